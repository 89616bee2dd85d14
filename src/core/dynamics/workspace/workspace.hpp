#pragma once
// The memory behind SceneData, private to module dynamics. Each part names its writer.

#include <map>
#include <optional>
#include <span>

#include "../applied_forces.hpp"
#include "../derivatives/linearisation.hpp"
#include "../extended/extended.hpp"
#include "../reduction/reduction.hpp"
#include "../robot_quantities.hpp"
#include "../systems/bodies/bodies.hpp"
#include "../systems/matrix/matrix.hpp"
#include "../systems/robots/robots.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/parallel.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/kkt/robot_groups.hpp"
#include "pool.hpp"
#include "scene_identity.hpp"

namespace manycontact {

/// One robot's kinematics and dynamics terms, in its tree frame. Set by evaluate, at q, v.
/// kin.a: bias accelerations, but while an AtSolution lives.
struct RobotData : RobotQuantities<double> {
  using RobotQuantities::RobotQuantities;
  std::uint64_t state = 0;   // the state that all of it belongs to
  std::uint64_t placed = 0;  // the state that the placements in kin belong to, if these alone were asked for
  std::vector<double> M;     // packed inertia (detail/algorithm/crba.hpp); empty until make_joint_space
};

/// One island at work. It fits a shape, not an island: when contacts are switched it goes back to its shape's pool,
/// and the next island of that shape takes it from there, with all its memory.
struct IslandWork {
  IslandWork(std::shared_ptr<IslandShape> s, const Options& options);

  std::shared_ptr<IslandShape> shape;
  Choice choice;
  Island island;  // set by prepare

  // systems that may solve it, but for dependent rows in this order; nullptr: not made
  BatchPlace alone;                      // used for one robot, which SIMD batches solve before all systems
  std::unique_ptr<RobotsSystem> robots;  // used for several; not `solves`: made by differentiate, only for that
  std::unique_ptr<BodiesSystem> bodies;  // made if sparse-bodies was chosen
  MatrixSystem matrix;

  bool joinable = true;              // false: its robots do not fit a RobotsSystem, or it cannot pay
  IslandSystem* answered = nullptr;  // gave the current solution, and gives its derivatives; nullptr: there is none
  bool answered_by(const IslandSystem* system) const { return system && answered == system; }
  /// SIMD batches of robots alone, as what gave a solution: one island by itself cannot ask anything of them.
  inline static IslandSystem batches;
  /// The solution came from a SIMD batch, and so may its derivatives and products.
  bool served_in_lanes() const { return answered_by(&batches) && alone.panel_is_safe; }
  /// SIMD batches solve it first, which need none of the terms of the whole K.
  bool stands_in_lanes() const { return alone.group || (robots && robots->solves); }
  int depended = 0;        // so many rows depended on others at the start (dynamics/keep_dependent.hpp)
  int factorizations = 0;  // factorizations of K, whole or robot by robot, since that began
  bool deficient = false;  // another system than `matrix` found rows dependent at the current state

  IslandDerivatives derivatives;  // while on the pool; else in Workspace::derivatives
};

/// Scratch of jvp and vjp.
struct ProductWork {
  struct OfRobot {
    std::vector<BodyVariation> body;               // njoints: tangents, or adjoints
    std::vector<Vec6<double>> u;                   // njoints: virtual velocities
    std::vector<Vec6<double>> fext, dfext, f, df;  // njoints
    std::vector<double> w;                         // nv: change of the torques
  };
  explicit ProductWork(const Scene& scene);
  std::vector<OfRobot> robots;
  Eigen::VectorXd a, y;  // vectors of the scene, all contacts active: right-hand sides and solutions x = [a; y]
  Eigen::VectorXd tau;   // dtau or wtau of the scene, nv
};

/// Scratch of prepare.
struct Switching {
  RobotGroups groups;                                  // groups of the robots whose islands change
  std::vector<std::unique_ptr<IslandWork>> old, next;  // the islands that were, and those to be
};

/// Scratch of one thread, for one island after the other.
struct ThreadWork {
  int number = 0;  // number of the thread
  FactorScratch scratch;
  PanelWork panel;
  IslandReport spare_report;  // report of factorizations that nobody asked for
  // scratch of one SIMD batch, one entry per robot, subtree or contact
  std::vector<lanes::Answer> answers;
  std::vector<lanes::Panel> panels;
  std::vector<lanes::InterfaceContacts::Rows> interface_contacts;
  std::vector<lanes::InterfaceContacts::Derivatives> interface_derivatives;
  KktVectors v;  // vectors of an island's system: used by jvp and vjp, and where rows depend
};

struct Workspace {
  explicit Workspace(const Scene& scene);

  SceneIdentity scene;        // the scene these data belong to
  std::uint64_t state = 0;    // number of the current state: of solves and other evaluations begun so far
  std::uint64_t current = 0;  // serial of the current solution, 0: none. What stamps point to

  // set by prepare, for `active` and `options`
  bool prepared = false;  // all of this fits; false while it is being changed
  std::vector<char> active;
  std::size_t springs = 0;  // number of springs of the scene: they join robots to islands
  Options options;
  std::vector<ThreadWork> threads;                   // one at least
  double worth_a_thread = costs::kWorthAThread;      // s of work for each
  std::vector<internal::Failure> failures;           // one per thread
  std::vector<std::unique_ptr<IslandWork>> islands;  // all islands, in the order of their first robots
  std::vector<int> robot_island;                     // one entry per robot
  std::uint64_t layout = 0;                          // changes of islands so far
  ShapeCache shapes;
  IslandPool pool;
  std::map<Eigen::Index, Eigen::VectorXd> spare_f;  // forces of other sizes
  Switching switching;

  // set by prepare, if contacts between the same two bodies are reduced: then the rest is prepared only when asked
  // for (prepare_islands)
  std::unique_ptr<Reduction> pairs;  // nullptr: none may be reduced
  Reduction* reduction = nullptr;    // `pairs`, where some are; what is solved is its scene then
  std::vector<char> islands_active;
  std::optional<Options> islands_options;  // none: the islands of `islands_active` do not exist

  InLanes lanes;
  std::vector<char> done;  // scratch of each_island

  // set by evaluate, update_kinematics
  OnDemand<RobotData> robots;
  OnDemand<ContactSupport> supports;       // contacts that the joint-space K was made for; constant once there
  OnDemand<ContactData<double>> contacts;  // rows at the bias accelerations
  std::vector<std::uint64_t> rows_state;   // one entry per contact: the state of its rows

  // ContactData::left of pairs (contact/pair_rows.hpp), by who evaluates their rows at the state, at left_offset of the
  // contact; -1: it is no pair
  std::vector<int> left_offset;
  std::vector<double> left;

  std::vector<double> prescribed;  // rows of f: accelerations asked for, or none where these are zero

  // set by solve
  std::unique_ptr<AppliedWork> applied;  // nullptr: the scene has neither external wrenches nor springs
  Eigen::VectorXd q;                     // nq: the configuration solved at
  Eigen::VectorXd given;                 // nv: the torques given, without friction, springs and external wrenches

  // set by differentiate, jvp, vjp
  std::unique_ptr<Linearisation> linearisation;
  DerivativeData derivatives;
  std::unique_ptr<ProductWork> products;

  // set by solve in the precision `extended`, by estimate_errors in any
  std::unique_ptr<ExtendedWork> extended;
};

namespace internal {

/// Throws std::invalid_argument, in the name of `function`, where data are not of this scene.
void check_scene(const Scene& scene, const SceneData& data, const char* function);
/// The same, and std::logic_error unless data contain a solution of the contacts now active.
void check_solved(const Scene& scene, const SceneData& data, const char* function);
/// The same, and std::logic_error where its contacts were asked for accelerations (dynamics/solve_prescribed.hpp).
void check_not_prescribed(const Scene& scene, const SceneData& data, const char* function);
void check_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected);

/// x of n numbers, whatever it contained: Eigen's own resize leaves an array freed when memory runs out.
template <class Matrix>
void remake(Matrix& x, Eigen::Index rows, Eigen::Index cols = 1) {
  if (x.rows() == rows && x.cols() == cols) return;
  x = Matrix();
  x.resize(rows, cols);
}

}  // namespace internal

}  // namespace manycontact
