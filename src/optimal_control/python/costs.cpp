#include "action.hpp"
#include "manycontact/action/cones.hpp"
#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "shared.hpp"

namespace manycontact::python {

namespace {

// Adds a property of a cone, whose setter also updates the cone.
template <class Cone, class... Given>
void add_updated(Class<Cone>& c, Given... given) {
  const auto add = [&c]<class X>(const char* name, X (Cone::*get)() const, auto set) {
    c.property(name, get, [set](Cone& x, const std::decay_t<X>& value) { (x.*set)(value), x.update(); });
  };
  in_groups<3>(add, given...);
}

// Adds a cone class. A cone is pickled as its class and the arguments of its constructor.
template <class Cone, class... Arguments>
void add_cone(py::module_& m, auto... arguments) {
  Class<Cone> c(m);
  add_copy(c)
      .template constructors<void(Arguments...)>()
      .template methods<&Cone::update>()
      .template read<&Cone::get_A, &Cone::get_lb, &Cone::get_ub>();
  add_updated(c, "R", &Cone::get_R, &Cone::set_R);
  if constexpr (requires { &Cone::get_mu; }) {
    c.template read<&Cone::get_nf>();
    add_updated(c, "mu", &Cone::get_mu, &Cone::set_mu, "inner_appr", &Cone::get_inner_appr, &Cone::set_inner_appr,
                "min_nforce", &Cone::get_min_nforce, &Cone::set_min_nforce, "max_nforce", &Cone::get_max_nforce,
                &Cone::set_max_nforce);
  }
  if constexpr (requires { &Cone::get_box; }) add_updated(c, "box", &Cone::get_box, &Cone::set_box);
  c.methods("__str__", &text_of<Cone>).def("__reduce__", [arguments...](const Cone& x) {
    return py::make_tuple(py::type::of<Cone>(), py::make_tuple((x.*arguments)()...));
  });
}

void add_cones(py::module_& m) {
  using R = const Eigen::Matrix3d&;
  using Box = const Eigen::Vector2d&;
  using F = FrictionCone;
  using W = WrenchCone;
  add_cone<F, R, double, std::size_t, bool, double, double>(m, &F::get_R, &F::get_mu, &F::get_nf, &F::get_inner_appr,
                                                            &F::get_min_nforce, &F::get_max_nforce);
  add_cone<W, R, double, Box, std::size_t, bool, double, double>(
      m, &W::get_R, &W::get_mu, &W::get_box, &W::get_nf, &W::get_inner_appr, &W::get_min_nforce, &W::get_max_nforce);
  add_cone<CoPSupport, R, Box>(m, &CoPSupport::get_R, &CoPSupport::get_box);
}

using CostData = std::shared_ptr<CostDataAbstract>;

// A base class for costs written in Python. T is CostModelAbstract, or a cost class of this library.
template <class T>
struct PyCost : T {
  using T::T;
  void calc(const CostData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    MANYCONTACT_OVERRIDE(void, T, calc, data, x, u);
  }
  void calc(const CostData& data, const ConstVectorRef& x) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calc, data, x);
  }
  void calcDiff(const CostData& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x, u);
  }
  void calcDiff(const CostData& data, const ConstVectorRef& x) override {
    const Scope scope(*this, *data);
    PYBIND11_OVERRIDE(void, T, calcDiff, data, x);
  }
  CostData createData(DataCollector* collector) override {
    CostData data = created_in_python<T, CostDataAbstract>(this, collector);
    return data ? data : T::createData(collector);
  }
};

// Adds getters of derivatives, which return views for user-defined costs, and copies for other costs.
template <class... Given>
void add_derivatives(Class<CostDataAbstract, CostData>& c, Given... given) {
  const auto add = [&c]<class M>(const char* name, M CostDerivatives::*made, M CostDataAbstract::*member) {
    c.property(
        name,
        [made, member](py::object self) {
          auto& d = self.cast<CostDataAbstract&>();
          return d.own ? view(d.*member, self, true) : read_only(copy(d.whole_derivatives().*made));
        },
        [name, member](CostDataAbstract& d, py::handle values) {
          if (!d.own)
            throw py::type_error(std::string(name) +
                                 " is computed from the residual's derivatives and cannot be assigned");
          assign(d.*member, values);
        });
  };
  in_groups<3>(add, given...);
}

void add_cost_data(py::module_& m) {
  auto data = shared<CostDataAbstract>(m);
  data.def(py::init([](CostModelAbstract& model, const std::shared_ptr<Shared>& shared) {
        return std::make_shared<CostDataAbstract>(&model, shared->collector());
      }))
      .write<&CostDataAbstract::cost>()
      .read<&CostDataAbstract::activation, &CostDataAbstract::residual>()
      .read("shared", [](const CostDataAbstract& d) { return Scope::shared_of(&d); });
  using D = CostDerivatives;
  using Own = CostDataAbstract;
  add_derivatives(data, "Lx", &D::Lx, &Own::Lx, "Lu", &D::Lu, &Own::Lu, "Lxx", &D::Lxx, &Own::Lxx, "Lxu", &D::Lxu,
                  &Own::Lxu, "Luu", &D::Luu, &Own::Luu);
  m.attr("CostDataResidual") = m.attr("CostDataAbstract");
}

void add_cost_models(py::module_& m) {
  using Activation = std::shared_ptr<ActivationModelAbstract>;
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using Abstract = CostModelAbstract;
  auto abstract = shared<Abstract, PyCost<Abstract>>(m);
  add_cost_data(m);
  abstract.constructors<void(State, Activation, Residual), void(State, Activation, std::size_t), void(State, Residual),
                        void(State, Activation), void(State, std::size_t), void(State)>();
  add_calc<CostDataAbstract>(abstract);
  abstract
      .def("createData",
           [](Abstract& c, const std::shared_ptr<Shared>& shared) { return c.createData(shared->collector()); })
      .read<&Abstract::get_state, &Abstract::get_activation, &Abstract::get_residual, &Abstract::get_nu>()
      .def("__str__", &text_of<Abstract>);
  shared<CostModelResidual, PyCost<CostModelResidual>, Abstract>(m)
      .constructors<void(State, Activation, Residual), void(State, Residual)>();
  shared<CostItem>(m).read<&CostItem::name, &CostItem::cost, &CostItem::active>().write<&CostItem::weight>();
  using Sum = CostModelSum;
  shared<Sum>(m)
      .constructors<void(State, std::size_t), void(State)>()
      .methods<&Sum::addCost, &Sum::removeCost, &Sum::changeCostStatus, &Sum::getCostStatus>()
      .read<&Sum::get_state, &Sum::get_costs, &Sum::get_nu, &Sum::get_nr, &Sum::get_active_set,
            &Sum::get_inactive_set>()
      .def("__str__", &text_of<Sum>);
}

void add_constraints(py::module_& m) {
  using Residual = std::shared_ptr<ResidualModelAbstract>;
  using One = ConstraintModelResidual;
  shared<One>(m)
      .def(py::init([](State state, Residual residual, const Bounds& lower, const Bounds& upper, bool T_act) {
        return std::make_shared<One>(std::move(state), std::move(residual), lower.x, upper.x, T_act);
      }))
      .constructors<void(State, Residual, bool)>()
      .read<&One::get_residual, &One::get_ng, &One::get_nh, &One::get_lb, &One::get_ub>()
      .def("__str__", &text_of<One>);
  using Manager = ConstraintModelManager;
  shared<Manager>(m)
      .constructors<void(State, std::size_t), void(State)>()
      .methods<&Manager::addConstraint, &Manager::removeConstraint, &Manager::changeConstraintStatus,
               &Manager::getConstraintStatus>()
      .read<&Manager::get_ng, &Manager::get_nh, &Manager::get_ng_T, &Manager::get_nh_T, &Manager::get_lb,
            &Manager::get_ub, &Manager::get_active_set, &Manager::get_inactive_set>()
      .def("__str__", &text_of<Manager>);
}

}  // namespace

void add_costs(py::module_& m) {
  add_cones(m);
  add_cost_models(m);
  add_constraints(m);
}

}  // namespace manycontact::python
