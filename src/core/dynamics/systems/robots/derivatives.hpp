#pragma once
// Computes derivatives of an island robot by robot with the factors of its solve. K_r is the block of robot r and the
// contacts on it alone; G_r are the entries of coupling contacts at its velocities (interface.hpp).
// With T_r = K_r^-1 G_r^T and S = sum_r G_r T_r + delta I, the solution of K X = B is
//
//     S Y = sum_r G_r K_r^-1 B_r - B_joining,    X_r = K_r^-1 B_r - T_r Y,    X_joining = Y.
//
// The panel of derivatives contains forces f = -X, so its interface rows contain -Y. A column of B is zero in the rows
// of most robots. For these, X_r = -T_r Y is a product with few rows, instead of a solve with the factor of K.
//
// A contact that couples two robots acts on one body of robot r. E_r contains six unit forces on this body: G_r^T = E_r
// W^T, W the contact's force basis. B_r has the robot's own columns (with respect to its q, v, u) and E_r D_r; D_r is
// the change of the contact's force with q of both robots. SIMD batches solve only K_r^-1 [E_r, own columns].

#include <optional>

#include "../../workspace/threads.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact {

/// Derivatives of islands of one shape, for one request at a time.
struct RobotsDerivatives {
  static constexpr int kChunk = 192;  // columns of X processed at a time, to stay in cache

  explicit RobotsDerivatives(const IslandShape& shape, const RobotsSystem& system);

  struct Columns {  // a block of adjacent columns: its first column in X and in a robot's panel P
    int in_X, in_P, count;
  };
  struct OfRobot {
    int nv = 0;
    std::vector<int> row, join;  // the island's row of each row of K_r and of G_r; constant
    std::vector<double> ends;    // one MovingEnd per coupling contact, later EndForce in its place (lanes/block.hpp)
    // set for the requested derivatives
    int q_first = 0, v_first = 0, u_first = 0, own = 0;  // first columns in P for q, v, u; number of own columns
    std::vector<Columns> columns;                        // columns where B_r is not zero
    std::vector<Columns> sampled;                        // sampled columns where B_r is not zero; in_X: in Sample::X
    std::vector<lanes::Sampled> copied;                  // right-hand sides of the sample that SIMD batches write to B
    int ld = 0;                                          // leading dimension of P and H
    AlignedPanel P;                                      // K_r^-1 [E_r, B_r], with forces f, not -f
    std::vector<double> G;                               // G_r^T, nv x padded()
    std::vector<double> H;                               // G_r P, padded() x ld
    std::vector<double> T;     // T_r^T, one padded row per row of G_r; entries of force rows of T_r have opposite sign
    std::vector<double> B;     // sampled columns of B_r, one after the other
    std::vector<double> x;     // scratch: one column of X_r, and as many zeros
    std::vector<double> left;  // -G_r x and |G_r| |x|, x each sampled column of X_r
    double error = 0;          // largest backward error of the sampled columns in the rows of K_r

    int size() const { return static_cast<int>(row.size()); }
    int padded() const { return sparse::padded(static_cast<std::ptrdiff_t>(join.size())); }
  };
  std::vector<OfRobot> robots;

  std::optional<DerivativeRequest> request;  // the request for which the members are allocated
  bool cheaper[2] = {};  // whether cheaper than derivatives by K: [0] J has full row rank, [1] dependent rows
  bool has_room = false;

  std::vector<double> terms;    // lanes::JoinTerms of the coupling contacts
  std::vector<std::size_t> at;  // one entry per coupling contact: its offset in `terms`
  std::vector<int> eliminated;  // one entry per interface row, in the order of S: the island's row
  std::vector<double> D;        // the diagonal D of S = L D L^T
  struct Sample {               // columns of the panel whose backward error is computed
    std::vector<int> column;    // numbers of the sampled columns in the island's panel
    AlignedPanel X;             // the solutions, one column per entry of `column`
    std::vector<double> b;    // right-hand sides of the interface rows, column after column
    double robots_error = 0;  // largest backward error in the robots' rows, the only ones that refinement improves
  } sample;
  struct Buffers {              // scratch memory of a thread
    std::vector<double> work;   // scratch of a solve with S
    std::vector<char> nonzero;  // one flag per row of S
    std::vector<double> E, ED;  // K_r^-1 E_r of a contact, transposed; K_r^-1 E_r D_r
  };
  std::vector<Buffers> buffers;
};

}  // namespace manycontact

namespace manycontact::internal {

/// Calls step(kernel, robots, their memory, thread's memory) for each SIMD batch. Each call of each_batch reverses the
/// order, as the last batches are still in cache; a thread always has the same batches. of_solve: work of a
/// step relative to a solve.
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
