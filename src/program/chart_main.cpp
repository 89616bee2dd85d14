// The program manycontact-chart, which contains the commands that need quadruple precision.

#include "command/command.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  return run_program({command("chart", run_chart), command("stability", run_stability), command("export", run_export)},
                     {argv + (argc > 0), argv + argc});
}
