#pragma once
// Unit forces along springs and on joints, the torques that they are, and what a velocity or an acceleration is along
// them: with the columns of U these torques, tau = U x and U^T a.

#include <span>

#include "manycontact/algorithm/applied_forces.hpp"

namespace manycontact::internal {

struct UnitForce {
  int spring = -1;                                // between points: on A's end, and its opposite on B's ...
  Vec3<double> direction = Vec3<double>::Zero();  // ... along this, in the world; or
  int coordinate = -1;                            // on a joint: of the scene's velocities
  int island = -1, number = 0;                    // by UnitTorques::number: forces of one number are on different ones
};

class UnitTorques {
 public:
  explicit UnitTorques(const Scene& scene);
  /// At q (nq) of the scene, with its robots' bases; nothing added.
  void place(const Scene& scene, const Eigen::VectorXd& q);
  void clear();
  void add(const UnitForce& force, double amount);
  /// U x of what was added (nv), until the next call.
  const Eigen::VectorXd& torques();
  /// Takes a velocity or acceleration (nv); after it, what that is along a force. Clears.
  void look(const Eigen::VectorXd& a);
  double along(const UnitForce& force) const;
  /// Gives islands and numbers. Robots are on one island that contacts flagged `active`, or springs among `forces`,
  /// join. Returns how many numbers there are.
  int number(const Scene& scene, const std::vector<char>& active, std::span<UnitForce> forces);

 private:
  std::vector<int> islands_, count_;
  std::vector<int> push_[2];  // per spring: of A's end and of B's; -1: in the world
  Scene ends_;                // the robots, with a push in world axes at each end that moves
  AppliedForces<double> forces_;
  AppliedScratch scratch_;
  std::vector<int> robots_;
  std::vector<Vec6<double>> w_;
  Eigen::VectorXd q_, rest_, tau_, joints_, a_, by_q_, by_v_, by_w_;
};

}  // namespace manycontact::internal
