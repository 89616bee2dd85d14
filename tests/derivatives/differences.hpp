#pragma once
// Derivatives of accelerations and contact forces come from central differences of the truth in quadruple precision,
// accurate to about 1e-20. Errors of solutions are relative, in the maximum norm, per quantity and robot. Ten times the
// allowed error of a value is allowed.

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "support/islands.hpp"
#include "support/measure.hpp"
#include "support/truth.hpp"

namespace manycontact::test {

struct State {
  Eigen::VectorXd q, v, u;
};

inline double allowed_of_derivative(double condition) { return 10 * allowed(condition); }

// ---- the truth --------------------------------------------------------------------------------------------------

/// Returns the truth at a state moved by h along a direction of the tangent space. Empty: not moved.
inline Truth<Quad> truth_along(const Scene& scene, const std::vector<char>& active, const State& s, const Quad& h,
                               const VecX<Quad>& dq, const VecX<Quad>& dv, const VecX<Quad>& du) {
  VecX<Quad> q = s.q.cast<Quad>(), v = s.v.cast<Quad>(), u = s.u.cast<Quad>();
  for (const Robot& robot : scene.robots) {
    if (dq.size() == 0) break;
    const Model& model = *robot.model;
    VecX<Quad> moved(model.nq);
    integrate<Quad>(model, q.segment(robot.idx_q, model.nq), h * dq.segment(robot.idx_v, model.nv), moved);
    q.segment(robot.idx_q, model.nq) = moved;
  }
  if (dv.size() > 0) v += h * dv;
  if (du.size() > 0) u += h * du;
  return solve_truth<Quad>(scene, active, q, v, u);
}

/// [a; f] differentiated along a direction.
struct DirectionalTruth {
  VecX<Quad> da, df;
};
inline DirectionalTruth difference_along(const Scene& scene, const std::vector<char>& active, const State& s,
                                         const VecX<Quad>& dq, const VecX<Quad>& dv, const VecX<Quad>& du) {
  const Quad h = Quad(1) / Quad(10000000000LL);
  const Truth<Quad> after = truth_along(scene, active, s, h, dq, dv, du);
  const Truth<Quad> before = truth_along(scene, active, s, -h, dq, dv, du);
  EXPECT_EQ(after.rank, before.rank);
  return {(after.a - before.a) / (2 * h), (after.f - before.f) / (2 * h)};
}

/// Returns [a; f] differentiated along a direction of u: it is affine, so any step is exact. `here`: not moved.
inline DirectionalTruth difference_along_u(const Scene& scene, const std::vector<char>& active, const State& s,
                                           const Truth<Quad>& here, const VecX<Quad>& du) {
  const Truth<Quad> there = truth_along(scene, active, s, 1, {}, {}, du);
  EXPECT_EQ(there.rank, here.rank);
  return {there.a - here.a, there.f - here.f};
}

/// Coordinates of the scene behind an island's rows and columns.
struct Places {
  std::vector<int> v, u, f;

  Places(const Scene& scene, const SceneData& data, const Island& island) {
    for (int r : island.robots) {
      for (int i = 0; i < scene.robots[r].model->nv; ++i) v.push_back(scene.robots[r].idx_v + i);
      for (int i = 0; i < scene.robots[r].model->nu(); ++i) u.push_back(scene.robots[r].idx_u + i);
    }
    for (int c : island.contacts)
      for (int i = 0; i < scene.contacts[c].rows(); ++i) f.push_back(data.f_offset[c] + i);
  }
};

/// Returns per island the matrix of [a; f] differentiated by [q | v | u], laid out like IslandDerivatives::X, after
/// prepare. The k-th coordinates of all islands move at once: no island depends on another's.
inline std::vector<MatX<Quad>> differences(const Scene& scene, const SceneData& data, const State& s) {
  std::vector<Places> places;
  std::vector<MatX<Quad>> out;
  std::size_t most = 0;
  for (const Island& island : islands_at(scene, data)) {
    const Places& p = places.emplace_back(scene, data, island);
    out.push_back(MatX<Quad>::Zero(island.size(), 2 * p.v.size() + p.u.size()));
    most = std::max(most, p.v.size());
  }
  const VecX<Quad> none;
  const Truth<Quad> here = truth_along(scene, data.active, s, 0, none, none, none);
  for (int by = 0; by < 3; ++by)
    for (std::size_t k = 0; k < most; ++k) {
      VecX<Quad> step = VecX<Quad>::Zero(by == 2 ? scene.nu : scene.nv);
      bool moves = false;
      for (const Places& p : places) {
        const std::vector<int>& of = by == 2 ? p.u : p.v;
        if (k < of.size()) step[of[k]] = 1, moves = true;
      }
      if (!moves) continue;
      const DirectionalTruth d =
          by == 2 ? difference_along_u(scene, data.active, s, here, step)
                  : difference_along(scene, data.active, s, by == 0 ? step : none, by == 1 ? step : none, none);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Places& p = places[i];
        if (k >= (by == 2 ? p.u : p.v).size()) continue;
        const std::size_t column = by * p.v.size() + k, nv = p.v.size();
        for (std::size_t r = 0; r < nv; ++r) out[i](r, column) = d.da[p.v[r]];
        for (std::size_t r = 0; r < p.f.size(); ++r) out[i](nv + r, column) = d.df[p.f[r]];
      }
    }
  return out;
}

// ---- errors -----------------------------------------------------------------------------------------------------

inline constexpr std::array<const char*, 6> kQuantities = {"da_dq",      "da_dv",      "da_du",
                                                           "dforces_dq", "dforces_dv", "dforces_du"};

/// Returns the larger one; NaN if either is.
inline double worse(double a, double b) { return b <= a ? a : a != a ? a : b; }

/// The largest relative errors over the robots, and the largest of all relative to the allowed error.
struct DerivativeErrors {
  std::array<double, 6> quantity = {};
  double excess = 0;

  void add(const DerivativeErrors& o) {
    for (int k = 0; k < 6; ++k) quantity[k] = worse(quantity[k], o.quantity[k]);
    excess = worse(excess, o.excess);
  }
};

/// Returns where the columns of q, v and u begin in an island's matrices, and where they end.
inline std::array<int, 4> column_kinds(const Island& island, const MatX<Quad>& truth) {
  return {0, island.nv, 2 * island.nv, static_cast<int>(truth.cols())};
}

/// Returns a robot's rows of an island: of its accelerations, or of its contacts.
inline std::vector<int> rows_of(const Scene& scene, const Island& island, int robot, bool forces) {
  std::vector<int> rows;
  if (!forces) {
    const int first = island.dof_offset[local_robot(island, robot)];
    for (int i = 0; i < scene.robots[robot].model->nv; ++i) rows.push_back(first + i);
    return rows;
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    if (contact.A.robot != robot && contact.B.robot != robot) continue;
    for (int i = 0; i < contact.rows(); ++i) rows.push_back(island.nv + island.row_offset[k] + i);
  }
  return rows;
}

/// Returns errors of an island's rows [a; f], in columns of three kinds: q's, v's and u's, of which first[k] is the
/// first. Where a derivative is exactly zero the differences leave noise: values below 1e-20 of the robot's other
/// derivatives are noise, and errors are relative to the others.
inline DerivativeErrors derivative_errors(const Scene& scene, const Island& island, const Eigen::MatrixXd& answer,
                                          const MatX<Quad>& truth, const std::array<int, 4>& first, double condition) {
  DerivativeErrors e;
  for (int robot : island.robots)
    for (int forces = 0; forces < 2; ++forces) {
      const std::vector<int> rows = rows_of(scene, island, robot, forces);
      const MatX<Quad> all = truth(rows, Eigen::all);
      const double noise = 1e-20 * size_of(all);
      for (int by = 0; by < 3; ++by) {
        const auto columns = Eigen::seq(first[by], first[by + 1] - 1);
        const MatX<Quad> part = all(Eigen::all, columns);
        const Eigen::MatrixXd mine = answer(rows, columns);
        const double difference = difference_of(mine, part), size = size_of(part);
        const double error = difference <= noise ? 0 : difference / (size <= noise ? size_of(all) : size);
        e.quantity[3 * forces + by] = worse(e.quantity[3 * forces + by], error);
        e.excess = worse(e.excess, error / allowed_of_derivative(condition));
      }
    }
  return e;
}

// ---- answers ----------------------------------------------------------------------------------------------------

/// Computes derivatives at the last solve, over NaN.
inline const DerivativeData& differentiate_afresh(const Scene& scene, SceneData& data,
                                                  const DerivativeRequest& request = {}) {
  differentiate(scene, data, request);
  for (const IslandDerivatives& island : derivatives(data).islands)
    const_cast<IslandDerivatives&>(island).X.setConstant(NAN);
  return differentiate(scene, data, request);
}

}  // namespace manycontact::test
