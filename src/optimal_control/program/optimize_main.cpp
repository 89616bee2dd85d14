// manycontact-optimize: the command that needs the modules of optimal control.

#include "program/command/program.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  Command optimize = optimize_command();
  optimize.run = run_optimize;
  return run_program({optimize}, {argv + (argc > 0), argv + argc});
}
