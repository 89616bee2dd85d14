#pragma once
// Islands solved by sparse-ldl robot by robot, in SIMD batches: of one robot, or of several that few rows couple. In
// the notation of interface.hpp, with b = [b_1; ...; b_n; c]:
//
//     x_r  = K_r^-1 (b_r - G_r^T y),    S y = sum_r G_r K_r^-1 b_r - c.
//
// A robot's terms, its part of K, the factor of K_r with the rows of G_r below it, and its part of S are computed one
// after the other while they are in the cache, for a SIMD batch of robots; likewise the steps back. The solution is
// refined and judged with the island's K as that of its factor is. A robot alone has no y.

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

/// Robots of one plan. It stays when they are gone, for contact sets to come.
struct BlockGroup {
  std::shared_ptr<const lanes::BlockPlan> plan;
  std::vector<lanes::OneOrBatch<lanes::RobotBlocks>> kernels;  // one entry per thread
  std::vector<lanes::OneOrBatch<lanes::SingleBlocks>> single;  // the same of robots alone, where the options ask for it
  std::vector<int> islands;  // scratch of a call: the islands it solves with this plan
  double seconds = 0;        // predicted, of one robot solved alone
};

/// Contacts that join two robots, identical except for places and gains.
struct InterfaceContactGroup {
  struct Key {  // properties that their kernels are made for
    const ModelStructure *A, *B;
    int kind;  // kind_of(contact)
    int joint_A, joint_B;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<lanes::OneOrBatch<lanes::InterfaceContacts>> kernels;  // one entry per thread
};

/// SIMD batches of robots, formed by prepare.
struct InLanes {
  const simd::Level* level = nullptr;                                               // nullptr: no batches
  std::map<std::pair<const ModelStructure*, std::vector<int>>, BlockGroup> groups;  // keys: what plans depend on
  std::map<InterfaceContactGroup::Key, InterfaceContactGroup> contacts;
  // scratch of a call: its islands, those of a SIMD batch one after the other
  struct Batch {
    BlockGroup* group;
    int first, count;  // range of islands and robots
  };
  std::vector<int> islands;
  std::vector<lanes::RobotBlocks::Robot> robots;
  std::vector<Batch> batches;
};

/// The place of an island of one robot in a SIMD batch with others of its group: batch by batch, all of a scene's are
/// solved by one call (the functions of `alone.cpp` below). The whole K solves what batches left.
struct BatchPlace {
  BlockGroup* group = nullptr;  // nullptr: it is in no SIMD batch; by prepare
  // set by the last solution that came from a SIMD batch
  bool panel_is_safe = false;  // whether derivatives may come from there too
  bool refine_panel = false;   // and are refined once
};

/// An island of several robots.
class RobotsSystem final : public IslandSystem {
 public:
  explicit RobotsSystem(IslandWork& island);
  ~RobotsSystem() override;

  /// Rows that depend on others are of contacts on single robots.
  bool solve(const Scene&, SceneData&, ThreadWork&, IslandReport&) override;
  bool differentiate(const Scene&, SceneData&, ThreadWork&, IslandDerivatives&) override;
  bool jvp(const Scene&, SceneData&, ThreadWork&, const TangentProduct&) override;
  bool vjp(const Scene&, SceneData&, ThreadWork&, const AdjointProduct&) override;
  bool invert(const Scene&, SceneData&, ThreadWork&, ProductWork&) override;

  /// The factors of the robots and of the interface rows, and the right-hand side, at the current state. False where
  /// these are not sound.
  bool factorize(const Scene& scene, SceneData& data);
  /// Whether rows of any robot depend on others, in these factors.
  bool rows_depend() const;
  /// Growth of K's entries in these factors, as Factor has it.
  double growth() const;

  IslandWork& owner;
  using Robot = lanes::RobotBlocks::Robot;
  struct Batch {  // robots of a SIMD batch: numbers of `order`
    BlockGroup* group;
    int first, count;
    std::size_t at;  // offset in `memory`
  };
  struct ContactBatch {  // the same, of `contacts`
    InterfaceContactGroup* group;
    int first, count;
  };
  struct Coupling {  // a contact that joins robots
    InterfaceContactGroup* group;
    int contact;           // number in the scene
    int number;            // number in the island
    int row, rows;         // the first of its interface rows, and how many
    int A, B;              // robots of the island
    int among_A, among_B;  // numbers among the joins of A and B
    double smallest_row, motion;
  };
  struct OfRobot {
    BlockGroup* group;
    std::vector<int> contacts = {};   // contacts on it alone, numbers in the scene
    int member = 0;                   // index in `members`: its place in `order`
    std::vector<int> couplings = {};  // indices in `contacts`: those that join it, in the order of its joins
  };

  std::shared_ptr<const Interface> interface;
  bool solves = false;                // it is the island's first way: predicted to be cheaper than its factor
  bool refused = false;               // the pivots of the last solve were not sound
  double seconds = 0;                 // predicted, of a solve
  Order within = Order::kLeafToRoot;  // order in which each robot is eliminated
  std::vector<int> order;             // robots of the island, group by group
  std::vector<OfRobot> robots;
  bool contradiction = false;  // the last solution was inconsistent: derivatives have a term of it, in the whole K
  // set by prepare, for the current island
  std::vector<Coupling> contacts;  // group by group, like ones together
  std::vector<Robot> members;      // robots in the order of `order`; filled by solve
  Robot& member(std::size_t robot) { return members[robots[robot].member]; }
  const Robot& member(std::size_t robot) const { return members[robots[robot].member]; }
  // set by factorize
  std::vector<Batch> batches;
  std::vector<ContactBatch> contact_batches;
  std::uint64_t state = 0;                         // the state that all of this belongs to; 0 where it is not sound
  double first_error = 0;                          // backward error of the solution before refinement
  bool back = false;                               // the way the last step took through the batches
  sparse::LargeMemory memory;                      // numbers of the batches and their robots
  std::vector<double> Sx, L, D, terms;             // -S and its factor, in its order
  std::vector<double> b, y, r, scale, step;        // vectors of the interface rows
  std::unique_ptr<RobotsDerivatives> derivatives;  // made when first needed
};

namespace internal {

/// The predicted cost of a SIMD batch of `count` robots, relative to one robot.
inline double together(std::size_t count) { return count > 1 ? 1 + costs::kTogether * static_cast<double>(count) : 1; }

/// Plans SIMD batches for an island of a new shape, where they are cheaper than its factor: alone.group, robots.
void plan_robots(const Scene& scene, Workspace& work, IslandWork& island);
/// The same for other robots and contacts of the same shape. Allocates nothing for a contact set met before.
void bind_robots(const Scene& scene, Workspace& work, IslandWork& island);
/// Groups the current islands of one robot into SIMD batches.
void group_robots_alone(Workspace& work);
/// Gives back the groups that no island has, at work or in the pool.
void forget_unused_groups(Workspace& work);
/// island.robots, settled, where that is possible; made when first asked for.
void make_robots(const Scene& scene, Workspace& work, IslandWork& island);

/// Solves the islands of one robot that have a place in a SIMD batch, at w.q, data.v, data.tau: those not solved yet,
/// where the options ask for it first in single precision. Islands whose condition is too poor for that are left to
/// doubles. start: of a step, whose forces are then not in data.tau.
void solve_alone(const Scene& scene, SceneData& data, const StartOfStep* start = nullptr);
/// Whether all robots are islands that have a place in a SIMD batch of doubles.
bool stand_alone(const Scene& scene, const Workspace& w);
/// How many robots alone, or states, a SIMD batch has at most; 1 without SIMD batches.
int batch_width(const Workspace& w);
/// Reports the rows of an island's J that depend on others: status, rank, names.
void report_dependent_rows(const Scene& scene, const SceneData& data, IslandWork& island, std::span<const int> rows,
                           const rank::Contradiction<double>& contradiction, IslandReport& report);
/// Derivatives of islands that SIMD batches serve (IslandWork::served_in_lanes) into w.derivatives, and products with
/// them: jvp or vjp of the kernels, whose vectors are as lanes::ProductJob has them.
void differentiate_alone(const Scene& scene, SceneData& data);
using ProductInLanes = void (lanes::RobotBlocks::*)(const lanes::ProductJob&, std::span<lanes::RobotBlocks::Robot>);
void multiply_alone(const Scene& scene, SceneData& data, ProductInLanes product, const std::array<const double*, 3>& in,
                    const std::array<double*, 3>& out);

/// Makes island.robots->derivatives for `out`, which is laid out, where robot by robot is predicted to be cheaper than
/// by the factor of the whole K.
void prepare_robots_derivatives(const Scene& scene, IslandWork& island, const IslandDerivatives& out, Workspace& work);
/// Whether it is; but for that the way may turn out not to be sound.
bool differentiates_by_robots(const IslandWork& island);

/// The job of SIMD batches at the current state, and what they take of its solution.
lanes::Job job_at_state(const Scene& scene, SceneData& data);
lanes::Solution solution_of(const Scene& scene, const SceneData& data);

/// The componentwise backward error (sparse/refine.hpp) of the interface rows, of their b and y and the robots'
/// borders; NaN where any is.
double interface_error(double damping, RobotsSystem& robots);

}  // namespace internal

}  // namespace manycontact
