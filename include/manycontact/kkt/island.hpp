#pragma once
// Islands: robots joined by active contacts between bodies that move. Each has a KKT system of its own; the world joins
// nothing, nor does the base of a robot that stands.

#include <vector>

#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// Its robots' velocity coordinates stand one after the other, and so do its contacts' rows.
struct Island {
  std::vector<int> robots;      // scene numbers, ascending
  std::vector<int> contacts;    // scene numbers of the active ones, ascending
  std::vector<int> dof_offset;  // per robot: its first coordinate in the island
  std::vector<int> row_offset;  // per contact: its first row in the island
  int nv = 0, nc = 0;

  int size() const { return nv + nc; }
};

/// Whether a contact makes one island of two robots.
inline bool joins_robots(const Contact& contact) { return moves(contact.A) && moves(contact.B); }
/// Whether a spring does: it joins no rows of K, but derivatives have blocks between the two.
inline bool joins_robots(const Spring& spring) { return moves(spring.A) && moves(spring.B); }
/// The robot whose island a contact is part of: A's, or B's where A cannot move.
inline int robot_of(const Contact& contact) { return moves(contact.A) ? contact.A.robot : contact.B.robot; }

/// The islands of the scene with its springs and the given contacts active (one flag each), in the order of their first
/// robots.
std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active);

/// All robots and all active contacts of the scene as one island, whether contacts join them or not.
Island whole_scene(const Scene& scene, const std::vector<char>& active);

/// Fills dof_offset, row_offset, nv and nc from robots and contacts.
void number_island(const Scene& scene, Island& island);

/// Position of a robot in island.robots, which it is one of.
int local_robot(const Island& island, int robot);
/// First coordinate in the island of the robot that a contact's end is on; 0 where that end cannot move.
int first_dof(const Island& island, const Attachment& end);

// The walk between an island's coordinates and the scene's, a robot or a contact at a time.

/// use(first in the scene's v, first in the island, count) for each robot.
template <class Use>
void each_velocity_block(const Scene& scene, const Island& island, Use&& use) {
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(island.robots[k])];
    use(robot.idx_v, island.dof_offset[k], robot.model->nv);
  }
}

/// use(first in the scene's u, first in the island's torques, count) for each robot.
template <class Use>
void each_torque_block(const Scene& scene, const Island& island, Use&& use) {
  int first = 0;
  for (int r : island.robots) {
    const int nu = scene.robots[static_cast<std::size_t>(r)].model->nu();
    use(scene.robots[r].idx_u, first, nu);
    first += nu;
  }
}

/// use(first in the scene's forces, first in the island's rows, count) for each contact. f_offset: per contact of the
/// scene, its first row among the forces.
template <class Use>
void each_force_block(const Scene& scene, const std::vector<int>& f_offset, const Island& island, Use&& use) {
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    use(f_offset[c], island.row_offset[k], scene.contacts[c].rows());
  }
}

}  // namespace manycontact
