#pragma once
// What residuals see of the action model: the scene, its solution, torques and contacts. What Crocoddyl calls
// DataCollectorJointActMultibodyInContact.

#include "manycontact/action/actuation.hpp"
#include "manycontact/action/contact.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// Where an island's rows and columns are in the state's and the control's vectors.
struct IslandColumns {
  std::vector<int> v;  // nv of the island: of the velocity coordinates; also the rows of its accelerations
  std::vector<int> x;  // 2 nv: columns [q | v] in ndx
  std::vector<int> u;  // in nu, ascending by robot
};

/// Of an impulse (control/impulse_fwddyn.hpp): the solution is that of its equations, which are at rest.
struct Impact {
  std::vector<Kinematics<double>> motion;  // per robot, at q and the velocity before
  Eigen::VectorXd vnext;                   // nv: the velocity after
  Eigen::MatrixXd dvnext_dx;               // nv x ndx: by calcDiff
};

/// The state's robots in motion, for residuals, contacts and impulses that are evaluated by hand: what pinocchio::Data
/// is to Crocoddyl.
class MultibodyData {
 public:
  explicit MultibodyData(const Multibody& model);
  MultibodyData(const MultibodyData&) = delete;

  /// Places, velocities, inertias and their derivatives at q, v and the accelerations a (nv; zero). Throws
  /// std::invalid_argument on a wrong size.
  void update(const ConstVectorRef& q, const ConstVectorRef& v, const ConstVectorRef& a);
  void update(const ConstVectorRef& q, const ConstVectorRef& v);

  Scene scene;         // without contacts
  SceneData solution;  // by update: kinematics
  Eigen::VectorXd q, v, a;
  std::vector<Kinematics<double>> motion;  // by update, per robot: with a
  std::vector<RneaDerivatives> terms;      // by update, per robot: Psid, Psidd, Sv
};

struct DataCollector {  // what residuals see
  /// Of an action model.
  DataCollector(const Scene& s, const Options& options, std::shared_ptr<ActuationDataAbstract> act);
  /// By hand: as a residual needs them. Parts are kept up to date by their owner, before each calc: the motion by
  /// MultibodyData::update, torques by the actuation, contacts' forces by updateForce, updateForceDiff.
  DataCollector();
  explicit DataCollector(MultibodyData* motion, std::shared_ptr<ActuationDataAbstract> act = nullptr,
                         std::shared_ptr<ContactDataMultiple> contact = nullptr);
  DataCollector(MultibodyData* motion, std::shared_ptr<ContactDataMultiple> contact);
  explicit DataCollector(std::shared_ptr<ActuationDataAbstract> act);
  DataCollector(const DataCollector&) = delete;
  virtual ~DataCollector();

 private:
  struct Own;
  std::unique_ptr<Own> own_;

 public:
  const bool whole;                    // by hand: data created with it have whole matrices
  MultibodyData* pinocchio = nullptr;  // by hand
  Scene& scene;         // the state's robots, the contacts in the order of their names, damping, armature
  SceneData& solution;  // kinematics of the last calc; the rest of the last calc(data, x, u)
  std::shared_ptr<ActuationDataAbstract> actuation;
  std::shared_ptr<ContactDataMultiple> contacts;
  std::vector<IslandColumns> islands;  // per island of the solution
  // Derivatives by the state and the control, per island [a; f] x [q | v | u]. For a custom actuation, da/dtau is
  // multiplied out; for a selection they are the solution's own.
  // Throws std::logic_error unless they are of the last calc.
  PanelView panel(std::size_t island) const;
  std::vector<RowMajorMatrix> custom;  // per island, for a custom actuation

  std::unique_ptr<Impact> impact;  // null but in an impulse

  /// At the x of the last calc.
  const Kinematics<double>& kinematics(int robot) const {
    return impact ? impact->motion[static_cast<std::size_t>(robot)] : kinematics_of(solution, robot);
  }
  /// The contact model's data on this frame; of several the one of this name. Throws std::invalid_argument when there
  /// is none, or more than one and no name.
  const ContactDataAbstract& contact_on(FrameIndex frame, const std::string& who, const std::string& name = "") const;
  /// Prepares the solution for the contacts that are active. Never by sparse-bodies, which leaves neither inertias nor
  /// contact rows in joint space for residuals to look at: deep trees are solved by sparse-ldl here.
  void prepare();
};
using DataCollectorAbstract = DataCollector;
using DataCollectorActuation = DataCollector;
using DataCollectorMultibody = DataCollector;
using DataCollectorActMultibody = DataCollector;
using DataCollectorMultibodyInContact = DataCollector;
using DataCollectorMultibodyInImpulse = DataCollector;
using DataCollectorActMultibodyInContact = DataCollector;

}  // namespace manycontact
