#include "manycontact/control/impulse_fwddyn.hpp"

#include <cmath>
#include <ostream>

#include "../../action/by_node.hpp"
#include "../../action/terms.hpp"
#include "../integrators/steps.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/model/inputs.hpp"

namespace manycontact {

namespace internal {

// The right-hand side (1 + e) M v of an impact, as an actuation tau(x, u) = (1 + e) M(q) u with u = v.
class ImpactActuation : public ActuationModelAbstract {
 public:
  explicit ImpactActuation(std::shared_ptr<StateMultibody> state);

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  void commands(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void torqueTransform(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override {}
  std::shared_ptr<ActuationDataAbstract> createData() override;

  double restitution = 0;    // e
  Eigen::VectorXd armature;  // nv

 private:
  std::shared_ptr<StateMultibody> multibody_;
};

namespace {

struct RobotWork {
  explicit RobotWork(const Model& model)
      : kin(model),
        derivatives(model),
        f(model.njoints(), Vec6<double>(Vec6<double>::Zero())),
        Yc(kin.Y),
        M(packed_size(model)),
        lower(M.size()),
        upper(M.size()) {}
  Kinematics<double> kin;
  RneaDerivatives derivatives;
  std::vector<Vec6<double>> f;
  std::vector<Inertia<double>> Yc;
  std::vector<double> M;
  std::vector<int> lower, upper;  // indices of (i, j), (j, i) in the values of dtau_du, per packed entry of M
};

struct ImpactData : ActuationDataAbstract {
  using ActuationDataAbstract::ActuationDataAbstract;
  std::vector<RobotWork> robots;
};

const std::vector<Robot>& robots_of(const StateMultibody& state) { return state.get_model()->scene().robots; }

// Calls use(k, i, j) for each packed entry k of M, in row i and in column j of an ancestor or of i, within the robot.
template <class Use>
void each_entry(const Model& model, Use&& use) {
  for (int i = 0; i < model.nv; ++i) {
    int k = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j]) use(k++, i, j);
  }
}

// Sets the kinematics for the inverse dynamics ID(q, 0, u): zero velocity, no gravity, and accelerations u.
void move(const Robot& robot, const ConstVectorRef& x, const ConstVectorRef& u, RobotWork& w) {
  const Model& model = *robot.model;
  forward_kinematics<double>(model, robot.base, x.segment(robot.idx_q, model.nq), w.kin);
  forward_accelerations<double>(model, x.tail(u.size()).segment(robot.idx_v, model.nv), u.data() + robot.idx_v,
                                Vec3<double>(Vec3<double>::Zero()), w.kin);
}

}  // namespace

ImpactActuation::ImpactActuation(std::shared_ptr<StateMultibody> state)
    : ActuationModelAbstract(state, state->get_nv()),
      armature(state->get_model()->armature),
      multibody_(std::move(state)) {}

std::shared_ptr<ActuationDataAbstract> ImpactActuation::createData() {
  auto data = std::make_shared<ImpactData>(this);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Robot& robot : robots_of(*multibody_)) {
    data->robots.emplace_back(*robot.model);
    each_entry(*robot.model, [&](int, int i, int j) {
      entries.emplace_back(robot.idx_v + i, robot.idx_v + j, 0);
      if (i != j) entries.emplace_back(robot.idx_v + j, robot.idx_v + i, 0);
    });
  }
  data->dtau_du.setFromTriplets(entries.begin(), entries.end());
  data->dtau_dx.setFromTriplets(entries.begin(), entries.end());
  double* first = data->dtau_du.valuePtr();
  for (std::size_t r = 0; r < data->robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    RobotWork& w = data->robots[r];
    each_entry(*robot.model, [&](int k, int i, int j) {
      w.lower[k] = static_cast<int>(&data->dtau_du.coeffRef(robot.idx_v + i, robot.idx_v + j) - first);
      w.upper[k] = static_cast<int>(&data->dtau_du.coeffRef(robot.idx_v + j, robot.idx_v + i) - first);
    });
  }
  return data;
}

// Computes tau = (1 + e) ID(q, 0, u), where ID is the inverse dynamics without gravity.
void ImpactActuation::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ImpactActuation::calc", x, u);
  ImpactData& d = static_cast<ImpactData&>(*data);
  for (std::size_t r = 0; r < d.robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    RobotWork& w = d.robots[r];
    move(robot, x, u, w);
    inverse_dynamics<double>(*robot.model, w.kin, nullptr, {}, w.f, d.tau.segment(robot.idx_v, robot.model->nv));
  }
  d.tau += armature.cwiseProduct(u);
  d.tau *= 1 + restitution;
}

// Computes dtau/dq = (1 + e) dID/dq and dtau/du = (1 + e) M at the last calc.
void ImpactActuation::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ImpactActuation::calcDiff", x, u);
  ImpactData& d = static_cast<ImpactData&>(*data);
  const double scale = 1 + restitution;
  double *by_x = d.dtau_dx.valuePtr(), *by_u = d.dtau_du.valuePtr();
  for (std::size_t r = 0; r < d.robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    const Model& model = *robot.model;
    RobotWork& w = d.robots[r];
    crba<double>(model, w.kin, w.Yc, w.M.data());
    rnea_derivatives<double>(model, w.kin, w.Yc, {}, w.derivatives);
    each_entry(model, [&](int k, int i, int j) {
      const double turned = i == j ? armature[robot.idx_v + i] - model.armature[i] : 0;
      by_u[w.lower[k]] = by_u[w.upper[k]] = scale * (w.M[k] + turned);
      by_x[w.upper[k]] = scale * w.derivatives.dq_upper[k];
      by_x[w.lower[k]] = scale * w.derivatives.dq_lower[k];  // overwrites dq_upper on the diagonal, as intended
    });
  }
}

}  // namespace internal

using Model_ = ActionModelImpulseFwdDynamics;
using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::Stage;

namespace {

constexpr const char* kActionModelImpulseFwdDynamics = Model_::kName;
const std::vector<int> kNoColumns;

// A differential model without controls. Costs and constraints of the impact write their derivatives into its data.
class Terms : public DifferentialActionModelAbstract {
 public:
  explicit Terms(const Model_& model)
      : DifferentialActionModelAbstract(model.get_state(), 0, model.get_nr(), model.get_ng(), model.get_nh()) {
    set_storage(MatrixStorage::kDense);
  }
  void calc(const std::shared_ptr<DifferentialActionDataAbstract>&, const ConstVectorRef&,
            const ConstVectorRef&) override {}
  void calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>&, const ConstVectorRef&,
                const ConstVectorRef&) override {}
};

void check_residual(const std::string& name, const ResidualModelAbstract& residual, bool) {
  require(!residual.depends_on().u && !residual.depends_on().acceleration, kActionModelImpulseFwdDynamics,
          "\"" + name + "\" depends on controls or accelerations, which an impact does not have");
}

}  // namespace

Model_::ActionModelImpulseFwdDynamics(std::shared_ptr<StateMultibody> state,
                                      std::shared_ptr<ImpulseModelMultiple> impulses,
                                      std::shared_ptr<CostModelSum> costs,
                                      std::shared_ptr<ConstraintModelManager> constraints, double r_coeff,
                                      double damping, bool)
    : NodeWithData(internal::given(kActionModelImpulseFwdDynamics, state, "the state"), 0,
                   internal::given(kActionModelImpulseFwdDynamics, costs, "the stack of costs")->get_nr(),
                   constraints ? constraints->get_ng() : 0, constraints ? constraints->get_nh() : 0,
                   constraints ? constraints->get_ng_T() : 0, constraints ? constraints->get_nh_T() : 0),
      multibody_(std::move(state)),
      impulses_(internal::given(kActionModelImpulseFwdDynamics, impulses, "the stack of impulses")),
      costs_(std::move(costs)),
      constraints_(std::move(constraints)),
      actuation_(std::make_shared<internal::ImpactActuation>(multibody_)) {
  const auto check_part = [this](const auto& part, const char* what, std::size_t nu) {
    require(same_space(*part.get_state(), *state_), kActionModelImpulseFwdDynamics,
            std::string("the state of the ") + what + " differs from the model's state, the same state is expected");
    require(nu == 0, kActionModelImpulseFwdDynamics,
            std::string("nu of the ") + what + " is " + std::to_string(nu) + ", nu = 0 is expected");
  };
  check_part(*impulses_, "impulses", 0);
  check_part(*costs_, "costs", costs_->get_nu());
  if (constraints_) check_part(*constraints_, "constraints", constraints_->get_nu());
  dynamics_ = std::make_shared<DifferentialActionModelContactFwdDynamics>(
      multibody_, actuation_, impulses_->get_contacts(),
      std::make_shared<CostModelSum>(multibody_, multibody_->get_nv()), damping, true);
  dynamics_->set_storage(MatrixStorage::kDense);
  set_restitution_coefficient(r_coeff);
}

void Model_::set_restitution_coefficient(double r_coeff) {
  require(r_coeff >= 0 && std::isfinite(r_coeff),
          std::string(kActionModelImpulseFwdDynamics) + "::set_restitution_coefficient",
          std::to_string(r_coeff) + " was given, a finite number that is not negative is expected");
  r_coeff_ = actuation_->restitution = r_coeff;
}

void Model_::set_armature(const Eigen::VectorXd& armature) {
  dynamics_->set_armature(armature);
  actuation_->armature = armature;
}

ActionDataImpulseFwdDynamics::ActionDataImpulseFwdDynamics(ActionModelImpulseFwdDynamics* model)
    : ActionDataAbstract(model),
      dynamics(std::dynamic_pointer_cast<DifferentialActionDataContactFwdDynamics>(model->dynamics_->createData())),
      multibody(dynamics->multibody.get()) {
  const StateAbstract& state = *model->get_state();
  multibody->scene.gravity.setZero();
  if (has_applied_forces(multibody->scene)) {  // finite forces transmit no impulse
    drop_applied_forces(multibody->scene);
    multibody->solution = SceneData(multibody->scene, multibody->solution.options);
    dynamics->laid_out = false;
  }
  multibody->impact = std::make_unique<Impact>();
  Impact& impact = *multibody->impact;
  for (const Robot& robot : multibody->scene.robots) impact.motion.emplace_back(*robot.model);
  impact.vnext.setZero(state.get_nv());
  impact.dvnext_dx.setZero(state.get_nv(), state.get_ndx());
  x.setZero(state.get_nx());
  x_rest.setZero(state.get_nx());
  v.setZero(state.get_nv());
  Terms shape(*model);
  terms = std::make_shared<DifferentialActionDataAbstract>(&shape);
  for (auto& [name, contact] : multibody->contacts->contacts) contact->f_u_columns = &kNoColumns;
  costs = model->costs_->createData(multibody, terms.get());
  if (model->constraints_) constraints = model->constraints_->createData(multibody, terms.get());
}

DataPtr Model_::createData() {
  internal::each_residual({*costs_, constraints_.get()}, check_residual);
  return std::make_shared<Data>(this);
}

bool Model_::checkData(const DataPtr& data) {
  const auto* d = dynamic_cast<Data*>(data.get());
  return d && dynamics_->checkData(d->dynamics);
}

// Calls lay_out of costs and constraints again after impulses were switched, or after a frame has changed.
void Model_::lay_out(Data& d) const {
  bool fits = d.laid_out.size() == impulses_->get_impulses().size();
  std::size_t k = 0;
  for (const auto& [name, item] : impulses_->get_impulses()) {
    fits = fits && d.laid_out[k] == item->active && d.frames[k] == item->impulse->get_id();
    ++k;
  }
  fits = internal::residuals_fit({*costs_, constraints_.get()}, *d.costs, d.constraints.get()) && fits;
  for (auto& [name, contact] : d.multibody->contacts->contacts) contact->f_u_columns = &kNoColumns;
  if (fits) return;
  d.laid_out.clear();
  d.frames.clear();
  for (const auto& [name, item] : impulses_->get_impulses()) {
    d.laid_out.push_back(item->active);
    d.frames.push_back(item->impulse->get_id());
  }
  costs_->lay_out(*d.costs);
  if (constraints_) constraints_->lay_out(*d.constraints, d.constraints->terminal);
}

// Computes the velocity v+ = w - e v after the impact, with the velocity v before it and the restitution e. w is the
// acceleration xout of `dynamics` at zero velocity and u = v.
void Model_::evaluate(Data& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  constexpr const char* where = "ActionModelImpulseFwdDynamics::calc";
  const internal::ActionTerms terms{*costs_, constraints_.get()};
  internal::check_terms(where, terms, *d.costs, d.constraints.get());
  for (const auto& [name, item] : impulses_->get_impulses())
    require(item->active == impulses_->get_contacts()->getContactStatus(name), where,
            "the status of an impulse was changed in the item, call changeImpulseStatus instead");
  const Eigen::Index nq = state_->get_nq(), nv = state_->get_nv();
  d.stage = Stage::kFresh;
  d.x = x;
  d.v = x.tail(nv);
  d.x_rest.head(nq) = x.head(nq);
  internal::read_status(terms, d.status);
  dynamics_->calc(d.dynamics, d.x_rest, d.v);
  DataCollector& m = *d.multibody;
  m.impact->vnext = d.dynamics->xout - r_coeff_ * d.v;
  d.xnext.head(nq) = x.head(nq);
  d.xnext.tail(nv) = m.impact->vnext;
  for (std::size_t r = 0; r < m.scene.robots.size(); ++r) {
    const Robot& robot = m.scene.robots[r];
    const Model& model = *robot.model;
    Kinematics<double>& kin = m.impact->motion[r];
    forward_kinematics<double>(model, robot.base, x.segment(robot.idx_q, model.nq), kin);
    forward_accelerations<double>(model, d.v.segment(robot.idx_v, model.nv), nullptr, m.scene.gravity, kin);
  }
  lay_out(d);
  internal::calc(*costs_, d.costs, x, u);
  if (constraints_) internal::calc(*constraints_, d.constraints, x, u);
  d.cost = d.costs->cost;
  internal::stack_residuals(*costs_, *d.costs, d.r);
  internal::copy_values(*d.terms, false, d);
  d.stage = u ? Stage::kRunning : Stage::kTerminal;
}

// Computes dv+/dq = dw/dq and dv+/dv = dw/dv - e I, where w is the acceleration of `dynamics`, whose controls are v.
void Model_::differentiate(Data& d, const ConstVectorRef&, const ConstVectorRef* u) {
  const Stage stage = u ? Stage::kRunning : Stage::kTerminal;
  internal::check_stage(kActionModelImpulseFwdDynamics,
                        d.stage == stage && internal::has_status({*costs_, constraints_.get()}, d.status), stage);
  const Eigen::Index nv = state_->get_nv();
  dynamics_->calcDiff(d.dynamics, d.x_rest, d.v);
  DataCollector& m = *d.multibody;
  Eigen::MatrixXd& dvnext = m.impact->dvnext_dx;
  dvnext.leftCols(nv) = d.dynamics->Fx.leftCols(nv);
  dvnext.rightCols(nv) = d.dynamics->Fu;
  dvnext.rightCols(nv).diagonal().array() -= r_coeff_;
  // Copies the columns of u, which is v, to those of v, so that the contacts' views df_dx show derivatives w.r.t. v.
  for (RowMajorMatrix& panel : m.custom) panel.middleCols(nv, nv) = panel.rightCols(nv);
  for (auto& [name, contact] : m.contacts->contacts)
    if (contact->active) new (&contact->df_du) PanelView(nullptr, contact->Jc.rows(), 0, Eigen::OuterStride<>(0));
  d.Fx.topLeftCorner(nv, nv).setIdentity();
  d.Fx.topRightCorner(nv, nv).setZero();
  d.Fx.bottomRows(nv) = dvnext;
  internal::calc_diff(*costs_, d.costs, d.x, u);
  if (constraints_) internal::calc_diff(*constraints_, d.constraints, d.x, u);
  d.Lx = d.terms->Lx;
  d.Lxx = d.terms->Lxx;
  d.Gx = d.terms->Gx;
  d.Hx = d.terms->Hx;
  d.Gu.resize(d.Gx.rows(), 0);
  d.Hu.resize(d.Hx.rows(), 0);
}

void Model_::print(std::ostream& os) const {
  os << kActionModelImpulseFwdDynamics << " {nx=" << state_->get_nx() << ", ndx=" << state_->get_ndx()
     << ", nc=" << impulses_->get_nc() << ", nr=" << get_nr() << ", ng=" << get_ng() << ", nh=" << get_nh()
     << ", r_coeff=" << r_coeff_ << ", damping=" << get_damping_factor() << "}";
}

}  // namespace manycontact
