#include "manycontact/simulation/step_batch.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "dynamics/workspace/changes.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/copies.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"
#include "manycontact/dynamics/parallel.hpp"
#include "resisting_forces.hpp"

namespace manycontact {

/// States that are stepped together as copies in one scene. Once a step of one of them fails, each state has its own
/// data. Between steps a part stores only the members of SimulationData from which `step` continues; the other members
/// belong to the thread. A part with redundant rows owns the SimulationData that found these rows.
struct SimulationBatch::Part {
  Eigen::Index first;
  int states;
  Eigen::VectorXd q, v, left_q, left_v, contact_v;  // members of SimulationData, for all copies
  Eigen::ArrayX2d account;                          // BoundedEnergy::account, for all copies
  std::vector<char> left_active, kept_active;
  std::vector<signed char> slip;
  long steps = 0;
  std::unique_ptr<SimulationData> own;  // data of this part alone; null if the thread's data are used
  std::vector<SimulationData> alone;    // empty, or, after a failed step, one entry per state
  Eigen::VectorXd u;                    // workspace
};

struct SimulationBatch::Work {
  int copies;
  Scene scene;  // one scene with all copies of the robots
  Integrator integrator;
  double h;
  Options options;
  std::vector<Part> parts;
  std::vector<std::unique_ptr<SimulationData>> of_threads;
  std::vector<internal::Failure> failures;  // one per thread
};

namespace {

using Part = SimulationBatch::Part;
using Work = SimulationBatch::Work;

void expect(bool fits, const char* what) {
  if (!fits) throw std::invalid_argument(what);
}

// Concatenates `copies` rows of X into `out`, from row `first` on. The last row of X is repeated for missing rows.
void side_by_side(const ConstBatchRows& X, Eigen::Index first, int copies, Eigen::VectorXd& out) {
  out.resize(copies * X.cols());
  for (int k = 0; k < copies; ++k)
    out.segment(k * X.cols(), X.cols()) = X.row(std::min(first + k, X.rows() - 1)).transpose();
}

int states_at_once(const Scene& scene, const Options& options) {
  SceneData data(scene, options);
  prepare(scene, data);
  return internal::states_side_by_side(data);
}

// Copies the caller's settings (contacts, wrenches, PD laws, velocity limit) into the data of states first ...
// first + states - 1.
void take_settings(const SimulationBatch& b, Eigen::Index first, int states, SimulationData& d) {
  d.velocity_limit = b.velocity_limit;
  for (std::size_t c = 0; c < d.dynamics.active.size(); ++c) d.dynamics.active[c] = b.active[c % b.active.size()];
  for (std::size_t k = 0; k < d.dynamics.wrenches.size(); ++k)
    d.dynamics.wrenches[k] = b.wrenches[k % b.wrenches.size()];
  if (b.kp.size() == 0) {
    d.pd = {};
    return;
  }
  d.pd.kp = b.kp.replicate(states, 1), d.pd.kd = b.kd.replicate(states, 1);
  side_by_side(b.q_ref, first, states, d.pd.q_ref), side_by_side(b.v_ref, first, states, d.pd.v_ref);
}

void put_state(const Scene& scene, const SimulationData& d, int copy, Eigen::Index state, SimulationBatch& b) {
  b.q.row(state) = d.q.segment(copy * scene.nq, scene.nq).transpose();
  b.v.row(state) = d.v.segment(copy * scene.nv, scene.nv).transpose();
  b.f.row(state) = d.f.segment(copy * b.f.cols(), b.f.cols()).transpose();
}

// Extracts one state of the copies, with all data with which the next step continues.
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
  if (out.resisting && d.resisting && d.resisting->bounded.account.rows() > 0)
    out.resisting->bounded.account = d.resisting->bounded.account.middleRows(copy * scene.nrobots(), scene.nrobots());
  return out;
}

// Steps the states of a part in which each state has its own data (part.alone).
void step_alone(const Scene& scene, const ConstBatchRows& u, int steps, Part& part, SimulationBatch& b) {
  for (int k = 0; k < part.states; ++k) {
    SimulationData& d = part.alone[k];
    StepStatus& status = b.status[part.first + k];
    take_settings(b, part.first + k, 1, d);
    status = StepStatus::kOk;
    for (int n = 0; n < steps && status == StepStatus::kOk; ++n)
      status = step(scene, u.row(part.first + k).transpose(), d);
    if (d.f.size() == b.f.cols()) put_state(scene, d, 0, part.first + k, b);
  }
}

std::unique_ptr<SimulationData> data_of_copies(const Work& work, const Part& part) {
  return std::make_unique<SimulationData>(work.scene, part.q, part.v, work.integrator, work.h, work.options);
}

// Swaps the members with which a step continues between a part and `d`.
void exchange(Part& part, SimulationData& d) {
  part.q.swap(d.q), part.v.swap(d.v);
  part.left_q.swap(d.left_q), part.left_v.swap(d.left_v);
  part.contact_v.swap(d.contact_v);
  part.left_active.swap(d.left_active), part.kept_active.swap(d.kept_active);
  std::swap(part.steps, d.steps);
  if (!d.resisting) return;
  part.slip.resize(d.resisting->joints.slip.size(), 0);
  part.slip.swap(d.resisting->joints.slip);
  part.account.swap(d.resisting->bounded.account);
}

bool rows_depend(SimulationData& d) {
  const auto has_dependent = [](const IslandReport& island) { return island.rank < island.nc; };
  return std::ranges::any_of(internal::at_rest_with_joints(d).data.report.islands, has_dependent);
}

// Calls use(data) with the data of the part or of the thread. If `use` returns true, the part owns the data afterwards.
template <class Use>
void with_data(const Work& work, std::unique_ptr<SimulationData>& of_thread, Part& part, Use&& use) {
  if (part.own) return (void)use(*part.own);
  if (!of_thread) of_thread = data_of_copies(work, part);
  SimulationData& d = *of_thread;
  for (SceneData* data : {&d.dynamics, &internal::at_rest_with_joints(d).data}) forget_dependent(*data);
  exchange(part, d);
  use(d) ? part.own.swap(of_thread) : exchange(part, d);
}

// Steps the states of a part as copies in one scene. Returns the number of steps before a step failed.
int step_together(const Scene& scene, const ConstBatchRows& u, int steps, const Work& work, Part& part,
                  SimulationData& d, SimulationBatch& b) {
  take_settings(b, part.first, work.copies, d);
  side_by_side(u, part.first, work.copies, part.u);
  int made = 0;
  while (made < steps && step(work.scene, part.u, d) == StepStatus::kOk) ++made;
  for (int k = 0; k < part.states; ++k) {
    if (made < steps) {
      part.alone.push_back(taken_out(scene, d, k, b.f.cols()));
      continue;
    }
    b.status[part.first + k] = StepStatus::kOk;
    if (steps > 0) put_state(scene, d, k, part.first + k, b);
  }
  return made;
}

void step_part(const Scene& scene, const ConstBatchRows& u, int steps, const Work& work,
               std::unique_ptr<SimulationData>& of_thread, Part& part, SimulationBatch& b) {
  if (part.alone.empty()) {
    int made = 0;
    with_data(work, of_thread, part, [&](SimulationData& d) {
      made = step_together(scene, u, steps, work, part, d, b);
      return made > 0 && rows_depend(d);
    });
    if (made == steps) return;
    part.own.reset();
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
  expect(b.q.cols() == scene.nq && b.v.cols() == scene.nv,
         "step_batch: the batch belongs to another scene, a batch of this scene is expected");
  expect(u.rows() == n && u.cols() == scene.nu,
         "step_batch: u has a wrong shape, expected a row of nu numbers for each state");
  expect(steps >= 0, "step_batch: the number of steps is negative, 0 or more is expected");
  expect(b.active.size() == scene.contacts.size(),
         "step_batch: batch.active has a wrong size, a flag for each contact is expected");
  expect(b.wrenches.size() == scene.wrenches.size(),
         "step_batch: batch.wrenches has a wrong size, a wrench for each wrench of the scene is expected");
  const Eigen::Index gains = b.kp.size();
  expect(b.kd.size() == gains && (gains == 0 || gains == scene.nv),
         "step_batch: batch.kp or kd has a wrong size, nv numbers or none are expected");
  for (const BatchMatrix* X : {&b.q_ref, &b.v_ref})
    expect(gains == 0 || (X->rows() == n && X->cols() == scene.nv),
           "step_batch: batch.q_ref or v_ref has a wrong shape, expected a row of nv numbers for each state");
}

// Updates the data with which the next step continues, after state `copy` was replaced in d.q, d.v.
void renew(const Scene& scene, const Scene& copies, int copy, Eigen::Index rows, SimulationData& d) {
  d.left_q.segment(copy * scene.nq, scene.nq) = d.q.segment(copy * scene.nq, scene.nq);
  d.left_v.segment(copy * scene.nv, scene.nv) = d.v.segment(copy * scene.nv, scene.nv);
  if (d.resisting && d.resisting->bounded.account.rows() > 0)
    d.resisting->bounded.account.middleRows(copy * scene.nrobots(), scene.nrobots())
        .setConstant(std::numeric_limits<double>::quiet_NaN());
  if (d.left_active != d.dynamics.active || rows == 0) return;
  Eigen::VectorXd c = d.contact_v;
  d.stage_v.setZero();
  d.at_rest.inverse_dynamics_of(copies, d.q, d.v, d.stage_v, copies.gravity, d.tau);
  d.at_rest.contact_velocities(d.dynamics.f_offset, c);
  d.contact_v.segment(copy * rows, rows) = c.segment(copy * rows, rows);
}

}  // namespace

SimulationBatch::SimulationBatch(const Scene& scene, const ConstBatchRows& q_, const ConstBatchRows& v_,
                                 Integrator integrator, double h, int threads, const Options& options)
    : q(q_), v(v_), status(static_cast<std::size_t>(q_.rows()), StepStatus::kOk) {
  expect(q.cols() == scene.nq && v.cols() == scene.nv && q.rows() == v.rows(),
         "SimulationBatch: q or v has a wrong shape, a row of nq and a row of nv numbers for each state are expected");
  expect(threads >= 0 && threads <= kMostThreads,
         "SimulationBatch: the number of threads is negative or too large, 0 to 4096 is expected");
  active = active_contacts(scene);
  wrenches = external_wrenches(scene);
  Options of_part = options;
  of_part.threads = 1;
  const int copies = static_cast<int>(std::clamp<Eigen::Index>(q.rows(), 1, states_at_once(scene, of_part)));
  work.reset(new Work{copies, internal::copies_of(scene, copies), integrator, h, of_part, {}, {}, {}});
  internal::take_all_changes(scene, work->scene);
  for (Eigen::Index first = 0; first < q.rows(); first += copies) {
    Part& part = work->parts.emplace_back();
    part.first = first, part.states = static_cast<int>(std::min<Eigen::Index>(copies, q.rows() - first));
    side_by_side(q, first, copies, part.q), side_by_side(v, first, copies, part.v);
    part.left_q.setConstant(part.q.size(), std::numeric_limits<double>::quiet_NaN());  // NaN differs from any q
    part.left_v = part.v;
  }
  work->failures.resize(static_cast<std::size_t>(threads > 0 ? threads : internal::default_threads()));
  work->of_threads.resize(work->failures.size());
  Part neutral;
  neutral.q.setZero(work->scene.nq), neutral.v.setZero(work->scene.nv);
  work->of_threads.front() = data_of_copies(*work, neutral);
  f = BatchMatrix::Zero(q.rows(), rows_of_active(scene, active));
}

void step_batch(const Scene& scene, const ConstBatchRows& u, SimulationBatch& batch, int steps) {
  check(scene, u, batch, steps);
  if (const int rows = rows_of_active(scene, batch.active); rows != batch.f.cols())
    batch.f = BatchMatrix::Zero(batch.q.rows(), rows);
  Work& work = *batch.work;
  internal::take_all_changes(scene, work.scene);
  internal::run_items(std::span<internal::Failure>(work.failures), static_cast<std::ptrdiff_t>(work.parts.size()),
                      [&](std::ptrdiff_t k, int thread) {
                        step_part(scene, u, steps, work, work.of_threads[thread], work.parts[k], batch);
                      });
}

void set_state(const Scene& scene, Eigen::Index k, const ConstVector& q, const ConstVector& v, SimulationBatch& batch) {
  expect(q.size() == scene.nq && v.size() == scene.nv && batch.q.cols() == scene.nq,
         "set_state: q or v has a wrong size, nq and nv numbers are expected");
  expect(k >= 0 && k < batch.q.rows(),
         "set_state: the number of the state is below 0 or too large, a number of a state of the batch is expected");
  Work& work = *batch.work;
  Part& part = work.parts[k / work.copies];
  const int copy = static_cast<int>(k - part.first), last = copy + 1 == part.states ? work.copies : copy + 1;
  const auto set = [&](SimulationData& d, int at) {
    d.q.segment(at * scene.nq, scene.nq) = q;
    d.v.segment(at * scene.nv, scene.nv) = v;
  };
  if (!part.alone.empty())
    set(part.alone[copy], 0);
  else
    with_data(work, work.of_threads.front(), part, [&](SimulationData& d) {
      for (int at = copy; at < last; ++at) {  // surplus copies repeat the last state, and are set too
        set(d, at);
        if (d.steps > 0) renew(scene, work.scene, at, batch.f.cols(), d);
      }
      return false;
    });
  batch.q.row(k) = q.transpose(), batch.v.row(k) = v.transpose();
}

}  // namespace manycontact
