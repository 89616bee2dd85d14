// Pinocchio: constraintDynamics (one or three proximal iterations), its derivatives, constrainedABA, robot algorithms.

#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
// Constrained algorithms need the headers above.
#include <pinocchio/algorithm/constrained-dynamics-derivatives.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/pv.hpp>
// Algorithms without constraints:
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "bodies.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "pinocchio_model.hpp"
#include "program.hpp"

namespace manycontact::bench {

namespace {

using Constraints = PINOCCHIO_STD_VECTOR_WITH_EIGEN_ALLOCATOR(pin::RigidConstraintModel);
using ConstraintDatas = PINOCCHIO_STD_VECTOR_WITH_EIGEN_ALLOCATOR(pin::RigidConstraintData);

Constraints constraints_of(const Posed& s, const pin::Model& model) {
  Constraints all;
  for (const Hold& h : holds_of(s, bodies_of(s)))
    all.emplace_back(h.point ? pin::CONTACT_3D : pin::CONTACT_6D, model, h.a + 1, place(h.in_a), h.b + 1, place(h.in_b),
                     pin::LOCAL);
  return all;
}

const pin::ProximalSettings kIterated(1e-12, 1e-6, 3);  // further iterations do not change the digits of our scenes

// Returns Pinocchio's default for independent contacts, no damping, and a mu of 1e-6 for others.
pin::ProximalSettings one_iteration(const Posed& s) {
  SceneData data(s.scene);
  const bool dependent = solve(s.scene, s.q, s.v, s.u, data).status != Status::kOk;
  return {1e-12, dependent ? 1e-6 : 0, 1};
}

// "constraintDynamics:MU:ITERATIONS" makes exactly these iterations, whatever their residual.
pin::ProximalSettings dialled(const std::string& words, const pin::ProximalSettings& usual) {
  const Task task = task_of(words);
  if (task.dials.size() != 2) return usual;
  return {0, task.dials[0], static_cast<int>(task.dials[1])};
}

struct Common : Loaded {
  explicit Common(const Posed& s)
      : model(model_of(s)), data(model), constraints(constraints_of(s, model)), q(s.q), v(s.v), tau(s.v) {
    tau.setZero();
    for (const Robot& r : s.scene.robots)
      tau.segment(r.idx_v + r.model->first_actuated(), r.model->nu()) = s.u.segment(r.idx_u, r.model->nu());
    for (const auto& c : constraints) constraint_datas.emplace_back(c);
  }
  Eigen::VectorXd accelerations() override { return data.ddq; }

  pin::Model model;
  pin::Data data;
  Constraints constraints;
  ConstraintDatas constraint_datas;
  Eigen::VectorXd q, v, tau;
};

struct ConstraintDynamics : Common {
  ConstraintDynamics(const Posed& s, const pin::ProximalSettings& given) : Common(s), settings(given) {
    pin::initConstraintDynamics(model, data, constraints);
    ConstraintDynamics::run();
  }
  void run() override { pin::constraintDynamics(model, data, q, v, tau, constraints, constraint_datas, settings); }
  pin::ProximalSettings settings;
};

struct Derivatives : ConstraintDynamics {
  using ConstraintDynamics::ConstraintDynamics;
  void run() override {
    pin::computeConstraintDynamicsDerivatives(model, data, constraints, constraint_datas, settings);
  }
};

struct ConstrainedAba : Common {
  ConstrainedAba(const Posed& s, const std::string& words) : Common(s), settings(dialled(words, {1e-12, 1e-6, 5})) {
    pin::initPvSolver(model, data, constraints);
  }
  void run() override { pin::constrainedABA(model, data, q, v, tau, constraints, constraint_datas, settings); }
  pin::ProximalSettings settings;
};

struct Bodies : Common {
  Bodies(const Posed& s, std::string algorithm)
      : Common(s), task(std::move(algorithm)), a(2 * s.v), J(pin::Data::Matrix6x::Zero(6, model.nv)) {}
  void run() override {
    if (task == "rnea") pin::rnea(model, data, q, v, a);
    if (task == "aba") pin::aba(model, data, q, v, a);
    if (task == "crba") pin::crba(model, data, q);  // fills one triangle
    if (task == "frame_jacobian") pin::computeFrameJacobian(model, data, q, model.getFrameId("held"), pin::LOCAL, J);
  }
  Eigen::VectorXd accelerations() override { return {}; }
  std::string task;
  Eigen::VectorXd a;  // accelerations or torques
  pin::Data::Matrix6x J;
};

std::string refuses(const Posed& s, const std::string& task) {
  const double nv = s.scene.nv;
  if (5 * 8 * nv * nv * nv > 4e9) return "its data would take more than 4 GB";
  if (task == "constrainedABA")
    for (const Contact& c : s.scene.contacts)
      if (c.B.robot >= 0) return "it has no contacts between bodies";
  return strange(s);
}

std::unique_ptr<Loaded> load(const Posed& s, const std::string& task) {
  const std::string name = task_of(task).name;
  if (name == "constrainedABA") return std::make_unique<ConstrainedAba>(s, task);
  if (name == "constraintDynamics") return std::make_unique<ConstraintDynamics>(s, dialled(task, one_iteration(s)));
  if (name == "constraintDynamics iterated") return std::make_unique<ConstraintDynamics>(s, kIterated);
  if (name == "derivatives") {
    const pin::ProximalSettings once = one_iteration(s);
    return std::make_unique<Derivatives>(s, once.mu > 0 ? kIterated : once);
  }
  return std::make_unique<Bodies>(s, task);
}

}  // namespace

const Program& program() {
  static const Program p{"Pinocchio",
                         PINOCCHIO_VERSION,
                         {"constraintDynamics", "constraintDynamics iterated", "derivatives", "constrainedABA"},
                         {"rnea", "aba", "crba", "frame_jacobian"},
                         refuses,
                         load};
  return p;
}

}  // namespace manycontact::bench
