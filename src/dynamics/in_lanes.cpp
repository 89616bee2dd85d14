#include "bodies.hpp"
#include "steps.hpp"

namespace manycontact {

namespace internal {

namespace {

void report_answer(const lanes::Answer& answer, IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  report.method = Method::kSparseLdl;
  report.order = d.choice.order;
  report.factor_nonzeros = d.shape->pattern(d.choice.order)->ldl.nonzeros() + d.island.size();
  report.refinement_steps = answer.refinement_steps;
  report.residual_dynamics = answer.residual_dynamics;
  report.residual_contact = answer.residual_contact;
  report.backward_error = answer.backward_error;
  d.factor = nullptr;
  d.in_lanes = true;
  d.panel_is_safe = answer.panel_is_safe;
  d.refine_panel = answer.refine_panel;
}

// use(kernel), with w.lanes.islands and numbers, for as many islands at a time as stand side by side, of those that
// `wanted` holds for.
template <class Wanted, class Use>
void each_in_lanes(const Scene& scene, Workspace& w, Wanted&& wanted, Use&& use) {
  lanes::Groups& g = w.lanes;
  for (auto& entry : g.groups) {
    const lanes::Group& group = entry.second;
    const auto use_those_at_hand = [&] {
      if (g.islands.empty()) return;
      use(*group.kernel);
      g.islands.clear();
      g.numbers.clear();
    };
    for (int i : group.islands) {
      const IslandWork& d = *w.islands[i];
      if (!wanted(d)) continue;
      if (!g.islands.empty() && !lanes::alike(scene, *g.islands.front(), d.island)) use_those_at_hand();
      g.islands.push_back(&d.island);
      g.numbers.push_back(i);
      if (static_cast<int>(g.islands.size()) == g.level->width) use_those_at_hand();
    }
    use_those_at_hand();
  }
}

bool served(const IslandWork& d) { return d.served_in_lanes(); }

}  // namespace

void solve_in_lanes(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  lanes::Groups& g = w.lanes;
  for (std::unique_ptr<IslandWork>& d : w.islands) d->in_lanes = false;
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return;
  const lanes::Job job{scene,         w.solves + 1, w.q.data(),    data.v.data(), data.tau.data(),
                       data.f_offset, w.wanted,     data.a.data(), data.f.data()};
  each_in_lanes(
      scene, w, [](const IslandWork& d) { return !d.was_dependent; },  // mostly still is: another way answers
      [&](lanes::Kernel& kernel) {
        kernel.solve(job, g.islands, {g.answers.data(), g.islands.size()});
        for (std::size_t k = 0; k < g.islands.size(); ++k)
          if (g.answers[k].sound)
            report_answer(g.answers[k], *w.islands[g.numbers[k]], data.report.islands[g.numbers[k]]);
      });
}

void differentiate_in_lanes(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  lanes::DerivativeJob job{
      scene, data.serial, w.q.data(), data.v.data(), data.a.data(), data.f.data(), data.f_offset, {}, 0, 0, 0};
  each_in_lanes(scene, w, served, [&](lanes::Kernel& kernel) {
    w.lanes.panels.clear();
    for (int i : w.lanes.numbers) {
      IslandDerivatives& out = w.derivatives.islands[i];
      job.request = out.request;
      job.q_first = out.q_first, job.v_first = out.v_first, job.u_first = out.u_first;
      w.lanes.panels.push_back({out.X.data(), static_cast<int>(out.X.cols()), w.islands[i]->refine_panel});
    }
    kernel.differentiate(job, w.lanes.islands, w.lanes.panels);
  });
}

void jvp_in_lanes(const Scene& scene, SceneData& data, const double* dq, const double* dv, const double* du, double* da,
                  double* df) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),   data.v.data(),    data.a.data(),
                              data.f.data(), data.f_offset, {dq, dv, du}, {da, df, nullptr}};
  each_in_lanes(scene, w, served, [&](lanes::Kernel& kernel) { kernel.jvp(job, w.lanes.islands); });
}

void vjp_in_lanes(const Scene& scene, SceneData& data, const double* wa, const double* wf, double* wq, double* wv,
                  double* wu) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),        data.v.data(), data.a.data(),
                              data.f.data(), data.f_offset, {wa, wf, nullptr}, {wq, wv, wu}};
  each_in_lanes(scene, w, served, [&](lanes::Kernel& kernel) { kernel.vjp(job, w.lanes.islands); });
}

void complete(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  for (std::unique_ptr<IslandWork>& d : w.islands)
    if (by_bodies(*d) && joint_space_size(*d->shape) <= kMostJointSpace) joint_space_terms(scene, data, *d, "complete");
  if (w.kinematics_known) return;
  for (std::unique_ptr<IslandWork>& d : w.islands)
    if (d->in_lanes) complete_island(scene, data, *d);
  w.kinematics_known = true;
}

void complete_island(const Scene& scene, const SceneData& data, IslandWork& d) {
  Workspace& w = *data.workspace;
  evaluate(scene, w.q, data.v, w, d.island);
  if (!climb_ladder(scene, data, w.scratch, d, w.spare_report)) d.factor = nullptr;
  d.in_lanes = false;
}

}  // namespace internal

void complete(const Scene& scene, const SceneData& data) {
  internal::check_solved(scene, data, "complete");
  internal::complete(scene, data);
}

}  // namespace manycontact
