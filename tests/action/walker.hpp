#pragma once
// The humanoid on both soles, built as a user of Crocoddyl builds it, for tests of the interface.

#include <gtest/gtest.h>

#include "action/problem.hpp"
#include "manycontact/action.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {

using ActionModel = DifferentialActionModelContactFwdDynamics;
using DataPtr = std::shared_ptr<DifferentialActionDataAbstract>;

struct Walker : Problem {
  SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml");
  Eigen::VectorXd x_rest;  // at rest
  std::size_t nu;
  FrameIndex left, right;
  SE3<double> left_pref, right_pref;
  std::shared_ptr<ContactModel6D> left_contact, right_contact;

  explicit Walker(Actuated how = Actuated::kFloatingBase, bool with_right = true) {
    static_cast<Problem&>(*this) = make_problem(file, how);
    nu = actuation->get_nu();
    x_rest = x;
    const Multibody& model = *state->get_model();
    left = model.getFrameId("left_sole");
    right = model.getFrameId("right_sole");
    left_pref = file.scene.contacts[0].B.placement;
    right_pref = file.scene.contacts[1].B.placement;
    left_contact = std::make_shared<ContactModel6D>(state, left, left_pref, LOCAL, nu, Eigen::Vector2d(100, 20));
    right_contact = std::make_shared<ContactModel6D>(state, right, right_pref, LOCAL, nu, Eigen::Vector2d(100, 20));
    contacts = std::make_shared<ContactModelMultiple>(state, nu);
    contacts->addContact("left", left_contact);
    if (with_right) contacts->addContact("right", right_contact);
    std::mt19937 rng(8);
    x = moved(rng);
    u = random_vector(static_cast<int>(nu), rng, 5);
  }

  /// Returns a state away from rest.
  Eigen::VectorXd moved(std::mt19937& rng) const {
    Eigen::VectorXd out = state->integrate_x(x_rest, random_vector(static_cast<int>(state->get_ndx()), rng, 0.05));
    out.tail(state->get_nv()) = random_vector(static_cast<int>(state->get_nv()), rng, 0.5);
    return out;
  }

  void add_cost(const std::string& name, std::shared_ptr<ResidualModelAbstract> residual, double weight = 1) {
    costs->addCost(name, std::make_shared<CostModelResidual>(state, residual), weight);
  }
  void add_costs() {
    add_cost("state", std::make_shared<ResidualModelState>(state, x_rest, nu), 0.5);
    add_cost("control", std::make_shared<ResidualModelControl>(state, nu), 1e-3);
    add_cost("com", std::make_shared<ResidualModelCoMPosition>(state, Eigen::Vector3d(0.1, 0, 0.7), nu), 10);
    add_cost("hand", std::make_shared<ResidualModelFramePlacement>(state, state->get_model()->getFrameId("left_hand"),
                                                                   SE3<double>(), nu));
    add_cost("effort", std::make_shared<ResidualModelContactControlGrav>(state, nu), 1e-2);
  }

  /// Imposes lower <= centre of mass <= upper, one side open where they differ.
  std::shared_ptr<ConstraintModelResidual> com_within(double lower, double upper) const {
    return std::make_shared<ConstraintModelResidual>(
        state, std::make_shared<ResidualModelCoMPosition>(state, Eigen::Vector3d::Zero(), nu),
        Eigen::VectorXd::Constant(3, lower), Eigen::VectorXd::Constant(3, upper));
  }
  std::shared_ptr<ConstraintModelResidual> left_friction() const {
    const FrictionCone cone(Eigen::Matrix3d::Identity(), 0.7);
    return std::make_shared<ConstraintModelResidual>(
        state, std::make_shared<ResidualModelContactFrictionCone>(state, left, cone, nu), cone.get_lb(), cone.get_ub());
  }
};

/// Returns the data after calc and calcDiff.
inline DataPtr evaluated(ActionModel& model, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                         DataPtr data = nullptr) {
  if (!data) data = model.createData();
  model.calc(data, x, u);
  model.calcDiff(data, x, u);
  return data;
}

/// Returns the largest difference relative to 1 or the larger matrix; NaN if the shapes differ.
inline double twin_difference(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& twin) {
  if (mine.rows() != twin.rows() || mine.cols() != twin.cols()) return std::numeric_limits<double>::quiet_NaN();
  if (mine.size() == 0) return 0;
  return (mine - twin).cwiseAbs().maxCoeff() / std::max({1.0, size_of(mine), size_of(twin)});
}

/// Returns the largest relative error of the outputs of calc and calcDiff.
inline double difference_of(const DifferentialActionDataAbstract& a, const DifferentialActionDataAbstract& b) {
  double worst = std::abs(a.cost - b.cost) / std::max(1e-300, std::abs(b.cost));
  const auto take = [&](const auto& mine, const auto& truth) {
    const double e = error_of(mine, truth);
    if (!(e <= worst)) worst = e;
  };
  take(a.xout, b.xout), take(a.Fx, b.Fx), take(a.Fu, b.Fu), take(a.r, b.r);
  take(a.Lx, b.Lx), take(a.Lu, b.Lu), take(a.Lxx, b.Lxx), take(a.Lxu, b.Lxu), take(a.Luu, b.Luu);
  take(a.g, b.g), take(a.h, b.h), take(a.Gx, b.Gx), take(a.Gu, b.Gu), take(a.Hx, b.Hx), take(a.Hu, b.Hu);
  return worst;
}

inline const ContactDataAbstract& contact_data(const DataPtr& data, const std::string& name) {
  return *as_fwddyn(data).multibody->contacts->contacts.at(name);
}

}  // namespace manycontact::test
