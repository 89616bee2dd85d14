#include "bodies.hpp"
#include "cut.hpp"
#include "steps.hpp"
#include "threads.hpp"

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
  d.factorizations = 1;
  d.in_lanes = true;
  d.panel_is_safe = answer.panel_is_safe;
  d.refine_panel = answer.refine_panel;
}

// The islands that `wanted` holds for into w.lanes, in batches of as many as stand side by side.
template <class Wanted>
void form_batches(const Scene& scene, Workspace& w, Wanted&& wanted) {
  lanes::Groups& g = w.lanes;
  g.islands.clear();
  g.numbers.clear();
  g.batches.clear();
  for (const auto& [key, group] : g.groups) {
    bool begun = false;
    for (int i : group.islands) {
      const Island& island = w.islands[i]->island;
      if (!wanted(*w.islands[i])) continue;
      if (!begun || g.batches.back().count == g.level->width ||
          !lanes::alike(scene, g.islands[g.batches.back().first]->contacts, island.contacts))
        g.batches.push_back({&group, static_cast<int>(g.islands.size()), 0});
      begun = true;
      g.islands.push_back(&island);
      g.numbers.push_back(i);
      ++g.batches.back().count;
    }
  }
}

// use(kernel, islands, their numbers, memory of the thread) for each batch.
template <class Wanted, class Use>
void each_in_lanes(const Scene& scene, Workspace& w, Wanted&& wanted, Use&& use) {
  lanes::Groups& g = w.lanes;
  form_batches(scene, w, wanted);
  each_item(w, g.batches.size(), [&](std::size_t k, ThreadWork& thread) {
    const auto [group, first, count] = g.batches[k];
    use(*group->kernels[thread.number], std::span<const Island* const>(g.islands).subspan(first, count),
        std::span<const int>(g.numbers).subspan(first, count), thread);
  });
}

using Islands = std::span<const Island* const>;
using Numbers = std::span<const int>;

bool served(const IslandWork& d) { return d.served_in_lanes(); }

}  // namespace

void solve_in_lanes(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  for (std::unique_ptr<IslandWork>& d : w.islands) d->in_lanes = false;
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return;
  const lanes::Job job{scene,         w.solves, w.q.data(),    data.v.data(), data.tau.data(),
                       data.f_offset, w.wanted, data.a.data(), data.f.data()};
  // Not those answered already, nor those whose rows are certain to depend on each other.
  const auto wanted = [&scene](const IslandWork& d) {
    return !d.was_dependent && (scene.damping > 0 || d.island.nc <= d.island.nv);
  };
  each_in_lanes(
      scene, w, wanted,
      [&](lanes::Kernel& kernel, Islands islands, Numbers numbers, ThreadWork& thread) {
        kernel.solve(job, islands, {thread.answers.data(), islands.size()});
        for (std::size_t k = 0; k < islands.size(); ++k)
          if (thread.answers[k].sound)
            report_answer(thread.answers[k], *w.islands[numbers[k]], data.report.islands[numbers[k]]);
      });
}

void differentiate_in_lanes(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  std::size_t bytes = 0;
  for (const IslandDerivatives& d : w.derivatives.islands) bytes += sizeof(double) * d.X.size();
  const bool past_caches = bytes > kCached;
  each_in_lanes(scene, w, served, [&](lanes::Kernel& kernel, Islands islands, Numbers numbers, ThreadWork& thread) {
    const IslandDerivatives& first = w.derivatives.islands[numbers.front()];
    const lanes::DerivativeJob job{scene,         data.serial,   w.q.data(),    data.v.data(),
                                   data.a.data(), data.f.data(), data.f_offset, first.request,
                                   first.q_first, first.v_first, first.u_first, past_caches};
    thread.panels.clear();
    for (int i : numbers) {
      IslandDerivatives& out = w.derivatives.islands[i];
      thread.panels.push_back({out.X.data(), static_cast<int>(out.X.cols()), w.islands[i]->refine_panel});
    }
    kernel.differentiate(job, islands, thread.panels);
  });
}

void jvp_in_lanes(const Scene& scene, SceneData& data, const double* dq, const double* dv, const double* du, double* da,
                  double* df) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),   data.v.data(),    data.a.data(),
                              data.f.data(), data.f_offset, {dq, dv, du}, {da, df, nullptr}};
  each_in_lanes(scene, w, served,
                [&](lanes::Kernel& kernel, Islands islands, Numbers, ThreadWork&) { kernel.jvp(job, islands); });
}

void vjp_in_lanes(const Scene& scene, SceneData& data, const double* wa, const double* wf, double* wq, double* wv,
                  double* wu) {
  Workspace& w = *data.workspace;
  const lanes::ProductJob job{scene,         data.serial,   w.q.data(),        data.v.data(), data.a.data(),
                              data.f.data(), data.f_offset, {wa, wf, nullptr}, {wq, wv, wu}};
  each_in_lanes(scene, w, served,
                [&](lanes::Kernel& kernel, Islands islands, Numbers, ThreadWork&) { kernel.vjp(job, islands); });
}

void complete(const Scene& scene, const SceneData& data) {
  Workspace& w = *data.workspace;
  for (std::unique_ptr<IslandWork>& d : w.islands) complete_bodies(scene, data, *d, w.threads.front());
  for (std::unique_ptr<IslandWork>& d : w.islands)
    if (by_bodies(*d) && joint_space_size(*d->shape) <= kMostJointSpace) joint_space_terms(scene, data, *d, "complete");
  complete_cut(scene, data);
  if (w.kinematics_known) return;
  for (std::unique_ptr<IslandWork>& d : w.islands)
    if (d->in_lanes) complete_island(scene, data, *d, w.threads.front());
  w.kinematics_known = true;
}

void complete_island(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  Workspace& w = *data.workspace;
  if (!d.cut || !d.cut->terms_known) evaluate(scene, w.q, data.v, w, d.island);
  factorize_again(scene, data, d, thread);
  d.in_lanes = false;
}

}  // namespace internal

void complete(const Scene& scene, const SceneData& data) {
  internal::check_solved(scene, data, "complete");
  internal::complete(scene, data);
}

}  // namespace manycontact
