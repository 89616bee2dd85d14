#pragma once
// Derivatives of an island robot by robot, of which joining.hpp has the matrices.
// With T_r = K_r^-1 G_r^T and S = sum_r G_r T_r + delta I, the answer to K X = B is
//
//     S Y = sum_r G_r K_r^-1 B_r - B_joining,    X_r = K_r^-1 B_r - T_r Y,    X_joining = Y.
//
// Forces come out with their own sign, -X; so -Y stands in the joining rows of the panel, and the products take it
// there. A column of B is zero in the rows of most robots. There X_r is -T_r Y alone, a product of as few terms as rows
// join the robot, in place of a solve with the island's factor.

#include "joining.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "workspace.hpp"

namespace manycontact {

/// Of an island's shape, and for one request at a time.
struct ByRobots {
  static constexpr int kChunk = 192;  // columns of X worked at a time, which stay in the cache

  /// order: of elimination, of the K_r. shapes: where their patterns are met again.
  ByRobots(const IslandShape& shape, Order order, std::shared_ptr<const Joining> joining, ShapeCache& shapes);

  struct Columns {  // A block of columns of X, and where it stands in a robot's panel.
    int in_X, in_P, count;
  };
  struct OfRobot : Joining::OfRobot {
    explicit OfRobot(const Joining::OfRobot& r) : Joining::OfRobot(r) {}
    std::vector<int> row, join;  // per row of K_r and of G_r: the island's row; constant
    // for the request
    std::vector<Columns> columns;  // where B_r is not zero
    std::vector<Columns> sampled;  // those of the sample, in its panel
    int ld = 0;                    // of P and H
    // numbers
    KktMatrix K;
    std::unique_ptr<Factor> factor;
    std::vector<std::span<const double>> J;
    std::vector<double> G;      // G_r^T, nv x padded
    std::vector<double> P;      // [G_r^T, B_r], then [T_r, K_r^-1 B_r]
    std::vector<double> H;      // G_r P
    std::vector<double> T;      // T_r^T where accelerations come out, -T_r^T where forces do; by rows of G_r, padded
    std::vector<char> nonzero;  // a flag per row of K_r
    bool sound = false;         // K_r's pivots are

    int size() const { return static_cast<int>(row.size()); }
    int padded() const { return sparse::padded(static_cast<std::ptrdiff_t>(joining.size())); }
  };
  std::vector<OfRobot> robots;
  std::shared_ptr<const Joining> joining;
  bool compiled = true;  // all schedules are there

  bool laid_out = false;  // for `request`
  DerivativeRequest request;
  bool cheaper = false;  // than the island's factor, for that

  std::vector<int> eliminated;  // per joining row, in the order of S: the island's row
  std::vector<double> Sx, L, D, scale;
  struct Sample {             // a column of each robot's, to be judged with the island's K
    std::vector<int> column;  // of X
    AlignedPanel X;
    std::vector<double> b, error;  // b: in K's order, column after column
  } sample;
  struct Buffers {              // of a thread
    std::vector<double> work;   // of a solve with S
    std::vector<char> nonzero;  // of S
    std::vector<double> x, r, scale;
  };
  std::vector<Buffers> buffers;
};

namespace internal {

/// Makes island.by_robots for `out`, which is laid out, where robot by robot is predicted to be cheaper than by the
/// factor at hand.
void prepare_by_robots(IslandWork& island, const IslandDerivatives& out, Workspace& work);
/// Whether it is; but for that the way may turn out not to be sound. Where the island was solved robot by robot, by the
/// factors that are there then, without one of its own.
inline bool goes_by_robots(const IslandWork& d) {
  return d.by_robots && d.by_robots->cheaper && (d.factor ? d.factor == d.chosen.get() : d.in_lanes && d.cut);
}

/// All of an island's derivatives into `out`, robot by robot, after derivative_terms. False where that is not sound:
/// then X is not known, and another way has to answer.
bool differentiate_by_robots(const Scene& scene, SceneData& data, IslandWork& island, IslandDerivatives& out);

}  // namespace internal

}  // namespace manycontact
