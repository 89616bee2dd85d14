#include <typeinfo>

#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

Eigen::VectorXd zeros(std::size_t n) { return Eigen::VectorXd::Zero(n); }

// Adds a block for a row r = x_i + const. or r = u_i + const.
void add_coordinate(int row, const std::vector<int>& xcols, const std::vector<int>& ucols, ResidualDataAbstract& data) {
  ResidualBlock& block = data.blocks.emplace_back(std::vector<int>{row}, xcols, ucols);
  block.Rx.setOnes();
  block.Ru.setOnes();
  block.constant = true;
}

// Returns the state if its class is StateMultibody, else null, because derived classes may have other differences.
const StateMultibody* exact_multibody(const StateAbstract& state) {
  return typeid(state) == typeid(StateMultibody) ? static_cast<const StateMultibody*>(&state) : nullptr;
}

std::size_t nu_of(const std::shared_ptr<ActuationModelAbstract>& actuation, std::size_t nu) {
  if (nu != kDefaultNu) return nu;
  return actuation ? actuation->get_nu() : 0;
}

}  // namespace

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref,
                                       std::size_t nu)
    : ResidualWithReference(xref, "ResidualModelState", state, internal::given(state).get_ndx(), nu,
                            Dependence{.q = true, .v = true}) {
  check_size(name_, "the reference", xref.size(), state_->get_nx());
}

ResidualModelState::ResidualModelState(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelState(state, internal::given(state).zero(), nu) {}

// Makes for each joint one block for its q, and then one block for each of its velocity coordinates.
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
        add_coordinate(first, dofs, {}, data);
      else
        data.blocks.emplace_back(dofs, dofs, std::vector<int>{});
      for (int i = nv + first; i < nv + first + joint.nv(); ++i) add_coordinate(i, {i}, {}, data);
    }
}

void ResidualModelState::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef&) const {
  auto block = data.blocks.begin();
  const auto* multibody = exact_multibody(*state_);
  if (!multibody) {
    block->Rx = state_->Jdiff_Js(reference_, x, second)[0];
    return;
  }
  for (const Robot& robot : multibody->get_model()->scene().robots)
    for (const Joint& joint : robot.model->joints) {
      if (joint.nv() > 1) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> J(joint.nv(), joint.nv());
        joint_difference_derivative(joint, data.r.segment(robot.idx_v + joint.idx_v, joint.nv()), false, J);
        block->Rx = J;
      }
      block += 1 + joint.nv();
    }
}

void ControlResidual::lay_out(ResidualDataAbstract& data) const {
  data.blocks.clear();
  data.blocks.reserve(nu_);
  for (int i = 0; i < static_cast<int>(nu_); ++i) add_coordinate(i, {}, {i}, data);
}

ResidualModelControl::ResidualModelControl(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelControl(state, zeros(internal::nu_or_default(state, nu))) {}

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation,
                                                   const Eigen::VectorXd& uref, std::size_t nu, bool)
    : ControlResidual("ResidualModelJointEffort", std::move(state), uref, nu_of(actuation, nu)) {
  require(actuation != nullptr, name_, "the actuation is a null pointer, a model is expected");
  require(nu_ == actuation->get_nu(), name_,
          "nu is " + std::to_string(nu_) + ", the actuation's nu = " + std::to_string(actuation->get_nu()) +
              " is expected");
  check_size(name_, "the reference", uref.size(), nr_);
}

ResidualModelJointEffort::ResidualModelJointEffort(std::shared_ptr<StateAbstract> state,
                                                   std::shared_ptr<ActuationModelAbstract> actuation, std::size_t nu)
    : ResidualModelJointEffort(std::move(state), actuation, zeros(nu_of(actuation, nu)), nu) {}

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state,
                                                               const Eigen::VectorXd& aref, std::size_t nu)
    : ResidualWithReference(aref, "ResidualModelJointAcceleration", state, internal::given(state).get_nv(), nu,
                            Dependence{.acceleration = true}) {
  check_size(name_, "the reference", aref.size(), nr_);
}

ResidualModelJointAcceleration::ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : ResidualModelJointAcceleration(state, zeros(internal::given(state).get_nv()), nu) {}

void ResidualModelJointAcceleration::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                              const ConstVectorRef&) const {
  data.r = data.shared->solution.a - reference_;
}

void ResidualModelJointAcceleration::lay_out(ResidualDataAbstract& data) const {
  internal::expect_dynamics("ResidualModelJointAcceleration", data.shared);
  data.blocks.clear();
  for (const IslandColumns& island : data.shared->islands) data.blocks.emplace_back(island.v, island.x, island.u);
}

void ResidualModelJointAcceleration::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                                 const ConstVectorRef&) const {
  for (std::size_t i = 0; i < data.blocks.size(); ++i) {
    ResidualBlock& block = data.blocks[i];
    const PanelView panel = data.shared->panel(i);
    block.Rx = panel.topLeftCorner(block.Rx.rows(), block.Rx.cols());
    block.Ru = panel.block(0, block.Rx.cols(), block.Ru.rows(), block.Ru.cols());
  }
}

}  // namespace manycontact
