#include "batch/batch.hpp"
#include "command/execute.hpp"
#include "command/command.hpp"

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  restart_without_blas_threads(argv);
  Command batch = command("batch", run_batch);
  if (under_mpirun()) batch.run = nullptr, batch.beside = "manycontact-mpi";
  return run_program({command("solve", run_solve), command("inspect", run_inspect), command("chart"),
                      command("simulate", run_simulate), command("optimize"), batch, command("view", run_view),
                      command("stability"), command("export")},
                     {argv + (argc > 0), argv + argc});
}
