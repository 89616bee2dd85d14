#include "manycontact/simulation/step_batch.hpp"

#include <algorithm>
#include <stdexcept>

#include "dynamics/workspace/changes.hpp"
#include "dynamics/workspace/parallel.hpp"
#include "manycontact/dynamics/copies.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/sparse/blas_threads.hpp"
#include "resisting_forces.hpp"

namespace manycontact {

/// States side by side as copies of the scene, or, after a step of one of them failed, each with its own data.
struct SimulationBatch::Part {
  Part(const Scene& of, Eigen::Index first_, int states_)
      : first(first_), states(states_), scene(internal::copies_of(of, states_)) {}

  Eigen::Index first;
  int states;
  Scene scene;                                  // the copies
  std::vector<SimulationData> together, alone;  // one, or none; none, or one for each state
  Eigen::VectorXd u;
};

namespace {

using Part = SimulationBatch::Part;

void expect(bool fits, const char* what) {
  if (!fits) throw std::invalid_argument(what);
}

// Rows first ... of X, one after the other.
Eigen::VectorXd side_by_side(const ConstBatchRows& X, Eigen::Index first, int states) {
  Eigen::VectorXd out(states * X.cols());
  for (int k = 0; k < states; ++k) out.segment(k * X.cols(), X.cols()) = X.row(first + k).transpose();
  return out;
}

int states_at_once(const Scene& scene, const Options& options) {
  SceneData data(scene, options);
  prepare(scene, data);
  return internal::states_side_by_side(data);
}

// The caller's numbers into the data of states first ... .
void take_settings(const SimulationBatch& b, Eigen::Index first, int states, SimulationData& d) {
  d.velocity_limit = b.velocity_limit;
  for (std::size_t c = 0; c < d.dynamics.active.size(); ++c) d.dynamics.active[c] = b.active[c % b.active.size()];
  for (std::size_t k = 0; k < d.dynamics.pushes.size(); ++k) d.dynamics.pushes[k] = b.pushes[k % b.pushes.size()];
  if (b.kp.size() == 0) {
    d.pd = {};
    return;
  }
  d.pd.kp = b.kp.replicate(states, 1), d.pd.kd = b.kd.replicate(states, 1);
  d.pd.q_ref = side_by_side(b.q_ref, first, states), d.pd.v_ref = side_by_side(b.v_ref, first, states);
}

void put_state(const Scene& scene, const SimulationData& d, int copy, Eigen::Index state, SimulationBatch& b) {
  b.q.row(state) = d.q.segment(copy * scene.nq, scene.nq).transpose();
  b.v.row(state) = d.v.segment(copy * scene.nv, scene.nv).transpose();
  b.f.row(state) = d.f.segment(copy * b.f.cols(), b.f.cols()).transpose();
}

// One state of those side by side, with all that the next step knows of the last.
SimulationData taken_out(const Scene& scene, const SimulationData& d, int copy, Eigen::Index rows) {
  const Eigen::VectorXd q = d.q.segment(copy * scene.nq, scene.nq), v = d.v.segment(copy * scene.nv, scene.nv);
  SimulationData out(scene, q, v, d.integrator, d.h, d.dynamics.options);
  out.steps = d.steps;
  out.f = Eigen::VectorXd::Zero(rows);
  if (d.left_active != d.dynamics.active) return out;
  out.left_q = d.left_q.segment(copy * scene.nq, scene.nq), out.left_v = d.left_v.segment(copy * scene.nv, scene.nv);
  out.left_active.assign(d.left_active.begin(),
                         d.left_active.begin() + static_cast<std::ptrdiff_t>(scene.contacts.size()));
  out.contact_v = d.contact_v.segment(copy * rows, rows);
  if (out.resisting && d.resisting)
    std::copy_n(d.resisting->joints.slip.begin() + copy * scene.nv, scene.nv, out.resisting->joints.slip.begin());
  return out;
}

// Steps of states that have their own data.
void step_alone(const Scene& scene, const ConstBatchRows& u, int steps, Part& part, SimulationBatch& b) {
  for (int k = 0; k < part.states; ++k) {
    SimulationData& d = part.alone[static_cast<std::size_t>(k)];
    StepStatus& status = b.status[static_cast<std::size_t>(part.first + k)];
    take_settings(b, part.first + k, 1, d);
    status = StepStatus::kOk;
    for (int n = 0; n < steps && status == StepStatus::kOk; ++n)
      status = step(scene, u.row(part.first + k).transpose(), d);
    if (d.f.size() == b.f.cols()) put_state(scene, d, 0, part.first + k, b);
  }
}

void step_part(const Scene& scene, const ConstBatchRows& u, int steps, Part& part, SimulationBatch& b) {
  if (part.alone.empty()) {
    internal::take_all_changes(scene, part.scene);
    SimulationData& d = part.together.front();
    take_settings(b, part.first, part.states, d);
    part.u = side_by_side(u, part.first, part.states);
    int made = 0;
    while (made < steps && step(part.scene, part.u, d) == StepStatus::kOk) ++made;
    if (made == steps) {
      for (int k = 0; k < part.states; ++k) {
        b.status[static_cast<std::size_t>(part.first + k)] = StepStatus::kOk;
        if (steps > 0) put_state(scene, d, k, part.first + k, b);
      }
      return;
    }
    for (int k = 0; k < part.states; ++k) part.alone.push_back(taken_out(scene, d, k, b.f.cols()));
    part.together.clear();
    steps -= made;
  }
  step_alone(scene, u, steps, part, b);
}

int rows_of_active(const Scene& scene, const std::vector<char>& active) {
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) rows += active[c] ? scene.contacts[c].rows() : 0;
  return rows;
}

void check(const Scene& scene, const ConstBatchRows& u, const SimulationBatch& b, int steps) {
  const Eigen::Index n = b.q.rows();
  expect(b.q.cols() == scene.nq && b.v.cols() == scene.nv, "step_batch: the batch is of another scene");
  expect(u.rows() == n && u.cols() == scene.nu,
         "step_batch: u does not fit, expected a row of nu numbers for each state");
  expect(steps >= 0, "step_batch: the number of steps is negative");
  expect(b.active.size() == scene.contacts.size(), "step_batch: batch.active does not fit the scene");
  expect(b.pushes.size() == scene.pushes.size(), "step_batch: batch.pushes does not fit the scene");
  const Eigen::Index gains = b.kp.size();
  expect(b.kd.size() == gains && (gains == 0 || gains == scene.nv), "step_batch: batch.kp and kd do not fit the scene");
  for (const BatchMatrix* X : {&b.q_ref, &b.v_ref})
    expect(gains == 0 || (X->rows() == n && X->cols() == scene.nv),
           "step_batch: batch.q_ref and v_ref do not fit, expected a row of nv numbers for each state");
}

}  // namespace

SimulationBatch::SimulationBatch(const Scene& scene, const ConstBatchRows& q_, const ConstBatchRows& v_,
                                 Integrator integrator, double h, int threads, const Options& options)
    : q(q_), v(v_), status(static_cast<std::size_t>(q_.rows()), StepStatus::kOk) {
  expect(q.cols() == scene.nq && v.cols() == scene.nv && q.rows() == v.rows(),
         "SimulationBatch: q or v does not fit the scene");
  expect(threads >= 0 && threads <= kMostThreads, "SimulationBatch: the number of threads is negative or too large");
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  for (const Push& push : scene.pushes) pushes.push_back(push.wrench);
  Options of_part = options;
  of_part.threads = 1;
  const int at_once = states_at_once(scene, of_part);
  for (Eigen::Index first = 0; first < q.rows(); first += at_once) {
    const int states = static_cast<int>(std::min<Eigen::Index>(at_once, q.rows() - first));
    parts.push_back(std::make_shared<Part>(scene, first, states));
    internal::take_all_changes(scene, parts.back()->scene);
    parts.back()->together.emplace_back(parts.back()->scene, side_by_side(q, first, states),
                                        side_by_side(v, first, states), integrator, h, of_part);
  }
  f = BatchMatrix::Zero(q.rows(), rows_of_active(scene, active));
  failures = std::make_shared<std::vector<internal::Failure>>(
      static_cast<std::size_t>(threads > 0 ? threads : internal::default_threads()));
}

void step_batch(const Scene& scene, const ConstBatchRows& u, SimulationBatch& batch, int steps) {
  check(scene, u, batch, steps);
  if (const int rows = rows_of_active(scene, batch.active); rows != batch.f.cols())
    batch.f = BatchMatrix::Zero(batch.q.rows(), rows);
  const sparse::OneBlasThread one_blas_thread;
  internal::run_items(
      std::span<internal::Failure>(*batch.failures), static_cast<std::ptrdiff_t>(batch.parts.size()),
      [&](std::ptrdiff_t k, int) { step_part(scene, u, steps, *batch.parts[static_cast<std::size_t>(k)], batch); });
}

namespace {

// The velocities of contacts that the next step of the whole is to go on from, where one state is another.
void renew(const Scene& scene, int copy, Eigen::Index rows, Part& part, SimulationData& d) {
  d.left_q.segment(copy * scene.nq, scene.nq) = d.q.segment(copy * scene.nq, scene.nq);
  d.left_v.segment(copy * scene.nv, scene.nv) = d.v.segment(copy * scene.nv, scene.nv);
  if (d.left_active != d.dynamics.active || rows == 0) return;
  Eigen::VectorXd c = d.contact_v;
  d.stage_v.setZero();
  d.at_rest.inverse_dynamics_of(part.scene, d.q, d.v, d.stage_v, part.scene.gravity, d.tau);
  d.at_rest.contact_velocities(d.dynamics.f_offset, c);
  d.contact_v.segment(copy * rows, rows) = c.segment(copy * rows, rows);
}

}  // namespace

void set_state(const Scene& scene, Eigen::Index k, const ConstVector& q, const ConstVector& v, SimulationBatch& batch) {
  expect(q.size() == scene.nq && v.size() == scene.nv && batch.q.cols() == scene.nq,
         "set_state: q or v does not fit the scene");
  expect(k >= 0 && k < batch.q.rows(), "set_state: there is no such state");
  for (const std::shared_ptr<Part>& part : batch.parts) {
    const int copy = static_cast<int>(k - part->first);
    if (copy < 0 || copy >= part->states) continue;
    const bool alone = !part->alone.empty();
    SimulationData& d = alone ? part->alone[static_cast<std::size_t>(copy)] : part->together.front();
    const int at = alone ? 0 : copy;
    d.q.segment(at * scene.nq, scene.nq) = q;
    d.v.segment(at * scene.nv, scene.nv) = v;
    if (!alone && d.steps > 0) renew(scene, copy, batch.f.cols(), *part, d);
  }
  batch.q.row(k) = q.transpose(), batch.v.row(k) = v.transpose();
}

}  // namespace manycontact
