#pragma once
// Solves islands by sparse-ldl, robot by robot in SIMD batches. The interface rows are the rows of contacts between two
// robots. K has the blocks K_r and G_r (interface.hpp), b has the parts b_r of robot r and c of the interface rows, and
// the solution of K x = b has the parts x_r and y:
//
//     x_r  = K_r^-1 (b_r - G_r^T y),    S y = sum_r G_r K_r^-1 b_r - c.
//
// A first pass over the SIMD batches computes K_r, its factor and its part of the Schur complement S; a second pass
// computes x_r. The solution is refined and checked with the island's K. A single-robot island has no y.

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

struct BlockGroup {  // robots that share a BlockPlan; a group without robots is kept for later contact sets
  std::shared_ptr<const lanes::BlockPlan> plan;
  std::vector<lanes::OneOrBatch<lanes::RobotBlocks>> kernels;  // double precision, one entry per thread
  std::vector<lanes::OneOrBatch<lanes::SingleBlocks>> single;  // single precision; empty unless options request it
  std::vector<int> islands;                                    // scratch of a call: islands to solve with this plan
  double seconds = 0;                                          // predicted time of a solve of one robot [s]
};

struct InterfaceContactGroup {  // contacts that couple two robots, and differ only in placements and gains
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
  const simd::Level* level = nullptr;  // instruction level; nullptr: no SIMD batches
  std::map<std::pair<const ModelStructure*, std::vector<int>>, BlockGroup> groups;  // keys are made by group_of
  std::map<InterfaceContactGroup::Key, InterfaceContactGroup> contacts;
  // scratch of solve_alone and differentiate_alone: the islands and robots of the call, batch after batch
  struct Batch {
    BlockGroup* group;
    int first, count;  // range in `islands` and `robots`
  };
  std::vector<int> islands;
  std::vector<lanes::RobotBlocks::Robot> robots;
  std::vector<Batch> batches;
};

struct BatchPlace {  // how SIMD batches solve a single-robot island: all in one call of solve_alone (alone.cpp)
  BlockGroup* group = nullptr;  // set by prepare; nullptr: no SIMD batch can solve the island
  // set when a SIMD batch has solved the island
  bool panel_is_safe = false;  // whether the batch may compute derivatives too
  bool refine_panel = false;   // whether the batch refines the derivatives once
};

class RobotsSystem final : public IslandSystem {  // solves an island of several robots
 public:
  explicit RobotsSystem(IslandWork& island);
  ~RobotsSystem() override;

  /// Returns false, among other cases, if rows of contacts between two robots are redundant.
  bool solve(const Scene&, SceneData&, ThreadWork&, IslandReport&) override;
  bool differentiate(const Scene&, SceneData&, ThreadWork&, IslandDerivatives&) override;
  bool jvp(const Scene&, SceneData&, ThreadWork&, const TangentProduct&) override;
  bool vjp(const Scene&, SceneData&, ThreadWork&, const AdjointProduct&) override;
  bool invert(const Scene&, SceneData&, ThreadWork&, ProductWork&) override;

  bool factorize(const Scene& scene, SceneData& data);  // computes b, K_r, S, factors; false if a pivot is unsound
  bool rows_depend() const;                             // whether `factorize` found dependent rows in any robot's K_r
  double growth() const;  // growth of K's entries in the factors of all K_r and S (Factor::growth)

  IslandWork& owner;
  using Robot = lanes::RobotBlocks::Robot;
  struct Batch {  // a SIMD batch of robots: a range of `order`
    BlockGroup* group;
    int first, count;
    std::size_t at;  // offset of the batch's numbers in `memory`
  };
  struct ContactBatch {  // a SIMD batch of coupling contacts: a range of `contacts`
    InterfaceContactGroup* group;
    int first, count;
  };
  struct Coupling {  // a contact that couples robots
    InterfaceContactGroup* group;
    int contact;           // the contact's number in the scene
    int number;            // the contact's number in the island
    int row, rows;         // the contact's first interface row, and its number of rows
    int A, B;              // the coupled robots' numbers in the island
    int among_A, among_B;  // the contact's index in the coupling contacts of robots A and B
    double smallest_row, motion;  // size of J's smallest row; size by which it is judged
  };
  struct OfRobot {
    BlockGroup* group;
    std::vector<int> contacts = {};   // contacts on this robot alone, as numbered in the scene
    int member = 0;                   // index in RobotsSystem::members
    std::vector<int> couplings = {};  // indices in RobotsSystem::contacts of contacts that couple this robot
  };

  std::shared_ptr<const Interface> interface;
  bool solves = false;                // whether this system solves first: predicted to be cheaper than factorizing K
  bool refused = false;               // whether the last solve had unsound pivots
  double seconds = 0;                 // predicted time of a solve [s]
  Order within = Order::kLeafToRoot;  // elimination order of each robot
  std::vector<int> order;             // robots of the island, group by group
  std::vector<OfRobot> robots;
  bool contradiction = false;  // whether contacts were inconsistent in the last solve; MatrixSystem differentiates then
  // set by prepare, for the current island
  std::vector<Coupling> contacts;  // sorted; those that can share a SIMD batch are adjacent
  std::vector<Robot> members;      // robots in the order of `order`; filled by solve
  Robot& member(std::size_t robot) { return members[robots[robot].member]; }
  const Robot& member(std::size_t robot) const { return members[robots[robot].member]; }
  // set by factorize
  std::vector<Batch> batches;
  std::vector<ContactBatch> contact_batches;
  std::uint64_t state = 0;                         // state of the batches and their factors; 0: not sound
  double first_error = 0;                          // backward error of the solution before refinement
  bool back = false;                               // whether the last each_batch visited the batches from last to first
  sparse::LargeMemory memory;                      // numbers of the batches: K, its factors, vectors
  std::vector<double> Sx, L, D, terms;             // -S, its factor, magnitudes of pivot terms; in elimination order
  std::vector<double> b, y, r, scale, step;        // right-hand side, solution etc. of interface rows
  std::unique_ptr<RobotsDerivatives> derivatives;  // constructed when first needed
};

namespace internal {

/// Returns the predicted cost of a SIMD batch of `count` robots, relative to that of one robot.
inline double together(std::size_t count) { return count > 1 ? 1 + costs::kTogether * static_cast<double>(count) : 1; }

/// Prepares an island of a new shape for SIMD batches: sets `alone.group` if it has one robot, otherwise
/// `robots` if solving robot by robot is predicted cheaper than factorizing K.
void plan_robots(const Scene& scene, Workspace& work, IslandWork& island);
/// Assigns the island's robots and contacts to the plan of its shape. Does not allocate for a contact set used before.
void bind_robots(const Scene& scene, Workspace& work, IslandWork& island);
void group_robots_alone(Workspace& work);    // groups the current single-robot islands into SIMD batches
void forget_unused_groups(Workspace& work);  // frees groups that no current or pooled island uses
/// Constructs island.robots if the island may be solved robot by robot (IslandWork::joinable).
void make_robots(const Scene& scene, Workspace& work, IslandWork& island);

/// Solves all unsolved single-robot islands in SIMD batches at w.q, data.v, data.tau, first in single precision if
/// options request it. start: start of a simulation step, if any; data.tau then excludes the step's forces.
void solve_alone(const Scene& scene, SceneData& data, const StartOfStep* start = nullptr);
bool stand_alone(const Scene& scene, const Workspace& w);  // whether batches of doubles solve all islands (lone robots)
int batch_width(const Workspace& w);  // the most single robots, or states, in a SIMD batch; 1 without batches
/// Sets the status, reason, rank and dependent_rows of a report from the dependent rows of the island's J.
void report_dependent_rows(const Scene& scene, const SceneData& data, IslandWork& island, std::span<const int> rows,
                           const rank::Contradiction<double>& contradiction, IslandReport& report);
void differentiate_alone(const Scene& scene, SceneData& data);  // all islands with served_in_lanes, in w.derivatives
/// Computes jvp or vjp (`product`) of all islands with IslandWork::served_in_lanes. in, out: as in lanes::ProductJob.
using ProductInLanes = void (lanes::RobotBlocks::*)(const lanes::ProductJob&, std::span<lanes::RobotBlocks::Robot>);
void multiply_alone(const Scene& scene, SceneData& data, ProductInLanes product, const std::array<const double*, 3>& in,
                    const std::array<double*, 3>& out);

/// Allocates island.robots->derivatives for `out` if derivatives robot by robot are predicted cheaper than by K.
void prepare_robots_derivatives(const Scene& scene, IslandWork& island, const IslandDerivatives& out, Workspace& work);
bool differentiates_by_robots(const IslandWork& island);  // whether robot by robot is tried first, as predicted cheaper

/// Return the inputs of SIMD batches for a solve at the current state, and for derivatives at the current solution.
lanes::Job job_at_state(const Scene& scene, SceneData& data);
lanes::Solution solution_of(const Scene& scene, const SceneData& data);

/// Returns the componentwise backward error of the interface rows, or NaN, from b, y and each robot's -G_r x_r.
double interface_error(double damping, RobotsSystem& robots);

}  // namespace internal

}  // namespace manycontact
