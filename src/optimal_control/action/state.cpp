#include "manycontact/action/state.hpp"

#include <cmath>
#include <random>

#include "assign.hpp"
#include "manycontact/algorithm/integrate.hpp"

namespace manycontact {

namespace {

// Calls use(joint, first index in q, first index in v) for every joint of every robot.
template <class Use>
void each_joint(const Scene& scene, Use&& use) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) use(joint, robot.idx_q + joint.idx_q, robot.idx_v + joint.idx_v);
}

template <int n, class Rows>
void transport(const Eigen::Matrix<double, n, n>& J, Rows&& rows) {
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    const Eigen::Matrix<double, n, 1> column = rows.col(j);
    rows.col(j).noalias() = J * column;
  }
}

std::vector<Eigen::MatrixXd> chosen(Eigen::MatrixXd& J1, Eigen::MatrixXd& J2, Jcomponent which) {
  if (which == first) return {std::move(J1)};
  if (which == second) return {std::move(J2)};
  return {std::move(J1), std::move(J2)};
}

}  // namespace

bool same_space(const StateAbstract& a, const StateAbstract& b) {
  if (&a == &b) return true;
  const auto* one = dynamic_cast<const StateMultibody*>(&a);
  const auto* other = dynamic_cast<const StateMultibody*>(&b);
  return one && other && one->get_model() == other->get_model();
}

StateAbstract::StateAbstract(std::size_t nx, std::size_t ndx)
    : nx_(nx), ndx_(ndx), nq_(nx - ndx / 2), nv_(ndx / 2), lb_(nx), ub_(nx) {
  lb_.setConstant(-std::numeric_limits<double>::infinity());
  ub_.setConstant(std::numeric_limits<double>::infinity());
}

Eigen::VectorXd StateAbstract::diff_dx(const ConstVectorRef& x0, const ConstVectorRef& x1) const {
  Eigen::VectorXd dx(ndx_);
  diff(x0, x1, dx);
  return dx;
}

Eigen::VectorXd StateAbstract::integrate_x(const ConstVectorRef& x, const ConstVectorRef& dx) const {
  Eigen::VectorXd out(nx_);
  integrate(x, dx, out);
  return out;
}

std::vector<Eigen::MatrixXd> StateAbstract::Jdiff_Js(const ConstVectorRef& x0, const ConstVectorRef& x1,
                                                     Jcomponent which) const {
  Eigen::MatrixXd J1(ndx_, ndx_), J2(ndx_, ndx_);
  Jdiff(x0, x1, J1, J2, which);
  return chosen(J1, J2, which);
}

std::vector<Eigen::MatrixXd> StateAbstract::Jintegrate_Js(const ConstVectorRef& x, const ConstVectorRef& dx,
                                                          Jcomponent which) const {
  Eigen::MatrixXd J1(ndx_, ndx_), J2(ndx_, ndx_);
  Jintegrate(x, dx, J1, J2, which, setto);
  return chosen(J1, J2, which);
}

void StateAbstract::set_lb(const Eigen::VectorXd& lb) {
  check_size("StateAbstract::set_lb", "lb", lb.size(), nx_);
  lb_ = lb;
  update_has_limits();
}

void StateAbstract::set_ub(const Eigen::VectorXd& ub) {
  check_size("StateAbstract::set_ub", "ub", ub.size(), nx_);
  ub_ = ub;
  update_has_limits();
}

void StateAbstract::update_has_limits() { has_limits_ = lb_.array().isFinite().any() || ub_.array().isFinite().any(); }

StateMultibody::StateMultibody(std::shared_ptr<const Multibody> model)
    : StateAbstract(internal::given("StateMultibody", model)->nq + internal::given("StateMultibody", model)->nv,
                    2 * internal::given("StateMultibody", model)->nv),
      model_(std::move(model)) {
  each_joint(model_->scene(), [&](const Joint& joint, int iq, int iv) {
    const int n = joint.nv();
    if (joint.type != JointType::kFloating && joint.lower.size() == n && joint.upper.size() == n) {
      lb_.segment(iq, n) = joint.lower;
      ub_.segment(iq, n) = joint.upper;
    }
    if (joint.velocity_limit.size() == n) {
      lb_.segment(nq_ + iv, n) = -joint.velocity_limit;
      ub_.segment(nq_ + iv, n) = joint.velocity_limit;
    }
  });
  update_has_limits();
}

Eigen::VectorXd StateMultibody::zero() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(nx_);
  for (const Robot& robot : model_->scene().robots) x.segment(robot.idx_q, robot.model->nq) = neutral(*robot.model);
  return x;
}

Eigen::VectorXd StateMultibody::rand() const {
  thread_local std::mt19937 rng(1);
  const auto draw = [](double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); };
  Eigen::VectorXd x(nx_);
  each_joint(model_->scene(), [&](const Joint& joint, int iq, int iv) {
    const bool floating = joint.type == JointType::kFloating;
    for (int i = 0; i < (floating ? 3 : joint.nv()); ++i) {
      const double reach =
          joint.type == JointType::kRevolute || (joint.type == JointType::kPlanar && i == 2) ? M_PI : 1;
      const double low = lb_[iq + i], high = ub_[iq + i];
      x[iq + i] = std::isfinite(low) && std::isfinite(high) ? draw(low, high) : draw(-reach, reach);
    }
    if (floating) {
      Eigen::Vector4d quat;
      // Points that are uniform in the ball have directions that are uniform on the sphere.
      do quat = Eigen::Vector4d(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1));
      while (quat.norm() < 0.1 || quat.norm() > 1);
      x.segment<4>(iq + 3) = quat.normalized();
    }
    for (int i = 0; i < joint.nv(); ++i) x[nq_ + iv + i] = draw(-1, 1);
  });
  return x;
}

void StateMultibody::diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dx) const {
  check_size("StateMultibody::diff", "x0", x0.size(), nx_);
  check_size("StateMultibody::diff", "x1", x1.size(), nx_);
  check_size("StateMultibody::diff", "dxout", dx.size(), ndx_);
  for (const Robot& robot : model_->scene().robots) {
    const Model& m = *robot.model;
    difference<double>(m, x0.segment(robot.idx_q, m.nq), x1.segment(robot.idx_q, m.nq), dx.segment(robot.idx_v, m.nv));
  }
  dx.tail(nv_) = x1.tail(nv_) - x0.tail(nv_);
}

void StateMultibody::integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef out) const {
  check_size("StateMultibody::integrate", "x", x.size(), nx_);
  check_size("StateMultibody::integrate", "dx", dx.size(), ndx_);
  check_size("StateMultibody::integrate", "xout", out.size(), nx_);
  for (const Robot& robot : model_->scene().robots) {
    const Model& m = *robot.model;
    manycontact::integrate<double>(m, x.segment(robot.idx_q, m.nq), dx.segment(robot.idx_v, m.nv),
                                   out.segment(robot.idx_q, m.nq));
  }
  out.tail(nv_) = x.tail(nv_) + dx.tail(nv_);
}

void StateMultibody::Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
                           Jcomponent which) const {
  Eigen::VectorXd dx(ndx_);
  StateMultibody::diff(x0, x1, dx);  // the diff of this class, even if a derived class overrides it
  const auto fill = [&](bool of_x0, MatrixRef J) {
    check_size("StateMultibody::Jdiff", of_x0 ? "Jfirst" : "Jsecond", J.size(), ndx_ * ndx_);
    J.setZero();
    J.bottomRightCorner(nv_, nv_).diagonal().setConstant(of_x0 ? -1 : 1);
    each_joint(model_->scene(), [&](const Joint& joint, int, int iv) {
      const int n = joint.nv();
      joint_difference_derivative(joint, dx.segment(iv, n), of_x0, J.block(iv, iv, n, n));
    });
  };
  if (which != second) fill(true, Jfirst);
  if (which != first) fill(false, Jsecond);
}

void StateMultibody::Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                                Jcomponent which, AssignmentOp op) const {
  check_size("StateMultibody::Jintegrate", "x", x.size(), nx_);
  check_size("StateMultibody::Jintegrate", "dx", dx.size(), ndx_);
  const auto fill = [&](bool of_x, MatrixRef J) {
    check_size("StateMultibody::Jintegrate", of_x ? "Jfirst" : "Jsecond", J.size(), ndx_ * ndx_);
    if (op == setto) J.setZero();
    J.bottomRightCorner(nv_, nv_).diagonal().array() += op == rmfrom ? -1 : 1;
    Mat6<double> block;
    each_joint(model_->scene(), [&](const Joint& joint, int, int iv) {
      const int n = joint.nv();
      joint_integrate_derivative(joint, dx.segment(iv, n), of_x, block.topLeftCorner(n, n));
      internal::assign(J.block(iv, iv, n, n), block.topLeftCorner(n, n), op);
    });
  };
  if (which != second) fill(true, Jfirst);
  if (which != first) fill(false, Jsecond);
}

void StateMultibody::JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                                         Jcomponent which) const {
  check_size("StateMultibody::JintegrateTransport", "x", x.size(), nx_);
  check_size("StateMultibody::JintegrateTransport", "dx", dx.size(), ndx_);
  check_size("StateMultibody::JintegrateTransport", "a column of Jin", Jin.rows(), ndx_);
  require(which != both, "StateMultibody::JintegrateTransport", "firstsecond is `both`, first or second is expected");
  Mat6<double> block = Mat6<double>::Identity();
  each_joint(model_->scene(), [&](const Joint& joint, int, int iv) {
    const int n = joint.nv();
    if (n == 1) return;
    joint_integrate_derivative(joint, dx.segment(iv, n), which == first, block.topLeftCorner(n, n));
    if (n == 6)
      transport<6>(block, Jin.middleRows<6>(iv));
    else
      transport<3>(block.topLeftCorner<3, 3>(), Jin.middleRows<3>(iv));
  });
}

}  // namespace manycontact
