#include "action.hpp"
#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/impulse_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "shared.hpp"

namespace manycontact::python {

namespace {

using Index = std::size_t;

// An entry of `running`, which lists the calls to Python that run in this thread. The innermost call is last.
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

// Returns da/dx (nv, ndx) and da/du (nv, nu) of the last calc.
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
  shared<Shared>(m, "DataCollector")
      .read(
          "acceleration", [](const Shared& s) { return s.get().solution.a; }, "tau",
          [](const Shared& s) { return s.get().actuation->tau; }, "report",
          [](const Shared& s) { return s.get().solution.report; })
      .def("contact_force",
           [](const Shared& s, const std::string& name) -> Vector {
             const auto& contacts = s.get().contacts->contacts;
             const auto found = contacts.find(name);
             if (found == contacts.end()) throw py::value_error("there is no contact '" + name + "'");
             return found->second->f;
           })
      .def("acceleration_derivatives", [](const Shared& s) { return acceleration_derivatives(s.get()); })
      .def("frame_placement",
           [](const Shared& s, std::size_t id) {
             const auto& f = s.frame(id);
             return frame_placement<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                            f.placement);
           })
      .def("frame_velocity",
           [](const Shared& s, std::size_t id, ReferenceFrame type) -> Vec6<double> {
             const auto& f = s.frame(id);
             return frame_velocity<double>(s.get().kinematics(f.robot), s.get().scene.robots[f.robot].base, f.joint,
                                           f.placement, type);
           })
      .def("frame_jacobian", [](const Shared& s, std::size_t id, ReferenceFrame type) {
        const auto& f = s.frame(id);
        const Robot& robot = s.get().scene.robots[f.robot];
        Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, robot.model->nv);
        frame_jacobian<double>(*robot.model, s.get().kinematics(f.robot), robot.base, f.joint, f.placement, type, J);
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, s.get().scene.nv);
        out.middleCols(robot.idx_v, robot.model->nv) = J;
        return out;
      });
}

// Returns a getter of a whole matrix: a view if the data contain it, otherwise a copy made from the blocks.
auto whole(Eigen::MatrixXd ResidualDataAbstract::*member, Eigen::MatrixXd (ResidualDataAbstract::*made)() const) {
  return [member, made](const py::object& self) {
    auto& d = self.cast<ResidualDataAbstract&>();
    return (d.*member).size() > 0 ? view(d.*member, self, true) : read_only(copy((d.*made)()));
  };
}

// Returns a setter that copies a whole matrix into the blocks.
template <class Block>
auto set_whole(const char* name, Eigen::MatrixXd ResidualDataAbstract::*member,
               Eigen::MatrixXd (ResidualDataAbstract::*made)() const, Block ResidualBlock::*block,
               std::vector<int> ResidualBlock::*columns) {
  return [=](ResidualDataAbstract& d, const Eigen::MatrixXd& J) {
    expect_shape(name, J, (d.*made)());
    if ((d.*member).size() > 0) d.*member = J;
    for (ResidualBlock& b : d.blocks)
      for (std::size_t i = 0; i < b.rows.size(); ++i)
        for (std::size_t j = 0; j < (b.*columns).size(); ++j) (b.*block)(i, j) = J(b.rows[i], (b.*columns)[j]);
    if ((d.*made)() != J)
      throw py::value_error(std::string(name) +
                            ": an entry is not zero, although the residual does not depend on this coordinate");
  };
}

// Adds a residual with a reference. If this is a cone, Python gets the residual's own object, so that setting its
// members changes the residual. Other references are copied.
template <class T, class... Signatures>
auto residual(py::module_& m) {
  auto c = shared<T, ResidualModelAbstract>(m);
  c.template constructors<Signatures...>();
  if constexpr (requires(T & r) { r.get_reference(); }) {
    using X = std::decay_t<decltype(std::declval<T&>().get_reference())>;
    using Given = std::conditional_t<is_matrix<X> || std::is_same_v<X, SE3<double>>, X, const X&>;
    c.property(
        "reference", [](const T& r) -> Given { return r.get_reference(); },
        [](T& r, const X& x) { r.set_reference(x); });
  }
  return c;
}

void add_residual_base(py::module_& m) {
  using Abstract = ResidualModelAbstract;
  value<Dependence>(m)
      .from_members<bool, bool, bool, bool, bool>()
      .write<&Dependence::q, &Dependence::v, &Dependence::u, &Dependence::acceleration, &Dependence::forces>();

  auto data = shared<ResidualDataAbstract>(m);
  using D = ResidualDataAbstract;
  using B = ResidualBlock;
  data.property("Rx", whole(&D::Rx, &D::whole_Rx), set_whole("Rx", &D::Rx, &D::whole_Rx, &B::Rx, &B::xcols), "Ru",
                whole(&D::Ru, &D::whole_Ru), set_whole("Ru", &D::Ru, &D::whole_Ru, &B::Ru, &B::ucols))
      .read("shared", [](const D& d) { return Scope::shared_of(&d); })
      .views<&D::r>();

  auto model = shared<Abstract, PyResidual>(m);
  data.def(py::init([](const Abstract& model, const std::shared_ptr<Shared>& shared) {
    return std::make_shared<ResidualDataAbstract>(&model, shared->collector());
  }));
  model.constructors<void(State, std::size_t, std::size_t, Dependence)>()
      .def("createData",
           [](Abstract& x, const std::shared_ptr<Shared>& shared) { return x.createData(shared->collector()); })
      .read<&Abstract::get_state, &Abstract::get_nr, &Abstract::get_nu, &Abstract::get_q_dependent,
            &Abstract::get_v_dependent, &Abstract::get_u_dependent>()
      .def("__str__", &text_of<Abstract>);
}

// Adds a residual with constructors (state, id, reference, nu) and (state, id, reference).
template <class T, class Reference>
void residual_of_frame(py::module_& m) {
  auto c = residual<T, void(State, Index, const Reference&, Index), void(State, Index, const Reference&)>(m);
  c.template property<&T::get_id, &T::set_id>();
  if constexpr (std::is_base_of_v<ContactResidual, T>)
    c.template property<&T::get_axes, &T::set_axes, &T::get_contact, &T::set_contact>();
}

void add_residuals_of_states(py::module_& m) {
  using Actuation = std::shared_ptr<ActuationModelAbstract>;
  using V = const Vector&;
  using V3 = const Eigen::Vector3d&;
  using V6 = const Vec6<double>&;
  residual<ResidualModelState, void(State, V, Index), void(State, V), void(State, Index), void(State)>(m);
  residual<ResidualModelControl, void(State, V), void(State, Index), void(State)>(m);
  residual<ResidualModelJointEffort, void(State, Actuation, V, Index), void(State, Actuation, V),
           void(State, Actuation, Index), void(State, Actuation)>(m);
  residual<ResidualModelJointAcceleration, void(State, V, Index), void(State, Index), void(State)>(m);
  residual<ResidualModelCoMPosition, void(State, V3, Index, int), void(State, V3)>(m);
  residual<ResidualModelCentroidalMomentum, void(State, V6, Index, int), void(State, V6)>(m);
  using F = ResidualModelFrameVelocity;
  residual<F, void(State, Index, V6, ReferenceFrame, Index), void(State, Index, V6, ReferenceFrame)>(m)
      .property<&F::get_id, &F::set_id, &F::get_type, &F::set_type>();
  residual<ResidualModelContactForce, void(State, Index, V6, Index, Index), void(State, Index, V6, Index)>(m);
  residual<ResidualModelControlGrav, void(State, Index), void(State)>(m);
  residual<ResidualModelContactControlGrav, void(State, Index), void(State)>(m);
  residual<ResidualModelImpulseCoM, void(State)>(m);
}

void add_residuals_of_frames(py::module_& m) {
  residual_of_frame<ResidualModelFramePlacement, SE3<double>>(m);
  residual_of_frame<ResidualModelFrameTranslation, Eigen::Vector3d>(m);
  residual_of_frame<ResidualModelFrameRotation, Eigen::Matrix3d>(m);
  residual_of_frame<ResidualModelContactFrictionCone, FrictionCone>(m);
  residual_of_frame<ResidualModelContactWrenchCone, WrenchCone>(m);
  residual_of_frame<ResidualModelContactCoPPosition, CoPSupport>(m);
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
  throw py::value_error("data.shared is available only while calc and calcDiff of a class written in Python run");
}

void add_residual_models(py::module_& m) {
  add_shared(m);
  add_residual_base(m);
  enumeration<ConeAxes>(m);
  add_residuals_of_states(m);
  add_residuals_of_frames(m);
}

}  // namespace manycontact::python
