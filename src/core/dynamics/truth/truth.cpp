#include "manycontact/dynamics/truth.hpp"

#include <algorithm>

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/rank/row_units.hpp"
#include "truth_terms.hpp"

namespace manycontact {

namespace internal {

template <class S>
void dense_truth(const Scene& scene, const TruthTerms<S>& t, const Island& island, const std::vector<int>& f_offset,
                 const VecX<S>& u, Truth<S>& out) {
  DenseKkt<S> kkt;
  kkt.M.setZero(island.nv, island.nv);
  kkt.J.setZero(island.nc, island.nv);
  kkt.row_scale.resize(island.nc);
  kkt.delta = S(scene.damping);
  MatX<S> b1(island.nv, 1), b2(island.nc, 1), a, f;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const int r = island.robots[k], o = island.dof_offset[k];
    const Model& model = *scene.robots[r].model;
    unpack_inertia<S>(model, t.M[r].data(), kkt.M.block(o, o, model.nv, model.nv));
    b1.col(0).segment(o, model.nv) = bias_torques(scene, t, r, u);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<S>& rows = t.contacts[c];
    int j = 0;
    const int o = island.row_offset[k];
    for (int i = 0; i < contact.rows(); ++i) kkt.row_scale[o + i] = row_size(contact, rows, i);
    for (int i : t.supports[c].a)
      kkt.J.col(first_dof(island, contact.A) + i).segment(o, contact.rows()) = rows.J.col(j++);
    for (int i : t.supports[c].b)
      kkt.J.col(first_dof(island, contact.B) + i).segment(o, contact.rows()) = rows.J.col(j++);
    b2.block(o, 0, contact.rows(), 1) = -rows.a0;
    for (int i = 0; i < contact.rows(); ++i) {
      const S unit(row_unit(scene, contact, i));
      kkt.row_scale[o + i] *= unit;
      kkt.J.row(o + i) *= unit;
      b2.row(o + i) *= unit;
    }
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
    const Contact& contact = scene.contacts[island.contacts[k]];
    for (int i = 0; i < contact.rows(); ++i)
      out.f[f_offset[island.contacts[k]] + i] = f(island.row_offset[k] + i, 0) * S(row_unit(scene, contact, i));
  }
}

using Real = InstantiatedScalar;
template void dense_truth<Real>(const Scene&, const TruthTerms<Real>&, const Island&, const std::vector<int>&,
                                const VecX<Real>&, Truth<Real>&);

}  // namespace internal
}  // namespace manycontact
