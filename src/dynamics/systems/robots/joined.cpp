// Islands of several robots, in lanes: the numbers.

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../steps.hpp"
#include "../../threads.hpp"
#include "each_batch.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

namespace {

using Member = JoinedRobots::Robot;
using Kernel = lanes::RobotBlocks;
using Memory = lanes::RobotBlocks::Memory;

// Robots alike, as many as stand side by side.
void form_robot_batches(const Scene& scene, Workspace& w, const IslandWork& d, JoinedRobots& joined) {
  joined.batches.clear();
  std::size_t size = 0;
  for (std::size_t k = 0; k < joined.order.size(); ++k) {
    const JoinedRobots::OfRobot& r = joined.robots[joined.order[k]];
    const auto* last = joined.batches.empty() ? nullptr : &joined.batches.back();
    if (!last || last->group != r.group || last->count == w.lanes.level->width ||
        !lanes::alike(scene, joined.robots[joined.order[last->first]].contacts, r.contacts))
      joined.batches.push_back({r.group, static_cast<int>(k), 0, 0});
    ++joined.batches.back().count;
  }
  const auto width = [](const JoinedRobots::Batch& batch) {
    return batch.group->kernels.front()->width(batch.count == 1);
  };
  const auto shared = [&](const JoinedRobots::Batch& batch) {
    return sparse::padded(width(batch) * batch.group->plan->memory_size());
  };
  const auto of_each = [](const lanes::BlockPlan& plan) { return sparse::padded(lanes::Border::size(plan.border)); };
  for (JoinedRobots::Batch& batch : joined.batches) {
    batch.at = size;
    size += shared(batch) + batch.count * of_each(*batch.group->plan);
  }
  joined.memory.reserve(size);
  for (const JoinedRobots::Batch& batch : joined.batches) {
    const lanes::BlockPlan& plan = *batch.group->plan;
    double *memory = joined.memory.data() + batch.at, *at = memory + shared(batch),
           *joins = memory + width(batch) * plan.kept_size();
    for (int k = batch.first; k < batch.first + batch.count; ++k, at += of_each(plan), joins += plan.joins_size()) {
      Member& member = joined.members[k];
      member.number = d.island.robots[joined.order[k]];
      member.contacts = joined.robots[joined.order[k]].contacts.data();
      member.border = {at, plan.border};
      member.joins = joins;
    }
  }
}

void form_contact_batches(const Scene& scene, const Workspace& w, JoinedRobots& joined) {
  joined.contact_batches.clear();
  for (std::size_t k = 0; k < joined.contacts.size(); ++k) {
    const JoinedRobots::Joint& joint = joined.contacts[k];
    const auto* last = joined.contact_batches.empty() ? nullptr : &joined.contact_batches.back();
    if (!last || last->group != joint.group || last->count == w.lanes.level->width ||
        !lanes::alike_rows(scene.contacts[joined.contacts[last->first].contact], scene.contacts[joint.contact]))
      joined.contact_batches.push_back({joint.group, static_cast<int>(k), 0});
    ++joined.contact_batches.back().count;
  }
}

// use(a robot's border, its row, the joining row) for each row of G_1, ..., G_n.
template <class Use>
void each_border_row(const JoinedRobots& joined, Use&& use) {
  for (std::size_t k = 0; k < joined.robots.size(); ++k) {
    const std::vector<int>& rows = joined.joining->robots[k].joining;
    for (std::size_t i = 0; i < rows.size(); ++i) use(joined.member(k).border, i, rows[i]);
  }
}

bool all_sound(const JoinedRobots& joined) {
  return std::all_of(joined.members.begin(), joined.members.end(), [](const Member& r) { return r.sound; });
}

// J and a0 of the contacts that join robots, a0 into b.
void evaluate_joining(const Scene& scene, Workspace& w, JoinedRobots& joined) {
  const auto join = [&](int robot, int among) {
    const auto& r = joined.robots[robot];
    return joined.members[r.member].joins + r.group->plan->size_of_ends<lanes::JoinedEnd>(among);
  };
  each_item(w, joined.contact_batches.size(), [&](std::size_t k, ThreadWork& thread) {
    const JoinedRobots::ContactBatch& batch = joined.contact_batches[k];
    const auto joints = std::span(joined.contacts).subspan(batch.first, batch.count);
    thread.joining.clear();
    for (const JoinedRobots::Joint& joint : joints)
      thread.joining.push_back({&scene.contacts[joint.contact], join(joint.A, joint.among_A),
                                join(joint.B, joint.among_B), joined.b.data() + joint.row, 0, 0});
    batch.group->kernels[thread.number]->evaluate(scene.gravity, thread.joining);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      joints[i].motion = thread.joining[i].motion;
      joints[i].smallest_row = thread.joining[i].smallest_row;
    }
  });
}

// No row of J is nothing but rounding beside the contacts' motions: pivots do not show that.
bool believable_rows(const Scene& scene, const JoinedRobots& joined) {
  double smallest = std::numeric_limits<double>::infinity(), motion = 0;
  const auto add = [&](const auto& x) {
    smallest = std::min(smallest, x.smallest_row);
    motion = std::max(motion, x.motion);
  };
  std::for_each(joined.members.begin(), joined.members.end(), add);
  std::for_each(joined.contacts.begin(), joined.contacts.end(), add);
  return scene.damping > 0 || smallest > tolerance::kRank * motion;
}

// b = wanted - a0 of the joining rows, which hold a0.
void joining_right_side(const SceneData& data, JoinedRobots& joined) {
  for (const JoinedRobots::Joint& joint : joined.contacts)
    for (int i = 0; i < joint.rows; ++i)
      joined.b[joint.row + i] = wanted_in(data, joint.contact, i) - joined.b[joint.row + i];
}

// -S = -sum_r G_r K_r^-1 G_r^T - delta I and its factor; false where its pivots are not sound.
bool factor_joining(double damping, JoinedRobots& joined) {
  const Joining& joining = *joined.joining;
  std::fill(joined.Sx.begin(), joined.Sx.end(), 0.0);
  for (int k = 0; k < joining.rows(); ++k) joined.Sx[joining.S.p[k + 1] - 1] = -damping;
  for (std::size_t k = 0; k < joined.robots.size(); ++k) {
    const double* S = joined.member(k).border.S;
    for (int slot : joining.robots[k].slot) joined.Sx[slot] += *S++;
  }
  sparse::panel_kernels().factor(joining.schedule, joined.Sx.data(), joined.L.data(), joined.D.data(),
                                 joined.terms.data());
  for (int k = 0; k < joining.rows(); ++k) joined.terms[k] -= std::abs(joined.Sx[joining.S.p[k + 1] - 1]);
  each_border_row(joined, [&](const lanes::Border& border, std::size_t i, int row) {
    joined.terms[joining.place[row]] += border.terms()[i];  // the robots' terms in its place
  });
  for (double& terms : joined.terms) terms += damping;
  for (double pivot : joined.D)
    if (!(pivot < 0) || !std::isfinite(pivot)) return false;
  return sparse::smallest_pivot_ratio(joining.rows(), joined.D.data(), joined.terms.data()) >= tolerance::kPivotLeft;
}

// y += the joining rows of K^-1 r; each robot gets its part of what is added.
void solve_joining(JoinedRobots& joined) {
  const Joining& joining = *joined.joining;
  for (int k = 0; k < joining.rows(); ++k) joined.step[joining.place[k]] = joined.r[k];
  each_border_row(joined, [&](const lanes::Border& border, std::size_t i, int row) {
    joined.step[joining.place[row]] += border.b()[i];
  });
  sparse::panel_kernels().solve_vector(joining.schedule, joined.L.data(), joined.D.data(), joined.step.data());
  for (int k = 0; k < joining.rows(); ++k) joined.y[k] += joined.step[joining.place[k]];
  each_border_row(joined, [&](const lanes::Border& border, std::size_t i, int row) {
    border.y()[i] = joined.step[joining.place[row]];
  });
}

// r = b - sum_r G_r x_r + delta y, and the sizes of its terms.
void joining_residual(double damping, JoinedRobots& joined) {
  for (std::size_t k = 0; k < joined.b.size(); ++k) {
    joined.r[k] = joined.b[k] + damping * joined.y[k];
    joined.scale[k] = std::abs(joined.b[k]) + damping * std::abs(joined.y[k]);
  }
  each_border_row(joined, [&](const lanes::Border& border, std::size_t i, int row) {
    joined.r[row] += border.r()[i];
    joined.scale[row] += border.scale()[i];
  });
}

// The largest residuals and sizes of dynamics rows and of contact rows.
struct Largest {
  double r[2] = {0, 0}, scale[2] = {0, 0};
};
Largest largest_of(const JoinedRobots& joined) {
  Largest out;
  const auto take = [](double x, double& largest) { largest = sparse::larger_or_nan(largest, x); };
  for (const Member& m : joined.members)
    for (int row : {0, 1}) take(m.r[row], out.r[row]), take(m.scale[row], out.scale[row]);
  for (std::size_t k = 0; k < joined.r.size(); ++k)
    take(std::abs(joined.r[k]), out.r[1]), take(joined.scale[k], out.scale[1]);
  return out;
}

// The componentwise backward error (sparse/refine.hpp) of the answer, NaN where any is. Rows are judged beside the
// largest of their robot, or of the joining rows: no milder than beside the island's.
double backward_error_of(const JoinedRobots& joined) {
  double error = sparse::componentwise_backward_error(joined.r, joined.scale);
  for (const Member& m : joined.members) error = sparse::larger_or_nan(error, m.error);
  return error;
}

void report_joined(const Scene& scene, const JoinedRobots& joined, const sparse::Refinement& refinement, IslandWork& d,
                   IslandReport& report) {
  reset(report, d.island);
  report.method = Method::kSparseLdl;
  report.order = d.choice.order;
  report.factor_nonzeros = joined.joining->symbolic.nonzeros() + d.island.size();
  for (const JoinedRobots::OfRobot& r : joined.robots) report.factor_nonzeros += r.group->plan->factor_nonzeros();
  report.refinement_steps = refinement.steps;
  Largest largest = largest_of(joined);
  largest.scale[1] = std::max(largest.scale[1], scene.gravity.norm());
  report.residual_dynamics = largest.r[0] == 0 ? 0 : largest.r[0] / largest.scale[0];
  report.residual_contact = largest.r[1] == 0 ? 0 : largest.r[1] / largest.scale[1];
  report.backward_error = refinement.backward_error;
  d.factor = nullptr;
  d.first_error = refinement.first;
  d.factorizations = 1;
  d.in_lanes = true;
  d.panel_is_safe = false;
}

// The answer, in the scene's coordinates.
void store_answer(const lanes::Job& job, Workspace& w, JoinedRobots& joined) {
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.store(job, robots, memory.at);
  });
  for (const JoinedRobots::Joint& joint : joined.contacts)
    for (int i = 0; i < joint.rows; ++i) job.f[job.f_offset[joint.contact] + i] = -joined.y[joint.row + i];
}

// x = K^-1 b, refined.
sparse::Refinement solve_refined_joined(Workspace& w, double damping, int max_steps, JoinedRobots& joined) {
  std::fill(joined.y.begin(), joined.y.end(), 0.0);
  joined.r = joined.b;
  const auto correct = [&] {  // x += K^-1 r
    solve_joining(joined);
    each_batch(w, joined, [](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
      kernel.correct(robots, memory);
    });
    joining_residual(damping, joined);
  };
  correct();
  return sparse::refine(
      max_steps, tolerance::kRefined, [&] { return backward_error_of(joined); }, correct);
}

bool solve_joined_island(const lanes::Job& job, SceneData& data, IslandWork& d, IslandReport& report) {
  const Scene& scene = job.scene;
  Workspace& w = *data.workspace;
  JoinedRobots& joined = *d.joined;
  if (!factorize_joined(job, data, d)) return false;
  const sparse::Refinement refinement = solve_refined_joined(w, scene.damping, tolerance::kRefinementSteps, joined);
  if (!(refinement.backward_error <= tolerance::kConverged)) return false;
  store_answer(job, w, joined);
  report_joined(scene, joined, refinement, d, report);
  joined.serial = job.serial;
  for (int r : d.island.robots) w.robots[r].known = false;
  return true;
}

}  // namespace

bool factorize_joined(const lanes::Job& job, SceneData& data, IslandWork& d) {
  const Scene& scene = job.scene;
  Workspace& w = *data.workspace;
  JoinedRobots& joined = *d.joined;
  joined.serial = 0;
  joined.terms_known = false;
  form_robot_batches(scene, w, d, joined);
  form_contact_batches(scene, w, joined);
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.evaluate(job, robots, memory);
  });
  if (!all_sound(joined)) return false;
  evaluate_joining(scene, w, joined);
  if (!believable_rows(scene, joined)) return false;
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.factor(robots, memory);
  });
  if (!all_sound(joined) || !factor_joining(scene.damping, joined) || !std::isfinite(growth_of(joined))) return false;
  joining_right_side(data, joined);
  return true;
}

double growth_of(const JoinedRobots& joined) {
  double terms = 0, diagonal = 0, most = 1;
  for (const Member& r : joined.members) {
    terms = std::max(terms, r.terms);
    diagonal = std::max(diagonal, r.diagonal);
    if (r.diagonal > 0) most = std::max(most, r.terms / r.diagonal);
  }
  for (double t : joined.terms) terms = std::max(terms, t);
  return diagonal > 0 ? std::max(most, terms / diagonal) : most;
}

void solve_joined(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return;
  const lanes::Job job{scene,         w.solves, w.q.data(),    data.v.data(), data.tau.data(),
                       data.f_offset, w.wanted, data.a.data(), data.f.data()};
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (w.islands[i]->joined && w.islands[i]->joined->solves && !w.islands[i]->was_dependent)  // else answered already
      (void)solve_joined_island(job, data, *w.islands[i], data.report.islands[i]);
}

bool solved_joined(const SceneData& data, const IslandWork& d) {
  return d.joined && d.joined->solves && d.joined->serial == data.serial;
}

void solve_once_refined_joined(const Scene& scene, SceneData& data, IslandWork& d, Eigen::VectorXd& a,
                               Eigen::VectorXd& f) {
  Workspace& w = *data.workspace;
  JoinedRobots& joined = *d.joined;
  const lanes::Job job{scene, data.serial, nullptr, nullptr, nullptr, data.f_offset, nullptr, a.data(), f.data()};
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    kernel.load(job, robots, memory.at);
  });
  for (const JoinedRobots::Joint& joint : joined.contacts)
    for (int i = 0; i < joint.rows; ++i) joined.b[joint.row + i] = -f[data.f_offset[joint.contact] + i];
  (void)solve_refined_joined(w, scene.damping, 1, joined);
  store_answer(job, w, joined);
}

double joining_error(double damping, JoinedRobots& joined) {
  joining_residual(damping, joined);
  return sparse::componentwise_backward_error(joined.r, joined.scale);
}

void evaluate_joined(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  const auto unknown = [](const IslandWork& d) { return d.in_lanes && d.joined && !d.joined->terms_known; };
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork&) {
    IslandWork& d = *w.islands[i];
    if (!unknown(d)) return;
    evaluate(scene, w.q, data.v, w, d.island);
    d.joined->terms_known = true;
  });
}

}  // namespace manycontact::internal
