#pragma once
// Feasibility-driven DDP: a step of length s < 1 leaves (1 - s) of the candidate's gaps, and may increase the cost
// until the gaps are closed. Interface, algorithm and defaults are those of Crocoddyl 3.0's SolverFDDP (Mastalli et
// al., ICRA 2020).

#include "manycontact/control/ddp.hpp"

namespace manycontact {

class SolverFDDP : public SolverDDP {  // DDP that accepts any initial guess: the iterations close its gaps.
 public:
  using SolverDDP::SolverDDP;

  const Eigen::Vector2d& expectedImprovement() override;
  /// Computes the terms of the expected improvement that do not depend on the step.
  void updateExpectedImprovement();
  void forwardPass(double steplength) override;
  /// Returns the multiple of the expected increase by which a step from a candidate with gaps may increase the cost.
  double get_th_acceptnegstep() const { return th_acceptnegstep_; }
  /// Sets by which multiple of the expected increase a step from a candidate with gaps may increase the cost. Throws
  /// std::invalid_argument if the multiple is negative.
  void set_th_acceptnegstep(double x) {
    internal::kNotNegative.set(th_acceptnegstep_, x, "SolverFDDP::set_th_acceptnegstep");
  }

 protected:
  void prepareImprovement() override { updateExpectedImprovement(); }
  void updateImprovement() override { d_ = Eigen::Vector2d(expectedImprovement()); }
  bool accepts() const override;
  bool closesGaps() const override { return was_feasible_ || steplength_ == 1; }
  double dg_ = 0, dq_ = 0, dv_ = 0;
  double th_acceptnegstep_ = 2;
};

}  // namespace manycontact
