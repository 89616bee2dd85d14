#pragma once
// Derivatives of an island robot by robot, by the factors that solved it; interface.hpp defines the matrices. With T_r
// = K_r^-1 G_r^T and S = sum_r G_r T_r + delta I, the solution of K X = B is
//
//     S Y = sum_r G_r K_r^-1 B_r - B_joining,    X_r = K_r^-1 B_r - T_r Y,    X_joining = Y.
//
// The panel contains forces -X, so -Y is in its interface rows, where products read it. Most robots' rows of a column
// of B are zero: X_r = -T_r Y is then a product with few rows, instead of a solve with the island's factor.
//
// A contact that couples A and B acts only on their bodies, by E_r: six columns of forces on robot r's body. So G_r^T =
// E_r W^T and B_r = own columns + E_r D_r, where D_r (six rows) also has columns of the other robot's coordinates. SIMD
// batches solve only K_r^-1 [E_r, columns of the robot's own coordinates].

#include <optional>

#include "../../workspace/threads.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact {

/// Derivatives of islands of one shape, for one request at a time.
struct RobotsDerivatives {
  static constexpr int kChunk = 192;  // columns of X processed at a time, to stay in cache

  explicit RobotsDerivatives(const IslandShape& shape, const RobotsSystem& system);

  struct Columns {  // A block of columns of X, and its place in a robot's panel.
    int in_X, in_P, count;
  };
  struct OfRobot {
    int nv = 0;
    std::vector<int> row, join;  // one entry per row of K_r and of G_r: the island's row; constant
    std::vector<double> ends;    // ends of its coupling contacts: MovingEnd, then EndForce
    // set for the request
    int q_first = 0, v_first = 0, u_first = 0, own = 0;  // columns of the panel, as in lanes::DerivativeJob
    std::vector<Columns> columns;                        // columns where B_r is not zero
    std::vector<Columns> sampled;                        // columns of the sample, in its panel
    std::vector<lanes::Sampled> copied;                  // sampled columns that SIMD batches copy
    int ld = 0;                                          // leading dimension of P and H
    AlignedPanel P;                                      // K_r^-1 [E_r, B_r], with forces f, not -f
    std::vector<double> G;                               // G_r^T, nv x padded
    std::vector<double> H;                               // G_r P
    std::vector<double> T;     // T_r^T in rows of accelerations, -T_r^T in rows of forces; by rows of G_r, padded
    std::vector<double> B;     // sampled columns of B_r, one after the other
    std::vector<double> x;     // one column of the solution, and zeros behind it
    std::vector<double> left;  // interface rows per column: the robot's part of the residual, and of its scale
    double error = 0;          // largest backward error of these columns in the robot's rows

    int size() const { return static_cast<int>(row.size()); }
    int padded() const { return sparse::padded(static_cast<std::ptrdiff_t>(join.size())); }
  };
  std::vector<OfRobot> robots;

  std::optional<DerivativeRequest> request;  // the request that the layout is for
  bool cheaper[2] = {};  // whether cheaper than the island's factor: [0] without dropped rows, [1] with
  bool has_room = false;

  std::vector<double> terms;    // lanes::JoinTerms of the coupling contacts
  std::vector<std::size_t> at;  // one entry per coupling contact: its offset in `terms`
  std::vector<int> eliminated;  // one entry per interface row, in the order of S: the island's row
  std::vector<double> D;        // D of the factor of S
  struct Sample {               // a column per robot, checked with the island's K
    std::vector<int> column;    // columns of X
    AlignedPanel X;
    std::vector<double> b;    // right-hand sides of the interface rows, column after column
    double robots_error = 0;  // largest error in the robots' rows, the only ones that refinement improves
  } sample;
  struct Buffers {              // memory of a thread
    std::vector<double> work;   // scratch of a solve with S
    std::vector<char> nonzero;  // one flag per row of S
    std::vector<double> E, ED;  // columns E of a panel, stored as rows; K_r^-1 E D
  };
  std::vector<Buffers> buffers;
};

}  // namespace manycontact

namespace manycontact::internal {

// Iteration over the batches of an island's robots.

/// Calls step(kernel, robots, their memory, thread's memory) for each batch. A thread always has the same batches, in
/// alternating direction, as the last ones are still cached. of_solve: work of all steps together relative to a solve.
template <class Step>
void each_batch(Workspace& w, RobotsSystem& system, double of_solve, Step&& step) {
  system.back = !system.back;
  const std::size_t count = system.batches.size(), threads = w.threads.size();
  const auto item = [&](std::size_t k) -> const RobotsSystem::Batch& {
    const std::size_t first = k % threads, last = first + (count - 1 - first) / threads * threads;
    return system.batches[system.back ? last - (k - first) : k];
  };
  each_item(w, count, are_worth_threads(w, of_solve * system.seconds), [&](std::size_t k, ThreadWork& thread) {
    const RobotsSystem::Batch& batch = item(k);
    const std::size_t next = k + threads;  // next item of the same thread
    double* memory = system.memory.data();
    const std::span<RobotsSystem::Robot> robots = std::span(system.members).subspan(batch.first, batch.count);
    const lanes::RobotBlocks::Memory at{memory + batch.at, memory + (next < count ? item(next) : batch).at};
    step(batch.group->kernels[thread.number].of(robots.size()), robots, at, thread);
  });
}

template <class Step>
void each_batch(Workspace& w, RobotsSystem& system, Step&& step) {
  each_batch(w, system, costs::kWalk, std::forward<Step>(step));
}

}  // namespace manycontact::internal
