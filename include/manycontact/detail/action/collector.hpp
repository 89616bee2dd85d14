#pragma once
// DataCollector contains the data of an action model that residuals depend on: scene, solution, torques and contacts.
// It corresponds to Crocoddyl's DataCollectorJointActMultibodyInContact.

#include "manycontact/action/actuation.hpp"
#include "manycontact/action/contact.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// The indices of an island's coordinates in the vectors of states and controls.
struct IslandColumns {
  std::vector<int> v;  // nv entries: the island's velocity coordinates, which also number the rows of its accelerations
  std::vector<int> x;  // 2 nv entries: the island's columns [q | v] among ndx columns
  std::vector<int> u;  // the island's columns among nu columns, robots in ascending order
};

/// The data of an impulse (control/impulse_fwddyn.hpp); DataCollector::solution is the solution of the impulse
/// equations at rest.
struct Impact {
  std::vector<Kinematics<double>> motion;  // one entry per robot: kinematics at q and the velocity before the impact
  Eigen::VectorXd vnext;                   // nv: the velocity after the impact
  Eigen::MatrixXd dvnext_dx;               // nv x ndx: set by calcDiff
};

/// The kinematics of the state's robots, for evaluating residuals, contacts and impulses standalone, without an action
/// model. It corresponds to pinocchio::Data in Crocoddyl.
class MultibodyData {
 public:
  explicit MultibodyData(const Multibody& model);  // sets the neutral configuration, at rest
  MultibodyData(const MultibodyData&) = delete;

  /// Computes placements, velocities, inertias and their derivatives at q (nq), v (nv) and accelerations a (nv; zero if
  /// a is not given). Throws std::invalid_argument for a wrong size.
  void update(const ConstVectorRef& q, const ConstVectorRef& v, const ConstVectorRef& a);
  void update(const ConstVectorRef& q, const ConstVectorRef& v) { update(q, v, Eigen::VectorXd::Zero(scene.nv)); }

  Scene scene;         // the robots, without contacts
  SceneData solution;  // kinematics of the robots: set by update
  Eigen::VectorXd q, v, a;
  std::vector<Kinematics<double>> motion;  // one per robot: kinematics with the accelerations a; set by update
  std::vector<RneaDerivatives> terms;      // one per robot: Psid, Psidd, Sv; set by update
};

struct DataCollector {  // The data that residuals depend on.
  /// Creates the data of an action model.
  DataCollector(const Scene& s, const Options& options, std::shared_ptr<ActuationDataAbstract> act);
  /// Creates data for standalone evaluation, with only the members that a residual needs. The caller updates these
  /// members before each calc: motion by MultibodyData::update, torques by the actuation, forces of contacts by
  /// updateForce and updateForceDiff.
  DataCollector() : DataCollector(nullptr, nullptr, nullptr) {}
  /// Creates data for standalone evaluation, with kinematics and, if given, actuation and contacts.
  explicit DataCollector(MultibodyData* motion, std::shared_ptr<ActuationDataAbstract> act = nullptr,
                         std::shared_ptr<ContactDataMultiple> contact = nullptr);
  /// Create data for standalone evaluation, with the given members only.
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
  const bool whole;                    // whether the data are standalone; parts then have whole matrices
  MultibodyData* pinocchio = nullptr;  // null unless the data are standalone
  Scene& scene;                        // the state's robots; contacts in the order of their names; damping; armature
  SceneData& solution;  // kinematics are those of the last calc, all other members those of the last calc(data, x, u)
  std::shared_ptr<ActuationDataAbstract> actuation;
  std::shared_ptr<ContactDataMultiple> contacts;
  std::vector<IslandColumns> islands;  // one entry per island of the solution
  // panel returns the derivatives of an island with respect to state and control: rows [a; f], columns [q | v | u].
  // They include the derivatives of a custom actuation. If the actuation selects coordinates, the panel is that of the
  // solution. Throws std::logic_error unless calcDiff followed the last calc.
  PanelView panel(std::size_t island) const;  // the derivatives described above
  std::vector<RowMajorMatrix> custom;         // panels with a custom actuation, one matrix per island

  std::unique_ptr<Impact> impact;  // null unless the model is an impulse

  /// Returns the kinematics of a robot at the x of the last calc.
  const Kinematics<double>& kinematics(int robot) const {
    return impact ? impact->motion[static_cast<std::size_t>(robot)] : robot_kinematics(scene, solution, robot);
  }
  /// Returns the data of the contact model on this frame; `name` selects one of several contacts. Throws
  /// std::invalid_argument if there is none, or if there are several and no name is given.
  const ContactDataAbstract& contact_on(FrameIndex frame, const std::string& who, const std::string& name = "") const;
  /// Prepares the solution for the active contacts. The method sparse-bodies is never used, since residuals need
  /// inertias and contact rows in joint space. Deep trees are solved by sparse-ldl instead.
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
