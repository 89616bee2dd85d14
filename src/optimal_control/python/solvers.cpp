// Shooting problems, solvers and callbacks.

#include "action.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/callbacks.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/control/solver_kkt.hpp"
#include "manycontact/control/sparse.hpp"

namespace manycontact::python {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;
using Problem = std::shared_ptr<ShootingProblem>;

void add_problem(py::module_& m) {
  using P = ShootingProblem;
  using Model = std::shared_ptr<ActionModelAbstract>;
  shared<P>(m, "ShootingProblem")
      .constructors<void(const Eigen::VectorXd&, const P::Models&, Model)>(Unlocked())
      .unlocked("calc", &P::calc, "calcDiff", &P::calcDiff, "rollout", &P::rollout_us, "quasiStatic",
                &P::quasiStatic_xs)
      .def("circularAppend", py::overload_cast<Model>(&P::circularAppend), Unlocked())
      .def("circularAppend", py::overload_cast<Model, std::shared_ptr<ActionDataAbstract>>(&P::circularAppend),
           Unlocked())
      .def("updateModel", &P::updateModel, Unlocked())
      .read("T", &P::get_T)
      .property("x0", &P::get_x0, &P::set_x0)
      .read("runningModels", &P::get_runningModels, "terminalModel", &P::get_terminalModel, "runningDatas",
            &P::get_runningDatas, "terminalData", &P::get_terminalData, "nx", &P::get_nx, "ndx", &P::get_ndx, "nu_max",
            &P::get_nu_max)
      .property("nthreads", &P::get_nthreads, [](P& p, int n) { p.set_nthreads(checked_threads(n)); })
      .def("__str__", &text_of<P>);
}

// A class to derive from. T: SolverDDP, or one of the library's that derive from it. solve() calls what Python defines.
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
    return this->cost_ = cost();  // Python cannot set it
  }
  void backwardPass() override { PYBIND11_OVERRIDE(void, T, backwardPass, ); }
  void forwardPass(double steplength) override { PYBIND11_OVERRIDE(void, T, forwardPass, steplength); }
  void increaseRegularization() override { PYBIND11_OVERRIDE(void, T, increaseRegularization, ); }
  void decreaseRegularization() override { PYBIND11_OVERRIDE(void, T, decreaseRegularization, ); }
  void allocateData() override { PYBIND11_OVERRIDE(void, T, allocateData, ); }
};

struct PyCallback : CallbackAbstract {
  [[noreturn]] static void throw_undefined() {
    throw py::value_error("CallbackAbstract: __call__(self, solver) is to be defined");
  }
  void operator()(SolverAbstract& solver) override {
    const py::gil_scoped_acquire gil;
    const py::object self = py::cast(static_cast<CallbackAbstract*>(this), py::return_value_policy::reference);
    const py::object own = py::type::of(self).attr("__call__");  // not get_override, which finds none while it runs
    if (own.is(py::type::of<CallbackAbstract>().attr("__call__"))) throw_undefined();
    own(self, py::cast(&solver, py::return_value_policy::reference));
  }
};

using Callbacks = std::vector<std::shared_ptr<CallbackAbstract>>;

// The only callback of a solver while solve() runs: calls the user's, which may be replaced meanwhile, from the next
// iteration on; then Ctrl-C ends the solve.
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
  if (std::find(callbacks.begin(), callbacks.end(), nullptr) != callbacks.end())
    throw py::value_error("setCallbacks: a callback is None");
  now->users = callbacks;
}

bool solve_problem(SolverAbstract& solver, const Vectors& xs, const Vectors& us, std::size_t maxiter, bool feasible,
                   double init_reg) {
  if (solving(solver))
    throw py::value_error("solve: this solver is solving; a callback may interrupt() it, or solve by another solver");
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
// A callback written in Python may refer to its solver, which keeps the callback. Python's collector finds such cycles,
// because a solver reports to it the callbacks that it keeps. It may only report those that nothing else in C++ keeps.

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
  enumeration<StopReason>(m, "StopReason");

  using S = SolverAbstract;
  auto callback = shared<CallbackAbstract, PyCallback>(m, "CallbackAbstract");
  auto solver = shared<S>(m, "SolverAbstract", kCollected);
  callback.constructors<void()>().def("__call__", [](CallbackAbstract& c, SolverAbstract& of) {
    if (dynamic_cast<PyCallback*>(&c)) PyCallback::throw_undefined();  // it has none, or calls super()'s
    c(of);
  });
  solver.def("solve", &solve_problem)
      .unlocked("computeDirection", &S::computeDirection, "tryStep", &S::tryStep, "stoppingCriteria",
                &S::stoppingCriteria, "expectedImprovement", &S::expectedImprovement, "resizeData", &S::resizeData)
      .methods("setCandidate", &S::setCandidate, "setCallbacks", &set_callbacks, "getCallbacks", &callbacks_of,
               "interrupt", &S::interrupt)
      .read("reason", &S::reason, "problem", &S::get_problem)
      .property("xs", &S::get_xs, &S::set_xs, "us", &S::get_us, &S::set_us)
      .read("fs", &S::get_fs, "isFeasible", &S::get_is_feasible, "cost", &S::get_cost, "merit", &S::get_merit, "stop",
            &S::get_stop, "d", &S::get_d, "dV", &S::get_dV, "dV_exp", &S::get_dVexp, "ffeas", &S::get_ffeas, "gfeas",
            &S::get_gfeas, "hfeas", &S::get_hfeas, "stepLength", &S::get_steplength, "iter", &S::get_iter)
      .property("preg", &S::get_preg, &S::set_preg, "th_acceptStep", &S::get_th_acceptstep, &S::set_th_acceptstep,
                "th_stop", &S::get_th_stop, &S::set_th_stop, "th_gapTol", &S::get_th_gaptol, &S::set_th_gaptol);
}

void add_solver_classes(py::module_& m) {
  using D = SolverDDP;
  shared<D, PySolver<D>, SolverAbstract>(m, "SolverDDP")
      .constructors<void(Problem)>(Unlocked())
      .unlocked("calcDiff", &D::calcDiff, "backwardPass", &D::backwardPass, "allocateData", &D::allocateData,
                "increaseRegularization", &D::increaseRegularization, "decreaseRegularization",
                &D::decreaseRegularization, "forwardPass", &D::forwardPass)
      .read("Vxx", &D::get_Vxx, "Vx", &D::get_Vx, "Qxx", &D::get_Qxx, "Qxu", &D::get_Qxu, "Quu", &D::get_Quu, "Qx",
            &D::get_Qx, "Qu", &D::get_Qu, "K", &D::get_K, "k", &D::get_k)
      .property("alphas", &D::get_alphas, &D::set_alphas, "reg_min", &D::get_reg_min, &D::set_reg_min, "reg_max",
                &D::get_reg_max, &D::set_reg_max, "th_grad", &D::get_th_grad, &D::set_th_grad);
  shared<SolverFDDP, PySolver<SolverFDDP>, D>(m, "SolverFDDP")
      .constructors<void(Problem)>(Unlocked())
      .property("th_acceptNegStep", &SolverFDDP::get_th_acceptnegstep, &SolverFDDP::set_th_acceptnegstep);
  shared<SolverBoxDDP, PySolver<SolverBoxDDP>, D>(m, "SolverBoxDDP").constructors<void(Problem)>(Unlocked());
  shared<SolverBoxFDDP, PySolver<SolverBoxFDDP>, SolverFDDP>(m, "SolverBoxFDDP")
      .constructors<void(Problem)>(Unlocked());
  shared<SolverKKT, SolverAbstract>(m, "SolverKKT")
      .constructors<void(Problem)>(Unlocked())
      .def("calcDiff", &SolverKKT::calcDiff, Unlocked())
      .read("kkt", &SolverKKT::get_kkt, "kktref", &SolverKKT::get_kktref, "primaldual", &SolverKKT::get_primaldual,
            "dxs", &SolverKKT::get_dxs, "dus", &SolverKKT::get_dus, "lambdas", &SolverKKT::get_lambdas);
  shared<SolverSparse, PySolver<SolverSparse>, SolverFDDP>(m, "SolverSparse")
      .constructors<void(Problem, bool)>(Unlocked())
      .def("blocks", &SolverSparse::blocks);
  using A = SolverAugmentedLagrangian;
  shared<A, SolverAbstract>(m, "SolverAugmentedLagrangian")
      .constructors<void(Problem)>(Unlocked())
      .def("reset", &A::reset)
      .property("multipliers", &A::get_multipliers, &A::set_multipliers)
      .read("violation", &A::get_violation, "kkt_residual", &A::get_kkt_residual, "outer_iter", &A::get_outer_iter)
      .property("penalty", &A::get_penalty, &A::set_penalty, "penalty_init", &A::get_penalty_init, &A::set_penalty_init,
                "th_constraint", &A::get_th_constraint, &A::set_th_constraint, "th_kkt", &A::get_th_kkt,
                &A::set_th_kkt);
  def(m, "kkt_residual", &kkt_residual, Unlocked());
}

void add_callbacks(py::module_& m) {
  enumeration<VerboseLevel, _0, _1, _2, _3, _4>(m, "VerboseLevel");
  shared<CallbackVerbose, CallbackAbstract>(m, "CallbackVerbose")
      .constructors<void(VerboseLevel, int)>()
      .property("level", &CallbackVerbose::get_level, &CallbackVerbose::set_level, "precision",
                &CallbackVerbose::get_precision, &CallbackVerbose::set_precision);
  using L = CallbackLogger;
  shared<L, CallbackAbstract>(m, "CallbackLogger")
      .constructors<void()>()
      .read("xs", &L::xs, "us", &L::us, "fs", &L::fs, "iters", &L::iters, "costs", &L::costs, "stops", &L::stops,
            "grads", &L::grads, "pregs", &L::pregs, "steps", &L::steps, "ffeass", &L::ffeass, "gfeass", &L::gfeass,
            "hfeass", &L::hfeass, "feasible", &L::feasible);
}

}  // namespace

void add_solvers(py::module_& m) {
  add_problem(m);
  add_solver_base(m);
  add_callbacks(m);
  add_solver_classes(m);
}

}  // namespace manycontact::python
