#pragma once

#include <limits>
#include <optional>

#include "bounded_step.hpp"
#include "goal_rows.hpp"
#include "newton_step.hpp"

namespace manycontact::internal {

/// Limits of q (infinite if none). moved_by: one entry per entry of q. It is the velocity coordinate that moves only
/// this entry, or -1 if there is none with a limit.
struct CoordinateLimits {
  explicit CoordinateLimits(const Scene& scene);
  Eigen::VectorXd within(const Eigen::VectorXd& q) const { return q.cwiseMax(lower).cwiseMin(upper); }
  /// Computes the bounds low and high (nv) of a step dq from q.
  void of_step(const Eigen::VectorXd& q, Eigen::VectorXd& low, Eigen::VectorXd& high) const;

  Eigen::VectorXd lower, upper;
  std::vector<int> moved_by;
  int nv;
};

class PlaceSearch {
 public:
  PlaceSearch(const Scene& scene, const std::vector<Goal>& goals, const PlaceOptions& options)
      : scene_(scene), options_(options), limits_(scene), rows_(scene, goals) {}

  /// Moves q to a local minimum of |e|. Returns |e| at the minimum, or 0 if every goal is met.
  double run(Eigen::VectorXd& q);
  bool met(double left) const { return left == 0; }
  /// Returns the number of steps tried in all runs.
  int tries() const { return tries_; }
  /// Returns whether the last run ended because it reached the largest number of steps.
  bool out_of_steps() const { return out_of_steps_; }
  bool moves(int robot) const;  // Returns whether a goal depends on the robot's coordinates. Requires a run.
  std::vector<GoalLeft> left(const Eigen::VectorXd& q);

 private:
  void descend(Eigen::VectorXd& q, int most_tries);
  int gauss_newton(Eigen::VectorXd& q, int most_tries);
  int newton(Eigen::VectorXd& q, int most_tries);
  Eigen::VectorXd aside(const Eigen::VectorXd& q);
  void look_at(const Eigen::VectorXd& q);
  bool exact(const Eigen::VectorXd& q, const Eigen::VectorXd& e) const;
  Eigen::VectorXd moved(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const;

  const Scene& scene_;
  const PlaceOptions& options_;
  CoordinateLimits limits_;
  GoalRows rows_;
  int tries_ = 0;
  bool out_of_steps_ = false;
  double reach_ = std::numeric_limits<double>::infinity();  // largest |entry| of a Gauss-Newton step [m, rad]
  Eigen::SparseMatrix<double> J_;
  Eigen::VectorXd of_, low_, high_;  // q at which J_ was computed; bounds of a step from this q
  std::optional<BoundedStep> bounded_;
  std::optional<NewtonStep> newton_;
};

}  // namespace manycontact::internal
