#pragma once
// Islands solved by sparse-ldl robot by robot in SIMD batches. In interface.hpp's notation, with b = [b_1; ...; b_n;
// c]:
//
//     x_r  = K_r^-1 (b_r - G_r^T y),    S y = sum_r G_r K_r^-1 b_r - c.
//
// One pass over the SIMD batches computes terms, K_r, factors with the rows of G_r, and parts of S; another one solves
// backward. The solution is refined and checked with the island's K. A single-robot island has no y.

#include <map>

#include "../../lanes/lanes.hpp"
#include "../system.hpp"
#include "interface.hpp"
#include "manycontact/kkt/costs.hpp"
#include "manycontact/sparse/memory.hpp"

namespace manycontact {

struct RobotsDerivatives;
struct SceneData;
struct Workspace;
struct IslandReport;

/// Robots of one plan. Groups without robots are kept for later contact sets.
struct BlockGroup {
  std::shared_ptr<const lanes::BlockPlan> plan;
  std::vector<lanes::OneOrBatch<lanes::RobotBlocks>> kernels;  // one entry per thread
  std::vector<lanes::OneOrBatch<lanes::SingleBlocks>> single;  // used for single-robot islands, if options request it
  std::vector<int> islands;                                    // scratch of a call: islands to solve with this plan
  double seconds = 0;                                          // predicted for one robot alone
};

/// Contacts that couple two robots, identical except for placements and gains.
struct InterfaceContactGroup {
  struct Key {  // properties on which the kernels depend
    const ModelStructure *A, *B;
    int kind;  // kind_of(contact)
    int joint_A, joint_B;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<lanes::OneOrBatch<lanes::InterfaceContacts>> kernels;  // one entry per thread
};

/// SIMD batches of robots, set up by prepare.
struct InLanes {
  const simd::Level* level = nullptr;                                               // nullptr: no batches
  std::map<std::pair<const ModelStructure*, std::vector<int>>, BlockGroup> groups;  // keys: structure, contacts, ...
  std::map<InterfaceContactGroup::Key, InterfaceContactGroup> contacts;
  // scratch of a call: the islands that it processes, batch after batch
  struct Batch {
    BlockGroup* group;
    int first, count;  // range of islands and robots
  };
  std::vector<int> islands;
  std::vector<lanes::RobotBlocks::Robot> robots;
  std::vector<Batch> batches;
};

/// The group of a single-robot island: one call solves all such islands in batches (functions of `alone.cpp` below).
struct BatchPlace {
  BlockGroup* group = nullptr;  // nullptr: not in a SIMD batch; set by prepare
  // set by the last solution from a SIMD batch
  bool panel_is_safe = false;  // whether the batch may compute derivatives too
  bool refine_panel = false;   // whether these are refined once
};

/// Solves an island of several robots.
class RobotsSystem final : public IslandSystem {
 public:
  explicit RobotsSystem(IslandWork& island);
  ~RobotsSystem() override;

  /// Redundant rows are supported only on contacts with single robots.
  bool solve(const Scene&, SceneData&, ThreadWork&, IslandReport&) override;
  bool differentiate(const Scene&, SceneData&, ThreadWork&, IslandDerivatives&) override;
  bool jvp(const Scene&, SceneData&, ThreadWork&, const TangentProduct&) override;
  bool vjp(const Scene&, SceneData&, ThreadWork&, const AdjointProduct&) override;
  bool invert(const Scene&, SceneData&, ThreadWork&, ProductWork&) override;

  /// Computes the factors and the right-hand side at the current state. False: they are not sound.
  bool factorize(const Scene& scene, SceneData& data);
  /// Whether any robot has dependent rows in these factors.
  bool rows_depend() const;
  /// Returns the growth of K's entries in these factors (Factor::growth).
  double growth() const;

  IslandWork& owner;
  using Robot = lanes::RobotBlocks::Robot;
  struct Batch {  // robots of a SIMD batch: range of `order`
    BlockGroup* group;
    int first, count;
    std::size_t at;  // offset in `memory`
  };
  struct ContactBatch {  // couplings of a SIMD batch: range of `contacts`
    InterfaceContactGroup* group;
    int first, count;
  };
  struct Coupling {  // a contact that couples robots
    InterfaceContactGroup* group;
    int contact;           // number in the scene
    int number;            // number in the island
    int row, rows;         // first interface row and number of rows
    int A, B;              // robots of the island
    int among_A, among_B;  // index among the joins of A and B
    double smallest_row, motion;
  };
  struct OfRobot {
    BlockGroup* group;
    std::vector<int> contacts = {};   // contacts on it alone, as numbered in the scene
    int member = 0;                   // index in `members`
    std::vector<int> couplings = {};  // indices in `contacts`, in the order of its joins
  };

  std::shared_ptr<const Interface> interface;
  bool solves = false;                // whether it is tried first: predicted to be cheaper than the island's factor
  bool refused = false;               // whether pivots of the last solve were not sound
  double seconds = 0;                 // predicted for a solve
  Order within = Order::kLeafToRoot;  // elimination order of each robot
  std::vector<int> order;             // robots of the island, group by group
  std::vector<OfRobot> robots;
  bool contradiction = false;  // the last solution was inconsistent; only the whole K differentiates it
  // set by prepare, for the current island
  std::vector<Coupling> contacts;  // sorted by group, identical ones adjacent
  std::vector<Robot> members;      // robots in the order of `order`; filled by solve
  Robot& member(std::size_t robot) { return members[robots[robot].member]; }
  const Robot& member(std::size_t robot) const { return members[robots[robot].member]; }
  // set by factorize
  std::vector<Batch> batches;
  std::vector<ContactBatch> contact_batches;
  std::uint64_t state = 0;                         // the state of these members; 0: not sound
  double first_error = 0;                          // backward error of the solution before refinement
  bool back = false;                               // direction of the last iteration over the batches
  sparse::LargeMemory memory;                      // numbers of the batches and their robots
  std::vector<double> Sx, L, D, terms;             // -S and its factor, in its order
  std::vector<double> b, y, r, scale, step;        // vectors of the interface rows
  std::unique_ptr<RobotsDerivatives> derivatives;  // constructed when first needed
};

namespace internal {

/// The predicted cost of a SIMD batch of `count` robots, relative to one robot.
inline double together(std::size_t count) { return count > 1 ? 1 + costs::kTogether * static_cast<double>(count) : 1; }

/// Plans SIMD batches for an island of a new shape if they are cheaper than its factor: alone.group, robots.
void plan_robots(const Scene& scene, Workspace& work, IslandWork& island);
/// Assigns other robots and contacts of the same shape. Allocates nothing for contact sets that occurred before.
void bind_robots(const Scene& scene, Workspace& work, IslandWork& island);
/// Groups the current single-robot islands into SIMD batches.
void group_robots_alone(Workspace& work);
/// Frees groups that no island uses, neither current nor pooled.
void forget_unused_groups(Workspace& work);
/// Constructs island.robots at the first call, if possible.
void make_robots(const Scene& scene, Workspace& work, IslandWork& island);

/// Solves the unsolved single-robot islands that fit SIMD batches, at w.q, data.v, data.tau, first in single precision
/// if options request it. start: start of a step, whose forces are then not in data.tau.
void solve_alone(const Scene& scene, SceneData& data, const StartOfStep* start = nullptr);
/// Whether all islands are single robots in SIMD batches of doubles.
bool stand_alone(const Scene& scene, const Workspace& w);
/// Returns the largest number of single robots, or states, in a SIMD batch; 1 without SIMD batches.
int batch_width(const Workspace& w);
/// Reports dependent rows of an island's J: status, rank, names.
void report_dependent_rows(const Scene& scene, const SceneData& data, IslandWork& island, std::span<const int> rows,
                           const rank::Contradiction<double>& contradiction, IslandReport& report);
/// Compute derivatives of islands solved in SIMD batches (IslandWork::served_in_lanes) into w.derivatives, and products
/// by the kernels' jvp or vjp with the vectors of lanes::ProductJob.
void differentiate_alone(const Scene& scene, SceneData& data);
using ProductInLanes = void (lanes::RobotBlocks::*)(const lanes::ProductJob&, std::span<lanes::RobotBlocks::Robot>);
void multiply_alone(const Scene& scene, SceneData& data, ProductInLanes product, const std::array<const double*, 3>& in,
                    const std::array<double*, 3>& out);

/// Allocates island.robots->derivatives for `out` if robot by robot is predicted to be cheaper than the whole K.
void prepare_robots_derivatives(const Scene& scene, IslandWork& island, const IslandDerivatives& out, Workspace& work);
/// Whether robot by robot is cheaper; the result may still turn out not to be sound.
bool differentiates_by_robots(const IslandWork& island);

/// Return the jobs of SIMD batches at the current state, and at its solution.
lanes::Job job_at_state(const Scene& scene, SceneData& data);
lanes::Solution solution_of(const Scene& scene, const SceneData& data);

/// Returns the componentwise backward error of the interface rows from b, y and the robots' borders, or NaN.
double interface_error(double damping, RobotsSystem& robots);

}  // namespace internal

}  // namespace manycontact
