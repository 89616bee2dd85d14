#pragma once
// Springs and dampers between points in a semi-implicit Euler step of any length.
//
// A spring has stiffness k, damping c and stretch e. J v is the relative velocity of its ends along a direction, and s
// is the share of the start velocity v that the spring does not resist (spring_share.hpp). With D = h^2 k + h c the
// impulse is p = -D (J v+ + g), where D g = h k e - s h^2 k J v. It is h times the force
// -k (e + h J (v+ - s v)) - c J v+. A spring with tension T and length l at the end of the step is also stiff across
// its direction: D = h^2 T / l, D g = -s D J v', with v' the velocity at the start without its stretching part. If the
// spring rotates with its bodies, its force does not brake them: with r the rotating share of the ends' motion,
// g = -(s + r - s r) J v'. The step without springs has the KKT matrix K, the right-hand side b and the solution x0 =
// K^-1 b. With springs,
//
//     (D^-1 + J K^-1 J^T) p = -(J x0 + g),        and then K v+ = b + J^T p.
//
// K^-1 J^T takes one unit-force solve per spring end on an island; one solve treats one end on every island. Springs
// do not couple islands, so the cost of many bodies on springs is proportional to their number. For an island with many
// springs, K^-1 is computed as a matrix instead, by a panel of right-hand sides.

#include <Eigen/SparseCholesky>

#include "manycontact/simulation/step.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "momentum_steps.hpp"
#include "unit_forces.hpp"

namespace manycontact::internal {

struct ResistingSprings {
  explicit ResistingSprings(const Scene& scene);

  Scene loads;                                      // the scene with all loads except springs between points
  std::shared_ptr<AppliedForces<double>> of_loads;  // applied forces of `loads`, or null if `loads` has none
  std::vector<double> mobility;                     // upper bound per spring: J M^-1 J^T of its bodies alone [1/kg]

  struct Row {
    int spring;
    Vec3<double> direction;  // unit vector in the world
    double D, g, k, e;       // k, e: stiffness and stretch along `direction`
    double turns;            // row across a spring: its rotating share r from 0 to 1; row along a spring: -1
    double length;           // row across a spring with a rest length: current length of the spring; other rows: 0
    double keeps = 0;        // share s of the start velocity v that the spring does not resist
  };
  std::vector<Row> rows;
  UnitTorques unit;
  std::vector<UnitForce> ends;  // unit forces on the ends of rows
  std::vector<int> row;         // row of each entry of `ends`
  int numbers = 0;              // count of numbers in `ends`; forces with the same number are on different islands
  std::vector<int> asked;       // one entry per island: index in `ends` of the unit force in the current solve, or -1
  std::vector<double> gains;    // saves alpha of each contact while the solves for unit forces use zero
  Eigen::VectorXd by_unit;      // nv: response to unit forces, computed with the matrix K^-1

  Eigen::VectorXd p, rate;     // one entry per row: impulse p; rate J v'
  Eigen::VectorXd given;       // one entry per row: energy that the impulse, without damping, gives to the bodies [J]
  Eigen::VectorXd stretching;  // one entry per row: impulse that removes the stretching part of the start velocity
  Eigen::VectorXd own;         // one entry per row: its diagonal entry of J K^-1 J^T
  bool is_dense = true;        // whether J K^-1 J^T is stored dense: it has few rows, or enough nonzero entries
  Eigen::MatrixXd C, with_D;   // C: J K^-1 J^T; with_D: its part for the rows `used`, with D^-1 added
  std::vector<int> used;       // rows that are part of the last factorization
  Eigen::VectorXd of_used;
  Eigen::LLT<Eigen::MatrixXd> factor;                        // used for many rows
  Eigen::LDLT<Eigen::MatrixXd> pivoted_factor;               // used for few rows, and if `factor` fails
  std::vector<Eigen::Triplet<double>> entries, own_entries;  // entries of all rows; of the rows in the factorization
  Eigen::SparseMatrix<double> S;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_factor;
  Eigen::VectorXd b, none;
  Eigen::VectorXd without, f_without;  // the solution without springs: v+ (nv), and the impulses of contacts

  // Sets of free groups (momentum.hpp) that springs couple, and the angular momentum to be restored to each set.
  std::vector<int> cluster, members;
  std::vector<Vec3<double>> couple;
};

constexpr double kIdle = 1e-300;      // value of D for a row that is left out
constexpr std::size_t kFewRows = 64;  // most rows for one dense factor of all rows

inline bool is_across(const ResistingSprings::Row& row) { return row.turns >= 0; }
/// Factorizes D^-1 + J K^-1 J^T for the rows along springs, or for all rows. Returns false if the factorization fails.
[[nodiscard]] bool factorize_rows(bool all, ResistingSprings& s);
/// Replaces x by (D^-1 + J K^-1 J^T)^-1 x, for the rows of the last factorize_rows.
void solve_rows(ResistingSprings& s, Eigen::VectorXd& x);

/// Adds external wrenches and joint springs at the start of the step to data.w. Evaluates data.applied at this state.
void add_loads(const Scene& scene, SimulationData& data);
/// Finds the rows of all springs. Requires add_loads. Sets data.w to NaN for a spring of length zero (no direction).
void take_springs(const Scene& scene, SimulationData& data);
/// Solves K v+ = b with the springs' impulses in the data of at_rest_with_joints. Returns false if a solve failed. With
/// data.in_batches, the solve adds M v and the bias to b. If SIMD batches fail, b and data.tau contain these terms.
[[nodiscard]] bool solve_with_springs(Eigen::VectorXd& b, SimulationData& data);
/// Adds the springs' impulses of the last solve to the momentum of free groups at the end of the step.
void add_impulses_of_springs(const Scene& scene, SimulationData& data);
/// Computes data.work of springs and dampers between points.
void account_for_springs(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);

}  // namespace manycontact::internal
