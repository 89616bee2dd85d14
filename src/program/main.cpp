// manycontact: the program.

#include "command/execute.hpp"
#include "command/program.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  restart_without_blas_threads(argv);
  return run_program({solve_command(), inspect_command(), chart_command(), simulate_command(), optimize_command(),
                      batch_command(), view_command(), stability_command(), export_command()},
                     {argv + (argc > 0), argv + argc});
}
