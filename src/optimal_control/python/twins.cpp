// Further classes of Crocoddyl: thrusters, squashed controls, a bounded quadratic problem, linear-quadratic
// differential models, and parts of action models whose derivatives are central differences.

#include <optional>
#include <type_traits>

#include "action.hpp"
#include "manycontact/action/contact.hpp"
#include "manycontact/action/squashing.hpp"
#include "manycontact/action/thrusters.hpp"
#include "manycontact/control/box_qp.hpp"
#include "manycontact/control/control_parametrization.hpp"
#include "manycontact/control/diff_lqr.hpp"
#include "manycontact/detail/action/num_diff_parts.hpp"

namespace manycontact::python {

namespace {

Items<Handle<Thruster>> thrusters_of(const std::shared_ptr<ActuationModelFloatingBaseThrusters>& model) {
  const auto at = [model](std::size_t k) {
    return Handle<Thruster>([model, k]() -> const Thruster& { return model->get_thrusters().at(k); },
                            [model, k](const Thruster& thruster) {
                              std::vector<Thruster> all = model->get_thrusters();
                              all.at(k) = thruster;
                              model->set_thrusters(all);
                            });
  };
  return {[model] { return model->get_thrusters().size(); }, at};
}

void add_thrusters(py::module_& m) {
  enumeration<ThrusterType, CW, CCW>(m);
  using Held = Handle<Thruster>;
  Class<Held> c(m, "Thruster");
  c.def(py::init([](const SE3<double>& pose, double ctorque, ThrusterType type, double min, double max) {
     return Held(Thruster(pose, ctorque, type, min, max));
   })).def("__repr__", [](const Held& x) { return text_of(x.get()); });
  c.fields<&Thruster::pose, &Thruster::ctorque, &Thruster::type, &Thruster::min_thrust, &Thruster::max_thrust>();
  add_items<Held>(m, "ThrusterList", false);
  using Model = ActuationModelFloatingBaseThrusters;
  shared<Model, ActuationModelAbstract>(m)
      .constructors<void(std::shared_ptr<StateMultibody>, const std::vector<Thruster>&)>()
      .property("thrusters", &thrusters_of, &Model::set_thrusters)
      .read<&Model::get_nthrusters, &Model::get_Wthrust, &Model::get_S>();
}

void add_squashing(py::module_& m) {
  using Abstract = SquashingModelAbstract;
  shared<SquashingDataAbstract>(m).read<&SquashingDataAbstract::u, &SquashingDataAbstract::du_ds>();
  shared<Abstract>(m)
      .methods<&Abstract::createData, &Abstract::calc, &Abstract::calcDiff>()
      .read<&Abstract::get_ns>()
      .property<&Abstract::get_s_lb, &Abstract::set_s_lb, &Abstract::get_s_ub, &Abstract::set_s_ub>();
  using Smooth = SquashingModelSmoothSat;
  shared<Smooth, Abstract>(m)
      .constructors<void(const ConstVectorRef&, const ConstVectorRef&, std::size_t)>()
      .property<&Smooth::get_smooth, &Smooth::set_smooth>()
      .read<&Smooth::get_d>();
  using Model = ActuationSquashingModel;
  shared<Model, ActuationModelAbstract>(m)
      .constructors<void(std::shared_ptr<ActuationModelAbstract>, std::shared_ptr<Abstract>, std::size_t)>()
      .read<&Model::get_squashing, &Model::get_actuation>();
}

void add_box_qp(py::module_& m) {
  shared<BoxQPSolution>(m)
      .read<&BoxQPSolution::Hff_inv, &BoxQPSolution::x, &BoxQPSolution::free_idx, &BoxQPSolution::clamped_idx>();
  shared<BoxQP>(m)
      .constructors<void(std::size_t, std::size_t, double, double, double)>()
      .def("solve", [](BoxQP& x, const Matrix& H, const Vector& q, const Vector& lb, const Vector& ub,
                       const Vector& xinit) { return BoxQPSolution(x.solve(H, q, lb, ub, xinit)); })
      .read<&BoxQP::is_sound, &BoxQP::get_iter>()
      .read("solution", [](const BoxQP& x) { return BoxQPSolution(x.get_solution()); })
      .property<&BoxQP::get_nx, &BoxQP::set_nx, &BoxQP::get_maxiter, &BoxQP::set_maxiter, &BoxQP::get_th_acceptstep,
                &BoxQP::set_th_acceptstep, &BoxQP::get_th_grad, &BoxQP::set_th_grad, &BoxQP::get_reg, &BoxQP::set_reg,
                &BoxQP::get_alphas, &BoxQP::set_alphas>();
}

void add_differential_lqr(py::module_& m) {
  using Lqr = DifferentialActionModelLQR;
  shared<Lqr, DifferentialActionModelAbstract>(m)
      .constructors<void(const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&),
                    void(const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&,
                         const Vector&, const Vector&, const Vector&),
                    void(std::size_t, std::size_t, bool)>()
      .def_static("Random", &Lqr::Random)
      .read<&Lqr::get_Aq, &Lqr::get_Av, &Lqr::get_B, &Lqr::get_f>();
}

// Adds a model class Twin, which has the values of a model of class Part, but computes derivatives by differences.
template <class Twin, class Part>
void add_twin(py::module_& m) {
  shared<Twin, Part>(m)
      .def(py::init([](const std::shared_ptr<Part>& part) { return std::make_shared<Twin>(part); }))
      .template property<&Twin::get_disturbance, &Twin::set_disturbance>();
}

// Evaluates a part (a cost, a residual, ...) without an action model. Computes the motion of the robots for it.
template <class Twin, class Part>
class Alone {
 public:
  explicit Alone(const std::shared_ptr<Part>& part)
      : state_(std::dynamic_pointer_cast<StateMultibody>(part->get_state())), twin_(part) {
    if (!state_) throw py::type_error("numerical differences: the state of the part has to be a StateMultibody");
    motion_ = std::make_shared<MultibodyData>(*state_->get_model());
    collector_ = std::make_shared<DataCollector>(motion_.get());
    twin_.set_reevals({[this](const Vector& x, const Vector&) { move(x); }});
    if constexpr (std::is_same_v<Part, ContactModelAbstract>)
      data_ = twin_.createData(motion_.get());
    else
      data_ = twin_.createData(collector_.get());
  }
  Alone(const Alone&) = delete;

  /// Returns the part's data after calc or calcDiff at x, u. Without u, these are the functions of a terminal node.
  const auto& at(const Vector& x, const std::optional<Vector>& u, bool differentiate) {
    check(x, u);
    move(x);
    if constexpr (!std::is_same_v<Part, ContactModelAbstract>) {
      if (u) {
        twin_.calc(data_, x, *u);
        if (differentiate) twin_.calcDiff(data_, x, *u);
        return *data_;
      }
    }
    twin_.calc(data_, x);
    if (differentiate) twin_.calcDiff(data_, x);
    return *data_;
  }
  double get_disturbance() const { return twin_.get_disturbance(); }
  void set_disturbance(double disturbance) { twin_.set_disturbance(disturbance); }

 private:
  void check(const Vector& x, const std::optional<Vector>& u) const {
    if (x.size() != static_cast<Eigen::Index>(state_->get_nx()))
      throw py::value_error("x: " + std::to_string(state_->get_nx()) + " numbers are expected");
    if (u && u->size() != static_cast<Eigen::Index>(twin_.get_model()->get_nu()))
      throw py::value_error("u: " + std::to_string(twin_.get_model()->get_nu()) + " numbers are expected");
  }
  void move(const Vector& x) { motion_->update(x.head(state_->get_nq()), x.tail(state_->get_nv())); }

  std::shared_ptr<StateMultibody> state_;
  Twin twin_;
  std::shared_ptr<MultibodyData> motion_;
  std::shared_ptr<DataCollector> collector_;
  decltype(std::declval<Part>().createData(nullptr)) data_;
};

template <class Twin, class Part>
auto add_alone(py::module_& m) {
  using One = Alone<Twin, Part>;
  return shared<One>(m, type_name<Twin>())
      .template constructors<void(const std::shared_ptr<Part>&)>()
      .template property<&One::get_disturbance, &One::set_disturbance>();
}

void add_twins_of_parts(py::module_& m) {
  using U = std::optional<Vector>;
  using Cost = Alone<CostModelNumDiff, CostModelAbstract>;
  add_alone<CostModelNumDiff, CostModelAbstract>(m)
      .def("calc", [](Cost& c, const Vector& x, const U& u) { return c.at(x, u, false).cost; })
      .def("calcDiff", [](Cost& c, const Vector& x, const U& u) {
        const CostDataAbstract& d = c.at(x, u, true);
        return std::make_tuple(Vector(d.Lx), Vector(d.Lu), Matrix(d.Lxx), Matrix(d.Lxu), Matrix(d.Luu));
      });
  using Constraint = Alone<ConstraintModelNumDiff, ConstraintModelAbstract>;
  add_alone<ConstraintModelNumDiff, ConstraintModelAbstract>(m)
      .def("calc",
           [](Constraint& c, const Vector& x, const U& u) {
             const ConstraintDataAbstract& d = c.at(x, u, false);
             return std::make_tuple(Vector(d.g), Vector(d.h));
           })
      .def("calcDiff", [](Constraint& c, const Vector& x, const U& u) {
        const ConstraintDataAbstract& d = c.at(x, u, true);
        return std::make_tuple(Matrix(d.Gx), Matrix(d.Gu), Matrix(d.Hx), Matrix(d.Hu));
      });
  using Contact = Alone<ContactModelNumDiff, ContactModelAbstract>;
  add_alone<ContactModelNumDiff, ContactModelAbstract>(m)
      .def("calc", [](Contact& c, const Vector& x) { return Vector(c.at(x, {}, false).a0); })
      .def("calcDiff", [](Contact& c, const Vector& x) { return Matrix(c.at(x, {}, true).da0_dx); });
}

}  // namespace

void add_twins(py::module_& m) {
  add_thrusters(m);
  add_squashing(m);
  add_box_qp(m);
  add_differential_lqr(m);
  add_twin<StateNumDiff, StateAbstract>(m);
  add_twin<ActivationModelNumDiff, ActivationModelAbstract>(m);
  add_twin<ActuationModelNumDiff, ActuationModelAbstract>(m);
  add_twin<ResidualModelNumDiff, ResidualModelAbstract>(m);
  add_twin<ControlParametrizationModelNumDiff, ControlParametrizationModelAbstract>(m);
  add_twins_of_parts(m);
}

}  // namespace manycontact::python
