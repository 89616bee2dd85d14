#pragma once
// The linear-quadratic problem of a horizon of knots k = 0 ... T. A block is a robot's share of state and control. In
// each knot the blocks are partitioned into groups, which only couplings connect.
//
//   minimise   sum_k sum_g  1/2 [x]^T [ Q    S ] [x]  + [q]^T [x]
//                               [v]   [ S^T  R ] [v]    [r]   [v]
//   subject to x_0 = x0
//              x_g(k+1) = A x_g + B v_g + f                    each group g of knot k < T
//              sum_g (rows of b in  C x_g + D v_g + d)  = 0    each coupling b, over the groups g that b connects
//
// x_g contains the states of the blocks of group g, in sequence. v_g = [u_g; w_g] contains the controls of the blocks,
// then the variables w_b of the couplings b of group g: force and common acceleration of a contact. w_b occurs in each
// group that coupling b connects; the equations of b are sums over these groups. A coupling of one group without
// variables is an equality constraint. The terminal knot has no controls and no dynamics.
//
// With multipliers lambda_k of the equation of x_k, and mu_b of the equations of b, the optimum satisfies (kkt.hpp)
//
//   Q x + S v + q + A^T lambda+ + C^T mu - lambda  = 0      so that lambda_k is the gradient of the value function
//   S^T x + R v + r + B^T lambda+ + D^T mu         = 0      rows of w_b: summed over the groups that b connects
//
// where + means knot k + 1. A knot has the matrices of aligator's module gar (Q S R q r A B f C D d), but by groups.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "manycontact/abi.hpp"
#include "manycontact/lq/block_diagonal.hpp"

namespace manycontact::lq {

/// The structure of a symplectic Euler step. The state of a block is [y; z] with halves of equal size, and the step
/// moves y according to the new z: A = [J 0; 0 0] + [G; 1] A_z, B = [G; 1] B_z, where A_z, B_z are the lower halves of
/// A and B. With this structure, Riccati and CouplingSchur take half the operations for products with A.
struct SymplecticStructure {
  BlockDiagonal J, G;
};

/// One group of a knot. Its blocks have nx states and nu controls, its couplings have nw variables and nc equations,
/// and nv = nu + nw. Q and R must be symmetric, because entries of both triangles are read.
struct Group {
  std::vector<int> blocks;
  std::vector<int> couplings;  // indices in the knot, in the order of v_g and of the rows of C

  Eigen::MatrixXd Q, S, R;                   // nx x nx, nx x nv, nv x nv
  Eigen::VectorXd q, r;                      // nx, nv
  Eigen::MatrixXd A, B;                      // nx x nx, nx x nv; unused in the terminal knot
  Eigen::VectorXd f;                         // nx: the gap, in a step of Newton's method
  std::optional<SymplecticStructure> steps;  // structure of A and B, if known; A and B are complete in any case
  Eigen::MatrixXd C, D;                      // nc x nx, nc x nv
  Eigen::VectorXd d;                         // nc
};

struct Coupling {
  int size = 0;  // size of w_b
  int rows = 0;  // number of equations of the coupling
};

struct Knot {
  std::vector<Group> groups;        // each block is in exactly one group
  std::vector<Coupling> couplings;  // each coupling connects at least one group
};

struct Problem {            // all knots of a horizon
  std::vector<int> nx, nu;  // numbers of states and controls of each block
  std::vector<Knot> knots;  // T + 1 knots; the last is the terminal knot
  Eigen::VectorXd x0;       // initial states of all blocks

  int horizon() const { return static_cast<int>(knots.size()) - 1; }
  int blocks() const { return static_cast<int>(nx.size()); }
};

/// Sets every matrix and vector to zero, with the size that follows from nx, nu, the groups and the couplings.
void set_zero(Problem& problem);

/// Throws std::invalid_argument, whose message names knot and group, if sizes, partition or couplings do not fit.
void check(const Problem& problem);

struct Layout {  // Offsets of blocks and couplings in the vectors of a Point. Each list ends with the total size.
  std::vector<int> x, u;                  // offsets of each block
  std::vector<std::vector<int>> w, rows;  // offsets by knot, then by coupling

  explicit Layout(const Problem& problem);
  Layout() = default;
};

/// A point of the problem, or gradients at a point: for each knot one vector per kind of variables and multipliers.
struct Point {
  std::vector<Eigen::VectorXd> x;       // T + 1 vectors: the states of all blocks
  std::vector<Eigen::VectorXd> u;       // T + 1 vectors: the controls of all blocks; empty in the terminal knot
  std::vector<Eigen::VectorXd> w;       // T + 1 vectors: the variables of all couplings
  std::vector<Eigen::VectorXd> lambda;  // T + 1 vectors: the multipliers of the equation of x_k
  std::vector<Eigen::VectorXd> mu;      // T + 1 vectors: the multipliers of the couplings' equations

  Point(const Problem& problem, const Layout& layout);
  Point() = default;
};

/// Terms that are added to diagonals, which give Q + x I, R + u I for controls (not for w), and C x + D v + d - rows mu
/// = 0. `x` and `u` are preg and dreg of Crocoddyl. `rows` is a proximal term of the couplings' equations.
struct Regularisation {
  double x = 0, u = 0, rows = 0;
};

}  // namespace manycontact::lq
