#include "part.hpp"

#include <algorithm>

#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::cli {

namespace {

void append(std::vector<Segment>& list, int whole, int own, int count) {
  if (count == 0) return;
  if (!list.empty() && list.back().whole + list.back().count == whole && list.back().own + list.back().count == own)
    list.back().count += count;
  else
    list.push_back({whole, own, count});
}

struct Members {  // the robots and active contacts of a part's islands, in ascending order
  std::vector<int> robots, contacts;
};
Members members_of(const Scene& scene, const std::vector<Island>& islands, int number, int parts) {
  std::int64_t total = 0, before = 0;
  for (const Island& island : islands) total += island.size();
  // Both robots of a contact must be in one part, even if the contact acts on the fixed base of one of them.
  const int count = static_cast<int>(islands.size());
  std::vector<int> memory(count), island_of(scene.robots.size()), part(count);
  sparse::UnionFind neighbours(memory);
  for (int i = 0; i < count; ++i)
    for (int r : islands[i].robots) island_of[r] = i;
  for (int i = 0; i < count; ++i)
    for (int c : islands[i].contacts)
      for (const Attachment* at : {&scene.contacts[c].A, &scene.contacts[c].B})
        if (at->robot >= 0) neighbours.join(i, island_of[at->robot]);
  Members out;
  for (int i = 0; i < count; ++i) {
    const Island& island = islands[i];
    // An island is in the part that contains its middle. Coupled islands are in the part of the root of their set.
    const std::int64_t middle = 2 * before + island.size();
    part[i] = total > 0 ? static_cast<int>(std::min<std::int64_t>(middle * parts / (2 * total), parts - 1)) : -1;
    part[i] = part[neighbours.root(i)];
    if (part[i] == number) {
      out.robots.insert(out.robots.end(), island.robots.begin(), island.robots.end());
      out.contacts.insert(out.contacts.end(), island.contacts.begin(), island.contacts.end());
    }
    before += island.size();
  }
  std::ranges::sort(out.robots);
  std::ranges::sort(out.contacts);
  return out;
}

}  // namespace

ScenePart part_of(const Scene& scene, int number, int parts) {
  const std::vector<char> active = active_contacts(scene);
  const Members members = members_of(scene, find_islands(scene, active), number, parts);
  ScenePart part;
  part.scene.name = scene.name;
  part.scene.gravity = scene.gravity;
  part.scene.damping = scene.damping;
  part.scene.tolerance = scene.tolerance;
  part.scene.moment_length = scene.moment_length;
  std::vector<int> own_robot(scene.robots.size(), -1);
  for (int r : members.robots) {
    const Robot& robot = scene.robots[r];
    const int own = own_robot[r] = add_robot(part.scene, robot.name, robot.model, robot.base);
    const Robot& copy = part.scene.robots[own];
    append(part.q, robot.idx_q, copy.idx_q, robot.model->nq);
    append(part.v, robot.idx_v, copy.idx_v, robot.model->nv);
    append(part.u, robot.idx_u, copy.idx_u, robot.model->nu());
  }
  std::vector<int> first_row(scene.contacts.size());
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    first_row[c] = part.nf;
    part.nf += active[c] ? scene.contacts[c].rows() : 0;
  }
  // Contacts are copied, because add_contact would normalise their axes again and so change them.
  for (int c : members.contacts) {
    Contact contact = scene.contacts[c];
    contact.A.robot = own_robot[contact.A.robot];
    if (contact.B.robot >= 0) contact.B.robot = own_robot[contact.B.robot];
    append(part.f, first_row[c], part.own_nf, contact.rows());
    part.own_nf += contact.rows();
    part.scene.contact_index[contact.name] = static_cast<int>(part.scene.contacts.size());
    part.scene.contacts.push_back(std::move(contact));
  }
  take_applied_forces(scene, own_robot, part.scene);
  part.nq = scene.nq, part.nv = scene.nv, part.nu = scene.nu;
  return part;
}

void take(const std::vector<Segment>& segments, const double* whole, double* own) {
  for (const Segment& s : segments) std::copy_n(whole + s.whole, s.count, own + s.own);
}
void put(const std::vector<Segment>& segments, const double* own, double* whole) {
  for (const Segment& s : segments) std::copy_n(own + s.own, s.count, whole + s.whole);
}

}  // namespace manycontact::cli
