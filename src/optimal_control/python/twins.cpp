// Further classes of Crocoddyl: thrusters, squashed controls, a bounded quadratic problem, linear-quadratic
// differential models, and parts of action models whose derivatives are central differences.

#include <optional>
#include <type_traits>

#include "action.hpp"
#include "manycontact/action/contact.hpp"
#include "manycontact/action/num_diff_parts.hpp"
#include "manycontact/action/squashing.hpp"
#include "manycontact/action/thrusters.hpp"
#include "manycontact/control/box_qp.hpp"
#include "manycontact/control/control_parametrization.hpp"
#include "manycontact/control/diff_lqr.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

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
  add_enumeration<ThrusterType>(
      m, "ThrusterType", "type",
      "Direction of rotation of a propeller: CW gives a torque along its thrust, CCW one against it.",
      {{"CW", CW}, {"CCW", CCW}});
  using Held = Handle<Thruster>;
  py::class_<Held> c(m, "Thruster",
                     "A propeller on the base. Its thrust acts along its z axis.\n"
                     "\n"
                     "Assigning to the attributes of actuation.thrusters[0] changes the actuation.");
  c.def(py::init([](const SE3<double>& pose, double ctorque, ThrusterType type, double min, double max) {
          return Held(Thruster(pose, ctorque, type, min, max));
        }),
        py::arg("pose"), py::arg("ctorque"), py::arg_v("type", CW, "ThrusterType.CW"), py::arg("min_thrust") = 0.0,
        py::arg_v("max_thrust", std::numeric_limits<double>::infinity(), "float('inf')"))
      .def("__repr__", [](const Held& x) { return text_of(x.get()); });
  handle_field(c, "pose", &Thruster::pose, "In the base's frame.");
  handle_field(c, "ctorque", &Thruster::ctorque, "Torque about the axis per thrust [m].");
  handle_field(c, "type", &Thruster::type, "Direction of rotation, a ThrusterType.");
  handle_field(c, "min_thrust", &Thruster::min_thrust, "[N]");
  handle_field(c, "max_thrust", &Thruster::max_thrust, "[N]");
  add_items<Held>(m, "ThrusterList", "The thrusters of an actuation. Assigning to their attributes changes it.", false);
  using Model = ActuationModelFloatingBaseThrusters;
  py::class_<Model, ActuationModelAbstract, std::shared_ptr<Model>>(
      m, "ActuationModelFloatingBaseThrusters", "u = [thrusts; torques of the actuated joints] of one robot.")
      .def(py::init<std::shared_ptr<StateMultibody>, const std::vector<Thruster>&>(), py::arg("state").none(false),
           py::arg("thrusters"))
      .def_property("thrusters", &thrusters_of, &Model::set_thrusters, "The thrusters; their number is fixed.")
      .def_property_readonly("nthrusters", &Model::get_nthrusters, "Number of thrusters.")
      .def_property_readonly(
          "Wthrust", [](const Model& x) { return x.get_Wthrust(); }, "(nv, nu): tau = W u.")
      .def_property_readonly(
          "S", [](const Model& x) { return x.get_S(); }, "(nv, nv): W times its pseudo-inverse.");
}

void add_squashing(py::module_& m) {
  using Data = std::shared_ptr<SquashingDataAbstract>;
  using Abstract = SquashingModelAbstract;
  py::class_<SquashingDataAbstract, Data>(m, "SquashingDataAbstract", "Result of a squashing model.")
      .def_readonly("u", &SquashingDataAbstract::u, "Controls (ns).")
      .def_readonly("du_ds", &SquashingDataAbstract::du_ds, "Derivatives of u by s (ns, ns).");
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "SquashingModelAbstract", "u(s), s any numbers.")
      .def("createData", &Abstract::createData, "Return data of the model.")
      .def("calc", &Abstract::calc, py::arg("data").none(false), py::arg("s"), "Compute data.u.")
      .def("calcDiff", &Abstract::calcDiff, py::arg("data").none(false), py::arg("s"), "Compute data.du_ds.")
      .def_property_readonly("ns", &Abstract::get_ns, "Number of squashed inputs s.")
      .def_property("s_lb", &Abstract::get_s_lb, &Abstract::set_s_lb, "Lower bounds of s, for a barrier.")
      .def_property("s_ub", &Abstract::get_s_ub, &Abstract::set_s_ub, "Upper bounds of s, for a barrier.");
  using Smooth = SquashingModelSmoothSat;
  py::class_<Smooth, Abstract, std::shared_ptr<Smooth>>(
      m, "SquashingModelSmoothSat", "u close to s inside the bounds, and between the bounds for any s, smoothly.")
      .def(py::init<const ConstVectorRef&, const ConstVectorRef&, std::size_t>(), py::arg("u_lb"), py::arg("u_ub"),
           py::arg("ns"))
      .def_property("smooth", &Smooth::get_smooth, &Smooth::set_smooth, "Smoothness: 0 is the sharp saturation.")
      .def_property_readonly("d", &Smooth::get_d, "Width of the smooth part, per input.");
  using Model = ActuationSquashingModel;
  py::class_<Model, ActuationModelAbstract, std::shared_ptr<Model>>(
      m, "ActuationSquashingModel", "An actuation whose controls are squashed first: nu = ns.")
      .def(py::init<std::shared_ptr<ActuationModelAbstract>, std::shared_ptr<Abstract>, std::size_t>(),
           py::arg("actuation").none(false), py::arg("squashing").none(false), py::arg("nu"))
      .def_property_readonly("squashing", &Model::get_squashing, "The squashing model.")
      .def_property_readonly("actuation", &Model::get_actuation, "The actuation that takes the squashed controls.");
}

void add_box_qp(py::module_& m) {
  py::class_<BoxQPSolution, std::shared_ptr<BoxQPSolution>>(m, "BoxQPSolution", "x, and which bounds are active.")
      .def_readonly("Hff_inv", &BoxQPSolution::Hff_inv, "Inverse of H's rows and columns of the free components.")
      .def_readonly("x", &BoxQPSolution::x, "The minimiser (nx).")
      .def_readonly("free_idx", &BoxQPSolution::free_idx, "Numbers of the components between their bounds.")
      .def_readonly("clamped_idx", &BoxQPSolution::clamped_idx, "Numbers of the components on a bound.");
  py::class_<BoxQP, std::shared_ptr<BoxQP>>(m, "BoxQP",
                                            "min 1/2 x'H x + q'x, lb <= x <= ub, by projected Newton steps.")
      .def(py::init<std::size_t, std::size_t, double, double, double>(), py::arg("nx"), py::arg("maxiter") = 100,
           py::arg("th_acceptstep") = 0.1, py::arg("th_grad") = 1e-9, py::arg("reg") = 1e-9)
      .def(
          "solve",
          [](BoxQP& x, const Matrix& H, const Vector& q, const Vector& lb, const Vector& ub, const Vector& xinit) {
            return BoxQPSolution(x.solve(H, q, lb, ub, xinit));
          },
          py::arg("H"), py::arg("q"), py::arg("lb"), py::arg("ub"), py::arg("xinit"),
          "A BoxQPSolution. Where H is not positive definite on the free components, is_sound is False.")
      .def_property_readonly("is_sound", &BoxQP::is_sound,
                             "False if H was not positive definite on the free components.")
      .def_property_readonly(
          "solution", [](const BoxQP& x) { return BoxQPSolution(x.get_solution()); }, "A copy.")
      .def_property_readonly("iter", &BoxQP::get_iter, "Newton steps of the last solve.")
      .def_property("nx", &BoxQP::get_nx, &BoxQP::set_nx, "Number of components of x.")
      .def_property("maxiter", &BoxQP::get_maxiter, &BoxQP::set_maxiter, "Largest number of Newton steps.")
      .def_property("th_acceptstep", &BoxQP::get_th_acceptstep, &BoxQP::set_th_acceptstep,
                    "Share of the predicted decrease that a step must reach.")
      .def_property("th_grad", &BoxQP::get_th_grad, &BoxQP::set_th_grad,
                    "Projected gradient at which the iteration ends.")
      .def_property("reg", &BoxQP::get_reg, &BoxQP::set_reg, "Regularisation added to the diagonal of H.")
      .def_property("alphas", &BoxQP::get_alphas, &BoxQP::set_alphas, "Step lengths of the line search.");
}

void add_differential_lqr(py::module_& m) {
  using Lqr = DifferentialActionModelLQR;
  py::class_<Lqr, DifferentialActionModelAbstract, std::shared_ptr<Lqr>>(
      m, "DifferentialActionModelLQR", "qdd = Aq q + Av v + B u + f, l = 1/2 x'Q x + 1/2 u'R u + x'N u + q'x + r'u.")
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&>(),
           py::arg("Aq"), py::arg("Av"), py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"))
      .def(py::init<const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&, const Matrix&,
                    const Vector&, const Vector&, const Vector&>(),
           py::arg("Aq"), py::arg("Av"), py::arg("B"), py::arg("Q"), py::arg("R"), py::arg("N"), py::arg("f"),
           py::arg("q"), py::arg("r"))
      .def(py::init<std::size_t, std::size_t, bool>(), py::arg("nq"), py::arg("nu"), py::arg("drift_free") = true)
      .def_static("Random", &Lqr::Random, py::arg("nq"), py::arg("nu"), py::arg("ng") = 0, py::arg("nh") = 0,
                  "Return a model with random matrices.")
      .def_property_readonly("Aq", &Lqr::get_Aq, "Acceleration per configuration.")
      .def_property_readonly("Av", &Lqr::get_Av, "Acceleration per velocity.")
      .def_property_readonly("B", &Lqr::get_B, "Acceleration per control.")
      .def_property_readonly("f", &Lqr::get_f, "Acceleration at zero configuration, velocity and control.");
}

// A part with the values of another one, and derivatives by central differences.
template <class Twin, class Part>
void add_twin(py::module_& m, const char* name, const char* argument) {
  py::class_<Twin, Part, std::shared_ptr<Twin>>(m, name, "The part given, with derivatives by central differences.")
      .def(py::init([](const std::shared_ptr<Part>& part) { return std::make_shared<Twin>(part); }),
           py::arg(argument).none(false))
      .def_property(
          "disturbance", [](const Twin& x) { return x.get_disturbance(); },
          [](Twin& x, double disturbance) { x.set_disturbance(disturbance); }, "The step of the differences.");
}

// A part by itself, with the motion of its robots: what an action model has for it.
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

  /// The data after calc or calcDiff at x, u; without u those of a terminal node.
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
auto add_alone(py::module_& m, const char* name, const char* doc) {
  using Class = Alone<Twin, Part>;
  py::class_<Class, std::shared_ptr<Class>> c(m, name, doc);
  c.def(py::init([](const std::shared_ptr<Part>& model) { return std::make_shared<Class>(model); }),
        py::arg("model").none(false))
      .def_property("disturbance", &Class::get_disturbance, &Class::set_disturbance, "The step of the differences.");
  return c;
}

void add_twins_of_parts(py::module_& m) {
  using Cost = Alone<CostModelNumDiff, CostModelAbstract>;
  add_alone<CostModelNumDiff, CostModelAbstract>(
      m, "CostModelNumDiff",
      "A cost by itself, with derivatives by central differences. Without u: in a terminal node.")
      .def(
          "calc", [](Cost& c, const Vector& x, const std::optional<Vector>& u) { return c.at(x, u, false).cost; },
          py::arg("x"), py::arg("u") = py::none(), "Return the cost.")
      .def(
          "calcDiff",
          [](Cost& c, const Vector& x, const std::optional<Vector>& u) {
            const CostDataAbstract& d = c.at(x, u, true);
            return std::make_tuple(Vector(d.Lx), Vector(d.Lu), Matrix(d.Lxx), Matrix(d.Lxu), Matrix(d.Luu));
          },
          py::arg("x"), py::arg("u") = py::none(), "Return Lx, Lu, Lxx, Lxu, Luu; Hessians are Gauss-Newton's.");
  using Constraint = Alone<ConstraintModelNumDiff, ConstraintModelAbstract>;
  add_alone<ConstraintModelNumDiff, ConstraintModelAbstract>(
      m, "ConstraintModelNumDiff",
      "A constraint by itself, with derivatives by central differences. Without u: in a terminal node.")
      .def(
          "calc",
          [](Constraint& c, const Vector& x, const std::optional<Vector>& u) {
            const ConstraintDataAbstract& d = c.at(x, u, false);
            return std::make_tuple(Vector(d.g), Vector(d.h));
          },
          py::arg("x"), py::arg("u") = py::none(), "Return g, h.")
      .def(
          "calcDiff",
          [](Constraint& c, const Vector& x, const std::optional<Vector>& u) {
            const ConstraintDataAbstract& d = c.at(x, u, true);
            return std::make_tuple(Matrix(d.Gx), Matrix(d.Gu), Matrix(d.Hx), Matrix(d.Hu));
          },
          py::arg("x"), py::arg("u") = py::none(), "Return Gx, Gu, Hx, Hu.");
  using Contact = Alone<ContactModelNumDiff, ContactModelAbstract>;
  add_alone<ContactModelNumDiff, ContactModelAbstract>(m, "ContactModelNumDiff",
                                                       "A contact by itself, with derivatives by central differences.")
      .def(
          "calc", [](Contact& c, const Vector& x) { return Vector(c.at(x, {}, false).a0); }, py::arg("x"),
          "Return a0, the contact's acceleration without that of the joints (nc).")
      .def(
          "calcDiff", [](Contact& c, const Vector& x) { return Matrix(c.at(x, {}, true).da0_dx); }, py::arg("x"),
          "Return da0/dx (nc, ndx).");
}

}  // namespace

void add_twins(py::module_& m) {
  add_thrusters(m);
  add_squashing(m);
  add_box_qp(m);
  add_differential_lqr(m);
  add_twin<StateNumDiff, StateAbstract>(m, "StateNumDiff", "state");
  add_twin<ActivationModelNumDiff, ActivationModelAbstract>(m, "ActivationModelNumDiff", "model");
  add_twin<ActuationModelNumDiff, ActuationModelAbstract>(m, "ActuationModelNumDiff", "model");
  add_twin<ResidualModelNumDiff, ResidualModelAbstract>(m, "ResidualModelNumDiff", "model");
  add_twin<ControlParametrizationModelNumDiff, ControlParametrizationModelAbstract>(
      m, "ControlParametrizationModelNumDiff", "model");
  add_twins_of_parts(m);
}

}  // namespace manycontact::python
