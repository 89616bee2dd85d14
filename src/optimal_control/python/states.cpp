#include "action.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact::python {

namespace {

// Checks that x of a StateMultibody contains a configuration and finite velocities. Other states check x themselves.
void judge(const char* function, const char* what, const StateAbstract& state, const ConstVectorRef& x) {
  const auto* own = dynamic_cast<const StateMultibody*>(&state);
  if (!own || x.size() != static_cast<Eigen::Index>(own->get_nx())) return;
  expect_configuration(function, what, x.head(own->get_nq()), own->get_model()->scene());
}

void add_states(py::module_& m) {
  enumeration<Jcomponent, both, first, second>(m);

  shared<Multibody>(m)
      .read<&Multibody::nq, &Multibody::nv, &Multibody::armature, &Multibody::effortLimit>()
      .read("frame_names",
            [](const Multibody& x) {
              std::vector<std::string> names;
              for (const auto& frame : x.frames) names.push_back(frame.name);
              return names;
            })
      .methods<&Multibody::getFrameId, &Multibody::existFrame>();

  using S = StateAbstract;
  auto state = shared<S>(m);
  state.read<&S::get_nx, &S::get_ndx, &S::get_nq, &S::get_nv>();
  add_bounds(state, "lb", &S::get_lb, &S::set_lb, "ub", &S::get_ub, &S::set_ub);
  state.read<&S::get_has_limits>()
      .methods<&S::zero, &S::rand>()
      .def("diff",
           [](const S& s, const ConstVectorRef& x0, const ConstVectorRef& x1) {
             judge("diff", "x0", s, x0), judge("diff", "x1", s, x1);
             return s.diff_dx(x0, x1);
           })
      .def("integrate",
           [](const S& s, const ConstVectorRef& x, const ConstVectorRef& dx) {
             judge("integrate", "x", s, x);
             return s.integrate_x(x, dx);
           })
      .methods("Jdiff", &S::Jdiff_Js, "Jintegrate", &S::Jintegrate_Js);

  shared<StateMultibody, StateAbstract>(m)
      .constructors<void(const Scene&)>()
      .def(py::init([](std::shared_ptr<Model> model) {
        return std::make_shared<StateMultibody>(std::shared_ptr<const Model>(std::move(model)));
      }))
      .read(
          "pinocchio", [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_pinocchio()); },
          "model", [](const StateMultibody& s) { return std::const_pointer_cast<Multibody>(s.get_model()); });
}

using ActuationData = std::shared_ptr<ActuationDataAbstract>;

// A base class for actuations written in Python. T is ActuationModelAbstract, or an actuation class of this library.
template <class T>
class PyActuation : public T {
 public:
  using T::T;
  void calc(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    MANYCONTACT_OVERRIDE(void, T, calc, data, x, u);
  }
  void calc(const ActuationData& data, const ConstVectorRef& x) override { PYBIND11_OVERRIDE(void, T, calc, data, x); }
  void calcDiff(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    MANYCONTACT_OVERRIDE(void, T, calcDiff, data, x, u);
  }
  void calcDiff(const ActuationData& data, const ConstVectorRef& x) override {
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x);
  }
  void commands(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& tau) override {
    MANYCONTACT_OVERRIDE(void, T, commands, data, x, tau);
  }
  void torqueTransform(const ActuationData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    PYBIND11_OVERRIDE(void, T, torqueTransform, data, x, u);
  }
  ActuationData createData() override {
    return made([&]() -> ActuationData { PYBIND11_OVERRIDE(ActuationData, T, createData, ); }());
  }
};

// Adds members that are sparse matrices. Python reads dense copies of them, and assigns dense matrices.
template <class... Given>
void add_matrices(Class<ActuationDataAbstract, ActuationData>& c, Given... given) {
  using D = ActuationDataAbstract;
  const auto add = [&c](const char* name, ActuationMatrix D::*member) {
    c.property(
        name, [member](const D& d) { return Eigen::MatrixXd(d.*member); },
        [name, member](D& d, const Eigen::MatrixXd& values) {
          expect_shape(name, values, d.*member);
          d.*member = values;
        });
  };
  in_groups<2>(add, given...);
}

void add_actuations(py::module_& m) {
  using Abstract = ActuationModelAbstract;
  using State_ = std::shared_ptr<StateAbstract>;
  auto data = shared<ActuationDataAbstract>(m);
  auto model = shared<Abstract, PyActuation<Abstract>>(m);
  data.constructors<void(const Abstract*)>();
  data.views<&ActuationDataAbstract::tau, &ActuationDataAbstract::u>();
  add_matrices(data, "dtau_dx", &ActuationDataAbstract::dtau_dx, "dtau_du", &ActuationDataAbstract::dtau_du, "Mtau",
               &ActuationDataAbstract::Mtau);
  model.constructors<void(State_, std::size_t)>()
      .read<&Abstract::get_nu, &Abstract::get_state>()
      .def("createData", &Abstract::createData)
      .def("calc",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calc))
      .def("calcDiff",
           py::overload_cast<const ActuationData&, const ConstVectorRef&, const ConstVectorRef&>(&Abstract::calcDiff))
      .methods<&Abstract::commands, &Abstract::torqueTransform>()
      .methods("__str__", &text_of<Abstract>);
  shared<ActuationModelSelection, Abstract>(m);
  shared<ActuationModelFull, PyActuation<ActuationModelFull>, ActuationModelSelection>(m).constructors<void(State)>();
  shared<ActuationModelFloatingBase, PyActuation<ActuationModelFloatingBase>, ActuationModelSelection>(m)
      .constructors<void(State)>();
}

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

void add_activation_base(py::module_& m) {
  using Abstract = ActivationModelAbstract;
  auto data = shared<ActivationDataAbstract>(m);
  auto model = shared<Abstract, PyActivation>(m);
  data.def(py::init([](const Abstract& model) { return std::make_shared<ActivationDataAbstract>(model.get_nr()); }))
      .write<&ActivationDataAbstract::a_value>()
      .property(
          "Arr", [](py::object self) { return view(self.cast<ActivationDataAbstract&>().Arr.diagonal(), self, true); },
          [](ActivationDataAbstract& d, py::handle values) { assign(d.Arr.diagonal(), values); });
  data.views<&ActivationDataAbstract::Ar>();

  model.constructors<void(std::size_t)>()
      .read<&Abstract::get_nr>()
      .methods<&Abstract::createData, &Abstract::calc, &Abstract::calcDiff>()
      .methods("__str__", &text_of<Abstract>);

  Class<ActivationBounds> bounds(m, "ActivationBounds");
  add_copy(bounds)
      .def(py::pickle([](const ActivationBounds& b) { return py::make_tuple(copy(b.lb), copy(b.ub), b.beta); },
                      [](const py::tuple& state) {
                        ActivationBounds b(state[0].cast<Bounds>().x, state[1].cast<Bounds>().x);
                        b.beta = state[2].cast<double>();  // lb and ub are already contracted
                        return b;
                      }))
      .def(py::init([](const Bounds& lb, const Bounds& ub, double beta) { return ActivationBounds(lb.x, ub.x, beta); }))
      .read<&ActivationBounds::lb, &ActivationBounds::ub, &ActivationBounds::beta>();
}

void add_activations(py::module_& m) {
  shared<ActivationModelQuad, ActivationModelAbstract>(m).constructors<void(std::size_t)>();
  shared<ActivationModelWeightedQuad, ActivationModelAbstract>(m)
      .constructors<void(const Vector&)>()
      .property<&ActivationModelWeightedQuad::get_weights, &ActivationModelWeightedQuad::set_weights>();
  shared<ActivationModelQuadraticBarrier, ActivationModelAbstract>(m)
      .constructors<void(const ActivationBounds&)>()
      .property(
          "bounds", [](const ActivationModelQuadraticBarrier& a) { return ActivationBounds(a.get_bounds()); },
          &ActivationModelQuadraticBarrier::set_bounds);
  shared<ActivationModelWeightedQuadraticBarrier, ActivationModelQuadraticBarrier>(m)
      .constructors<void(const ActivationBounds&, const Vector&)>();
  shared<ActivationModelSmooth1Norm, ActivationModelAbstract>(m).constructors<void(std::size_t, double)>();
  shared<ActivationModelSmooth2Norm, ActivationModelAbstract>(m).constructors<void(std::size_t, double)>();
  shared<ActivationModel2NormBarrier, ActivationModelAbstract>(m).constructors<void(std::size_t, double, bool)>();
  shared<ActivationModelQuadFlatExp, ActivationModelAbstract>(m).constructors<void(std::size_t, double)>();
  shared<ActivationModelQuadFlatLog, ActivationModelAbstract>(m).constructors<void(std::size_t, double)>();
}

}  // namespace

void add_action_parts(py::module_& m) {
  add_states(m);
  add_actuations(m);
  add_activation_base(m);
  add_activations(m);
}

}  // namespace manycontact::python
