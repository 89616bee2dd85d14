// manycontact-chart: the commands that judge answers by quadruple precision and draw with gnuplot.

#include "program/program.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  Command chart = chart_command(), stability = stability_command();
  chart.run = run_chart;
  stability.run = run_stability;
  return run_program({chart, stability}, {argv + (argc > 0), argv + argc});
}
