#pragma once
// Many states of one scene: solved, differentiated, pulled back, in several threads.
//
//   BatchData batch(scene);                                   // a SceneData per thread
//   solve_batch(scene, {Q, V, U}, batch, A, F, status);       // row k of A, F: the answer at row k of Q, V, U
//
// A state's numbers depend on that state alone: neither on the others, nor on the number of threads, nor on which of
// them solved it. They are those of new SceneData, bit by bit.

#include <memory>
#include <span>
#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// One state per row. Views: blocks of a wider row-major matrix do as well.
using BatchMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstBatchRows = Eigen::Ref<const BatchMatrix, 0, Eigen::OuterStride<>>;
using BatchRows = Eigen::Ref<BatchMatrix, 0, Eigen::OuterStride<>>;

/// As many rows each: configurations (scene.nq), velocities (nv), torques of the actuated coordinates (nu).
struct BatchStates {
  ConstBatchRows q, v, u;
};

struct BatchCopies;  // private to floor dynamics
namespace internal {
struct Failure;
}

/// The memory of the threads. Where the robots of one state do not fill the SIMD lanes, several states are solved side
/// by side: as one scene of as many copies as there are lanes. A second call with as many states allocates nothing in
/// them, by the methods and where `solve` and `differentiate` do not.
struct BatchData {
  /// threads: 0, as many as OpenMP would take (one where the library was built without OpenMP).
  explicit BatchData(const Scene& scene, int threads = 0, const Options& options = {});

  // the caller's, between calls
  Options options;                   // but for its `threads`: a state is one thread's
  std::vector<char> active;          // one per contact: as the scene has it at first
  std::vector<Vec6<double>> pushes;  // one per push: its wrench, in all states; as the scene has it at first

  struct Thread {  // One thread's memory.
    SceneData data;
    std::shared_ptr<BatchCopies> copies = nullptr;  // made when first needed
  };
  std::vector<Thread> threads;
  std::shared_ptr<std::vector<internal::Failure>> failures;  // scratch: what went wrong in each
};

/// BatchRows of the active contacts: the size of a state's forces.
int force_rows(const Scene& scene, const BatchData& batch);

// All: states of failed islands give NaN for these islands, and the state's status is kFailed; the others are
// solved all the same. `status` has one entry per state. Throw std::invalid_argument when a size does not fit or the
// data are of another scene, before anything is computed; std::bad_alloc, also from a thread: then outputs are as they
// come. OpenBLAS is held to one thread meanwhile, in the whole program; one batch at a time.

/// A (nv columns) and F (force_rows): accelerations and contact forces, as `solve`.
void solve_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                 std::span<Status> status);

/// The same, and in each row of D the derivatives of [a; f] with respect to [q v u], a row-major matrix of
/// (nv + force_rows) x (2 nv + nu) numbers in the scene's order. (Large scenes: `differentiate` has blocks per island.)
void differentiate_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                         BatchRows D, std::span<Status> status);

/// WQ (nv), WV (nv), WU (nu): rows of WA (nv) and WF (force_rows) times the derivatives of a and f at each state, as
/// `vjp`. Each state is solved for that.
void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, std::span<Status> status);

/// The same, and WW (6 per push) by the wrenches of pushes, in the axes that these are stated in.
void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, BatchRows WW, std::span<Status> status);

}  // namespace manycontact
