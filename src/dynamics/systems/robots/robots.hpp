#pragma once
// Islands solved by sparse-ldl robot by robot, in lanes: of one robot, or of several that few rows join. In the
// notation of joining.hpp, with b = [b_1; ...; b_n; c]:
//
//     x_r  = K_r^-1 (b_r - G_r^T y),    S y = sum_r G_r K_r^-1 b_r - c.
//
// A robot's terms, its part of K, the factor of K_r with the rows of G_r below it, and its part of S are one step after
// the other while they are in the cache, of as many robots as stand side by side; likewise back. The answer is refined
// and judged with the island's K as that of its factor is. Of a robot alone there are no y.

#include <map>

#include "../../lanes/lanes.hpp"
#include "joining.hpp"
#include "manycontact/sparse/memory.hpp"

namespace manycontact {

struct IslandWork;
struct ThreadWork;

/// Robots of one plan. It stays when they are gone, for contact sets to come.
struct BlockGroup {
  std::shared_ptr<const lanes::BlockPlan> plan;
  std::vector<std::unique_ptr<lanes::RobotBlocks>> kernels;  // one per thread
  std::vector<int> islands;                                  // of robots alone: their numbers, ascending
};

/// Contacts that join two robots, alike but for places and gains.
struct JoiningGroup {
  struct Key {  // what their kernels are made for
    const Model *A, *B;
    ContactType type;
    int joint_A, joint_B;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<std::unique_ptr<lanes::JoiningContacts>> kernels;  // one per thread
};

/// By prepare: who stands in lanes.
struct InLanes {
  const lanes::Level* level = nullptr;                                     // nullptr: nobody
  std::map<std::pair<const Model*, std::vector<int>>, BlockGroup> groups;  // by what plans depend on
  std::map<JoiningGroup::Key, JoiningGroup> contacts;
  // scratch of a call: the islands it is about, those that stand side by side one after the other
  struct Batch {
    const BlockGroup* group;
    int first, count;  // of islands and robots
  };
  std::vector<int> islands;
  std::vector<lanes::RobotBlocks::Robot> robots;
  std::vector<Batch> batches;
};

/// Of an island of several robots, where that is possible.
struct JoinedRobots {
  using Robot = lanes::RobotBlocks::Robot;
  struct Batch {  // robots side by side: numbers of `order`
    BlockGroup* group;
    int first, count;
    std::size_t at;  // in `memory`
  };
  struct ContactBatch {  // likewise, of `contacts`
    JoiningGroup* group;
    int first, count;
  };
  struct Joint {  // a contact that joins robots
    JoiningGroup* group;
    int contact;           // of the scene
    int number;            // of the island
    int row, rows;         // the first of its joining rows, and how many
    int A, B;              // robots of the island
    int among_A, among_B;  // their joins
    double smallest_row, motion;
  };
  struct OfRobot {
    BlockGroup* group;
    std::vector<int> contacts;     // on it alone, of the scene
    int member;                    // of `members`: its place in `order`
    std::vector<int> joints = {};  // of `contacts`: those that join it, in the order of its joins
  };

  std::shared_ptr<const Joining> joining;
  bool solves = false;     // it is the island's first way: predicted to be cheaper than its factor
  std::vector<int> order;  // robots of the island, group by group
  std::vector<OfRobot> robots;
  // by prepare, for the island at hand
  std::vector<Joint> contacts;  // group by group, like ones together
  std::vector<Robot> members;   // as `order`; filled by solve
  Robot& member(std::size_t robot) { return members[robots[robot].member]; }
  const Robot& member(std::size_t robot) const { return members[robots[robot].member]; }
  // by factorize_joined
  std::vector<Batch> batches;
  std::vector<ContactBatch> contact_batches;
  std::uint64_t serial = 0;                  // of the solution that all of this is of
  bool terms_known = false;                  // robots and contacts are evaluated at the solution, too
  bool back = false;                         // the way the last step took through the batches
  sparse::LargeMemory memory;                // of the batches and their robots
  std::vector<double> Sx, L, D, terms;       // -S and its factor, in its order
  std::vector<double> b, y, r, scale, step;  // of the joining rows
};

struct SceneData;
struct Workspace;
struct IslandReport;

namespace internal {

/// Sorts the islands at hand into groups, makes what those of several robots need where that is cheaper than their
/// factor, and settles it on the islands. Allocates nothing for a contact set met before.
void prepare_robots(const Scene& scene, Workspace& work);
/// island.joined, settled, where that is possible; made when first asked for.
void make_joined(const Scene& scene, Workspace& work, IslandWork& island);

/// Solves the islands of one robot, and those of several, at w.q, data.v, data.tau. Those that come out unsound are
/// left as they were.
void solve_alone(const Scene& scene, SceneData& data);
void solve_joined(const Scene& scene, SceneData& data);

/// Derivatives of robots alone whose answer came from a lane into w.derivatives, and products with them, where that is
/// safe (IslandWork::served_in_lanes). Vectors in the scene's coordinates, as in jvp.hpp.
void differentiate_in_lanes(const Scene& scene, SceneData& data);
void jvp_in_lanes(const Scene& scene, SceneData& data, const double* dq, const double* dv, const double* du, double* da,
                  double* df);
void vjp_in_lanes(const Scene& scene, SceneData& data, const double* wa, const double* wf, double* wq, double* wv,
                  double* wu);

/// Whether the answer of an island of several robots is from there: products go by it, after complete_joined too.
bool solved_joined(const SceneData& data, const IslandWork& d);
/// The factors of an island's robots and of the joining rows, and the right-hand side; false where these are not sound.
bool factorize_joined(const lanes::Job& job, SceneData& data, IslandWork& d);
/// Growth of K's entries in these factors, as Factor has it.
double growth_of(const JoinedRobots& joined);
/// [a; -f] <- K^-1 [a; -f] of such an island, refined once, in the scene's coordinates.
void solve_once_refined_joined(const Scene& scene, SceneData& data, IslandWork& d, Eigen::VectorXd& a,
                               Eigen::VectorXd& f);
/// The componentwise backward error (sparse/refine.hpp) of the joining rows, of their b and y and the robots' borders;
/// NaN where any is.
double joining_error(double damping, JoinedRobots& joined);

/// Kinematics and contact rows of these islands, at w.q, data.v.
void evaluate_joined(const Scene& scene, const SceneData& data);

}  // namespace internal

}  // namespace manycontact
