// Contacts, impulses and differential action models: floor action.

#include "action.hpp"
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
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "ContactModelAbstract")
      .def_property_readonly("state", &Abstract::get_state)
      .def_property_readonly("nc", &Abstract::get_nc)
      .def_property_readonly("nu", &Abstract::get_nu)
      .def_property("id", &Abstract::get_id, &Abstract::set_id, "Number of the frame.")
      .def_property("type", &Abstract::get_type, &Abstract::set_type, "ReferenceFrame")
      .def_property("gains", &Abstract::get_gains, &Abstract::set_gains, "(alpha [1/s^2], beta [1/s])")
      .def("__str__", &text_of<Abstract>);

  contact<ContactModel1D>(m, "ContactModel1D", "One component of a point's position.")
      .def(py::init<State, std::size_t, double, ReferenceFrame, const Eigen::Matrix3d&, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("type"), py::arg("rotation"), py::arg("nu"),
           with_gains, "The component along rotation^T e_z, which stands at xref [m].")
      .def(py::init<State, std::size_t, double, std::size_t, const Gains2&>(), py::arg("state"), py::arg("id"),
           py::arg("xref"), py::arg("nu"), with_gains)
      .def_property("axis", &ContactModel1D::get_axis, &ContactModel1D::set_axis, "(3), in the reference frame.")
      .def_property(
          "reference", &ContactModel1D::get_reference, [](ContactModel1D& c, double x) { c.set_reference(x); }, "[m]");
  contact<ContactModel2D>(m, "ContactModel2D", "The x and z components of a point's position.")
      .def(py::init<State, std::size_t, const Eigen::Vector2d&, std::size_t, const Gains2&, ReferenceFrame>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("nu"), with_gains, in_local)
      .def_property("reference", &ContactModel2D::get_reference, &ContactModel2D::set_reference, "(2) [m]");
  contact<ContactModel3D>(m, "ContactModel3D", "A point's position.")
      .def(py::init<State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("xref"), py::arg("type"), py::arg("nu"), with_gains)
      .def(py::init<State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, const Gains2&>(), py::arg("state"),
           py::arg("id"), py::arg("xref"), py::arg("type"), with_gains)
      .def_property("reference", &ContactModel3D::get_reference, &ContactModel3D::set_reference, "(3) [m], world.");
  contact<ContactModel6D>(m, "ContactModel6D", "A frame's placement.")
      .def(py::init<State, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t, const Gains2&>(),
           py::arg("state"), py::arg("id"), py::arg("pref"), py::arg("type"), py::arg("nu"), with_gains)
      .def(py::init<State, std::size_t, const SE3<double>&, ReferenceFrame, const Gains2&>(), py::arg("state"),
           py::arg("id"), py::arg("pref"), py::arg("type"), with_gains)
      .def_property(
          "reference", [](const ContactModel6D& c) -> SE3<double> { return c.get_reference(); },
          &ContactModel6D::set_reference, "SE3 in the world.");
  contact<ContactModelBetweenBodies>(m, "ContactModelBetweenBodies", "A frame held to a frame of another body.")
      .def(py::init<State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t,
                    const Gains2&, const Eigen::Vector3d&>(),
           py::arg("state"), py::arg("contact_type"), py::arg("id"), py::arg("to"), py::arg("offset"), py::arg("type"),
           py::arg("nu"), with_gains, py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()))
      .def_property_readonly("to", &ContactModelBetweenBodies::get_to);
  contact<ContactModelOfScene>(m, "ContactModelOfScene", "A contact as a scene has it.")
      .def(py::init<State, const Contact&, std::size_t>(), py::arg("state"), py::arg("contact"), py::arg("nu"));

  py::class_<ContactDataAbstract, std::shared_ptr<ContactDataAbstract>>(m, "ContactDataAbstract", "Copies.")
      .def_property_readonly(
          "f", [](const ContactDataAbstract& d) { return Eigen::VectorXd(d.f); },
          "Force on A, in the contact's reference frame (nc) [N, N m].")
      .def_property_readonly(
          "Jc", [](const ContactDataAbstract& d) { return d.Jc; }, "(nc, v_columns)")
      .def_property_readonly(
          "a0", [](const ContactDataAbstract& d) { return d.a0; }, "(nc)")
      .def_readonly("v_columns", &ContactDataAbstract::v_columns, "Which velocity coordinates Jc's columns are.")
      .def_readonly("active", &ContactDataAbstract::active);

  py::class_<ContactItem, std::shared_ptr<ContactItem>>(m, "ContactItem")
      .def_readonly("name", &ContactItem::name)
      .def_readonly("contact", &ContactItem::contact)
      .def_readonly("active", &ContactItem::active);
  using Multiple = ContactModelMultiple;
  py::class_<Multiple, std::shared_ptr<Multiple>>(m, "ContactModelMultiple", "Contacts by name.")
      .def(py::init<State, std::size_t>(), py::arg("state"), py::arg("nu"))
      .def(py::init<State>(), py::arg("state"))
      .def("addContact", &Multiple::addContact, py::arg("name"), py::arg("contact").none(false),
           py::arg("active") = true)
      .def("removeContact", &Multiple::removeContact, py::arg("name"))
      .def("changeContactStatus", &Multiple::changeContactStatus, py::arg("name"), py::arg("active"))
      .def("getContactStatus", &Multiple::getContactStatus, py::arg("name"))
      .def_property_readonly("contacts", &Multiple::get_contacts, "{name: ContactItem}")
      .def_property_readonly("nc", &Multiple::get_nc, "Rows of the active contacts.")
      .def_property_readonly("nc_total", &Multiple::get_nc_total)
      .def_property_readonly("nu", &Multiple::get_nu)
      .def_property_readonly("active_set", &Multiple::get_active_set)
      .def_property_readonly("inactive_set", &Multiple::get_inactive_set)
      .def("__str__", &text_of<Multiple>);
  m.def("contacts_of_scene", &contacts_of_scene, py::arg("state"), py::arg("scene"), py::arg("nu"),
        "All contacts of a scene by their names, as a ContactModelMultiple.");
}

void add_impulses(py::module_& m) {
  const auto in_local = py::arg_v("type", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL");
  using Abstract = ImpulseModelAbstract;
  py::class_<Abstract, std::shared_ptr<Abstract>>(m, "ImpulseModelAbstract")
      .def_property_readonly("nc", &Abstract::get_nc)
      .def_property("id", &Abstract::get_id, &Abstract::set_id)
      .def_property("type", &Abstract::get_type, &Abstract::set_type)
      .def("__str__", &text_of<Abstract>);
  py::class_<ImpulseModel3D, Abstract, std::shared_ptr<ImpulseModel3D>>(m, "ImpulseModel3D", "A point's velocity.")
      .def(py::init<State, std::size_t, ReferenceFrame>(), py::arg("state"), py::arg("id"), in_local);
  py::class_<ImpulseModel6D, Abstract, std::shared_ptr<ImpulseModel6D>>(m, "ImpulseModel6D", "A frame's velocity.")
      .def(py::init<State, std::size_t, ReferenceFrame>(), py::arg("state"), py::arg("id"), in_local);
  py::class_<ImpulseModelBetweenBodies, Abstract, std::shared_ptr<ImpulseModelBetweenBodies>>(
      m, "ImpulseModelBetweenBodies", "The relative velocity of two bodies' frames.")
      .def(py::init<State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame,
                    const Eigen::Vector3d&>(),
           py::arg("state"), py::arg("contact_type"), py::arg("id"), py::arg("to"),
           py::arg_v("offset", SE3<double>(), "SE3()"), in_local,
           py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
  using Multiple = ImpulseModelMultiple;
  py::class_<Multiple, std::shared_ptr<Multiple>>(m, "ImpulseModelMultiple", "Impulses by name.")
      .def(py::init<State>(), py::arg("state"))
      .def("addImpulse", &Multiple::addImpulse, py::arg("name"), py::arg("impulse").none(false),
           py::arg("active") = true)
      .def("removeImpulse", &Multiple::removeImpulse, py::arg("name"))
      .def("changeImpulseStatus", &Multiple::changeImpulseStatus, py::arg("name"), py::arg("active"))
      .def("getImpulseStatus", &Multiple::getImpulseStatus, py::arg("name"))
      .def_property_readonly("nc", &Multiple::get_nc)
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
      "scipy.sparse.csc_matrix, a copy; of models with sparse storage.");
}

void add_base(py::module_& m) {
  add_enumeration<MatrixStorage>(m, "MatrixStorage", "storage", "Which of the large matrices are filled.",
                                 {{"BOTH", MatrixStorage::kBoth},
                                  {"DENSE", MatrixStorage::kDense},
                                  {"SPARSE", MatrixStorage::kSparse},
                                  {"PANEL", MatrixStorage::kPanel}});

  py::class_<AbstractData, std::shared_ptr<AbstractData>> data(m, "DifferentialActionDataAbstract");
  py::class_<Abstract, PyActionModel<Abstract, AbstractData>, std::shared_ptr<Abstract>> model(
      m, "DifferentialActionModelAbstract",
      "Continuous dynamics, cost and constraints of one node. Derive from it: calc(self, data, x, u=None) sets\n"
      "data.xout and data.cost; calcDiff(self, data, x, u=None) sets data.Fx, Fu, Lx, Lu, Lxx, Lxu, Luu; without u "
      "the\n"
      "node is terminal. createData(self) may return data of a class derived from DifferentialActionDataAbstract.");
  data.def(py::init<const Abstract*>(), py::arg("model").none(false));
  add_action_data(data);
  member_view(data, "xout", &AbstractData::xout, "Accelerations (nv): by calc.");
  sparse_twin(data, "Fx_sparse", &AbstractData::Fx_sparse);
  sparse_twin(data, "Fu_sparse", &AbstractData::Fu_sparse);
  sparse_twin(data, "Lxx_sparse", &AbstractData::Lxx_sparse);
  sparse_twin(data, "Lxu_sparse", &AbstractData::Lxu_sparse);
  sparse_twin(data, "Luu_sparse", &AbstractData::Luu_sparse);

  model.def(py::init<std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t>(),
            py::arg("state"), py::arg("nu"), py::arg("nr") = 0, py::arg("ng") = 0, py::arg("nh") = 0);
  add_action_model<AbstractData>(model);
  model.def_property("storage", &Abstract::get_storage, &Abstract::set_storage, "For data created from now on.");
}

void add_forward_dynamics(py::module_& m) {
  using Data = DifferentialActionDataContactFwdDynamics;
  using Model = DifferentialActionModelContactFwdDynamics;
  using Actuation = std::shared_ptr<ActuationModelAbstract>;
  using Contacts = std::shared_ptr<ContactModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;

  py::class_<Data, AbstractData, std::shared_ptr<Data>>(m, "DifferentialActionDataContactFwdDynamics")
      .def_property_readonly(
          "report", [](const Data& d) { return d.report(); }, "Report of the last calc; a copy.")
      .def_property_readonly(
          "costs", [](const Data& d) { return d.costs->costs; }, "{name: CostDataAbstract}")
      .def_property_readonly(
          "contacts", [](const Data& d) { return d.multibody->contacts->contacts; }, "{name: ContactDataAbstract}");

  py::class_<Model, Abstract, std::shared_ptr<Model>>(
      m, "DifferentialActionModelContactFwdDynamics",
      "Contact forward dynamics with costs and constraints: Crocoddyl's interface.")
      .def(py::init<State, Actuation, Contacts, Costs, double, bool>(), py::arg("state"), py::arg("actuation"),
           py::arg("contacts"), py::arg("costs"), py::arg("JMinvJt_damping") = 0.0, py::arg("enable_force") = false)
      .def(py::init<State, Actuation, Contacts, Costs, Constraints, double, bool>(), py::arg("state"),
           py::arg("actuation"), py::arg("contacts"), py::arg("costs"), py::arg("constraints"),
           py::arg("JMinvJt_damping") = 0.0, py::arg("enable_force") = false)
      .def_property_readonly("actuation", &Model::get_actuation)
      .def_property_readonly("contacts", &Model::get_contacts)
      .def_property_readonly("costs", &Model::get_costs)
      .def_property_readonly("constraints", &Model::get_constraints, "None where there are none.")
      .def_property("armature", &Model::get_armature, &Model::set_armature, "(nv) [kg m^2, kg]")
      .def_property("JMinvJt_damping", &Model::get_damping_factor, &Model::set_damping_factor)
      .def_property_readonly("enable_force", &Model::get_enable_force)
      .def_property(
          "options",
          [](const std::shared_ptr<Model>& x) {
            return Handle<Options>([x]() -> const Options& { return x->get_options(); },
                                   [x](const Options& options) { x->set_options(options); });
          },
          [](Model& x, const Options& options) { x.set_options(options); },
          "Options of the solves, of data created from now on.");
  using Free = DifferentialActionModelFreeFwdDynamics;
  py::class_<Free, Model, std::shared_ptr<Free>>(m, "DifferentialActionModelFreeFwdDynamics", "Without contacts.")
      .def(py::init<State, Actuation, Costs, Constraints>(), py::arg("state"), py::arg("actuation"), py::arg("costs"),
           py::arg("constraints") = py::none());

  using NumDiff = DifferentialActionModelNumDiff;
  py::class_<NumDiff, Abstract, std::shared_ptr<NumDiff>>(m, "DifferentialActionModelNumDiff",
                                                          "A model with derivatives by central differences.")
      .def(py::init<std::shared_ptr<Abstract>, bool>(), py::arg("model").none(false),
           py::arg("with_gauss_approx") = false)
      .def_property_readonly("model", &NumDiff::get_model)
      .def_property("disturbance", &NumDiff::get_disturbance, &NumDiff::set_disturbance);
}

}  // namespace

void add_action(py::module_& m) {
  add_contact_models(m);
  add_impulses(m);
  add_base(m);
  add_forward_dynamics(m);
}

}  // namespace manycontact::python
