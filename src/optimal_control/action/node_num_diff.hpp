#pragma once
// Derivatives of a node by central differences, in continuous and in discrete time.

#include <cmath>
#include <ostream>

#include "manycontact/action/num_diff.hpp"

namespace manycontact::internal {

/// The values of a node at a point. `next` is its acceleration, or its next state.
struct NodeValues {
  double cost;
  Eigen::VectorXd next, r, g, h;
};

/// A model around a point: x moved along the tangent, u as it is. A terminal node has no u.
template <class Node, class NodeData>
struct Around {
  Node& model;
  std::shared_ptr<NodeData> data;
  Eigen::VectorXd NodeData::*next;
  Eigen::VectorXd x, u;
  bool terminal;

  NodeValues operator()(const Eigen::VectorXd& dx, const Eigen::VectorXd& du) const {
    const Eigen::VectorXd at = model.get_state()->integrate_x(x, dx);
    if (terminal)
      model.calc(data, at);
    else
      model.calc(data, at, u + du);
    return {data->cost, (*data).*next, data->r, data->g, data->h};
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

namespace manycontact {

template <class Node, class NodeData>
NodeNumDiff<Node, NodeData>::NodeNumDiff(const char* name, std::shared_ptr<Node> model, bool with_gauss_approx,
                                         Eigen::VectorXd NodeData::*next, const char* where)
    : Node(internal::given(name, model)->get_state(), internal::given(name, model)->get_nu()),
      NumDiffOf<Node>(name, model, where),
      name_(name),
      gauss_(with_gauss_approx),
      next_(next) {
  this->u_lb_ = model->get_u_lb();
  this->u_ub_ = model->get_u_ub();
  this->update_has_control_limits();
}

template <class Node, class NodeData>
NodeDataNumDiff<NodeData>& NodeNumDiff<Node, NodeData>::own(const char* function, const Data& data) const {
  return internal::own_data<Own>(where(function).c_str(), data);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::copy_values(Own& d) const {
  const NodeData& from = *d.data_0;
  d.*next_ = from.*next_;
  d.cost = from.cost;
  d.r = from.r;
  d.g = from.g;
  d.h = from.h;
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::calc(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Own& d = own("calc", data);
  model_->calc(d.data_0, x, u);
  copy_values(d);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::calc(const Data& data, const ConstVectorRef& x) {
  Own& d = own("calc", data);
  model_->calc(d.data_0, x);
  copy_values(d);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::differentiate(Own& d, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                                                bool terminal) const {
  const auto step = [&](const Eigen::VectorXd& plus, const Eigen::VectorXd& minus) {
    return change(d, plus, minus, terminal);
  };
  internal::central_differences(internal::Around<Node, NodeData>{*model_, d.data_step, next_, x, u, terminal},
                                this->step_, gauss_, step(d.*next_, d.*next_).size(), step, d);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::calcDiff(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  differentiate(own("calcDiff", data), x, u, false);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::calcDiff(const Data& data, const ConstVectorRef& x) {
  differentiate(own("calcDiff", data), x, this->unone_, true);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::quasiStatic(const Data& data, VectorRef u, const ConstVectorRef& x,
                                              std::size_t maxiter, double tol) {
  model_->quasiStatic(own("quasiStatic", data).data_0, u, x, maxiter, tol);
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::print(std::ostream& os) const {
  os << name_ << " {" << *model_ << "}";
}

}  // namespace manycontact
