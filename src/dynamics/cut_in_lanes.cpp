// An island cut into robots: the numbers.

#include <algorithm>
#include <cmath>
#include <limits>

#include "cut.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"
#include "threads.hpp"

namespace manycontact::internal {

namespace {

using CutMember = CutIsland::Robot;
using Memory = lanes::CutRobots::Memory;

// Robots alike, as many as stand side by side.
void form_robot_batches(const Scene& scene, Workspace& w, const IslandWork& d, CutIsland& cut) {
  cut.batches.clear();
  std::size_t size = 0;
  for (std::size_t k = 0; k < cut.order.size(); ++k) {
    const CutIsland::OfRobot& r = cut.robots[cut.order[k]];
    const auto* last = cut.batches.empty() ? nullptr : &cut.batches.back();
    if (!last || last->group != r.group || last->count == w.lanes.level->width ||
        !lanes::alike(scene, cut.robots[cut.order[last->first]].contacts, r.contacts))
      cut.batches.push_back({r.group, static_cast<int>(k), 0, 0});
    ++cut.batches.back().count;
  }
  const auto width = [](const CutIsland::Batch& batch) {
    return batch.group->kernels.front()->width(batch.count == 1);
  };
  const auto shared = [&](const CutIsland::Batch& batch) {
    return sparse::padded(width(batch) * batch.group->robot->memory_size());
  };
  const auto of_each = [](const lanes::CutRobot& robot) { return sparse::padded(lanes::Border::size(robot.border)); };
  for (CutIsland::Batch& batch : cut.batches) {
    batch.at = size;
    size += shared(batch) + batch.count * of_each(*batch.group->robot);
  }
  cut.memory.reserve(size);
  for (const CutIsland::Batch& batch : cut.batches) {
    const lanes::CutRobot& robot = *batch.group->robot;
    double *memory = cut.memory.data() + batch.at, *at = memory + shared(batch),
           *joins = memory + width(batch) * robot.kept_size();
    for (int k = batch.first; k < batch.first + batch.count; ++k, at += of_each(robot), joins += robot.joins_size()) {
      CutMember& member = cut.members[k];
      member.number = d.island.robots[cut.order[k]];
      w.robots[member.number].known = false;
      member.contacts = cut.robots[cut.order[k]].contacts.data();
      member.border = {at, robot.border};
      member.joins = joins;
    }
  }
}

void form_contact_batches(const Scene& scene, const Workspace& w, CutIsland& cut) {
  cut.contact_batches.clear();
  for (std::size_t k = 0; k < cut.contacts.size(); ++k) {
    const CutIsland::Joint& joint = cut.contacts[k];
    const auto* last = cut.contact_batches.empty() ? nullptr : &cut.contact_batches.back();
    if (!last || last->group != joint.group || last->count == w.lanes.level->width ||
        !lanes::alike_rows(scene.contacts[cut.contacts[last->first].contact], scene.contacts[joint.contact]))
      cut.contact_batches.push_back({joint.group, static_cast<int>(k), 0});
    ++cut.contact_batches.back().count;
  }
}

// step(kernel, robots, their memory) for each batch, one way and the next time back: the last ones are still in the
// cache then.
template <class Step>
void each_batch(Workspace& w, CutIsland& cut, Step&& step) {
  cut.back = !cut.back;
  const std::size_t count = cut.batches.size();
  const auto item = [&](std::size_t k) -> const CutIsland::Batch& { return cut.batches[cut.back ? count - 1 - k : k]; };
  each_item(w, count, [&](std::size_t k, ThreadWork& thread) {
    const CutIsland::Batch& batch = item(k);
    const std::size_t next = k + w.threads.size();  // of the same thread
    double* memory = cut.memory.data();
    step(*batch.group->kernels[thread.number], std::span(cut.members).subspan(batch.first, batch.count),
         Memory{memory + batch.at, memory + (next < count ? item(next) : batch).at});
  });
}

bool all_sound(const CutIsland& cut) {
  return std::all_of(cut.members.begin(), cut.members.end(), [](const CutMember& r) { return r.sound; });
}

// J and a0 of the contacts that join robots, a0 into b.
void evaluate_joining(const Scene& scene, Workspace& w, CutIsland& cut) {
  each_item(w, cut.contact_batches.size(), [&](std::size_t k, ThreadWork& thread) {
    const CutIsland::ContactBatch& batch = cut.contact_batches[k];
    const auto joints = std::span(cut.contacts).subspan(batch.first, batch.count);
    thread.joining.clear();
    for (const CutIsland::Joint& joint : joints)
      thread.joining.push_back({&scene.contacts[joint.contact], cut.member(joint.A).joins + joint.at_A,
                                cut.member(joint.B).joins + joint.at_B, cut.b.data() + joint.row, 0, 0});
    batch.group->kernels[thread.number]->evaluate(scene.gravity, thread.joining);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      joints[i].motion = thread.joining[i].motion;
      joints[i].smallest_row = thread.joining[i].smallest_row;
    }
  });
}

// No row of J is nothing but rounding beside the contacts' motions: pivots do not show that.
bool believable_rows(const Scene& scene, const CutIsland& cut) {
  double smallest = std::numeric_limits<double>::infinity(), motion = 0;
  const auto add = [&](const auto& x) {
    smallest = std::min(smallest, x.smallest_row);
    motion = std::max(motion, x.motion);
  };
  std::for_each(cut.members.begin(), cut.members.end(), add);
  std::for_each(cut.contacts.begin(), cut.contacts.end(), add);
  return scene.damping > 0 || smallest > tolerance::kRank * motion;
}

// b = wanted - a0 of the joining rows, which hold a0.
void joining_right_side(const SceneData& data, CutIsland& cut) {
  for (const CutIsland::Joint& joint : cut.contacts)
    for (int i = 0; i < joint.rows; ++i)
      cut.b[joint.row + i] = wanted_in(data, joint.contact, i) - cut.b[joint.row + i];
}

// -S = -sum_r G_r K_r^-1 G_r^T - delta I and its factor; false where its pivots are not sound.
bool factor_joining(double damping, CutIsland& cut) {
  const Joining& joining = *cut.joining;
  std::fill(cut.Sx.begin(), cut.Sx.end(), 0.0);
  for (int k = 0; k < joining.rows(); ++k) cut.Sx[joining.S.p[k + 1] - 1] = -damping;
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {
    const double* S = cut.member(k).border.S;
    for (int slot : joining.robots[k].slot) cut.Sx[slot] += *S++;
  }
  sparse::panel_kernels().factor(joining.schedule, cut.Sx.data(), cut.L.data(), cut.D.data(), cut.terms.data());
  for (int k = 0; k < joining.rows(); ++k) cut.terms[k] -= std::abs(cut.Sx[joining.S.p[k + 1] - 1]);
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {  // the robots' terms in its place
    const Joining::OfRobot& r = joining.robots[k];
    const lanes::Border& border = cut.member(k).border;
    for (std::size_t i = 0; i < r.joining.size(); ++i) cut.terms[joining.place[r.joining[i]]] += border.terms()[i];
  }
  for (double& terms : cut.terms) terms += damping;
  for (double pivot : cut.D)
    if (!(pivot < 0) || !std::isfinite(pivot)) return false;
  return sparse::smallest_pivot_ratio(joining.rows(), cut.D.data(), cut.terms.data()) >= tolerance::kPivotLeft;
}

// Growth of K's entries, as Factor has it.
bool growth_is_finite(const CutIsland& cut) {
  double terms = 0, diagonal = 0;
  for (const CutMember& r : cut.members) {
    terms = std::max(terms, r.terms);
    diagonal = std::max(diagonal, r.diagonal);
  }
  for (double t : cut.terms) terms = std::max(terms, t);
  return diagonal == 0 || std::isfinite(terms / diagonal);
}

// y += the joining rows of K^-1 r; each robot gets its part of what is added.
void solve_joining(CutIsland& cut) {
  const Joining& joining = *cut.joining;
  for (int k = 0; k < joining.rows(); ++k) cut.step[joining.place[k]] = cut.r[k];
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {
    const Joining::OfRobot& r = joining.robots[k];
    const lanes::Border& border = cut.member(k).border;
    for (std::size_t i = 0; i < r.joining.size(); ++i) cut.step[joining.place[r.joining[i]]] += border.b()[i];
  }
  sparse::panel_kernels().solve_vector(joining.schedule, cut.L.data(), cut.D.data(), cut.step.data());
  for (int k = 0; k < joining.rows(); ++k) cut.y[k] += cut.step[joining.place[k]];
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {
    const Joining::OfRobot& r = joining.robots[k];
    const lanes::Border& border = cut.member(k).border;
    for (std::size_t i = 0; i < r.joining.size(); ++i) border.y()[i] = cut.step[joining.place[r.joining[i]]];
  }
}

// r = b - sum_r G_r x_r + delta y, and the sizes of its terms.
void joining_residual(double damping, CutIsland& cut) {
  const Joining& joining = *cut.joining;
  for (int k = 0; k < joining.rows(); ++k) {
    cut.r[k] = cut.b[k] + damping * cut.y[k];
    cut.scale[k] = std::abs(cut.b[k]) + damping * std::abs(cut.y[k]);
  }
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {
    const Joining::OfRobot& r = joining.robots[k];
    const lanes::Border& border = cut.member(k).border;
    for (std::size_t i = 0; i < r.joining.size(); ++i) {
      cut.r[r.joining[i]] += border.r()[i];
      cut.scale[r.joining[i]] += border.scale()[i];
    }
  }
}

// The largest residuals and sizes of dynamics rows and of contact rows.
struct Largest {
  double r[2] = {0, 0}, scale[2] = {0, 0};
};
Largest largest_of(const CutIsland& cut) {
  Largest out;
  const auto take = [](double x, double& largest) { largest = sparse::larger_or_nan(largest, x); };
  for (const CutMember& m : cut.members)
    for (int row : {0, 1}) take(m.r[row], out.r[row]), take(m.scale[row], out.scale[row]);
  for (std::size_t k = 0; k < cut.r.size(); ++k) take(std::abs(cut.r[k]), out.r[1]), take(cut.scale[k], out.scale[1]);
  return out;
}

// The componentwise backward error (sparse/refine.hpp) of the answer, NaN where any is. Rows are judged beside the
// largest of their robot, or of the joining rows: no milder than beside the island's.
double backward_error_of(const CutIsland& cut) {
  double error = sparse::componentwise_backward_error(cut.r, cut.scale);
  for (const CutMember& m : cut.members) error = sparse::larger_or_nan(error, m.error);
  return error;
}

void report_cut(const Scene& scene, const CutIsland& cut, const sparse::Refinement& refinement, std::uint64_t serial,
                IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  report.method = Method::kSparseLdl;
  report.order = d.choice.order;
  report.factor_nonzeros = cut.joining->symbolic.nonzeros() + d.island.size();
  for (const CutIsland::OfRobot& r : cut.robots) report.factor_nonzeros += r.group->robot->factor_nonzeros();
  report.refinement_steps = refinement.steps;
  Largest largest = largest_of(cut);
  largest.scale[1] = std::max(largest.scale[1], scene.gravity.norm());
  report.residual_dynamics = largest.r[0] == 0 ? 0 : largest.r[0] / largest.scale[0];
  report.residual_contact = largest.r[1] == 0 ? 0 : largest.r[1] / largest.scale[1];
  report.backward_error = refinement.backward_error;
  d.factor = nullptr;
  d.first_error = refinement.first;
  d.factorizations = 1;
  d.in_lanes = true;
  d.cut->terms_known = false;
  d.cut->serial = serial;
  d.panel_is_safe = false;
}

// The answer, in the scene's coordinates.
void store_answer(const lanes::Job& job, Workspace& w, CutIsland& cut) {
  each_batch(w, cut, [&](lanes::CutRobots& kernel, std::span<CutMember> robots, Memory memory) {
    kernel.store(job, robots, memory.at);
  });
  for (const CutIsland::Joint& joint : cut.contacts)
    for (int i = 0; i < joint.rows; ++i) job.f[job.f_offset[joint.contact] + i] = -cut.y[joint.row + i];
}

// x = K^-1 b, refined.
sparse::Refinement solve_refined_cut(Workspace& w, double damping, int max_steps, CutIsland& cut) {
  std::fill(cut.y.begin(), cut.y.end(), 0.0);
  cut.r = cut.b;
  const auto correct = [&] {  // x += K^-1 r
    solve_joining(cut);
    each_batch(w, cut, [](lanes::CutRobots& kernel, std::span<CutMember> robots, Memory memory) {
      kernel.correct(robots, memory);
    });
    joining_residual(damping, cut);
  };
  correct();
  return sparse::refine(
      max_steps, tolerance::kRefined, [&] { return backward_error_of(cut); }, correct);
}

bool solve_cut_island(const lanes::Job& job, SceneData& data, IslandWork& d, IslandReport& report) {
  const Scene& scene = job.scene;
  Workspace& w = *data.workspace;
  CutIsland& cut = *d.cut;
  using Kernel = lanes::CutRobots;
  form_robot_batches(scene, w, d, cut);
  form_contact_batches(scene, w, cut);
  each_batch(w, cut,
             [&](Kernel& kernel, std::span<CutMember> robots, Memory memory) { kernel.evaluate(job, robots, memory); });
  if (!all_sound(cut)) return false;
  evaluate_joining(scene, w, cut);
  if (!believable_rows(scene, cut)) return false;
  each_batch(w, cut,
             [&](Kernel& kernel, std::span<CutMember> robots, Memory memory) { kernel.factor(robots, memory); });
  if (!all_sound(cut) || !factor_joining(scene.damping, cut) || !growth_is_finite(cut)) return false;
  joining_right_side(data, cut);
  const sparse::Refinement refinement = solve_refined_cut(w, scene.damping, tolerance::kRefinementSteps, cut);
  if (!(refinement.backward_error <= tolerance::kConverged)) return false;
  store_answer(job, w, cut);
  report_cut(scene, cut, refinement, job.serial, d, report);
  return true;
}

}  // namespace

void solve_cut(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return;
  const lanes::Job job{scene,         w.solves, w.q.data(),    data.v.data(), data.tau.data(),
                       data.f_offset, w.wanted, data.a.data(), data.f.data()};
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (w.islands[i]->cut && !w.islands[i]->was_dependent)  // else answered already
      (void)solve_cut_island(job, data, *w.islands[i], data.report.islands[i]);
}

void solve_once_refined_cut(const Scene& scene, SceneData& data, IslandWork& d, Eigen::VectorXd& a,
                            Eigen::VectorXd& f) {
  Workspace& w = *data.workspace;
  CutIsland& cut = *d.cut;
  const lanes::Job job{scene, data.serial, nullptr, nullptr, nullptr, data.f_offset, nullptr, a.data(), f.data()};
  each_batch(w, cut, [&](lanes::CutRobots& kernel, std::span<CutMember> robots, Memory memory) {
    kernel.load(job, robots, memory.at);
  });
  for (const CutIsland::Joint& joint : cut.contacts)
    for (int i = 0; i < joint.rows; ++i) cut.b[joint.row + i] = -f[data.f_offset[joint.contact] + i];
  (void)solve_refined_cut(w, scene.damping, 1, cut);
  store_answer(job, w, cut);
}

void take_factor_of_robot(const CutIsland& cut, std::size_t k, KktMatrix& K, Factor& factor) {
  const int member = cut.robots[k].member;
  const auto after = std::upper_bound(cut.batches.begin(), cut.batches.end(), member,
                                      [](int m, const CutIsland::Batch& batch) { return m < batch.first; });
  const CutIsland::Batch& batch = after[-1];
  const KktPattern &with_border = batch.group->robot->pattern, &alone = *K.pattern;
  const std::size_t width = batch.group->kernels.front()->width(batch.count == 1);
  const double* from =
      cut.memory.data() + batch.at + (member - batch.first);  // lane by lane: as CutSideBySide::Numbers
  const auto take = [&](std::size_t first, int count, double* to) {
    for (int i = 0; i < count; ++i) to[i] = from[(first + i) * width];
  };
  const std::size_t L = static_cast<std::size_t>(with_border.K.nonzeros() + with_border.size()),
                    D = L + with_border.ldl.nonzeros();
  take(0, alone.K.nonzeros(), K.values.data());  // the border's columns are the last
  const CutMember& robot = cut.members[member];
  const LdlRoom room = room_for_ldl(factor, K, robot.diagonal > 0 ? robot.terms / robot.diagonal : 1);
  for (int j = 0; j < alone.size(); ++j)  // and its rows the last of a column
    take(L + with_border.ldl.Lp[j], alone.ldl.Lp[j + 1] - alone.ldl.Lp[j], room.L.data() + alone.ldl.Lp[j]);
  take(D, alone.size(), room.D.data());
}

void evaluate_cut(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  const auto unknown = [](const IslandWork& d) { return d.in_lanes && d.cut && !d.cut->terms_known; };
  if (std::none_of(w.islands.begin(), w.islands.end(), [&](const auto& d) { return unknown(*d); })) return;
  evaluate_in_lanes(scene, data, unknown);
  for (const std::unique_ptr<IslandWork>& d : w.islands)
    if (unknown(*d)) d->cut->terms_known = true;
}

void complete_cut(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  const auto left = [](const std::unique_ptr<IslandWork>& d) { return d->in_lanes && d->cut; };
  if (std::none_of(w.islands.begin(), w.islands.end(), left)) return;
  evaluate_cut(scene, data);
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *w.islands[i];
    if (!left(w.islands[i])) return;
    factorize_again(scene, data, d, thread);
    d.in_lanes = false;
  });
  w.kinematics_known = std::none_of(w.islands.begin(), w.islands.end(), [](const auto& d) { return d->in_lanes; });
}

}  // namespace manycontact::internal
