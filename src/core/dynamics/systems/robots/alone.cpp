// Solves single-robot islands in SIMD batches.

#include <algorithm>

#include "../../internal.hpp"
#include "../../workspace/threads.hpp"
#include "manycontact/rank/row_units.hpp"
#include "robots.hpp"

namespace manycontact {

namespace internal {

lanes::Job job_at_state(const Scene& scene, SceneData& data) {
  const Workspace& w = *data.workspace;
  return {scene,
          w.state,
          w.q.data(),
          data.v.data(),
          data.tau.data(),
          data.f_offset,
          w.prescribed.empty() ? nullptr : w.prescribed.data(),
          data.a.data(),
          data.f.data(),
          &w.left_offset,
          data.workspace->left.data()};
}

lanes::Solution solution_of(const Scene& scene, const SceneData& data) {
  return {scene, data.serial, data.workspace->q.data(), data.v.data(), data.a.data(), data.f.data(), data.f_offset};
}

namespace {

void take_answer(Precision precision, const lanes::Answer& answer, IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  report.precision = precision;
  report.method = Method::kSparseLdl;
  report.order = d.choice.order;
  report.factor_nonzeros = d.alone.group->plan->factor_nonzeros() + d.island.size();
  report.refinement_steps = answer.refinement_steps;
  report.residual_dynamics = answer.residual_dynamics;
  report.residual_contact = answer.residual_contact;
  report.contact_terms = answer.contact_terms;
  report.backward_error = answer.backward_error;
  d.answered = &IslandWork::batches;
  d.factorizations = 1;
  d.alone.panel_is_safe = answer.panel_is_safe;
  d.alone.refine_panel = answer.refine_panel;
}

void take_dependence(const Scene& scene, const SceneData& data, const lanes::Answer& answer, IslandWork& d,
                     IslandReport& report) {
  if (answer.dependent.empty()) return;
  d.matrix.dependent.clear();
  const KktPattern& p = *d.alone.group->plan->pattern;
  for (int k : answer.dependent) d.matrix.dependent.push_back(p.perm[k] - p.nv);
  report_dependent_rows(scene, data, d, d.matrix.dependent, answer.contradiction, report);
}

// Fills w.lanes with batches of up to `width` islands, without those for which group_of(island) returns nullptr.
template <class GroupOf>
void form_batches(const Scene& scene, Workspace& w, int width, GroupOf&& group_of) {
  InLanes& in = w.lanes;
  in.islands.clear();
  in.robots.clear();
  in.batches.clear();
  for (auto& [key, group] : in.groups) group.islands.clear();
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (BlockGroup* group = group_of(*w.islands[i])) group->islands.push_back(static_cast<int>(i));
  for (auto& [key, group] : in.groups) {
    bool begun = false;
    for (int i : group.islands) {
      const Island& island = w.islands[i]->island;
      if (!begun || in.batches.back().count == width ||
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

// Prefetches the numbers of the robots' models for a batch, if the robots do not share one model.
void prefetch_models(const Scene& scene, Robots robots) {
  constexpr int kLine = 64;
  if (robots.size() < 2 || scene.robots[robots[0].number].model == scene.robots[robots[1].number].model) return;
  for (const lanes::RobotBlocks::Robot& r : robots)
    for (const Joint& joint : scene.robots[r.number].model->joints) {
      const char* const end = reinterpret_cast<const char*>(&joint.inertia + 1);
      for (const char* at = reinterpret_cast<const char*>(&joint.placement); at < end; at += kLine)
        __builtin_prefetch(at);
    }
}

// Calls use(group, robots, islands' numbers, workspace) for each batch. of_solve: cost of `use` relative to a solve.
template <class GroupOf, class Use>
void each_batch_of(int width, const Scene& scene, Workspace& w, double of_solve, GroupOf&& group_of, Use&& use) {
  InLanes& in = w.lanes;
  form_batches(scene, w, width, group_of);
  double seconds = 0;
  for (const InLanes::Batch& batch : in.batches)
    seconds += of_solve * batch.group->seconds * together(static_cast<std::size_t>(batch.count));
  each_item(w, in.batches.size(), are_worth_threads(w, seconds), [&](std::size_t k, ThreadWork& thread) {
    const auto [group, first, count] = in.batches[k];
    if (k + 1 < in.batches.size())
      prefetch_models(scene, Robots(in.robots).subspan(in.batches[k + 1].first, in.batches[k + 1].count));
    use(*group, Robots(in.robots).subspan(first, count), Numbers(in.islands).subspan(first, count), thread);
  });
}

template <class GroupOf, class Use>
void each_in_lanes(const Scene& scene, Workspace& w, double of_solve, GroupOf&& group_of, Use&& use) {
  if (w.lanes.level) each_batch_of(w.lanes.level->robots.width, scene, w, of_solve, group_of, use);
}

// Returns the group whose SIMD batch solved the island and may differentiate it; nullptr if there is none.
BlockGroup* group_of_answer(const IslandWork& d) { return d.served_in_lanes() ? d.alone.group : nullptr; }

// Solves those unsolved single-robot islands for which fits(group, island) is true, in SIMD batches. kernels: member of
// BlockGroup whose kernels solve.
template <class Kernel, class Fits>
void solve_in_batches(const lanes::Job& job, SceneData& data, int width, Precision precision,
                      std::vector<lanes::OneOrBatch<Kernel>> BlockGroup::*kernels, Fits&& fits) {
  const Scene& scene = job.scene;
  Workspace& w = *data.workspace;
  const auto group_of = [&](const IslandWork& d) {
    BlockGroup* const group = d.answered || is_inexact(scene, d) ? nullptr : d.alone.group;
    return group && fits(*group, d) ? group : nullptr;
  };
  each_batch_of(
      width, scene, w, 1, group_of, [&](BlockGroup& group, Robots robots, Numbers numbers, ThreadWork& thread) {
        (group.*kernels)[thread.number].of(robots.size()).solve(job, robots, {thread.answers.data(), robots.size()});
        for (std::size_t k = 0; k < robots.size(); ++k) {
          const lanes::Answer& answer = thread.answers[k];
          if (!answer.sound) continue;
          IslandWork& d = *w.islands[numbers[k]];
          IslandReport& report = data.report.islands[numbers[k]];
          take_answer(precision, answer, d, report);
          take_dependence(scene, data, answer, d, report);
        }
      });
}

}  // namespace

void solve_alone(const Scene& scene, SceneData& data, const StartOfStep* start) {
  const Workspace& w = *data.workspace;
  if (!usable_numbers(scene) || !w.lanes.level) return;
  lanes::Job job = job_at_state(scene, data);
  job.start = start;
  if (w.options.precision == Precision::kSingle)
    solve_in_batches(job, data, batch_width(w), Precision::kSingle, &BlockGroup::single,
                     [&](const BlockGroup& group, const IslandWork& d) {
                       const bool dependent = scene.damping == 0 && d.island.nc > d.island.nv;  // rows surely depend
                       return !group.single.empty() && !dependent;
                     });
  solve_in_batches(job, data, w.lanes.level->robots.width, Precision::kDouble, &BlockGroup::kernels,
                   [](const BlockGroup&, const IslandWork&) { return true; });
}

bool stand_alone(const Scene& scene, const Workspace& w) {
  return w.lanes.level && !w.reduction && w.options.precision == Precision::kDouble && usable_numbers(scene) &&
         std::ranges::all_of(w.islands, [&](const auto& d) { return d->alone.group && !is_inexact(scene, *d); });
}

void differentiate_alone(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  std::size_t bytes = 0;
  for (const IslandDerivatives& d : w.derivatives.islands) bytes += sizeof(double) * d.X.size();
  const bool non_temporal = bytes > kCacheBytes;
  each_in_lanes(
      scene, w, costs::kDerivatives, group_of_answer,
      [&](BlockGroup& group, Robots robots, Numbers numbers, ThreadWork& thread) {
        const IslandDerivatives& first = w.derivatives.islands[numbers.front()];
        const lanes::DerivativeJob job{
            solution_of(scene, data),         first.request, first.q_first, first.v_first, first.u_first,
            static_cast<int>(first.X.cols()), non_temporal};
        thread.panels.clear();
        for (int i : numbers) {
          IslandDerivatives& out = w.derivatives.islands[i];
          thread.panels.push_back({out.X.data(), static_cast<int>(out.X.cols()), w.islands[i]->alone.refine_panel, {}});
        }
        // A batch of two takes as long as a full one: two robots are faster one by one.
        const std::size_t step = robots.size() == 2 ? 1 : robots.size();
        for (std::size_t k = 0; k < robots.size(); k += step)
          group.kernels[thread.number].of(step).differentiate(job, robots.subspan(k, step), nullptr,
                                                              std::span(thread.panels).subspan(k, step));
      });
}

void multiply_alone(const Scene& scene, SceneData& data, ProductInLanes product, const std::array<const double*, 3>& in,
                    const std::array<double*, 3>& out) {
  const lanes::ProductJob job{solution_of(scene, data), in, out};
  each_in_lanes(scene, *data.workspace, costs::kProducts, group_of_answer,
                [&](BlockGroup& group, Robots robots, Numbers, ThreadWork& thread) {
                  (group.kernels[thread.number].of(robots.size()).*product)(job, robots);
                });
}

}  // namespace internal

}  // namespace manycontact
