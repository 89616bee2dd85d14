#include "manycontact/control/callbacks.hpp"

#include <iomanip>
#include <iostream>
#include <sstream>

namespace manycontact {

CallbackVerbose::CallbackVerbose(VerboseLevel level, int precision) : CallbackVerbose(std::cout, level, precision) {}

CallbackVerbose::CallbackVerbose(std::ostream& out, VerboseLevel level, int precision) : out_(&out), level_(level) {
  set_precision(precision);
}

void CallbackVerbose::set_precision(int precision) {
  require(precision >= 0, "CallbackVerbose::set_precision", "a number that is not negative is expected");
  precision_ = precision;
}

void CallbackVerbose::operator()(SolverAbstract& solver) {
  struct Column {
    const char* name;
    VerboseLevel from;
    double value;
  };
  const Column columns[] = {
      {"cost", _0, solver.get_cost()},        {"merit", _1, solver.get_merit()},
      {"stop", _0, solver.get_stop()},        {"|grad|", _0, std::abs(solver.get_d()[0])},
      {"preg", _0, solver.get_preg()},        {"dreg", _2, solver.get_dreg()},
      {"step", _0, solver.get_steplength()},  {"||ffeas||", _1, solver.get_ffeas()},
      {"||gfeas||", _3, solver.get_gfeas()},  {"||hfeas||", _3, solver.get_hfeas()},
      {"dV-exp", _0, solver.get_dVexp()},     {"dV", _0, solver.get_dV()},
      {"dPhi-exp", _4, solver.get_dPhiexp()}, {"dPhi", _4, solver.get_dPhi()},
  };
  std::ostringstream header, line;
  header << "iter";
  line << std::setw(4) << solver.get_iter();
  const int width = precision_ + 8;  // width of -1.234e+05
  for (const Column& column : columns) {
    if (level_ < column.from) continue;
    const bool fixed = std::string(column.name) == "step";
    header << "  " << std::setw(fixed ? 6 : width) << column.name;
    if (fixed)
      line << "  " << std::fixed << std::setprecision(4) << std::setw(6) << column.value;
    else
      line << "  " << std::scientific << std::setprecision(precision_) << std::setw(width) << column.value;
  }
  if (solver.get_iter() % 10 == 0) *out_ << header.str() << "\n";
  *out_ << line.str() << std::endl;
}

void CallbackLogger::operator()(SolverAbstract& solver) {
  xs = solver.get_xs();
  us = solver.get_us();
  fs.push_back(solver.get_fs());
  iters.push_back(solver.get_iter());
  costs.push_back(solver.get_cost());
  stops.push_back(solver.get_stop());
  grads.push_back(std::abs(solver.get_d()[0]));
  pregs.push_back(solver.get_preg());
  dregs.push_back(solver.get_dreg());
  steps.push_back(solver.get_steplength());
  ffeass.push_back(solver.get_ffeas());
  gfeass.push_back(solver.get_gfeas());
  hfeass.push_back(solver.get_hfeas());
  feasible.push_back(solver.get_is_feasible());
}

}  // namespace manycontact
