#include "manycontact/action/thrusters.hpp"

#include <Eigen/QR>
#include <cmath>
#include <ostream>

namespace manycontact {

namespace {

constexpr const char* kThrusters = "ActuationModelFloatingBaseThrusters";

std::size_t count_controls(const StateMultibody* state, std::size_t thrusters) {
  require(state, kThrusters, "a state is expected, not a null pointer");
  const Scene& scene = state->get_model()->scene();
  require(scene.nrobots() == 1 && scene.robots[0].model->floating_base, kThrusters,
          "the state of one robot with a floating base is expected");
  return thrusters + static_cast<std::size_t>(scene.robots[0].model->nu());
}

}  // namespace

std::ostream& operator<<(std::ostream& os, const Thruster& thruster) {
  return os << "Thruster {at=[" << thruster.pose.p.transpose() << "], along=[" << thruster.pose.R.col(2).transpose()
            << "], ctorque=" << thruster.ctorque << ", type=" << (thruster.type == CW ? "CW" : "CCW") << ", thrust=["
            << thruster.min_thrust << ", " << thruster.max_thrust << "]}";
}

ActuationModelFloatingBaseThrusters::ActuationModelFloatingBaseThrusters(std::shared_ptr<StateMultibody> state,
                                                                         const std::vector<Thruster>& thrusters)
    : ActuationModelAbstract(state, count_controls(state.get(), thrusters.size())), thrusters_(thrusters) {
  W_.setZero(state->get_nv(), nu_);
  auto column = static_cast<Eigen::Index>(thrusters.size());
  for (const int i : state->get_model()->scene().robots[0].model->actuated) W_(i, column++) = 1;
  set_thrusters(thrusters);
}

// Computes W_, whose columns are the wrenches of unit thrusts in the base's axes. A thruster exerts a force along its z
// axis at its position, and a torque about z.
void ActuationModelFloatingBaseThrusters::set_thrusters(const std::vector<Thruster>& thrusters) {
  check_size("ActuationModelFloatingBaseThrusters::set_thrusters", "thrusters",
             static_cast<Eigen::Index>(thrusters.size()), thrusters_.size());
  thrusters_ = thrusters;
  for (std::size_t k = 0; k < thrusters_.size(); ++k) {
    const Thruster& t = thrusters_[k];
    const Vec3<double> z = t.pose.R.col(2);
    W_.col(static_cast<Eigen::Index>(k)).head<6>() << z, t.pose.p.cross(z) + (t.type == CW ? 1 : -1) * t.ctorque * z;
  }
  Mtau_ = W_.completeOrthogonalDecomposition().pseudoInverse();
  S_ = W_ * Mtau_;
}

void ActuationModelFloatingBaseThrusters::update(ActuationDataAbstract& data) const {
  data.dtau_du = W_;
  data.Mtau = Mtau_;
  for (std::size_t k = 0; k < data.tau_set.size(); ++k)
    data.tau_set[k] = std::abs(S_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k))) >= 1e-12;
}

std::shared_ptr<ActuationDataAbstract> ActuationModelFloatingBaseThrusters::createData() {
  auto data = std::make_shared<ActuationDataAbstract>(this);
  update(*data);
  return data;
}

void ActuationModelFloatingBaseThrusters::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModelFloatingBaseThrusters::calc", x, u);
  check_data("ActuationModelFloatingBaseThrusters::calc", data).tau.noalias() = W_ * u;
}

void ActuationModelFloatingBaseThrusters::calcDiff(const DataPtr& data, const ConstVectorRef& x,
                                                   const ConstVectorRef& u) {
  check("ActuationModelFloatingBaseThrusters::calcDiff", x, u);
  update(check_data("ActuationModelFloatingBaseThrusters::calcDiff", data));
}

void ActuationModelFloatingBaseThrusters::commands(const DataPtr& data, const ConstVectorRef& x,
                                                   const ConstVectorRef& tau) {
  check_size("ActuationModelFloatingBaseThrusters::commands", "x", x.size(), state_->get_nx());
  check_size("ActuationModelFloatingBaseThrusters::commands", "tau", tau.size(), state_->get_nv());
  check_data("ActuationModelFloatingBaseThrusters::commands", data).u.noalias() = Mtau_ * tau;
}

void ActuationModelFloatingBaseThrusters::torqueTransform(const DataPtr& data, const ConstVectorRef& x,
                                                          const ConstVectorRef& u) {
  check("ActuationModelFloatingBaseThrusters::torqueTransform", x, u);
  update(check_data("ActuationModelFloatingBaseThrusters::torqueTransform", data));
}

void ActuationModelFloatingBaseThrusters::print(std::ostream& os) const {
  os << kThrusters << " {nu=" << nu_ << ", nthrusters=" << thrusters_.size();
  for (const Thruster& thruster : thrusters_) os << ", " << thruster;
  os << "}";
}

}  // namespace manycontact
