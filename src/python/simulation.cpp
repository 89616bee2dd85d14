// Simulation of a scene.

#include "docs/simulation.hpp"

#include <chrono>
#include <mutex>
#include <variant>

#include "data.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/simulation/step_batch.hpp"
#include "manycontact/simulation/switch.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;

struct Simulation {
  Simulation(const Scene& scene, const Vector& q, const Vector& v, Integrator integrator, double h,
             const Options& options)
      : data(std::make_shared<SimulationData>(scene, q, v, integrator, h, options)),
        dynamics(std::make_shared<Data>(std::shared_ptr<SceneData>(data, &data->dynamics))) {}
  const SimulationData& at_rest() const {
    (void)dynamics->at_rest();
    return *data;
  }
  SimulationData& changeable() const {
    (void)dynamics->at_rest();
    return *data;
  }
  std::shared_ptr<SimulationData> data;
  std::shared_ptr<Data> dynamics;
};

void put(const char* name, const Vector& from, Vector& to) {
  if (from.size() != to.size())
    throw py::value_error(std::string("SimulationData.") + name + ": " + std::to_string(to.size()) +
                          " numbers are expected, not " + std::to_string(from.size()));
  to = from;
}

// States every so many steps.
struct Trajectory {
  std::vector<double> t;
  std::vector<Vector> q, v;
  StepStatus status = StepStatus::kOk;
};

py::array stack(const std::vector<Vector>& rows, Eigen::Index cols) {
  py::array_t<double> out({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(cols)});
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::copy_n(rows[i].data(), cols, out.mutable_data(static_cast<py::ssize_t>(i), 0));
  return read_only(std::move(out));
}

// Ctrl-C is heard every so often, whatever a step takes.
class Signals {
 public:
  void look() {
    constexpr auto kOften = std::chrono::milliseconds(50);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kOften) return;
    last_ = now;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Steps until steps are done, one is not kOk, or Ctrl-C. u: (nu), or a row per step.
Trajectory simulate(const Scene& scene, py::handle u, Simulation& simulation, long steps, long every) {
  if (steps < 0 || every < 1) throw py::value_error("simulate: steps >= 0 and every >= 1 are expected");
  const Doubles U = as_doubles(u, true);
  if (!U || U.ndim() > 2 || U.shape(U.ndim() - 1) != scene.nu || (U.ndim() == 2 && U.shape(0) != steps))
    throw py::value_error("simulate: u has to have the shape (nu,) or (steps, nu), here (" + std::to_string(scene.nu) +
                          ",) or (" + std::to_string(steps) + ", " + std::to_string(scene.nu) + ")");
  check_numbers("u", U.data(), U.size());
  const py::ssize_t stride = U.ndim() == 2 ? scene.nu : 0;
  Trajectory out;
  simulation.dynamics->use([&](SceneData&) {
    SimulationData& sim = *simulation.data;
    const auto record = [&] {
      out.t.push_back(sim.time());
      out.q.push_back(sim.q);
      out.v.push_back(sim.v);
    };
    record();
    long recorded = 0;
    Signals signals;
    for (long k = 0; k < steps; ++k) {
      out.status = step(scene, Eigen::Map<const Vector>(U.data() + k * stride, scene.nu), sim);
      if (out.status != StepStatus::kOk) break;
      if ((k + 1) % every == 0) record(), recorded = k + 1;
      signals.look();
      if (k + 1 == steps && recorded != steps) record();
    }
  });
  return out;
}

void add_steps(py::module_& m) {
  add_enumeration<Integrator>(m, "Integrator", "integrator", "Time stepping schemes on the manifold of configurations.",
                              {{"SEMI_IMPLICIT_EULER", Integrator::kSemiImplicitEuler}, {"RK4", Integrator::kRk4}});
  add_enumeration<StepStatus>(m, "StepStatus", "status of a step", "The result of a step.",
                              {{"OK", StepStatus::kOk},
                               {"SOLVER_FAILED", StepStatus::kSolverFailed},
                               {"NOT_FINITE", StepStatus::kNotFinite},
                               {"TOO_FAST", StepStatus::kTooFast}});

  py::class_<Handle<PdLaws>> pd(
      m, "PdLaws", "kp (q_ref - q) + kd (v_ref - v) on velocity coordinates, all (nv,), or all empty: none.");
  add_value(pd).def(py::init([](const Vector& kp, const Vector& kd, const Vector& q_ref, const Vector& v_ref) {
                      return Handle<PdLaws>(PdLaws{kp, kd, q_ref, v_ref});
                    }),
                    py::arg("kp"), py::arg("kd"), py::arg("q_ref"), py::arg("v_ref"));
  handle_field(pd, "kp", &PdLaws::kp, "Stiffness [N m / rad], none negative, 0 for joints of several coordinates.");
  handle_field(pd, "kd", &PdLaws::kd, "Damping [N m s / rad], none negative.");
  handle_field(pd, "q_ref", &PdLaws::q_ref, "Reference at the end of the next step [rad, m].");
  handle_field(pd, "v_ref", &PdLaws::v_ref, "Reference at the end of the next step [rad/s, m/s].");
  py::class_<StepWork> work(m, "StepWork", "Work of forces in a step [J].");
  add_value(work)
      .def_readonly("pd", &StepWork::pd, "Work of PD laws.")
      .def_readonly("dampers", &StepWork::dampers, "Work of dampers in joints and between points.")
      .def_readonly("friction", &StepWork::friction, "Work of joint friction.")
      .def_readonly("springs", &StepWork::springs,
                    "Energy that the step took from springs, beyond their change of energy.");

  py::class_<Simulation>(m, "SimulationData",
                         "A simulation of a scene: its state, step size, integrator and workspace.")
      .def(py::init([](const Scene& scene, const Vector& q, const Vector& v, Integrator integrator, double h,
                       const Options& options) { return Simulation(scene, q, v, integrator, h, options); }),
           py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("integrator"), py::arg("h"),
           py::arg_v("options", Options(), "Options()"),
           "Start at q (nq), v (nv), with the integrator 'semi-implicit-euler' or 'rk4' and the step h [s].")
      .def_property(
          "q", [](const Simulation& s) { return s.at_rest().q; },
          [](const Simulation& s, const Vector& q) { put("q", q, s.changeable().q); },
          "Configuration (nq); assign a whole vector to continue from there.")
      .def_property(
          "v", [](const Simulation& s) { return s.at_rest().v; },
          [](const Simulation& s, const Vector& v) { put("v", v, s.changeable().v); },
          "Velocity (nv); assign a whole vector to continue from there.")
      .def_property_readonly(
          "integrator", [](const Simulation& s) { return s.at_rest().integrator; }, "Integrator.")
      .def_property_readonly(
          "steps", [](const Simulation& s) { return s.at_rest().steps; }, "Number of completed steps.")
      .def_property_readonly(
          "solves", [](const Simulation& s) { return s.at_rest().solves; }, "Number of solves of all steps.")
      .def_property_readonly(
          "time", [](const Simulation& s) { return s.at_rest().time(); }, "Time since the start [s].")
      .def_property_readonly(
          "h", [](const Simulation& s) { return s.at_rest().h; }, "Step size [s].")
      .def_property_readonly(
          "worst", [](const Simulation& s) { return s.at_rest().worst; }, "Worst Status of all solves.")
      .def_property(
          "velocity_limit", [](const Simulation& s) { return s.at_rest().velocity_limit; },
          [](const Simulation& s, double limit) { s.changeable().velocity_limit = limit; },
          "Largest velocity [m/s, rad/s]; a faster step is StepStatus.TOO_FAST.")
      .def_property(
          "pd",
          [](const Simulation& s) {
            return Handle<PdLaws>([s]() -> const PdLaws& { return s.at_rest().pd; },
                                  [s](PdLaws laws) { s.changeable().pd = std::move(laws); });
          },
          [](const Simulation& s, const PdLaws& laws) { s.changeable().pd = laws; },
          "PD laws of joints, evaluated at the end of a step. Assign them, or their attributes, between steps.")
      .def_property_readonly(
          "pd_torque", [](const Simulation& s) { return s.at_rest().pd_torque; },
          "Mean torque of the PD laws in the last step (nv) [N m, N].")
      .def_property_readonly(
          "work", [](const Simulation& s) { return s.at_rest().work; }, "StepWork of the last step.")
      .def_property_readonly(
          "unsettled", [](const Simulation& s) { return s.at_rest().unsettled; },
          "Number of steps in which joint friction did not converge.")
      .def_property_readonly(
          "dynamics", [](const Simulation& s) { return s.dynamics; },
          "SceneData of the last solve. Between steps dynamics.active may be switched, and dynamics.pushes changed.");

  py::class_<Trajectory> trajectory(m, "Trajectory", "The states that simulate recorded.");
  add_value(trajectory)
      .def_property_readonly(
          "t", [](const Trajectory& x) { return read_only(py::array_t<double>(x.t.size(), x.t.data())); },
          "Times (n) [s].")
      .def_property_readonly(
          "q", [](const Trajectory& x) { return stack(x.q, x.q.front().size()); }, "Configurations (n, nq).")
      .def_property_readonly(
          "v", [](const Trajectory& x) { return stack(x.v, x.v.front().size()); }, "Velocities (n, nv).")
      .def_readonly("status", &Trajectory::status, "StepStatus of the last step; not OK: the simulation ended early.");
}

void add_step_functions(py::module_& m) {
  m.def(
      "step",
      [](const Scene& scene, const Raw& u, const Simulation& simulation) {
        check_numbers("u", u.array.data(), u.array.size());
        const auto U = u.vector();
        return simulation.dynamics->use([&](SceneData&) { return step(scene, U, *simulation.data); });
      },
      py::arg("scene"), py::arg("u"), py::arg("data"), doc::step);
  m.def("simulate", &simulate, py::arg("scene"), py::arg("u"), py::arg("data"), py::arg("steps"), py::arg("every") = 1,
        doc::simulate);
  m.def(
      "contact_force",
      [](const Scene& scene, const Simulation& simulation, const std::variant<int, std::string>& contact) -> Vector {
        return std::visit([&](const auto& c) -> Vector { return contact_force(scene, simulation.at_rest(), c); },
                          contact);
      },
      py::arg("scene"), py::arg("data"), py::arg("contact"), doc::step_contact_force);
  py::class_<VelocityJump> jump(m, "VelocityJump", "The result of an impact.");
  add_value(jump)
      .def_readonly("status", &VelocityJump::status,
                    "Status of its solve; 'failed': only the set of contacts was changed.")
      .def_readonly("energy_lost", &VelocityJump::energy_lost, "Kinetic energy that was lost [J].")
      .def_readonly("impulse", &VelocityJump::impulse, "Impulses on A (rows of the active contacts) [N s, N m s].");
  m.def(
      "switch_contacts",
      [](Scene& scene, py::handle active, const Simulation& simulation, bool here) {
        std::vector<char> flags(scene.contacts.size());
        set_flags("active", active, flags);
        return simulation.dynamics->use([&](SceneData& dynamics) {
          for (std::size_t c = 0; here && c < flags.size() && c < dynamics.active.size(); ++c)
            if (flags[c] && !dynamics.active[c])
              resolve_reference(scene, simulation.data->q, true, true, scene.contacts[c]);
          return switch_contacts(scene, flags, *simulation.data);
        });
      },
      py::arg("scene"), py::arg("active"), py::arg("data"), py::arg("here") = false, doc::switch_contacts);
  m.def(
      "failure",
      [](const Scene& scene, const Simulation& simulation, StepStatus status) {
        if (simulation.at_rest().v.size() != scene.nv) throw py::value_error("failure: the data are of another scene");
        return failure(scene, simulation.at_rest(), status);
      },
      py::arg("scene"), py::arg("data"), py::arg("status"), doc::failure);
}

struct Many {
  SimulationBatch batch;
  std::shared_ptr<std::mutex> busy = std::make_shared<std::mutex>();

  template <class Use>
  auto use(Use&& act) {
    const std::unique_lock turn(*busy, std::try_to_lock);
    if (!turn) throw py::value_error("SimulationBatch: another thread steps it");
    return act(batch);
  }
};

BatchMatrix matrix_of(const char* name, py::handle source) {
  const Doubles X = as_doubles(source, true);
  if (!X || X.ndim() != 2) throw py::value_error(std::string(name) + " has to be a matrix, one state per row");
  check_numbers(name, X.data(), X.size());
  return Eigen::Map<const BatchMatrix>(X.data(), X.shape(0), X.shape(1));
}

py::array_t<std::int8_t> step_many(const Scene& scene, py::handle u, Many& many, int steps) {
  const BatchMatrix U = matrix_of("step_batch: u", u);
  return many.use([&](SimulationBatch& batch) {
    std::vector<StepStatus> worst(batch.status.size(), StepStatus::kOk);
    {
      const py::gil_scoped_release unlocked;
      Signals signals;
      for (int k = 0; k < steps; ++k) {
        step_batch(scene, U, batch);
        for (std::size_t i = 0; i < worst.size(); ++i)
          if (batch.status[i] != StepStatus::kOk) worst[i] = batch.status[i];
        signals.look();
      }
    }
    py::array_t<std::int8_t> out(static_cast<py::ssize_t>(worst.size()));
    for (std::size_t i = 0; i < worst.size(); ++i) out.mutable_data()[i] = static_cast<std::int8_t>(worst[i]);
    return out;
  });
}

// A member that is a matrix, read as a copy and assigned as a whole.
template <class Class>
void add_matrix(Class& c, const char* name, BatchMatrix SimulationBatch::*member, const char* doc) {
  c.def_property(
      name, [member](Many& m) { return m.use([&](SimulationBatch& b) -> BatchMatrix { return b.*member; }); },
      [member, name](Many& m, py::handle x) { m.use([&](SimulationBatch& b) { b.*member = matrix_of(name, x); }); },
      doc);
}

void add_batch_of_simulations(py::module_& m) {
  py::class_<Many> c(m, "SimulationBatch", doc::simulation_batch);
  c.def(
      py::init([](const Scene& scene, py::handle q, py::handle v, Integrator integrator, double h, int threads,
                  const Options& options) {
        return Many{SimulationBatch(scene, matrix_of("SimulationBatch: q", q), matrix_of("SimulationBatch: v", v),
                                    integrator, h, threads, options)};
      }),
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("integrator"), py::arg("h"), py::arg("threads") = 0,
      py::arg_v("options", Options(), "Options()"),
      "Start at the rows of q (states, nq) and v (states, nv), with the integrator 'semi-implicit-euler' or 'rk4' and "
      "the step h [s]. threads: 0 takes all.");
  const auto read = [&c](const char* name, BatchMatrix SimulationBatch::*member, const char* doc) {
    c.def_property_readonly(
        name, [member](Many& m) { return m.use([&](SimulationBatch& b) -> BatchMatrix { return b.*member; }); }, doc);
  };
  read("q", &SimulationBatch::q, "Configurations (states, nq); set_state changes them.");
  read("v", &SimulationBatch::v, "Velocities (states, nv).");
  read("f", &SimulationBatch::f, "Contact forces at the states before the last step (states, rows) [N, N m].");
  add_matrix(c, "q_ref", &SimulationBatch::q_ref, "References of the PD laws (states, nv) [rad, m].");
  add_matrix(c, "v_ref", &SimulationBatch::v_ref, "References of the PD laws (states, nv) [rad/s, m/s].");
  const auto gains = [&c](const char* name, Vector SimulationBatch::*member, const char* doc) {
    c.def_property(
        name, [member](Many& m) { return m.use([&](SimulationBatch& b) -> Vector { return b.*member; }); },
        [member](Many& m, const Vector& x) { m.use([&](SimulationBatch& b) { b.*member = x; }); }, doc);
  };
  gains("kp", &SimulationBatch::kp, "Gains of the PD laws (nv) [N m / rad], or empty: there are none.");
  gains("kd", &SimulationBatch::kd, "Gains of the PD laws (nv) [N m s / rad].");
  c.def_property(
       "active",
       [](Many& m) {
         return m.use([](SimulationBatch& b) { return std::vector<bool>(b.active.begin(), b.active.end()); });
       },
       [](Many& m, py::handle flags) {
         m.use([&](SimulationBatch& b) { set_flags("SimulationBatch.active", flags, b.active); });
       },
       "A flag per contact. Velocities do not jump.")
      .def_property(
          "velocity_limit", [](Many& m) { return m.use([](SimulationBatch& b) { return b.velocity_limit; }); },
          [](Many& m, double limit) { m.use([&](SimulationBatch& b) { b.velocity_limit = limit; }); },
          "Largest velocity [m/s, rad/s]; a faster step is StepStatus.TOO_FAST.");
  m.def("step_batch", &step_many, py::arg("scene"), py::arg("u"), py::arg("batch"), py::arg("steps") = 1,
        doc::step_batch);
  m.def(
      "set_state",
      [](const Scene& scene, Eigen::Index k, const Vector& q, const Vector& v, Many& many) {
        check_numbers("set_state: q", q.data(), q.size());
        check_numbers("set_state: v", v.data(), v.size());
        many.use([&](SimulationBatch& batch) { set_state(scene, k, q, v, batch); });
      },
      py::arg("scene"), py::arg("k"), py::arg("q"), py::arg("v"), py::arg("batch"),
      doc::set_state);
}

void add_invariants(py::module_& m) {
  py::class_<Invariants> kept(m, "Invariants", "Quantities that exact motion conserves.");
  add_value(kept)
      .def_readonly("position_drift", &Invariants::position_drift,
                    "Largest placement error of the active contacts [m, rad].")
      .def_readonly("velocity_drift", &Invariants::velocity_drift,
                    "Largest velocity of the active contacts, max |J v| [m/s, rad/s].")
      .def_readonly("kinetic", &Invariants::kinetic, "Kinetic energy [J].")
      .def_readonly("potential", &Invariants::potential, "Potential energy [J], zero at the world's origin.")
      .def_property_readonly("energy", &Invariants::energy, "Sum of kinetic and potential energy [J].")
      .def_readonly("momentum", &Invariants::momentum,
                    "Momentum about the world's origin (6): linear [N s], angular [N m s].");
  m.def(
      "invariants",
      [](const Scene& scene, const std::vector<bool>& active, const Vector& q, const Vector& v) {
        if (active.size() != scene.contacts.size() || q.size() != scene.nq || v.size() != scene.nv)
          throw py::value_error("invariants: active, q or v do not fit the scene");
        expect_configuration("invariants", "q", q, scene);
        InvariantsData data(scene);
        return invariants(scene, std::vector<char>(active.begin(), active.end()), q, v, data);
      },
      py::arg("scene"), py::arg("active"), py::arg("q"), py::arg("v"), doc::invariants);

  py::class_<Gains> gains(m, "Gains", "Stabilisation gains of a contact; alpha, beta = gains.");
  add_value(gains)
      .def(py::init([](double alpha, double beta) {
             return Gains{alpha, beta};
           }),
           py::arg("alpha") = 0.0, py::arg("beta") = 0.0)
      .def_readwrite("alpha", &Gains::alpha, "Gain of position errors [1/s^2].")
      .def_readwrite("beta", &Gains::beta, "Gain of velocities [1/s].")
      .def("__iter__", [](const Gains& g) { return py::iter(py::make_tuple(g.alpha, g.beta)); })
      .def("__repr__", [](const Gains& g) {
        return "Gains(" + std::string(py::str(py::float_(g.alpha))) + ", " + std::string(py::str(py::float_(g.beta))) +
               ")";
      });
  m.def(
      "recommended_gains", [](Integrator i, double h) { return recommended_gains(i, h); }, py::arg("integrator"),
      py::arg("h"), doc::recommended_gains);
  m.def(
      "error_growth", [](Integrator i, const Gains& g, double h) { return error_growth(i, g, h); },
      py::arg("integrator"), py::arg("gains"), py::arg("h"), doc::error_growth);
  m.def(
      "largest_stable_step", [](Integrator i, const Gains& g) { return largest_stable_step(i, g); },
      py::arg("integrator"), py::arg("gains"), doc::largest_stable_step);
}

}  // namespace

void add_simulation(py::module_& m) {
  add_steps(m);
  add_step_functions(m);
  add_batch_of_simulations(m);
  add_invariants(m);
}

}  // namespace manycontact::python
