#include "manycontact/dynamics/batch.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "manycontact/sparse/blas_threads.hpp"
#include "parallel.hpp"
#include "steps.hpp"

namespace manycontact {

BatchData::BatchData(const Scene& scene, int count, const Options& opts) : options(opts) {
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  if (count <= 0) count = internal::default_threads();
  threads.reserve(count);
  Options of_thread = options;
  of_thread.threads = 1;
  for (int k = 0; k < count; ++k) threads.push_back({SceneData(scene, of_thread)});
}

int force_rows(const Scene& scene, const BatchData& batch) {
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) rows += batch.active.at(c) ? scene.contacts[c].rows() : 0;
  return rows;
}

namespace {

using ConstRow = Eigen::Map<const Eigen::VectorXd>;
using Row = Eigen::Map<Eigen::VectorXd>;

ConstRow row_of(const ConstBatchRows& X, std::ptrdiff_t k) { return {X.data() + k * X.outerStride(), X.cols()}; }
Row row_of(BatchRows& X, std::ptrdiff_t k) { return {X.data() + k * X.outerStride(), X.cols()}; }

template <class Matrix>
void check(const char* function, const char* name, const Matrix& X, Eigen::Index rows, Eigen::Index cols) {
  if (X.rows() == rows && X.cols() == cols) return;
  throw std::invalid_argument(std::string(function) + ": " + name + " is " + std::to_string(X.rows()) + " x " +
                              std::to_string(X.cols()) + ", expected " + std::to_string(rows) + " x " +
                              std::to_string(cols));
}

void check(const char* function, const Scene& scene, const BatchStates& s, const BatchData& batch,
           std::span<Status> status) {
  for (const BatchData::Thread& thread : batch.threads) internal::check_scene(scene, thread.data, function);
  if (batch.active.size() != scene.contacts.size())
    throw std::invalid_argument(std::string(function) + ": " + std::to_string(batch.active.size()) +
                                " active flags for " + std::to_string(scene.contacts.size()) + " contacts");
  const Eigen::Index count = s.q.rows();
  check(function, "q", s.q, count, scene.nq);
  check(function, "v", s.v, count, scene.nv);
  check(function, "u", s.u, count, scene.nu);
  internal::check_size(function, "status", static_cast<Eigen::Index>(status.size()), count);
}

// Solves each state, then use(state, data). The one loop over states there is.
template <class Use>
void each_state(const Scene& scene, const BatchStates& s, BatchData& batch, std::span<Status> status, Use&& use) {
  for (BatchData::Thread& thread : batch.threads) {
    thread.data.options = batch.options;
    thread.data.options.threads = 1;
    thread.data.active = batch.active;
    thread.error = nullptr;
  }
  std::atomic<bool> stop = false;
  auto work = [&](std::ptrdiff_t k, int number) {
    if (stop) return;
    BatchData::Thread& thread = batch.threads[number];
    try {
      internal::forget_states(thread.data);
      status[k] = solve(scene, row_of(s.q, k), row_of(s.v, k), row_of(s.u, k), thread.data).status;
      use(k, thread.data);
    } catch (...) {
      thread.error = std::current_exception();
      thread.state = k;
      stop = true;
    }
  };
  const sparse::OneBlasThread one_blas_thread;
  const auto threads = std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(batch.threads.size()), s.q.rows());
  internal::run_items(static_cast<int>(std::max<std::ptrdiff_t>(threads, 1)), s.q.rows(), work);
  BatchData::Thread* first = nullptr;
  for (BatchData::Thread& thread : batch.threads)
    if (thread.error && (!first || thread.state < first->state)) first = &thread;
  if (first) std::rethrow_exception(first->error);
}

// [da; df] of [q v u] in the scene's order, row-major, from the islands' blocks.
void write_derivatives(const Scene& scene, const SceneData& data, Row out) {
  const DerivativeData& dd = derivatives(data);
  Eigen::Map<BatchMatrix> D(out.data(), scene.nv + data.f.size(), 2 * scene.nv + scene.nu);
  D.setZero();
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Island& island = island_of(data, i);
    const auto row_block = [&](int to, int from, int n) {
      each_velocity_block(scene, island, [&](int to_v, int from_v, int nv) {
        D.block(to, to_v, n, nv) = d.X.block(from, d.q_first + from_v, n, nv);
        D.block(to, scene.nv + to_v, n, nv) = d.X.block(from, d.v_first + from_v, n, nv);
      });
      each_torque_block(scene, island, [&](int to_u, int from_u, int nu) {
        D.block(to, 2 * scene.nv + to_u, n, nu) = d.X.block(from, d.u_first + from_u, n, nu);
      });
    };
    each_velocity_block(scene, island, row_block);
    each_force_block(scene, data.f_offset, island,
                     [&](int to, int from, int n) { row_block(scene.nv + to, d.nv + from, n); });
  }
}

}  // namespace

void solve_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                 std::span<Status> status) {
  check("solve_batch", scene, states, batch, status);
  check("solve_batch", "A", A, states.q.rows(), scene.nv);
  check("solve_batch", "F", F, states.q.rows(), force_rows(scene, batch));
  each_state(scene, states, batch, status, [&](std::ptrdiff_t k, const SceneData& data) {
    row_of(A, k) = data.a;
    row_of(F, k) = data.f;
  });
}

void differentiate_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                         BatchRows D, std::span<Status> status) {
  check("differentiate_batch", scene, states, batch, status);
  const Eigen::Index count = states.q.rows(), nf = force_rows(scene, batch);
  check("differentiate_batch", "A", A, count, scene.nv);
  check("differentiate_batch", "F", F, count, nf);
  check("differentiate_batch", "D", D, count, (scene.nv + nf) * (2 * scene.nv + scene.nu));
  each_state(scene, states, batch, status, [&](std::ptrdiff_t k, SceneData& data) {
    row_of(A, k) = data.a;
    row_of(F, k) = data.f;
    differentiate(scene, data);
    write_derivatives(scene, data, row_of(D, k));
  });
}

void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, std::span<Status> status) {
  check("vjp_batch", scene, states, batch, status);
  const Eigen::Index count = states.q.rows();
  check("vjp_batch", "WA", WA, count, scene.nv);
  check("vjp_batch", "WF", WF, count, force_rows(scene, batch));
  check("vjp_batch", "WQ", WQ, count, scene.nv);
  check("vjp_batch", "WV", WV, count, scene.nv);
  check("vjp_batch", "WU", WU, count, scene.nu);
  each_state(scene, states, batch, status, [&](std::ptrdiff_t k, SceneData& data) {
    vjp(scene, data, row_of(WA, k), row_of(WF, k), row_of(WQ, k), row_of(WV, k), row_of(WU, k));
  });
}

}  // namespace manycontact
