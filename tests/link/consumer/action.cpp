#include <iostream>

#include "manycontact/action.hpp"
#include "manycontact/analysis/load_scene.hpp"

using namespace manycontact;
using std::make_shared;

int main(int, char** argv) {
  const SceneFile file = load_scene(argv[1]);  // one humanoid on both soles
  const auto state = make_shared<StateMultibody>(file.scene);
  const auto actuation = make_shared<ActuationModelFloatingBase>(state);
  const std::size_t nu = actuation->get_nu();
  Eigen::VectorXd x(state->get_nx());
  x << file.q, Eigen::VectorXd::Zero(state->get_nv());

  const auto contacts = make_shared<ContactModelMultiple>(state, nu);
  const auto constraints = make_shared<ConstraintModelManager>(state, nu);
  const WrenchCone cone(Eigen::Matrix3d::Identity(), 0.7, {0.2, 0.08});
  for (const std::string side : {"left", "right"}) {
    const FrameIndex sole = state->get_pinocchio()->getFrameId(side + "_sole");
    const SE3<double> pref = file.scene.contacts[file.scene.contact_index.at(side)].B.placement;
    contacts->addContact(side, make_shared<ContactModel6D>(state, sole, pref, LOCAL_WORLD_ALIGNED, nu,
                                                           Eigen::Vector2d(0, 50)));
    const auto wrench = make_shared<ResidualModelContactWrenchCone>(state, sole, cone, nu);
    constraints->addConstraint(side, make_shared<ConstraintModelResidual>(state, wrench, cone.get_lb(), cone.get_ub()));
  }

  const auto costs = make_shared<CostModelSum>(state, nu);
  const auto add = [&](const char* name, std::shared_ptr<ResidualModelAbstract> residual, double weight) {
    costs->addCost(name, make_shared<CostModelResidual>(state, residual), weight);
  };
  add("state", make_shared<ResidualModelState>(state, x, nu), 1);
  add("control", make_shared<ResidualModelControl>(state, nu), 1e-3);
  add("com", make_shared<ResidualModelCoMPosition>(state, Eigen::Vector3d(0, 0, 0.7), nu), 100);

  DifferentialActionModelContactFwdDynamics model(state, actuation, contacts, costs, constraints);
  const auto data = model.createData();
  const Eigen::VectorXd u = model.quasiStatic_x(data, x);
  model.calc(data, x, u);
  model.calcDiff(data, x, u);

  const bool holds = (data->g.array() >= model.get_g_lb().array() - 1e-9).all() &&
                     (data->g.array() <= model.get_g_ub().array() + 1e-9).all();
  std::cout << model << "\ncost " << data->cost << ", largest torque " << u.cwiseAbs().maxCoeff() << " N m\n"
            << "stands still: " << (data->xout.norm() < 1e-6 ? "yes" : "no") << "\n"
            << "feet neither slip nor tip: " << (holds ? "yes" : "no") << "\n"
            << "|Fx| = " << data->Fx.norm() << ", |Fu| = " << data->Fu.norm() << ", |Gu| = " << data->Gu.norm() << "\n";
}
