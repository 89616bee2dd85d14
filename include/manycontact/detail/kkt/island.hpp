#pragma once
// Islands are sets of robots that are coupled by active contacts or by springs. Each island has a KKT system of its
// own. Contacts with the world, or with a body that is fixed to the world, do not couple robots.

#include <vector>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// One island. Velocity coordinates of its robots, and constraint rows of its contacts, are numbered from 0 on.
struct Island {
  std::vector<int> robots;      // numbers in the scene, ascending
  std::vector<int> contacts;    // numbers of the active contacts in the scene, ascending
  std::vector<int> dof_offset;  // one entry per robot: its first coordinate in the island
  std::vector<int> row_offset;  // one entry per contact: its first row in the island
  int nv = 0, nc = 0;

  int size() const { return nv + nc; }  // number of rows of K
};

/// Returns whether a contact couples the motions of two bodies, so that their robots share an island.
inline bool joins_robots(const Contact& contact) { return moves(contact.A) && moves(contact.B); }
/// Returns whether a spring couples two bodies. It adds no rows to K, but derivatives then have blocks between the
/// robots.
inline bool joins_robots(const Spring& spring) { return moves(spring.A) && moves(spring.B); }
/// Returns the robot to whose island a contact belongs: the robot of A or, if A cannot move, the robot of B.
inline int robot_of(const Contact& contact) { return moves(contact.A) ? contact.A.robot : contact.B.robot; }

/// Finds the islands of the scene with its springs and the given active contacts (one flag per contact), sorted by
/// their first robots. The cost is linear in the numbers of robots and contacts.
std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active);

/// Returns one island of all robots and all active contacts of the scene, coupled or not.
Island whole_scene(const Scene& scene, const std::vector<char>& active);

/// Computes dof_offset, row_offset, nv and nc from robots and contacts.
void number_island(const Scene& scene, Island& island);

/// Returns the index of a robot in island.robots; the robot must be part of the island.
int local_robot(const Island& island, int robot);
/// Returns the first coordinate in the island of the robot to which an end of a contact is attached; 0 if the end
/// cannot move.
int first_dof(const Island& island, const Attachment& end);

// The functions below map coordinates of an island to those of the scene, by robot or contact.

/// Calls use(first index in the scene's v, first index in the island, count) for each robot.
template <class Use>
void each_velocity_block(const Scene& scene, const Island& island, Use&& use) {
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(island.robots[k])];
    use(robot.idx_v, island.dof_offset[k], robot.model->nv);
  }
}

/// Calls use(first index in the scene's u, first index in the island's torques, count) for each robot.
template <class Use>
void each_torque_block(const Scene& scene, const Island& island, Use&& use) {
  int first = 0;
  for (int r : island.robots) {
    const int nu = scene.robots[static_cast<std::size_t>(r)].model->nu();
    use(scene.robots[r].idx_u, first, nu);
    first += nu;
  }
}

/// Calls use(first index in the scene's forces, first index in the island's rows, count) for each contact. f_offset
/// contains, per contact of the scene, its first row among the forces.
template <class Use>
void each_force_block(const Scene& scene, const std::vector<int>& f_offset, const Island& island, Use&& use) {
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    use(f_offset[c], island.row_offset[k], scene.contacts[c].rows());
  }
}

}  // namespace manycontact
