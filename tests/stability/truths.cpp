#include "stability/truths.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/dynamics/solve.hpp"
#include "stability/derivatives.hpp"
#include "support/measure.hpp"
#include "support/truth.hpp"

namespace manycontact::test {

namespace {

constexpr int kDenseTruth = 75;             // most velocity coordinates for which the truth is computed densely
constexpr int kDenseIfSingular = 110;       // most unknowns for which this is done if refinement does not converge
constexpr double kVanishingMotion = 1e-12;  // relative to their scale: smaller accelerations cancel

template <class D>
bool finite(const Eigen::MatrixBase<D>& x) {
  return std::isfinite(size_of(x));
}

Truth<Quad> truth_of(const Problem& p) {
  const VecX<Quad> q = p.q.cast<Quad>(), v = p.v.cast<Quad>(), u = p.u.cast<Quad>();
  if (p.scene.nv <= kDenseTruth) return solve_truth<Quad>(p.scene, active(p.scene), q, v, u);
  SceneData data(p.scene, {Method::kSparseLdl, {}});
  (void)solve(p.scene, p.q, p.v, p.u, data);
  return refine_truth<Quad>(p.scene, data, q, v, u, kDenseIfSingular);
}

template <class S>
IslandTruth island_truth(const IslandSystem<S>& system) {
  IslandTruth out;
  out.v = system.v;
  out.f = system.f;
  return out;
}

// Computes whole inverses and the contacts' inconsistency, for problems that are small enough.
void look_closely(const Problem& p, const Truth<Quad>& truth, Truths& out) {
  double left = 0, Ja = 0, a0 = 0;
  for (const IslandSystem<Quad>& system : island_systems<Quad>(p)) {
    const std::size_t i = out.islands.size();
    IslandTruth& island = out.islands.emplace_back(island_truth(system));
    island.condition = condition(system, p.scene.damping, truth.rank[i]);
    out.J_size = std::max(out.J_size, size_of(system.J));
    const VecX<Quad> a = out.a(system.v);
    left = std::max(left, size_of(system.J * a + system.a0));
    Ja = std::max(Ja, size_of(system.J.cwiseAbs() * a.cwiseAbs()));
    a0 = std::max(a0, size_of(system.a0));
  }
  if (out.f.size() == 0 || p.only_known) return;
  out.contradiction = left == 0 ? 0 : left / (Ja + a0);
  out.contradiction_over_gravity = left == 0 ? 0 : left / std::max(Ja + a0, p.scene.gravity.norm());
}

void look_from_afar(const Problem& p, Truths& out) {
  for (const IslandSystem<double>& system : island_systems<double>(p)) {
    IslandTruth& island = out.islands.emplace_back(island_truth(system));
    island.condition = estimated_condition(system, p.scene.damping);
    out.J_size = std::max(out.J_size, size_of(system.J));
  }
}

std::vector<RobotPlaces> robot_places(const Scene& scene, const std::vector<IslandTruth>& islands) {
  std::vector<RobotPlaces> out(scene.nrobots());
  for (int r = 0; r < scene.nrobots(); ++r) {
    for (int i = 0; i < scene.robots[r].model->nv; ++i) out[r].v.push_back(scene.robots[r].idx_v + i);
    const auto has = [&](const IslandTruth& i) { return std::find(i.v.begin(), i.v.end(), out[r].v[0]) != i.v.end(); };
    out[r].island = static_cast<int>(std::find_if(islands.begin(), islands.end(), has) - islands.begin());
  }
  int row = 0;
  for (const Contact& c : scene.contacts)
    for (int i = 0; c.active && i < c.rows(); ++i, ++row) {
      out[c.A.robot].f.push_back(row);
      if (c.B.robot >= 0 && c.B.robot != c.A.robot) out[c.B.robot].f.push_back(row);
    }
  return out;
}

}  // namespace

Truths::Truths(const Problem& p) {
  Truth<Quad> truth = truth_of(p);
  if (p.only_known) truth.a = p.known->a, truth.f = p.known->f;
  a = truth.a;
  f = truth.f;
  p.scene.nv <= kDenseIfSingular ? look_closely(p, truth, *this) : look_from_afar(p, *this);
  exists = finite(a) && finite(f);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    islands[i].regular = p.answerable && truth.regular[i];
    exists = exists && islands[i].regular;
    rank += truth.rank[i];
  }
  rows = static_cast<int>(f.size());
  robots = robot_places(p.scene, islands);
  tau_b = -truth.h.template cast<double>();
  for (const Robot& r : p.scene.robots)
    tau_b.segment(r.idx_v + r.model->first_actuated(), r.model->nu()) += p.u.segment(r.idx_u, r.model->nu());
  if (!exists) return;
  const Eigen::VectorXd without = free_accelerations(p.scene, p.q, p.v, p.u);
  if (finite(without) && (size_of(p.v) == 0 || size_of(a) < kVanishingMotion * size_of(without))) a_free = without;
  directions = true_directions(p, *this);
}

const IslandReport& report_of(const Report& report, std::size_t island) {
  return report.islands.at(report.islands.size() == 1 ? 0 : island);
}

double condition_of(const Truths& truths, const Report& report, std::size_t island) {
  Condition c;
  for (std::size_t i = 0; i < truths.islands.size(); ++i) {
    if (&report_of(report, i) != &report_of(report, island)) continue;
    c.K = std::max(c.K, truths.islands[i].condition.K);
    c.inverse = std::max(c.inverse, truths.islands[i].condition.inverse);
  }
  return c.product();
}

Truths claimed(const Truths& damped, const Truths& undamped, const Report& report) {
  Truths out = undamped;
  out.exists = true;
  for (std::size_t i = 0; i < out.islands.size(); ++i) {
    IslandTruth& island = out.islands[i];
    if (report_of(report, i).status == Status::kRegularised) {
      island.damped_condition = damped.islands[i].condition;
    } else {
      island = damped.islands[i];
      out.a(island.v) = damped.a(island.v);
      out.f(island.f) = damped.f(island.f);
      if (damped.directions.empty()) out.directions.clear();
      for (std::size_t k = 0; k < out.directions.size(); ++k) {
        out.directions[k].da(island.v) = damped.directions[k].da(island.v);
        out.directions[k].df(island.f) = damped.directions[k].df(island.f);
      }
    }
    out.exists = out.exists && island.regular;
  }
  out.exists = out.exists && finite(out.a) && finite(out.f);
  return out;
}

Problem without_damping(Problem p) {
  p.scene.damping = 0;
  p.known.reset();
  p.only_known = false;
  return p;
}

}  // namespace manycontact::test
