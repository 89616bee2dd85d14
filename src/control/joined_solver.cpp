#include "manycontact/control/joined_solver.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <typeinfo>

#include "coordinates.hpp"
#include "joined_parts.hpp"
#include "kkt_residual.hpp"
#include "manycontact/lq/bond_schur.hpp"
#include "manycontact/lq/choose.hpp"
#include "manycontact/lq/kkt.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

const ActionModelJoined* as_joined(const ShootingProblem& problem, std::size_t t) {
  return dynamic_cast<const ActionModelJoined*>(problem.model(t).get());
}

// One group per block, with the bonds that touch it.
lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& bonds) {
  lq::Knot knot;
  for (std::size_t i = 0; i < blocks; ++i) {
    lq::Group group;
    group.blocks = {static_cast<int>(i)};
    for (std::size_t b = 0; b < bonds.size(); ++b)
      if (bonds[b].first == static_cast<int>(i) || bonds[b].second == static_cast<int>(i))
        group.bonds.push_back(static_cast<int>(b));
    knot.groups.push_back(std::move(group));
  }
  knot.bonds.assign(bonds.size(), {6, 6});
  return knot;
}

std::vector<std::pair<int, int>> pairs_of(const ActionModelJoined& model) {
  std::vector<std::pair<int, int>> out;
  for (const JoinedBond& bond : model.get_bonds()) out.emplace_back(bond.part_a, bond.part_b);
  return out;
}

// Zeros of the right sizes: a block and a group for each part.
lq::Problem structure_of(const ShootingProblem& problem) {
  lq::Problem out;
  for (const ActionPart& part : as_joined(problem, 0)->get_parts()) {
    out.nx.push_back(static_cast<int>(part.dx.size()));
    out.nu.push_back(static_cast<int>(part.u.size()));
  }
  for (std::size_t t = 0; t < problem.get_T(); ++t)
    out.knots.push_back(knot_of(out.nx.size(), pairs_of(*as_joined(problem, t))));
  out.knots.push_back(knot_of(out.nx.size(), {}));
  lq::set_zero(out);
  return out;
}

// J1 and h J2 of symplectic Euler; what is derived from it may step otherwise.
void fill_steps(const ActionModelAbstract& model, ActionDataAbstract& data, std::optional<lq::Steps>& out) {
  const auto* augmented = dynamic_cast<const ActionModelAugmentedLagrangian*>(&model);
  const ActionModelAbstract& node = augmented ? *augmented->get_model() : model;
  const IntegratedActionDataEuler& euler = internal::euler_of(data);
  if (typeid(node) != typeid(IntegratedActionModelEuler) || !euler.joints_are_known) return out.reset();
  if (!out) out.emplace();
  const auto fill = [&](lq::BlockDiagonal& D, double scale, double of_joint,
                        Mat6<double> IntegratedActionDataEuler::WideJoint::*which) {
    D.scale = scale;
    D.parts.resize(euler.wide_joints.size());
    for (std::size_t k = 0; k < D.parts.size(); ++k) {
      const IntegratedActionDataEuler::WideJoint& joint = euler.wide_joints[k];
      D.parts[k].first = joint.first;
      D.parts[k].block = of_joint * (joint.*which).topLeftCorner(joint.size, joint.size);
    }
  };
  fill(out->J, 1, 1, &IntegratedActionDataEuler::WideJoint::of_x);
  fill(out->G, euler.step, euler.step, &IntegratedActionDataEuler::WideJoint::of_dx);
}

// From the nodes' derivatives: all but f and x0.
void fill_nodes(const ShootingProblem& problem, lq::Problem& out) {
  const std::size_t T = problem.get_T();
  for (std::size_t t = 0; t <= T; ++t) {
    const auto& data = static_cast<const ActionDataJoined&>(*problem.data(t));
    const std::vector<JoinedPart>& parts = as_joined(problem, t)->get_parts();
    for (std::size_t i = 0; i < data.parts.size(); ++i) {
      lq::Group& group = out.knots[t].groups[i];
      const ActionDataAbstract& from = *data.parts[i];
      group.Q = from.Lxx;
      group.q = from.Lx;
      if (t == T) continue;
      group.S = from.Lxu;
      group.R = from.Luu;
      group.r = from.Lu;
      group.A = from.Fx;
      group.B = from.Fu;
      fill_steps(*parts[i].model, *data.parts[i], group.steps);
      group.C = data.C[i];
      group.D = data.D[i];
    }
  }
}

}  // namespace

namespace internal {

namespace {

// Part i's controls that stand at a limit: their slope is the limit's multiplier.
void leave_out_limits(const ActionModelJoined& model, std::size_t i, const VectorXd& u, bool limits, lq::Knot& knot) {
  const std::vector<int>& own = model.get_parts()[i].u;
  lq::Group& group = knot.groups[i];
  for (std::size_t j = 0; j < own.size(); ++j) {
    if (!stands_at_limit(model, u, own[j], limits)) continue;
    const Index at = static_cast<Index>(j);
    group.B.col(at).setZero();
    group.D.col(at).setZero();
    group.r[at] = 0;
  }
}

}  // namespace

// The problem of kkt_residual.hpp with the wrenches as variables that cost nothing but Lw.
std::vector<VectorXd> least_squares_multipliers_of_joined(const ShootingProblem& problem,
                                                          const std::vector<VectorXd>& us, bool limits) {
  lq::Problem lq = structure_of(problem);
  fill_nodes(problem, lq);
  for (lq::Knot& knot : lq.knots)
    for (std::size_t i = 0; i < knot.groups.size(); ++i) {
      lq::Group& group = knot.groups[i];
      group.Q.setIdentity();
      group.S.setZero();
      group.R.setZero();
      if (&knot == &lq.knots.back()) continue;
      for (int j = 0; j < lq.nu[i]; ++j) group.R(j, j) = 1;
    }
  for (std::size_t t = 0; t < us.size(); ++t)
    for (std::size_t i = 0; i < lq.nu.size(); ++i)
      leave_out_limits(*as_joined(problem, t), i, us[t], limits, lq.knots[t]);
  const std::unique_ptr<lq::DirectionSolver> solver = lq::choose(lq);
  lq::Point z;
  const bool answered =
      solver->factorize(lq).status == lq::Status::kOk && solver->solve(lq, z).status == lq::Status::kOk;
  const lq::Layout layout(lq);
  std::vector<VectorXd> out(problem.get_T() + 1, VectorXd::Constant(static_cast<Index>(problem.get_ndx()),
                                                                    std::numeric_limits<double>::quiet_NaN()));
  const std::vector<JoinedPart>& parts = as_joined(problem, 0)->get_parts();
  for (std::size_t t = 0; answered && t < out.size(); ++t)
    for (std::size_t i = 0; i < parts.size(); ++i)
      scatter(z.lambda[t].segment(layout.x[i], lq.nx[i]), parts[i].dx, out[t]);
  return out;
}

}  // namespace internal

JoinedPrediction predict_joined(const std::vector<int>& nx, const std::vector<int>& nu,
                                const std::vector<std::vector<std::pair<int, int>>>& bonds) {
  lq::Problem problem;
  problem.nx = nx;
  problem.nu = nu;
  for (const auto& of_node : bonds) problem.knots.push_back(knot_of(nx.size(), of_node));
  problem.knots.push_back(knot_of(nx.size(), {}));
  const lq::Prediction flops = lq::predict(problem);
  return {flops.dense, std::min(flops.islands, flops.bond_schur)};
}

bool SolverJoinedPart::serves(const ShootingProblem& problem) {
  const ActionModelJoined* last = as_joined(problem, problem.get_T());
  for (std::size_t t = 0; last && t < problem.get_T(); ++t) {
    const ActionModelJoined* model = as_joined(problem, t);
    if (!model || model->get_parts().size() != last->get_parts().size()) return false;
    for (std::size_t i = 0; i < last->get_parts().size(); ++i)
      if (model->get_parts()[i].dx != last->get_parts()[i].dx || model->get_parts()[i].x != last->get_parts()[i].x ||
          model->get_parts()[i].u != last->get_parts()[i].u)
        return false;
  }
  return last != nullptr;
}

SolverJoinedPart::SolverJoinedPart(ShootingPart part) : SolverSparsePart(std::move(part), WithoutMatrices{}) {
  SolverJoinedPart::allocateData();
}

void SolverJoinedPart::allocateData() {
  const std::size_t T = problem_->get_T();
  const Index nx = static_cast<Index>(problem_->get_nx()), ndx = static_cast<Index>(problem_->get_ndx());
  const Index nu = static_cast<Index>(problem_->get_terminalModel()->get_nu());
  xs_try_.assign(T + 1, VectorXd::Zero(nx));
  Vx_.assign(T + 1, VectorXd::Zero(ndx));
  dx_.assign(T, VectorXd::Zero(ndx));
  us_try_.assign(T, VectorXd::Zero(nu));
  k_ = us_try_;
  step_ = from_model_ = of_cluster_ = VectorXd::Zero(ndx);
  u_of_cluster_ = VectorXd::Zero(nu);
  xnext_ = VectorXd::Zero(nx);
  lq_ = structure_of(*problem_);
  layout_ = lq::Layout(lq_);
  z_ = preconditioned_ = lq::Point(lq_, layout_);
  direction_ = lq::choose(lq_);
  const auto* schur = dynamic_cast<const lq::BondSchur*>(direction_.get());
  policies_ = schur ? &schur->clusters() : dynamic_cast<const lq::Riccati*>(direction_.get());
}

// What the nodes do not give: gaps.
void SolverJoinedPart::fill() {
  fill_nodes(*problem_, lq_);
  if (is_feasible_) {
    for (lq::Knot& knot : lq_.knots)
      for (lq::Group& group : knot.groups) group.f.setZero();
    lq_.x0.setZero();
    return;
  }
  const std::size_t T = problem_->get_T();
  const std::vector<JoinedPart>& parts = as_joined(*problem_, T)->get_parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t t = 0; t < T; ++t) gather(fs_[t + 1], parts[i].dx, lq_.knots[t].groups[i].f);
    internal::take(fs_[0], parts[i].dx, lq_.x0.segment(layout_.x[i], lq_.nx[i]));
  }
}

void SolverJoinedPart::backwardPass() {
  fill();
  sound_ = false;
  outcome_ = direction_->factorize(lq_, {preg_, dreg_, 0});
  if (outcome_.status != lq::Status::kOk) return;
  outcome_ = direction_->solve(lq_, z_);
  if (outcome_.status != lq::Status::kOk) return;
  sound_ = true;
  const lq::Change change = lq::cost_change(lq_, layout_, {preg_, dreg_, 0}, z_);
  d_ << -change.linear, -change.quadratic;
  dg_ = d_[0];
  dq_ = d_[1];
  const std::vector<JoinedPart>& parts = as_joined(*problem_, problem_->get_T())->get_parts();
  for (std::size_t t = 0; t < Vx_.size(); ++t)
    for (std::size_t i = 0; i < parts.size(); ++i) {
      internal::put(z_.lambda[t].segment(layout_.x[i], lq_.nx[i]), parts[i].dx, Vx_[t]);
      if (t < k_.size()) internal::put(-z_.u[t].segment(layout_.u[i], lq_.nu[i]), parts[i].u, k_[t]);
    }
}

// u = us + s du + K (x (-) xs - s dx), K of lq's sign
void SolverJoinedPart::stepControl(std::size_t t, double steplength) {
  problem_->model(t)->get_state()->diff(xs_[t], xs_try_[t], dx_[t]);
  const std::vector<JoinedPart>& parts = as_joined(*problem_, t)->get_parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = 0; j < parts[i].dx.size(); ++j) {
      const Index at = layout_.x[i] + static_cast<Index>(j);
      from_model_[at] = dx_[t][parts[i].dx[j]] - steplength * z_.x[t][at];
    }
  us_try_[t] = us_[t] - steplength * k_[t];
  add_gains_times(t, from_model_, us_try_[t]);
}

// use(cluster, K of its controls)
template <class Use>
void SolverJoinedPart::each_cluster(std::size_t t, Use&& use) {
  const std::vector<lq::Cluster>& clusters = policies_->plan()[t];
  for (std::size_t c = 0; c < clusters.size(); ++c)
    use(clusters[c], policies_->policy(static_cast<int>(t), static_cast<int>(c)).K.topRows(clusters[c].nu));
}

// About the candidate itself.
void SolverJoinedPart::setFeedForward(const std::vector<VectorXd>& nu) {
  SolverSparsePart::setFeedForward(nu);
  for (VectorXd& dx : z_.x) dx.setZero();
}

void SolverJoinedPart::computeFeedForwardGradient(std::vector<VectorXd>& g) {
  const std::size_t T = problem_->get_T();
  g.resize(T);
  VectorXd gx;
  for (std::size_t t = T + 1; t-- > 0;) {
    const ActionModelJoined& model = *as_joined(*problem_, t);
    VectorXd& gu = t < T ? g[t] : u_of_cluster_;
    joined_gradient(model, static_cast<const ActionDataJoined&>(*problem_->data(t)), Vx_[std::min(t + 1, T)], t == T,
                    {}, gx, gu);
    Vx_[t] = gx;
    if (t < T) add_feedback(t, gu, Vx_[t]);
  }
}

// to += K^T g, K of lq's sign
void SolverJoinedPart::add_feedback(std::size_t t, const VectorXd& g, VectorXd& to) {
  const std::vector<JoinedPart>& parts = as_joined(*problem_, t)->get_parts();
  each_cluster(t, [&](const lq::Cluster& cluster, const auto& K) {
    auto u = u_of_cluster_.head(cluster.nu);
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b)
      internal::take(g, parts[static_cast<std::size_t>(cluster.blocks[b])].u,
                     u.segment(cluster.u_start[b], lq_.nu[cluster.blocks[b]]));
    of_cluster_.head(cluster.nx).noalias() = K.transpose() * u;
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const std::vector<int>& dx = parts[static_cast<std::size_t>(cluster.blocks[b])].dx;
      for (std::size_t j = 0; j < dx.size(); ++j) to[dx[j]] += of_cluster_[cluster.x_start[b] + static_cast<Index>(j)];
    }
  });
}

// The linear-quadratic problem whose gradient by nu is g, and by x none: its solution is nu = du - K dx = -H^-1 g.
void SolverJoinedPart::preconditionFeedForward(std::vector<VectorXd>& g) {
  const std::size_t T = g.size();
  const std::vector<JoinedPart>& parts = as_joined(*problem_, T)->get_parts();
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
    for (std::size_t i = 0; i < parts.size(); ++i) {
      lq::Group& group = lq_.knots[t].groups[i];
      internal::take(g[t], parts[i].u, group.r.head(lq_.nu[i]));
      internal::take(step_, parts[i].dx, group.q);
      group.q = -group.q;
    }
  }
  const lq::Outcome outcome = direction_->solve(lq_, preconditioned_);
  const bool solved = outcome.status == lq::Status::kOk || outcome.status == lq::Status::kInaccurate;
  for (std::size_t t = 0; t < T && solved; ++t) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      internal::put(-preconditioned_.u[t].segment(layout_.u[i], lq_.nu[i]), parts[i].u, g[t]);
    add_gains_times(t, preconditioned_.x[t], g[t]);
  }
}

// to += K dx, dx by block
void SolverJoinedPart::add_gains_times(std::size_t t, const VectorXd& dx, VectorXd& to) {
  const std::vector<JoinedPart>& parts = as_joined(*problem_, t)->get_parts();
  each_cluster(t, [&](const lq::Cluster& cluster, const auto& K) {
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const int i = cluster.blocks[b];
      of_cluster_.segment(cluster.x_start[b], lq_.nx[i]) = dx.segment(layout_.x[i], lq_.nx[i]);
    }
    auto u = u_of_cluster_.head(cluster.nu);
    u.noalias() = K * of_cluster_.head(cluster.nx);
    for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
      const std::vector<int>& own = parts[static_cast<std::size_t>(cluster.blocks[b])].u;
      for (std::size_t j = 0; j < own.size(); ++j) to[own[j]] += u[cluster.u_start[b] + static_cast<Index>(j)];
    }
  });
}

std::vector<SolverJoinedPart::Gains> SolverJoinedPart::gains(std::size_t t) const {
  std::vector<Gains> out;
  if (outcome_.status != lq::Status::kOk || k_[t].size() == 0) return out;
  const std::vector<JoinedPart>& parts = as_joined(*problem_, t)->get_parts();
  const std::vector<lq::Cluster>& clusters = policies_->plan()[t];
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const Eigen::MatrixXd& K = policies_->policy(static_cast<int>(t), static_cast<int>(c)).K;
    if (K.rows() < clusters[c].nu) return {};
    out.push_back({{}, {}, -K.topRows(clusters[c].nu)});
    for (const int b : clusters[c].blocks) {  // x_start and u_start: one after the other
      const JoinedPart& part = parts[static_cast<std::size_t>(b)];
      out.back().dx.insert(out.back().dx.end(), part.dx.begin(), part.dx.end());
      out.back().u.insert(out.back().u.end(), part.u.begin(), part.u.end());
    }
  }
  return out;
}

std::vector<int> SolverJoinedPart::blocks() const {
  std::vector<int> out;
  for (const lq::Cluster& cluster : policies_->plan()[0]) out.push_back(cluster.nv);
  return out;
}

namespace {

[[noreturn]] void refuse_pass() {
  throw std::logic_error("SolverJoinedPart: robots that hold each other have no value function of their own");
}

}  // namespace

void SolverJoinedPart::computeActionValueFunction(std::size_t, const std::shared_ptr<ActionModelAbstract>&,
                                                  const std::shared_ptr<ActionDataAbstract>&) {
  refuse_pass();
}
void SolverJoinedPart::computeValueFunction(std::size_t, const std::shared_ptr<ActionModelAbstract>&) { refuse_pass(); }
void SolverJoinedPart::computeGains(std::size_t) { refuse_pass(); }

}  // namespace manycontact
