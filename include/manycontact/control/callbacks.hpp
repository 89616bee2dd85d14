#pragma once
// Callbacks that print or record each iteration.

#include <iosfwd>

#include "manycontact/control/solver.hpp"

namespace manycontact {

/// The columns of CallbackVerbose. Level _0 has cost, stop, |grad|, preg, step, and dV expected and actual. Level _1
/// adds merit and gaps. Level _2 adds dreg, _3 violations of g and h, and _4 the reductions of the merit.
enum VerboseLevel { _0 = 0, _1, _2, _3, _4 };

/// Prints one line for each iteration, on standard output unless another stream is given, as Crocoddyl's
/// CallbackVerbose does.
class CallbackVerbose : public CallbackAbstract {
 public:
  explicit CallbackVerbose(VerboseLevel level = _4, int precision = 3);  // precision: number of digits
  /// precision: number of digits.
  explicit CallbackVerbose(std::ostream& out, VerboseLevel level = _4, int precision = 3);
  void operator()(SolverAbstract& solver) override;

  VerboseLevel get_level() const { return level_; }       // the columns
  void set_level(VerboseLevel level) { level_ = level; }  // selects the columns
  int get_precision() const { return precision_; }        // number of digits
  void set_precision(int precision);                      // not negative, or std::invalid_argument is thrown

 private:
  std::ostream* out_;
  VerboseLevel level_;
  int precision_;
};

/// Records each iteration, with the names of Crocoddyl's CallbackLogger (in Python).
class CallbackLogger : public CallbackAbstract {
 public:
  void operator()(SolverAbstract& solver) override;

  std::vector<Eigen::VectorXd> xs, us;           // candidate of the last iteration
  std::vector<std::vector<Eigen::VectorXd>> fs;  // gaps of the candidate before each iteration
  std::vector<std::size_t> iters;
  std::vector<double> costs, stops, grads, pregs, dregs, steps, ffeass, gfeass, hfeass;
  std::vector<bool> feasible;  // whether the candidate has no gaps after each iteration
};

}  // namespace manycontact
