#include "manycontact/control/coupled_direction.hpp"

#include <algorithm>

#include "../constrained/quadratic_model.hpp"
#include "coordinates.hpp"
#include "manycontact/detail/control/couplings.hpp"
#include "manycontact/lq/choose.hpp"
#include "manycontact/lq/coupling_schur.hpp"
#include "manycontact/lq/kkt.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::VectorXd;
using Vectors = Direction::Vectors;

namespace {

bool same_coordinates(const ActionPart& a, const ActionPart& b) { return a.x == b.x && a.dx == b.dx && a.u == b.u; }

}  // namespace

CoupledPrediction predict_coupled(const std::vector<int>& nx, const std::vector<int>& nu,
                                  const std::vector<std::vector<std::pair<int, int>>>& couplings) {
  lq::Problem problem;
  problem.nx = nx;
  problem.nu = nu;
  for (const auto& of_node : couplings) problem.knots.push_back(internal::knot_of(nx.size(), of_node));
  problem.knots.push_back(internal::knot_of(nx.size(), {}));
  const lq::Prediction flops = lq::predict(problem);
  return {flops.dense, std::min(flops.islands, flops.coupling_schur)};
}

bool CoupledDirection::applies_to(const ShootingProblem& problem) {
  const ActionModelParts* last = internal::as_coupled(problem, problem.get_T());
  for (std::size_t t = 0; last && t < problem.get_T(); ++t) {
    const ActionModelParts* model = internal::as_coupled(problem, t);
    if (!model || !std::equal(model->get_parts().begin(), model->get_parts().end(), last->get_parts().begin(),
                              last->get_parts().end(), same_coordinates))
      return false;
  }
  return last != nullptr;
}

void CoupledDirection::resize() {
  Direction::resize();
  of_cluster_ = from_model_ = step_;
  u_of_cluster_.setZero(part_.problem->get_nu_max());
  blocks_ = internal::blocks_of(*part_.problem);
  lq_ = internal::structure_of(*part_.problem, blocks_);
  layout_ = lq::Layout(lq_);
  z_ = preconditioned_ = lq::Point(lq_, layout_);
  solver_ = lq::choose(lq_);
  const auto* schur = dynamic_cast<const lq::CouplingSchur*>(solver_.get());
  policies_ = schur ? &schur->clusters() : dynamic_cast<const lq::Riccati*>(solver_.get());
}

bool CoupledDirection::compute(double preg, double dreg) {
  internal::fill_nodes(*part_.problem, internal::Terms::kAll, lq_);
  const std::size_t T = k_.size();
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    auto x0 = lq_.x0.segment(layout_.x[i], lq_.nx[i]);
    is_feasible_ ? void(x0.setZero()) : internal::take(fs_[0], blocks_[i].dx, x0);
    for (std::size_t t = 0; t < T; ++t) {
      VectorXd& f = lq_.knots[t].groups[i].f;
      is_feasible_ ? void(f.setZero()) : gather(fs_[t + 1], blocks_[i].dx, f);
    }
  }
  outcome_ = solver_->factorize(lq_, {preg, dreg, 0});
  if (outcome_.status != lq::Status::kOk) return false;
  outcome_ = solver_->solve(lq_, z_);
  if (outcome_.status != lq::Status::kOk) return false;
  const lq::Change change = lq::cost_change(lq_, layout_, {preg, dreg, 0}, z_);
  improvement_ << -change.linear, -change.quadratic;
  for (std::size_t t = 0; t <= T; ++t)
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      internal::put(z_.lambda[t].segment(layout_.x[i], lq_.nx[i]), blocks_[i].dx, Vx_[t]);
      if (t < T) internal::put(-z_.u[t].segment(layout_.u[i], lq_.nu[i]), blocks_[i].u, k_[t]);
    }
  return true;
}

// Computes u = us + s du + K (x (-) xs - s dx) for the step length s, where K = du/dx as in lq/riccati.hpp.
void CoupledDirection::step_control(std::size_t t, double steplength) {
  part_.problem->model(t)->get_state()->diff(xs_[t], xs_try_[t], dx_[t]);
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (std::size_t j = 0; j < blocks_[i].dx.size(); ++j) {
      const Index at = layout_.x[i] + static_cast<Index>(j);
      from_model_[at] = dx_[t][blocks_[i].dx[j]] - steplength * z_.x[t][at];
    }
  us_try_[t] = us_[t] - steplength * k_[t];
  add_gains_times(t, from_model_, us_try_[t]);
}

// Calls use(cluster, K) for each cluster at node t, where K are the gains of the cluster's controls.
template <class Use>
void CoupledDirection::each_cluster(std::size_t t, Use&& use) {
  const std::vector<lq::Cluster>& clusters = policies_->plan()[t];
  for (std::size_t c = 0; c < clusters.size(); ++c)
    use(clusters[c], policies_->policy(static_cast<int>(t), static_cast<int>(c)).K.topRows(clusters[c].nu));
}

// Sets du = nu and dx = 0. Steps of SolverDDP::descend thus have the feedback K (x (-) xs) about the candidate xs.
void CoupledDirection::set_feed_forward(const Vectors& nu) {
  Direction::set_feed_forward(nu);
  for (VectorXd& dx : z_.x) dx.setZero();
}

void CoupledDirection::feed_forward_gradient(Vectors& g) {
  const std::size_t T = g.size();
  VectorXd gx;
  for (std::size_t t = T + 1; t-- > 0;) {
    const ActionModelParts& model = *internal::as_coupled(*part_.problem, t);
    VectorXd& gu = t < T ? g[t] : u_of_cluster_;
    coupled_gradient(model, static_cast<const ActionDataParts&>(*part_.problem->data(t)), Vx_[std::min(t + 1, T)],
                     t == T, {}, gx, gu);
    Vx_[t] = gx;
    if (t < T) add_feedback(t, gu, Vx_[t]);
  }
}

// Adds K^T g to `to`, where K = du/dx as in lq/riccati.hpp.
void CoupledDirection::add_feedback(std::size_t t, const VectorXd& g, VectorXd& to) {
  each_cluster(t, [&](const lq::Cluster& cluster, const auto& K) {
    auto u = u_of_cluster_.head(cluster.nu);
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b)
      internal::take(g, blocks_[cluster.blocks[b]].u, u.segment(cluster.u_start[b], lq_.nu[cluster.blocks[b]]));
    of_cluster_.head(cluster.nx).noalias() = K.transpose() * u;
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const std::vector<int>& dx = blocks_[cluster.blocks[b]].dx;
      for (std::size_t j = 0; j < dx.size(); ++j) to[dx[j]] += of_cluster_[cluster.x_start[b] + static_cast<Index>(j)];
    }
  });
}

// Solves the linear-quadratic problem with gradient g for the controls and zero for the states, which gives
//     nu = du - K dx = -H^-1 g
void CoupledDirection::precondition_feed_forward(Vectors& g) {
  const std::size_t T = g.size();
  lq_.x0.setZero();
  for (lq::Knot& knot : lq_.knots)
    for (lq::Group& group : knot.groups) {
      group.q.setZero();
      group.r.setZero();
      group.f.setZero();
    }
  for (std::size_t t = 0; t < T; ++t) {
    step_.setZero();
    add_feedback(t, g[t], step_);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      lq::Group& group = lq_.knots[t].groups[i];
      internal::take(g[t], blocks_[i].u, group.r.head(lq_.nu[i]));
      internal::take(step_, blocks_[i].dx, group.q);
      group.q = -group.q;
    }
  }
  const lq::Outcome outcome = solver_->solve(lq_, preconditioned_);
  const bool solved = outcome.status == lq::Status::kOk || outcome.status == lq::Status::kInaccurate;
  for (std::size_t t = 0; t < T && solved; ++t) {
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      internal::put(-preconditioned_.u[t].segment(layout_.u[i], lq_.nu[i]), blocks_[i].u, g[t]);
    add_gains_times(t, preconditioned_.x[t], g[t]);
  }
}

// Adds K dx to `to`, where dx is ordered by block.
void CoupledDirection::add_gains_times(std::size_t t, const VectorXd& dx, VectorXd& to) {
  each_cluster(t, [&](const lq::Cluster& cluster, const auto& K) {
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const int i = cluster.blocks[b];
      of_cluster_.segment(cluster.x_start[b], lq_.nx[i]) = dx.segment(layout_.x[i], lq_.nx[i]);
    }
    auto u = u_of_cluster_.head(cluster.nu);
    u.noalias() = K * of_cluster_.head(cluster.nx);
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const std::vector<int>& own = blocks_[cluster.blocks[b]].u;
      for (std::size_t j = 0; j < own.size(); ++j) to[own[j]] += u[cluster.u_start[b] + static_cast<Index>(j)];
    }
  });
}

std::vector<Direction::Gains> CoupledDirection::gains(std::size_t t) const {
  std::vector<Gains> out;
  if (outcome_.status != lq::Status::kOk || k_[t].size() == 0) return out;
  const std::vector<lq::Cluster>& clusters = policies_->plan()[t];
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const Eigen::MatrixXd& K = policies_->policy(static_cast<int>(t), static_cast<int>(c)).K;
    if (K.rows() < clusters[c].nu) return {};
    out.push_back({{}, {}, -K.topRows(clusters[c].nu)});
    for (const int b : clusters[c].blocks) {  // blocks in the order of x_start and u_start
      for (const int i : blocks_[b].dx) out.back().dx.push_back(part_.dx[i]);
      for (const int i : blocks_[b].u) out.back().u.push_back(part_.u[t][i]);
    }
  }
  return out;
}

std::vector<int> CoupledDirection::blocks() const {
  std::vector<int> out;
  for (const lq::Cluster& cluster : policies_->plan()[0]) out.push_back(cluster.nv);
  return out;
}

}  // namespace manycontact
