#include "manycontact/action/contact_fwddyn.hpp"

#include <cmath>
#include <limits>
#include <ostream>

#include "../terms.hpp"
#include "fwddyn_steps.hpp"
#include "manycontact/dynamics/follow_kinematics.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

using Model_ = DifferentialActionModelContactFwdDynamics;
using internal::Stage;

constexpr const char* kDifferentialActionModelContactFwdDynamics = "DifferentialActionModelContactFwdDynamics";

Model_::DifferentialActionModelContactFwdDynamics(std::shared_ptr<StateMultibody> state,
                                                  std::shared_ptr<ActuationModelAbstract> actuation,
                                                  std::shared_ptr<ContactModelMultiple> contacts,
                                                  std::shared_ptr<CostModelSum> costs,
                                                  std::shared_ptr<ConstraintModelManager> constraints, double damping,
                                                  bool enable_force)
    : Base(internal::given(kDifferentialActionModelContactFwdDynamics, state, "the state"),
           internal::given(kDifferentialActionModelContactFwdDynamics, actuation, "the actuation")->get_nu(),
           internal::given(kDifferentialActionModelContactFwdDynamics, costs, "the stack of costs")->get_nr(),
           constraints ? constraints->get_ng() : 0, constraints ? constraints->get_nh() : 0),
      multibody_(std::move(state)),
      actuation_(std::move(actuation)),
      contacts_(internal::given(kDifferentialActionModelContactFwdDynamics, contacts, "the stack of contacts")),
      costs_(std::move(costs)),
      constraints_(std::move(constraints)),
      armature_(multibody_->get_model()->armature),
      enable_force_(enable_force) {
  const auto check_part = [this](const auto& part, const char* what) {
    require(same_space(*part.get_state(), *state_), kDifferentialActionModelContactFwdDynamics,
            std::string("the state of the ") + what + " differs from the model's state, the same state is expected");
    require(part.get_nu() == nu_, kDifferentialActionModelContactFwdDynamics,
            std::string("nu of the ") + what + " is " + std::to_string(part.get_nu()) +
                ", the actuation's nu = " + std::to_string(nu_) + " is expected");
  };
  check_part(*actuation_, "actuation");
  check_part(*contacts_, "contacts");
  check_part(*costs_, "costs");
  if (constraints_) {
    check_part(*constraints_, "constraints");
    g_lb_ = constraints_->get_lb();
    g_ub_ = constraints_->get_ub();
  }
  for (const ExternalWrench& push : multibody_->get_model()->scene().wrenches) wrenches_.push_back(push.wrench);
  set_damping_factor(damping);
  models_ = std::make_shared<std::vector<std::shared_ptr<const Model>>>();
  set_armature(armature_);
  const std::vector<int>& selection = actuation_->selection();
  for (std::size_t k = 0; k < selection.size(); ++k) {
    u_ub_[k] = multibody_->get_model()->effortLimit[selection[k]];
    u_lb_[k] = -u_ub_[k];
  }
  update_has_control_limits();
}

void Model_::set_damping_factor(double damping) {
  require(damping >= 0 && std::isfinite(damping),
          std::string(kDifferentialActionModelContactFwdDynamics) + "::set_damping_factor",
          std::to_string(damping) + " was given, a finite number that is not negative is expected");
  damping_ = damping;
}

void Model_::set_start(const Eigen::VectorXd& x0) {
  if (x0.size() > 0) check_size("set_start", "x0", x0.size(), state_->get_nx());
  start_ = x0;
}

void Model_::set_wrenches(const std::vector<Vec6<double>>& wrenches) {
  check_size("set_wrenches", "wrenches", wrenches.size(), wrenches_.size());
  wrenches_ = wrenches;
}

void Model_::set_armature(const Eigen::VectorXd& armature) {
  check_size("set_armature", "armature", armature.size(), state_->get_nv());
  for (double number : armature)
    require(number >= 0 && std::isfinite(number),
            std::string(kDifferentialActionModelContactFwdDynamics) + "::set_armature",
            std::to_string(number) + " was given, finite numbers that are not negative are expected");
  armature_ = armature;
  models_ = std::make_shared<const std::vector<std::shared_ptr<const Model>>>(
      internal::models_with_armature(multibody_->get_model()->scene(), armature));
}

std::shared_ptr<DifferentialActionDataAbstract> Model_::createData() { return std::make_shared<Data>(this); }

bool Model_::checkData(const DataPtr& data) {
  const auto own = std::dynamic_pointer_cast<Data>(data);
  return own && own->owner == identity_;
}

Model_::Data& Model_::own(const char* where, const DataPtr& data) const {
  Data* d = dynamic_cast<Data*>(&check_data(where, data));
  require(d && d->owner == identity_, where,
          "the data were created by another model, data of this model's createData() are expected");
  return *d;
}

// Updates the data's scene with the model's contacts, damping and armature, before a calc at x.
Model_::Data& Model_::refresh(const char* where, const DataPtr& data, const ConstVectorRef& x) const {
  Data& d = own(where, data);
  check_size(where, "x", x.size(), state_->get_nx());
  require(d.contacts_version == contacts_->get_version(), where,
          "contacts were added or removed since the data were created, new data are expected");
  const internal::ActionTerms terms{*costs_, constraints_.get()};
  internal::check_terms(where, terms, *d.costs, d.constraints.get());
  d.stage = Stage::kFresh;
  d.x = x;
  internal::read_status(terms, d.status);
  DataCollector& m = *d.multibody;
  m.scene.damping = damping_;
  bool same = d.models == models_;
  if (!same) {
    d.models = models_;
    for (std::size_t r = 0; r < m.scene.robots.size(); ++r) m.scene.robots[r].model = (*models_)[r];
  }
  same &= internal::update_contacts(*contacts_, m.scene, m.solution);
  if (!same) {
    m.solution = SceneData(m.scene, m.solution.options);
    internal::update_contacts(*contacts_, m.scene, m.solution);
    d.laid_out = false;
  }
  m.solution.wrenches = wrenches_;
  if (!is_prepared(m.solution)) {
    m.prepare();
    d.laid_out = false;
  }
  if (!internal::on_same_frames(*contacts_, *m.contacts) ||
      !internal::residuals_fit(terms, *d.costs, d.constraints.get()))
    d.laid_out = false;
  if (!d.laid_out) {
    internal::lay_out_islands(*actuation_, d);
    internal::lay_out_contacts(*contacts_, m);
    costs_->lay_out(*d.costs);
    if (constraints_) constraints_->lay_out(*d.constraints, d.constraints->terminal);
    d.laid_out = true;
  }
  return d;
}

void Model_::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check_size("DifferentialActionModelContactFwdDynamics::calc", "u", u.size(), nu_);
  Data& d = refresh("DifferentialActionModelContactFwdDynamics::calc", data, x);
  DataCollector& m = *d.multibody;
  d.u = u;
  actuation_->calc(m.actuation, x, u);
  (void)solve_tau(m.scene, x.head(state_->get_nq()), x.tail(state_->get_nv()), m.actuation->tau, m.solution);
  d.xout = m.solution.a;
  internal::fill_contacts(m);
  costs_->calc(d.costs, x, u);
  d.cost = d.costs->cost;
  internal::stack_residuals(*costs_, *d.costs, d.r);
  if (constraints_) constraints_->calc(d.constraints, x, u);
  d.stage = Stage::kRunning;
}

void Model_::calc(const DataPtr& data, const ConstVectorRef& x) {
  Data& d = refresh("DifferentialActionModelContactFwdDynamics::calc", data, x);
  follow_kinematics(d.multibody->scene, x.head(state_->get_nq()), x.tail(state_->get_nv()), d.multibody->solution);
  costs_->calc(d.costs, x);
  d.cost = d.costs->cost;
  internal::stack_residuals(*costs_, *d.costs, d.r);
  if (constraints_) constraints_->calc(d.constraints, x);
  d.stage = Stage::kTerminal;
}

// Throws std::logic_error unless the last calc had the same stage, active contacts, costs and constraints.
void Model_::check_stage(const Data& d, Stage stage) const {
  internal::check_stage(kDifferentialActionModelContactFwdDynamics,
                        d.stage == stage && d.contacts_version == contacts_->get_version() &&
                            internal::has_status({*costs_, constraints_.get()}, d.status),
                        stage);
}

void Model_::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Data& d = own("DifferentialActionModelContactFwdDynamics::calcDiff", data);
  check_size("DifferentialActionModelContactFwdDynamics::calcDiff", "x", x.size(), state_->get_nx());
  check_size("DifferentialActionModelContactFwdDynamics::calcDiff", "u", u.size(), nu_);
  check_stage(d, Stage::kRunning);
  DataCollector& m = *d.multibody;
  actuation_->calcDiff(m.actuation, d.x, d.u);
  const bool forces = needs_forces();
  differentiate(m.scene, m.solution, {true, true, true, forces, internal::by_all_torques(*actuation_, m.scene)});
  internal::apply_actuation(*actuation_, m);
  internal::fill_dynamics(d);
  internal::fill_contact_derivatives(forces, m);
  costs_->calcDiff(d.costs, d.x, d.u);
  if (constraints_) constraints_->calcDiff(d.constraints, d.x, d.u);
}

void Model_::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  Data& d = own("DifferentialActionModelContactFwdDynamics::calcDiff", data);
  check_size("DifferentialActionModelContactFwdDynamics::calcDiff", "x", x.size(), state_->get_nx());
  check_stage(d, Stage::kTerminal);
  costs_->calcDiff(d.costs, d.x);
  if (constraints_) constraints_->calcDiff(d.constraints, d.x);
}

bool Model_::needs_forces() const {
  bool needed = enable_force_;
  internal::each_residual({*costs_, constraints_.get()}, [&](const auto&, const ResidualModelAbstract& residual, bool) {
    needed = needed || residual.depends_on().forces;
  });
  return needed;
}

// Computes quasi-static controls u. The torques of the actuation are linearised at u = 0.
void Model_::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t, double) {
  constexpr const char* kWhere = "DifferentialActionModelContactFwdDynamics::quasiStatic";
  check_size(kWhere, "u", u.size(), nu_);
  check_size(kWhere, "x", x.size(), state_->get_nx());
  require(x.tail(state_->get_nv()).isZero(0), kWhere, "the velocity is not zero, a state at rest is expected");
  Data& d = refresh(kWhere, data, x);
  DataCollector& m = *d.multibody;
  u.setZero();
  actuation_->calc(m.actuation, x, u);
  actuation_->calcDiff(m.actuation, x, u);
  if (!unusable_configuration("q", x.head(m.scene.nq), m.scene).empty()) {  // e.g. x of a rejected trial step
    u.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  u = quasi_static(m.scene, x.head(m.scene.nq), m.actuation->tau, m.actuation->dtau_du, m.solution);
}

const Eigen::VectorXd& Model_::get_g_lb() const {
  return constraints_ && constraints_->get_status() != g_lb_status_ ? constraints_->get_lb() : g_lb_;
}
const Eigen::VectorXd& Model_::get_g_ub() const {
  return constraints_ && constraints_->get_status() != g_ub_status_ ? constraints_->get_ub() : g_ub_;
}
void Model_::set_g_lb(const Eigen::VectorXd& g_lb) {
  Base::set_g_lb(g_lb);
  if (constraints_) g_lb_status_ = constraints_->get_status();
}
void Model_::set_g_ub(const Eigen::VectorXd& g_ub) {
  Base::set_g_ub(g_ub);
  if (constraints_) g_ub_status_ = constraints_->get_status();
}

void Model_::print(std::ostream& os) const {
  os << kDifferentialActionModelContactFwdDynamics << " {nx=" << state_->get_nx() << ", ndx=" << state_->get_ndx()
     << ", nu=" << nu_ << ", nc=" << contacts_->get_nc() << ", nr=" << get_nr() << ", ng=" << get_ng()
     << ", nh=" << get_nh() << ", damping=" << damping_ << "}";
}

}  // namespace manycontact
