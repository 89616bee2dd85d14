#pragma once
// Block L D L^T of a body-space system (system.hpp), leaves first, without forming it: the articulated-body algorithm
// with contact rows. After elimination of a node's subtree, its body's solution makes this function stationary:
//
//   1/2 a^T P a + a^T p + y^T (G a - g) - 1/2 y^T E y,      a: its acceleration, y: forces of rows not yet eliminated
//
// Rows not yet eliminated are called open. Elimination of the joint with motion subspace S, U = P S, D = S^T U +
// armature, W = G S changes
//
//   P -= U D^-1 U^T,   G -= W D^-1 U^T,   E += W D^-1 W^T
//
// A row k is eliminated when its bodies are in the subtree and joints gave it a pivot E_kk (tolerance::kRowMoves):
//
//   P += G_k^T G_k / E_kk,   G_j -= (E_jk / E_kk) G_k,   E_ij -= E_ik E_kj / E_kk
//
// A translation X transforms P, p, G to the parent. At most tolerance::kMostOpen of a subtree's independent rows remain
// open, so the cost is linear in the bodies. Rows between distant bodies are open up to a common ancestor; rows open at
// the bases form a dense system. Sources: Featherstone (2008), table 7.1; for rows Popov, Vereshchagin, Zenkevich
// (1978), Sathya, Carpentier, arXiv 2404.12514. The choice of rows, and rows between two bodies, are ours.

#include "manycontact/kkt/bodies/system.hpp"
#include "manycontact/kkt/reason.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// The projection of a body that rows G = Q R constrain relative to the world, G^T a = g. The rows determine the body's
/// acceleration a along Q, so that the children's inertia C along Q has no effect. With a_g = Q R^-T g, N = 1 - Q Q^T
/// and a = N a + a_g, the children's C, p and open rows G_j, g_j become
///
///   C <- N C N,  p <- N (p + C a_g),  G_j <- N G_j,  g_j <- g_j - G_j^T a_g
///
/// This changes only the forces y of the rows G, which the body's own equation gives from the children's forces.
/// Without the projection, the inertias of all bodies below would add up along Q and cancel in every digit.
struct BodyHold {
  int rows = 0;  // 0: the projection is not used, as the rows are dependent or damped
  Mat6<double> Q, R, C;
};

/// Factorizes `count` rows on a node as Q R. Returns false, with hold.rows = 0, for (nearly) dependent or damped rows.
bool factorize_hold(const BodySystem& system, int node, const int* row, int count, BodyHold& hold);
/// Return the solution y of R^T y = b, and that of R y = Q^T f, in entries 0 ... hold.rows - 1. hold has Q and R.
Vec6<double> solve_transposed(const BodyHold& hold, Vec6<double> b);
Vec6<double> forces_of(const BodyHold& hold, const Vec6<double>& f);

struct BodyLdl {  // Block L D L^T from the leaves to the root.
  // set by factorize_bodies
  std::vector<Mat6<double>> P;  // one entry per node: articulated inertia before its joint is eliminated
  Mat6X<double> U;              // 6 x nv: P S of each joint
  std::vector<double> Dinv;     // D^-1 of each joint, ndof x ndof numbers per node
  std::vector<int> count,
      eliminated;  // one entry per node: number of rows open before its joint; number of them eliminated there
  std::vector<std::size_t> row_first, joint_first, square_first;  // offsets of each node's entries in row, W, E
  std::vector<int> row;
  std::vector<Vec6<double>> G, H;  // one entry per row open at a node: G before its joint is eliminated; H: G after it
  std::vector<double> W, E;        // W = G S; E: L's columns below the diagonal, on it E_kk^-1 of eliminated rows
  std::vector<int> base_row;       // rows still open at the bases, in elimination order
  std::vector<double> base_E;      // E in the rows and columns base_row
  std::vector<double> pivot_sum;   // one entry per row: sum of the terms of E_kk that joints contributed
  std::vector<BodyHold> hold;      // one entry per constrained body of the pattern
  double growth = 1;               // largest factor by which P grew when rows were eliminated
  std::vector<double> least_kept;  // one entry per node: least pivot / its terms, of rows eliminated in its subtree
  std::vector<char> drops_below;   // one flag per node: whether rows in its subtree were dropped
  std::vector<double> least_inertia, most_inertia;  // one entry per row: least and largest D of joints that moved it

  // rows that depend on others (dependent_rows.hpp): they are not in the factor, and their y is zero
  std::vector<char> dropped;  // one flag per row: it was dropped
  struct Drop {
    int row, node;  // node: the node whose rows span the row, or the number of nodes if the row drives no joint
  };
  std::vector<Drop> found;

  // set by backward_sweep
  std::vector<Vec6<double>> p;  // one entry per node: bias force
  Eigen::VectorXd u, g;         // u: D^-1 times the joints' right-hand sides; g: the rows' right-hand sides

  // scratch
  std::vector<int> place;  // one entry per row: its index among the current node's open rows

  void resize(const BodyPattern& pattern);
};

struct HeldRows {  // the rows that constrain a node and are not dropped
  int row[6], count = 0;
};
HeldRows held_rows(const BodyPattern& pattern, const BodyLdl& ldl, int node);

/// Factorizes the system. Returns kNone if the factor is sound, kSingularInertia if a D is only rounding error,
/// kSmallPivot for (nearly) dependent rows, kNotFinite for NaN or infinity. b: also do its backward_sweep. drop: drop
/// rows spanned by those that constrain a body, and list them in ldl.found.
[[nodiscard]] Reason factorize_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors* b = nullptr,
                                      bool drop = false);

void backward_step(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, int i);
void backward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b);

/// Computes x from the bases to the leaves, after a backward sweep of b. Returns its backward error; `left`: residual.
double forward_sweep(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x, BodyResidual& left);
/// Adds to x its correction dx, after a backward sweep of left.r. Returns x's backward error; `left`: its residual.
double correct_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& dx, BodyVectors& x,
                      BodyResidual& left);

void solve_bodies(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, BodyVectors& x);  // no refinement

}  // namespace manycontact
