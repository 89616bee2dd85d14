// Robots alone in lanes: islands of one robot, as many side by side as there are lanes.

#include "../../internal.hpp"
#include "../../threads.hpp"
#include "robots.hpp"

namespace manycontact {

bool AloneSystem::answered(const Workspace& work) const { return state == work.state && panel_is_safe; }

namespace internal {

lanes::Job job_at_state(const Scene& scene, SceneData& data) {
  const Workspace& w = *data.workspace;
  return {scene,         w.state,      w.q.data(),    data.v.data(), data.tau.data(),
          data.f_offset, w.prescribed, data.a.data(), data.f.data()};
}

namespace {

void take_answer(const Workspace& w, const lanes::Answer& answer, IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  report.method = Method::kSparseLdl;
  report.order = d.choice.order;
  report.factor_nonzeros = d.shape->pattern(d.choice.order)->ldl.nonzeros() + d.island.size();
  report.refinement_steps = answer.refinement_steps;
  report.residual_dynamics = answer.residual_dynamics;
  report.residual_contact = answer.residual_contact;
  report.backward_error = answer.backward_error;
  d.answered = &d.alone;
  d.factorizations = 1;
  d.alone.state = w.state;
  d.alone.panel_is_safe = answer.panel_is_safe;
  d.alone.refine_panel = answer.refine_panel;
}

// The islands that `wanted` holds for into w.lanes, in batches of as many as stand side by side.
template <class Wanted>
void form_batches(const Scene& scene, Workspace& w, Wanted&& wanted) {
  InLanes& in = w.lanes;
  in.islands.clear();
  in.robots.clear();
  in.batches.clear();
  for (const auto& [key, group] : in.groups) {
    bool begun = false;
    for (int i : group.islands) {
      const Island& island = w.islands[i]->island;
      if (!wanted(*w.islands[i])) continue;
      if (!begun || in.batches.back().count == in.level->width ||
          !lanes::alike(scene, w.islands[in.islands[in.batches.back().first]]->island.contacts, island.contacts))
        in.batches.push_back({&group, static_cast<int>(in.robots.size()), 0});
      begun = true;
      in.robots.push_back({island.robots.front(), island.contacts.data()});
      in.islands.push_back(i);
      ++in.batches.back().count;
    }
  }
}

using Robots = std::span<lanes::RobotBlocks::Robot>;
using Numbers = std::span<const int>;

// use(kernel, robots, numbers of their islands, memory of the thread) for each batch.
template <class Wanted, class Use>
void each_in_lanes(const Scene& scene, Workspace& w, Wanted&& wanted, Use&& use) {
  InLanes& in = w.lanes;
  form_batches(scene, w, wanted);
  each_item(w, in.batches.size(), [&](std::size_t k, ThreadWork& thread) {
    const auto [group, first, count] = in.batches[k];
    use(*group->kernels[thread.number], Robots(in.robots).subspan(first, count),
        Numbers(in.islands).subspan(first, count), thread);
  });
}

auto served_by(const Workspace& w) {
  return [&w](const IslandWork& d) { return d.alone.answered(w); };
}

}  // namespace

void solve_alone(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return;
  const lanes::Job job = job_at_state(scene, data);
  // Not those answered already, nor those whose rows are certain to depend on each other.
  const auto wanted = [&scene](const IslandWork& d) {
    return !d.answered && !is_inexact(scene, d) && (scene.damping > 0 || d.island.nc <= d.island.nv);
  };
  each_in_lanes(scene, w, wanted, [&](lanes::RobotBlocks& kernel, Robots robots, Numbers numbers, ThreadWork& thread) {
    kernel.solve(job, robots, {thread.answers.data(), robots.size()});
    for (std::size_t k = 0; k < robots.size(); ++k)
      if (thread.answers[k].sound)
        take_answer(w, thread.answers[k], *w.islands[numbers[k]], data.report.islands[numbers[k]]);
  });
}

void differentiate_alone(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  std::size_t bytes = 0;
  for (const IslandDerivatives& d : w.derivatives.islands) bytes += sizeof(double) * d.X.size();
  const bool non_temporal = bytes > kCacheBytes;
  each_in_lanes(
      scene, w, served_by(w), [&](lanes::RobotBlocks& kernel, Robots robots, Numbers numbers, ThreadWork& thread) {
        const IslandDerivatives& first = w.derivatives.islands[numbers.front()];
        const lanes::DerivativeJob job{scene,         data.serial,   w.q.data(),    data.v.data(),
                                       data.a.data(), data.f.data(), data.f_offset, first.request,
                                       first.q_first, first.v_first, first.u_first, static_cast<int>(first.X.cols()),
                                       non_temporal};
        thread.panels.clear();
        for (int i : numbers) {
          IslandDerivatives& out = w.derivatives.islands[i];
          thread.panels.push_back({out.X.data(), static_cast<int>(out.X.cols()), w.islands[i]->alone.refine_panel, {}});
        }
        kernel.differentiate(job, robots, nullptr, thread.panels);
      });
}

void jvp_alone(const Scene& scene, SceneData& data, const double* dq, const double* dv, const double* du, double* da,
               double* df) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),   data.v.data(),    data.a.data(),
                              data.f.data(), data.f_offset, {dq, dv, du}, {da, df, nullptr}};
  each_in_lanes(scene, w, served_by(w),
                [&](lanes::RobotBlocks& kernel, Robots robots, Numbers, ThreadWork&) { kernel.jvp(job, robots); });
}

void vjp_alone(const Scene& scene, SceneData& data, const double* wa, const double* wf, double* wq, double* wv,
               double* wu) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),        data.v.data(), data.a.data(),
                              data.f.data(), data.f_offset, {wa, wf, nullptr}, {wq, wv, wu}};
  each_in_lanes(scene, w, served_by(w),
                [&](lanes::RobotBlocks& kernel, Robots robots, Numbers, ThreadWork&) { kernel.vjp(job, robots); });
}

}  // namespace internal

}  // namespace manycontact
