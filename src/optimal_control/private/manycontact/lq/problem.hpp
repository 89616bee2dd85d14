#pragma once
// The linear-quadratic problem of a horizon, without reference to robots: knots k = 0 ... T and blocks i (a robot's
// share of state and control). In each knot the blocks are partitioned into groups, which only couplings connect.
//
//   minimise   sum_k sum_g  1/2 [x]^T [ Q    S ] [x]  + [q]^T [x]
//                               [v]   [ S^T  R ] [v]    [r]   [v]
//   subject to x_0 = x0
//              x_g(k+1) = A x_g + B v_g + f                    each group g of knot k < T
//              sum over the groups g that coupling b touches of its rows of  C x_g + D v_g + d  = 0     each coupling b
//
// x_g has the states of g's blocks, in sequence. v_g = [u_g; w_g] has the controls of its blocks, then the variables of
// the couplings on it. A coupling connects groups that are no dense block together. Its variables w_b (a contact's
// force and common acceleration) occur in each of these groups, and its equations sum over them. A coupling without
// variables on one group is an equality constraint. The terminal knot has no controls and no dynamics.
//
// With multipliers lambda_k of x_k's equation and mu_b of a coupling's, the optimum satisfies (kkt.hpp)
//
//   Q x + S v + q + A^T lambda+ + C^T mu - lambda  = 0      so that lambda_k is the gradient of the value function
//   S^T x + R v + r + B^T lambda+ + D^T mu         = 0      rows of w summed over the groups that the coupling touches
//
// where + means knot k + 1. The structure is that of aligator's gar (a knot with Q S R q r A B f C D d) by groups.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "manycontact/abi.hpp"
#include "manycontact/lq/block_diagonal.hpp"

namespace manycontact::lq {

/// A group of one block whose state is [y; z], halves of one size, where y moves by the z that is reached (symplectic
/// Euler): A = [J 0; 0 0] + [G; 1] A_z, B = [G; 1] B_z, and A_z, B_z are their lower halves. Riccati and CouplingSchur
/// then take half the operations for products with A.
struct SymplecticStructure {
  BlockDiagonal J, G;
};

/// One group of a knot. Sizes: nx, nu those of its blocks, nw and nc of its couplings, nv = nu + nw. Q and R must be
/// symmetric; entries of both triangles are read.
struct Group {
  std::vector<int> blocks;
  std::vector<int> couplings;  // numbers in the knot, in the order of v_g and of the rows of C

  Eigen::MatrixXd Q, S, R;                   // nx x nx, nx x nv, nv x nv
  Eigen::VectorXd q, r;                      // nx, nv
  Eigen::MatrixXd A, B;                      // nx x nx, nx x nv; unused in the terminal knot
  Eigen::VectorXd f;                         // nx: the gap, if the problem is a step of Newton's method
  std::optional<SymplecticStructure> steps;  // set if it is known; A and B are complete nevertheless
  Eigen::MatrixXd C, D;                      // nc x nx, nc x nv
  Eigen::VectorXd d;                         // nc
};

struct Coupling {
  int size = 0;  // size of w_b
  int rows = 0;  // number of its equations
};

struct Knot {
  std::vector<Group> groups;        // each block is in one of them
  std::vector<Coupling> couplings;  // each touches at least one group
};

struct Problem {            // all knots of a horizon
  std::vector<int> nx, nu;  // sizes of each block
  std::vector<Knot> knots;  // T + 1, the last is the terminal one
  Eigen::VectorXd x0;       // initial states of all blocks

  int horizon() const { return static_cast<int>(knots.size()) - 1; }
  int blocks() const { return static_cast<int>(nx.size()); }
};

/// Sets every matrix and vector to zero, with the sizes that follow from nx, nu, the groups and the couplings.
void set_zero(Problem& problem);

/// Throws std::invalid_argument, with knot and group, if sizes, partition or couplings do not fit.
void check(const Problem& problem);

/// Offsets of blocks and couplings in the vectors of a Point: the first entry of each, and then the total.
struct Layout {
  std::vector<int> x, u;                  // offsets of each block
  std::vector<std::vector<int>> w, rows;  // offsets by knot, then by coupling

  explicit Layout(const Problem& problem);
  Layout() = default;
};

/// A point of the problem, or its gradients: a vector for each knot.
struct Point {
  std::vector<Eigen::VectorXd> x;       // T + 1, by block
  std::vector<Eigen::VectorXd> u;       // T + 1, by block; the terminal knot's is empty
  std::vector<Eigen::VectorXd> w;       // T + 1, by coupling
  std::vector<Eigen::VectorXd> lambda;  // T + 1, of x_k's equation
  std::vector<Eigen::VectorXd> mu;      // T + 1, of the couplings' equations

  Point(const Problem& problem, const Layout& layout);
  Point() = default;
};

/// Added to the diagonals: Q + x I, R + u I for controls (not w), and C x + D v + d - rows mu = 0. x, u: Crocoddyl's
/// preg, dreg; `rows`: the step of a proximal (augmented Lagrangian) method on the couplings' equations.
struct Regularisation {
  double x = 0, u = 0, rows = 0;
};

}  // namespace manycontact::lq
