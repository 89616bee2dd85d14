#pragma once
// Solves many states of one scene in several threads, also with derivatives and vector-Jacobian products.
//
//     BatchData batch(scene);                                   // a SceneData per thread
//     solve_batch(scene, {Q, V, U}, batch, A, F, status);       // row k of A, F: the solution at row k of Q, V, U
//
// The result of a state depends on that state alone. It is bitwise independent of the other states, of the number of
// threads, and of the thread that solved it, and equal to the result with a new SceneData.

#include <memory>
#include <span>
#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Matrices with one state per row. They are views, so blocks of a wider row-major matrix may be passed.
using BatchMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstBatchRows = Eigen::Ref<const BatchMatrix, 0, Eigen::OuterStride<>>;
using BatchRows = Eigen::Ref<BatchMatrix, 0, Eigen::OuterStride<>>;

/// Configurations q (scene.nq columns), velocities v (nv columns) and torques u of the actuated coordinates (nu
/// columns). The three matrices have equally many rows. Units and frames are those of `solve`.
struct BatchStates {
  ConstBatchRows q, v, u;
};

struct BatchCopies;  // private to the module dynamics
namespace internal {
struct Failure;
}

/// The memory of the threads of a batch. If the robots of one state do not fill a SIMD batch, several states are solved
/// together, as one scene with one copy per SIMD element. Threads do not allocate in a second call with as many states,
/// under the conditions stated at `solve` and `differentiate`. A BatchData belongs to the scene it was made for. Only
/// one batch function may use it at a time.
struct BatchData {
  /// threads: number of threads. 0 takes OpenMP's number, or one if the library was built without OpenMP. Throws
  /// std::invalid_argument if a number of threads is negative or above kMostThreads.
  explicit BatchData(const Scene& scene, int threads = 0, const Options& options = {});

  // These members are set by the caller, between calls.
  Options options;                   // Options::threads is ignored: each state is solved by one thread.
  std::vector<char> active;          // one flag per contact; initially as in the scene
  std::vector<Vec6<double>> wrenches;  // the external wrenches, the same in all states; initially the scene's [N, N m]

  struct Thread {  // The memory of one thread.
    SceneData data;
    std::shared_ptr<BatchCopies> copies = nullptr;  // created when first needed
  };
  std::vector<Thread> threads;
  std::shared_ptr<std::vector<internal::Failure>> failures;  // workspace: one exception per thread
};

/// Returns the number of constraint rows of the active contacts, which is the number of columns of F.
int force_rows(const Scene& scene, const BatchData& batch);

// If an island fails, all functions below set the island's results to NaN, and the status of its state to kFailed. They
// solve the other states nevertheless. `status` has one entry per state. Batches with data of their own may run in
// several threads at the same time.

/// Solves every state, as `solve` does. A (nv columns) receives the accelerations and F (force_rows columns) the
/// contact forces. Throws std::invalid_argument before anything is computed if a size is wrong or the data belong to
/// another scene. May throw std::bad_alloc, also if a worker thread runs out of memory; the outputs are then
/// unspecified.
void solve_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                 std::span<Status> status);

/// Solves every state and differentiates its solution. Each row of D receives the derivatives of [a; f] with respect to
/// [q v u], a row-major matrix of (nv + force_rows) x (2 nv + nu) numbers in the scene's order. Throws as solve_batch
/// does. For large scenes `differentiate` takes far less memory, as it stores only the diagonal blocks of islands.
void differentiate_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                         BatchRows D, std::span<Status> status);

/// Solves every state and multiplies the transposed derivatives by rows of WA (nv columns) and WF (force_rows columns),
/// as `vjp` does. The results are WQ (nv columns), WV (nv columns) and WU (nu columns). No derivative matrix is formed.
/// Throws as solve_batch does.
void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, std::span<Status> status);

/// Computes the products of the first overload, and WW, the product with respect to the external wrenches: 6 columns
/// per wrench, in the wrench's own axes (`ExternalWrench::reference_frame`).
void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, BatchRows WW, std::span<Status> status);

}  // namespace manycontact
