#include "truth.hpp"

#include <algorithm>
#include <random>

#include "../text/places.hpp"
#include "chart.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/analysis/errors.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

namespace {

constexpr int kWholeUpTo = 60;    // largest nv of an island with derivatives along all unit vectors
constexpr int kDirections = 4;    // number of random directions in each of q, v and u for larger islands
constexpr int kDenseSize = 150;   // most unknowns for which the dense solver replaces a missing sparse factor
constexpr double kAtRest = 1e-4;  // smaller accelerations of a robot, relative to those without contacts, are zero

Eigen::MatrixXd directions(int n, bool whole, std::mt19937& rng) {
  if (whole) return Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd out(n, kDirections);
  for (double& x : out.reshaped()) x = 2.0 * rng() / 4294967295.0 - 1;
  return out;
}

void choose_directions(const Places& p, std::mt19937& rng, ChartTruth::OfIsland& out) {
  const int nv = static_cast<int>(p.v.size()), nu = static_cast<int>(p.u.size());
  const bool whole = nv <= kWholeUpTo;
  const Eigen::MatrixXd dq = directions(nv, whole, rng), dv = directions(nv, whole, rng);
  const Eigen::MatrixXd du = directions(nu, whole, rng);
  const Eigen::Index nq = dq.cols(), n = dq.cols() + dv.cols() + du.cols();
  out.along.setZero(2 * nv + nu, n);
  out.along.topLeftCorner(nv, nq) = dq;
  out.along.block(nv, nq, nv, dv.cols()) = dv;
  out.along.bottomRightCorner(nu, du.cols()) = du;
  const Eigen::Index first[4] = {0, nq, nq + dv.cols(), n};
  for (int k = 0; k < 4; ++k) out.first[k] = static_cast<int>(first[k]);
  out.derivatives.setConstant(nv + static_cast<int>(p.f.size()), n, std::numeric_limits<Quad>::quiet_NaN());
}

// Returns the reference solution at the state displaced by `step` in q (by = 0), v (by = 1) or u (by = 2).
Truth<Quad> truth_along(const SceneFile& file, SceneData& data, int by, const VecX<Quad>& step) {
  const Scene& scene = file.scene;
  VecX<Quad> q = file.q.cast<Quad>(), v = file.v.cast<Quad>(), u = file.u.cast<Quad>();
  if (by == 1) v += step;
  if (by == 2) u += step;
  if (by == 0)
    for (const Robot& robot : scene.robots) {
      const Model& model = *robot.model;
      VecX<Quad> moved(model.nq);
      integrate<Quad>(model, q.segment(robot.idx_q, model.nq), step.segment(robot.idx_v, model.nv), moved);
      q.segment(robot.idx_q, model.nq) = moved;
    }
  return refine_truth<Quad>(scene, data, q, v, u, kDenseSize);
}

// Computes derivatives by central differences. As islands are independent, step k displaces all islands, each along its
// direction k.
void differences(const SceneFile& file, SceneData& data, const std::vector<Places>& places, ChartTruth& truth) {
  const Quad h = Quad(1) / Quad(10000000000LL);
  int most = 0;
  for (const ChartTruth::OfIsland& o : truth.islands)
    for (int by = 0; by < 3; ++by) most = std::max(most, o.first[by + 1] - o.first[by]);
  for (int by = 0; by < 3; ++by)
    for (int k = 0; k < most; ++k) {
      progress("exact derivatives, " + std::to_string(by * most + k + 1) + " of " + std::to_string(3 * most));
      VecX<Quad> step = VecX<Quad>::Zero(by == 2 ? file.scene.nu : file.scene.nv);
      bool moves = false;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const ChartTruth::OfIsland& o = truth.islands[i];
        if (k >= o.first[by + 1] - o.first[by]) continue;
        const std::vector<int>& to = by == 2 ? places[i].u : places[i].v;
        const std::size_t row = by * places[i].v.size();
        for (std::size_t j = 0; j < to.size(); ++j) step[to[j]] = h * o.along(row + j, o.first[by] + k);
        moves = true;
      }
      if (!moves) continue;
      const Truth<Quad> after = truth_along(file, data, by, step), before = truth_along(file, data, by, -step);
      for (std::size_t i = 0; i < places.size(); ++i) {
        ChartTruth::OfIsland& o = truth.islands[i];
        if (k >= o.first[by + 1] - o.first[by]) continue;
        if (!after.regular[i] || !before.regular[i] || after.rank[i] != before.rank[i]) o.derivatives_known = false;
        const Places& p = places[i];
        auto column = o.derivatives.col(o.first[by] + k);
        for (std::size_t j = 0; j < p.v.size(); ++j) column[j] = (after.a[p.v[j]] - before.a[p.v[j]]) / (2 * h);
        for (std::size_t j = 0; j < p.f.size(); ++j)
          column[p.v.size() + j] = (after.f[p.f[j]] - before.f[p.f[j]]) / (2 * h);
      }
    }
}

}  // namespace

ChartTruth find_truth(const SceneFile& file, SceneData& data) {
  const Scene& scene = file.scene;
  ChartTruth truth;
  progress("exact solution");
  const Truth<Quad> here = truth_along(file, data, 2, VecX<Quad>::Zero(scene.nu));
  truth.a = here.a;
  truth.f = here.f;

  SceneData free(scene, {Method::kSparseLdl, Order::kLeafToRoot});
  free.active.assign(scene.contacts.size(), 0);
  (void)solve(scene, file.q, file.v, file.u, free);
  truth.a_free = free.a;
  for (const Robot& robot : scene.robots) {
    const Eigen::VectorXd a = truth.a.segment(robot.idx_v, robot.model->nv).cast<double>();
    truth.at_rest.push_back(largest_entry(a) < kAtRest * largest_entry(free.a.segment(robot.idx_v, robot.model->nv)));
  }

  std::mt19937 rng(20);
  std::vector<Places> places;
  for (std::size_t i = 0; i < island_count(data); ++i) {
    ChartTruth::OfIsland& o = truth.islands.emplace_back();
    o.island = solved_island(data, i);
    o.known = o.derivatives_known = here.regular[i];
    choose_directions(places.emplace_back(scene, data.f_offset, o.island), rng, o);
    truth.sampled += o.island.nv > kWholeUpTo;
  }
  differences(file, data, places, truth);
  for (const ChartTruth::OfIsland& o : truth.islands) {
    truth.unknown += !o.known;
    truth.unknown_derivatives += !o.derivatives_known;
  }
  return truth;
}

}  // namespace manycontact::cli
