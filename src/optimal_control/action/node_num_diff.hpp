#pragma once

#include <cmath>
#include <ostream>

#include "by_node.hpp"
#include "manycontact/action/num_diff.hpp"

namespace manycontact::internal {

/// Computes [cost; next; r; g; h] at x (+) dx and u + du (without u in a terminal node), where next(data) returns the
/// acceleration or the next state.
template <class Node, class NodeData, class Next>
struct Around {
  Node& model;
  std::shared_ptr<NodeData> data;
  Next next;
  Eigen::VectorXd x, u;
  bool terminal;

  Eigen::VectorXd operator()(const Eigen::VectorXd& dx, const Eigen::VectorXd& du) const {
    const Eigen::VectorXd at = model.get_state()->integrate_x(x, dx);
    if (terminal)
      model.calc(data, at);
    else
      model.calc(data, at, u + du);
    const Eigen::VectorXd moved = next(*data);
    Eigen::VectorXd out(1 + moved.size() + data->r.size() + data->g.size() + data->h.size());
    out << data->cost, moved, data->r, data->g, data->h;
    return out;
  }
};

/// Computes the Hessian of the cost L by differences: L_ij = (L(+,+) - L(+,-) - L(-,+) + L(-,-)) / 4h^2, where the
/// signs are those of steps +-h e_i +-h e_j from x, u.
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
          sum += s * t * at(dz.head(ndx), dz.tail(nu))[0];
        }
      L(i, j) = L(j, i) = sum / (4 * h * h);
    }
  d.Lxx = L.topLeftCorner(ndx, ndx);
  if (at.terminal) return;
  d.Lxu = L.topRightCorner(ndx, nu);
  d.Luu = L.bottomRightCorner(nu, nu);
}

/// Computes all derivatives in d, where d.g, d.h, d.r must have the right sizes. Steps are absolute in the tangent
/// space of x, and relative to max(1, |u_i|) in u. gauss: Hessians are Rx^T Rx, ..., instead of second differences.
template <class Function, class Data>
void central_differences(const Function& at, double step, bool gauss, Data& d) {
  const Eigen::Index ndx = static_cast<Eigen::Index>(at.model.get_state()->get_ndx()), nu = at.u.size();
  const Eigen::Index nf = at.next(d).size(), nr = d.r.size(), ng = d.g.size(), nh = d.h.size();
  const Eigen::VectorXd no_x = Eigen::VectorXd::Zero(ndx), no_u = Eigen::VectorXd::Zero(nu);
  Eigen::MatrixXd by_x(1 + nf + nr + ng + nh, ndx), by_u = Eigen::MatrixXd::Zero(by_x.rows(), nu);
  for (Eigen::Index i = 0; i < ndx; ++i) {
    const Eigen::VectorXd dx = step * Eigen::VectorXd::Unit(ndx, i);
    by_x.col(i) = (at(dx, no_u) - at(-dx, no_u)) / (2 * step);
  }
  for (Eigen::Index i = 0; i < nu && !at.terminal; ++i) {
    const double h = step * std::max(1.0, std::abs(at.u[i]));
    const Eigen::VectorXd du = h * Eigen::VectorXd::Unit(nu, i);
    by_u.col(i) = (at(no_x, du) - at(no_x, -du)) / (2 * h);
  }
  d.Lx = by_x.row(0);
  if (!at.terminal) d.Lu = by_u.row(0);
  d.Fx = by_x.middleRows(1, nf), d.Fu = by_u.middleRows(1, nf);
  d.Rx = by_x.middleRows(1 + nf, nr), d.Ru = by_u.middleRows(1 + nf, nr);
  d.Gx = by_x.middleRows(1 + nf + nr, ng), d.Gu = by_u.middleRows(1 + nf + nr, ng);
  d.Hx = by_x.bottomRows(nh), d.Hu = by_u.bottomRows(nh);
  if (!gauss) return second_differences(at, ndx, d);
  d.Lxx = d.Rx.transpose() * d.Rx;
  d.Lxu = d.Rx.transpose() * d.Ru;
  d.Luu = d.Ru.transpose() * d.Ru;
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
void NodeNumDiff<Node, NodeData>::evaluate(const Data& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  Own& d = own("calc", data);
  internal::calc(*model_, d.data_0, x, u);
  const NodeData& from = *d.data_0;
  d.*next_ = from.*next_;
  d.cost = from.cost;
  d.r = from.r;
  d.g = from.g;
  d.h = from.h;
}

template <class Node, class NodeData>
void NodeNumDiff<Node, NodeData>::differentiate(const Data& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                                                bool terminal) const {
  Own& d = own("calcDiff", data);
  const auto next = [&](const NodeData& moved) { return coordinates(d, moved, terminal); };
  internal::central_differences(
      internal::Around<Node, NodeData, decltype(next)>{*model_, d.data_step, next, x, u, terminal}, this->step_, gauss_,
      d);
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
