// Residuals of costs and constraints.

#include "action.hpp"
#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/impulse_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/algorithm/frames.hpp"
#include "shared.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;

// Calls of Python's that run in this thread, innermost last.
struct Running {
  const void* data;
  std::shared_ptr<Shared> shared;
};
thread_local std::vector<Running> running;

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
  Data createData(DataCollector* collector) override {
    Data data = created_in_python<Base, ResidualDataAbstract>(this, collector);
    if (!data) return Base::createData(collector);
    lay_out(*data);
    return data;
  }
};

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
      m, "DataCollector",
      "The data of an action model that residuals and costs depend on, while calc, calcDiff and createData run;\n"
      "copies.")
      .def_property_readonly(
          "acceleration", [](const Shared& s) { return s.get().solution.a; },
          "Accelerations (nv) [m/s^2, rad/s^2], in running nodes.")
      .def_property_readonly(
          "tau", [](const Shared& s) { return s.get().actuation->tau; }, "Torques (nv) [N m, N]; set by calc.")
      .def_property_readonly(
          "report", [](const Shared& s) { return s.get().solution.report; }, "Report of the solve.")
      .def(
          "contact_force",
          [](const Shared& s, const std::string& name) -> Vector {
            const auto& contacts = s.get().contacts->contacts;
            const auto found = contacts.find(name);
            if (found == contacts.end()) throw py::value_error("there is no contact '" + name + "'");
            return found->second->f;
          },
          py::arg("name"), "Return the force on A in the contact's reference frame [N, N m].")
      .def(
          "acceleration_derivatives", [](const Shared& s) { return acceleration_derivatives(s.get()); },
          "Return da/dx (nv, ndx) and da/du (nv, nu), in calcDiff of running nodes.")
      .def(
          "frame_placement",
          [](const Shared& s, std::size_t id) {
            const auto& f = s.frame(id);
            return frame_placement<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                           f.placement);
          },
          py::arg("id"), "Return the placement oMf (SE3) of a frame at x.")
      .def(
          "frame_velocity",
          [](const Shared& s, std::size_t id, ReferenceFrame type) -> Vec6<double> {
            const auto& f = s.frame(id);
            return frame_velocity<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                          f.placement, type);
          },
          py::arg("id"), py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"),
          "Return the spatial velocity (6) of a frame, linear part first.")
      .def(
          "frame_jacobian",
          [](const Shared& s, std::size_t id, ReferenceFrame type) {
            const auto& f = s.frame(id);
            const Robot& robot = s.get().scene.robots[f.robot];
            Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, robot.model->nv);
            frame_jacobian<double>(*robot.model, s.get().kinematics(f.robot), robot.base, f.joint, f.placement, type,
                                   J);
            Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, s.get().scene.nv);
            out.middleCols(robot.idx_v, robot.model->nv) = J;
            return out;
          },
          py::arg("id"), py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"),
          "Return the Jacobian (6, nv) of a frame: frame_velocity = J v.");
}

void check_jacobian(const char* name, const Eigen::MatrixXd& J, Eigen::Index rows, Eigen::Index cols) {
  if (J.rows() != rows || J.cols() != cols)
    throw py::value_error(std::string(name) + ": a matrix of shape (" + std::to_string(rows) + ", " +
                          std::to_string(cols) + ") is expected");
}

// The whole matrix: a view where the data have it (of a user's own cost), else a copy of the blocks.
py::array whole(py::object self, Eigen::MatrixXd ResidualDataAbstract::*member,
                Eigen::MatrixXd (ResidualDataAbstract::*made)() const) {
  auto& d = self.cast<ResidualDataAbstract&>();
  return (d.*member).size() > 0 ? view(d.*member, self, true) : read_only(copy((d.*made)()));
}
py::array get_Rx(py::object self) {
  return whole(std::move(self), &ResidualDataAbstract::Rx, &ResidualDataAbstract::whole_Rx);
}
py::array get_Ru(py::object self) {
  return whole(std::move(self), &ResidualDataAbstract::Ru, &ResidualDataAbstract::whole_Ru);
}

void check_taken(const char* name, const Eigen::MatrixXd& taken, const Eigen::MatrixXd& J) {
  if (taken != J)
    throw py::value_error(std::string(name) + ": entries that this residual's derivatives never have are not zero");
}

// The whole matrix into the blocks' rows and columns.
void set_Rx(ResidualDataAbstract& d, const Eigen::MatrixXd& J) {
  const Eigen::MatrixXd now = d.whole_Rx();
  check_jacobian("Rx", J, now.rows(), now.cols());
  if (d.Rx.size() > 0) d.Rx = J;
  for (ResidualBlock& b : d.blocks)
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      for (std::size_t j = 0; j < b.xcols.size(); ++j) b.Rx(i, j) = J(b.rows[i], b.xcols[j]);
  check_taken("Rx", d.whole_Rx(), J);
}
void set_Ru(ResidualDataAbstract& d, const Eigen::MatrixXd& J) {
  const Eigen::MatrixXd now = d.whole_Ru();
  check_jacobian("Ru", J, now.rows(), now.cols());
  if (d.Ru.size() > 0) d.Ru = J;
  for (ResidualBlock& b : d.blocks)
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      for (std::size_t j = 0; j < b.ucols.size(); ++j) b.Ru(i, j) = J(b.rows[i], b.ucols[j]);
  check_taken("Ru", d.whole_Ru(), J);
}

template <class T>
auto residual(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, ResidualModelAbstract, std::shared_ptr<T>>(m, name, doc);
}

// Cones are the residual's own, which setting their members changes; other references are copies.
template <class T, class Class>
void with_reference(Class& c, const char* doc) {
  using X = std::decay_t<decltype(std::declval<T&>().get_reference())>;
  using Given = std::conditional_t<is_matrix<X> || std::is_same_v<X, SE3<double>>, X, const X&>;
  c.def_property(
      "reference", [](const T& r) -> Given { return r.get_reference(); }, [](T& r, const X& x) { r.set_reference(x); },
      doc);
}

void add_residual_base(py::module_& m) {
  using Abstract = ResidualModelAbstract;
  py::class_<Dependence> dependence(m, "Dependence", "The variables that a residual depends on; others cost nothing.");
  add_value(dependence)
      .def(py::init([](bool q, bool v, bool u, bool acceleration, bool forces) {
             return Dependence{q, v, u, acceleration, forces};
           }),
           py::kw_only(), py::arg("q") = false, py::arg("v") = false, py::arg("u") = false,
           py::arg("acceleration") = false, py::arg("forces") = false)
      .def_readwrite("q", &Dependence::q, "On the configuration.")
      .def_readwrite("v", &Dependence::v, "On the velocity.")
      .def_readwrite("u", &Dependence::u, "On the controls.")
      .def_readwrite("acceleration", &Dependence::acceleration, "On accelerations, and therefore on q, v and u.")
      .def_readwrite("forces", &Dependence::forces, "On contact forces, and therefore on q, v and u.");

  py::class_<ResidualDataAbstract, std::shared_ptr<ResidualDataAbstract>> data(
      m, "ResidualDataAbstract", "The value of a residual and its derivatives.");
  data.def_property("Rx", &get_Rx, &set_Rx, "Derivative dr/dx (nr, ndx); a copy: assign the whole matrix.")
      .def_property("Ru", &get_Ru, &set_Ru, "Derivative dr/du (nr, nu); a copy: assign the whole matrix.")
      .def_property_readonly(
          "shared", [](const ResidualDataAbstract& d) { return Scope::shared_of(&d); },
          "DataCollector, while calc and calcDiff run.");
  member_view(data, "r", &ResidualDataAbstract::r, "Value (nr); set by calc.");

  py::class_<Abstract, PyResidual, std::shared_ptr<Abstract>> model(
      m, "ResidualModelAbstract",
      "r(x, u). Derive from it: `calc(self, data, x, u)` sets data.r. `calcDiff(self, data, x, u)` sets data.Rx and "
      "data.Ru.\n"
      "u is zero in terminal nodes. data.shared has the robots' kinematics. createData(self, shared) may return data "
      "of a class\n"
      "derived from ResidualDataAbstract.");
  data.def(py::init([](const Abstract& model, const std::shared_ptr<Shared>& shared) {
             return std::make_shared<ResidualDataAbstract>(&model, shared->collector());
           }),
           py::arg("model"), py::arg("shared").none(false));
  model
      .def(py::init<State, std::size_t, std::size_t, Dependence>(), py::arg("state"), py::arg("nr"), py::arg("nu"),
           py::arg("depends_on"))
      .def(
          "createData",
          [](Abstract& x, const std::shared_ptr<Shared>& shared) { return x.createData(shared->collector()); },
          py::arg("shared").none(false), "Make a ResidualDataAbstract, for an overridden createData.")
      .def_property_readonly("state", &Abstract::get_state, "StateAbstract that it was made for.")
      .def_property_readonly("nr", &Abstract::get_nr, "Number of rows of the residual.")
      .def_property_readonly("nu", &Abstract::get_nu, "Number of controls.")
      .def_property_readonly("q_dependent", &Abstract::get_q_dependent, "Whether it depends on q.")
      .def_property_readonly("v_dependent", &Abstract::get_v_dependent, "Whether it depends on v.")
      .def_property_readonly("u_dependent", &Abstract::get_u_dependent, "Whether it depends on u.")
      .def("__str__", &text_of<Abstract>);
}

// (state, id, reference, nu) and (state, id, reference).
template <class T, class Reference>
void frame_and_reference(py::module_& m, const char* name, const char* reference, const char* doc, const char* of) {
  auto c = residual<T>(m, name, doc);
  c.def(py::init<State, std::size_t, const Reference&, std::size_t>(), py::arg("state"), py::arg("id"),
        py::arg(reference), py::arg("nu"))
      .def(py::init<State, std::size_t, const Reference&>(), py::arg("state"), py::arg("id"), py::arg(reference))
      .def_property("id", &T::get_id, &T::set_id, "Number of the frame: state.pinocchio.getFrameId(name).");
  if constexpr (std::is_base_of_v<ContactResidual, T>)
    c.def_property("axes", &T::get_axes, &T::set_axes,
                   "Axes of the cone, initially 'contact'; also 'foot', 'world' or 'other' (those of B').")
        .def_property("contact", &T::get_contact, &T::set_contact,
                      "Name of the contact, if there are several on that frame; '' for the only one.");
  with_reference<T>(c, of);
}

void add_residuals_of_states(py::module_& m) {
  {
    auto c = residual<ResidualModelState>(m, "ResidualModelState", "The state error x (-) xref (ndx).");
    c.def(py::init<State, const Vector&, std::size_t>(), py::arg("state"), py::arg("xref"), py::arg("nu"))
        .def(py::init<State, const Vector&>(), py::arg("state"), py::arg("xref"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelState>(c, "Reference state (nx).");
  }
  {
    auto c = residual<ResidualModelControl>(m, "ResidualModelControl", "The control error u - uref (nu) [N m, N].");
    c.def(py::init<State, const Vector&>(), py::arg("state"), py::arg("uref"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelControl>(c, "Reference controls (nu).");
  }
  {
    using Actuation = std::shared_ptr<ActuationModelAbstract>;
    auto c = residual<ResidualModelJointEffort>(m, "ResidualModelJointEffort",
                                                "The error of joint efforts, u - uref (nu) [N m, N].");
    c.def(py::init<State, Actuation, const Vector&, std::size_t>(), py::arg("state"), py::arg("actuation"),
          py::arg("uref"), py::arg("nu"))
        .def(py::init<State, Actuation, const Vector&>(), py::arg("state"), py::arg("actuation"), py::arg("uref"))
        .def(py::init<State, Actuation, std::size_t>(), py::arg("state"), py::arg("actuation"), py::arg("nu"))
        .def(py::init<State, Actuation>(), py::arg("state"), py::arg("actuation"));
    with_reference<ResidualModelJointEffort>(c, "Reference efforts (nu) [N m, N].");
  }
  {
    auto c = residual<ResidualModelJointAcceleration>(m, "ResidualModelJointAcceleration",
                                                      "The acceleration error a - aref (nv) [m/s^2, rad/s^2].");
    c.def(py::init<State, const Vector&, std::size_t>(), py::arg("state"), py::arg("aref"), py::arg("nu"))
        .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
        .def(py::init<State>(), py::arg("state"));
    with_reference<ResidualModelJointAcceleration>(c, "Reference accelerations (nv) [m/s^2, rad/s^2].");
  }
  {
    auto c = residual<ResidualModelCoMPosition>(
        m, "ResidualModelCoMPosition",
        "The error c - cref (3) [m] of the centre of mass of the scene, or of one robot by its number.");
    c.def(py::init<State, const Eigen::Vector3d&, std::size_t, int>(), py::arg("state"), py::arg("cref"), py::arg("nu"),
          py::arg("robot") = -1)
        .def(py::init<State, const Eigen::Vector3d&>(), py::arg("state"), py::arg("cref"));
    with_reference<ResidualModelCoMPosition>(c, "Reference position (3) [m].");
  }
  {
    auto c = residual<ResidualModelCentroidalMomentum>(
        m, "ResidualModelCentroidalMomentum",
        "The momentum minus href (6), in world axes: linear [N s], angular about the centre of mass [N m s].");
    c.def(py::init<State, const Vec6<double>&, std::size_t, int>(), py::arg("state"), py::arg("href"), py::arg("nu"),
          py::arg("robot") = -1)
        .def(py::init<State, const Vec6<double>&>(), py::arg("state"), py::arg("href"));
    with_reference<ResidualModelCentroidalMomentum>(c, "Reference momentum (6) [N s, N m s].");
  }
}

void add_residuals_of_frames(py::module_& m) {
  frame_and_reference<ResidualModelFramePlacement, SE3<double>>(m, "ResidualModelFramePlacement", "pref",
                                                                "The placement error log6(pref^-1 oMf) (6) of a frame.",
                                                                "Reference placement in the world (SE3).");
  frame_and_reference<ResidualModelFrameTranslation, Eigen::Vector3d>(m, "ResidualModelFrameTranslation", "xref",
                                                                      "The position error p - xref (3) [m] of a frame.",
                                                                      "Reference position in the world (3) [m].");
  frame_and_reference<ResidualModelFrameRotation, Eigen::Matrix3d>(
      m, "ResidualModelFrameRotation", "Rref", "The rotation error log3(Rref^T R) (3) [rad] of a frame.",
      "Reference rotation in the world (3, 3).");
  {
    auto c = residual<ResidualModelFrameVelocity>(m, "ResidualModelFrameVelocity",
                                                  "The velocity error v - vref (6) [m/s, rad/s] of a frame.");
    c.def(py::init<State, std::size_t, const Vec6<double>&, ReferenceFrame, std::size_t>(), py::arg("state"),
          py::arg("id"), py::arg("vref"), py::arg("type"), py::arg("nu"))
        .def(py::init<State, std::size_t, const Vec6<double>&, ReferenceFrame>(), py::arg("state"), py::arg("id"),
             py::arg("vref"), py::arg("type"))
        .def_property("id", &ResidualModelFrameVelocity::get_id, &ResidualModelFrameVelocity::set_id,
                      "Number of the frame: state.pinocchio.getFrameId(name).")
        .def_property("type", &ResidualModelFrameVelocity::get_type, &ResidualModelFrameVelocity::set_type,
                      "ReferenceFrame of the velocity.");
    with_reference<ResidualModelFrameVelocity>(c, "Reference velocity (6) [m/s, rad/s].");
  }
}

void add_residuals_of_contacts(py::module_& m) {
  add_enumeration<ConeAxes>(m, "ConeAxes", "axes",
                            "The axes of a cone: those of its contact, of A, of the world, or of B'.",
                            {{"CONTACT", ConeAxes::kContact},
                             {"FOOT", ConeAxes::kFoot},
                             {"WORLD", ConeAxes::kWorld},
                             {"OTHER", ConeAxes::kOther}});
  {
    auto c = residual<ResidualModelContactForce>(m, "ResidualModelContactForce",
                                                 "The contact force error f - fref (nc) [N, N m].");
    c.def(py::init<State, std::size_t, const Vec6<double>&, std::size_t, std::size_t>(), py::arg("state"),
          py::arg("id"), py::arg("fref"), py::arg("nc"), py::arg("nu"))
        .def(py::init<State, std::size_t, const Vec6<double>&, std::size_t>(), py::arg("state"), py::arg("id"),
             py::arg("fref"), py::arg("nc"));
    with_reference<ResidualModelContactForce>(c, "Reference wrench (6) [N, N m].");
  }
  frame_and_reference<ResidualModelContactFrictionCone, FrictionCone>(
      m, "ResidualModelContactFrictionCone", "fref", "The product A f of a friction cone and a contact force (nf + 1).",
      "FrictionCone.");
  frame_and_reference<ResidualModelContactWrenchCone, WrenchCone>(
      m, "ResidualModelContactWrenchCone", "fref", "The product A f of a wrench cone and a contact wrench (nf + 13).",
      "WrenchCone.");
  frame_and_reference<ResidualModelContactCoPPosition, CoPSupport>(
      m, "ResidualModelContactCoPPosition", "cref", "The product A f of a support polygon and a contact wrench (4).",
      "CoPSupport.");
  residual<ResidualModelControlGrav>(m, "ResidualModelControlGrav",
                                     "The torques minus those that compensate gravity, tau - g(q) (nv) [N m, N].")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"));
  residual<ResidualModelContactControlGrav>(
      m, "ResidualModelContactControlGrav",
      "The torques minus those that compensate gravity with contacts, tau - (g(q) - J^T f) (nv) [N m, N].")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"));
  residual<ResidualModelImpulseCoM>(m, "ResidualModelImpulseCoM",
                                    "The jump of the velocity of the centre of mass (3) [m/s].")
      .def(py::init<State>(), py::arg("state"));
}

}  // namespace

void Scope::begin(const void* data, std::shared_ptr<Shared> shared) { running.push_back({data, std::move(shared)}); }
Scope::~Scope() {
  running.back().shared->end();
  running.pop_back();
}

std::shared_ptr<Shared> Scope::shared_of(const void* data) {
  for (auto r = running.rbegin(); r != running.rend(); ++r)
    if (r->data == data) return r->shared;
  throw py::value_error("data.shared is there while calc and calcDiff of a class written in Python run");
}

void add_residual_models(py::module_& m) {
  add_shared(m);
  add_residual_base(m);
  add_residuals_of_states(m);
  add_residuals_of_frames(m);
  add_residuals_of_contacts(m);
}

}  // namespace manycontact::python
