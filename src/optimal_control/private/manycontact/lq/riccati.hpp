#pragma once
// The Riccati recursion, on one dense block or by clusters of blocks ("islands through time").
//
// The value function of knot k, V(x) = 1/2 x^T P x + p^T x + const, is block diagonal over the clusters, which are sets
// of blocks that groups or couplings join in knot k or later. For k = T ... 0, with P+, p+ of knot k + 1:
//
//   Qxx = Q + A^T P+ A     Qxv = S + A^T P+ B     Qvv = R + B^T P+ B     t = p+ + P+ f
//   qx = q + A^T t         qv = r + B^T t
//   [ Qvv    D^T    ] [ K  k  ]     [ Qxv^T  qv ]
//   [ D   -reg.rows ] [ K' k' ] = - [ C      d  ]        v = K x + k,  mu = K' x + k'
//   P = Qxx + Qxv K + C^T K'       p = qx + K^T qv + K'^T d
//
// Qvv is factorized by Cholesky, and the matrix with D by LU if a cluster has couplings. N separate blocks of n states
// take N T n^3 operations. Equations on x alone in the terminal knot are not solved (kSingular without reg.rows).

#include <Eigen/LU>

#include "manycontact/lq/direction_solver.hpp"
#include "manycontact/lq/plan.hpp"
#include "manycontact/lq/riccati_step.hpp"

namespace manycontact::lq {

class Riccati : public DirectionSolver {  // The Riccati recursion, dense or by clusters.
 public:
  struct Policy {       // The policy of a cluster in a knot. factorize computes K and P; solve computes k and p.
    Eigen::MatrixXd K;  // (nv + rows) x nx: [v; mu] = K x + k, whose first nu rows are u
    Eigen::VectorXd k;
    Eigen::MatrixXd P;  // nx x nx
    Eigen::VectorXd p;  // gradient of the value function at x = 0
    Eigen::MatrixXd L;  // L of Qvv = L L^T, lower triangle; with couplings the matrix that lu factorizes
    Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  };

  /// join: kAll for a dense recursion, kIslands for one by clusters, kNoCouplings for one with zero w, mu of couplings.
  explicit Riccati(Join join) : join_(join) {}

  const char* name() const override;
  double flops() const override { return flops_; }

  const Plan& plan() const { return plan_; }
  const Policy& policy(int knot, int cluster) const { return policies_[knot][cluster]; }

  /// Returns P of the next knot, with states in the order of this knot's cluster (a copy if the orders differ).
  Eigen::Ref<const Eigen::MatrixXd> next_value(const Problem& problem, int knot, int cluster);
  /// Returns Group::steps of a cluster with a single group, or null for other clusters, or if steps is not set.
  const SymplecticStructure* steps(const Problem& problem, int knot, int cluster) const;

 protected:
  void do_analyse(const Problem& problem) override;
  Outcome do_factorize(const Problem& problem, const Regularisation& reg) override;
  void do_solve(const Problem& problem, const Point& h, Point& z, bool first) override;

 private:
  friend class CouplingSchur;
  void expand(const Problem& problem, int k, int c, const Regularisation& reg);
  void expand_next_value(const Problem& problem, int k, int c);
  Status eliminate(const Problem& problem, int k, int c, const Regularisation& reg);
  Status eliminate_with_rows(const Problem& problem, int k, int c, const Regularisation& reg);
  /// Computes x, u, lambda of H z + h = 0, and w, mu of the clusters' couplings. Does not change the policies.
  void pass(const Problem& problem, const Point& h, Point& z);
  void backward(const Problem& problem, const Point& h, int k);
  void forward(const Problem& problem, const Point& h, int k, Point& z);

  Join join_;
  Plan plan_;
  double flops_ = 0;
  std::vector<std::vector<Policy>> policies_;
  std::vector<std::vector<Eigen::VectorXd>> k_, p_;  // k and p of the current solve or correction, by knot and cluster
  std::vector<int> x_of_block_;
  RiccatiStep step_;                      // workspace of the current cluster
  std::vector<double> next_, with_rows_;  // workspace
  Eigen::VectorXd t_, x_, v_, f_;
};

}  // namespace manycontact::lq
