#include "simulate.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "../program/command.hpp"
#include "../program/progress.hpp"
#include "../text/table.hpp"
#include "../view/view.hpp"
#include "control.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/simulation/spring_steps.hpp"
#include "switches.hpp"
#include "watch.hpp"

namespace manycontact::cli {

namespace {

constexpr double kMostSteps = 1e9;
constexpr int kConditionEvery = 10;  // steps

// What the command line asks for, and what came of it.
struct Run {
  Integrator integrator = Integrator::kSemiImplicitEuler;
  double h = 0;
  long steps = 0;
  int every = 1;

  StepStatus stopped = StepStatus::kOk;
  Invariants start, end, largest;  // largest: drift of the states written
  double seconds = 0;
  SpringStep shortest;  // at the start
  Findings at_start;    // of files; contacts out of place or moving; joints without inertia, where that ended it
  std::optional<Recording> view;
};

Integrator integrator_of(const Arguments& arguments) {
  const std::string name = arguments.value("--integrator").value_or("semi-implicit-euler");
  const auto integrator = integrator_from_string(name);
  if (!integrator) throw UsageError("unknown integrator '" + name + "', expected semi-implicit-euler or rk4");
  return *integrator;
}

// "25 10" or "25,10".
Gains two_numbers(const std::string& option, const std::string& names, const std::string& text,
                  const std::string& otherwise = "") {
  double x[2];
  const char *at = text.data(), *end = at + text.size();
  for (int k = 0; k < 2; ++k) {
    while (at != end && (*at == ' ' || (k == 1 && *at == ','))) ++at;
    const auto [next, error] = std::from_chars(at, end, x[k]);
    if (error != std::errc() || !std::isfinite(x[k]) || x[k] < 0) at = nullptr;
    if (!at) break;
    at = next;
  }
  while (at && at != end && *at == ' ') ++at;
  if (at != end)
    throw UsageError("option " + option + " is '" + text + "', expected '" + names + "', neither below 0" + otherwise);
  return {x[0], x[1]};
}

std::optional<Gains> gains_of(const Arguments& arguments, const Run& run) {
  const auto text = arguments.value("--gains");
  if (!text) return std::nullopt;
  return *text == "recommended" ? recommended_gains(run.integrator, run.h)
                                : two_numbers("--gains", "alpha beta", *text, ", or 'recommended'");
}

Run run_of(const Arguments& arguments) {
  Run run;
  run.integrator = integrator_of(arguments);
  const double time = arguments.positive("--time");
  run.h = arguments.positive("--step");
  if (!(time / run.h <= kMostSteps)) throw UsageError("--time is more than 1e9 times --step");
  run.steps = std::max(1L, static_cast<long>(std::ceil(time / run.h - 1e-6)));
  run.every = arguments.integer("--every", 1, 1000000000, 1);
  return run;
}

// What moves the scene and what looks on.
struct Around {
  Control control;
  Watch watch;
  std::optional<Switches> switches;
  std::unique_ptr<CsvFile> forces;
  std::optional<TimeTable> pushes;
  Eigen::VectorXd wrenches;  // of all pushes, one after the other

  /// The wrenches at t, where a file has them, into the data of the next step.
  void push(double t, SimulationData& sim) {
    if (!pushes) return;
    pushes->at(t, false, wrenches);
    for (std::size_t k = 0; k < sim.dynamics.pushes.size(); ++k)
      sim.dynamics.pushes[k] = wrenches.segment<6>(static_cast<Eigen::Index>(6 * k));
  }
};

// The forces at the last state, by a step that is taken back.
void write_last_forces(const Scene& scene, Around& around, SimulationData& sim) {
  const Eigen::VectorXd q = sim.q, v = sim.v;
  const long steps = sim.steps;
  const Status worst = sim.worst;
  const double t = sim.time();
  around.push(t, sim);
  if (step(scene, around.control.at(t, q, v), sim) == StepStatus::kOk) write_forces_row(t, scene, sim, *around.forces);
  sim.q = q, sim.v = v, sim.steps = steps, sim.worst = worst;
}

// Steps and writes until the end, or until a step is not kOk.
void simulate(Scene& scene, Around& around, bool progress_always, SimulationData& sim, CsvFile& csv, Run& run) {
  InvariantsData room(scene);
  const auto record = [&] {
    run.end = invariants(scene, sim.dynamics.active, sim.q, sim.v, room);
    run.largest.position_drift = std::max(run.largest.position_drift, run.end.position_drift);
    run.largest.velocity_drift = std::max(run.largest.velocity_drift, run.end.velocity_drift);
    run.largest.kinetic = std::max(run.largest.kinetic, run.end.kinetic);
    write_trajectory_row(sim.time(), sim.q, sim.v, run.end, csv);
    if (run.view) {
      const Eigen::VectorXd& u = around.control.at(sim.time(), sim.q, sim.v);
      around.push(sim.time(), sim);
      add_state({.t = sim.time(),
                 .q = sim.q,
                 .v = sim.v,
                 .active = sim.dynamics.active,
                 .u = u,
                 .pushes = sim.dynamics.pushes},
                *run.view);
    }
  };
  write_trajectory_header(scene, csv);
  if (around.forces) write_forces_header(scene, *around.forces);
  record();
  run.start = run.end;
  Progress progress("simulate", static_cast<double>(run.steps), progress_always);
  const auto begin = std::chrono::steady_clock::now();
  long written = 0;
  Eigen::VectorXd q, v;
  while (sim.steps < run.steps && run.stopped == StepStatus::kOk) {
    const std::size_t blows = around.switches ? around.switches->blows().size() : 0;
    const bool switched = !around.switches || around.switches->apply(scene, sim, 1e-6 * sim.h);
    if (around.switches && around.switches->blows().size() > blows)
      around.watch.lost(around.switches->blows().back().jump.energy_lost);
    if (!switched) {
      run.stopped = StepStatus::kSolverFailed;
      break;
    }
    const double t = sim.time();
    q = sim.q, v = sim.v;
    const Eigen::VectorXd& u = around.control.at(t, q, v);
    around.push(t, sim);
    run.stopped = step(scene, u, sim);
    if (run.stopped == StepStatus::kOk) {
      around.watch.look(scene, t, q, v, u, sim);
      if (around.forces && (sim.steps - 1) % run.every == 0) write_forces_row(t, scene, sim, *around.forces);
    }
    if (sim.steps % run.every == 0 && sim.steps != written) record(), written = sim.steps;
    progress.update(static_cast<double>(sim.steps));
  }
  if (written != sim.steps) record();
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  csv.close();
  if (!around.forces) return;
  if (run.stopped == StepStatus::kOk) write_last_forces(scene, around, sim);
  around.forces->close();
}

// The contact whose gains bear the smallest step, if that is below h.
void print_advice(std::ostream& out, const Scene& scene, const SimulationData& sim) {
  const Contact* worst = nullptr;
  double least = sim.h;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    const double most = largest_stable_step(sim.integrator, {contact.alpha, contact.beta});
    if (sim.dynamics.active[c] && most < least * (1 - 1e-9)) worst = &contact, least = most;
  }
  if (!worst) return;
  const Gains fit = recommended_gains(sim.integrator, sim.h);
  wrap(out,
       "contact " + worst->name + "'s gains " + number(worst->alpha) + " " + number(worst->beta) +
           " are unstable with " + to_string(sim.integrator) + " beyond steps of " + number(least) +
           " s; recommended for this step are " + number(fit.alpha) + " " + number(fit.beta),
       2);
}

// The spring that bears the smallest step, if h is too long for it.
std::string spring_advice(const Scene& scene, const SimulationData& sim, const SpringStep& shortest) {
  const bool implicit = sim.integrator == Integrator::kSemiImplicitEuler;
  if (shortest.spring < 0 || shortest.largest >= (implicit ? 2 : 1) * sim.h) return "";
  std::string who;
  if (shortest.in_joint) {
    const JointSpring& spring = scene.joint_springs[static_cast<std::size_t>(shortest.spring)];
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    who = "the spring of joint " + robot.name + "/" + robot.model->joints[spring.joint].name;
  } else {
    who = "spring " + scene.springs[static_cast<std::size_t>(shortest.spring)].name;
  }
  if (implicit)
    return who + " allows steps of " + number(shortest.largest) +
           " s at most, for the initial inertia, and is integrated implicitly: oscillations that are too fast for "
           "steps of " +
           number(sim.h) + " s are damped";
  return who + " is unstable with " + to_string(sim.integrator) + " beyond steps of " + number(shortest.largest) +
         " s, for the initial inertia";
}

void print_impacts(std::ostream& out, const Around& around) {
  if (!around.switches) return;
  for (const Switches::ImpactEvent& blow : around.switches->blows())
    wrap(out,
         "at t = " + number(blow.t, 4) + " s " + blow.contacts + " closed: the impact dissipated " +
             number(blow.jump.energy_lost) + " J",
         2);
}

// Empty where every switch was done.
std::string switches_not_reached(const Around& around, const SimulationData& sim) {
  const std::string list = around.switches ? around.switches->not_reached() : "";
  return list.empty() ? "" : "not switched, for the run ended at t = " + number(sim.time(), 6) + " s: " + list;
}

void print_summary(std::ostream& out, const SceneFile& file, const SimulationData& sim, const Around& around,
                   const Run& run) {
  out << printable(file.scene.name) << ": " << count(sim.steps, "step") << " of " << number(sim.h) << " s, "
      << to_string(sim.integrator) << ", to t = " << number(sim.time(), 6) << " s in " << number(run.seconds)
      << " s, status " << to_string(sim.worst) << "\n";
  Table table({{"", Table::kLeft}, {"start"}, {"end"}, {"largest"}, {"", Table::kLeft}});
  const auto short_of = [](double x) { return x == 0 ? std::string("0") : scientific(x); };
  table.add({"drift, position", short_of(run.start.position_drift), short_of(run.end.position_drift),
             short_of(run.largest.position_drift), "m, rad"});
  table.add({"drift, velocity", short_of(run.start.velocity_drift), short_of(run.end.velocity_drift),
             short_of(run.largest.velocity_drift), "m/s, rad/s"});
  table.add({"energy", number(run.start.energy(), 6), number(run.end.energy(), 6), "", "J"});
  table.add({"work of torques", "", number(around.watch.work(), 6), "", "J; energy lost in impacts is subtracted"});
  if (!file.scene.pushes.empty()) table.add({"work of pushes", "", number(around.watch.work_of_pushes(), 6), "", "J"});
  table.print(out);
  print_impacts(out, around);
  const std::string late = switches_not_reached(around, sim);
  if (!late.empty()) wrap(out, printable(late), 2);
  print_findings(out, file.scene, run.at_start);
  around.watch.print(out, file, sim, run.start, run.end, run.largest.kinetic);
  print_advice(out, file.scene, sim);
  const std::string springs = spring_advice(file.scene, sim, run.shortest);
  if (!springs.empty()) wrap(out, printable(springs), 2);
}

Json document(const SceneFile& file, const SimulationData& sim, const Around& around, const Run& run) {
  Json json = {
      {"scene", file.scene.name},
      {"integrator", to_string(sim.integrator)},
      {"step", sim.h},
      {"steps", sim.steps},
      {"time", sim.time()},
      {"status", to_string(sim.worst)},
      {"stopped", run.stopped == StepStatus::kOk ? Json(nullptr) : Json(failure(file.scene, sim, run.stopped))},
      {"energy", {run.start.energy(), run.end.energy()}},
      {"largest_position_drift", run.largest.position_drift}};
  json["largest_step_of_springs"] = run.shortest.spring < 0 ? Json(nullptr) : Json(run.shortest.largest);
  add_findings(file.scene, run.at_start, json);
  around.watch.add_to(json, file.scene);
  return json;
}

// Torques over time or a PD law, switches, and the file for forces.
Around around_of(const Arguments& arguments, const SceneFile& file) {
  Around out{Control(file), Watch(file.scene, solver_options(arguments)), std::nullopt, nullptr, std::nullopt, {}};
  if (const auto pushes = arguments.value("--pushes")) {
    if (file.scene.pushes.empty())
      throw InputError(file.path, 1, "the scene has no <push>, expected those that --pushes gives wrenches");
    out.pushes.emplace(*pushes, "w:", push_names(file.scene));
    if (out.pushes->empty())
      throw InputError(*pushes, 1,
                       "has no column of a push, expected columns like w:" + push_names(file.scene).front());
    out.wrenches.resize(static_cast<Eigen::Index>(6 * file.scene.pushes.size()));
    for (std::size_t k = 0; k < file.scene.pushes.size(); ++k)
      out.wrenches.segment<6>(static_cast<Eigen::Index>(6 * k)) = file.scene.pushes[k].wrench;
  }
  if (const auto torques = arguments.value("--torques")) out.control.read_torques(*torques);
  const auto pd = arguments.value("--pd"), reference = arguments.value("--reference");
  if (reference && !pd) throw UsageError("option --reference needs --pd");
  if (pd) {
    const Gains k = two_numbers("--pd", "kp kd", *pd);
    out.control.follow(k.alpha, k.beta, reference);
  }
  if (const auto text = arguments.value("--switch")) out.switches.emplace(*text, file);
  if (const auto forces = arguments.value("--forces")) out.forces = std::make_unique<CsvFile>(*forces, "--forces");
  return out;
}

int run_simulate(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  Run run = run_of(arguments);
  const std::optional<Gains> gains = gains_of(arguments, run);
  const Options options = solver_options(arguments);
  const double damping = arguments.positive("--damping", 0);
  const auto out = arguments.value("--out");
  if (!out) throw UsageError("option --out is missing");
  check_files(arguments,
              {path, arguments.value("--torques").value_or("-"), arguments.value("--reference").value_or("-"),
               arguments.value("--pushes").value_or("-")},
              {"--out", "--forces", "--json", "--view"});

  SceneFile file = load_scene(path);
  check_files(arguments, file.files, {"--out", "--forces", "--json", "--view"});
  const auto json = arguments.value("--json");
  if (json) check_writable(*json, "--json");
  if (gains) set_gains(file.scene, *gains);
  if (damping > 0) file.scene.damping = damping;
  if (arguments.has("--passive")) file.u.setZero();
  Around around = around_of(arguments, file);
  CsvFile csv(*out);
  run.view = recording_of(arguments, file.scene);
  SimulationData sim(file.scene, file.q, file.v, run.integrator, run.h, options);
  sim.condition_every = kConditionEvery;
  run.shortest = shortest_spring_step(file.scene, sim.dynamics.active, file.q, run.integrator);
  run.at_start.files = file.findings;
  run.at_start.misplaced = placement_errors(file.scene, sim.dynamics.active, file.q);
  run.at_start.moving = velocity_errors(file.scene, sim.dynamics.active, file.q, file.v);
  simulate(file.scene, around, arguments.has("--progress"), sim, csv, run);
  if (run.stopped == StepStatus::kSolverFailed)
    run.at_start.massless = massless_joints(file.scene, sim.dynamics, sim.q);
  const std::string late = switches_not_reached(around, sim);
  const bool summary = !is_standard_output(arguments, {"--out", "--forces", "--json"});
  if (summary)
    print_summary(std::cout, file, sim, around, run);
  else if (!late.empty())
    std::cerr << "manycontact: " << printable(path + ": " + late) << "\n";
  if (json) write_json_file(document(file, sim, around, run), *json);
  finish_view(arguments, file, run.view, summary ? &std::cout : nullptr);
  if (run.stopped == StepStatus::kOk) return sim.worst <= Status::kInconsistent ? kExitOk : kExitUnsound;
  std::cerr << "manycontact: " << printable(path) << ": stopped in step " << sim.steps + 1 << " of " << run.steps
            << ", at t = " << number(sim.time(), 6) << " s: " << printable(failure(file.scene, sim, run.stopped))
            << "\n";
  return kExitUnsound;
}

}  // namespace

const Command& simulate_command() {
  static const Command command{
      "simulate",
      "SCENE",
      "Simulates the scene with its contacts, and torques that are constant, given over time or from a PD law: "
      "trajectory, constraint errors, energy, momentum.",
      {{"--time", "T", "s; the last step ends at T or just after", true},
       {"--step", "H", "s", true},
       {"--out", "FILE",
        "CSV: t, q, v, largest drift over the contacts (m or rad, and per s), energy, momentum; - is standard output",
        true},
       {"--integrator", "I", "semi-implicit-euler (the default) or rk4, both on the manifold"},
       {"--gains", "G", "of all contacts: 'alpha beta', or 'recommended' for the step; default the scene's"},
       {"--damping", "D", "of the contacts instead of the scene's; 1e-8 to 1e-6 passes singular configurations"},
       {"--every", "N", "writes every Nth state, and the last"},
       {"--passive", "", "without torques"},
       {"--torques", "FILE",
        "CSV: t and columns u:robot/joint, constant from row to row; other joints, and times before the first row, "
        "have the scene's"},
       {"--pushes", "FILE",
        "CSV: t and columns w:push[0] ... w:push[5], force and torque of the scene's <push>, constant from row to row; "
        "other pushes, and times before the first row, have the scene's"},
       {"--pd", "G", "'kp kd': adds kp (q_ref - q) + kd (v_ref - v) on actuated joints, towards the scene's q or"},
       {"--reference", "FILE", "CSV: t and columns q:robot/joint, v:robot/joint, as --out writes them"},
       {"--switch", "LIST",
        "contacts that open and close: '0.2 left off, 0.5 left on' (or here: constrained at the current placement); on "
        "for an active contact stops its frames' velocity"},
       {"--forces", "FILE", "CSV: t, contact forces on A in their reference frames, at the states of --out"},
       {"--json", "FILE",
        "JSON: status, energy, violations of contacts and joint limits, and when they first occurred"},
       view_option(),
       {"--progress", "", "shows progress even where standard error is not a terminal"},
       method_option(),
       order_option()},
      "Exit status: 0 ok, redundant, inconsistent; 1 regularised, or stopped before the end (solver failed, state not\n"
      "finite, or faster than 1e5 m/s or rad/s): what was reached is written; 2 bad usage, bad input or output.\n",
      run_simulate};
  return command;
}

}  // namespace manycontact::cli
