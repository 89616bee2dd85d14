// manycontact-chart: the commands that need quadruple precision.

#include "command/program.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  Command chart = chart_command(), stability = stability_command(), exporting = export_command();
  chart.run = run_chart;
  stability.run = run_stability;
  exporting.run = run_export;
  return run_program({chart, stability, exporting}, {argv + (argc > 0), argv + argc});
}
