#pragma once
// One iteration of FDDP for a robot on its contacts, in the API that Crocoddyl and manycontact share: `api` is the
// namespace of either. 20 nodes of 10 ms each have the costs |x - x_rest|^2 / 2 and 1e-3 |u|^2 / 2.

#include "program.hpp"

namespace manycontact::bench {

struct Fddp : Loaded {
  Fddp(const Posed& s, const std::shared_ptr<api::StateMultibody>& state,
       const std::shared_ptr<api::ContactModelMultiple>& contacts) {
    Eigen::VectorXd x(s.q.size() + s.v.size());
    x << s.q, 0 * s.v;
    const auto costs = std::make_shared<api::CostModelSum>(state, s.u.size());
    const auto add = [&](const std::string& name, const std::shared_ptr<api::ResidualModelAbstract>& r, double weight) {
      costs->addCost(name, std::make_shared<api::CostModelResidual>(state, r), weight);
    };
    add("state", std::make_shared<api::ResidualModelState>(state, x, s.u.size()), 1);
    add("control", std::make_shared<api::ResidualModelControl>(state, s.u.size()), 1e-3);
    const auto node = std::make_shared<api::IntegratedActionModelEuler>(
        std::make_shared<api::DifferentialActionModelContactFwdDynamics>(
            state, std::make_shared<api::ActuationModelFloatingBase>(state), contacts, costs),
        0.01);
    x << s.q, s.v;
    us.assign(20, s.u);
    xs.assign(us.size() + 1, x);
    const auto problem = std::make_shared<api::ShootingProblem>(
        x, std::vector<std::shared_ptr<api::ActionModelAbstract>>(us.size(), node), node);
    problem->set_nthreads(1);
    solver = std::make_unique<api::SolverFDDP>(problem);
  }
  void run() override { solver->solve(xs, us, 1); }

  std::vector<Eigen::VectorXd> xs, us;
  std::unique_ptr<api::SolverFDDP> solver;
};

}  // namespace manycontact::bench
