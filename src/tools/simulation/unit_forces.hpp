#pragma once
// Unit forces on springs and joints: torques tau = U x of forces x, and components U^T a of a motion a.

#include <algorithm>

#include "manycontact/algorithm/applied_forces.hpp"

namespace manycontact::internal {

/// Finds sets of robots coupled by active contacts, or also by springs. first[r]: first robot of the set with r.
void find_robot_sets(const Scene& scene, const std::vector<char>& active, bool by_springs, std::vector<int>& first);

struct UnitForce {
  int spring = -1;  // index of a spring between points, whose ends on `island` the force acts on
  Vec3<double> direction = Vec3<double>::Zero();  // direction in the world; B's end gets the opposite
  int coordinate = -1;          // index of a joint's coordinate in the scene's v, on which the force acts
  int island = -1, number = 0;  // set by UnitTorques; forces with the same number are on different islands
};

class UnitTorques {
 public:
  explicit UnitTorques(const Scene& scene);
  /// Computes the positions of springs' ends at q (nq), and clears the sum of added forces.
  void place(const Scene& scene, const Eigen::VectorXd& q);
  void clear();
  void add(const UnitForce& force, double amount);
  /// Returns the torques U x (nv), with x the amounts of the added forces. The reference is valid until the next call.
  const Eigen::VectorXd& torques();
  /// Stores a velocity or acceleration a (nv), of which `along` returns components. Clears the sum of added forces.
  void look(const Eigen::VectorXd& a);
  double along(const UnitForce& force) const;
  /// Returns the component of a along a spring, for its ends on `island`, or for both ends if island is -1.
  double along(int spring, const Vec3<double>& direction, int island) const;
  /// Assigns robots to islands: sets of robots that contacts flagged `active` couple.
  void find_islands(const Scene& scene, const std::vector<char>& active);
  /// Returns the island of a spring's end, or -1 if the end is fixed to the world.
  int island_of(int spring, int end) const { return island_of_end_[end][spring]; }
  /// Append unit forces to `to` and number them: those of a spring, one per island of its ends, or that of a joint.
  void add_forces(int spring, const Vec3<double>& direction, std::vector<UnitForce>& to);
  void add_force(const Scene& scene, int coordinate, std::vector<UnitForce>& to);
  /// begin_numbers restarts the numbering of forces. numbers returns how many numbers are in use.
  void begin_numbers() { std::ranges::fill(count_, 0), most_ = 0; }
  int numbers() const { return most_; }

 private:
  void give_number(UnitForce& force);
  std::vector<int> islands_, count_;
  int most_ = 0;
  std::vector<int> push_[2];  // one per spring: index of the wrench on its end, or -1 if the end is fixed to the world
  std::vector<int> island_of_end_[2];  // one per spring: island of its end, or -1 if the end is fixed to the world
  Scene ends_;                         // the robots, with an external wrench in world axes at each movable end
  AppliedForces<double> forces_;
  AppliedScratch scratch_;
  std::vector<int> robots_;
  std::vector<Vec6<double>> w_;
  Eigen::VectorXd q_, rest_, tau_, joints_, a_, by_q_, by_v_, by_w_;
};

}  // namespace manycontact::internal
