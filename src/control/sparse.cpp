#include "manycontact/control/sparse.hpp"

#include <algorithm>

#include "manycontact/control/joined_solver.hpp"
#include "nodes.hpp"

namespace manycontact {

using Eigen::VectorXd;

SolverSparse::SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits)
    : SolverFDDP(std::move(problem), WithoutMatrices{}), limits_(limits) {
  SolverSparse::allocateData();
  if (limits_) th_stop_ = 5e-5;  // as SolverBoxFDDP
}

std::unique_ptr<SolverSparsePart> SolverSparse::solver_of(ShootingPart part) const {
  const bool joined = SolverJoinedPart::serves(*part.problem);
  if (joined && !limits_) return std::make_unique<SolverJoinedPart>(std::move(part));
  require(!joined || part.problem->get_terminalData()->Fx.size() > 0, "SolverSparse",
          "limits of robots that hold each other by nodes of storage kSparse, kDense is expected");
  if (limits_) return std::make_unique<SolverWithBox<SolverSparsePart>>(std::move(part));
  return std::unique_ptr<SolverSparsePart>(new SolverSparsePart(std::move(part)));
}

template <class Work>
void SolverSparse::each_part(Work&& work) {
  internal::each_node(problem_->get_nthreads(), parts_.size(), [&](std::size_t i) { work(*parts_[i]); });
}

// Where nodes were replaced, as in a receding horizon, parts of the same coordinates follow with their memory; those
// that are joined by bonds are made anew.
void SolverSparse::allocateData() {
  if (nodes_ == problem_->get_runningDatas() && terminal_ == problem_->get_terminalData()) return;
  const std::size_t T = problem_->get_T();
  xs_try_.resize(T + 1);
  us_try_.resize(T);
  for (std::size_t t = 0; t <= T; ++t) xs_try_[t].setZero(static_cast<Eigen::Index>(problem_->get_nx()));
  Vx_.assign(T + 1, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_->get_ndx())));
  k_.resize(T);
  for (std::size_t t = 0; t < T; ++t) {
    us_try_[t].setZero(static_cast<Eigen::Index>(problem_->get_runningModels()[t]->get_nu()));
    k_[t] = us_try_[t];
  }
  nodes_.clear();  // until all have followed
  std::vector<ShootingPart> parts = separate(*problem_);
  const auto follows = [](const SolverSparsePart& own, const ShootingPart& part) {
    return own.part_.x == part.x && own.part_.dx == part.dx && !dynamic_cast<const SolverJoinedPart*>(&own) &&
           !SolverJoinedPart::serves(*part.problem);
  };
  if (parts_.size() != parts.size()) parts_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].problem->set_nthreads(1);
    if (i >= parts_.size()) {
      parts_.push_back(solver_of(std::move(parts[i])));
    } else if (follows(*parts_[i], parts[i])) {
      parts_[i]->problem_ = parts[i].problem;
      parts_[i]->part_ = std::move(parts[i]);
      parts_[i]->resizeData();
    } else {
      parts_[i] = solver_of(std::move(parts[i]));
    }
    parts_[i]->feed_forward_ = parts_[i]->us_;
    parts_[i]->set_scale(scale_);
  }
  nodes_ = problem_->get_runningDatas();
  terminal_ = problem_->get_terminalData();
}

void SolverSparse::adoptScale() {
  for (const auto& own : parts_) own->set_scale(scale_);
}

double SolverSparse::calcDiff() {
  SolverFDDP::calcDiff();
  share_candidate();
  return cost_;
}

// x0, xs, us and gaps.
void SolverSparse::share_candidate() {
  each_part([this](SolverSparsePart& own) {
    const ShootingPart& part = own.part_;
    gather(problem_->get_x0(), part.x, own.xnext_);
    part.problem->set_x0(own.xnext_);
    for (std::size_t t = 0; t < xs_.size(); ++t) {
      gather(xs_[t], part.x, own.xs_[t]);
      gather(fs_[t], part.dx, own.fs_[t]);
      if (t < us_.size()) gather(us_[t], part.u[t], own.us_[t]);
    }
  });
}

void SolverSparse::backwardPass() {
  each_part([this](SolverSparsePart& own) {
    own.preg_ = preg_;
    own.dreg_ = dreg_;
    own.is_feasible_ = is_feasible_;
    own.backwardPass();
    for (std::size_t t = 0; t < Vx_.size(); ++t) {
      scatter(own.Vx_[t], own.part_.dx, Vx_[t]);
      if (t < k_.size()) scatter(own.k_[t], own.part_.u[t], k_[t]);
    }
  });
  sound_ = std::all_of(parts_.begin(), parts_.end(), [](const auto& own) { return own->sound_; });
}

void SolverSparse::forwardPass(double steplength) {
  each_part([=](SolverSparsePart& own) { own.forwardPass(steplength); });
  cost_try_ = 0;
  for (const auto& own : parts_) cost_try_ += own->cost_try_;  // NaN where one is
  if (raiseIfNaN(cost_try_)) cost_try_ = std::numeric_limits<double>::quiet_NaN();
  each_part([this](SolverSparsePart& own) {  // no two write the same number
    for (std::size_t t = 0; t < xs_try_.size(); ++t) {
      scatter(own.xs_try_[t], own.part_.x, xs_try_[t]);
      if (t < us_try_.size()) scatter(own.us_try_[t], own.part_.u[t], us_try_[t]);
    }
  });
}

void SolverSparse::prepareImprovement() {
  each_part([](SolverSparsePart& own) { own.prepareImprovement(); });
  dg_ = dq_ = 0;
  for (const auto& own : parts_) {
    dg_ += own->dg_;
    dq_ += own->dq_;
  }
}

const Eigen::Vector2d& SolverSparse::expectedImprovement() {
  each_part([](SolverSparsePart& own) { own.expectedImprovement(); });
  d_.setZero();
  for (const auto& own : parts_) d_ += own->d_;
  return d_;
}

double SolverSparse::expectedReduction() const {
  double out = 0;
  for (const auto& own : parts_) out += own->expectedReduction();
  return out;
}

// Work on each part's share of the vectors, which is put back.
template <class Work>
void SolverSparse::each_feed_forward(std::vector<VectorXd>& whole, Work&& work) {
  whole.resize(us_.size());
  for (std::size_t t = 0; t < us_.size(); ++t) whole[t].resize(us_[t].size());
  each_part([&](SolverSparsePart& own) {
    for (std::size_t t = 0; t < us_.size(); ++t) gather(whole[t], own.part_.u[t], own.feed_forward_[t]);
    work(own, own.feed_forward_);
    for (std::size_t t = 0; t < us_.size(); ++t) scatter(own.feed_forward_[t], own.part_.u[t], whole[t]);
  });
}

void SolverSparse::setFeedForward(const std::vector<VectorXd>& nu) {
  share_candidate();
  SolverFDDP::setFeedForward(nu);
  each_part([&](SolverSparsePart& own) {
    for (std::size_t t = 0; t < us_.size(); ++t) gather(nu[t], own.part_.u[t], own.feed_forward_[t]);
    own.setFeedForward(own.feed_forward_);
  });
}

void SolverSparse::computeFeedForwardGradient(std::vector<VectorXd>& g) {
  each_feed_forward(g, [this](SolverSparsePart& own, std::vector<VectorXd>& own_g) {
    for (std::size_t t = 0; t < us_.size(); ++t) gather(us_try_[t], own.part_.u[t], own.us_try_[t]);
    own.held_changed_ = false;
    own.computeFeedForwardGradient(own_g);
  });
  for (const auto& own : parts_) held_changed_ |= own->held_changed_;
}

void SolverSparse::preconditionFeedForward(std::vector<VectorXd>& g) {
  each_feed_forward(g, [](SolverSparsePart& own, auto& own_g) { own.preconditionFeedForward(own_g); });
}

void SolverSparse::holdFeedForward(std::vector<VectorXd>& nu) {
  each_feed_forward(nu, [](SolverSparsePart& own, auto& own_nu) { own.holdFeedForward(own_nu); });
}

void SolverSparse::computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>&,
                                              const std::shared_ptr<ActionDataAbstract>&) {
  require(t < problem_->get_T(), "SolverSparse::computeActionValueFunction", "there is no such node");
  each_part([=](SolverSparsePart& own) {
    own.computeActionValueFunction(t, own.problem_->get_runningModels()[t], own.problem_->get_runningDatas()[t]);
  });
}
void SolverSparse::computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>&) {
  require(t < problem_->get_T(), "SolverSparse::computeValueFunction", "there is no such node");
  each_part([=](SolverSparsePart& own) { own.computeValueFunction(t, own.problem_->get_runningModels()[t]); });
}
void SolverSparse::computeGains(std::size_t t) {
  require(t < problem_->get_T(), "SolverSparse::computeGains", "there is no such node");
  each_part([=](SolverSparsePart& own) { own.computeGains(t); });
}

std::vector<int> SolverSparsePart::blocks() const {
  std::size_t nu = 0;
  for (const auto& model : problem_->get_runningModels()) nu = std::max(nu, model->get_nu());
  return {static_cast<int>(nu)};
}

std::vector<int> SolverSparse::blocks() const {
  std::vector<int> out;
  for (const auto& own : parts_) {
    const std::vector<int> of_part = own->blocks();
    out.insert(out.end(), of_part.begin(), of_part.end());
  }
  return out;
}

std::string SolverSparse::direction() const {
  std::string out;
  for (const auto& own : parts_)
    if (out.find(own->direction()) == std::string::npos)
      out += (out.empty() ? "" : ", ") + std::string(own->direction());
  return out;
}

}  // namespace manycontact
