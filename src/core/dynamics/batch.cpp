#include "manycontact/dynamics/batch.hpp"

#include <algorithm>
#include <stdexcept>

#include "internal.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/copies.hpp"
#include "manycontact/dynamics/parallel.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "workspace/changes.hpp"

namespace manycontact {

struct BatchCopies {  // a scene that consists of `count` copies of another scene, and its data
  BatchCopies(const Scene& of, int copies, const Options& options);

  int count;
  Scene scene;
  SceneData data;
  Eigen::VectorXd q, v, u, wa, wf, wq, wv, wu, ww;  // vectors of all copies, one after another
};

namespace {

Eigen::Index wrench_numbers(const Scene& scene) { return static_cast<Eigen::Index>(6 * scene.wrenches.size()); }

}  // namespace

namespace internal {

Scene copies_of(const Scene& scene, int count) {
  Scene out;
  std::vector<int> robot_at(scene.robots.size());
  for (int k = 0; k < count; ++k) {
    for (Robot robot : scene.robots) {
      robot.idx_q += k * scene.nq, robot.idx_v += k * scene.nv, robot.idx_u += k * scene.nu;
      out.robots.push_back(std::move(robot));
    }
    for (Contact contact : scene.contacts) {
      for (Attachment* at : {&contact.A, &contact.B})
        if (at->robot >= 0) at->robot += k * scene.nrobots();
      out.contacts.push_back(std::move(contact));
    }
    for (std::size_t r = 0; r < robot_at.size(); ++r) robot_at[r] = k * scene.nrobots() + static_cast<int>(r);
    take_applied_forces(scene, robot_at, out);
  }
  out.nq = count * scene.nq, out.nv = count * scene.nv, out.nu = count * scene.nu;
  return out;
}

int states_side_by_side(const SceneData& data) {
  const Workspace& w = *data_solved(data).workspace;
  if (!w.lanes.level) return 1;
  const int width = batch_width(w);
  const auto leaves_room = [&](const BlockGroup& group) {
    const auto members = std::ranges::count_if(w.islands, [&](const auto& d) { return d->alone.group == &group; });
    return members > 0 && members < width;
  };
  for (const auto& [key, group] : w.lanes.groups)
    if (leaves_room(group)) return width;
  return 1;
}

}  // namespace internal

BatchCopies::BatchCopies(const Scene& of, int copies, const Options& options)
    : count(copies), scene(internal::copies_of(of, copies)), data(scene, options) {
  q.resize(scene.nq);
  for (Eigen::VectorXd* x : {&v, &wa, &wq, &wv}) x->resize(scene.nv);
  for (Eigen::VectorXd* x : {&u, &wu}) x->resize(scene.nu);
  ww.resize(wrench_numbers(scene));
}

BatchData::BatchData(const Scene& scene, int count, const Options& opts) : options(opts) {
  active = active_contacts(scene);
  wrenches = external_wrenches(scene);
  if (count <= 0) count = internal::default_threads();
  threads.reserve(count);
  failures = std::make_shared<std::vector<internal::Failure>>();
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
    throw std::invalid_argument(std::string(function) + ": batch.active has " + std::to_string(batch.active.size()) +
                                " flags, the scene has " + std::to_string(scene.contacts.size()) + " contacts");
  if (batch.wrenches.size() != scene.wrenches.size())
    throw std::invalid_argument(std::string(function) + ": batch.wrenches has " +
                                std::to_string(batch.wrenches.size()) + " wrenches, the scene has " +
                                std::to_string(scene.wrenches.size()));
  const Eigen::Index count = s.q.rows();
  check(function, "q", s.q, count, scene.nq);
  check(function, "v", s.v, count, scene.nv);
  check(function, "u", s.u, count, scene.nu);
  internal::check_size(function, "status", static_cast<Eigen::Index>(status.size()), count);
}

// Returns the least number of states for which one solve of all copies, at the cost of two single solves, is cheaper.
std::ptrdiff_t worth_it(int copies) { return std::min(copies, 3); }

void prepare_copies(const Scene& scene, BatchData& batch) {
  const int count = internal::batch_width(*data_solved(batch.threads.front().data).workspace);
  for (BatchData::Thread& thread : batch.threads) {
    if (!thread.copies || thread.copies->count != count ||
        has_applied_forces(thread.copies->scene) != has_applied_forces(scene)) {
      thread.copies.reset();
      thread.copies = std::make_shared<BatchCopies>(scene, count, thread.data.options);
    }
    Scene& copies = thread.copies->scene;
    internal::take_all_changes(scene, copies);
    SceneData& data = thread.copies->data;
    data.options = thread.data.options;
    for (std::size_t c = 0; c < data.active.size(); ++c) data.active[c] = batch.active[c % batch.active.size()];
    for (std::size_t k = 0; k < data.wrenches.size(); ++k) data.wrenches[k] = batch.wrenches[k % batch.wrenches.size()];
  }
}

// Concatenates rows first, first+1, ... of X, one per copy. Copies beyond the last row of X repeat the last row.
void gather(const ConstBatchRows& X, std::ptrdiff_t first, int copies, Eigen::VectorXd& out) {
  for (std::ptrdiff_t k = 0; k < copies; ++k)
    out.segment(k * X.cols(), X.cols()) = row_of(X, std::min(first + k, X.rows() - 1));
}

struct Solved {  // the result of one solve, of one state or of several, one per copy of the scene
  const Scene& scene;
  SceneData& data;
  BatchCopies* copies;  // nullptr: solved in the scene itself
  std::ptrdiff_t first;
  int states;

  int count() const { return copies ? copies->count : 1; }
  std::size_t islands() const { return data.report.islands.size() / count(); }  // islands per state
};

// Writes the segment of x for copy number `copy` to the row of X for the state of that copy. x: vector of all copies.
void put(const Eigen::VectorXd& x, const Solved& s, int copy, BatchRows X) {
  row_of(X, s.first + copy) = x.segment(copy * X.cols(), X.cols());
}

Status status_of(const Solved& s, int copy) {
  Status worst = Status::kOk;
  for (std::size_t i = copy * s.islands(); i < (copy + 1) * s.islands(); ++i)
    worst = std::max(worst, s.data.report.islands[i].status);
  return worst;
}

// Solves states first ... first+states-1, as copies in one scene or one by one. Calls use(Solved) after each solve.
template <class Use>
void solve_some(const Scene& scene, const BatchStates& s, BatchData::Thread& thread, std::ptrdiff_t first, int states,
                std::span<Status> status, Use&& use) {
  const auto solved = [&](const Solved& these) {
    for (int k = 0; k < these.states; ++k) status[these.first + k] = status_of(these, k);
    use(these);
  };
  if (thread.copies && states >= worth_it(thread.copies->count)) {
    BatchCopies& c = *thread.copies;
    gather(s.q, first, c.count, c.q);
    gather(s.v, first, c.count, c.v);
    gather(s.u, first, c.count, c.u);
    (void)solve(c.scene, c.q, c.v, c.u, c.data);
    return solved({c.scene, c.data, &c, first, states});
  }
  for (std::ptrdiff_t k = first; k < first + states; ++k) {
    (void)solve(scene, row_of(s.q, k), row_of(s.v, k), row_of(s.u, k), thread.data);
    solved({scene, thread.data, nullptr, k, 1});
  }
}

// Solves all states, and calls use(Solved) for each state, or once for copies solved together.
template <class Use>
void each_state(const Scene& scene, const BatchStates& s, BatchData& batch, std::span<Status> status, Use&& use) {
  for (BatchData::Thread& thread : batch.threads) {
    thread.data.options = batch.options;
    thread.data.options.threads = 1;
    thread.data.active = batch.active;
    thread.data.wrenches = batch.wrenches;
  }
  const std::ptrdiff_t count = s.q.rows();
  if (count == 0) return;
  const auto threads = std::min(static_cast<std::ptrdiff_t>(batch.threads.size()), count);
  const std::ptrdiff_t of_thread = (count + threads - 1) / threads;
  std::ptrdiff_t at_once = 1;
  if (of_thread > 1) {
    SceneData& data = batch.threads.front().data;
    prepare(scene, data);
    at_once = std::min<std::ptrdiff_t>(internal::states_side_by_side(data), of_thread);
  }
  if (at_once > 1) prepare_copies(scene, batch);
  batch.failures->resize(batch.threads.size());
  const std::span<internal::Failure> failures(batch.failures->data(), threads);
  internal::run_items(failures, (count + at_once - 1) / at_once, [&](std::ptrdiff_t k, int number) {
    const std::ptrdiff_t first = k * at_once;
    const int states = static_cast<int>(std::min(at_once, count - first));
    solve_some(scene, s, batch.threads[number], first, states, status, use);
  });
}

// Writes one copy's d[a; f]/d[q v u], row-major in the scene's order, from its islands' panels. nf: length of f.
void write_derivatives(const Scene& scene, const Solved& s, int copy, Eigen::Index nf, Row out) {
  const DerivativeData& dd = derivatives(s.data);
  const int v0 = copy * scene.nv, u0 = 2 * scene.nv - copy * scene.nu;  // offsets of the copy's coordinates
  Eigen::Map<BatchMatrix> D(out.data(), scene.nv + nf, 2 * scene.nv + scene.nu);
  D.setZero();
  for (std::size_t i = copy * s.islands(); i < (copy + 1) * s.islands(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Island& island = solved_island(s.data, i);
    const auto row_block = [&](Eigen::Index to, int from, int n) {
      each_velocity_block(s.scene, island, [&](int to_v, int from_v, int nv) {
        D.block(to, to_v - v0, n, nv) = d.X.block(from, d.q_first + from_v, n, nv);
        D.block(to, scene.nv + to_v - v0, n, nv) = d.X.block(from, d.v_first + from_v, n, nv);
      });
      each_torque_block(s.scene, island, [&](int to_u, int from_u, int nu) {
        D.block(to, u0 + to_u, n, nu) = d.X.block(from, d.u_first + from_u, n, nu);
      });
    };
    each_velocity_block(s.scene, island, [&](int to, int from, int n) { row_block(to - v0, from, n); });
    each_force_block(s.scene, s.data.f_offset, island,
                     [&](int to, int from, int n) { row_block(scene.nv + to - copy * nf, d.nv + from, n); });
  }
}

void put_answer(const Solved& s, BatchRows A, BatchRows F) {
  for (int k = 0; k < s.states; ++k) {
    put(s.data.a, s, k, A);
    put(s.data.f, s, k, F);
  }
}

}  // namespace

void solve_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                 std::span<Status> status) {
  check("solve_batch", scene, states, batch, status);
  check("solve_batch", "A", A, states.q.rows(), scene.nv);
  check("solve_batch", "F", F, states.q.rows(), force_rows(scene, batch));
  each_state(scene, states, batch, status, [&](const Solved& s) { put_answer(s, A, F); });
}

void differentiate_batch(const Scene& scene, const BatchStates& states, BatchData& batch, BatchRows A, BatchRows F,
                         BatchRows D, std::span<Status> status) {
  check("differentiate_batch", scene, states, batch, status);
  const Eigen::Index count = states.q.rows(), nf = force_rows(scene, batch);
  check("differentiate_batch", "A", A, count, scene.nv);
  check("differentiate_batch", "F", F, count, nf);
  check("differentiate_batch", "D", D, count, (scene.nv + nf) * (2 * scene.nv + scene.nu));
  each_state(scene, states, batch, status, [&](const Solved& s) {
    put_answer(s, A, F);
    differentiate(s.scene, s.data);
    for (int k = 0; k < s.states; ++k) write_derivatives(scene, s, k, nf, row_of(D, s.first + k));
  });
}

namespace {

// Computes vjp of all states. WW: nullptr if not requested.
void products_of_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA,
                       const ConstBatchRows& WF, BatchData& batch, BatchRows& WQ, BatchRows& WV, BatchRows& WU,
                       BatchRows* WW, std::span<Status> status) {
  check("vjp_batch", scene, states, batch, status);
  const Eigen::Index count = states.q.rows();
  check("vjp_batch", "WA", WA, count, scene.nv);
  check("vjp_batch", "WF", WF, count, force_rows(scene, batch));
  check("vjp_batch", "WQ", WQ, count, scene.nv);
  check("vjp_batch", "WV", WV, count, scene.nv);
  check("vjp_batch", "WU", WU, count, scene.nu);
  if (WW) check("vjp_batch", "WW", *WW, count, wrench_numbers(scene));
  each_state(scene, states, batch, status, [&](const Solved& s) {
    const auto product = [&](const auto& wa, const auto& wf, auto&& wq, auto&& wv, auto&& wu, auto&& ww) {
      WW ? vjp(s.scene, s.data, wa, wf, wq, wv, wu, ww) : vjp(s.scene, s.data, wa, wf, wq, wv, wu);
    };
    if (!s.copies)
      return product(row_of(WA, s.first), row_of(WF, s.first), row_of(WQ, s.first), row_of(WV, s.first),
                     row_of(WU, s.first), row_of(WW ? *WW : WU, s.first));
    BatchCopies& c = *s.copies;
    internal::remake(c.wf, s.data.f.size());
    gather(WA, s.first, c.count, c.wa);
    gather(WF, s.first, c.count, c.wf);
    product(c.wa, c.wf, c.wq, c.wv, c.wu, c.ww);
    for (int k = 0; k < s.states; ++k) {
      put(c.wq, s, k, WQ), put(c.wv, s, k, WV), put(c.wu, s, k, WU);
      if (WW) put(c.ww, s, k, *WW);
    }
  });
}

}  // namespace

void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, std::span<Status> status) {
  products_of_batch(scene, states, WA, WF, batch, WQ, WV, WU, nullptr, status);
}

void vjp_batch(const Scene& scene, const BatchStates& states, const ConstBatchRows& WA, const ConstBatchRows& WF,
               BatchData& batch, BatchRows WQ, BatchRows WV, BatchRows WU, BatchRows WW, std::span<Status> status) {
  products_of_batch(scene, states, WA, WF, batch, WQ, WV, WU, &WW, status);
}

}  // namespace manycontact
