#pragma once
// Unit forces along springs and on joints, the torques that they are, and what a velocity or an acceleration is along
// them: with the columns of U these torques, tau = U x and U^T a.

#include <algorithm>
#include <span>

#include "manycontact/algorithm/applied_forces.hpp"

namespace manycontact::internal {

struct UnitForce {
  int spring = -1;                                // between points: on its ends that are on `island` ...
  Vec3<double> direction = Vec3<double>::Zero();  // ... along this, in the world, its opposite on B's; or
  int coordinate = -1;                            // on a joint: of the scene's velocities
  int island = -1, number = 0;                    // by UnitTorques: forces of one number are on different islands
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
  /// The same along a spring, of the ends on an island; -1: of both ends.
  double along(int spring, const Vec3<double>& direction, int island) const;
  /// Robots are on one island that contacts flagged `active` join.
  void find_islands(const Scene& scene, const std::vector<char>& active);
  /// The island of a spring's end, -1 in the world.
  int island_of(int spring, int end) const { return island_of_end_[end][static_cast<std::size_t>(spring)]; }
  /// The forces on a spring's ends, one for each island that they are on; or the force on a joint. With their numbers.
  void add_forces(int spring, const Vec3<double>& direction, std::vector<UnitForce>& to);
  void add_force(const Scene& scene, int coordinate, std::vector<UnitForce>& to);
  /// Before the first of these: numbers start again. After the last: how many there are.
  void begin_numbers() { std::fill(count_.begin(), count_.end(), 0), most_ = 0; }
  int numbers() const { return most_; }

 private:
  void give_number(UnitForce& force);
  std::vector<int> islands_, count_;
  int most_ = 0;
  std::vector<int> push_[2];           // per spring: of A's end and of B's; -1: in the world
  std::vector<int> island_of_end_[2];  // the same
  Scene ends_;                         // the robots, with a push in world axes at each end that moves
  AppliedForces<double> forces_;
  AppliedScratch scratch_;
  std::vector<int> robots_;
  std::vector<Vec6<double>> w_;
  Eigen::VectorXd q_, rest_, tau_, joints_, a_, by_q_, by_v_, by_w_;
};

}  // namespace manycontact::internal
