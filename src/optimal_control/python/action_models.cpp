#include "action.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/action/impulse.hpp"
#include "manycontact/action/num_diff.hpp"
#include "manycontact/control/free_fwddyn.hpp"

namespace manycontact::python {

namespace {

using Gains2 = Eigen::Vector2d;

void add_contact_models(py::module_& m) {
  using Abstract = ContactModelAbstract;
  shared<Abstract>(m)
      .read<&Abstract::get_state, &Abstract::get_nc, &Abstract::get_nu>()
      .property<&Abstract::get_id, &Abstract::set_id, &Abstract::get_type, &Abstract::set_type, &Abstract::get_gains,
                &Abstract::set_gains>()
      .def("__str__", &text_of<Abstract>);

  shared<ContactModel1D, ContactModelAbstract>(m)
      .constructors<void(State, std::size_t, double, ReferenceFrame, const Eigen::Matrix3d&, std::size_t,
                         const Gains2&),
                    void(State, std::size_t, double, std::size_t, const Gains2&)>()
      .property<&ContactModel1D::get_axis, &ContactModel1D::set_axis>()
      .property("reference", &ContactModel1D::get_reference, [](ContactModel1D& c, double x) { c.set_reference(x); });
  shared<ContactModel2D, ContactModelAbstract>(m)
      .constructors<void(State, std::size_t, const Eigen::Vector2d&, std::size_t, const Gains2&, ReferenceFrame)>()
      .property<&ContactModel2D::get_reference, &ContactModel2D::set_reference>();
  shared<ContactModel3D, ContactModelAbstract>(m)
      .constructors<void(State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, std::size_t, const Gains2&),
                    void(State, std::size_t, const Eigen::Vector3d&, ReferenceFrame, const Gains2&)>()
      .property<&ContactModel3D::get_reference, &ContactModel3D::set_reference>();
  shared<ContactModel6D, ContactModelAbstract>(m)
      .constructors<void(State, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t, const Gains2&),
                    void(State, std::size_t, const SE3<double>&, ReferenceFrame, const Gains2&)>()
      .property(
          "reference", [](const ContactModel6D& c) -> SE3<double> { return c.get_reference(); },
          &ContactModel6D::set_reference);
  shared<ContactModelBetweenBodies, ContactModelAbstract>(m)
      .constructors<void(State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame, std::size_t,
                         const Gains2&, const Eigen::Vector3d&)>()
      .read<&ContactModelBetweenBodies::get_to>();
  shared<ContactModelOfScene, ContactModelAbstract>(m).constructors<void(State, const Contact&, std::size_t)>();

  shared<ContactDataAbstract>(m)
      .read("f", [](const ContactDataAbstract& d) { return Vector(d.f); })
      .read<&ContactDataAbstract::Jc, &ContactDataAbstract::a0, &ContactDataAbstract::v_columns,
            &ContactDataAbstract::active>();

  shared<ContactItem>(m).read<&ContactItem::name, &ContactItem::contact, &ContactItem::active>();
  using Multiple = ContactModelMultiple;
  shared<Multiple>(m)
      .constructors<void(State, std::size_t), void(State)>()
      .methods<&Multiple::addContact, &Multiple::removeContact, &Multiple::changeContactStatus,
               &Multiple::getContactStatus>()
      .read<&Multiple::get_contacts, &Multiple::get_nc, &Multiple::get_nc_total, &Multiple::get_nu,
            &Multiple::get_active_set, &Multiple::get_inactive_set>()
      .def("__str__", &text_of<Multiple>);
  def(m, "contacts_of_scene", &contacts_of_scene);
}

void add_impulses(py::module_& m) {
  using Abstract = ImpulseModelAbstract;
  shared<Abstract>(m)
      .read<&Abstract::get_nc>()
      .property<&Abstract::get_id, &Abstract::set_id, &Abstract::get_type, &Abstract::set_type>()
      .def("__str__", &text_of<Abstract>);
  shared<ImpulseModel3D, Abstract>(m).constructors<void(State, std::size_t, ReferenceFrame)>();
  shared<ImpulseModel6D, Abstract>(m).constructors<void(State, std::size_t, ReferenceFrame)>();
  shared<ImpulseModelBetweenBodies, Abstract>(m)
      .constructors<void(State, ContactType, std::size_t, std::size_t, const SE3<double>&, ReferenceFrame,
                         const Eigen::Vector3d&)>();
  using Multiple = ImpulseModelMultiple;
  shared<Multiple>(m)
      .constructors<void(State)>()
      .methods<&Multiple::addImpulse, &Multiple::removeImpulse, &Multiple::changeImpulseStatus,
               &Multiple::getImpulseStatus>()
      .read<&Multiple::get_nc>()
      .def("__str__", &text_of<Multiple>);
}

using Abstract = DifferentialActionModelAbstract;
using AbstractData = DifferentialActionDataAbstract;

// Returns a Python getter that copies a sparse matrix to a scipy matrix.
auto sparse(const Eigen::SparseMatrix<double>& (AbstractData::*get)() const) {
  return [get](const AbstractData& d) {
    Eigen::SparseMatrix<double> matrix = (d.*get)();
    matrix.makeCompressed();
    const py::object copied = scipy_csc(std::move(matrix));
    read_only(copied.attr("data"));
    return copied;
  };
}

void add_base(py::module_& m) {
  enumeration<MatrixStorage>(m);

  auto data = shared<AbstractData>(m);
  auto model = shared<Abstract, PyActionModel<Abstract, AbstractData>>(m);
  data.constructors<void(const Abstract*)>();
  add_action_data(data);
  data.views<&AbstractData::xout>();
  using D = AbstractData;
  data.read("Fx_sparse", sparse(&D::Fx_sparse), "Fu_sparse", sparse(&D::Fu_sparse), "Lxx_sparse",
            sparse(&D::Lxx_sparse), "Lxu_sparse", sparse(&D::Lxu_sparse), "Luu_sparse", sparse(&D::Luu_sparse));

  model.constructors<void(std::shared_ptr<StateAbstract>, std::size_t, std::size_t, std::size_t, std::size_t)>();
  add_action_model<AbstractData>(model);
  model.property<&Abstract::get_storage, &Abstract::set_storage>();
}

void add_forward_dynamics(py::module_& m) {
  using Data = DifferentialActionDataContactFwdDynamics;
  using Model = DifferentialActionModelContactFwdDynamics;
  using Actuation = std::shared_ptr<ActuationModelAbstract>;
  using Contacts = std::shared_ptr<ContactModelMultiple>;
  using Costs = std::shared_ptr<CostModelSum>;
  using Constraints = std::shared_ptr<ConstraintModelManager>;

  shared<Data, AbstractData>(m).read(
      "report", [](const Data& d) { return d.report(); }, "costs", [](const Data& d) { return d.costs->costs; },
      "contacts", [](const Data& d) { return d.multibody->contacts->contacts; });

  shared<Model, Abstract>(m)
      .constructors<void(State, Actuation, Contacts, Costs, double, bool),
                    void(State, Actuation, Contacts, Costs, Constraints, double, bool)>()
      .read<&Model::get_actuation, &Model::get_contacts, &Model::get_costs, &Model::get_constraints,
            &Model::get_enable_force>()
      .property<&Model::get_armature, &Model::set_armature>()
      .property(
          "JMinvJt_damping", &Model::get_damping_factor, &Model::set_damping_factor, "options",
          [](const std::shared_ptr<Model>& x) {
            return Handle<Options>([x]() -> const Options& { return x->get_options(); },
                                   [x](const Options& options) { x->set_options(options); });
          },
          [](Model& x, const Options& options) { x.set_options(options); });
  using Free = DifferentialActionModelFreeFwdDynamics;
  shared<Free, Model>(m).constructors<void(State, Actuation, Costs, Constraints)>();

  using NumDiff = DifferentialActionModelNumDiff;
  shared<NumDiff, Abstract>(m)
      .constructors<void(std::shared_ptr<Abstract>, bool)>()
      .read<&NumDiff::get_model>()
      .property<&NumDiff::get_disturbance, &NumDiff::set_disturbance>();
}

}  // namespace

void add_action(py::module_& m) {
  add_contact_models(m);
  add_impulses(m);
  add_base(m);
  add_forward_dynamics(m);
}

}  // namespace manycontact::python
