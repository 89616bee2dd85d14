// Options of the commands that other programs execute. The main program prints them too, and starts those programs.

#include "../view/view.hpp"
#include "command.hpp"

namespace manycontact::cli {

const Command& chart_command() {
  static const Command command{
      "chart",
      "SCENE...",
      "Accuracy against speed: every method, order and regularisation on each scene.",
      {{"--out", "DIR", "where chart.csv and the pictures go; it is made when it is missing", true},
       {"--seconds", "S", "of repeated measurements per scene (16); everything is run at least once"},
       {"--longest", "S", "a call that would take more seconds, roughly, is skipped (20)"}},
      "DIR/chart.csv has a line per method, order and damping, the scene's own and guessed ones: 1e-12, 1e-9, 1e-6,\n"
      "1e-3. Its time_us is the median of one solve. Errors are relative, in the maximum norm, the worst over robots.\n"
      "They are differences from a solution of the scene in quadruple precision, with the scene's own damping.\n"
      "Its status is that of solve; regularised: the damping is guessed; skipped: it would take too long.\n"
      "On the front no other result is as fast and as accurate in accelerations, and better in one of the two.\n"
      "One scene: DIR/chart.svg, chart.png. Several: DIR/NAME.svg, NAME.png each, and DIR/README.md shows them.\n"
      "python3 draws them from DIR/chart.json. Without its matplotlib there are no pictures.\n"
      "Exit status: 0, whatever the statuses are; 2 bad usage, bad input or output.\n",
      nullptr,
      nullptr,
      "manycontact-chart"};
  return command;
}

const Command& stability_command() {
  static const Command command{
      "stability",
      "SCENE",
      "Charts of the scene without torques: drift of the contacts against step size, for gains from none to too stiff; "
      "energy error over many steps; both integrators. CSV, and SVG and PNG by matplotlib.",
      {{"--out", "DIR", "for drift.* and energy.*", true},
       {"--time", "T", "s, of each run of the drift chart; default 0.5"},
       {"--step", "H", "s, of the energy chart; default 0.0001"},
       {"--steps", "N", "of the energy chart; default 100000"},
       {"--progress", "", "shows progress even where standard error is not a terminal"},
       method_option(),
       order_option()},
      "Exit status: 0 charts drawn; 1 python3 with matplotlib is missing, the CSV files are there; 2 bad usage or\n"
      "bad input.\n",
      nullptr,
      nullptr,
      "manycontact-chart"};
  return command;
}

const Command& export_command() {
  static const Command command{
      "export",
      "SCENE",
      "Writes K, b and, in quadruple precision, x of each island as Matrix Market files.",
      {{"--out", "DIR", "where the files and a README.md about them go; it is made when it is missing", true},
       {"--truth", "", "also solutions, in 34 digits"},
       {"--derivatives", "", "also the right-hand sides of the derivatives"}},
      "DIR/island_N.mtx is K = [M J^T; J -delta I] of the scene's own contacts, island_N_b.mtx is b, island_N_x.mtx\n"
      "is x = [a; -f]. Without rounding of K and b, x is in island_N_scene_x.mtx. For derivatives, b and x are in\n"
      "island_N_db.mtx and island_N_dx.mtx. The names of the rows are in island_N_names.txt. DIR/README.md lists\n"
      "sizes, ranks, conditions and the correct digits of the solutions. python3 writes it from DIR/export.json.\n"
      "Exit status: 0; 2 bad usage, bad input or output.\n",
      nullptr,
      nullptr,
      "manycontact-chart"};
  return command;
}

const Command& optimize_command() {
  static const Command command{
      "optimize",
      "TASK",
      "Optimizes a motion of a scene with the task's costs and contacts.",
      {{"--out", "FILE", "CSV of the motion, a row per node, in the columns of `simulate`; - is standard output", true},
       {"--json", "FILE", "iterations, states, controls, findings and a report; - is standard output"},
       {"--torques", "FILE", "CSV of the torques, t and columns u:robot/joint, as `simulate --torques` takes them"},
       {"--forces", "FILE", "CSV of the contact forces, in the columns of `simulate --forces`"},
       {"--simulate", "H", "follow the motion with its feedback in a simulation of steps of about H s, by RK4"},
       {"--charts", "FOLDER", "convergence, torques and contact forces, as SVG and PNG, by matplotlib"},
       view_option(),
       {"--threads", "N", "for dynamics and derivatives; default all. Results do not depend on it"},
       {"--solver", "S", "fddp, box-fddp, sparse or auto; default the task's"}},
      "Progress on standard error, a line per iteration. Ctrl-C ends after the current iteration and writes the result "
      "so\n"
      "far. Exit status: 0 converged, 1 not, 2 bad usage, bad input or output.\n",
      nullptr,
      nullptr,
      "manycontact-optimize"};
  return command;
}

}  // namespace manycontact::cli
