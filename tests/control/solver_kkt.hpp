#pragma once
// Newton steps with the dense KKT matrix of the whole horizon: a reference for small problems. With w = [dxs; dus], H
// the nodes' Hessians, g their gradients and D w + c the linearised dynamics with gaps c,
//
//     [ H  D^T ] [   w    ]     [ g ]
//     [ D   0  ] [ lambda ] = - [ c ]
//
// Interface, algorithm and defaults are those of Crocoddyl 3.0's SolverKKT. A step moves states and controls
// independently, so that gaps close as far as the dynamics are linear. Motions are not simulated.

#include "manycontact/control/solver.hpp"

namespace manycontact::test {

class SolverKKT : public SolverAbstract {  // A solver with one dense matrix.
 public:
  explicit SolverKKT(
      std::shared_ptr<ShootingProblem> problem);  // problem: not null, or std::invalid_argument is thrown
  /// init_reg is ignored. Throws std::invalid_argument if nodes store no matrices.
  bool solve(const Vectors& init_xs = DEFAULT_VECTOR, const Vectors& init_us = DEFAULT_VECTOR,
             std::size_t maxiter = 100, bool is_feasible = false, double init_reg = NAN) override;
  void computeDirection(bool recalc = true) override;
  double tryStep(double steplength = 1) override;
  /// The stopping value |g + D^T lambda|^2 + |c|^2.
  double stoppingCriteria() override;
  const Eigen::Vector2d& expectedImprovement() override;
  void resizeData() override;
  double calcDiff();  // computes the nodes' derivatives and assembles the matrix; returns the cost

  const Eigen::MatrixXd& get_kkt() const { return kkt_; }                 // the KKT matrix
  const Eigen::VectorXd& get_kktref() const { return kktref_; }           // [g; c]
  const Eigen::VectorXd& get_primaldual() const { return primaldual_; }   // [w; lambda]
  const Vectors& get_dxs() const { return dxs_; }                         // steps of the states (T + 1)
  const Vectors& get_dus() const { return dus_; }                         // steps of the controls (T)
  const Vectors& get_lambdas() const { return lambdas_; }                 // multipliers of the dynamics (T + 1)
  std::size_t get_nx() const { return static_cast<std::size_t>(nx_); }    // sum over all nodes
  std::size_t get_ndx() const { return static_cast<std::size_t>(ndx_); }  // sum over all nodes
  std::size_t get_nu() const { return static_cast<std::size_t>(nu_); }    // sum over all nodes

 private:
  Eigen::Index nx_ = 0, ndx_ = 0, nu_ = 0;
  Eigen::MatrixXd kkt_;
  Eigen::VectorXd kktref_, primaldual_;
  Vectors xs_try_, us_try_, dxs_, dus_, lambdas_;
  std::vector<double> alphas_;
  double cost_try_ = 0, th_grad_ = 1e-12;
};

}  // namespace manycontact::test
