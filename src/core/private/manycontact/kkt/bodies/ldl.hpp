#pragma once
// Block L D L^T of a body-space system, from the leaves to the root, without forming it: the articulated-body
// algorithm with contact rows. A node's subtree leaves for its body
//
//   1/2 a^T P a + a^T p + y^T (G a - g) - 1/2 y^T E y,      y: the rows still open
//
// (stationary in a and y). Eliminating the joint, with U = P S, D = S^T U + armature, W = G S:
//
//   P -= U D^-1 U^T,   G -= W D^-1 U^T,   E += W D^-1 W^T
//
// and a row k, once all bodies it acts on are below and joints there have given it a pivot E_kk (tolerance::kRowMoves):
//
//   P += G_k^T G_k / E_kk,   G_j -= (E_jk / E_kk) G_k,   E_ij -= E_ik E_kj / E_kk
//
// The remainder goes to the parent by X. Rows that do not depend on each other leave at most tolerance::kMostOpen of
// their own open, so the cost is linear in the bodies; rows that join far bodies are open all the way between them.
// Rows open at the bases are a dense system. Sources: Featherstone (2008), table 7.1; for rows in such a recursion
// Popov, Vereshchagin, Zenkevich (1978), Sathya, Carpentier, arXiv 2404.12514. The choice of rows by pivots, and rows
// of two ends, are ours.

#include "manycontact/kkt/bodies/system.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Rows G = Q R that constrain a body, G^T a = g. They determine the body's acceleration along Q, so nothing that comes
/// from the children counts there, whatever its size:
///
///   a = N a + a_g,  a_g = Q R^-T g,  N = 1 - Q Q^T:
///   C <- N C N,  p <- N (p + C a_g),  G_j <- N G_j,  g_j <- g_j - G_j^T a_g      C, p, G_j: from the children
///
/// Along Q anything may be added to C. It changes y of these rows alone, which the body's own equation gives back once
/// the children's forces are known. Without it, stiffness of all that hangs below piles up along the chain, and cancels
/// in every digit.
struct BodyHold {
  int rows = 0;  // 0: not done, the rows depend on each other or are damped
  Mat6<double> Q, R, C;
};

/// Factorizes `count` rows of a node; false, and rows = 0, where they depend on each other, or nearly.
bool factorize_hold(const BodySystem& system, int node, const int* row, int count, BodyHold& hold);
/// y of R^T y = b and of R y = Q^T f, entries 0 ... rows - 1.
Vec6<double> solve_transposed(const BodyHold& hold, Vec6<double> b);
Vec6<double> forces_of(const BodyHold& hold, const Vec6<double>& f);

struct BodyLdl {  // block LDL from leaves to root
  // set by factorize_bodies
  std::vector<Mat6<double>> P;  // one entry per node, before its joint is eliminated
  Mat6X<double> U;              // 6 x nv
  std::vector<double> Dinv;     // one ndof x ndof matrix per node
  std::vector<int> count,
      eliminated;  // one entry per node: rows open before it, of which so many are eliminated there, these first
  std::vector<std::size_t> row_first, joint_first, square_first;  // one per node: where its numbers begin below
  std::vector<int> row;                                           // number of each open row
  std::vector<Vec6<double>> G, H;  // the same: G before the joint; when it is eliminated, or when it leaves the node
  std::vector<double> W, E;        // G S; E: below the diagonal L's columns, on it E_kk^-1, of rows eliminated
  std::vector<int> base_row;       // rows left at the bases, in the order in which they are eliminated
  std::vector<double> base_E;      // numbers of the rows left at the bases, as E
  std::vector<double> pivot_sum;   // one entry per row: sum of what joints gave E_kk
  std::vector<BodyHold> hold;      // one entry per constrained body of the pattern
  double growth = 1;               // growth of P
  std::vector<double> least_kept;  // one entry per node: least part left of the rows eliminated there and below
  std::vector<char> drops_below;   // one flag per node: rows there or below were dropped
  std::vector<double> least_inertia, most_inertia;  // one per row: of its joints, with rows eliminated before

  // rows that others span (dependent_rows.hpp): they have no part in the factor, and their y is zero
  std::vector<char> dropped;  // one flag per row
  struct Drop {
    int row, node;  // the row; the node whose rows span it, or the number of nodes: the row moves nothing
  };
  std::vector<Drop> found;

  // set by solve_bodies
  std::vector<Vec6<double>> p;  // one entry per node
  Eigen::VectorXd u, g;         // D^-1 u; rows' right-hand sides

  // scratch
  std::vector<int> place;  // one entry per row: its place at the current node

  void resize(const BodyPattern& pattern);
};

/// The rows that constrain a node and are not dropped, six at most.
struct HeldRows {
  int row[6], count = 0;
};
HeldRows held_rows(const BodyPattern& pattern, const BodyLdl& ldl, int node);

/// kNone: sound. kSingularInertia: a joint has nothing to move, or only rounding errors. kSmallPivot: rows depend on
/// each other, or nearly. kNotFinite. With b, right-hand sides are lifted in the same sweep. drop: rows that those
/// which constrain a body span are dropped as they are met, into ldl.found.
[[nodiscard]] Reason factorize_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors* b = nullptr,
                                      bool drop = false);

/// The first half of solving, from the leaves to b's remainder at the bases; its one step, of node i for its parent.
void backward_step(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, int i);
void backward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b);

/// The second, from the bases: x of the b lifted; returns its backward error.
double forward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x, BodyResidual& left);
/// Solves for a correction dx, for which b = left.r was lifted: x += dx. Returns the backward error of x for b.
double correct_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& dx, BodyVectors& x,
                      BodyResidual& left);

/// x of the right-hand sides b.
void solve_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x);

}  // namespace manycontact
