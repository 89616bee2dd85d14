#include "manycontact/dynamics/truth.hpp"

#include "manycontact/algorithm/rnea.hpp"

namespace manycontact {

namespace {

template <class S>
struct Terms {
  std::vector<Kinematics<S>> kin;
  std::vector<VecX<S>> M, h;
};

template <class S>
Terms<S> robot_terms(const Scene& scene, const VecX<S>& q, const VecX<S>& v) {
  Terms<S> t;
  std::vector<Vec6<S>> f;
  std::vector<Inertia<S>> Yc;
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    Kinematics<S>& kin = t.kin.emplace_back(model);
    forward_kinematics<S>(model, robot.base, q.segment(robot.idx_q, model.nq), kin);
    forward_accelerations<S>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, kin);
    inverse_dynamics<S>(model, kin, nullptr, {}, f, t.h.emplace_back(model.nv));
    crba<S>(model, kin, Yc, t.M.emplace_back(model.M_begin[model.nv]).data());
  }
  return t;
}

template <class S>
void solve_island(const Scene& scene, const Terms<S>& t, const Island& island, const std::vector<int>& f_offset,
                  const VecX<S>& u, Truth<S>& out) {
  DenseKkt<S> kkt;
  kkt.M.setZero(island.nv, island.nv);
  kkt.J.setZero(island.nc, island.nv);
  kkt.delta = S(scene.damping);
  MatX<S> b1(island.nv, 1), b2(island.nc, 1), a, f;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    const Model& model = *robot.model;
    const int o = island.dof_offset[k], first = model.first_actuated();
    unpack_inertia<S>(model, t.M[island.robots[k]].data(), kkt.M.block(o, o, model.nv, model.nv));
    for (int i = 0; i < model.nv; ++i)
      b1(o + i, 0) = (i < first ? S(0) : u[robot.idx_u + i - first]) - t.h[island.robots[k]][i];
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const ContactSupport support = contact_support(scene, contact);
    ContactData<S> rows(contact, support);
    contact_rows<S>(scene, contact, support, t.kin[contact.A.robot],
                    contact.B.robot < 0 ? nullptr : &t.kin[contact.B.robot], rows);
    int j = 0;
    const int o = island.row_offset[k];
    for (int i : support.a)
      kkt.J.col(island.dof_offset[local_robot(island, contact.A.robot)] + i).segment(o, contact.rows()) = rows.J.col(j++);
    for (int i : support.b)
      kkt.J.col(island.dof_offset[local_robot(island, contact.B.robot)] + i).segment(o, contact.rows()) = rows.J.col(j++);
    b2.block(o, 0, contact.rows(), 1) = -rows.a0;
  }
  factor<S>(kkt);
  solve<S>(kkt, b1, b2, a, f);
  out.rank.push_back(kkt.rank);
  out.regular.push_back(kkt.regular);
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    out.a.segment(robot.idx_v, robot.model->nv) = a.col(0).segment(island.dof_offset[k], robot.model->nv);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int rows = scene.contacts[island.contacts[k]].rows();
    out.f.segment(f_offset[island.contacts[k]], rows) = f.col(0).segment(island.row_offset[k], rows);
  }
}

}  // namespace

template <class S>
Truth<S> solve_truth(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                     const VecX<S>& u) {
  const Terms<S> terms = robot_terms<S>(scene, q, v);
  std::vector<int> f_offset(scene.contacts.size(), -1);
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) f_offset[c] = rows, rows += scene.contacts[c].rows();
  Truth<S> out;
  out.a.resize(scene.nv);
  out.f.resize(rows);
  out.h.resize(scene.nv);
  for (int r = 0; r < scene.nrobots(); ++r)
    out.h.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) = terms.h[r];
  for (const Island& island : find_islands(scene, active))
    solve_island<S>(scene, terms, island, f_offset, u, out);
  return out;
}

template Truth<InstantiatedScalar> solve_truth<InstantiatedScalar>(const Scene&, const std::vector<char>&,
                                                                   const VecX<InstantiatedScalar>&,
                                                                   const VecX<InstantiatedScalar>&,
                                                                   const VecX<InstantiatedScalar>&);

}  // namespace manycontact
