#include <ostream>
#include <typeinfo>

#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "residual_parts.hpp"

namespace manycontact {

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref,
                                       std::size_t nu)
    : ResidualModelAbstract(state, internal::given(state).get_ndx(), nu, {.q = true, .v = true}) {
  set_reference(xref);
}

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref)
    : ResidualModelState(state, xref, internal::given(state).get_nv()) {}

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelState(state, internal::given(state).zero(), nu) {}

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state)
    : ResidualModelState(state, internal::given(state).get_nv()) {}

void ResidualModelState::set_reference(const Eigen::VectorXd& reference) {
  check_size("ResidualModelState", "the reference", reference.size(), state_->get_nx());
  xref_ = reference;
}

void ResidualModelState::calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                              const ConstVectorRef&) {
  state_->diff(xref_, x, data->r);
}

namespace {

// The state where its differences are known joint by joint; a class that a user derived may have others.
const StateMultibody* exact_multibody(const StateAbstract& state) {
  return typeid(state) == typeid(StateMultibody) ? static_cast<const StateMultibody*>(&state) : nullptr;
}

}  // namespace

// A block for the q of each joint, then one for each coordinate of its v.
void ResidualModelState::lay_out(ResidualDataAbstract& data) const {
  const auto* multibody = exact_multibody(*state_);
  if (!multibody) return ResidualModelAbstract::lay_out(data);
  const int nv = static_cast<int>(state_->get_nv());
  data.blocks.clear();
  for (const Robot& robot : multibody->get_model()->scene().robots)
    for (const Joint& joint : robot.model->joints) {
      const int first = robot.idx_v + joint.idx_v;
      const std::vector<int> dofs = internal::range(first, joint.nv());
      if (joint.nv() == 1)
        internal::add_coordinate(first, dofs, {}, data);
      else
        data.blocks.emplace_back(dofs, dofs, std::vector<int>{});
      for (int i = nv + first; i < nv + first + joint.nv(); ++i) internal::add_coordinate(i, {i}, {}, data);
    }
}

void ResidualModelState::differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                                       const ConstVectorRef&) {
  auto block = data->blocks.begin();
  const auto* multibody = exact_multibody(*state_);
  if (!multibody) {
    block->Rx = state_->Jdiff_Js(xref_, x, second)[0];
    return;
  }
  for (const Robot& robot : multibody->get_model()->scene().robots)
    for (const Joint& joint : robot.model->joints) {
      if (joint.nv() > 1) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> J(joint.nv(), joint.nv());
        joint_difference_derivative(joint, data->r.segment(robot.idx_v + joint.idx_v, joint.nv()), false, J);
        block->Rx = J;
      }
      block += 1 + joint.nv();
    }
}

void ResidualModelState::print(std::ostream& os) const { os << "ResidualModelState"; }

ResidualModelControl::ResidualModelControl(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& uref)
    : ResidualModelAbstract(std::move(state), uref.size(), uref.size(), {.u = true}), uref_(uref) {}

ResidualModelControl::ResidualModelControl(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelControl(std::move(state), Eigen::VectorXd(Eigen::VectorXd::Zero(nu))) {}

ResidualModelControl::ResidualModelControl(std::shared_ptr<StateAbstract> state)
    : ResidualModelControl(state, internal::given(state).get_nv()) {}

void ResidualModelControl::set_reference(const Eigen::VectorXd& reference) {
  check_size("ResidualModelControl", "the reference", reference.size(), nr_);
  uref_ = reference;
}

void ResidualModelControl::calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef&,
                                const ConstVectorRef& u) {
  data->r = u - uref_;
}

void ResidualModelControl::lay_out(ResidualDataAbstract& data) const { internal::lay_out_controls(nu_, data); }

void ResidualModelControl::differentiate(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&,
                                         const ConstVectorRef&) {}

void ResidualModelControl::print(std::ostream& os) const { os << "ResidualModelControl"; }

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation,
                                                   const Eigen::VectorXd& uref, std::size_t nu, bool)
    : ResidualModelAbstract(std::move(state), nu, nu, {.u = true}) {
  require(actuation != nullptr, "ResidualModelJointEffort", "the actuation is a null pointer, a model is expected");
  require(nu == actuation->get_nu(), "ResidualModelJointEffort",
          "nu is " + std::to_string(nu) + ", the actuation's " + std::to_string(actuation->get_nu()) + " expected");
  set_reference(uref);
}

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation,
                                                   const Eigen::VectorXd& uref)
    : ResidualModelJointEffort(std::move(state), actuation, uref, actuation ? actuation->get_nu() : 0) {}

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation, std::size_t nu)
    : ResidualModelJointEffort(std::move(state), std::move(actuation), Eigen::VectorXd(Eigen::VectorXd::Zero(nu)), nu) {
}

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation)
    : ResidualModelJointEffort(std::move(state), actuation, actuation ? actuation->get_nu() : 0) {}

void ResidualModelJointEffort::set_reference(const Eigen::VectorXd& reference) {
  check_size("ResidualModelJointEffort", "the reference", reference.size(), nr_);
  uref_ = reference;
}

void ResidualModelJointEffort::calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef&,
                                    const ConstVectorRef& u) {
  data->r = u - uref_;
}

void ResidualModelJointEffort::lay_out(ResidualDataAbstract& data) const { internal::lay_out_controls(nu_, data); }

void ResidualModelJointEffort::differentiate(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&,
                                             const ConstVectorRef&) {}

void ResidualModelJointEffort::print(std::ostream& os) const { os << "ResidualModelJointEffort"; }

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state,
                                                               const Eigen::VectorXd& aref, std::size_t nu)
    : ResidualModelAbstract(state, internal::given(state).get_nv(), nu, {.acceleration = true}) {
  set_reference(aref);
}

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state,
                                                               const Eigen::VectorXd& aref)
    : ResidualModelJointAcceleration(state, aref, internal::given(state).get_nv()) {}

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelJointAcceleration(state, Eigen::VectorXd(Eigen::VectorXd::Zero(internal::given(state).get_nv())),
                                     nu) {}

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state)
    : ResidualModelJointAcceleration(state, internal::given(state).get_nv()) {}

void ResidualModelJointAcceleration::set_reference(const Eigen::VectorXd& reference) {
  check_size("ResidualModelJointAcceleration", "the reference", reference.size(), nr_);
  aref_ = reference;
}

void ResidualModelJointAcceleration::calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef&,
                                          const ConstVectorRef&) {
  data->r = data->shared->solution.a - aref_;
}

void ResidualModelJointAcceleration::lay_out(ResidualDataAbstract& data) const {
  internal::expect_dynamics("ResidualModelJointAcceleration", data.shared);
  data.blocks.clear();
  for (const IslandColumns& island : data.shared->islands) data.blocks.emplace_back(island.v, island.x, island.u);
}

void ResidualModelJointAcceleration::differentiate(const std::shared_ptr<ResidualDataAbstract>& data,
                                                   const ConstVectorRef&, const ConstVectorRef&) {
  for (std::size_t i = 0; i < data->blocks.size(); ++i) {
    ResidualBlock& block = data->blocks[i];
    const PanelView panel = data->shared->panel(i);
    block.Rx = panel.topLeftCorner(block.Rx.rows(), block.Rx.cols());
    block.Ru = panel.block(0, block.Rx.cols(), block.Ru.rows(), block.Ru.cols());
  }
}

void ResidualModelJointAcceleration::print(std::ostream& os) const { os << "ResidualModelJointAcceleration"; }

}  // namespace manycontact
