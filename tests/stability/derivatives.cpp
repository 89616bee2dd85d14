#include "stability/derivatives.hpp"

#include <numeric>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "stability/island_system.hpp"
#include "support/measure.hpp"
#include "support/random.hpp"
#include "support/truth.hpp"

namespace manycontact::test {

namespace {

constexpr int kLargest = 80;                // unknowns of an island: differences of the truth take five solves of it
constexpr double kVanishingChange = 1e-12;  // smaller changes, relative to the others, count as zero

Truth<Quad> truth_along(const Problem& p, const Direction& d, const Quad& h) {
  VecX<Quad> q = p.q.cast<Quad>(), v = p.v.cast<Quad>(), u = p.u.cast<Quad>();
  for (const Robot& robot : p.scene.robots) {
    if (d.dq.size() == 0) break;
    const Model& model = *robot.model;
    VecX<Quad> moved(model.nq);
    integrate<Quad>(model, q.segment(robot.idx_q, model.nq), h * d.dq.segment(robot.idx_v, model.nv), moved);
    q.segment(robot.idx_q, model.nq) = moved;
  }
  if (d.dv.size() > 0) v += h * d.dv;
  if (d.du.size() > 0) u += h * d.du;
  return solve_truth<Quad>(p.scene, active(p.scene), q, v, u);
}

// Returns the step of the differences. Any step in v and u is exact: a and f are quadratic in v and linear in u. In q
// the noise is 1e-20 or less, and the step is too short to pass half a revolution less 1e-12. Dependent rows need a
// longer one: ranks are judged at 1e-11, and a rank that is the same this far off does not change nearby.
Quad step(bool in_q, bool dependent) {
  if (!in_q) return Quad(1);
  return Quad(1) / Quad(dependent ? 1000000000LL : 100000000000000LL);
}

// Whether the truth is differentiable along a direction with the same rank. If so, computes its change.
bool differentiate_truth(const Problem& p, const Truths& truths, Direction& d) {
  const auto same_rank = [&](const Truth<Quad>& t) {
    return std::accumulate(t.rank.begin(), t.rank.end(), 0) == truths.rank;
  };
  const Quad h = step(d.dq.size() > 0, p.scene.damping == 0 && truths.rank < truths.rows);
  const Truth<Quad> after = truth_along(p, d, h);
  if (d.du.size() > 0) {
    d.da = after.a - truths.a;
    d.df = after.f - truths.f;
    return same_rank(after);
  }
  const Truth<Quad> before = truth_along(p, d, -h);
  d.da = (after.a - before.a) / (2 * h);
  d.df = (after.f - before.f) / (2 * h);
  return same_rank(after) && same_rank(before);
}

Eigen::VectorXd times(const Eigen::MatrixXd& by_q, const Eigen::MatrixXd& by_v, const Eigen::MatrixXd& by_u,
                      const Direction& d) {
  if (d.dq.size() > 0) return by_q * d.dq.cast<double>();
  return d.dv.size() > 0 ? by_v * d.dv.cast<double>() : by_u * d.du.cast<double>();
}

}  // namespace

std::vector<Direction> true_directions(const Problem& p, const Truths& truths) {
  if (!truths.exists || p.only_known) return {};
  for (const IslandTruth& island : truths.islands)
    if (static_cast<int>(island.v.size() + island.f.size()) > kLargest) return {};
  std::mt19937 rng(21);
  std::vector<Direction> out(3);
  out[0].dq = random_vector(p.scene.nv, rng).cast<Quad>();
  out[1].dv = random_vector(p.scene.nv, rng).cast<Quad>();
  out[2].du = random_vector(p.scene.nu, rng).cast<Quad>();
  for (Direction& d : out)
    if (!differentiate_truth(p, truths, d)) return {};
  return out;
}

DirectionErrors direction_errors(const Problem& p, const Truths& truths, SceneData& data) {
  DirectionErrors out;
  if (truths.directions.empty()) return out;
  differentiate(p.scene, data);
  const SceneDerivatives D = dense_derivatives(p.scene, data);
  for (const RobotPlaces& at : truths.robots) {
    if (report_of(data.report, at.island).status == Status::kFailed) continue;
    double most = 0;  // largest change with this robot
    for (const Direction& d : truths.directions) most = worse(most, worse(size_of(d.da(at.v)), size_of(d.df(at.f))));
    const auto add = [&](const VecX<Quad>& truth, const Eigen::VectorXd& mine) {
      const double difference = difference_of(mine, truth), size = size_of(truth);
      const double error = difference == 0 ? 0 : difference / (size < kVanishingChange * most ? most : size);
      out.largest = worse(out.largest, error);
      out.excess = worse(out.excess, error / (10 * allowed(condition_of(truths, data.report, at.island))));
    };
    for (const Direction& d : truths.directions) {
      add(d.da(at.v), times(D.da_dq, D.da_dv, D.da_du, d)(at.v));
      add(d.df(at.f), times(D.dforces_dq, D.dforces_dv, D.dforces_du, d)(at.f));
    }
  }
  return out;
}

}  // namespace manycontact::test
