#pragma once
// The memory behind SceneData, private to module dynamics. Comments name the function that sets each part.

#include <map>
#include <optional>

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

/// One robot's terms at q, v, in its tree frame; set by evaluate. kin.a: bias accelerations, unless AtSolution lives.
struct RobotData : RobotQuantities<double> {
  using RobotQuantities::RobotQuantities;
  std::uint64_t state = 0;   // the state of all members
  std::uint64_t placed = 0;  // the state of the placements in kin, if only these were computed
  std::vector<double> M;     // packed inertia (detail/algorithm/crba.hpp); empty until make_joint_space
};

/// One current island. When contacts are switched it returns to its shape's pool, for the next island of that shape.
struct IslandWork {
  IslandWork(std::shared_ptr<IslandShape> s, const Options& options);

  std::shared_ptr<IslandShape> shape;
  Choice choice;
  Island island;  // set by prepare

  // systems that may solve it, in this order (unless rows are made dependent); nullptr: none
  BatchPlace alone;                      // used for single robots, which SIMD batches solve before all systems
  std::unique_ptr<RobotsSystem> robots;  // used for several; if not `solves`: only for differentiate
  std::unique_ptr<BodiesSystem> bodies;  // if sparse-bodies was chosen
  MatrixSystem matrix;

  bool joinable = true;              // false: its robots do not fit a RobotsSystem, or that is not cheaper
  IslandSystem* answered = nullptr;  // solved, and also differentiates; nullptr: no solution
  bool answered_by(const IslandSystem* system) const { return system && answered == system; }
  /// Value of `answered` for SIMD batches of single-robot islands; it has no functions for one island.
  inline static IslandSystem batches;
  /// Whether a SIMD batch solved it, and may compute its derivatives and products.
  bool served_in_lanes() const { return answered_by(&batches) && alone.panel_is_safe; }
  /// Whether SIMD batches solve it first; they need no terms of the whole K.
  bool stands_in_lanes() const { return alone.group || (robots && robots->solves); }
  int depended = 0;        // number of redundant rows at the start of a motion (dynamics/keep_dependent.hpp)
  int factorizations = 0;  // number of factorizations of K, whole or robot by robot, in this solve
  bool deficient = false;  // another system than `matrix` found rows dependent at the current state

  IslandDerivatives derivatives;  // while in the pool; else in Workspace::derivatives
};

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

struct Switching {
  RobotGroups groups;                                  // robots whose islands change
  std::vector<std::unique_ptr<IslandWork>> old, next;  // islands before and after
};

/// Scratch of one thread.
struct ThreadWork {
  int number = 0;
  FactorScratch scratch;
  PanelWork panel;
  IslandReport spare_report;  // report of factorizations that are not reported
  // scratch of one SIMD batch: one entry per robot, subtree or contact
  std::vector<lanes::Answer> answers;
  std::vector<lanes::Panel> panels;
  std::vector<lanes::InterfaceContacts::Rows> interface_contacts;
  std::vector<lanes::InterfaceContacts::Derivatives> interface_derivatives;
  KktVectors v;  // used for jvp, vjp and dependent rows
};

struct Workspace {
  explicit Workspace(const Scene& scene);

  SceneIdentity scene;        // the scene these data belong to
  std::uint64_t state = 0;    // number of the current state; each solve or other evaluation increments it
  std::uint64_t current = 0;  // state of the current solution, 0: none. Stamps point to it

  // set by prepare, for `active` and `options`
  bool prepared = false;  // false while the members below change
  std::vector<char> active;
  std::size_t springs = 0;  // number of the scene, as springs couple robots
  Options options;
  std::vector<ThreadWork> threads;                   // one at least
  double worth_a_thread = costs::kWorthAThread;      // least seconds of work per thread
  std::vector<internal::Failure> failures;           // one per thread
  std::vector<std::unique_ptr<IslandWork>> islands;  // sorted by their first robots
  std::vector<int> robot_island;                     // one entry per robot
  std::uint64_t layout = 0;                          // number of changes of islands
  ShapeCache shapes;
  IslandPool pool;
  std::map<Eigen::Index, Eigen::VectorXd> spare_f;  // forces of other sizes
  Switching switching;

  // set by prepare if contacts are reduced to pairs; the rest is then prepared on demand (prepare_islands)
  std::unique_ptr<Reduction> pairs;  // nullptr: no contacts may be reduced
  Reduction* reduction = nullptr;    // `pairs` if any are reduced; its scene is then solved
  std::vector<char> islands_active;
  std::optional<Options> islands_options;  // none: there are no islands of `islands_active`

  InLanes lanes;
  std::vector<char> done;  // scratch of each_island

  // set by evaluate, update_kinematics
  OnDemand<RobotData> robots;
  OnDemand<ContactSupport> supports;       // contacts that have joint-space terms; constant then
  OnDemand<ContactData<double>> contacts;  // rows at the bias accelerations
  std::vector<std::uint64_t> rows_state;   // one entry per contact: the state of its rows

  // ContactData::left of pairs (contact/pair_rows.hpp), set with their rows, at left_offset; -1: the contact is no pair
  std::vector<int> left_offset;
  std::vector<double> left;

  std::vector<double> prescribed;  // accelerations required of the rows of f; empty: zero

  // set by solve
  std::unique_ptr<AppliedWork> applied;  // nullptr: the scene has neither wrenches nor springs
  Eigen::VectorXd q;                     // nq: the configuration of the solve
  Eigen::VectorXd given;                 // nv: input torques, without friction, springs and external wrenches

  // set by differentiate, jvp, vjp
  std::unique_ptr<Linearisation> linearisation;
  DerivativeData derivatives;
  std::unique_ptr<ProductWork> products;

  // set by solve in precision `extended`, and by estimate_errors
  std::unique_ptr<ExtendedWork> extended;
};

namespace internal {

/// Throws std::invalid_argument, naming `function`, if data are not of this scene.
void check_scene(const Scene& scene, const SceneData& data, const char* function);
/// Does the same, and throws std::logic_error unless data contain a solution for the active contacts.
void check_solved(const Scene& scene, const SceneData& data, const char* function);
/// Does the same, and throws std::logic_error if accelerations were prescribed (dynamics/solve_prescribed.hpp).
void check_not_prescribed(const Scene& scene, const SceneData& data, const char* function);
void check_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected);

/// Resizes x without keeping its content. Eigen's own resize leaves a freed array if memory runs out.
template <class Matrix>
void remake(Matrix& x, Eigen::Index rows, Eigen::Index cols = 1) {
  if (x.rows() == rows && x.cols() == cols) return;
  x = Matrix();
  x.resize(rows, cols);
}

}  // namespace internal

}  // namespace manycontact
