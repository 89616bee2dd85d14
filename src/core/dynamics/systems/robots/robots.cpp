#include <algorithm>
#include <cmath>
#include <limits>

#include "../../derivatives/products.hpp"
#include "../../internal.hpp"
#include "../../workspace/threads.hpp"
#include "derivatives.hpp"
#include "manycontact/rank/row_units.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace internal {

namespace {

using Member = RobotsSystem::Robot;
using Kernel = lanes::RobotBlocks;
using Memory = lanes::RobotBlocks::Memory;

void form_robot_batches(const Scene& scene, Workspace& w, RobotsSystem& s) {  // splits each group into SIMD batches
  s.batches.clear();
  std::size_t size = 0;
  for (std::size_t k = 0; k < s.order.size(); ++k) {
    const RobotsSystem::OfRobot& r = s.robots[s.order[k]];
    const auto* last = s.batches.empty() ? nullptr : &s.batches.back();
    if (!last || last->group != r.group || last->count == w.lanes.level->robots.width ||
        !lanes::alike(scene, s.robots[s.order[last->first]].contacts, r.contacts))
      s.batches.push_back({r.group, static_cast<int>(k), 0, 0});
    ++s.batches.back().count;
  }
  const auto width = [&w](const RobotsSystem::Batch& batch) {
    return static_cast<std::size_t>(batch.count == 1 ? 1 : w.lanes.level->robots.width);
  };
  const auto shared = [&](const RobotsSystem::Batch& batch) {
    return sparse::padded(width(batch) * batch.group->plan->memory_size());
  };
  const auto of_each = [](const lanes::BlockPlan& plan) { return sparse::padded(lanes::Border::size(plan.border())); };
  for (RobotsSystem::Batch& batch : s.batches) {
    batch.at = size;
    size += shared(batch) + batch.count * of_each(*batch.group->plan);
  }
  s.memory.reserve(size);
  for (const RobotsSystem::Batch& batch : s.batches) {
    const lanes::BlockPlan& plan = *batch.group->plan;
    double *memory = s.memory.data() + batch.at, *at = memory + shared(batch),
           *joins = memory + width(batch) * plan.kept_size();
    for (int k = batch.first; k < batch.first + batch.count; ++k, at += of_each(plan), joins += plan.joins_size()) {
      Member& member = s.members[k];
      member.number = s.owner.island.robots[s.order[k]];
      member.contacts = s.robots[s.order[k]].contacts.data();
      member.border = {at, plan.border()};
      member.joins = joins;
    }
  }
}

void form_contact_batches(const Scene& scene, const Workspace& w, RobotsSystem& s) {
  s.contact_batches.clear();
  for (std::size_t k = 0; k < s.contacts.size(); ++k) {
    const RobotsSystem::Coupling& coupling = s.contacts[k];
    const auto* last = s.contact_batches.empty() ? nullptr : &s.contact_batches.back();
    if (!last || last->group != coupling.group || last->count == w.lanes.level->robots.width ||
        !lanes::alike_rows(scene.contacts[s.contacts[last->first].contact], scene.contacts[coupling.contact]))
      s.contact_batches.push_back({coupling.group, static_cast<int>(k), 0});
    ++s.contact_batches.back().count;
  }
}

// Calls use(robot's border, row in G_r, interface row) for each row of each robot's G_r.
template <class Use>
void each_border_row(const RobotsSystem& s, Use&& use) {
  for (std::size_t k = 0; k < s.robots.size(); ++k) {
    const std::vector<int>& rows = s.interface->robots[k].interface_rows;
    for (std::size_t i = 0; i < rows.size(); ++i) use(s.member(k).border, i, rows[i]);
  }
}

bool all_sound(const RobotsSystem& s) {
  return std::all_of(s.members.begin(), s.members.end(), [](const Member& r) { return r.sound; });
}

// Evaluates J and a0 of contacts that couple two robots. Stores a0 in s.b, which interface_right_side overwrites.
void evaluate_interface(const Scene& scene, Workspace& w, RobotsSystem& s) {
  const auto join = [&](int robot, int among) {
    const auto& r = s.robots[robot];
    return s.members[r.member].joins + r.group->plan->size_of_ends<lanes::JoinedEnd>(among);
  };
  each_item(
      w, s.contact_batches.size(), are_worth_threads(w, costs::kWalk * s.seconds),
      [&](std::size_t k, ThreadWork& thread) {
        const RobotsSystem::ContactBatch& batch = s.contact_batches[k];
        const auto couplings = std::span(s.contacts).subspan(batch.first, batch.count);
        thread.interface_contacts.clear();
        for (const RobotsSystem::Coupling& coupling : couplings)
          thread.interface_contacts.push_back({&scene.contacts[coupling.contact], join(coupling.A, coupling.among_A),
                                               join(coupling.B, coupling.among_B), s.b.data() + coupling.row,
                                               left_of(w, coupling.contact), 0, 0});
        batch.group->kernels[thread.number].of(couplings.size()).evaluate(scene.gravity, thread.interface_contacts);
        for (std::size_t i = 0; i < couplings.size(); ++i) {
          couplings[i].motion = thread.interface_contacts[i].motion;
          couplings[i].smallest_row = thread.interface_contacts[i].smallest_row;
        }
      });
}

// Whether every interface row of J exceeds its rounding errors. Pivots do not reveal rows of mere rounding errors.
bool accept_rows(const Scene& scene, const RobotsSystem& s) {
  double smallest = std::numeric_limits<double>::infinity(), motion = 0;
  for (const Member& m : s.members) motion = std::max(motion, m.motion);
  for (const RobotsSystem::Coupling& c : s.contacts) {
    smallest = std::min(smallest, c.smallest_row);
    motion = std::max(motion, c.motion);
  }
  return scene.damping > 0 || smallest > tolerance::kRank * motion;
}

void interface_right_side(const SceneData& data, RobotsSystem& s) {  // s.b becomes prescribed acceleration - a0
  for (const RobotsSystem::Coupling& coupling : s.contacts)
    for (int i = 0; i < coupling.rows; ++i)
      s.b[coupling.row + i] = prescribed_in(data, coupling.contact, i) - s.b[coupling.row + i];
}

bool sound_interface_pivots(const RobotsSystem& s) {  // whether pivots of -S exceed their rounding errors
  for (std::size_t k = 0; k < s.D.size(); ++k) {
    const rank::Pivot<double> pivot{false, s.D[k], s.terms[k], 0};
    if (!rank::is_left(pivot) || !rank::has_its_sign(pivot)) return false;
  }
  return true;
}

// Assembles and factorizes -S = -sum_r G_r K_r^-1 G_r^T - delta I. Returns false if pivots of -S are not sound.
bool factor_interface(double damping, RobotsSystem& s) {
  const Interface& interface = *s.interface;
  std::fill(s.Sx.begin(), s.Sx.end(), 0.0);
  for (int k = 0; k < interface.rows(); ++k) s.Sx[interface.S.p[k + 1] - 1] = -damping;
  for (std::size_t k = 0; k < s.robots.size(); ++k) {
    const double* S = s.member(k).border.S;
    for (int slot : interface.robots[k].slot) s.Sx[slot] += *S++;
  }
  sparse::panel_kernels().factor(interface.schedule, s.Sx.data(), nullptr, 0, s.L.data(), s.D.data(), s.terms.data());
  for (int k = 0; k < interface.rows(); ++k) s.terms[k] -= std::abs(s.Sx[interface.S.p[k + 1] - 1]);
  each_border_row(s, [&](const lanes::Border& border, std::size_t i, int row) {
    s.terms[interface.place[row]] += border.terms()[i];  // replaces |S_kk| by the magnitudes it was summed from
  });
  for (double& terms : s.terms) terms += damping;
  return sound_interface_pivots(s);
}

void solve_interface(RobotsSystem& s) {  // y += interface rows of K^-1 r; copies this step to the robots' borders
  const Interface& interface = *s.interface;
  for (int k = 0; k < interface.rows(); ++k) s.step[interface.place[k]] = s.r[k];
  each_border_row(
      s, [&](const lanes::Border& border, std::size_t i, int row) { s.step[interface.place[row]] += border.b()[i]; });
  sparse::panel_kernels().solve_vector(interface.schedule, s.L.data(), s.D.data(), s.step.data());
  for (int k = 0; k < interface.rows(); ++k) s.y[k] += s.step[interface.place[k]];
  each_border_row(
      s, [&](const lanes::Border& border, std::size_t i, int row) { border.y()[i] = s.step[interface.place[row]]; });
}

// Computes the interface rows' residual r = b - sum_r G_r x_r + delta y, and sums of magnitudes of its terms.
void interface_residual(double damping, RobotsSystem& s) {
  for (std::size_t k = 0; k < s.b.size(); ++k) {
    s.r[k] = s.b[k] + damping * s.y[k];
    s.scale[k] = std::abs(s.b[k]) + damping * std::abs(s.y[k]);
  }
  each_border_row(s, [&](const lanes::Border& border, std::size_t i, int row) {
    s.r[row] += border.r()[i];
    s.scale[row] += border.scale()[i];
  });
}

struct Largest {  // largest residuals and magnitudes of terms: [0] dynamics rows, [1] contact rows
  double r[2] = {0, 0}, scale[2] = {0, 0};
};
Largest largest_of(const RobotsSystem& s) {
  Largest out;
  const auto take = [](double x, double& largest) { largest = sparse::larger_or_nan(largest, x); };
  for (const Member& m : s.members)
    for (int row : {0, 1}) take(m.r[row], out.r[row]), take(m.scale[row], out.scale[row]);
  for (std::size_t k = 0; k < s.r.size(); ++k) take(std::abs(s.r[k]), out.r[1]), take(s.scale[k], out.scale[1]);
  return out;
}

// Returns the componentwise backward error of the interface rows. The residual of a row with tiny terms is judged
// relative to the island's largest terms.
double largest_interface_error(const RobotsSystem& s) {
  double largest = 0;
  for (const Member& m : s.members) largest = std::max({largest, m.scale[0], m.scale[1]});
  return sparse::componentwise_backward_error(s.r, s.scale, largest);
}

// Returns the componentwise backward error (sparse/refine.hpp), or NaN. A row with tiny terms is judged relative to
// the largest terms of its robot (an interface row: of the island), as at rest its terms are only rounding errors.
double backward_error_of(const RobotsSystem& s) {
  double error = largest_interface_error(s);
  for (const Member& m : s.members) error = sparse::larger_or_nan(error, m.error);
  return error;
}

void report_answer(const Scene& scene, const RobotsSystem& s, const sparse::Refinement& refinement,
                   IslandReport& report) {
  reset(report, s.owner.island);
  report.method = Method::kSparseLdl;
  report.order = s.within;
  report.factor_nonzeros = s.interface->schedule.nonzeros() + s.owner.island.size();
  for (const RobotsSystem::OfRobot& r : s.robots) report.factor_nonzeros += r.group->plan->factor_nonzeros();
  report.refinement_steps = refinement.steps;
  const Largest largest = largest_of(s);
  report_residuals(scene, largest.r, largest.scale, report);
  report.backward_error = refinement.backward_error;
}

std::span<const int> dependent_rows(RobotsSystem& s) {  // rows of J, numbered in the island
  IslandWork& d = s.owner;
  d.matrix.dependent.clear();
  for (std::size_t k = 0; k < s.robots.size(); ++k) {
    const lanes::BlockPlan& plan = *s.robots[k].group->plan;
    for (int row : s.member(k).dependent) {
      const int own = plan.pattern->perm[row] - plan.pattern->nv;
      const std::vector<int>& first = plan.island.row_offset;
      const auto c = std::upper_bound(first.begin(), first.end(), own) - first.begin() - 1;
      d.matrix.dependent.push_back(d.island.row_offset[s.interface->robots[k].contacts[c]] + own - first[c]);
    }
  }
  return d.matrix.dependent;
}

// Reports the dependent rows and their inconsistency. Returns false if only the dense reference solver can judge them.
bool report_dependence(const Scene& scene, const SceneData& data, RobotsSystem& s, IslandReport& report) {
  rank::Contradiction<double> all;
  for (const Member& m : s.members) all.add(m.contradiction);
  for (std::size_t k = 0; k < s.b.size(); ++k) all.add_products(s.scale[k] - std::abs(s.b[k]), std::abs(s.b[k]));
  if (all.needs_dense()) return false;
  report.backward_error = backward_error_of(s);
  s.contradiction = all.exceeds_rounding();
  report_dependent_rows(scene, data, s.owner, dependent_rows(s), all, report);
  return true;
}

void store_answer(const lanes::Job& job, Workspace& w, RobotsSystem& s) {
  each_batch(w, s, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.store(job, robots, memory.at);
  });
  for (const RobotsSystem::Coupling& coupling : s.contacts)
    for (int i = 0; i < coupling.rows; ++i) job.f[job.f_offset[coupling.contact] + i] = -s.y[coupling.row + i];
}

// Whether rounding errors of damped contact rows are small relative to delta |f|, as in RobotBlock::plainly_damped.
bool plainly_damped(const Scene& scene, const SceneData& data, const RobotsSystem& s) {
  if (scene.damping == 0) return true;
  double force = 0;
  each_force_block(scene, data.f_offset, s.owner.island, [&](int first, int, int n) {
    force = std::max(force, data.f.segment(first, n).cwiseAbs().maxCoeff());
  });
  for (const Member& m : s.members) force = std::max(force, tolerance::kLeastLoad * m.scale[0]);
  return largest_of(s).scale[1] <= tolerance::kInDoubt * scene.damping * force;
}

// Solves x = K^-1 b with refinement.
sparse::Refinement solve_refined(Workspace& w, double damping, int max_steps, RobotsSystem& s) {
  std::fill(s.y.begin(), s.y.end(), 0.0);
  s.r = s.b;
  const auto correct = [&] {
    solve_interface(s);
    each_batch(w, s, [](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
      kernel.correct(robots, memory);
    });
    interface_residual(damping, s);
  };
  correct();
  return sparse::refine(
      max_steps, tolerance::kRefined, [&] { return backward_error_of(s); }, correct);
}

// Overwrites [a; y] of Workspace::products with K^-1 [a; y], refined once.
void solve_once_refined(const Scene& scene, SceneData& data, RobotsSystem& s, ProductWork& work) {
  Workspace& w = *data.workspace;
  const auto turn = [&] {  // y = -f
    each_force_block(scene, data.f_offset, s.owner.island,
                     [&](int first, int, int n) { work.y.segment(first, n) *= -1; });
  };
  turn();
  const lanes::Job job{scene,         data.serial, nullptr,       nullptr,      nullptr,
                       data.f_offset, nullptr,     work.a.data(), work.y.data()};
  each_batch(w, s, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.load(job, robots, memory.at);
  });
  for (const RobotsSystem::Coupling& coupling : s.contacts)
    for (int i = 0; i < coupling.rows; ++i) s.b[coupling.row + i] = -work.y[data.f_offset[coupling.contact] + i];
  (void)solve_refined(w, scene.damping, 1, s);
  store_answer(job, w, s);
  turn();
}

}  // namespace

void report_dependent_rows(const Scene& scene, const SceneData& data, IslandWork& d, std::span<const int> rows,
                           const rank::Contradiction<double>& contradiction, IslandReport& report) {
  d.deficient = true;
  report.status = contradicts(scene, data, contradiction, d) ? Status::kInconsistent : Status::kRedundant;
  report.reason = Reason::kSmallPivot;
  report.rank -= static_cast<int>(rows.size());
  name_dependent_rows(data, d.island, rows, report);
}

double interface_error(double damping, RobotsSystem& s) {
  interface_residual(damping, s);
  return sparse::componentwise_backward_error(s.r, s.scale);
}

}  // namespace internal

RobotsSystem::RobotsSystem(IslandWork& island) : owner(island) {}
RobotsSystem::~RobotsSystem() = default;

bool RobotsSystem::factorize(const Scene& scene, SceneData& data) {
  using namespace internal;
  Workspace& w = *data.workspace;
  const lanes::Job job = job_at_state(scene, data);
  state = 0;
  ++owner.factorizations;
  form_robot_batches(scene, w, *this);
  form_contact_batches(scene, w, *this);
  each_batch(w, *this, [&](internal::Kernel& kernel, std::span<Robot> robots, internal::Memory memory, ThreadWork&) {
    kernel.evaluate(job, robots, memory);
  });
  if (!all_sound(*this)) return false;
  evaluate_interface(scene, w, *this);
  if (!accept_rows(scene, *this)) return false;
  each_batch(w, *this, [&](internal::Kernel& kernel, std::span<Robot> robots, internal::Memory memory, ThreadWork&) {
    kernel.factor(robots, memory);
  });
  if (!all_sound(*this) || !factor_interface(scene.damping, *this) || !std::isfinite(growth())) return false;
  interface_right_side(data, *this);
  state = w.state;
  return true;
}

bool RobotsSystem::rows_depend() const {
  return std::ranges::any_of(members, [](const Robot& r) { return !r.dependent.empty(); });
}

double RobotsSystem::growth() const {
  double largest = 0, diagonal = 0, most = 1;
  for (const Robot& r : members) {
    largest = std::max(largest, r.terms);
    diagonal = std::max(diagonal, r.diagonal);
    if (r.diagonal > 0) most = std::max(most, r.terms / r.diagonal);
  }
  for (double t : terms) largest = std::max(largest, t);
  return diagonal > 0 ? std::max(most, largest / diagonal) : most;
}

bool RobotsSystem::solve(const Scene& scene, SceneData& data, ThreadWork&, IslandReport& report) {
  Workspace& w = *data.workspace;
  if (!solves || !internal::usable_numbers(scene)) return false;
  refused = !factorize(scene, data);
  if (refused) return false;
  const sparse::Refinement refinement = internal::solve_refined(w, scene.damping, tolerance::kRefinementSteps, *this);
  state = 0;  // set again once the solution is accepted
  if (!(refinement.backward_error <= tolerance::kConverged)) return false;
  first_error = refinement.first;
  internal::store_answer(internal::job_at_state(scene, data), w, *this);
  if (!internal::plainly_damped(scene, data, *this)) return false;
  const bool dependent = rows_depend();
  if (dependent)
    internal::each_batch(
        w, *this, [](internal::Kernel& kernel, std::span<Robot> of_batch, internal::Memory memory_of, ThreadWork&) {
          kernel.finish(of_batch, memory_of);
        });
  internal::report_answer(scene, *this, refinement, report);
  if (dependent && !internal::report_dependence(scene, data, *this, report)) return false;
  state = w.state;
  return true;
}

bool RobotsSystem::jvp(const Scene& scene, SceneData& data, ThreadWork&, const TangentProduct& p) {
  if (owner.deficient) return false;  // only MatrixSystem adds the terms of least-norm forces
  internal::place_at_state(scene, data, owner.island);
  internal::tangent_product(scene, data, owner.island, p,
                            [&](ProductWork& work) { internal::solve_once_refined(scene, data, *this, work); });
  return true;
}

bool RobotsSystem::vjp(const Scene& scene, SceneData& data, ThreadWork&, const AdjointProduct& p) {
  if (owner.deficient) return false;  // only MatrixSystem adds the terms of least-norm forces
  internal::place_at_state(scene, data, owner.island);
  internal::adjoint_product(scene, data, owner.island, p,
                            [&](ProductWork& work) { internal::solve_once_refined(scene, data, *this, work); });
  return true;
}

bool RobotsSystem::invert(const Scene& scene, SceneData& data, ThreadWork&, ProductWork& work) {
  if (owner.deficient) return false;
  internal::solve_once_refined(scene, data, *this, work);
  return true;
}

}  // namespace manycontact
