#pragma once
// Block L D L^T of a body-space system from the leaves to the root, without forming it: the articulated-body algorithm
// with contact rows. Eliminating a node's subtree leaves for its body
//
//   1/2 a^T P a + a^T p + y^T (G a - g) - 1/2 y^T E y,      y: the rows still open
//
// (stationary in a and y). Eliminating the joint, with U = P S, D = S^T U + armature, W = G S:
//
//   P -= U D^-1 U^T,   G -= W D^-1 U^T,   E += W D^-1 W^T
//
// and of a row k, once both its bodies are below and joints there gave it a pivot E_kk (tolerance::kRowMoves):
//
//   P += G_k^T G_k / E_kk,   G_j -= (E_jk / E_kk) G_k,   E_ij -= E_ik E_kj / E_kk
//
// X transforms the remainder to the parent. Independent rows leave at most tolerance::kMostOpen rows open, so the cost
// is linear in the bodies; rows between distant bodies are open all the way. Rows open at the bases form a dense
// system. Sources: Featherstone (2008), table 7.1; for contact rows Popov, Vereshchagin, Zenkevich (1978), Sathya,
// Carpentier, arXiv 2404.12514. Choosing rows by pivots, and rows with two ends, are ours.

#include "manycontact/kkt/bodies/system.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Rows G = Q R that constrain a body, G^T a = g. They determine its acceleration along Q, so contributions of the
/// children along Q have no effect, whatever their size:
///
///   a = N a + a_g,  a_g = Q R^-T g,  N = 1 - Q Q^T:
///   C <- N C N,  p <- N (p + C a_g),  G_j <- N G_j,  g_j <- g_j - G_j^T a_g      C, p, G_j: from the children
///
/// Anything may be added to C along Q: it changes only y of these rows, which the body's equation gives from the
/// children's forces. Otherwise stiffness of all bodies below would accumulate, and cancel in every digit.
struct BodyHold {
  int rows = 0;  // 0: not used, as the rows are dependent or damped
  Mat6<double> Q, R, C;
};

/// Factorizes `count` rows of a node; returns false, with rows = 0, if they are (nearly) dependent.
bool factorize_hold(const BodySystem& system, int node, const int* row, int count, BodyHold& hold);
/// Return y of R^T y = b and of R y = Q^T f, in entries 0 ... rows - 1.
Vec6<double> solve_transposed(const BodyHold& hold, Vec6<double> b);
Vec6<double> forces_of(const BodyHold& hold, const Vec6<double>& f);

struct BodyLdl {  // block LDL from leaves to root
  // set by factorize_bodies
  std::vector<Mat6<double>> P;  // one entry per node, before its joint is eliminated
  Mat6X<double> U;              // 6 x nv
  std::vector<double> Dinv;     // one ndof x ndof matrix per node
  std::vector<int> count,
      eliminated;  // one entry per node: rows open before its joint; the first of these, which are eliminated there
  std::vector<std::size_t> row_first, joint_first, square_first;  // offsets of each node's entries below
  std::vector<int> row;
  std::vector<Vec6<double>> G, H;  // one entry per open row: before the joint; when it leaves the node
  std::vector<double> W, E;        // G S; E: L's columns below the diagonal, on it E_kk^-1 of eliminated rows
  std::vector<int> base_row;       // rows left at the bases, in elimination order
  std::vector<double> base_E;      // entries of these rows, as E
  std::vector<double> pivot_sum;   // one entry per row: sum of the joints' terms of E_kk
  std::vector<BodyHold> hold;      // one entry per constrained body of the pattern
  double growth = 1;               // growth of P
  std::vector<double> least_kept;  // one entry per node: least remaining part of rows eliminated there and below
  std::vector<char> drops_below;   // one flag per node: whether rows there or below were dropped
  std::vector<double> least_inertia, most_inertia;  // one per row: inertias of its joints, with earlier rows eliminated

  // rows spanned by others (dependent_rows.hpp): not in the factor, with y zero
  std::vector<char> dropped;  // one flag per row
  struct Drop {
    int row, node;  // node: whose rows span the row, or the number of nodes if the row moves nothing
  };
  std::vector<Drop> found;

  // set by solve_bodies
  std::vector<Vec6<double>> p;  // one entry per node
  Eigen::VectorXd u, g;         // D^-1 u; rows' right-hand sides

  // scratch
  std::vector<int> place;  // one entry per row: its index at the current node

  void resize(const BodyPattern& pattern);
};

/// The rows that constrain a node and are not dropped, at most six.
struct HeldRows {
  int row[6], count = 0;
};
HeldRows held_rows(const BodyPattern& pattern, const BodyLdl& ldl, int node);

/// Factorizes the system. kNone: sound. kSingularInertia: a joint moves no inertia but rounding errors. kSmallPivot:
/// rows are (nearly) dependent. kNotFinite: some entry is not. If b is given, it is lifted in the same sweep. drop:
/// rows spanned by those that constrain a body are dropped, into ldl.found.
[[nodiscard]] Reason factorize_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors* b = nullptr,
                                      bool drop = false);

/// Backward sweep of a solve, from the leaves to b's remainder at the bases, and its step from node i to its parent.
void backward_step(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, int i);
void backward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b);

/// Forward sweep, from the bases: x of the lifted b; returns its backward error.
double forward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x, BodyResidual& left);
/// Solves for the correction dx, for which b = left.r was lifted, and adds it to x. Returns the backward error of x.
double correct_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& dx, BodyVectors& x,
                      BodyResidual& left);

/// Solves for x with right-hand sides b.
void solve_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x);

}  // namespace manycontact
