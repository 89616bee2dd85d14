#include "simulate.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "../command/command.hpp"
#include "../command/interrupt.hpp"
#include "../command/progress.hpp"
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
const std::string kInterrupted = "interrupted";
constexpr int kConditionEvery = 10;  // steps between estimates of the condition number

struct Run {  // the options of the command line, and the results of the run
  Integrator integrator = Integrator::kSemiImplicitEuler;
  double h = 0;
  long steps = 0;
  int every = 1;

  StepStatus stopped = StepStatus::kOk;
  bool interrupted = false;
  Invariants start, end, largest;  // `largest` has the largest constraint errors of all written states
  double seconds = 0;
  SpringStep shortest;  // the spring or joint that needs the shortest steps at the start
  Findings at_start;    // findings at the start; later also nearly dependent rows, and joints whose lack of inertia
                        // ended the run
  std::optional<Recording> view;
};

Integrator integrator_of(const Arguments& arguments) {
  const std::string name = arguments.value("--integrator").value_or("semi-implicit-euler");
  const auto integrator = integrator_from_string(name);
  if (!integrator) throw UsageError("unknown integrator '" + name + "', expected semi-implicit-euler or rk4");
  return *integrator;
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
  if (!(time / run.h <= kMostSteps)) throw UsageError("--time is more than 1e9 times --step: choose a longer step");
  run.steps = std::max(1L, static_cast<long>(std::ceil(time / run.h - 1e-6)));
  run.every = arguments.integer("--every", 1, 1000000000, 1);
  return run;
}

struct Around {  // what a simulation reads (torques, wrenches, switches) and what observes it (Watch, forces file)
  Control control;
  Watch watch;
  std::optional<Switches> switches;
  std::unique_ptr<CsvFile> forces;
  std::optional<TimeTable> wrenches_in_time;
  Eigen::VectorXd wrenches;  // all external wrenches in one vector

  /// Sets the external wrenches of the next step to the file's wrenches at t, if --wrenches is given.
  void push(double t, SimulationData& sim) {
    if (!wrenches_in_time) return;
    wrenches_in_time->at(t, false, wrenches);
    for (std::size_t k = 0; k < sim.dynamics.wrenches.size(); ++k)
      sim.dynamics.wrenches[k] = wrenches.segment<6>(static_cast<Eigen::Index>(6 * k));
  }
  /// Sets the wrenches at t, and the reference of the PD law: that at the end of the step, or for RK4 in its middle.
  void act(double t, SimulationData& sim) {
    push(t, sim);
    control.set_pd(sim.integrator == Integrator::kRk4 ? t + sim.h / 2 : t + sim.h, sim.pd);
  }
};

// Adds the mean torques of the PD laws in the last step to the torques u of the motors.
Eigen::VectorXd with_pd(const Scene& scene, const SimulationData& sim, Eigen::VectorXd u) {
  if (sim.pd.kp.size() == 0) return u;
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k)
      u[robot.idx_u + k] += sim.pd_torque[robot.idx_v + robot.model->actuated[k]];
  return u;
}

// Writes the contact forces at the last state. To compute them, makes one more step, and then restores the state.
void write_last_forces(const Scene& scene, Around& around, SimulationData& sim) {
  const Eigen::VectorXd q = sim.q, v = sim.v;
  const long steps = sim.steps;
  const Status worst = sim.worst;
  const double t = sim.time();
  around.act(t, sim);
  if (step(scene, around.control.torques_at(t), sim) == StepStatus::kOk)
    write_forces_row(t, scene, sim, *around.forces);
  sim.q = q, sim.v = v, sim.steps = steps, sim.worst = worst;
}

// Makes steps and writes rows until the end, or until the status of a step is not kOk.
void simulate(Scene& scene, Around& around, bool progress_always, SimulationData& sim, CsvFile& csv, Run& run) {
  InvariantsData room(scene);
  const auto record = [&] {
    run.end = invariants(scene, sim.dynamics.active, sim.q, sim.v, room);
    run.largest.violation_position = std::max(run.largest.violation_position, run.end.violation_position);
    run.largest.violation_velocity = std::max(run.largest.violation_velocity, run.end.violation_velocity);
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
                 .drift = Eigen::Vector2d(run.end.violation_position, run.end.violation_velocity),
                 .wrenches = sim.dynamics.wrenches},
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
  const InterruptFlag interrupt;
  while (sim.steps < run.steps && run.stopped == StepStatus::kOk && !run.interrupted) {
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
    const Eigen::VectorXd& u = around.control.torques_at(t);
    around.act(t, sim);
    if (around.watch.is_new(sim)) around.watch.judge_rows(scene, u, sim, run.at_start);
    run.stopped = step(scene, u, sim);
    if (run.stopped == StepStatus::kOk) {
      around.watch.look(scene, t, q, v, with_pd(scene, sim, u), sim);
      if (around.forces && (sim.steps - 1) % run.every == 0) write_forces_row(t, scene, sim, *around.forces);
    }
    if (sim.steps % run.every == 0 && sim.steps != written) record(), written = sim.steps;
    progress.update(static_cast<double>(sim.steps));
    run.interrupted = interrupt.is_set() && sim.steps < run.steps;
  }
  if (written != sim.steps) record();
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  csv.close();
  if (!around.forces) return;
  if (run.stopped == StepStatus::kOk) write_last_forces(scene, around, sim);
  around.forces->close();
}

// Prints the contact whose gains require the smallest step, if that step is below h.
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
       "the gains " + number(worst->alpha) + " " + number(worst->beta) + " of contact " + worst->name +
           " are unstable with " + to_string(sim.integrator) + " in steps above " + number(least) +
           " s; for steps of " + number(sim.h) + " s the gains " + number(fit.alpha) + " " + number(fit.beta) +
           " are recommended",
       2);
}

// Returns a name of the spring or joint in `shortest`: "spring rope", "joint arm/wrist, by its spring and PD law,".
std::string name_of(const Scene& scene, const SimulationData& sim, const SpringStep& shortest) {
  if (shortest.spring >= 0) return "spring " + scene.springs[shortest.spring].name;
  const int i = shortest.coordinate;
  std::vector<std::string> by;
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[spring.robot];
    if (robot.idx_v + robot.model->joints[spring.joint].idx_v == i && spring.stiffness > 0) by.push_back("spring");
  }
  for (const Robot& robot : scene.robots) {
    const int own = i - robot.idx_v;
    if (own < 0 || own >= robot.model->nv) continue;
    const bool rk4 = sim.integrator == Integrator::kRk4;
    if (rk4 && robot.model->damping.size() > 0 && robot.model->damping[own] > 0) by.push_back("damper");
    if (rk4 && robot.model->friction.size() > 0 && robot.model->friction[own] > 0) by.push_back("friction");
  }
  if (sim.pd.kp.size() > 0 && (sim.pd.kp[i] > 0 || sim.pd.kd[i] > 0)) by.push_back("PD law");
  std::string list;
  for (std::size_t k = 0; k < by.size(); ++k) list += (k == 0 ? "" : k + 1 == by.size() ? " and " : ", ") + by[k];
  return "joint " + velocity_names(scene)[i] + ", because of its " + list + ",";
}

// Returns advice if the step h is too long for the spring or joint in `shortest`, otherwise "".
std::string spring_advice(const Scene& scene, const SimulationData& sim, const SpringStep& shortest) {
  if (!shortest.any() || shortest.largest >= sim.h) return "";
  const std::string who = name_of(scene, sim, shortest);
  if (sim.integrator == Integrator::kSemiImplicitEuler)
    return who + " oscillates faster at the start than steps of " + number(sim.h) + " s can follow; steps of " +
           number(shortest.largest) + " s can. The present step is stable, and damps such oscillations";
  return who + " is unstable with " + to_string(sim.integrator) + " in steps above " + number(shortest.largest) +
         " s, for the initial inertia";
}

// Describes the closed contact with the largest placement error, such as "g closes 0.4 m away from its place".
std::string closed_away(const Scene& scene, const Switches::ImpactEvent& blow) {
  const auto size = [](const PlacementError& e) { return std::max(e.position, e.angle); };
  const PlacementError& worst = *std::ranges::max_element(blow.away, {}, size);
  return "at t = " + number(blow.t, 4) + " s contact " + scene.contacts[worst.contact].name + " closes " +
         in_words(worst) + " away from its reference placement" +
         (blow.away.size() > 1 ? ", and " + count(blow.away.size() - 1, "other contact") + " similarly" : "") +
         "; `here` in place of `on` constrains a contact at its current placement";
}

void print_impacts(std::ostream& out, const Scene& scene, const Around& around) {
  if (!around.switches) return;
  for (const Switches::ImpactEvent& blow : around.switches->blows()) {
    wrap(out,
         "at t = " + number(blow.t, 4) + " s " + blow.contacts + " closed: the impact dissipated " +
             number(blow.jump.energy_lost) + " J",
         2);
    if (!blow.away.empty()) wrap(out, printable(closed_away(scene, blow)), 2);
  }
}

// Returns the switches of --switch that the run did not reach, or "" if all were made.
std::string switches_not_reached(const Around& around, const SimulationData& sim) {
  const std::string list = around.switches ? around.switches->not_reached() : "";
  return list.empty()
             ? ""
             : "contacts were not switched, because the run ended at t = " + number(sim.time(), 6) + " s: " + list;
}

void print_summary(std::ostream& out, const SceneFile& file, const SimulationData& sim, const Around& around,
                   const Run& run) {
  out << printable(file.scene.name) << ": " << count(sim.steps, "step") << " of " << number(sim.h) << " s, "
      << to_string(sim.integrator) << ", to t = " << number(sim.time(), 6) << " s in " << number(run.seconds)
      << " s, status " << to_string(sim.worst) << "\n";
  Table table("<|start|end|largest|<");
  const auto short_of = [](double x) { return x == 0 ? std::string("0") : scientific(x); };
  table.add({"drift, position", short_of(run.start.violation_position), short_of(run.end.violation_position),
             short_of(run.largest.violation_position), "m, rad"});
  table.add({"drift, velocity", short_of(run.start.violation_velocity), short_of(run.end.violation_velocity),
             short_of(run.largest.violation_velocity), "m/s, rad/s"});
  table.add({"energy", number(run.start.energy(), 6), number(run.end.energy(), 6), "", "J"});
  table.add({"work of torques", "", number(around.watch.work(), 6), "", "J; energy lost in impacts is subtracted"});
  if (!file.scene.wrenches.empty())
    table.add({"work of wrenches", "", number(around.watch.work_of_wrenches(), 6), "", "J"});
  table.print(out);
  print_impacts(out, file.scene, around);
  const std::string late = switches_not_reached(around, sim);
  if (!late.empty()) wrap(out, printable(late), 2);
  print_findings(out, file.scene, run.at_start);
  around.watch.print(out, file, sim, run.start, run.end, run.largest.kinetic);
  print_advice(out, file.scene, sim);
  const std::string springs = spring_advice(file.scene, sim, run.shortest);
  if (!springs.empty()) wrap(out, printable(springs), 2);
  if (sim.unsettled > 0)
    wrap(out, "in " + count(sim.unsettled, "step") + " joint friction did not settle: shorter steps may help", 2);
}

Json document(const SceneFile& file, const SimulationData& sim, const Around& around, const Run& run) {
  Json json = {{"scene", file.scene.name},
               {"integrator", to_string(sim.integrator)},
               {"step", sim.h},
               {"steps", sim.steps},
               {"time", sim.time()},
               {"status", to_string(sim.worst)},
               {"stopped", run.stopped != StepStatus::kOk ? Json(failure(file.scene, sim, run.stopped))
                           : run.interrupted              ? Json(kInterrupted)
                                                          : Json(nullptr)},
               {"energy", {run.start.energy(), run.end.energy()}},
               {"largest_violation_position", run.largest.violation_position}};
  json["largest_step_of_springs"] = run.shortest.any() ? Json(run.shortest.largest) : Json(nullptr);
  const std::string advice = spring_advice(file.scene, sim, run.shortest);
  json["step_too_long"] = advice.empty() ? Json(nullptr) : Json(advice);
  json["unsettled_friction"] = sim.unsettled;
  add_findings(file.scene, run.at_start, json);
  if (around.switches)
    for (const Switches::ImpactEvent& blow : around.switches->blows())
      if (!blow.away.empty())
        json["findings"].push_back({{"kind", "closes"},
                                    {"name", file.scene.contacts[blow.away.front().contact].name},
                                    {"text", closed_away(file.scene, blow)}});
  around.watch.add_to(json, file.scene);
  return json;
}

// Reads the options for torques, PD laws, wrenches over time and switches, and the file for forces.
Around around_of(const Arguments& arguments, const SceneFile& file) {
  Around out{Control(file), Watch(file.scene, solver_options(arguments)), std::nullopt, nullptr, std::nullopt, {}};
  if (const auto wrenches = arguments.value("--wrenches")) {
    if (file.scene.wrenches.empty())
      throw InputError(file.path, 1, "the scene has no <wrench>, expected the wrenches that --wrenches gives");
    out.wrenches_in_time.emplace(*wrenches, "w:", wrench_names(file.scene));
    if (out.wrenches_in_time->empty())
      throw InputError(*wrenches, 1,
                       "has no column of a wrench, expected columns like w:" + wrench_names(file.scene).front());
    out.wrenches.resize(static_cast<Eigen::Index>(6 * file.scene.wrenches.size()));
    for (std::size_t k = 0; k < file.scene.wrenches.size(); ++k)
      out.wrenches.segment<6>(static_cast<Eigen::Index>(6 * k)) = file.scene.wrenches[k].wrench;
  }
  if (const auto torques = arguments.value("--torques")) out.control.read_torques(*torques);
  const auto pd = arguments.value("--pd"), reference = arguments.value("--reference");
  if (reference && !pd) throw UsageError("option --reference needs --pd");
  if (pd) out.control.follow(*pd, reference);
  if (const auto text = arguments.value("--switch")) out.switches.emplace(*text, file);
  if (const auto forces = arguments.value("--forces")) out.forces = std::make_unique<CsvFile>(*forces, "--forces");
  return out;
}

}  // namespace

Gains two_numbers(const std::string& option, const std::string& names, const std::string& text,
                  const std::string& otherwise) {
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
    throw UsageError("option " + option + " is '" + text + "', expected '" + names + "' with both 0 or more" +
                     otherwise);
  return {x[0], x[1]};
}

int run_simulate(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  Run run = run_of(arguments);
  const std::optional<Gains> gains = gains_of(arguments, run);
  const Options options = solver_options(arguments);
  const double damping = arguments.positive("--damping", 0);
  const std::string out = arguments.required("--out");
  check_files(arguments,
              {path, arguments.value("--torques").value_or("-"), arguments.value("--reference").value_or("-"),
               arguments.value("--wrenches").value_or("-")},
              {"--out", "--forces", "--json", "--view"});

  SceneFile file = load_scene(path);
  check_files(arguments, file.files, {"--out", "--forces", "--json", "--view"});
  const auto json = arguments.value("--json");
  if (json) check_writable(*json, "--json");
  if (gains) set_gains(file.scene, *gains);
  if (damping > 0) file.scene.damping = damping;
  if (arguments.has("--passive")) file.u.setZero();
  Around around = around_of(arguments, file);
  CsvFile csv(out);
  run.view = recording_of(arguments, file.scene);
  SimulationData sim(file.scene, file.q, file.v, run.integrator, run.h, options);
  sim.condition_every = kConditionEvery;
  around.control.set_pd(0, sim.pd);
  run.shortest = shortest_spring_step(file.scene, sim.pd, sim.dynamics.active, file.q, run.integrator);
  run.at_start.files = file.findings;
  run.at_start.misplaced = placement_errors(file.scene, file.q, sim.dynamics.active);
  run.at_start.moving = velocity_errors(file.scene, file.q, file.v, sim.dynamics.active);
  simulate(file.scene, around, arguments.has("--progress"), sim, csv, run);
  if (run.stopped != StepStatus::kOk) around.watch.judge_rows(file.scene, file.u, sim, run.at_start);
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
  if (run.stopped == StepStatus::kOk && !run.interrupted)
    return sim.worst <= Status::kInconsistent ? kExitOk : kExitUnsound;
  const std::string& rows = around.watch.nearly_dependent();
  const std::string advice = rows.empty() && !summary ? spring_advice(file.scene, sim, run.shortest) : rows;
  std::cerr << "manycontact: " << printable(path) << ": stopped in step " << sim.steps + 1 << " of " << run.steps
            << ", at t = " << number(sim.time(), 6)
            << " s: " << printable(run.interrupted ? kInterrupted : failure(file.scene, sim, run.stopped))
            << (advice.empty() ? "" : "; " + printable(advice)) << "\n";
  return kExitUnsound;
}

}  // namespace manycontact::cli
