#pragma once
// An island solved robot by robot, in lanes. In the notation of joining.hpp, with b = [b_1; ...; b_n; c]:
//
//     x_r  = K_r^-1 (b_r - G_r^T y),    S y = sum_r G_r K_r^-1 b_r - c.
//
// A robot's terms, its part of K, the factor of K_r with the rows of G_r below it, and its part of S are one step after
// the other while they are in the cache, of as many robots as stand side by side; likewise back. The answer is refined
// and judged with the island's K as that of its factor is.

#include "joining.hpp"
#include "lanes/cut.hpp"
#include "manycontact/sparse/memory.hpp"
#include "workspace.hpp"

namespace manycontact {

/// Of an island, where that is predicted to be cheaper than its factor.
struct CutIsland {
  using Robot = lanes::CutRobots::Robot;
  struct Batch {  // robots side by side: numbers of `order`
    CutGroup* group;
    int first, count;
    std::size_t at;  // in `memory`
  };
  struct ContactBatch {  // likewise, of `contacts`
    lanes::TermGroups::Contacts* group;
    int first, count;
  };
  struct Joint {  // a contact that joins robots
    lanes::TermGroups::Contacts* group;
    int contact;             // of the scene
    int row, rows;           // the first of its joining rows, and how many
    int A, B;                // robots of the island
    std::size_t at_A, at_B;  // in their `joins`
    double smallest_row, motion;
  };
  struct OfRobot {
    CutGroup* group;
    std::vector<int> contacts;  // on it alone, of the scene
    int member;                 // of `members`: its place in `order`
  };

  std::shared_ptr<const Joining> joining;
  std::vector<int> order;  // robots of the island, group by group
  std::vector<OfRobot> robots;
  // by prepare, for the island at hand
  std::vector<Joint> contacts;  // group by group, like ones together
  std::vector<Robot> members;   // as `order`; filled by solve
  Robot& member(std::size_t robot) { return members[robots[robot].member]; }
  const Robot& member(std::size_t robot) const { return members[robots[robot].member]; }
  // by solve
  std::vector<Batch> batches;
  std::vector<ContactBatch> contact_batches;
  std::uint64_t serial = 0;                  // of the solution that all of this is of
  bool terms_known = false;                  // robots and contacts are evaluated at the solution
  bool back = false;                         // the way the last step took through the batches
  sparse::LargeMemory memory;                // of the batches and their robots
  std::vector<double> Sx, L, D, terms;       // -S and its factor, in its order
  std::vector<double> b, y, r, scale, step;  // of the joining rows
};

namespace internal {

/// For each island that several robots share: makes island.cut where it is cheaper, and settles it on this island.
/// Allocates nothing for a contact set met before.
void prepare_cut(const Scene& scene, Workspace& work);
/// Solves these islands, at w.q, data.v, data.tau. Those that come out unsound are left as they were.
void solve_cut(const Scene& scene, SceneData& data);
/// Whether an island's answer is from there, and its numbers are those of the solution at hand: products go by them,
/// after complete_cut too.
inline bool solved_cut(const SceneData& data, const IslandWork& d) { return d.cut && d.cut->serial == data.serial; }
/// [a; -f] <- K^-1 [a; -f] of such an island, refined once, in the scene's coordinates.
void solve_once_refined_cut(const Scene& scene, SceneData& data, IslandWork& d, Eigen::VectorXd& a, Eigen::VectorXd& f);
/// Of robot k of such an island: K_r into K.values, and its factor, which has no border. K has the pattern of the robot
/// alone, in the island's order.
void take_factor_of_robot(const CutIsland& cut, std::size_t k, KktMatrix& K, Factor& factor);
/// Kinematics and contact rows of these islands, at w.q, data.v.
void evaluate_cut(const Scene& scene, const SceneData& data);
/// K and factor of the islands that were solved so, as if they had been solved by their factor.
void complete_cut(const Scene& scene, const SceneData& data);

}  // namespace internal

}  // namespace manycontact
