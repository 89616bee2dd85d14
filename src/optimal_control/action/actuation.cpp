#include "manycontact/action/actuation.hpp"

#include <Eigen/QR>
#include <typeinfo>

namespace manycontact {

ActuationDataAbstract::ActuationDataAbstract(const ActuationModelAbstract* model)
    : tau(Eigen::VectorXd::Zero(model->get_state()->get_nv())),
      u(Eigen::VectorXd::Zero(model->get_nu())),
      dtau_dx(model->get_state()->get_nv(), model->get_state()->get_ndx()),
      dtau_du(model->get_state()->get_nv(), model->get_nu()),
      Mtau(model->get_nu(), model->get_state()->get_nv()),
      tau_set(model->get_state()->get_nv(), true) {}

ActuationModelAbstract::ActuationModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : nu_(nu), state_(std::move(state)) {
  require(state_ != nullptr, "ActuationModelAbstract", "a state is expected, not a null pointer");
}

void ActuationModelAbstract::check(const char* where, const ConstVectorRef& x, const ConstVectorRef& u) const {
  check_size(where, "x", x.size(), state_->get_nx());
  check_size(where, "u", u.size(), nu_);
}

void ActuationModelAbstract::torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModel::torqueTransform", x, u);
  calc(data, x, u);
  calcDiff(data, x, u);
  data->Mtau = Eigen::MatrixXd(data->dtau_du).completeOrthogonalDecomposition().pseudoInverse();
}

ActuationModelSelection::ActuationModelSelection(std::shared_ptr<StateAbstract> state, std::vector<int> selection,
                                                 std::string name)
    : ActuationModelAbstract(std::move(state), selection.size()), name_(std::move(name)) {
  selection_ = std::move(selection);
}

std::shared_ptr<ActuationDataAbstract> ActuationModelSelection::createData() {
  auto data = std::make_shared<ActuationDataAbstract>(this);
  data->tau_set.assign(data->tau_set.size(), false);
  for (std::size_t k = 0; k < nu_; ++k) {
    data->dtau_du.insert(selection_[k], static_cast<int>(k)) = 1;
    data->tau_set[selection_[k]] = true;
  }
  data->dtau_du.makeCompressed();
  data->Mtau = data->dtau_du.transpose();
  return data;
}

void ActuationModelSelection::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModel::calc", x, u);
  check_data("ActuationModel::calc", data);
  data->tau.setZero();
  for (std::size_t k = 0; k < nu_; ++k) data->tau[selection_[k]] = u[k];
}

void ActuationModelSelection::calcDiff(const DataPtr&, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModel::calcDiff", x, u);  // derivatives are constant, set in createData
}

void ActuationModelSelection::commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) {
  check_data("ActuationModel::commands", data);
  check_size("ActuationModel::commands", "x", x.size(), state_->get_nx());
  check_size("ActuationModel::commands", "tau", tau.size(), state_->get_nv());
  for (std::size_t k = 0; k < nu_; ++k) data->u[k] = tau[selection_[k]];
}

void ActuationModelSelection::torqueTransform(const DataPtr&, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModel::torqueTransform", x, u);  // Mtau is constant, set in createData
}

// Returns the selection. Empty for classes that users derive, because these may have other derivatives.
const std::vector<int>& ActuationModelSelection::selection() const {
  static const std::vector<int> none;
  const auto& type = typeid(*this);
  return type == typeid(ActuationModelFull) || type == typeid(ActuationModelFloatingBase) ? selection_ : none;
}

namespace {

std::vector<int> all_coordinates(const StateAbstract* state) {
  require(state, "ActuationModelFull", "a state is expected, not a null pointer");
  return internal::range(0, static_cast<int>(state->get_nv()));
}

std::vector<int> actuated_coordinates(const StateMultibody* state) {
  require(state, "ActuationModelFloatingBase", "a state is expected, not a null pointer");
  std::vector<int> out;
  for (const Robot& robot : state->get_model()->scene().robots)
    for (const int i : robot.model->actuated) out.push_back(robot.idx_v + i);
  return out;
}

}  // namespace

ActuationModelFull::ActuationModelFull(std::shared_ptr<StateAbstract> state)
    : ActuationModelSelection(state, all_coordinates(state.get()), "ActuationModelFull") {}

ActuationModelFloatingBase::ActuationModelFloatingBase(std::shared_ptr<StateMultibody> state)
    : ActuationModelSelection(state, actuated_coordinates(state.get()), "ActuationModelFloatingBase") {}

}  // namespace manycontact
