#pragma once
// Minimises 1/2 x^T H x + q^T x with lb <= x <= ub, H positive definite, by projected Newton steps (Bertsekas, SIAM J.
// Control Optim. 1982; Tassa et al., ICRA 2014). Interface, algorithm and defaults are those of Crocoddyl 3.0's BoxQP.

#include <Eigen/Cholesky>
#include <vector>

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact {

struct BoxQPSolution {      // The minimum x, the free components, and the components clamped to a bound.
  Eigen::MatrixXd Hff_inv;  // inverse of Hff, the rows and columns of H of the free components
  Eigen::VectorXd x;
  std::vector<std::size_t> free_idx, clamped_idx;
};

class BoxQP {  // The solver of one quadratic problem with bounds.
 public:
  /// nx: number of unknowns. reg is added to the diagonal of H. Throws std::invalid_argument for numbers out of range.
  explicit BoxQP(std::size_t nx, std::size_t maxiter = 100, double th_acceptstep = 0.1, double th_grad = 1e-9,
                 double reg = 1e-9);

  /// Solves the problem from xinit. If Hff is not positive definite, is_sound() is false, and x is unusable. The
  /// returned reference remains valid until the next call. Throws std::invalid_argument for wrong sizes.
  const BoxQPSolution& solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                             const Eigen::VectorXd& ub, const Eigen::VectorXd& xinit);
  /// Solves the problem without Hff_inv, and without allocating; returns false if it fails.
  [[nodiscard]] bool minimise(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                              const Eigen::VectorXd& ub, const Eigen::VectorXd& xinit);
  bool is_sound() const { return sound_; }
  /// Sets rows and columns of free components in `inverse` (nx x nx) to Hff^-1, and the others to 0. Call it after a
  /// solve.
  void free_inverse(Eigen::MatrixXd& inverse);
  const BoxQPSolution& get_solution() const { return solution_; }

  std::size_t get_nx() const { return nx_; }                   // number of unknowns
  std::size_t get_maxiter() const { return maxiter_; }         // largest number of Newton steps
  std::size_t get_iter() const { return iter_; }               // Newton steps of the last solve
  double get_th_acceptstep() const { return th_acceptstep_; }  // share of the expected reduction that accepts a step
  double get_th_grad() const { return th_grad_; }              // threshold of the gradient for convergence
  double get_reg() const { return reg_; }                      // added to the diagonal of H
  const std::vector<double>& get_alphas() const { return alphas_; }  // step lengths that are tried
  void set_nx(std::size_t nx);                                       // number of unknowns
  void set_maxiter(std::size_t maxiter) { maxiter_ = maxiter; }      // largest number of Newton steps

  /// Throw std::invalid_argument unless th_acceptstep is in (0, 0.5), and th_grad and reg are at least 0.
  void set_th_acceptstep(double th_acceptstep);
  void set_th_grad(double x) { internal::kNotNegative.set(th_grad_, x, "BoxQP::set_th_grad"); }
  void set_reg(double x) { internal::kNotNegative.set(reg_, x, "BoxQP::set_reg"); }
  void set_alphas(const std::vector<double>& alphas);  // positive and decreasing, or std::invalid_argument is thrown

 private:
  void sort_components(const Eigen::VectorXd& lb, const Eigen::VectorXd& ub);
  [[nodiscard]] bool newton_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, double& gradient);
  [[nodiscard]] bool search(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                            const Eigen::VectorXd& ub);
  std::size_t nx_, maxiter_, iter_ = 0;
  double th_acceptstep_, th_grad_, reg_;
  BoxQPSolution solution_;
  std::vector<double> alphas_;
  Eigen::VectorXd x_, xnew_, g_, dx_, Hx_, qf_, dxf_;
  Eigen::MatrixXd L_, inverse_;  // factor of Hff in the top left corner; workspace
  bool sound_ = false;
};

}  // namespace manycontact
