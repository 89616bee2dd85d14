#include "action.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/callbacks.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/detail/control/sparse.hpp"

namespace manycontact::python {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;
using Problem = std::shared_ptr<ShootingProblem>;

void add_problem(py::module_& m) {
  using P = ShootingProblem;
  using Model = std::shared_ptr<ActionModelAbstract>;
  shared<P>(m)
      .constructors<void(const Eigen::VectorXd&, const P::Models&, Model)>(Unlocked())
      .unlocked<&P::calc, &P::calcDiff>()
      .unlocked("rollout", &P::rollout_us, "quasiStatic", &P::quasiStatic_xs)
      .def("circularAppend", py::overload_cast<Model>(&P::circularAppend), Unlocked())
      .def("circularAppend", py::overload_cast<Model, std::shared_ptr<ActionDataAbstract>>(&P::circularAppend),
           Unlocked())
      .def("updateModel", &P::updateModel, Unlocked())
      .read<&P::get_T, &P::get_runningModels, &P::get_terminalModel, &P::get_runningDatas, &P::get_terminalData,
            &P::get_nx, &P::get_ndx, &P::get_nu_max>()
      .property<&P::get_x0, &P::set_x0>()
      .property("nthreads", &P::get_nthreads, [](P& p, int n) { p.set_nthreads(checked_threads(n)); })
      .def("__str__", &text_of<P>);
}

// A base class for solvers written in Python, where T is SolverDDP or a subclass. solve() calls methods of Python.
template <class T>
struct PySolver : T {
  using T::T;
  void computeDirection(bool recalc) override { PYBIND11_OVERRIDE(void, T, computeDirection, recalc); }
  double tryStep(double steplength) override { PYBIND11_OVERRIDE(double, T, tryStep, steplength); }
  double stoppingCriteria() override { PYBIND11_OVERRIDE(double, T, stoppingCriteria, ); }
  const Eigen::Vector2d& expectedImprovement() override {
    {
      const py::gil_scoped_acquire gil;
      if (const py::function own = py::get_override(static_cast<const T*>(this), "expectedImprovement"))
        return this->d_ = own().template cast<Eigen::Vector2d>();
    }
    return T::expectedImprovement();
  }
  void resizeData() override { PYBIND11_OVERRIDE(void, T, resizeData, ); }
  double calcDiff() override {
    const auto cost = [this]() -> double { PYBIND11_OVERRIDE(double, T, calcDiff, ); };
    return this->cost_ = cost();  // Python code cannot set cost_
  }
  void backwardPass() override { PYBIND11_OVERRIDE(void, T, backwardPass, ); }
  void forwardPass(double steplength) override { PYBIND11_OVERRIDE(void, T, forwardPass, steplength); }
  void increaseRegularization() override { PYBIND11_OVERRIDE(void, T, increaseRegularization, ); }
  void decreaseRegularization() override { PYBIND11_OVERRIDE(void, T, decreaseRegularization, ); }
  void allocateData() override { PYBIND11_OVERRIDE(void, T, allocateData, ); }
};

struct PyCallback : CallbackAbstract {
  [[noreturn]] static void throw_undefined() {
    throw py::value_error("CallbackAbstract: the class of the callback does not define __call__(self, solver)");
  }
  void operator()(SolverAbstract& solver) override {
    const py::gil_scoped_acquire gil;
    const py::object self = py::cast(static_cast<CallbackAbstract*>(this), py::return_value_policy::reference);
    const py::object own = py::type::of(self).attr("__call__");  // get_override fails inside a running __call__
    if (own.is(py::type::of<CallbackAbstract>().attr("__call__"))) throw_undefined();
    own(self, py::cast(&solver, py::return_value_policy::reference));
  }
};

using Callbacks = std::vector<std::shared_ptr<CallbackAbstract>>;

// The only callback of a solver while solve() runs. It calls the user's callbacks, and ends the solve after Ctrl-C. If
// a callback replaces the list of callbacks, the new list is used from the next iteration on.
struct Solving : CallbackAbstract {
  explicit Solving(Callbacks of) : users(std::move(of)) {}
  void operator()(SolverAbstract& solver) override {
    const py::gil_scoped_acquire gil;
    const Callbacks now = users;
    for (const auto& callback : now) (*callback)(solver);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  Callbacks users;
};

Solving* solving(const SolverAbstract& solver) {
  const Callbacks& all = solver.getCallbacks();
  return all.size() == 1 ? dynamic_cast<Solving*>(all.front().get()) : nullptr;
}

const Callbacks& callbacks_of(const SolverAbstract& solver) {
  const Solving* now = solving(solver);
  return now ? now->users : solver.getCallbacks();
}

void set_callbacks(SolverAbstract& solver, const Callbacks& callbacks) {
  Solving* now = solving(solver);
  if (!now) return solver.setCallbacks(callbacks);
  if (std::ranges::find(callbacks, nullptr) != callbacks.end())
    throw py::value_error("setCallbacks: a callback is None");
  now->users = callbacks;
}

bool solve_problem(SolverAbstract& solver, const Vectors& xs, const Vectors& us, std::size_t maxiter, bool feasible,
                   double init_reg) {
  if (solving(solver))
    throw py::value_error(
        "solve: this solver is in use; a callback may call interrupt(), or solve with another solver");
  const auto call = std::make_shared<Solving>(solver.getCallbacks());
  struct Restore {
    SolverAbstract& solver;
    Solving& call;
    ~Restore() { solver.setCallbacks(call.users); }
  } const restore{solver, *call};
  solver.setCallbacks({call});
  const py::gil_scoped_release unlocked;
  return solver.solve(xs, us, maxiter, feasible, init_reg);
}

// ---- garbage ------------------------------------------------------------------------------------------------------
// A callback written in Python may refer to its solver, which owns the callback. Python's garbage collector finds such
// cycles, because a solver reports the callbacks that it owns, unless another C++ object owns them too.

template <class Use>
void each_kept_callback(PyObject* self, Use&& use) {
  const auto* instance = reinterpret_cast<py::detail::instance*>(self);
  const auto value = const_cast<py::detail::instance*>(instance)->get_value_and_holder();
  if (!value.holder_constructed()) return;
  const auto& solver = value.holder<std::shared_ptr<SolverAbstract>>();
  if (solver.use_count() != 1) return;
  for (const auto& callback : callbacks_of(*solver)) {
    if (callback.use_count() != 1 || !dynamic_cast<const PyCallback*>(callback.get())) continue;
    use(py::detail::get_object_handle(callback.get(), py::detail::get_type_info(typeid(CallbackAbstract))).ptr());
  }
}

int visit_callbacks(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  int result = 0;
  each_kept_callback(self, [&](PyObject* callback) {
    if (callback && result == 0) result = visit(callback, arg);
  });
  return result;
}

int clear_callbacks(PyObject* self) {
  const auto value = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder();
  if (value.holder_constructed()) value.holder<std::shared_ptr<SolverAbstract>>()->setCallbacks({});
  return 0;
}

const py::custom_type_setup kCollected([](PyHeapTypeObject* type) {
  type->ht_type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type->ht_type.tp_traverse = &visit_callbacks;
  type->ht_type.tp_clear = &clear_callbacks;
});

void add_solver_base(py::module_& m) {
  enumeration<StopReason>(m);

  using S = SolverAbstract;
  auto callback = shared<CallbackAbstract, PyCallback>(m);
  auto solver = shared<S>(m, "SolverAbstract", kCollected);
  callback.constructors<void()>().def("__call__", [](CallbackAbstract& c, SolverAbstract& of) {
    // There is no __call__, or super().__call__ was called.
    if (dynamic_cast<PyCallback*>(&c)) PyCallback::throw_undefined();
    c(of);
  });
  solver.def("solve", &solve_problem)
      .unlocked<&S::computeDirection, &S::tryStep, &S::stoppingCriteria, &S::expectedImprovement, &S::resizeData>()
      .methods<&S::setCandidate, &S::interrupt>()
      .methods("setCallbacks", &set_callbacks, "getCallbacks", &callbacks_of)
      .read<&S::reason, &S::get_problem, &S::get_fs, &S::get_cost, &S::get_merit, &S::get_stop, &S::get_d, &S::get_dV,
            &S::get_ffeas, &S::get_gfeas, &S::get_hfeas, &S::get_iter>()
      .property<&S::get_xs, &S::set_xs, &S::get_us, &S::set_us, &S::get_preg, &S::set_preg, &S::get_th_stop,
                &S::set_th_stop>()
      .read("isFeasible", &S::get_is_feasible, "dV_exp", &S::get_dVexp, "stepLength", &S::get_steplength)
      .property("th_acceptStep", &S::get_th_acceptstep, &S::set_th_acceptstep, "th_gapTol", &S::get_th_gaptol,
                &S::set_th_gaptol);
}

void add_solver_classes(py::module_& m) {
  using D = SolverDDP;
  shared<D, PySolver<D>, SolverAbstract>(m)
      .constructors<void(Problem)>(Unlocked())
      .unlocked<&D::calcDiff, &D::backwardPass, &D::allocateData, &D::increaseRegularization,
                &D::decreaseRegularization, &D::forwardPass>()
      .read<&D::get_Vxx, &D::get_Vx, &D::get_Qxx, &D::get_Qxu, &D::get_Quu, &D::get_Qx, &D::get_Qu, &D::get_K,
            &D::get_k>()
      .property<&D::get_alphas, &D::set_alphas, &D::get_reg_min, &D::set_reg_min, &D::get_reg_max, &D::set_reg_max,
                &D::get_th_grad, &D::set_th_grad>();
  shared<SolverFDDP, PySolver<SolverFDDP>, D>(m)
      .constructors<void(Problem)>(Unlocked())
      .property("th_acceptNegStep", &SolverFDDP::get_th_acceptnegstep, &SolverFDDP::set_th_acceptnegstep);
  shared<SolverBoxDDP, PySolver<SolverBoxDDP>, D>(m).constructors<void(Problem)>(Unlocked());
  shared<SolverBoxFDDP, PySolver<SolverBoxFDDP>, SolverFDDP>(m).constructors<void(Problem)>(Unlocked());
  shared<SolverSparse, PySolver<SolverSparse>, SolverFDDP>(m)
      .constructors<void(Problem, bool)>(Unlocked())
      .def("blocks", &SolverSparse::blocks);
  using A = SolverAugmentedLagrangian;
  shared<A, SolverAbstract>(m)
      .constructors<void(Problem)>(Unlocked())
      .def("reset", &A::reset)
      .property<&A::get_multipliers, &A::set_multipliers, &A::get_penalty, &A::set_penalty, &A::get_penalty_init,
                &A::set_penalty_init, &A::get_th_constraint, &A::set_th_constraint, &A::get_th_kkt, &A::set_th_kkt>()
      .read<&A::get_violation, &A::get_kkt_residual, &A::get_outer_iter>();
  def(m, "kkt_residual", &kkt_residual, Unlocked());
}

void add_callbacks(py::module_& m) {
  enumeration<VerboseLevel, _0, _1, _2, _3, _4>(m);
  shared<CallbackVerbose, CallbackAbstract>(m)
      .constructors<void(VerboseLevel, int)>()
      .property<&CallbackVerbose::get_level, &CallbackVerbose::set_level, &CallbackVerbose::get_precision,
                &CallbackVerbose::set_precision>();
  using L = CallbackLogger;
  shared<L, CallbackAbstract>(m)
      .constructors<void()>()
      .read<&L::xs, &L::us, &L::fs, &L::iters, &L::costs, &L::stops, &L::grads, &L::pregs, &L::steps, &L::ffeass,
            &L::gfeass, &L::hfeass, &L::feasible>();
}

}  // namespace

void add_solvers(py::module_& m) {
  add_problem(m);
  add_solver_base(m);
  add_callbacks(m);
  add_solver_classes(m);
}

}  // namespace manycontact::python
