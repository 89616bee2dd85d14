// Contacts, impulses and differential action models.

#include "action.hpp"
#include "docs/optimal_control.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/action/impulse.hpp"
#include "manycontact/action/num_diff.hpp"
#include "manycontact/control/free_fwddyn.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using State = std::shared_ptr<StateMultibody>;
using Gains2 = Eigen::Vector2d;

template <class T>
auto contact(py::module_& m, const char* name, const char* doc) {
  return py::class_<T, ContactModelAbstract, std::shared_ptr<T>>(m, name, doc);
}

void add_contact_models(py::module_& m) {
  const auto with_gains = py::arg("gains") = Gains2(Gains2::Zero());
  const auto in_local = py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL");
  using Abstract = ContactModelAbstract;
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "ContactModelAbstract", "The common base of contacts.")
      .def_property_readonly("state", &Abstract::get_state, "StateAbstract that it was made for.")
      .def_property_readonly("nc", &Abstract::get_nc, "Number of constraint rows.")
      .def_property_readonly("nu", &Abstract::get_nu, "Number of controls.")
      .def_property("id", &Abstract::get_id, &Abstract::set_id,
                    "Number of the frame: state.pinocchio.getFrameId(name).")
      .def_property("type", &Abstract::get_type, &Abstract::set_type, "ReferenceFrame")
      .def_property("gains", &Abstract::get_gains, &Abstract::set_gains,
                    "Stabilisation gains (alpha [1/s^2], beta [1/s]).")
      .def("__str__", &text_of<Abstract>);

  contact<ContactModel1D>(m, "ContactModel1D", "Constrains one component of a point's position.")
      .def(py::init<State, std::size_t, double, ReferenceFrame, const Eigen::Matrix3d&, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("type"), py::arg("rotation"), py::arg("nu"),
           with_gains, "The component along rotation^T e_z has the value xref [m].")
      .def(py::init<State, std::size_t, double, std::size_t, const Gains2&>(), py::arg("state"), py::arg("id"),
           py::arg("xref"), py::arg("nu"), with_gains)
      .def_property("axis", &ContactModel1D::get_axis, &ContactModel1D::set_axis,
                    "Unit vector (3) in the reference frame.")
      .def_property(
          "reference", &ContactModel1D::get_reference, [](ContactModel1D& c, double x) { c.set_reference(x); }, "[m]");
  contact<ContactModel2D>(m, "ContactModel2D", "Constrains the x and z components of a point's position.")
      .def(py::init<State, std::size_t, const Eigen::Vector2d&, std::size_t, const Gains2&, ReferenceFrame>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("nu"), with_gains, in_local)
      .def_property("reference", &ContactModel2D::get_reference, &ContactModel2D::set_reference, "(2) [m]");
  contact<ContactModel3D>(m, "ContactModel3D", "Constrains a point's position.")
      .def(py::init<State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("type"), py::arg("nu"), with_gains)
      .def(py::init<State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, const Gains2&>(), py::arg("state"),
           py::arg("id"), py::arg("xref"), py::arg("type"), with_gains)
      .def_property("reference", &ContactModel3D::get_reference, &ContactModel3D::set_reference,
                    "Required position in the world (3) [m].");
  contact<ContactModel6D>(m, "ContactModel6D", "Constrains a frame's placement.")
      .def(py::init<State, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("pref"), py::arg("type"), py::arg("nu"), with_gains)
      .def(py::init<State, std::size_t, const SE3<double>&, ReferenceFrame, const Gains2&>(), py::arg("state"),
           py::arg("id"), py::arg("pref"), py::arg("type"), with_gains)
      .def_property(
          "reference", [](const ContactModel6D& c) -> SE3<double> { return c.get_reference(); },
          &ContactModel6D::set_reference, "Required placement in the world (SE3).");
  contact<ContactModelBetweenBodies>(m, "ContactModelBetweenBodies", "Constrains a frame to a frame of another body.")
      .def(py::init<State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t,
                    const Gains2&, const Eigen::Vector3d&>(),
           py::arg("state"), py::arg("contact_type"), py::arg("id"), py::arg("to"), py::arg("offset"), py::arg("type"),
           py::arg("nu"), with_gains, py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()))
      .def_property_readonly("to", &ContactModelBetweenBodies::get_to, "Number of the frame of B'.");
  contact<ContactModelOfScene>(m, "ContactModelOfScene", "A contact as in a scene, with any attachment.")
      .def(py::init<State, const Contact&, std::size_t>(), py::arg("state"), py::arg("contact"), py::arg("nu"));

  py::class_<ContactDataAbstract, std::shared_ptr<ContactDataAbstract>>(m, "ContactDataAbstract", "Copies.")
      .def_property_readonly(
          "f", [](const ContactDataAbstract& d) { return Eigen::VectorXd(d.f); },
          "Force on A, in the contact's reference frame (nc) [N, N m].")
      .def_property_readonly(
          "Jc", [](const ContactDataAbstract& d) { return d.Jc; }, "Jacobian (nc, number of v_columns).")
      .def_property_readonly(
          "a0", [](const ContactDataAbstract& d) { return d.a0; }, "Bias of the constraint rows (nc) [m/s^2, rad/s^2].")
      .def_readonly("v_columns", &ContactDataAbstract::v_columns, "Velocity coordinates of the columns of Jc.")
      .def_readonly("active", &ContactDataAbstract::active, "Whether it is active.");

  py::class_<ContactItem, std::shared_ptr<ContactItem>>(m, "ContactItem",
                                                        "A contact, its name, and whether it is active.")
      .def_readonly("name", &ContactItem::name, "Name.")
      .def_readonly("contact", &ContactItem::contact, "ContactModelAbstract.")
      .def_readonly("active", &ContactItem::active, "Whether it is active.");
  using Multiple = ContactModelMultiple;
  py::class_<Multiple, std::shared_ptr<Multiple>>(m, "ContactModelMultiple", "Contacts by name.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addContact", &Multiple::addContact, py::arg("name"), py::arg("contact").none(false),
           py::arg("active") = true, "Add a contact. A name that exists raises ValueError.")
      .def("removeContact", &Multiple::removeContact, py::arg("name"), "Remove a contact by its name.")
      .def("changeContactStatus", &Multiple::changeContactStatus, py::arg("name"), py::arg("active"),
           "Activate or deactivate a contact.")
      .def("getContactStatus", &Multiple::getContactStatus, py::arg("name"), "Return whether a contact is active.")
      .def_property_readonly("contacts", &Multiple::get_contacts, "{name: ContactItem}.")
      .def_property_readonly("nc", &Multiple::get_nc, "Number of constraint rows of the active contacts.")
      .def_property_readonly("nc_total", &Multiple::get_nc_total, "Number of constraint rows of all contacts.")
      .def_property_readonly("nu", &Multiple::get_nu, "Number of controls.")
      .def_property_readonly("active_set", &Multiple::get_active_set, "Names of the active ones.")
      .def_property_readonly("inactive_set", &Multiple::get_inactive_set, "Names of the inactive ones.")
      .def("__str__", &text_of<Multiple>);
  m.def("contacts_of_scene", &contacts_of_scene, py::arg("state"), py::arg("scene"), py::arg("nu"),
        doc::contacts_of_scene);
}

void add_impulses(py::module_& m) {
  const auto in_local = py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL");
  using Abstract = ImpulseModelAbstract;
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "ImpulseModelAbstract", "The common base of impulses.")
      .def_property_readonly("nc", &Abstract::get_nc, "Number of constraint rows.")
      .def_property("id", &Abstract::get_id, &Abstract::set_id,
                    "Number of the frame: state.pinocchio.getFrameId(name).")
      .def_property("type", &Abstract::get_type, &Abstract::set_type, "ReferenceFrame of its rows.")
      .def("__str__", &text_of<Abstract>);
  py::class_<ImpulseModel3D, Abstract, std::shared_ptr<ImpulseModel3D>>(m, "ImpulseModel3D",
                                                                        "Stops the velocity of a point.")
      .def(py::init<State, std::size_t, ReferenceFrame>(), py::arg("state"), py::arg("id"), in_local);
  py::class_<ImpulseModel6D, Abstract, std::shared_ptr<ImpulseModel6D>>(m, "ImpulseModel6D",
                                                                        "Stops the velocity of a frame.")
      .def(py::init<State, std::size_t, ReferenceFrame>(), py::arg("state"), py::arg("id"), in_local);
  py::class_<ImpulseModelBetweenBodies, Abstract, std::shared_ptr<ImpulseModelBetweenBodies>>(
      m, "ImpulseModelBetweenBodies", "Stops the relative velocity of two bodies' frames.")
      .def(py::init<State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame,
                    const Eigen::Vector3d&>(),
           py::arg("state"), py::arg("contact_type"), py::arg("id"), py::arg("to"),
           py::arg_v("offset", SE3<double>(), "SE3()"), in_local,
           py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
  using Multiple = ImpulseModelMultiple;
  py::class_<Multiple, std::shared_ptr<Multiple>>(m, "ImpulseModelMultiple",
                                                  "The impulses of an action model, by name.")
      .def(py::init<State>(), py::arg("state"))
      .def("addImpulse", &Multiple::addImpulse, py::arg("name"), py::arg("impulse").none(false),
           py::arg("active") = true, "Add an impulse. A name that exists raises ValueError.")
      .def("removeImpulse", &Multiple::removeImpulse, py::arg("name"), "Remove an impulse by its name.")
      .def("changeImpulseStatus", &Multiple::changeImpulseStatus, py::arg("name"), py::arg("active"),
           "Activate or deactivate an impulse.")
      .def("getImpulseStatus", &Multiple::getImpulseStatus, py::arg("name"), "Return whether an impulse is active.")
      .def_property_readonly("nc", &Multiple::get_nc, "Number of constraint rows.")
      .def("__str__", &text_of<Multiple>);
}

// ---- differential action models ------------------------------------------------------------------------------------

using Abstract = DifferentialActionModelAbstract;
using AbstractData = DifferentialActionDataAbstract;

template <class Class>
void sparse_twin(Class& c, const char* name, const Eigen::SparseMatrix<double>& (AbstractData::*get)() const) {
  c.def_property_readonly(
      name,
      [get](const AbstractData& d) {
        Eigen::SparseMatrix<double> matrix = (d.*get)();
        matrix.makeCompressed();
        const py::object copied = scipy_csc(std::move(matrix));
        read_only(copied.attr("data"));
        return copied;
      },
      "scipy.sparse.csc_matrix, for models with sparse storage; a copy.");
}

void add_base(py::module_& m) {
  add_enumeration<MatrixStorage>(m, "MatrixStorage", "storage", "Which large matrices are computed.",
                                 {{"BOTH", MatrixStorage::kBoth},
                                  {"DENSE", MatrixStorage::kDense},
                                  {"SPARSE", MatrixStorage::kSparse},
                                  {"PANEL", MatrixStorage::kPanel}});

  py::class_<AbstractData, std::shared_ptr<AbstractData>> data(m, "DifferentialActionDataAbstract",
                                                               "The results of a node in continuous time.");
  py::class_<Abstract, PyActionModel<Abstract, AbstractData>, std::shared_ptr<Abstract>> model(
      m, "DifferentialActionModelAbstract",
      "Continuous dynamics, cost and constraints of one node.\n"
      "\n"
      "In a derived class calc(self, data, x, u=None) sets data.xout and data.cost, and calcDiff(self, data, x,\n"
      "u=None)\n"
      "sets data.Fx, Fu, Lx, Lu, Lxx, Lxu and Luu. Without u the node is terminal. createData(self) may return\n"
      "data of a\n"
      "class derived from DifferentialActionDataAbstract.");
  data.def(py::init<const Abstract*>(), py::arg("model").none(false));
  add_action_data(data);
  member_view(data, "xout", &AbstractData::xout, "Accelerations (nv) [m/s^2, rad/s^2]; set by calc.");
  sparse_twin(data, "Fx_sparse", &AbstractData::Fx_sparse);
  sparse_twin(data, "Fu_sparse", &AbstractData::Fu_sparse);
  sparse_twin(data, "Lxx_sparse", &AbstractData::Lxx_sparse);
  sparse_twin(data, "Lxu_sparse", &AbstractData::Lxu_sparse);
  sparse_twin(data, "Luu_sparse", &AbstractData::Luu_sparse);

  model.def(py::init<std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t>(),
            py::arg("state"), py::arg("nu"), py::arg("nr") = 0, py::arg("ng") = 0, py::arg("nh") = 0);
  add_action_model<AbstractData>(model);
  model.def_property("storage", &Abstract::get_storage, &Abstract::set_storage,
                     "MatrixStorage of data created afterwards.");
}

void add_forward_dynamics(py::module_& m) {
  using Data = DifferentialActionDataContactFwdDynamics;
  using Model = DifferentialActionModelContactFwdDynamics;
  using Actuation = std::shared_ptr<ActuationModelAbstract>;
  using Contacts = std::shared_ptr<ContactModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;

  py::class_<Data, AbstractData, std::shared_ptr<Data>>(m, "DifferentialActionDataContactFwdDynamics",
                                                        "Data of DifferentialActionModelContactFwdDynamics.")
      .def_property_readonly(
          "report", [](const Data& d) { return d.report(); }, "Report of the last calc; a copy.")
      .def_property_readonly(
          "costs", [](const Data& d) { return d.costs->costs; }, "{name: CostDataAbstract}.")
      .def_property_readonly(
          "contacts", [](const Data& d) { return d.multibody->contacts->contacts; }, "{name: ContactDataAbstract}.");

  py::class_<Model, Abstract, std::shared_ptr<Model>>(
      m, "DifferentialActionModelContactFwdDynamics",
      "Contact forward dynamics with costs and constraints, with Crocoddyl's API.")
      .def(py::init<State, Actuation, Contacts, Costs, double, bool>(), py::arg("state"), py::arg("actuation"),
           py::arg("contacts"), py::arg("costs"), py::arg("JMinvJt_damping") = 0.0, py::arg("enable_force") = false)
      .def(py::init<State, Actuation, Contacts, Costs, Constraints, double, bool>(), py::arg("state"),
           py::arg("actuation"), py::arg("contacts"), py::arg("costs"), py::arg("constraints"),
           py::arg("JMinvJt_damping") = 0.0, py::arg("enable_force") = false)
      .def_property_readonly("actuation", &Model::get_actuation, "ActuationModelAbstract.")
      .def_property_readonly("contacts", &Model::get_contacts, "ContactModelMultiple.")
      .def_property_readonly("costs", &Model::get_costs, "CostModelSum.")
      .def_property_readonly("constraints", &Model::get_constraints, "ConstraintModelManager, or None.")
      .def_property("armature", &Model::get_armature, &Model::set_armature,
                    "Reflected rotor inertia (nv) [kg m^2, kg]; it replaces the model's.")
      .def_property("JMinvJt_damping", &Model::get_damping_factor, &Model::set_damping_factor,
                    "Damping delta of the contacts [1/kg].")
      .def_property_readonly("enable_force", &Model::get_enable_force,
                             "Whether derivatives of contact forces are always computed.")
      .def_property(
          "options",
          [](const std::shared_ptr<Model>& x) {
            return Handle<Options>([x]() -> const Options& { return x->get_options(); },
                                   [x](const Options& options) { x->set_options(options); });
          },
          [](Model& x, const Options& options) { x.set_options(options); },
          "Options of the solves, for data created afterwards.");
  using Free = DifferentialActionModelFreeFwdDynamics;
  py::class_<Free, Model, std::shared_ptr<Free>>(m, "DifferentialActionModelFreeFwdDynamics",
                                                 "Forward dynamics without contacts, with costs and constraints.")
      .def(py::init<State, Actuation, Costs, Constraints>(), py::arg("state"), py::arg("actuation"), py::arg("costs"),
           py::arg("constraints") = py::none());

  using NumDiff = DifferentialActionModelNumDiff;
  py::class_<NumDiff, Abstract, std::shared_ptr<NumDiff>>(m, "DifferentialActionModelNumDiff",
                                                          "A model with derivatives by central differences.")
      .def(py::init<std::shared_ptr<Abstract>, bool>(), py::arg("model").none(false),
           py::arg("with_gauss_approx") = false)
      .def_property_readonly("model", &NumDiff::get_model, "The model that is differentiated.")
      .def_property("disturbance", &NumDiff::get_disturbance, &NumDiff::set_disturbance, "Step of the differences.");
}

}  // namespace

void add_action(py::module_& m) {
  add_contact_models(m);
  add_impulses(m);
  add_base(m);
  add_forward_dynamics(m);
}

}  // namespace manycontact::python
