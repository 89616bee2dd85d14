// What action models are made of: states, actuations, activations, residuals, costs, constraints. Floor action.

#include "action.hpp"
#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/impulse_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/algorithm/frames.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

// ---- states and actuations -----------------------------------------------------------------------------------------

void add_states(py::module_& m) {
  py::enum_<Jcomponent>(m, "Jcomponent").value("both", both).value("first", first).value("second", second);

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
      .def("diff", &StateAbstract::diff_dx, py::arg("x0"), py::arg("x1"), "x1 (-) x0 (ndx).")
      .def("integrate", &StateAbstract::integrate_x, py::arg("x"), py::arg("dx"), "x (+) dx (nx).")
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

void add_actuations(py::module_& m) {
  using Abstract = ActuationModelAbstract;
  py::class_<ActuationDataAbstract, std::shared_ptr<ActuationDataAbstract>> data(m, "ActuationDataAbstract");
  member_view(data, "tau", &ActuationDataAbstract::tau, "Torques (nv) [N m, N].");
  member_view(data, "u", &ActuationDataAbstract::u, "Controls (nu).");
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "ActuationModelAbstract", "tau(x, u).")
      .def_property_readonly("nu", &Abstract::get_nu)
      .def_property_readonly("state", &Abstract::get_state)
      .def("createData", &Abstract::createData)
      .def("calc",
           py::overload_cast<const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&,
                             const ConstVectorRef&>(&Abstract::calc),
           py::arg("data").none(false), py::arg("x"), py::arg("u"), "data.tau.")
      .def("commands", &Abstract::commands, py::arg("data").none(false), py::arg("x"), py::arg("tau"), "data.u.")
      .def("__str__", &text_of<Abstract>);
  py::class_<ActuationModelSelection, Abstract, std::shared_ptr<ActuationModelSelection>>(
      m, "ActuationModelSelection", "u is the torque of a selection of coordinates.");
  py::class_<ActuationModelFull, ActuationModelSelection, std::shared_ptr<ActuationModelFull>>(
      m, "ActuationModelFull", "Every coordinate, floating bases included: nu = nv.")
      .def(py::init<State>(), py::arg("state"));
  py::class_<ActuationModelFloatingBase, ActuationModelSelection, std::shared_ptr<ActuationModelFloatingBase>>(
      m, "ActuationModelFloatingBase", "All coordinates but the floating bases'.")
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

void add_activations(py::module_& m) {
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

  py::class_<ActivationBounds>(m, "ActivationBounds", "lb <= r <= ub, drawn in to the middle by beta in [0, 1].")
      .def(py::init([](const Bounds& lb, const Bounds& ub, double beta) { return ActivationBounds(lb.x, ub.x, beta); }),
           py::arg("lb"), py::arg("ub"), py::arg("beta") = 1.0)
      .def_readonly("lb", &ActivationBounds::lb)
      .def_readonly("ub", &ActivationBounds::ub)
      .def_readonly("beta", &ActivationBounds::beta);

  activation<ActivationModelQuad>(m, "ActivationModelQuad", "1/2 |r|^2").def(py::init<std::size_t>(), py::arg("nr"));
  activation<ActivationModelWeightedQuad>(m, "ActivationModelWeightedQuad", "1/2 sum w_i r_i^2")
      .def(py::init<const Vector&>(), py::arg("weights"))
      .def_property("weights", &ActivationModelWeightedQuad::get_weights, &ActivationModelWeightedQuad::set_weights);
  activation<ActivationModelQuadraticBarrier>(m, "ActivationModelQuadraticBarrier",
                                              "1/2 |min(r - lb, 0)|^2 + 1/2 |max(r - ub, 0)|^2")
      .def(py::init<const ActivationBounds&>(), py::arg("bounds"))
      .def_property("bounds", &ActivationModelQuadraticBarrier::get_bounds,
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

// ---- residuals -----------------------------------------------------------------------------------------------------

// What a residual written in Python sees of the action model, while its calc or calcDiff runs.
class Shared {
 public:
  Shared(DataCollector* collector, const StateMultibody& state) : collector_(collector), state_(state) {}
  void end() { collector_ = nullptr; }
  const DataCollector& get() const {
    if (!collector_) throw py::value_error("data.shared is there while calc and calcDiff run, not later");
    return *collector_;
  }
  const Multibody::BodyFrame& frame(std::size_t id) const {
    (void)get();
    if (id >= state_.get_model()->frames.size()) throw py::value_error("there is no frame " + std::to_string(id));
    return state_.get_model()->frames[id];
  }

 private:
  DataCollector* collector_;
  const StateMultibody& state_;
};

// Calls of Python residuals that run in this thread, innermost last.
struct Running {
  const ResidualDataAbstract* data;
  std::shared_ptr<Shared> shared;
};
thread_local std::vector<Running> running;

struct Scope {
  Scope(const ResidualModelAbstract& model, const ResidualDataAbstract& data) {
    running.push_back({&data, std::make_shared<Shared>(data.shared, *model.get_state())});
  }
  ~Scope() {
    running.back().shared->end();
    running.pop_back();
  }
};

std::shared_ptr<Shared> shared_of(const ResidualDataAbstract& data) {
  for (auto r = running.rbegin(); r != running.rend(); ++r)
    if (r->data == &data) return r->shared;
  throw py::value_error("data.shared is there while calc and calcDiff of a residual written in Python run");
}

struct PyResidual : ResidualModelAbstract {
  using ResidualModelAbstract::ResidualModelAbstract;
  using Base = ResidualModelAbstract;
  using Data = std::shared_ptr<ResidualDataAbstract>;
  void calc(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE_PURE(void, Base, calc, data, x, u);
  }
  void calcDiff(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE_PURE(void, Base, calcDiff, data, x, u);
  }
};

FrameAxes axes_of(ReferenceFrame type) {
  return type == ReferenceFrame::kLocal   ? FrameAxes::kLocal
         : type == ReferenceFrame::kWorld ? FrameAxes::kWorld
                                          : FrameAxes::kLocalWorldAligned;
}

// da/dx (nv, ndx) and da/du (nv, nu) of the last calc.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> acceleration_derivatives(const DataCollector& d) {
  const Eigen::Index nv = d.scene.nv;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(nv, 2 * nv), u = Eigen::MatrixXd::Zero(nv, d.actuation->u.size());
  for (std::size_t i = 0; i < d.islands.size(); ++i) {
    const IslandColumns& at = d.islands[i];
    const PanelView panel = d.panel(i);
    for (std::size_t r = 0; r < at.v.size(); ++r) {
      for (std::size_t c = 0; c < at.x.size(); ++c) x(at.v[r], at.x[c]) = panel(r, c);
      for (std::size_t c = 0; c < at.u.size(); ++c) u(at.v[r], at.u[c]) = panel(r, at.x.size() + c);
    }
  }
  return {std::move(x), std::move(u)};
}

void add_shared(py::module_& m) {
  py::class_<Shared, std::shared_ptr<Shared>>(
      m, "DataCollector", "What a residual sees of its action model, while calc and calcDiff run; copies.")
      .def_property_readonly(
          "acceleration", [](const Shared& s) { return s.get().solution.a; }, "(nv); running nodes.")
      .def_property_readonly(
          "tau", [](const Shared& s) { return s.get().actuation->tau; }, "(nv)")
      .def_property_readonly("report", [](const Shared& s) { return s.get().solution.report; })
      .def(
          "contact_force",
          [](const Shared& s, const std::string& name) {
            const auto& contacts = s.get().contacts->contacts;
            const auto found = contacts.find(name);
            if (found == contacts.end()) throw py::value_error("there is no contact '" + name + "'");
            return found->second->f;
          },
          py::arg("name"), "In the contact's reference frame, on A [N, N m].")
      .def(
          "acceleration_derivatives", [](const Shared& s) { return acceleration_derivatives(s.get()); },
          "(da/dx (nv, ndx), da/du (nv, nu)); in calcDiff of running nodes.")
      .def(
          "frame_placement",
          [](const Shared& s, std::size_t id) {
            const auto& f = s.frame(id);
            return frame_placement<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                           f.placement);
          },
          py::arg("id"), "oMf at x.")
      .def(
          "frame_velocity",
          [](const Shared& s, std::size_t id, ReferenceFrame type) -> Vec6<double> {
            const auto& f = s.frame(id);
            return frame_velocity<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                          f.placement, axes_of(type));
          },
          py::arg("id"), py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.kLocal"),
          "Spatial velocity (6), linear first.")
      .def(
          "frame_jacobian",
          [](const Shared& s, std::size_t id, ReferenceFrame type) {
            const auto& f = s.frame(id);
            const Robot& robot = s.get().scene.robots[f.robot];
            Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, robot.model->nv);
            frame_jacobian<double>(*robot.model, s.get().kinematics(f.robot), robot.base, f.joint, f.placement,
                                   axes_of(type), J);
            Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, s.get().scene.nv);
            out.middleCols(robot.idx_v, robot.model->nv) = J;
            return out;
          },
          py::arg("id"), py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.kLocal"),
          "(6, nv): frame_velocity = J v.");
}

void check_jacobian(const char* name, const Eigen::MatrixXd& J, Eigen::Index rows, Eigen::Index cols) {
  if (J.rows() != rows || J.cols() != cols)
    throw py::value_error(std::string(name) + ": a matrix of shape (" + std::to_string(rows) + ", " +
                          std::to_string(cols) + ") is expected");
}

// The whole matrix into the blocks' rows and columns.
void set_Rx(ResidualDataAbstract& d, const Eigen::MatrixXd& J) {
  const Eigen::MatrixXd now = d.Rx();
  check_jacobian("Rx", J, now.rows(), now.cols());
  for (ResidualBlock& b : d.blocks)
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      for (std::size_t j = 0; j < b.xcols.size(); ++j) b.Rx(i, j) = J(b.rows[i], b.xcols[j]);
}
void set_Ru(ResidualDataAbstract& d, const Eigen::MatrixXd& J) {
  const Eigen::MatrixXd now = d.Ru();
  check_jacobian("Ru", J, now.rows(), now.cols());
  for (ResidualBlock& b : d.blocks)
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      for (std::size_t j = 0; j < b.ucols.size(); ++j) b.Ru(i, j) = J(b.rows[i], b.ucols[j]);
}

template <class T>
auto residual(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, ResidualModelAbstract, std::shared_ptr<T>>(m, name, doc);
}

template <class T, class Class>
void with_reference(Class& c, const char* doc = "") {
  c.def_property(
      "reference", &T::get_reference,
      [](T& r, const std::decay_t<decltype(r.get_reference())>& x) { r.set_reference(x); }, doc);
}

void add_residual_base(py::module_& m) {
  using Abstract = ResidualModelAbstract;
  py::class_<Dependence>(m, "Dependence", "What a residual depends on; what is not said costs nothing.")
      .def(py::init([](bool q, bool v, bool u, bool acceleration, bool forces) {
             return Dependence{q, v, u, acceleration, forces};
           }),
           py::kw_only(), py::arg("q") = false, py::arg("v") = false, py::arg("u") = false,
           py::arg("acceleration") = false, py::arg("forces") = false)
      .def_readwrite("q", &Dependence::q)
      .def_readwrite("v", &Dependence::v)
      .def_readwrite("u", &Dependence::u)
      .def_readwrite("acceleration", &Dependence::acceleration)
      .def_readwrite("forces", &Dependence::forces);

  py::class_<ResidualDataAbstract, std::shared_ptr<ResidualDataAbstract>> data(m, "ResidualDataAbstract");
  data.def_property("Rx", &ResidualDataAbstract::Rx, &set_Rx, "dr/dx (nr, ndx): a copy; assign the whole matrix.")
      .def_property("Ru", &ResidualDataAbstract::Ru, &set_Ru, "dr/du (nr, nu): a copy; assign the whole matrix.")
      .def_property_readonly("shared", &shared_of, "DataCollector, while calc and calcDiff run.");
  member_view(data, "r", &ResidualDataAbstract::r, "(nr): by calc.");

  py::class_<Abstract, PyResidual, std::shared_ptr<Abstract>>(
      m, "ResidualModelAbstract",
      "r(x, u). Derive from it: calc(self, data, x, u) sets data.r; calcDiff(self, data, x, u) sets data.Rx, data.Ru.\n"
      "u is zero in terminal nodes. data.shared has the robots' kinematics.")
      .def(py::init<State, std::size_t, std::size_t, Dependence>(), py::arg("state"), py::arg("nr"), py::arg("nu"),
           py::arg("depends_on"))
      .def_property_readonly("state", &Abstract::get_state)
      .def_property_readonly("nr", &Abstract::get_nr)
      .def_property_readonly("nu", &Abstract::get_nu)
      .def_property_readonly("q_dependent", &Abstract::get_q_dependent)
      .def_property_readonly("v_dependent", &Abstract::get_v_dependent)
      .def_property_readonly("u_dependent", &Abstract::get_u_dependent)
      .def("__str__", &text_of<Abstract>);
}

// With the constructors (state, reference, nu) and (state, reference), nu = nv.
template <class T, class Reference>
void state_and_reference(py::module_& m, const char* name, const char* reference, const char* doc) {
  auto c = residual<T>(m, name, doc);
  c.def(py::init<State, const Reference&, std::size_t>(), py::arg("state"), py::arg(reference), py::arg("nu"))
      .def(py::init<State, const Reference&>(), py::arg("state"), py::arg(reference));
  with_reference<T>(c);
}

// (state, id, reference, nu) and (state, id, reference).
template <class T, class Reference>
void frame_and_reference(py::module_& m, const char* name, const char* reference, const char* doc) {
  auto c = residual<T>(m, name, doc);
  c.def(py::init<State, std::size_t, const Reference&, std::size_t>(), py::arg("state"), py::arg("id"),
        py::arg(reference), py::arg("nu"))
      .def(py::init<State, std::size_t, const Reference&>(), py::arg("state"), py::arg("id"), py::arg(reference))
      .def_property("id", &T::get_id, &T::set_id, "Number of the frame: state.pinocchio.getFrameId(name).");
  with_reference<T>(c);
}

void add_residuals(py::module_& m) {
  {
    auto c = residual<ResidualModelState>(m, "ResidualModelState", "x (-) xref (ndx).");
    c.def(py::init<State, const Vector&, std::size_t>(), py::arg("state"), py::arg("xref"), py::arg("nu"))
        .def(py::init<State, const Vector&>(), py::arg("state"), py::arg("xref"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelState>(c, "(nx)");
  }
  {
    auto c = residual<ResidualModelControl>(m, "ResidualModelControl", "u - uref (nu) [N m, N].");
    c.def(py::init<State, const Vector&>(), py::arg("state"), py::arg("uref"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelControl>(c, "(nu)");
  }
  {
    using Actuation = std::shared_ptr<ActuationModelAbstract>;
    auto c = residual<ResidualModelJointEffort>(m, "ResidualModelJointEffort", "Joint efforts - uref (nu) [N m, N].");
    c.def(py::init<State, Actuation, const Vector&, std::size_t>(), py::arg("state"), py::arg("actuation"),
          py::arg("uref"), py::arg("nu"))
        .def(py::init<State, Actuation, const Vector&>(), py::arg("state"), py::arg("actuation"), py::arg("uref"))
        .def(py::init<State, Actuation, std::size_t>(), py::arg("state"), py::arg("actuation"), py::arg("nu"))
        .def(py::init<State, Actuation>(), py::arg("state"), py::arg("actuation"));
    with_reference<ResidualModelJointEffort>(c, "(nu)");
  }
  {
    auto c = residual<ResidualModelJointAcceleration>(m, "ResidualModelJointAcceleration", "a - aref (nv).");
    c.def(py::init<State, const Vector&, std::size_t>(), py::arg("state"), py::arg("aref"), py::arg("nu"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelJointAcceleration>(c, "(nv)");
  }
  {
    auto c = residual<ResidualModelCoMPosition>(m, "ResidualModelCoMPosition",
                                                "c - cref [m], of the scene, or of one robot by its number.");
    c.def(py::init<State, const Eigen::Vector3d&, std::size_t, int>(), py::arg("state"), py::arg("cref"), py::arg("nu"),
          py::arg("robot") = -1)
        .def(py::init<State, const Eigen::Vector3d&>(), py::arg("state"), py::arg("cref"));
    with_reference<ResidualModelCoMPosition>(c, "(3) [m]");
  }
  {
    auto c = residual<ResidualModelCentroidalMomentum>(
        m, "ResidualModelCentroidalMomentum",
        "Momentum - href, world axes: linear [N s], angular about the CoM [N m s].");
    c.def(py::init<State, const Vec6<double>&, std::size_t, int>(), py::arg("state"), py::arg("href"), py::arg("nu"),
          py::arg("robot") = -1)
        .def(py::init<State, const Vec6<double>&>(), py::arg("state"), py::arg("href"));
    with_reference<ResidualModelCentroidalMomentum>(c, "(6)");
  }
  frame_and_reference<ResidualModelFramePlacement, SE3<double>>(m, "ResidualModelFramePlacement", "pref",
                                                                "log6(pref^-1 oMf) (6).");
  frame_and_reference<ResidualModelFrameTranslation, Eigen::Vector3d>(m, "ResidualModelFrameTranslation", "xref",
                                                                      "p - xref (3) [m].");
  frame_and_reference<ResidualModelFrameRotation, Eigen::Matrix3d>(m, "ResidualModelFrameRotation", "Rref",
                                                                   "log3(Rref^T R) (3) [rad].");
  {
    auto c = residual<ResidualModelFrameVelocity>(m, "ResidualModelFrameVelocity", "The frame's velocity - vref (6).");
    c.def(py::init<State, std::size_t, const Vec6<double>&, ReferenceFrame, std::size_t>(), py::arg("state"),
          py::arg("id"), py::arg("vref"), py::arg("type"), py::arg("nu"))
        .def(py::init<State, std::size_t, const Vec6<double>&, ReferenceFrame>(), py::arg("state"), py::arg("id"),
             py::arg("vref"), py::arg("type"))
        .def_property("id", &ResidualModelFrameVelocity::get_id, &ResidualModelFrameVelocity::set_id)
        .def_property("type", &ResidualModelFrameVelocity::get_type, &ResidualModelFrameVelocity::set_type);
    with_reference<ResidualModelFrameVelocity>(c, "(6)");
  }
  {
    auto c = residual<ResidualModelContactForce>(m, "ResidualModelContactForce", "f - fref (nc) [N, N m].");
    c.def(py::init<State, std::size_t, const Vec6<double>&, std::size_t, std::size_t>(), py::arg("state"),
          py::arg("id"), py::arg("fref"), py::arg("nc"), py::arg("nu"))
        .def(py::init<State, std::size_t, const Vec6<double>&, std::size_t>(), py::arg("state"), py::arg("id"),
             py::arg("fref"), py::arg("nc"));
    with_reference<ResidualModelContactForce>(c, "(6)");
  }
  frame_and_reference<ResidualModelContactFrictionCone, FrictionCone>(m, "ResidualModelContactFrictionCone", "fref",
                                                                      "A f of a friction cone (nf + 1).");
  frame_and_reference<ResidualModelContactWrenchCone, WrenchCone>(m, "ResidualModelContactWrenchCone", "fref",
                                                                  "A f of a wrench cone (nf + 13).");
  frame_and_reference<ResidualModelContactCoPPosition, CoPSupport>(m, "ResidualModelContactCoPPosition", "cref",
                                                                   "A f of a support polygon (4).");
  residual<ResidualModelControlGrav>(m, "ResidualModelControlGrav", "tau - g(q) (nv).")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"));
  residual<ResidualModelContactControlGrav>(m, "ResidualModelContactControlGrav", "tau - (g(q) - J^T f) (nv).")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"));
  residual<ResidualModelImpulseCoM>(m, "ResidualModelImpulseCoM", "The jump of the CoM's velocity (3) [m/s].")
      .def(py::init<State>(), py::arg("state"));
}

void add_cones(py::module_& m) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const double inf = std::numeric_limits<double>::infinity();
  const auto infinite = py::arg_v("max_nforce", inf, "float('inf')");
  py::class_<FrictionCone>(m, "FrictionCone", "lb <= A f <= ub on a force (3): nf facets and the normal force.")
      .def(py::init<const Eigen::Matrix3d&, double, std::size_t, bool, double, double>(),
           py::arg_v("R", I, "numpy.eye(3)"), py::arg("mu") = 0.7, py::arg("nf") = 4, py::arg("inner_appr") = true,
           py::arg("min_nforce") = 0.0, infinite, "R: the cone's axes in the axes of f, z the normal. Forces in N.")
      .def("update", &FrictionCone::update, "Setters take effect.")
      .def_property_readonly("A", [](const FrictionCone& c) { return Eigen::MatrixXd(c.get_A()); })
      .def_property_readonly("lb", &FrictionCone::get_lb)
      .def_property_readonly("ub", &FrictionCone::get_ub)
      .def_property_readonly("nf", &FrictionCone::get_nf)
      .def_property("R", &FrictionCone::get_R, &FrictionCone::set_R)
      .def_property("mu", &FrictionCone::get_mu, &FrictionCone::set_mu)
      .def("__str__", &text_of<FrictionCone>);
  py::class_<WrenchCone>(m, "WrenchCone", "lb <= A w <= ub on a wrench (6) of a rectangular foot: nf + 13 rows.")
      .def(py::init<const Eigen::Matrix3d&, double, const Eigen::Vector2d&, std::size_t, bool, double, double>(),
           py::arg("R"), py::arg("mu"), py::arg("box"), py::arg("nf") = 4, py::arg("inner_appr") = true,
           py::arg("min_nforce") = 0.0, infinite, "box: length and width [m].")
      .def("update", &WrenchCone::update, "Setters take effect.")
      .def_property_readonly("A", [](const WrenchCone& c) { return Eigen::MatrixXd(c.get_A()); })
      .def_property_readonly("lb", &WrenchCone::get_lb)
      .def_property_readonly("ub", &WrenchCone::get_ub)
      .def_property_readonly("nf", &WrenchCone::get_nf)
      .def_property("R", &WrenchCone::get_R, &WrenchCone::set_R)
      .def_property("mu", &WrenchCone::get_mu, &WrenchCone::set_mu)
      .def_property("box", &WrenchCone::get_box, &WrenchCone::set_box)
      .def("__str__", &text_of<WrenchCone>);
  py::class_<CoPSupport>(m, "CoPSupport", "lb <= A w <= ub on a wrench (6): centre of pressure inside the box.")
      .def(py::init<const Eigen::Matrix3d&, const Eigen::Vector2d&>(), py::arg("R"), py::arg("box"))
      .def_property_readonly("A", [](const CoPSupport& c) { return Eigen::MatrixXd(c.get_A()); })
      .def_property_readonly("lb", [](const CoPSupport& c) { return Vector(c.get_lb()); })
      .def_property_readonly("ub", [](const CoPSupport& c) { return Vector(c.get_ub()); })
      .def("__str__", &text_of<CoPSupport>);
}

// ---- costs and constraints -----------------------------------------------------------------------------------------

void add_costs(py::module_& m) {
  using Activation = std::shared_ptr<ActivationModelAbstract>;
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  py::class_<CostDataResidual, std::shared_ptr<CostDataResidual>>(m, "CostDataResidual", "One cost's own numbers.")
      .def_readonly("cost", &CostDataResidual::cost)
      .def_readonly("activation", &CostDataResidual::activation)
      .def_readonly("residual", &CostDataResidual::residual)
      .def_property_readonly("Lx", &CostDataResidual::Lx, "(ndx), without the weight.")
      .def_property_readonly("Lu", &CostDataResidual::Lu, "(nu)")
      .def_property_readonly("Lxx", &CostDataResidual::Lxx, "(ndx, ndx), Gauss-Newton.")
      .def_property_readonly("Lxu", &CostDataResidual::Lxu, "(ndx, nu)")
      .def_property_readonly("Luu", &CostDataResidual::Luu, "(nu, nu)");
  py::class_<CostModelResidual, std::shared_ptr<CostModelResidual>>(
      m, "CostModelResidual", "The cost a(r(x, u)); without an activation 1/2 |r|^2.")
      .def(py::init<State, Activation, Residual>(), py::arg("state"), py::arg("activation").none(false),
           py::arg("residual").none(false))
      .def(py::init<State, Residual>(), py::arg("state"), py::arg("residual").none(false))
      .def_property_readonly("state", &CostModelResidual::get_state)
      .def_property_readonly("activation", &CostModelResidual::get_activation)
      .def_property_readonly("residual", &CostModelResidual::get_residual)
      .def_property_readonly("nu", &CostModelResidual::get_nu)
      .def("__str__", &text_of<CostModelResidual>);
  py::class_<CostItem, std::shared_ptr<CostItem>>(m, "CostItem")
      .def_readonly("name", &CostItem::name)
      .def_readonly("cost", &CostItem::cost)
      .def_readwrite("weight", &CostItem::weight)
      .def_readonly("active", &CostItem::active);
  using Sum = CostModelSum;
  py::class_<Sum, std::shared_ptr<Sum>>(m, "CostModelSum", "Costs by name, summed with weights.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addCost", &Sum::addCost, py::arg("name"), py::arg("cost").none(false), py::arg("weight"),
           py::arg("active") = true)
      .def("removeCost", &Sum::removeCost, py::arg("name"))
      .def("changeCostStatus", &Sum::changeCostStatus, py::arg("name"), py::arg("active"))
      .def("getCostStatus", &Sum::getCostStatus, py::arg("name"))
      .def_property_readonly("state", &Sum::get_state)
      .def_property_readonly("costs", &Sum::get_costs, "{name: CostItem}")
      .def_property_readonly("nu", &Sum::get_nu)
      .def_property_readonly("nr", &Sum::get_nr)
      .def_property_readonly("active_set", &Sum::get_active_set)
      .def_property_readonly("inactive_set", &Sum::get_inactive_set)
      .def("__str__", &text_of<Sum>);
  m.attr("CostModelAbstract") = m.attr("CostModelResidual");
}

void add_constraints(py::module_& m) {
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using One = ConstraintModelResidual;
  py::class_<One, std::shared_ptr<One>>(
      m, "ConstraintModelResidual", "lower <= r(x, u) <= upper; equality where the bounds are equal, r = 0 without.")
      .def(py::init([](State state, Residual residual, const Bounds& lower, const Bounds& upper, bool T_act) {
             return std::make_shared<One>(std::move(state), std::move(residual), lower.x, upper.x, T_act);
           }),
           py::arg("state"), py::arg("residual").none(false), py::arg("lower"), py::arg("upper"),
           py::arg("T_act") = true)
      .def(py::init<State, Residual, bool>(), py::arg("state"), py::arg("residual").none(false),
           py::arg("T_act") = true)
      .def_property_readonly("residual", &One::get_residual)
      .def_property_readonly("ng", &One::get_ng)
      .def_property_readonly("nh", &One::get_nh)
      .def_property_readonly("lb", &One::get_lb, "(nr)")
      .def_property_readonly("ub", &One::get_ub, "(nr)")
      .def("__str__", &text_of<One>);
  using Manager = ConstraintModelManager;
  py::class_<Manager, std::shared_ptr<Manager>>(m, "ConstraintModelManager", "Constraints by name.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addConstraint", &Manager::addConstraint, py::arg("name"), py::arg("constraint").none(false),
           py::arg("active") = true)
      .def("removeConstraint", &Manager::removeConstraint, py::arg("name"))
      .def("changeConstraintStatus", &Manager::changeConstraintStatus, py::arg("name"), py::arg("active"))
      .def("getConstraintStatus", &Manager::getConstraintStatus, py::arg("name"))
      .def_property_readonly("ng", &Manager::get_ng)
      .def_property_readonly("nh", &Manager::get_nh)
      .def_property_readonly("ng_T", &Manager::get_ng_T)
      .def_property_readonly("nh_T", &Manager::get_nh_T)
      .def_property_readonly("lb", &Manager::get_lb, "(ng)")
      .def_property_readonly("ub", &Manager::get_ub, "(ng)")
      .def_property_readonly("active_set", &Manager::get_active_set)
      .def_property_readonly("inactive_set", &Manager::get_inactive_set)
      .def("__str__", &text_of<Manager>);
}

}  // namespace

void add_action_parts(py::module_& m) {
  add_states(m);
  add_actuations(m);
  add_activations(m);
  add_cones(m);
  add_shared(m);
  add_residual_base(m);
  add_residuals(m);
  add_costs(m);
  add_constraints(m);
}

}  // namespace manycontact::python
