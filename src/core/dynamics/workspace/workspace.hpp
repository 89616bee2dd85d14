#pragma once
// The memory of SceneData, private to the module dynamics. Comments name the function that sets each part.

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

/// A robot's terms at q, v, in its tree frame, set by evaluate. kin.a: bias (with an AtSolution, total) accelerations.
struct RobotData : RobotQuantities<double> {
  using RobotQuantities::RobotQuantities;
  std::uint64_t state = 0;   // Workspace::state at which all members were computed
  std::uint64_t placed = 0;  // Workspace::state at which only the placements in kin were computed
  std::vector<double> M;     // packed inertia (detail/algorithm/crba.hpp); empty until make_joint_space
};

struct IslandWork {  // memory of an island, which the pool keeps for the next island of the same shape
  IslandWork(std::shared_ptr<IslandShape> s, const Options& options);

  std::shared_ptr<IslandShape> shape;
  Choice choice;
  Island island;  // set by prepare

  // systems that may solve the island, in this order (unless WithinTolerance changes J); nullptr: not available
  BatchPlace alone;                      // used for single-robot islands, which SIMD batches solve first
  std::unique_ptr<RobotsSystem> robots;  // used for several robots; if not robots->solves, only for derivatives
  std::unique_ptr<BodiesSystem> bodies;  // used if sparse-bodies was chosen
  MatrixSystem matrix;

  bool joinable = true;              // whether a RobotsSystem is possible, and not predicted to be slower
  IslandSystem* answered = nullptr;  // the system that solved, and also differentiates; nullptr: no solution
  bool answered_by(const IslandSystem* system) const { return system && answered == system; }
  inline static IslandSystem batches;  // `answered` if a SIMD batch solved the single-robot island; solves nothing
  /// Whether a SIMD batch solved the island, and may compute its derivatives and products.
  bool served_in_lanes() const { return answered_by(&batches) && alone.panel_is_safe; }
  /// Whether SIMD batches solve the island first, so that K need not be assembled.
  bool stands_in_lanes() const { return alone.group || (robots && robots->solves); }
  int depended = 0;        // number of redundant rows at the start of a motion (dynamics/keep_dependent.hpp)
  int factorizations = 0;  // number of factorizations of K, whole or robot by robot, in the current solve
  bool deficient = false;  // whether a system other than `matrix` found dependent rows at the current state

  IslandDerivatives derivatives;  // memory of derivatives in the pool; otherwise they are in Workspace::derivatives
};

struct ProductWork {
  struct OfRobot {
    std::vector<BodyVariation> body;               // njoints: tangents (jvp) or adjoints (vjp) of bodies' motions
    std::vector<Vec6<double>> u;                   // njoints: virtual velocities
    std::vector<Vec6<double>> fext, dfext, f, df;  // njoints: forces on bodies, and their changes
    std::vector<double> w;                         // nv: change of the torques
  };
  explicit ProductWork(const Scene& scene);
  std::vector<OfRobot> robots;
  Eigen::VectorXd a, y;  // right-hand side, then solution x = [a; y]; nv, and rows of all contacts at most
  Eigen::VectorXd tau;   // nv: dtau or wtau
};

struct Switching {
  RobotGroups groups;                                  // robots whose islands change when contacts are switched
  std::vector<std::unique_ptr<IslandWork>> old, next;  // islands before and after contacts are switched
};

struct ThreadWork {  // scratch of one thread
  int number = 0;
  FactorScratch scratch;
  PanelWork panel;
  IslandReport spare_report;  // receives reports of factorizations that do not belong to the solution
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
  std::uint64_t current = 0;  // number of the current solution's state, 0: none; Stamp::now points to this member

  // set by prepare, for `active` and `options`
  bool prepared = false;  // whether the members below are complete
  std::vector<char> active;
  std::size_t springs = 0;  // number of the scene's springs, which couple robots
  Options options;
  std::vector<ThreadWork> threads;                   // one or more
  double worth_a_thread = costs::kWorthAThread;      // least seconds of work per thread
  std::vector<internal::Failure> failures;           // one per thread
  std::vector<std::unique_ptr<IslandWork>> islands;  // sorted by their first robots
  std::vector<int> robot_island;                     // the island of each robot
  std::uint64_t layout = 0;                          // counts how often the islands changed
  ShapeCache shapes;
  IslandPool pool;
  std::map<Eigen::Index, Eigen::VectorXd> spare_f;  // memory for Solution::f of other sizes
  Switching switching;

  // set by prepare if contacts are reduced to pairs; `islands` are then prepared on demand (prepare_islands)
  std::unique_ptr<Reduction> pairs;  // nullptr: no contacts may be reduced
  Reduction* reduction = nullptr;    // == pairs.get() if any contacts are reduced; the reduced scene is then solved
  std::vector<char> islands_active;  // active contacts for which `islands` were prepared
  std::optional<Options> islands_options;  // options for which `islands` were prepared; nullopt: not prepared

  InLanes lanes;
  std::vector<char> done;  // scratch of each_island

  // set by evaluate, update_kinematics
  OnDemand<RobotData> robots;
  OnDemand<ContactSupport> supports;       // constant; made for contacts whose J was evaluated
  OnDemand<ContactData<double>> contacts;  // constraint rows, at the bias accelerations
  std::vector<std::uint64_t> rows_state;   // one entry per contact: the `state` at which its rows were evaluated

  // left: ContactData::left of all pairs (contacts that represent several), set with the rows. left_offset: where a
  // contact's numbers begin in `left`; -1: no pair.
  std::vector<int> left_offset;
  std::vector<double> left;

  std::vector<double> prescribed;  // prescribed accelerations of constraint rows, in f's order; empty: zero

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

/// Throws std::invalid_argument, naming `function`, if data are not of this scene. With `island`, only the island's
/// robots and contacts are compared, so that a check of each island costs no more than one of the scene.
void check_scene(const Scene& scene, const SceneData& data, const char* function, const Island* island = nullptr);
/// Calls check_scene, and throws std::logic_error unless data contain a solution for the active contacts.
void check_solved(const Scene& scene, const SceneData& data, const char* function, const Island* island = nullptr);
/// Calls check_solved, and throws std::logic_error if accelerations were prescribed (dynamics/solve_prescribed.hpp).
void check_not_prescribed(const Scene& scene, const SceneData& data, const char* function);
void check_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected);

/// Resizes x without keeping its content. If memory runs out, x is empty; Eigen's resize would leave a freed array.
template <class Matrix>
void remake(Matrix& x, Eigen::Index rows, Eigen::Index cols = 1) {
  if (x.rows() == rows && x.cols() == cols) return;
  x = Matrix();
  x.resize(rows, cols);
}

}  // namespace internal

}  // namespace manycontact
