#include <chrono>
#include <variant>

#include "data.hpp"
#include "in_use.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/simulation/step_batch.hpp"
#include "manycontact/simulation/switch.hpp"

namespace manycontact::python {

namespace {

struct Simulation {
  Simulation(const Scene& scene, const Vector& q, const Vector& v, Integrator integrator, double h,
             const Options& options)
      : data(std::make_shared<SimulationData>(scene, q, v, integrator, h, options)),
        dynamics(std::make_shared<Data>(std::shared_ptr<SceneData>(data, &data->dynamics))) {}
  SimulationData& at_rest() const {
    (void)dynamics->at_rest();
    return *data;
  }
  std::shared_ptr<SimulationData> data;
  std::shared_ptr<Data> dynamics;
};

template <class M>
auto got(M SimulationData::*member) {
  return [member](const Simulation& s) { return s.at_rest().*member; };
}

// Returns a setter that replaces a vector of SimulationData by another vector of the same size.
auto put(const char* name, Vector SimulationData::*member) {
  return [=](const Simulation& s, const Vector& from) {
    Vector& to = s.at_rest().*member;
    if (from.size() != to.size())
      throw py::value_error(std::string("SimulationData.") + name + ": " + std::to_string(to.size()) +
                            " numbers are expected, not " + std::to_string(from.size()));
    to = from;
  };
}

struct Trajectory {  // states of a simulation: the first, one after every `every` steps, and the last
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

class Signals {  // Handles Ctrl-C between steps. It is checked at most every 50 ms.
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

// Makes `steps` steps, or fewer if a step is not kOk or Ctrl-C is pressed. u: one vector (nu), or one row per step.
Trajectory simulate(const Scene& scene, py::handle u, Simulation& simulation, long steps, long every) {
  if (steps < 0 || every < 1) throw py::value_error("simulate: steps >= 0 and every >= 1 are expected");
  const Doubles U = as_doubles(u);
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
  enumeration<Integrator>(m);
  enumeration<StepStatus>(m);

  value<Handle<PdLaws>>(m)
      .from_members<Vector, Vector, Vector, Vector>()
      .fields<&PdLaws::kp, &PdLaws::kd, &PdLaws::q_ref, &PdLaws::v_ref>();
  value<StepWork>(m).read<&StepWork::pd, &StepWork::dampers, &StepWork::friction, &StepWork::springs>();

  using S = SimulationData;
  const auto at = &Simulation::at_rest;
  Class<Simulation>(m, "SimulationData")
      .constructors<void(const Scene&, const Vector&, const Vector&, Integrator, double, const Options&)>()
      .property("q", got(&S::q), put("q", &S::q), "v", got(&S::v), put("v", &S::v), "velocity_limit",
                got(&S::velocity_limit), [](const Simulation& s, double limit) { s.at_rest().velocity_limit = limit; })
      .read_at<&S::integrator, &S::steps, &S::solves, &S::time, &S::h, &S::worst>(at)
      .handle<Simulation>(
          "pd", [](const Simulation& s) -> const PdLaws& { return s.at_rest().pd; },
          [](const Simulation& s, PdLaws laws) { s.at_rest().pd = std::move(laws); })
      .read_at<&S::pd_torque, &S::work, &S::unsettled>(at)
      .read("dynamics", [](const Simulation& s) { return s.dynamics; });

  value<Trajectory>(m)
      .read(
          "t", [](const Trajectory& x) { return read_only(py::array_t<double>(x.t.size(), x.t.data())); }, "q",
          [](const Trajectory& x) { return stack(x.q, x.q.front().size()); }, "v",
          [](const Trajectory& x) { return stack(x.v, x.v.front().size()); })
      .read<&Trajectory::status>();
}

void add_step_functions(py::module_& m) {
  def(m, "step", [](const Scene& scene, const Raw& u, const Simulation& simulation) {
    const auto U = checked("u", u);
    return simulation.dynamics->use([&](SceneData&) { return step(scene, U, *simulation.data); });
  });
  def(m, "simulate", &simulate);
  def_as(m, "contact_force", "step_contact_force",
         [](const Scene& scene, const Simulation& simulation, const std::variant<int, std::string>& contact) -> Vector {
           return std::visit([&](const auto& c) -> Vector { return contact_force(scene, simulation.at_rest(), c); },
                             contact);
         });
  value<VelocityJump>(m).read<&VelocityJump::status, &VelocityJump::energy_lost, &VelocityJump::impulse>();
  def(m, "switch_contacts", [](Scene& scene, py::handle active, const Simulation& simulation, bool here) {
    std::vector<char> flags(scene.contacts.size());
    set_flags("active", active, flags);
    return simulation.dynamics->use([&](SceneData& dynamics) {
      for (std::size_t c = 0; here && c < flags.size() && c < dynamics.active.size(); ++c)
        if (flags[c] && !dynamics.active[c])
          resolve_reference(scene, simulation.data->q, true, true, scene.contacts[c]);
      return switch_contacts(scene, flags, *simulation.data);
    });
  });
  def(m, "failure", [](const Scene& scene, const Simulation& simulation, StepStatus status) {
    if (simulation.at_rest().v.size() != scene.nv) throw py::value_error("failure: the data belong to another scene");
    return failure(scene, simulation.at_rest(), status);
  });
}

BatchMatrix state_rows(const char* name, py::handle source) {
  const Doubles X = as_doubles(source);
  if (!X || X.ndim() != 2) throw py::value_error(std::string(name) + " has to be a matrix, one state per row");
  check_numbers(name, X.data(), X.size());
  return Eigen::Map<const BatchMatrix>(X.data(), X.shape(0), X.shape(1));
}

py::array_t<std::int8_t> step_many(const Scene& scene, py::handle u, SimulationBatch& batch, int steps) {
  const BatchMatrix U = state_rows("step_batch: u", u);
  const InUse turn(batch, "SimulationBatch");
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
  return numbers_of(worst);
}

// Returns a getter for a member of SimulationBatch, which copies the member.
template <class M>
auto got(M SimulationBatch::*member) {
  return [member](SimulationBatch& batch) {
    const InUse turn(batch, "SimulationBatch");
    return batch.*member;
  };
}
template <class M>
auto put(M SimulationBatch::*member) {
  return [member](SimulationBatch& batch, const M& x) {
    const InUse turn(batch, "SimulationBatch");
    batch.*member = x;
  };
}
auto put(const char* name, BatchMatrix SimulationBatch::*member) {
  return [=](SimulationBatch& batch, py::handle x) { put(member)(batch, state_rows(name, x)); };
}

void add_batch_of_simulations(py::module_& m) {
  using B = SimulationBatch;
  Class<B>(m, "SimulationBatch")
      .def(py::init([](const Scene& scene, py::handle q, py::handle v, Integrator integrator, double h, int threads,
                       const Options& options) {
        return B(scene, state_rows("SimulationBatch: q", q), state_rows("SimulationBatch: v", v), integrator, h,
                 threads, options);
      }))
      .read("q", got(&B::q), "v", got(&B::v), "f", got(&B::f))
      .property(
          "q_ref", got(&B::q_ref), put("q_ref", &B::q_ref), "v_ref", got(&B::v_ref), put("v_ref", &B::v_ref), "kp",
          got(&B::kp), put(&B::kp), "kd", got(&B::kd), put(&B::kd), "active",
          [](B& batch) {
            const std::vector<char> active = got(&B::active)(batch);
            return std::vector<bool>(active.begin(), active.end());
          },
          [](B& batch, py::handle x) {
            const InUse turn(batch, "SimulationBatch");
            set_flags("SimulationBatch.active", x, batch.active);
          },
          "velocity_limit", got(&B::velocity_limit), put(&B::velocity_limit));
  def(m, "step_batch", &step_many);
  def(m, "set_state", [](const Scene& scene, Eigen::Index k, const Vector& q, const Vector& v, B& batch) {
    check_numbers("set_state: q", q.data(), q.size());
    check_numbers("set_state: v", v.data(), v.size());
    const InUse turn(batch, "SimulationBatch");
    set_state(scene, k, q, v, batch);
  });
}

void add_invariants(py::module_& m) {
  value<Invariants>(m)
      .read<&Invariants::violation_position, &Invariants::violation_velocity, &Invariants::kinetic,
            &Invariants::potential, &Invariants::energy, &Invariants::momentum>();
  def(m, "invariants", [](const Scene& scene, const std::vector<bool>& active, const Vector& q, const Vector& v) {
    if (active.size() != scene.contacts.size() || q.size() != scene.nq || v.size() != scene.nv)
      throw py::value_error(
          "invariants: active, q or v has a wrong size, a flag per contact, nq and nv numbers are expected");
    expect_configuration("invariants", "q", q, scene);
    InvariantsData data(scene);
    return invariants(scene, std::vector<char>(active.begin(), active.end()), q, v, data);
  });

  value<Gains>(m)
      .from_members<double, double>()
      .write<&Gains::alpha, &Gains::beta>()
      .def("__iter__", [](const Gains& g) { return py::iter(py::make_tuple(g.alpha, g.beta)); })
      .def("__repr__", [](const Gains& g) {
        return "Gains(" + std::string(py::str(py::float_(g.alpha))) + ", " + std::string(py::str(py::float_(g.beta))) +
               ")";
      });
  def(m, "recommended_gains", [](Integrator i, double h) { return recommended_gains(i, h); });
  def(m, "error_growth", [](Integrator i, const Gains& g, double h) { return error_growth(i, g, h); });
  def(m, "largest_stable_step", [](Integrator i, const Gains& g) { return largest_stable_step(i, g); });
}

}  // namespace

void add_simulation(py::module_& m) {
  add_steps(m);
  add_step_functions(m);
  add_batch_of_simulations(m);
  add_invariants(m);
}

}  // namespace manycontact::python
