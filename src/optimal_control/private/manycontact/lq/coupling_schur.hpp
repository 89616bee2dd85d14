#pragma once
// Coupled blocks without one dense value function. Each cluster of blocks (those that groups couple in any knot) has a
// Riccati recursion of its own, as if the couplings' y = (w, mu) were given. A symmetric system in all y remains,
//
//   S y + s = 0,    sparse over the graph of couplings, dense in time,
//
// factorized by blocks (block_cholesky.hpp). A block of S is the response of cluster c to y of knot l in the equations
// of knot j. With the cluster's K, P, Qvv = L L^T, the closed loop F = A + B K, and in knot l the terms of y in q, r, f
//
//   Gx = [S_w  C^T]      Gu = [R_uw  D_u^T]      E = [B_w  0]      g = Gu + B^T P+ E
//   pi_l    = Gx + K^T Gu + F^T P+ E                       gradient of the value function by y_l
//   W_(l+1) = F_l W_l F_l^T + B Qvv^-1 B^T,  W_0 = 0       so that y_l moves x_l by - W_l pi_l y_l
//   theta_l = E - B Qvv^-1 g - F W_l pi_l
//   S_ll    = [R_ww  D_w^T; D_w  0] + E^T P+ E - g^T Qvv^-1 g - pi_l^T W_l pi_l
//   S_jl    = theta_j^T F_(j+1)^T ... F_(l-1)^T pi_l       j < l
//
// the last by one sweep backward over all columns of a vertex at once. This takes n^2 (m T) T operations per cluster,
// where n is the number of its states and m that of its y in a knot, in addition to the T n^3 of its Riccati recursion.
// Chains and trees of robots then cost (m T)^3 for each coupling. mu is eliminated before w, coupling by coupling. S is
// quasi-definite if the costs are convex and strictly convex in u. If a part of it is only semidefinite, a proximal
// term is added, which refinement removes. Couplings that are dependent and consistent then have a solution, one of
// many mu and w. If they are inconsistent, the KKT error shows it (kInaccurate).

#include "manycontact/lq/coupling_graph.hpp"
#include "manycontact/lq/riccati.hpp"

namespace manycontact::lq {

class CouplingSchur : public DirectionSolver {
 public:
  const char* name() const override { return "Schur complement of couplings"; }
  double flops() const override { return flops_; }

  /// The clusters' own recursions: their policies are feedback about the solution, at constant w and mu.
  const Riccati& clusters() const { return riccati_; }

 protected:
  void do_analyse(const Problem& problem) override;
  Outcome do_factorize(const Problem& problem, const Regularisation& reg) override;
  void do_solve(const Problem& problem, const Point& h, Point& z, bool first) override;

 private:
  void make_schur(const Problem& problem, const Regularisation& reg);
  void respond(const Problem& problem, int cluster);
  void respond_at(const Problem& problem, int cluster, int knot);
  const SymplecticStructure* steps(const Problem& problem, int cluster, int knot) const;
  void add_terms_of_y(const Problem& problem, int knot, const CouplingNode& node);
  void sweep(const Problem& problem, int cluster, int vertex);

  Riccati riccati_{Join::kNoCouplings};
  CouplingGraph graph_;
  BlockCholesky schur_;
  double flops_ = 0;

  // The terms of the current cluster, by knot.
  bool by_steps_ = false;
  std::vector<std::vector<double>> F_, pi_, theta_;
  std::vector<double> W_, FW_, Gx_, Gu_, E_, PE_, Y_, S_, U_, V_, Z_, Z_next_;

  Point terms_;
  Eigen::VectorXd y_;
};

}  // namespace manycontact::lq
