#pragma once
// Seeded random linear-quadratic problems are convex unless requested otherwise.

#include <functional>
#include <optional>
#include <random>

#include "manycontact/lq/problem.hpp"

namespace manycontact::test {

struct LqOptions {
  std::vector<int> nx = {4, 3, 5, 2}, nu = {2, 2, 3, 1};  // of each block
  int horizon = 12;
  /// Blocks that are one group in knot k, as lists; blocks in no list are groups of their own.
  std::function<std::vector<std::vector<int>>(int k)> groups = [](int) { return std::vector<std::vector<int>>{}; };
  /// Couplings of knot k: the blocks that each touches.
  std::function<std::vector<std::vector<int>>(int k)> couplings = [](int) { return std::vector<std::vector<int>>{}; };
  int coupling_size = 2;  // of w
  int coupling_rows = 2;
  double growth = 0.95;        // of the free motion: |A| about this; above 1 it is unstable
  double state_weight = 1;     // Q's size; 0: no cost on states
  double control_weight = 1;   // R's; 0: none
  double coupling_weight = 0;  // of w in the cost
  /// Size of J's and G's part in blocks of as many coordinates or more; of groups of one block, those of even size.
  std::optional<int> steps;
};

lq::Problem random_lq(std::mt19937& rng, const LqOptions& options = {});

/// Sets new numbers in the same structure.
void refill(lq::Problem& problem, std::mt19937& rng, const LqOptions& options);

/// Returns H of the optimality conditions H z + h = 0, from columns of kkt_residual; h in `h`. Order: as in `flat`.
Eigen::MatrixXd dense_kkt(const lq::Problem& problem, const lq::Regularisation& reg, Eigen::VectorXd& h);
/// Returns all of a point in one vector.
Eigen::VectorXd flat(const lq::Point& z);
void unflatten(const Eigen::VectorXd& all, lq::Point& z);

/// Returns robots hand in hand, each with its neighbour, in every running knot: sizes of humanoids by default.
lq::Problem chain_of_robots(int robots, int horizon, std::mt19937& rng, int nx = 76, int nu = 32, int m = 6);

}  // namespace manycontact::test
