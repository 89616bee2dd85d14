// Shooting problems, solvers and callbacks.

#include "action.hpp"
#include "docs/optimal_control.hpp"
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
  py::class_<P, Problem>(
      m, "ShootingProblem",
      "The problem to minimise the sum of the nodes' costs, with x_0 given and x_(t+1) = f_t(x_t, u_t).\n"
      "\n"
      "It has T running nodes and a terminal node. Nodes are evaluated in `nthreads` threads; those written in\n"
      "Python\n"
      "run one at a time.")
      .def(py::init<const Eigen::VectorXd&, const P::Models&, Model>(), py::arg("x0"), py::arg("runningModels"),
           py::arg("terminalModel").none(false), Unlocked())
      .def("calc", &P::calc, py::arg("xs"), py::arg("us"), Unlocked(),
           "Evaluate every node at xs (T + 1 of nx), us (T of nu), and return the total cost.")
      .def("calcDiff", &P::calcDiff, py::arg("xs"), py::arg("us"), Unlocked(),
           "Compute the derivatives at the last calc, and return the total cost.")
      .def("rollout", &P::rollout_us, py::arg("us"), Unlocked(),
           "Return the states xs (T + 1) of a simulation with the controls us (T).")
      .def("quasiStatic", &P::quasiStatic_xs, py::arg("xs"), Unlocked(),
           "Return controls that keep each of T states at rest.")
      .def("circularAppend", py::overload_cast<Model>(&P::circularAppend), py::arg("model").none(false), Unlocked(),
           "Shift the horizon: remove the first running node and append one at the end.")
      .def("circularAppend", py::overload_cast<Model, std::shared_ptr<ActionDataAbstract>>(&P::circularAppend),
           py::arg("model").none(false), py::arg("data").none(false), Unlocked(),
           "Shift the horizon, with data that the model created.")
      .def("updateModel", &P::updateModel, py::arg("i"), py::arg("model").none(false), Unlocked(),
           "Replace node i; i = T is the terminal node.")
      .def_property_readonly("T", &P::get_T, "Number of running nodes.")
      .def_property("x0", &P::get_x0, &P::set_x0, "Initial state (nx).")
      .def_property_readonly("runningModels", &P::get_runningModels, "Models of the running nodes (T).")
      .def_property_readonly("terminalModel", &P::get_terminalModel, "Model of the terminal node.")
      .def_property_readonly("runningDatas", &P::get_runningDatas, "Data of the running nodes (T).")
      .def_property_readonly("terminalData", &P::get_terminalData, "Data of the terminal node.")
      .def_property_readonly("nx", &P::get_nx, "Numbers of a state.")
      .def_property_readonly("ndx", &P::get_ndx, "Numbers of a tangent vector.")
      .def_property_readonly("nu_max", &P::get_nu_max, "Largest number of controls of a node.")
      .def_property(
          "nthreads", &P::get_nthreads, [](P& p, int n) { p.set_nthreads(checked_threads(n)); },
          "Number of threads; below 1: as many as OpenMP offers.")
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
  add_enumeration<StopReason>(m, "StopReason", "reason", "Why solve() stopped.",
                              {{"NONE", StopReason::kNone},
                               {"CONVERGED", StopReason::kConverged},
                               {"ITERATIONS", StopReason::kIterations},
                               {"NO_DIRECTION", StopReason::kNoDirection},
                               {"NO_STEP", StopReason::kNoStep},
                               {"INTERRUPTED", StopReason::kInterrupted},
                               {"INFEASIBLE", StopReason::kInfeasible}});

  using S = SolverAbstract;
  py::class_<CallbackAbstract, PyCallback, std::shared_ptr<CallbackAbstract>> callback(
      m, "CallbackAbstract",
      "A callback of a solver. In a derived class __call__(self, solver) is called after each iteration.");
  py::class_<S, std::shared_ptr<S>> solver(m, "SolverAbstract", "The common base of solvers of a ShootingProblem.",
                                           kCollected);
  callback.def(py::init<>())
      .def(
          "__call__",
          [](CallbackAbstract& c, SolverAbstract& of) {
            if (dynamic_cast<PyCallback*>(&c)) PyCallback::throw_undefined();  // it has none, or calls super()'s
            c(of);
          },
          py::arg("solver"));
  solver
      .def("solve", &solve_problem, py::arg("init_xs") = Vectors(), py::arg("init_us") = Vectors(),
           py::arg("maxiter") = 100, py::arg("isFeasible") = false, py::arg_v("init_reg", NAN, "float('nan')"),
           "Solve the problem, and return whether the solver converged; otherwise see reason.\n"
           "\n"
           "It starts from init_xs (T + 1 of nx; empty: the states' zeros) and init_us (T of nu; empty: zeros).\n"
           "isFeasible\n"
           "means that init_xs is the result of init_us. Ctrl-C ends the solve.")
      .def("computeDirection", &S::computeDirection, py::arg("recalc") = true, Unlocked(),
           "Compute the search direction; recalc: with derivatives.")
      .def("tryStep", &S::tryStep, py::arg("stepLength") = 1.0, Unlocked(),
           "Try a step along the direction, and return the reduction of the cost.")
      .def("stoppingCriteria", &S::stoppingCriteria, Unlocked(), "Return the stopping value.")
      .def("expectedImprovement", &S::expectedImprovement, Unlocked(), "Return the expected improvement (d0, d1).")
      .def("resizeData", &S::resizeData, Unlocked(), "Adapt the memory to the problem's nodes.")
      .def("setCandidate", &S::setCandidate, py::arg("xs") = Vectors(), py::arg("us") = Vectors(),
           py::arg("isFeasible") = false, "Set the candidate; empty lists mean zeros.")
      .def("setCallbacks", &set_callbacks, py::arg("callbacks"),
           "Set the callbacks; within a callback it takes effect from the next iteration on.")
      .def("getCallbacks", &callbacks_of, "Return the callbacks.")
      .def("interrupt", &S::interrupt, "End solve() after the current iteration; for callbacks.")
      .def_property_readonly("reason", &S::reason, "StopReason of the last solve.")
      .def_property_readonly("problem", &S::get_problem, "ShootingProblem.")
      .def_property("xs", &S::get_xs, &S::set_xs, "States of the candidate (T + 1); a copy.")
      .def_property("us", &S::get_us, &S::set_us, "Controls of the candidate (T); a copy.")
      .def_property_readonly("fs", &S::get_fs, "Gaps of the candidate (T + 1); a copy.")
      .def_property_readonly("isFeasible", &S::get_is_feasible, "Whether the candidate has no gaps.")
      .def_property_readonly("cost", &S::get_cost, "Cost of the candidate.")
      .def_property_readonly("merit", &S::get_merit, "Value of the merit function.")
      .def_property_readonly("stop", &S::get_stop, "Stopping value.")
      .def_property_readonly("d", &S::get_d, "Expected improvement (d0, d1): s (d0 + s d1 / 2) for a step of length s.")
      .def_property_readonly("dV", &S::get_dV, "Reduction of the cost by the last step.")
      .def_property_readonly("dV_exp", &S::get_dVexp, "Expected reduction of the cost by the last step.")
      .def_property_readonly("ffeas", &S::get_ffeas, "Norm of the gaps.")
      .def_property_readonly("gfeas", &S::get_gfeas, "Violation of g.")
      .def_property_readonly("hfeas", &S::get_hfeas, "Norm of h.")
      .def_property_readonly("stepLength", &S::get_steplength, "Length of the last step.")
      .def_property_readonly("iter", &S::get_iter, "Number of iterations.")
      .def_property("preg", &S::get_preg, &S::set_preg, "Regularisation.")
      .def_property("th_acceptStep", &S::get_th_acceptstep, &S::set_th_acceptstep,
                    "A step is accepted if it achieves this share of the expected reduction; in (0, 1].")
      .def_property("th_stop", &S::get_th_stop, &S::set_th_stop, "Threshold of the stopping value, above 0.")
      .def_property("th_gapTol", &S::get_th_gaptol, &S::set_th_gaptol, "Threshold of gaps, not negative.");
}

void add_solver_classes(py::module_& m) {
  using D = SolverDDP;
  py::class_<D, PySolver<D>, SolverAbstract, std::shared_ptr<D>>(
      m, "SolverDDP",
      "Differential dynamic programming.\n"
      "\n"
      "A class derived from it, or from its subclasses, may override computeDirection, tryStep,\n"
      "stoppingCriteria,\n"
      "expectedImprovement, calcDiff, backwardPass, forwardPass, resizeData, allocateData,\n"
      "increaseRegularization and\n"
      "decreaseRegularization.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked())
      .def("calcDiff", &D::calcDiff, Unlocked(), "Compute the derivatives at the candidate, and return the cost.")
      .def("backwardPass", &D::backwardPass, Unlocked(), "Compute the search direction.")
      .def("allocateData", &D::allocateData, Unlocked(), "Allocate the memory for the nodes of the problem.")
      .def("increaseRegularization", &D::increaseRegularization, Unlocked(), "Increase the regularisation.")
      .def("decreaseRegularization", &D::decreaseRegularization, Unlocked(), "Decrease the regularisation.")
      .def("forwardPass", &D::forwardPass, py::arg("stepLength") = 1.0, Unlocked(),
           "Simulate a step of the given length along the direction.")
      .def_property_readonly("Vxx", &D::get_Vxx, "Hessians of the value function, T + 1 matrices (ndx, ndx); a copy.")
      .def_property_readonly("Vx", &D::get_Vx, "Gradients of the value function, T + 1 vectors (ndx); a copy.")
      .def_property_readonly("Qxx", &D::get_Qxx,
                             "Hessians of the action value function, T matrices (ndx, ndx); a copy.")
      .def_property_readonly("Qxu", &D::get_Qxu, "Hessians of the action value function, T matrices (ndx, nu); a copy.")
      .def_property_readonly("Quu", &D::get_Quu, "Hessians of the action value function, T matrices (nu, nu); a copy.")
      .def_property_readonly("Qx", &D::get_Qx, "Gradients of the action value function, T vectors (ndx); a copy.")
      .def_property_readonly("Qu", &D::get_Qu, "Gradients of the action value function, T vectors (nu); a copy.")
      .def_property_readonly("K", &D::get_K, "Feedback gains, T matrices (nu, ndx); a copy.")
      .def_property_readonly("k", &D::get_k, "Feed-forward terms, T vectors (nu); a copy.")
      .def_property("alphas", &D::get_alphas, &D::set_alphas, "Step lengths that are tried, positive and decreasing.")
      .def_property("reg_min", &D::get_reg_min, &D::set_reg_min, "Smallest regularisation, not negative.")
      .def_property("reg_max", &D::get_reg_max, &D::set_reg_max, "Largest regularisation, not negative.")
      .def_property("th_grad", &D::get_th_grad, &D::set_th_grad,
                    "A step is accepted if the expected linear improvement is below it.");
  py::class_<SolverFDDP, PySolver<SolverFDDP>, D, std::shared_ptr<SolverFDDP>>(m, "SolverFDDP",
                                                                               "Feasibility-driven DDP.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked())
      .def_property("th_acceptNegStep", &SolverFDDP::get_th_acceptnegstep, &SolverFDDP::set_th_acceptnegstep,
                    "Share of an expected increase of the cost that is accepted, not negative.");
  py::class_<SolverBoxDDP, PySolver<SolverBoxDDP>, D, std::shared_ptr<SolverBoxDDP>>(
      m, "SolverBoxDDP", "DDP with the models' control limits.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked());
  py::class_<SolverBoxFDDP, PySolver<SolverBoxFDDP>, SolverFDDP, std::shared_ptr<SolverBoxFDDP>>(
      m, "SolverBoxFDDP", "FDDP with the models' control limits.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked());
  py::class_<SolverKKT, SolverAbstract, std::shared_ptr<SolverKKT>>(m, "SolverKKT",
                                                                    "Newton steps with the dense KKT matrix.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked())
      .def("calcDiff", &SolverKKT::calcDiff, Unlocked(),
           "Compute the derivatives at the candidate, and return the cost.")
      .def_property_readonly("kkt", &SolverKKT::get_kkt, "KKT matrix [H D^T; D 0]; a copy.")
      .def_property_readonly("kktref", &SolverKKT::get_kktref, "Right-hand side: gradients, then gaps; a copy.")
      .def_property_readonly("primaldual", &SolverKKT::get_primaldual, "Solution: steps, then multipliers; a copy.")
      .def_property_readonly("dxs", &SolverKKT::get_dxs, "Steps of the states (T + 1); a copy.")
      .def_property_readonly("dus", &SolverKKT::get_dus, "Steps of the controls (T); a copy.")
      .def_property_readonly("lambdas", &SolverKKT::get_lambdas, "Multipliers of the dynamics (T + 1); a copy.");
  py::class_<SolverSparse, PySolver<SolverSparse>, SolverFDDP, std::shared_ptr<SolverSparse>>(
      m, "SolverSparse", "FDDP for decoupled subproblems.")
      .def(py::init<Problem, bool>(), py::arg("problem").none(false), py::arg("limits") = false, Unlocked())
      .def("blocks", &SolverSparse::blocks, "Return the number of controls of each subproblem.");
  using A = SolverAugmentedLagrangian;
  py::class_<A, SolverAbstract, std::shared_ptr<A>>(m, "SolverAugmentedLagrangian",
                                                    "The method of multipliers for problems with constraints.")
      .def(py::init<Problem>(), py::arg("problem").none(false), Unlocked())
      .def("reset", &A::reset, "Reset the multipliers to zero and the penalty to its initial value.")
      .def_property("multipliers", &A::get_multipliers, &A::set_multipliers,
                    "Multipliers of [g; h] of each node (T + 1 vectors).")
      .def_property_readonly("violation", &A::get_violation, "Largest violation after a solve.")
      .def_property_readonly("kkt_residual", &A::get_kkt_residual, "KKT residual after a solve.")
      .def_property_readonly("outer_iter", &A::get_outer_iter, "Number of minimisations of the last solve.")
      .def_property("penalty", &A::get_penalty, &A::set_penalty, "Current penalty, above 0.")
      .def_property("penalty_init", &A::get_penalty_init, &A::set_penalty_init, "Initial penalty, above 0.")
      .def_property("th_constraint", &A::get_th_constraint, &A::set_th_constraint,
                    "Threshold of the violation, above 0.")
      .def_property("th_kkt", &A::get_th_kkt, &A::set_th_kkt, "Threshold of the KKT residual, above 0.");
  m.def("kkt_residual", &kkt_residual, py::arg("problem"), py::arg("xs"), py::arg("us"), py::arg("multipliers"),
        py::arg("limits"), py::arg("constraint_multipliers") = Vectors(), py::arg("scale") = 1, Unlocked(),
        doc::kkt_residual);
}

void add_callbacks(py::module_& m) {
  add_enumeration<VerboseLevel>(m, "VerboseLevel", "level", "The columns that CallbackVerbose prints.",
                                {{"_0", _0}, {"_1", _1}, {"_2", _2}, {"_3", _3}, {"_4", _4}});
  py::class_<CallbackVerbose, CallbackAbstract, std::shared_ptr<CallbackVerbose>>(
      m, "CallbackVerbose", "Prints one line on standard output for each iteration.")
      .def(py::init<VerboseLevel, int>(), py::arg_v("level", _4, "VerboseLevel._4"), py::arg("precision") = 3)
      .def_property("level", &CallbackVerbose::get_level, &CallbackVerbose::set_level,
                    "VerboseLevel: which columns are printed.")
      .def_property("precision", &CallbackVerbose::get_precision, &CallbackVerbose::set_precision, "Number of digits.");
  using L = CallbackLogger;
  py::class_<L, CallbackAbstract, std::shared_ptr<L>>(m, "CallbackLogger",
                                                      "Records each iteration; the attributes are copies.")
      .def(py::init<>())
      .def_readonly("xs", &L::xs, "States of the last iteration.")
      .def_readonly("us", &L::us, "Controls of the last iteration.")
      .def_readonly("fs", &L::fs, "Gaps before each iteration.")
      .def_readonly("iters", &L::iters, "Numbers of the iterations.")
      .def_readonly("costs", &L::costs, "Cost after each iteration.")
      .def_readonly("stops", &L::stops, "Stopping value of each iteration.")
      .def_readonly("grads", &L::grads, "Expected linear improvement of each iteration.")
      .def_readonly("pregs", &L::pregs, "Regularisation of each iteration.")
      .def_readonly("steps", &L::steps, "Step length of each iteration.")
      .def_readonly("ffeass", &L::ffeass, "Norm of the gaps of each iteration.")
      .def_readonly("gfeass", &L::gfeass, "Violation of g of each iteration.")
      .def_readonly("hfeass", &L::hfeass, "Norm of h of each iteration.")
      .def_readonly("feasible", &L::feasible, "Whether the candidate had no gaps after each iteration.");
}

}  // namespace

void add_solvers(py::module_& m) {
  add_problem(m);
  add_solver_base(m);
  add_callbacks(m);
  add_solver_classes(m);
}

}  // namespace manycontact::python
