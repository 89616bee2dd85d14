#pragma once
// The data of an action model that residuals depend on: the scene, its solution, torques and contacts. It corresponds
// to Crocoddyl's DataCollectorJointActMultibodyInContact.

#include "manycontact/action/actuation.hpp"
#include "manycontact/action/contact.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// The places of an island's rows and columns in the vectors of states and controls.
struct IslandColumns {
  std::vector<int> v;  // nv of the island: its velocity coordinates, which are also the rows of its accelerations
  std::vector<int> x;  // 2 nv: columns [q | v] in ndx
  std::vector<int> u;  // columns in nu, ascending by robot
};

/// The data of an impulse (control/impulse_fwddyn.hpp). The solution is that of its equations, which are at rest.
struct Impact {
  std::vector<Kinematics<double>> motion;  // one entry per robot, at q and the velocity before the impact
  Eigen::VectorXd vnext;                   // nv: the velocity after the impact
  Eigen::MatrixXd dvnext_dx;               // nv x ndx: set by calcDiff
};

/// The kinematics of the state's robots, for residuals, contacts and impulses that are evaluated standalone, without an
/// action model. It corresponds to pinocchio::Data in Crocoddyl.
class MultibodyData {
 public:
  explicit MultibodyData(const Multibody& model);  // starts at the neutral configuration, at rest
  MultibodyData(const MultibodyData&) = delete;

  /// Computes placements, velocities, inertias and their derivatives at q (nq), v (nv) and the accelerations a (nv;
  /// zero if not given). Throws std::invalid_argument for a wrong size.
  void update(const ConstVectorRef& q, const ConstVectorRef& v, const ConstVectorRef& a);
  void update(const ConstVectorRef& q, const ConstVectorRef& v) { update(q, v, Eigen::VectorXd::Zero(scene.nv)); }

  Scene scene;         // the robots, without contacts
  SceneData solution;  // set by update: kinematics
  Eigen::VectorXd q, v, a;
  std::vector<Kinematics<double>> motion;  // one per robot, set by update with the accelerations a
  std::vector<RneaDerivatives> terms;      // one per robot, set by update: Psid, Psidd, Sv
};

struct DataCollector {  // The data that residuals depend on.
  /// Creates the data of an action model.
  DataCollector(const Scene& s, const Options& options, std::shared_ptr<ActuationDataAbstract> act);
  /// Creates data for standalone evaluation, with the members that a residual needs. Their owner updates them before
  /// each calc: the motion with MultibodyData::update, torques with the actuation, forces of contacts with updateForce
  /// and updateForceDiff.
  DataCollector() : DataCollector(nullptr, nullptr, nullptr) {}
  /// Creates data for standalone evaluation.
  explicit DataCollector(MultibodyData* motion, std::shared_ptr<ActuationDataAbstract> act = nullptr,
                         std::shared_ptr<ContactDataMultiple> contact = nullptr);
  /// Create data for standalone evaluation, with some of these members.
  DataCollector(MultibodyData* motion, std::shared_ptr<ContactDataMultiple> contact)
      : DataCollector(motion, nullptr, std::move(contact)) {}
  explicit DataCollector(std::shared_ptr<ActuationDataAbstract> act) : DataCollector(nullptr, std::move(act)) {}
  explicit DataCollector(std::shared_ptr<ContactDataMultiple> contact)
      : DataCollector(nullptr, nullptr, std::move(contact)) {}
  DataCollector(const DataCollector&) = delete;
  virtual ~DataCollector();

 private:
  struct Own;
  std::unique_ptr<Own> own_;

 public:
  const bool whole;                    // standalone: data created with it have whole matrices
  MultibodyData* pinocchio = nullptr;  // standalone only
  Scene& scene;         // the state's robots, the contacts in the order of their names, damping, armature
  SceneData& solution;  // kinematics of the last calc; everything else is of the last calc(data, x, u)
  std::shared_ptr<ActuationDataAbstract> actuation;
  std::shared_ptr<ContactDataMultiple> contacts;
  std::vector<IslandColumns> islands;  // one entry per island of the solution
  // Derivatives with respect to state and control, per island [a; f] x [q | v | u]. For a custom actuation they are
  // multiplied by its derivatives; for a selection they are those of the solution. Throws std::logic_error unless they
  // are of the last calc.
  PanelView panel(std::size_t island) const;  // see above
  std::vector<RowMajorMatrix> custom;         // one matrix per island, for a custom actuation

  std::unique_ptr<Impact> impact;  // null except in an impulse

  /// The kinematics of a robot at the x of the last calc.
  const Kinematics<double>& kinematics(int robot) const {
    return impact ? impact->motion[static_cast<std::size_t>(robot)] : robot_kinematics(scene, solution, robot);
  }
  /// The data of the contact model on this frame; if there are several, of the one with this name. Throws
  /// std::invalid_argument if there is none, or if there are several and no name is given.
  const ContactDataAbstract& contact_on(FrameIndex frame, const std::string& who, const std::string& name = "") const;
  /// Prepares the solution for the active contacts. sparse-bodies is never used, since residuals need inertias and
  /// contact rows in joint space; deep trees are solved with sparse-ldl here.
  void prepare();
};
using DataCollectorAbstract = DataCollector;
using DataCollectorActuation = DataCollector;
using DataCollectorContact = DataCollector;
using DataCollectorImpulse = DataCollector;
using DataCollectorMultibody = DataCollector;
using DataCollectorActMultibody = DataCollector;
using DataCollectorMultibodyInContact = DataCollector;
using DataCollectorMultibodyInImpulse = DataCollector;
using DataCollectorActMultibodyInContact = DataCollector;

}  // namespace manycontact
