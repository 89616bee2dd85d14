#pragma once
// Unit forces on springs and joints, with torques tau = U x, and components U^T a of a velocity or acceleration a.

#include <algorithm>

#include "manycontact/algorithm/applied_forces.hpp"

namespace manycontact::internal {

/// Finds sets of robots coupled by contacts flagged `active` (`by_springs`: or springs). first[r]: first of r's set.
void find_robot_sets(const Scene& scene, const std::vector<char>& active, bool by_springs, std::vector<int>& first);

struct UnitForce {
  int spring = -1;                                // a spring between points: the force acts on its ends on `island`
  Vec3<double> direction = Vec3<double>::Zero();  // direction in the world; the opposite on B's end
  int coordinate = -1;                            // a joint: index of its coordinate in the scene's v
  int island = -1, number = 0;                    // set by UnitTorques; equal numbers: forces on different islands
};

class UnitTorques {
 public:
  explicit UnitTorques(const Scene& scene);
  /// Computes the positions of springs' ends at q (nq), and clears the sum of added forces.
  void place(const Scene& scene, const Eigen::VectorXd& q);
  void clear();
  void add(const UnitForce& force, double amount);
  /// Returns the torques U x (nv), where x are the amounts of the added forces. The reference is valid until the next
  /// call.
  const Eigen::VectorXd& torques();
  /// Stores a velocity or acceleration a (nv), of which `along` returns components. Clears the sum of added forces.
  void look(const Eigen::VectorXd& a);
  double along(const UnitForce& force) const;
  /// Returns the component of a along a spring, for the ends on `island`; island -1: for both ends.
  double along(int spring, const Vec3<double>& direction, int island) const;
  /// Assigns robots to islands, which contacts flagged `active` couple.
  void find_islands(const Scene& scene, const std::vector<char>& active);
  /// Returns the island of a spring's end, or -1 if the end is fixed to the world.
  int island_of(int spring, int end) const { return island_of_end_[end][spring]; }
  /// Append a spring's unit forces to `to`, one per island of its ends, or a joint's unit force, and number them.
  void add_forces(int spring, const Vec3<double>& direction, std::vector<UnitForce>& to);
  void add_force(const Scene& scene, int coordinate, std::vector<UnitForce>& to);
  /// begin_numbers resets the numbering of forces; numbers returns the count of numbers used.
  void begin_numbers() { std::ranges::fill(count_, 0), most_ = 0; }
  int numbers() const { return most_; }

 private:
  void give_number(UnitForce& force);
  std::vector<int> islands_, count_;
  int most_ = 0;
  std::vector<int> push_[2];           // one entry per spring: wrench on the end; -1: fixed to the world
  std::vector<int> island_of_end_[2];  // one entry per spring: island of the end; -1: fixed to the world
  Scene ends_;                         // the robots, with an external wrench in world axes at each movable end
  AppliedForces<double> forces_;
  AppliedScratch scratch_;
  std::vector<int> robots_;
  std::vector<Vec6<double>> w_;
  Eigen::VectorXd q_, rest_, tau_, joints_, a_, by_q_, by_v_, by_w_;
};

}  // namespace manycontact::internal
