// The command `manycontact stability` measures constraint violation and energy error for steps, gains and integrators.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "../command/command.hpp"
#include "../command/progress.hpp"
#include "../files/json_file.hpp"
#include "../files/python.hpp"
#include "../simulate/simulate.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace {

namespace fs = std::filesystem;

struct GainsChoice {
  std::string name;  // such as "none", "100 20", "recommended"
  bool recommended = false;
  Gains gains;  // used if `recommended` is false
};

struct EnergyRow {
  long step;
  double error;  // largest |E - E(0)| so far [J]
  double drift;  // constraint violation of positions at this step [m, rad]
};

struct EnergyRun {  // one run of the energy chart
  Integrator integrator;
  std::string gains;
  double h;
  EnergyRow last = {};  // last row of energy.csv
  StepStatus stopped = StepStatus::kOk;
  long steps = 0;      // completed steps
  double kinetic = 0;  // largest kinetic energy during the run [J]
};

// Rates omega [1/s] of critically damped gains alpha = omega^2, beta = 2 omega. 0 means no gains.
constexpr double kRates[] = {0, 10, 100, 1000};
constexpr double kSmallestStep = 5e-4, kLargestStep = 0.1;  // s
constexpr int kStepsPerDecade = 10;
constexpr int kEnergyRows = 400;

std::vector<double> step_sizes() {
  std::vector<double> sizes;
  const double decades = std::log10(kLargestStep / kSmallestStep);
  const int n = static_cast<int>(std::round(decades * kStepsPerDecade));
  for (int k = 0; k <= n; ++k) sizes.push_back(kLargestStep * std::pow(10, -decades * k / n));
  return sizes;
}

std::vector<GainsChoice> gains_choices() {
  std::vector<GainsChoice> out;
  for (double rate : kRates)
    out.push_back({rate == 0 ? "none" : number(rate * rate) + " " + number(2 * rate), false, {rate * rate, 2 * rate}});
  out.push_back({"recommended", true, {}});
  return out;
}

Gains gains_for(const GainsChoice& choice, Integrator integrator, double h) {
  return choice.recommended ? recommended_gains(integrator, h) : choice.gains;
}

const char* to_string(StepStatus status) {
  constexpr const char* kNames[] = {"", "solver failed", "not finite", "too fast"};
  return kNames[static_cast<int>(status)];
}

// Simulates `time` seconds and writes a row with the largest constraint violation. Stops if a step fails.
void measure_drift(SceneFile file, const Options& options, Integrator integrator, const GainsChoice& choice, double h,
                   double time, const std::function<void(long)>& each, CsvFile& csv) {
  const Gains gains = gains_for(choice, integrator, h);
  const long steps = static_cast<long>(std::ceil(time / h - 1e-6));
  set_gains(file.scene, gains);
  SimulationData sim(file.scene, file.q, file.v, integrator, h, options);
  InvariantsData room(file.scene);
  Invariants largest;
  StepStatus stopped = StepStatus::kOk;
  while (sim.steps < steps && stopped == StepStatus::kOk) {
    stopped = step(file.scene, file.u, sim);
    const Invariants at = invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room);
    largest.violation_position = std::max(largest.violation_position, at.violation_position);
    largest.violation_velocity = std::max(largest.violation_velocity, at.violation_velocity);
    each(sim.steps);
  }
  csv << to_string(integrator) << choice.name << gains.alpha << gains.beta << h << static_cast<double>(steps)
      << largest.violation_position << largest.violation_velocity << to_string(stopped)
      << largest_stable_step(integrator, gains);
  csv.end_row();
}

// Writes rows of the largest energy error so far, at steps spaced evenly in their logarithm.
EnergyRun measure_energy(SceneFile file, const Options& options, Integrator integrator, const GainsChoice& choice,
                         double h, long steps, const std::function<void(long)>& each, CsvFile& csv) {
  set_gains(file.scene, gains_for(choice, integrator, h));
  SimulationData sim(file.scene, file.q, file.v, integrator, h, options);
  InvariantsData room(file.scene);
  const double start = invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room).energy();
  EnergyRun out{integrator, choice.name, h};
  double largest = 0, next = 1;
  const double growth = std::pow(static_cast<double>(steps), 1.0 / kEnergyRows);
  while (sim.steps < steps && out.stopped == StepStatus::kOk) {
    out.stopped = step(file.scene, file.u, sim);
    if (out.stopped != StepStatus::kOk) break;
    const Invariants at = invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room);
    largest = std::max(largest, std::abs(at.energy() - start));
    out.kinetic = std::max(out.kinetic, at.kinetic);
    each(sim.steps);
    if (static_cast<double>(sim.steps) < next && sim.steps != steps) continue;
    out.last = {sim.steps, largest, at.violation_position};
    csv << to_string(integrator) << choice.name << h << static_cast<double>(sim.steps) << largest
        << at.violation_position;
    csv.end_row();
    while (growth > 1 && next <= static_cast<double>(sim.steps)) next *= growth;
  }
  out.steps = sim.steps;
  return out;
}

struct Plan {
  double drift_time = 0.5, energy_step = 1e-4;
  long energy_steps = 100000;
  bool progress = false;
};

// Returns the number of solves of all runs, which is a measure of their cost.
double total_work(const Plan& plan) {
  double work = 0;
  for (double h : step_sizes()) work += 5 * plan.drift_time / h * static_cast<double>(gains_choices().size());
  return work + 2.0 * 5 * static_cast<double>(plan.energy_steps);
}

std::vector<EnergyRun> measure(const SceneFile& file, const Options& options, const Plan& plan,
                               const fs::path& folder) {
  const std::vector<GainsChoice> choices = gains_choices();
  std::vector<EnergyRun> out;
  Progress progress("", total_work(plan), plan.progress);
  double done = 0;
  const auto cost = [](Integrator integrator) { return integrator == Integrator::kRk4 ? 4 : 1; };
  const auto show = [&](const std::string& chart, Integrator integrator, const GainsChoice& choice) {
    return [&, integrator, label = chart + ", " + to_string(integrator) + ", gains " + choice.name](long k) {
      progress.update(done + cost(integrator) * static_cast<double>(k), label);
    };
  };
  CsvFile drift((folder / "drift.csv").string()), energy((folder / "energy.csv").string());
  drift.header({"integrator", "gains", "alpha", "beta", "step_s", "steps", "largest_violation_position",
                "largest_violation_velocity", "stopped", "largest_stable_step_s"});
  energy.header({"integrator", "gains", "step_s", "step", "largest_energy_error_J", "violation_position"});
  for (Integrator integrator : kIntegrators)
    for (const GainsChoice& choice : choices)
      for (double h : step_sizes()) {
        measure_drift(file, options, integrator, choice, h, plan.drift_time, show("drift", integrator, choice), drift);
        done += cost(integrator) * plan.drift_time / h;
      }
  for (Integrator integrator : kIntegrators)
    for (const GainsChoice& choice : {choices.front(), choices.back()}) {
      out.push_back(measure_energy(file, options, integrator, choice, plan.energy_step, plan.energy_steps,
                                   show("energy", integrator, choice), energy));
      done += cost(integrator) * static_cast<double>(plan.energy_steps);
    }
  drift.close();
  energy.close();
  return out;
}

void write_json(const std::string& scene, const Plan& plan, const std::vector<EnergyRun>& energy,
                const fs::path& path) {
  Json runs = Json::array();
  for (const EnergyRun& run : energy)
    runs.push_back({{"integrator", to_string(run.integrator)},
                    {"gains", run.gains},
                    {"step_s", run.h},
                    {"steps", run.steps},
                    {"stopped", to_string(run.stopped)},
                    {"largest_kinetic_energy_J", run.kinetic}});
  write_json_file({{"scene", scene}, {"drift_time_s", plan.drift_time}, {"energy_runs", runs}}, path.string(), "--out");
}

void print_summary(std::ostream& out, const std::vector<EnergyRun>& energy) {
  Table table("integrator<|gains<|steps|energy error J|drift|<");
  for (const EnergyRun& run : energy) {
    const bool any = run.last.step > 0;
    table.add({to_string(run.integrator), run.gains, std::to_string(run.steps), any ? scientific(run.last.error) : "",
               any ? scientific(run.last.drift) : "", to_string(run.stopped)});
  }
  table.print(out);
}

}  // namespace

int run_stability(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  Plan plan;
  plan.drift_time = arguments.positive("--time", plan.drift_time);
  plan.energy_step = arguments.positive("--step", plan.energy_step);
  plan.energy_steps = arguments.integer("--steps", 1, 1000000000, static_cast<int>(plan.energy_steps));
  plan.progress = arguments.has("--progress");
  const Options options = solver_options(arguments);
  const std::string folder = arguments.required("--out");

  SceneFile file = load_scene(path);
  check_folder("--out", folder,
               {"drift.csv", "drift.svg", "drift.png", "energy.csv", "energy.svg", "energy.png", "stability.json"},
               file.files);
  if (file.scene.contacts.empty())
    throw InputError(path, 1, "the scene has no contacts, expected at least one contact");
  file.u.setZero();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder, 1, "cannot be created: " + error.message() + ", expected a folder for --out");
  const std::vector<EnergyRun> runs = measure(file, options, plan, folder);
  write_json(file.scene.name, plan, runs, fs::path(folder) / "stability.json");
  print_summary(std::cout, runs);
  const Python python = find_python();
  if (!python.draws) {
    std::cerr << "manycontact: " << kNoCharts << "; drift.csv and energy.csv are in " << printable(folder) << "\n";
    return kExitUnsound;
  }
  run_python(python, script_path("stability.py"), {folder});
  const bool energy = std::ranges::any_of(runs, [](const EnergyRun& run) { return run.last.error > 0; });
  std::cout << "charts: drift" << (energy ? " and energy" : "") << ", .png and .svg, in " << printable(folder) << "\n";
  if (!energy) std::cout << "there is no energy chart, because no run that took a step has an energy error\n";
  return kExitOk;
}

}  // namespace manycontact::cli
