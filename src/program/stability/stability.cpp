// `manycontact stability`: constraint violation and energy error by step size, gains and integrator.

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
  std::string name;  // "none", "100 20", "recommended"
  bool recommended = false;
  Gains gains;  // used if `recommended` is false
};

// One run of the chart of constraint violations.
struct DriftPoint {
  Integrator integrator;
  std::string name;  // name of the gains
  Gains gains;
  double h;            // s
  long steps;          // planned
  Invariants largest;  // constraint violation over the run
  StepStatus stopped;  // kOk: it ran to the end
};

struct EnergyRow {
  long step;
  double error;  // largest |E - E(0)| so far, J
  double drift;  // position, at this step
};

// One run of the energy chart.
struct EnergyRun {
  Integrator integrator;
  std::string gains;
  double h;
  std::vector<EnergyRow> rows;
  StepStatus stopped;
  long steps;      // done
  double kinetic;  // largest, J
};

struct Stability {
  std::string scene;
  std::vector<DriftPoint> drift;  // sorted by integrator, gains and step size
  std::vector<EnergyRun> energy;
  double drift_time;  // s
};

// Critically damped gains with these rates [1/s], from soft to stiff; 0: no gains.
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

// The largest constraint violation over `time`; stops if a step fails.
DriftPoint measure_drift(SceneFile file, const Options& options, Integrator integrator, const GainsChoice& choice,
                         double h, double time, const std::function<void(long)>& each) {
  const Gains gains = gains_for(choice, integrator, h);
  const long steps = static_cast<long>(std::ceil(time / h - 1e-6));
  set_gains(file.scene, gains);
  SimulationData sim(file.scene, file.q, file.v, integrator, h, options);
  InvariantsData room(file.scene);
  DriftPoint point{integrator, choice.name, gains, h, steps, {}, StepStatus::kOk};
  while (sim.steps < point.steps && point.stopped == StepStatus::kOk) {
    point.stopped = step(file.scene, file.u, sim);
    const Invariants at = invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room);
    point.largest.position_drift = std::max(point.largest.position_drift, at.position_drift);
    point.largest.velocity_drift = std::max(point.largest.velocity_drift, at.velocity_drift);
    each(sim.steps);
  }
  return point;
}

// Largest energy error so far, at steps spaced evenly in their logarithm.
EnergyRun measure_energy(SceneFile file, const Options& options, Integrator integrator, const GainsChoice& choice,
                         double h, long steps, const std::function<void(long)>& each) {
  set_gains(file.scene, gains_for(choice, integrator, h));
  SimulationData sim(file.scene, file.q, file.v, integrator, h, options);
  InvariantsData room(file.scene);
  const double start = invariants(file.scene, sim.dynamics.active, sim.q, sim.v, room).energy();
  EnergyRun out{integrator, choice.name, h, {}, StepStatus::kOk, 0, 0};
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
    out.rows.push_back({sim.steps, largest, at.position_drift});
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

// Solves of all runs, which is what they cost.
double total_work(const Plan& plan) {
  double work = 0;
  for (double h : step_sizes()) work += 5 * plan.drift_time / h * static_cast<double>(gains_choices().size());
  return work + 2.0 * 5 * static_cast<double>(plan.energy_steps);
}

Stability measure(const SceneFile& file, const Options& options, const Plan& plan) {
  const std::vector<GainsChoice> choices = gains_choices();
  Stability out{file.scene.name, {}, {}, plan.drift_time};
  Progress progress("", total_work(plan), plan.progress);
  double done = 0;
  for (Integrator integrator : kIntegrators) {
    const double cost = integrator == Integrator::kRk4 ? 4 : 1;
    for (const GainsChoice& choice : choices) {
      const std::string label = "drift, " + to_string(integrator) + ", gains " + choice.name;
      for (double h : step_sizes()) {
        out.drift.push_back(measure_drift(file, options, integrator, choice, h, plan.drift_time, [&](long k) {
          progress.update(done + cost * static_cast<double>(k), label);
        }));
        done += cost * plan.drift_time / h;
      }
    }
  }
  for (Integrator integrator : kIntegrators)
    for (const GainsChoice& choice : {choices.front(), choices.back()}) {
      const double cost = integrator == Integrator::kRk4 ? 4 : 1;
      const std::string label = "energy, " + to_string(integrator) + ", gains " + choice.name;
      out.energy.push_back(
          measure_energy(file, options, integrator, choice, plan.energy_step, plan.energy_steps,
                         [&](long k) { progress.update(done + cost * static_cast<double>(k), label); }));
      done += cost * static_cast<double>(plan.energy_steps);
    }
  return out;
}

const char* to_string(StepStatus status) {
  switch (status) {
    case StepStatus::kOk:
      return "";
    case StepStatus::kSolverFailed:
      return "solver failed";
    case StepStatus::kNotFinite:
      return "not finite";
    case StepStatus::kTooFast:
      return "too fast";
  }
  return "";
}

void write_drift(const Stability& s, const fs::path& path) {
  CsvFile csv(path.string());
  for (const char* name : {"integrator", "gains", "alpha", "beta", "step_s", "steps", "largest_position_drift",
                           "largest_velocity_drift", "stopped", "largest_stable_step_s"})
    csv << name;
  csv.end_row();
  for (const DriftPoint& p : s.drift) {
    csv << to_string(p.integrator) << p.name << p.gains.alpha << p.gains.beta << p.h << static_cast<double>(p.steps)
        << p.largest.position_drift << p.largest.velocity_drift << to_string(p.stopped)
        << largest_stable_step(p.integrator, p.gains);
    csv.end_row();
  }
  csv.close();
}

void write_energy(const Stability& s, const fs::path& path) {
  CsvFile csv(path.string());
  for (const char* name : {"integrator", "gains", "step_s", "step", "largest_energy_error_J", "position_drift"})
    csv << name;
  csv.end_row();
  for (const EnergyRun& run : s.energy)
    for (const EnergyRow& row : run.rows) {
      csv << to_string(run.integrator) << run.gains << run.h << static_cast<double>(row.step) << row.error << row.drift;
      csv.end_row();
    }
  csv.close();
}

// Writes the data that the charts show in addition to the CSV files.
void write_json(const Stability& s, const fs::path& path) {
  Json runs = Json::array();
  for (const EnergyRun& run : s.energy)
    runs.push_back({{"integrator", to_string(run.integrator)},
                    {"gains", run.gains},
                    {"step_s", run.h},
                    {"steps", run.steps},
                    {"stopped", to_string(run.stopped)},
                    {"largest_kinetic_energy_J", run.kinetic}});
  write_json_file({{"scene", s.scene}, {"drift_time_s", s.drift_time}, {"energy_runs", runs}}, path.string(), "--out");
}

// Whether any run has an energy error to draw.
bool has_energy_error(const Stability& s) {
  return std::any_of(s.energy.begin(), s.energy.end(),
                     [](const EnergyRun& run) { return !run.rows.empty() && run.rows.back().error > 0; });
}

void print_summary(std::ostream& out, const Stability& s) {
  Table table({{"integrator", Table::kLeft},
               {"gains", Table::kLeft},
               {"steps"},
               {"energy error J"},
               {"drift"},
               {"", Table::kLeft}});
  for (const EnergyRun& run : s.energy)
    table.add({to_string(run.integrator), run.gains, std::to_string(run.steps),
               run.rows.empty() ? "" : scientific(run.rows.back().error),
               run.rows.empty() ? "" : scientific(run.rows.back().drift), to_string(run.stopped)});
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
  const auto folder = arguments.value("--out");
  if (!folder) throw UsageError("option --out is missing");

  SceneFile file = load_scene(path);
  check_folder("--out", *folder,
               {"drift.csv", "drift.svg", "drift.png", "energy.csv", "energy.svg", "energy.png", "stability.json"},
               file.files);
  if (file.scene.contacts.empty()) throw InputError(path, 1, "there are no contacts, expected some to drift");
  file.u.setZero();
  std::error_code error;
  fs::create_directories(*folder, error);
  if (error) throw InputError(*folder, 1, "cannot be created: " + error.message() + ", expected a folder for --out");
  const Stability s = measure(file, options, plan);
  write_drift(s, fs::path(*folder) / "drift.csv");
  write_energy(s, fs::path(*folder) / "energy.csv");
  write_json(s, fs::path(*folder) / "stability.json");
  print_summary(std::cout, s);
  const Python python = find_python();
  if (!python.draws) {
    std::cerr << "manycontact: " << kNoCharts << "; drift.csv and energy.csv are in " << printable(*folder) << "\n";
    return kExitUnsound;
  }
  run_python(python, script_path("stability.py"), {*folder});
  const bool energy = has_energy_error(s);
  std::cout << "charts: drift" << (energy ? " and energy" : "") << ", .png and .svg, in " << printable(*folder) << "\n";
  if (!energy) std::cout << "no energy chart: no run that took a step has an energy error\n";
  return kExitOk;
}

}  // namespace manycontact::cli
