// States, actuations, activations: floor action.

#include "action.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

// ---- states and actuations -----------------------------------------------------------------------------------------

// x of a scene's robots is a configuration and finite velocities; of other states what they say themselves.
void judge(const char* function, const char* what, const StateAbstract& state, const ConstVectorRef& x) {
  const auto* own = dynamic_cast<const StateMultibody*>(&state);
  if (!own || x.size() != static_cast<Eigen::Index>(own->get_nx())) return;
  expect_configuration(function, what, x.head(own->get_nq()), own->get_model()->scene());
}

void add_states(py::module_& m) {
  add_enumeration<Jcomponent>(m, "Jcomponent", "component", "Which of a state's two Jacobians.",
                              {{"both", both}, {"first", first}, {"second", second}});

  py::class_<Multibody, std::shared_ptr<Multibody>>(m, "Multibody", "The robots behind a state, and their frames.")
      .def_readonly("nq", &Multibody::nq)
      .def_readonly("nv", &Multibody::nv)
      .def_readonly("armature", &Multibody::armature, "(nv) [kg m^2, kg]")
      .def_readonly("effortLimit", &Multibody::effortLimit, "(nv) [N m, N], infinite where there is none.")
      .def_property_readonly("frame_names",
                             [](const Multibody& x) {
                               std::vector<std::string> names;
                               for (const auto& frame : x.frames) names.push_back(frame.name);
                               return names;
                             })
      .def("getFrameId", &Multibody::getFrameId, py::arg("name"),
           "Number of a frame: 'left_sole' when there is one robot, else 'r0/left_sole'.")
      .def("existFrame", &Multibody::existFrame, py::arg("name"));

  py::class_<StateAbstract, std::shared_ptr<StateAbstract>>(m, "StateAbstract", "States x (nx), tangents dx (ndx).")
      .def_property_readonly("nx", &StateAbstract::get_nx)
      .def_property_readonly("ndx", &StateAbstract::get_ndx)
      .def_property_readonly("nq", &StateAbstract::get_nq)
      .def_property_readonly("nv", &StateAbstract::get_nv)
      .def_property(
          "lb", &StateAbstract::get_lb, [](StateAbstract& s, const Bounds& b) { s.set_lb(b.x); }, "(nx)")
      .def_property(
          "ub", &StateAbstract::get_ub, [](StateAbstract& s, const Bounds& b) { s.set_ub(b.x); }, "(nx)")
      .def_property_readonly("has_limits", &StateAbstract::get_has_limits)
      .def("zero", &StateAbstract::zero)
      .def("rand", &StateAbstract::rand)
      .def(
          "diff",
          [](const StateAbstract& s, const ConstVectorRef& x0, const ConstVectorRef& x1) {
            judge("diff", "x0", s, x0), judge("diff", "x1", s, x1);
            return s.diff_dx(x0, x1);
          },
          py::arg("x0"), py::arg("x1"), "x1 (-) x0 (ndx).")
      .def(
          "integrate",
          [](const StateAbstract& s, const ConstVectorRef& x, const ConstVectorRef& dx) {
            judge("integrate", "x", s, x);
            return s.integrate_x(x, dx);
          },
          py::arg("x"), py::arg("dx"), "x (+) dx (nx).")
      .def("Jdiff", &StateAbstract::Jdiff_Js, py::arg("x0"), py::arg("x1"),
           py::arg_v("firstsecond", both, "Jcomponent.both"), "List of d diff/dx0, d diff/dx1, (ndx, ndx) each.")
      .def("Jintegrate", &StateAbstract::Jintegrate_Js, py::arg("x"), py::arg("dx"),
           py::arg_v("firstsecond", both, "Jcomponent.both"), "List of d integrate/dx, d integrate/d(dx).");

  py::class_<StateMultibody, StateAbstract, State>(m, "StateMultibody", "x = [q; v] of a scene; dx = [dq; dv].")
      .def(py::init<const Scene&>(), py::arg("scene"))
      .def(py::init([](std::shared_ptr<Model> model) {
             return std::make_shared<StateMultibody>(std::shared_ptr<const Model>(std::move(model)));
           }),
           py::arg("model"))
      .def_property_readonly(
          "pinocchio", [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_pinocchio()); })
      .def_property_readonly("model",
                             [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_model()); });
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
  py::class_<ActuationDataAbstract, ActuationData> data(m, "ActuationDataAbstract");
  py::class_<Abstract, PyActuation<Abstract>, std::shared_ptr<Abstract>> model(
      m, "ActuationModelAbstract",
      "tau(x, u). Derive from it, or from the classes below: calc(self, data, x, u) sets data.tau; calcDiff(self, data,\n"
      "x, u) sets data.dtau_dx, data.dtau_du; commands(self, data, x, tau) sets data.u; torqueTransform(self, data, x, u)\n"
      "sets data.Mtau. createData(self) may return data of a class derived from ActuationDataAbstract.");
  data.def(py::init<const Abstract*>(), py::arg("model").none(false));
  member_view(data, "tau", &ActuationDataAbstract::tau, "Torques (nv) [N m, N].");
  member_view(data, "u", &ActuationDataAbstract::u, "Controls (nu).");
  add_matrix(data, "dtau_dx", &ActuationDataAbstract::dtau_dx, "(nv, ndx): a copy; assign the whole matrix.");
  add_matrix(data, "dtau_du", &ActuationDataAbstract::dtau_du, "(nv, nu): a copy; assign the whole matrix.");
  add_matrix(data, "Mtau", &ActuationDataAbstract::Mtau, "(nu, nv): a copy; assign the whole matrix.");
  model.def(py::init<State_, std::size_t>(), py::arg("state").none(false), py::arg("nu"))
      .def_property_readonly("nu", &Abstract::get_nu)
      .def_property_readonly("state", &Abstract::get_state)
      .def("createData", &Abstract::createData)
      .def("calc",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calc),
           py::arg("data").none(false), py::arg("x"), py::arg("u"), "data.tau.")
      .def("calcDiff",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calcDiff),
           py::arg("data").none(false), py::arg("x"), py::arg("u"), "data.dtau_dx, data.dtau_du.")
      .def("commands", &Abstract::commands, py::arg("data").none(false), py::arg("x"), py::arg("tau"), "data.u.")
      .def("torqueTransform", &Abstract::torqueTransform, py::arg("data").none(false), py::arg("x"), py::arg("u"),
           "data.Mtau: u = Mtau tau.")
      .def("__str__", &text_of<Abstract>);
  py::class_<ActuationModelSelection, Abstract, std::shared_ptr<ActuationModelSelection>>(
      m, "ActuationModelSelection", "u is the torque of a selection of coordinates.");
  py::class_<ActuationModelFull, PyActuation<ActuationModelFull>, ActuationModelSelection,
             std::shared_ptr<ActuationModelFull>>(m, "ActuationModelFull",
                                                  "Every coordinate, floating bases included: nu = nv.")
      .def(py::init<State>(), py::arg("state"));
  py::class_<ActuationModelFloatingBase, PyActuation<ActuationModelFloatingBase>, ActuationModelSelection,
             std::shared_ptr<ActuationModelFloatingBase>>(m, "ActuationModelFloatingBase",
                                                          "All coordinates but the floating bases'.")
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
  py::class_<ActivationDataAbstract, std::shared_ptr<ActivationDataAbstract>> data(m, "ActivationDataAbstract");
  py::class_<Abstract, PyActivation, std::shared_ptr<Abstract>> model(
      m, "ActivationModelAbstract",
      "a(r). Derive from it: calc(self, data, r) sets data.a_value; calcDiff(self, data, r) sets data.Ar, data.Arr.");
  data.def(py::init([](const Abstract& model) { return std::make_shared<ActivationDataAbstract>(model.get_nr()); }),
           py::arg("model"))
      .def_readwrite("a_value", &ActivationDataAbstract::a_value, "a(r): by calc.")
      .def_property(
          "Arr", [](py::object self) { return view(self.cast<ActivationDataAbstract&>().Arr.diagonal(), self, true); },
          [](ActivationDataAbstract& d, py::handle values) { assign(d.Arr.diagonal(), values); },
          "Diagonal of the Hessian (nr): by calcDiff.");
  member_view(data, "Ar", &ActivationDataAbstract::Ar, "Gradient (nr): by calcDiff.");

  model.def(py::init<std::size_t>(), py::arg("nr"))
      .def_property_readonly("nr", &Abstract::get_nr)
      .def("createData", &Abstract::createData)
      .def("calc", &Abstract::calc, py::arg("data").none(false), py::arg("r"))
      .def("calcDiff", &Abstract::calcDiff, py::arg("data").none(false), py::arg("r"))
      .def("__str__", &text_of<Abstract>);

  py::class_<ActivationBounds> bounds(m, "ActivationBounds",
                                      "lb <= r <= ub, drawn in to the middle by beta in [0, 1].");
  add_copy(bounds)
      .def(py::pickle([](const ActivationBounds& b) { return py::make_tuple(copy(b.lb), copy(b.ub), b.beta); },
                      [](const py::tuple& state) {
                        ActivationBounds b(state[0].cast<Bounds>().x, state[1].cast<Bounds>().x);
                        b.beta = state[2].cast<double>();  // which has drawn them in already
                        return b;
                      }))
      .def(py::init([](const Bounds& lb, const Bounds& ub, double beta) { return ActivationBounds(lb.x, ub.x, beta); }),
           py::arg("lb"), py::arg("ub"), py::arg("beta") = 1.0)
      .def_readonly("lb", &ActivationBounds::lb)
      .def_readonly("ub", &ActivationBounds::ub)
      .def_readonly("beta", &ActivationBounds::beta);
}

void add_activations(py::module_& m) {
  activation<ActivationModelQuad>(m, "ActivationModelQuad", "1/2 |r|^2").def(py::init<std::size_t>(), py::arg("nr"));
  activation<ActivationModelWeightedQuad>(m, "ActivationModelWeightedQuad", "1/2 sum w_i r_i^2")
      .def(py::init<const Vector&>(), py::arg("weights"))
      .def_property("weights", &ActivationModelWeightedQuad::get_weights, &ActivationModelWeightedQuad::set_weights);
  activation<ActivationModelQuadraticBarrier>(m, "ActivationModelQuadraticBarrier",
                                              "1/2 |min(r - lb, 0)|^2 + 1/2 |max(r - ub, 0)|^2")
      .def(py::init<const ActivationBounds&>(), py::arg("bounds"))
      .def_property(
          "bounds", [](const ActivationModelQuadraticBarrier& a) { return ActivationBounds(a.get_bounds()); },
          &ActivationModelQuadraticBarrier::set_bounds);
  py::class_<ActivationModelWeightedQuadraticBarrier, ActivationModelQuadraticBarrier,
             std::shared_ptr<ActivationModelWeightedQuadraticBarrier>>(m, "ActivationModelWeightedQuadraticBarrier",
                                                                       "The barrier of w_i r_i outside its bounds.")
      .def(py::init<const ActivationBounds&, const Vector&>(), py::arg("bounds"), py::arg("weights"));
  activation<ActivationModelSmooth1Norm>(m, "ActivationModelSmooth1Norm", "sum sqrt(eps + r_i^2)")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("eps") = 1.0);
  activation<ActivationModelSmooth2Norm>(m, "ActivationModelSmooth2Norm", "sqrt(eps + |r|^2)")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("eps") = 1.0);
  activation<ActivationModel2NormBarrier>(m, "ActivationModel2NormBarrier", "1/2 (|r| - alpha)^2 where |r| < alpha")
      .def(py::init<std::size_t, double, bool>(), py::arg("nr"), py::arg("alpha") = 0.1,
           py::arg("true_hessian") = false);
  activation<ActivationModelQuadFlatExp>(m, "ActivationModelQuadFlatExp", "1 - exp(-|r|^2 / alpha)")
      .def(py::init<std::size_t, double>(), py::arg("nr"), py::arg("alpha") = 1.0);
  activation<ActivationModelQuadFlatLog>(m, "ActivationModelQuadFlatLog", "log(1 + |r|^2 / alpha)")
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
