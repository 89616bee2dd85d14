#include "stability/island_system.hpp"

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::test {

namespace {

// Returns the motion of each robot at q and v, without joint accelerations.
template <class S>
std::vector<Kinematics<S>> bias_motions(const Problem& p) {
  const VecX<S> q = p.q.cast<S>(), v = p.v.cast<S>();
  std::vector<Kinematics<S>> out;
  for (const Robot& robot : p.scene.robots) {
    const Model& model = *robot.model;
    Kinematics<S>& kin = out.emplace_back(model);
    forward_kinematics<S>(model, robot.base, q.segment(robot.idx_q, model.nq), kin);
    forward_accelerations<S>(model, v.segment(robot.idx_v, model.nv), nullptr, p.scene.gravity, kin);
  }
  return out;
}

template <class S>
void add_inertia(const Model& model, const Kinematics<S>& kin, int first, MatX<S>& M) {
  std::vector<Inertia<S>> composite(model.njoints());
  VecX<S> packed(model.M_begin[model.nv]);
  crba<S>(model, kin, composite, packed.data());
  unpack_inertia<S>(model, packed.data(), M.block(first, first, model.nv, model.nv));
}

template <class S>
void add_contact_rows(const Scene& scene, const Island& island, int c, int first_row,
                      const std::vector<Kinematics<S>>& kin, IslandSystem<S>& out) {
  const Contact& contact = scene.contacts[c];
  const ContactSupport support = contact_support(scene, contact);
  ContactData<S> rows(contact, support);
  contact_rows<S>(scene, contact, support, kin[contact.A.robot], contact.B.robot < 0 ? nullptr : &kin[contact.B.robot],
                  rows);
  int column = 0;
  const auto place = [&](int robot, const std::vector<int>& coordinates) {
    for (int i : coordinates)
      out.J.col(island.dof_offset[local_robot(island, robot)] + i).segment(first_row, contact.rows()) =
          rows.J.col(column++);
  };
  place(contact.A.robot, support.a);
  place(contact.B.robot, support.b);
  out.a0.segment(first_row, contact.rows()) = rows.a0;
}

}  // namespace

std::vector<char> active(const Scene& scene) {
  std::vector<char> out;
  for (const Contact& c : scene.contacts) out.push_back(c.active);
  return out;
}

template <class S>
std::vector<IslandSystem<S>> island_systems(const Problem& p) {
  const std::vector<Kinematics<S>> kin = bias_motions<S>(p);
  std::vector<int> first_force;  // per contact
  int rows = 0;
  for (const Contact& c : p.scene.contacts) first_force.push_back(rows), rows += c.active ? c.rows() : 0;
  std::vector<IslandSystem<S>> out;
  for (const Island& island : find_islands(p.scene, active(p.scene))) {
    IslandSystem<S>& system = out.emplace_back();
    system.M.setZero(island.nv, island.nv);
    system.J.setZero(island.nc, island.nv);
    system.a0.setZero(island.nc);
    for (std::size_t k = 0; k < island.robots.size(); ++k) {
      const Robot& robot = p.scene.robots[island.robots[k]];
      add_inertia<S>(*robot.model, kin[island.robots[k]], island.dof_offset[k], system.M);
      for (int i = 0; i < robot.model->nv; ++i) system.v.push_back(robot.idx_v + i);
    }
    for (std::size_t k = 0; k < island.contacts.size(); ++k) {
      const int c = island.contacts[k];
      add_contact_rows<S>(p.scene, island, c, island.row_offset[k], kin, system);
      for (int i = 0; i < p.scene.contacts[c].rows(); ++i) system.f.push_back(first_force[c] + i);
    }
  }
  return out;
}

template std::vector<IslandSystem<double>> island_systems<double>(const Problem&);
template std::vector<IslandSystem<Quad>> island_systems<Quad>(const Problem&);

}  // namespace manycontact::test
