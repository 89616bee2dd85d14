#pragma once
// Solves coupled blocks by a Schur complement, without one dense value function. A cluster is a set of blocks that are
// in one group (problem.hpp) in some knot, directly or through other blocks. Each cluster has a Riccati recursion of
// its own, in which the couplings' variables y = (w, mu) count as given. A symmetric system S y + s = 0 in all y
// remains, sparse over the graph of couplings, dense in time. It is factorized by blocks (block_cholesky.hpp). Block
// S_jl is the sum over clusters of the effect of y_l (y of knot l) on the equations of the couplings in knot j.
// Notation: K, P, Qvv = L L^T of a cluster (riccati.hpp), the closed loop F = A + B K, and the coefficients Gx, Gu, E
// of y in q, r, f of knot l:
//
//   Gx = [S_w  C^T]      Gu = [R_uw  D_u^T]      E = [B_w  0]      g = Gu + B^T P+ E
//   pi_l    = Gx + K^T Gu + F^T P+ E                       gradient of the value function w.r.t. y_l
//   W_(l+1) = F_l W_l F_l^T + B Qvv^-1 B^T,  W_0 = 0       so that y_l moves x_l by - W_l pi_l y_l
//   theta_l = E - B Qvv^-1 g - F W_l pi_l
//   S_ll    = [R_ww  D_w^T; D_w  0] + E^T P+ E - g^T Qvv^-1 g - pi_l^T W_l pi_l
//   S_jl    = theta_j^T F_(j+1)^T ... F_(l-1)^T pi_l       j < l
//
// One backward sweep computes S_jl for all columns of a vertex of S. For a cluster of n states with m numbers y per
// knot, the sweeps take n^2 (m T) T operations, and the Riccati recursion takes T n^3. The factorization of S for
// chains and trees of robots takes (m T)^3 per coupling. For each coupling mu is eliminated before w. S is
// quasi-definite if the costs are convex, and strictly convex in u. If S is only semidefinite, a proximal term is
// added, and iterative refinement removes the error of this term. Redundant couplings then have a solution with one of
// many possible mu and w. Inconsistent couplings leave a large KKT error (kInaccurate).

#include "manycontact/lq/coupling_graph.hpp"
#include "manycontact/lq/riccati.hpp"

namespace manycontact::lq {

class CouplingSchur : public DirectionSolver {
 public:
  const char* name() const override { return "Schur complement of couplings"; }
  double flops() const override { return flops_; }

  const Riccati& clusters() const { return riccati_; }  // policies: feedback about the solution at constant w, mu

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

  bool by_steps_ = false;
  std::vector<std::vector<double>> F_, pi_, theta_;  // one entry per knot of the current cluster
  std::vector<double> W_, FW_, Gx_, Gu_, E_, PE_, Y_, S_, U_, V_, Z_, Z_next_;

  Point terms_;
  Eigen::VectorXd y_;
};

}  // namespace manycontact::lq
