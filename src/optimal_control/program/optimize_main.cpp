// The program manycontact-optimize, which contains the command that needs the modules of optimal control.

#include "program/command/command.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  return run_program({command("optimize", run_optimize)}, {argv + (argc > 0), argv + argc});
}
