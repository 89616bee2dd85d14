#pragma once
// The measurements and charts of `manycontact stability`.

#include <string>
#include <vector>

#include "../simulate/simulate.hpp"

namespace manycontact::cli {

struct GainsChoice {
  std::string name;  // "none", "100 20", "recommended"
  bool recommended = false;
  Gains gains;  // where not recommended
};

/// One run of the chart of constraint violations.
struct DriftPoint {
  Integrator integrator;
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

/// One run of the energy chart.
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
  std::vector<GainsChoice> choices;
  std::vector<DriftPoint> drift;  // by integrator, choice, step size
  std::vector<EnergyRun> energy;
  double drift_time;  // s
};

/// base.svg and base.png, by gnuplot.
void draw_drift(const Stability& s, const std::string& base);
void draw_energy(const Stability& s, const std::string& base);

}  // namespace manycontact::cli
