// Crocoddyl runs calc of its action model, with a robot's contacts with the world only, calcDiff after it, with
// derivatives of forces, and an iteration of FDDP. Compiles against versions with std::shared_ptr (3.1 and later).

#include <crocoddyl/core/costs/cost-sum.hpp>
#include <crocoddyl/core/utils/version.hpp>
#include <crocoddyl/core/integrator/euler.hpp>
#include <crocoddyl/core/residuals/control.hpp>
#include <crocoddyl/core/solvers/fddp.hpp>
#include <crocoddyl/multibody/actions/contact-fwddyn.hpp>
#include <crocoddyl/multibody/actuations/floating-base.hpp>
#include <crocoddyl/multibody/actuations/full.hpp>
#include <crocoddyl/multibody/contacts/contact-3d.hpp>
#include <crocoddyl/multibody/contacts/contact-6d.hpp>
#include <crocoddyl/multibody/contacts/multiple-contacts.hpp>
#include <crocoddyl/multibody/residuals/state.hpp>
#include <crocoddyl/multibody/states/multibody.hpp>

#include "manycontact/dynamics/solve.hpp"
#include "pinocchio_model.hpp"
namespace api = crocoddyl;
#include "fddp.hpp"

namespace manycontact::bench {

namespace {

using crocoddyl::StateMultibody;

// Adds the contacts as frames of the model, in their order: "hold0", "hold1", ...
std::shared_ptr<pin::Model> with_frames(const Posed& s, const std::vector<Hold>& holds) {
  auto model = std::make_shared<pin::Model>(model_of(s));
  model->names[1] = "root_joint";  // ActuationModelFloatingBase looks for it
  for (std::size_t k = 0; k < holds.size(); ++k)
    model->addFrame(pin::Frame("hold" + std::to_string(k), holds[k].a + 1, 0, place(holds[k].in_a), pin::OP_FRAME));
  return model;
}

std::shared_ptr<crocoddyl::ContactModelAbstract> contact(const std::shared_ptr<StateMultibody>& state, const Hold& hold,
                                                         std::size_t frame, std::size_t nu) {
  if (hold.point) return std::make_shared<crocoddyl::ContactModel3D>(state, frame, hold.in_b.p, pin::LOCAL, nu);
  return std::make_shared<crocoddyl::ContactModel6D>(state, frame, place(hold.in_b), pin::LOCAL, nu);
}

std::shared_ptr<StateMultibody> state_of(const Posed& s) {
  return std::make_shared<StateMultibody>(with_frames(s, holds_of(s, bodies_of(s))));
}

std::shared_ptr<crocoddyl::ContactModelMultiple> contacts_of(const Posed& s, const std::shared_ptr<StateMultibody>& state,
                                                             std::size_t nu) {
  const std::vector<Hold> holds = holds_of(s, bodies_of(s));
  const auto contacts = std::make_shared<crocoddyl::ContactModelMultiple>(state, nu);
  for (std::size_t k = 0; k < holds.size(); ++k) {
    const std::string name = "hold" + std::to_string(k);
    contacts->addContact(name, contact(state, holds[k], state->get_pinocchio()->getFrameId(name), nu));
  }
  return contacts;
}

std::shared_ptr<crocoddyl::DifferentialActionModelContactFwdDynamics> action_of(const Posed& s) {
  const auto state = state_of(s);
  const auto actuation = std::make_shared<crocoddyl::ActuationModelFull>(state);  // torques of all coordinates
  const std::size_t nu = actuation->get_nu();
  const auto contacts = contacts_of(s, state, nu);
  const auto costs = std::make_shared<crocoddyl::CostModelSum>(state, nu);
  return std::make_shared<crocoddyl::DifferentialActionModelContactFwdDynamics>(state, actuation, contacts, costs, 0.,
                                                                                true);
}

struct Calc : Loaded {
  explicit Calc(const Posed& s) : model(action_of(s)), data(model->createData()), x(s.q.size() + s.v.size()), u(s.v) {
    x << s.q, s.v;
    u.setZero();
    for (const Robot& r : s.scene.robots)
      u.segment(r.idx_v + r.model->first_actuated(), r.model->nu()) = s.u.segment(r.idx_u, r.model->nu());
    Calc::run();
  }
  void run() override { model->calc(data, x, u); }
  Eigen::VectorXd accelerations() override { return data->xout; }

  std::shared_ptr<crocoddyl::DifferentialActionModelContactFwdDynamics> model;
  std::shared_ptr<crocoddyl::DifferentialActionDataAbstract> data;
  Eigen::VectorXd x, u;
};

struct CalcDiff : Calc {
  using Calc::Calc;
  void begin() override { Calc::run(); }
  void run() override { model->calcDiff(data, x, u); }
};

std::string refuses(const Posed& s, const std::string& task) {
  if (s.scene.nv > 700) return "its matrices are dense";
  for (const Contact& c : s.scene.contacts)
    if (c.B.robot >= 0) return "it has no contacts between bodies";
  SceneData data(s.scene);
  if (solve(s.scene, s.q, s.v, s.u, data).status != Status::kOk) return "it takes no redundant contacts";
  return strange(s);
}

std::unique_ptr<Loaded> load(const Posed& s, const std::string& task) {
  if (task == "derivatives") return std::make_unique<CalcDiff>(s);
  if (task == "FDDP") {
    const auto state = state_of(s);
    return std::make_unique<Fddp>(s, state, contacts_of(s, state, s.u.size()));
  }
  return std::make_unique<Calc>(s);
}

}  // namespace

const Program& program() {
  static const Program p{"Crocoddyl", crocoddyl::printVersion(), {"calc", "derivatives"}, {"FDDP"}, refuses, load};
  return p;
}

}  // namespace manycontact::bench
