// States, actuations and activations.

#include "action.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

// ---- states and actuations -----------------------------------------------------------------------------------------

// x of a scene's robots is a configuration and finite velocities. Other states check x themselves.
void judge(const char* function, const char* what, const StateAbstract& state, const ConstVectorRef& x) {
  const auto* own = dynamic_cast<const StateMultibody*>(&state);
  if (!own || x.size() != static_cast<Eigen::Index>(own->get_nx())) return;
  expect_configuration(function, what, x.head(own->get_nq()), own->get_model()->scene());
}

void add_states(py::module_& m) {
  add_enumeration<Jcomponent>(m, "Jcomponent", "component", "Selects one or both Jacobians of a state.",
                              {{"both", both}, {"first", first}, {"second", second}});

  py::class_<Multibody, std::shared_ptr<Multibody>>(m, "Multibody", "The robots of a state, and their frames.")
      .def_readonly("nq", &Multibody::nq, "Number of configuration coordinates.")
      .def_readonly("nv", &Multibody::nv, "Number of velocity coordinates.")
      .def_readonly("armature", &Multibody::armature, "Reflected rotor inertia (nv) [kg m^2, kg].")
      .def_readonly("effortLimit", &Multibody::effortLimit, "Effort limits (nv) [N m, N]; inf: none.")
      .def_property_readonly(
          "frame_names",
          [](const Multibody& x) {
            std::vector<std::string> names;
            for (const auto& frame : x.frames) names.push_back(frame.name);
            return names;
          },
          "Names of the frames, in the order of their numbers.")
      .def("getFrameId", &Multibody::getFrameId, py::arg("name"),
           "Return the number of a frame: 'r0/left_sole', or 'left_sole' if there is only one robot.")
      .def("existFrame", &Multibody::existFrame, py::arg("name"), "Return whether there is a frame with this name.");

  py::class_<StateAbstract, std::shared_ptr<StateAbstract>>(
      m, "StateAbstract", "A manifold of states x (nx) with tangent vectors dx (ndx).")
      .def_property_readonly("nx", &StateAbstract::get_nx, "Numbers of a state.")
      .def_property_readonly("ndx", &StateAbstract::get_ndx, "Numbers of a tangent vector.")
      .def_property_readonly("nq", &StateAbstract::get_nq, "Number of configuration coordinates.")
      .def_property_readonly("nv", &StateAbstract::get_nv, "Number of velocity coordinates.")
      .def_property(
          "lb", &StateAbstract::get_lb, [](StateAbstract& s, const Bounds& b) { s.set_lb(b.x); },
          "Lower bounds (nx); -inf: none.")
      .def_property(
          "ub", &StateAbstract::get_ub, [](StateAbstract& s, const Bounds& b) { s.set_ub(b.x); },
          "Upper bounds (nx); inf: none.")
      .def_property_readonly("has_limits", &StateAbstract::get_has_limits, "Whether any bound is finite.")
      .def("zero", &StateAbstract::zero, "Return the neutral state (nx).")
      .def("rand", &StateAbstract::rand, "Return a random state (nx).")
      .def(
          "diff",
          [](const StateAbstract& s, const ConstVectorRef& x0, const ConstVectorRef& x1) {
            judge("diff", "x0", s, x0), judge("diff", "x1", s, x1);
            return s.diff_dx(x0, x1);
          },
          py::arg("x0"), py::arg("x1"), "Return x1 (-) x0 (ndx).")
      .def(
          "integrate",
          [](const StateAbstract& s, const ConstVectorRef& x, const ConstVectorRef& dx) {
            judge("integrate", "x", s, x);
            return s.integrate_x(x, dx);
          },
          py::arg("x"), py::arg("dx"), "Return x (+) dx (nx).")
      .def("Jdiff", &StateAbstract::Jdiff_Js, py::arg("x0"), py::arg("x1"),
           py::arg_v("firstsecond", both, "Jcomponent.both"),
           "Return a list of d diff/dx0 and d diff/dx1, (ndx, ndx) each.")
      .def("Jintegrate", &StateAbstract::Jintegrate_Js, py::arg("x"), py::arg("dx"),
           py::arg_v("firstsecond", both, "Jcomponent.both"),
           "Return a list of d integrate/dx and d integrate/d(dx), (ndx, ndx) each.");

  py::class_<StateMultibody, StateAbstract, State>(m, "StateMultibody",
                                                   "The states x = [q; v] of a scene, with dx = [dq; dv].")
      .def(py::init<const Scene&>(), py::arg("scene"))
      .def(py::init([](std::shared_ptr<Model> model) {
             return std::make_shared<StateMultibody>(std::shared_ptr<const Model>(std::move(model)));
           }),
           py::arg("model"))
      .def_property_readonly(
          "pinocchio", [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_pinocchio()); },
          "Multibody: the robots and their frames; Crocoddyl's name.")
      .def_property_readonly(
          "model", [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_model()); },
          "Multibody: the robots and their frames.");
}

using ActuationData = std::shared_ptr<ActuationDataAbstract>;

// A class to derive from. T: ActuationModelAbstract, or a class of the library's.
template <class T>
class PyActuation : public T {
 public:
  using T::T;
  void calc(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    if constexpr (std::is_abstract_v<T>) {
      PYBIND11_OVERRIDE_PURE(void, T, calc, data, x, u);
    } else {
      PYBIND11_OVERRIDE(void, T, calc, data, x, u);
    }
  }
  void calc(const ActuationData& data, const ConstVectorRef& x) override { PYBIND11_OVERRIDE(void, T, calc, data, x); }
  void calcDiff(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    if constexpr (std::is_abstract_v<T>) {
      PYBIND11_OVERRIDE_PURE(void, T, calcDiff, data, x, u);
    } else {
      PYBIND11_OVERRIDE(void, T, calcDiff, data, x, u);
    }
  }
  void calcDiff(const ActuationData& data, const ConstVectorRef& x) override {
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x);
  }
  void commands(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& tau) override {
    if constexpr (std::is_abstract_v<T>) {
      PYBIND11_OVERRIDE_PURE(void, T, commands, data, x, tau);
    } else {
      PYBIND11_OVERRIDE(void, T, commands, data, x, tau);
    }
  }
  void torqueTransform(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    PYBIND11_OVERRIDE(void, T, torqueTransform, data, x, u);
  }
  ActuationData createData() override {
    return made([&]() -> ActuationData { PYBIND11_OVERRIDE(ActuationData, T, createData, ); }());
  }
};

// A sparse matrix as a whole one: a copy; assignment takes the numbers of a whole one.
template <class Class>
void add_matrix(Class& c, const char* name, ActuationMatrix ActuationDataAbstract::*member, const char* doc) {
  c.def_property(
      name, [member](const ActuationDataAbstract& d) { return Eigen::MatrixXd(d.*member); },
      [name, member](ActuationDataAbstract& d, const Eigen::MatrixXd& values) {
        ActuationMatrix& matrix = d.*member;
        if (values.rows() != matrix.rows() || values.cols() != matrix.cols())
          throw py::value_error(std::string(name) + ": a matrix of shape (" + std::to_string(matrix.rows()) + ", " +
                                std::to_string(matrix.cols()) + ") is expected");
        matrix = values;
      },
      doc);
}

void add_actuations(py::module_& m) {
  using Abstract = ActuationModelAbstract;
  using State_ = std::shared_ptr<StateAbstract>;
  py::class_<ActuationDataAbstract, ActuationData> data(m, "ActuationDataAbstract", "Torques and their derivatives.");
  py::class_<Abstract, PyActuation<Abstract>, std::shared_ptr<Abstract>> model(
      m, "ActuationModelAbstract",
      "A function tau(x, u) from controls to torques.\n"
      "\n"
      "In a derived class `calc(self, data, x, u)` sets data.tau. `calcDiff(self, data, x, u)` sets data.dtau_dx and\n"
      "data.dtau_du. `commands(self, data, x, tau)` sets data.u. `torqueTransform(self, data, x, u)` sets data.Mtau.\n"
      "`createData(self)` may return data of a class derived from ActuationDataAbstract.");
  data.def(py::init<const Abstract*>(), py::arg("model").none(false));
  member_view(data, "tau", &ActuationDataAbstract::tau, "Torques (nv) [N m, N]; set by calc.");
  member_view(data, "u", &ActuationDataAbstract::u, "Controls (nu); set by commands.");
  add_matrix(data, "dtau_dx", &ActuationDataAbstract::dtau_dx,
             "Derivative (nv, ndx); a copy: assign the whole matrix.");
  add_matrix(data, "dtau_du", &ActuationDataAbstract::dtau_du, "Derivative (nv, nu); a copy: assign the whole matrix.");
  add_matrix(data, "Mtau", &ActuationDataAbstract::Mtau,
             "Matrix (nu, nv) with u = Mtau tau; a copy: assign the whole matrix.");
  model.def(py::init<State_, std::size_t>(), py::arg("state").none(false), py::arg("nu"))
      .def_property_readonly("nu", &Abstract::get_nu, "Number of controls.")
      .def_property_readonly("state", &Abstract::get_state, "StateAbstract that it was made for.")
      .def("createData", &Abstract::createData, "Create data of this model.")
      .def("calc",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calc),
           py::arg("data").none(false), py::arg("x"), py::arg("u"), "data.tau.")
      .def("calcDiff",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calcDiff),
           py::arg("data").none(false), py::arg("x"), py::arg("u"), "Compute data.dtau_dx and data.dtau_du.")
      .def("commands", &Abstract::commands, py::arg("data").none(false), py::arg("x"), py::arg("tau"), "data.u.")
      .def("torqueTransform", &Abstract::torqueTransform, py::arg("data").none(false), py::arg("x"), py::arg("u"),
           "Compute data.Mtau with u = Mtau tau.")
      .def("__str__", &text_of<Abstract>);
  py::class_<ActuationModelSelection, Abstract, std::shared_ptr<ActuationModelSelection>>(
      m, "ActuationModelSelection", "An actuation whose controls are the torques of selected coordinates.");
  py::class_<ActuationModelFull, PyActuation<ActuationModelFull>, ActuationModelSelection,
             std::shared_ptr<ActuationModelFull>>(m, "ActuationModelFull",
                                                  "Actuates every coordinate, floating bases included: nu = nv.")
      .def(py::init<State>(), py::arg("state"));
  py::class_<ActuationModelFloatingBase, PyActuation<ActuationModelFloatingBase>, ActuationModelSelection,
             std::shared_ptr<ActuationModelFloatingBase>>(
      m, "ActuationModelFloatingBase", "Actuates all coordinates except those of floating bases and passive joints.")
      .def(py::init<State>(), py::arg("state"));
}

// ---- activations ---------------------------------------------------------------------------------------------------

struct PyActivation : ActivationModelAbstract {
  using ActivationModelAbstract::ActivationModelAbstract;
  using Data = std::shared_ptr<ActivationDataAbstract>;
  void calc(const Data& data, const ConstVectorRef& r) override {
    PYBIND11_OVERRIDE_PURE(void, ActivationModelAbstract, calc, data, r);
  }
  void calcDiff(const Data& data, const ConstVectorRef& r) override {
    PYBIND11_OVERRIDE_PURE(void, ActivationModelAbstract, calcDiff, data, r);
  }
  Data createData() override {
    return made([&]() -> Data { PYBIND11_OVERRIDE(Data, ActivationModelAbstract, createData, ); }());
  }
};

template <class T>
auto activation(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, ActivationModelAbstract, std::shared_ptr<T>>(m, name, doc);
}

void add_activation_base(py::module_& m) {
  using Abstract = ActivationModelAbstract;
  py::class_<ActivationDataAbstract, std::shared_ptr<ActivationDataAbstract>> data(
      m, "ActivationDataAbstract", "The value of an activation and its derivatives.");
  py::class_<Abstract, PyActivation, std::shared_ptr<Abstract>> model(
      m, "ActivationModelAbstract",
      "An activation a(r).\n"
      "\n"
      "In a derived class calc(self, data, r) sets data.a_value, and calcDiff(self, data, r) sets data.Ar and\n"
      "data.Arr.");
  data.def(py::init([](const Abstract& model) { return std::make_shared<ActivationDataAbstract>(model.get_nr()); }),
           py::arg("model"))
      .def_readwrite("a_value", &ActivationDataAbstract::a_value, "Value a(r); set by calc.")
      .def_property(
          "Arr", [](py::object self) { return view(self.cast<ActivationDataAbstract&>().Arr.diagonal(), self, true); },
          [](ActivationDataAbstract& d, py::handle values) { assign(d.Arr.diagonal(), values); },
          "Diagonal of the Hessian (nr); set by calcDiff.");
  member_view(data, "Ar", &ActivationDataAbstract::Ar, "Gradient (nr); set by calcDiff.");

  model.def(py::init<std::size_t>(), py::arg("nr"))
      .def_property_readonly("nr", &Abstract::get_nr, "Number of rows of the residual.")
      .def("createData", &Abstract::createData, "Create data of this model.")
      .def("calc", &Abstract::calc, py::arg("data").none(false), py::arg("r"),
           "Compute data.a_value from the residual r (nr).")
      .def("calcDiff", &Abstract::calcDiff, py::arg("data").none(false), py::arg("r"),
           "Compute data.Ar and data.Arr at the last calc.")
      .def("__str__", &text_of<Abstract>);

  py::class_<ActivationBounds> bounds(m, "ActivationBounds",
                                      "Bounds lb <= r <= ub, contracted towards their middle by beta in [0, 1].");
  add_copy(bounds)
      .def(py::pickle([](const ActivationBounds& b) { return py::make_tuple(copy(b.lb), copy(b.ub), b.beta); },
                      [](const py::tuple& state) {
                        ActivationBounds b(state[0].cast<Bounds>().x, state[1].cast<Bounds>().x);
                        b.beta = state[2].cast<double>();  // lb and ub are contracted already
                        return b;
                      }))
      .def(py::init([](const Bounds& lb, const Bounds& ub, double beta) { return ActivationBounds(lb.x, ub.x, beta); }),
           py::arg("lb"), py::arg("ub"), py::arg("beta") = 1.0)
      .def_readonly("lb", &ActivationBounds::lb, "Lower bounds.")
      .def_readonly("ub", &ActivationBounds::ub, "Upper bounds.")
      .def_readonly("beta", &ActivationBounds::beta,
                    "Factor in [0, 1] by which finite pairs of bounds are contracted.");
}

void add_activations(py::module_& m) {
  activation<ActivationModelQuad>(m, "ActivationModelQuad", "The activation 1/2 |r|^2.")
      .def(py::init<std::size_t>(), py::arg("nr"));
  activation<ActivationModelWeightedQuad>(m, "ActivationModelWeightedQuad", "The activation 1/2 sum w_i r_i^2.")
      .def(py::init<const Vector&>(), py::arg("weights"))
      .def_property("weights", &ActivationModelWeightedQuad::get_weights, &ActivationModelWeightedQuad::set_weights,
                    "One weight per row (nr).");
  activation<ActivationModelQuadraticBarrier>(m, "ActivationModelQuadraticBarrier",
                                              "The activation 1/2 |min(r - lb, 0)|^2 + 1/2 |max(r - ub, 0)|^2.")
      .def(py::init<const ActivationBounds&>(), py::arg("bounds"))
      .def_property(
          "bounds", [](const ActivationModelQuadraticBarrier& a) { return ActivationBounds(a.get_bounds()); },
          &ActivationModelQuadraticBarrier::set_bounds, "ActivationBounds.");
  py::class_<ActivationModelWeightedQuadraticBarrier, ActivationModelQuadraticBarrier,
             std::shared_ptr<ActivationModelWeightedQuadraticBarrier>>(
      m, "ActivationModelWeightedQuadraticBarrier",
      "The activation 1/2 |w min(r - lb, 0)|^2 + 1/2 |w max(r - ub, 0)|^2.")
      .def(py::init<const ActivationBounds&, const Vector&>(), py::arg("bounds"), py::arg("weights"));
  activation<ActivationModelSmooth1Norm>(m, "ActivationModelSmooth1Norm", "The activation sum sqrt(eps + r_i^2).")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("eps") = 1.0);
  activation<ActivationModelSmooth2Norm>(m, "ActivationModelSmooth2Norm", "The activation sqrt(eps + |r|^2).")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("eps") = 1.0);
  activation<ActivationModel2NormBarrier>(m, "ActivationModel2NormBarrier",
                                          "The activation 1/2 (|r| - alpha)^2 if |r| < alpha, otherwise 0.")
      .def(py::init<std::size_t, double, bool>(), py::arg("nr"), py::arg("alpha") = 0.1,
           py::arg("true_hessian") = false);
  activation<ActivationModelQuadFlatExp>(m, "ActivationModelQuadFlatExp", "The activation 1 - exp(-|r|^2 / alpha).")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("alpha") = 1.0);
  activation<ActivationModelQuadFlatLog>(m, "ActivationModelQuadFlatLog", "The activation log(1 + |r|^2 / alpha).")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("alpha") = 1.0);
}

}  // namespace

void add_action_parts(py::module_& m) {
  add_states(m);
  add_actuations(m);
  add_activation_base(m);
  add_activations(m);
}

}  // namespace manycontact::python
