#pragma once
// Derivatives by central differences, of models in continuous and in discrete time: the parts that their NumDiff
// classes share.

#include <cmath>

#include "manycontact/action/state.hpp"

namespace manycontact::internal {

/// column(i, (f(+) - f(-)) / 2h) for each of n directions; f(step of direction i), column(i, f(+), f(-), 2h).
template <class F, class Column>
void each_direction(Eigen::Index n, double h, F&& f, Column&& column) {
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
    d[i] = h;
    const auto plus = f(d);
    const auto minus = f(-d);
    column(i, plus, minus, 2 * h);
  }
}

/// The Jacobian of a function of n numbers.
template <class F>
Eigen::MatrixXd jacobian(Eigen::Index rows, Eigen::Index n, double h, F&& f) {
  Eigen::MatrixXd J(rows, n);
  each_direction(n, h, f, [&](Eigen::Index i, const Eigen::VectorXd& plus, const Eigen::VectorXd& minus, double width) {
    J.col(i) = (plus - minus) / width;
  });
  return J;
}

/// The same by u, whose steps are relative.
template <class F>
Eigen::MatrixXd jacobian_by_u(Eigen::Index rows, const Eigen::VectorXd& u, double h, F&& f) {
  const Eigen::VectorXd scale = u.cwiseAbs().cwiseMax(1);
  return jacobian(rows, u.size(), h, [&](const Eigen::VectorXd& d) { return f(u + scale.cwiseProduct(d)); }) *
         scale.cwiseInverse().asDiagonal();
}

/// The values of a node at a point. `next` is its acceleration, or its next state.
struct NodeValues {
  double cost;
  Eigen::VectorXd next, r, g, h;
};

/// A model around a point: x moved along the tangent, u as it is. `next` gives what its data have as NodeValues::next.
/// A terminal node has no u.
template <class Model, class Data, class Next>
struct Around {
  Model& model;
  std::shared_ptr<Data> data;
  Next next;
  Eigen::VectorXd x, u;
  bool terminal;

  NodeValues operator()(const Eigen::VectorXd& dx, const Eigen::VectorXd& du) const {
    const Eigen::VectorXd at = model.get_state()->integrate_x(x, dx);
    if (terminal)
      model.calc(data, at);
    else
      model.calc(data, at, u + du);
    return {data->cost, next(*data), data->r, data->g, data->h};
  }
};

/// L_ij = (L(+,+) - L(+,-) - L(-,+) + L(-,-)) / 4h^2
template <class Function, class Data>
void second_differences(const Function& at, Eigen::Index ndx, Data& d) {
  const Eigen::Index nu = at.u.size(), n = ndx + (at.terminal ? 0 : nu);
  const double h = std::pow(std::numeric_limits<double>::epsilon(), 0.25);
  Eigen::MatrixXd L(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (int s : {1, -1})
        for (int t : {1, -1}) {
          Eigen::VectorXd dz = Eigen::VectorXd::Zero(ndx + nu);
          dz[i] += s * h;
          dz[j] += t * h;
          sum += s * t * at(dz.head(ndx), dz.tail(nu)).cost;
        }
      L(i, j) = L(j, i) = sum / (4 * h * h);
    }
  d.Lxx = L.topLeftCorner(ndx, ndx);
  if (at.terminal) return;
  d.Lxu = L.topRightCorner(ndx, nu);
  d.Luu = L.bottomRightCorner(nu, nu);
}

/// All derivatives of d, whose g, h, r have their sizes. The step is absolute in x's tangent, relative to max(1, |u_i|)
/// in u. change(plus, minus): from one `next` to another, `rows` numbers. gauss: Hessians Rx^T Rx, ..., not second
/// differences.
template <class Function, class Change, class Data>
void central_differences(const Function& at, double step, bool gauss, Eigen::Index rows, Change&& change, Data& d) {
  const Eigen::Index ndx = static_cast<Eigen::Index>(at.model.get_state()->get_ndx()), nu = at.u.size();
  const Eigen::Index nr = d.r.size(), ng = d.g.size(), nh = d.h.size();
  d.Fx.setZero(rows, ndx), d.Fu.setZero(rows, nu);
  d.Rx.setZero(nr, ndx), d.Ru.setZero(nr, nu);
  d.Gx.setZero(ng, ndx), d.Gu.setZero(ng, nu);
  d.Hx.setZero(nh, ndx), d.Hu.setZero(nh, nu);
  const auto differ = [&](bool by_x, Eigen::Index i, Eigen::VectorXd& L, Eigen::MatrixXd& F, Eigen::MatrixXd& R,
                          Eigen::MatrixXd& G, Eigen::MatrixXd& H) {
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(ndx), du = Eigen::VectorXd::Zero(nu);
    const double h = by_x ? step : step * std::max(1.0, std::abs(at.u[i]));
    (by_x ? dx : du)[i] = h;
    const NodeValues plus = at(dx, du), minus = at(-dx, -du);
    L[i] = (plus.cost - minus.cost) / (2 * h);
    F.col(i) = change(plus.next, minus.next) / (2 * h);
    R.col(i) = (plus.r - minus.r) / (2 * h);
    G.col(i) = (plus.g - minus.g) / (2 * h);
    H.col(i) = (plus.h - minus.h) / (2 * h);
  };
  for (Eigen::Index i = 0; i < ndx; ++i) differ(true, i, d.Lx, d.Fx, d.Rx, d.Gx, d.Hx);
  for (Eigen::Index i = 0; i < nu && !at.terminal; ++i) differ(false, i, d.Lu, d.Fu, d.Ru, d.Gu, d.Hu);
  if (gauss) {
    d.Lxx = d.Rx.transpose() * d.Rx;
    d.Lxu = d.Rx.transpose() * d.Ru;
    d.Luu = d.Ru.transpose() * d.Ru;
  } else {
    second_differences(at, ndx, d);
  }
}

}  // namespace manycontact::internal
