#pragma once
// The rows of all contacts of a scene at one state, in any scalar, and their expected values.

#include <type_traits>
#include <vector>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {

template <class S>
struct SceneRows {
  const Scene& scene;
  std::vector<Kinematics<S>> kin;
  std::vector<ContactSupport> support;
  std::vector<ContactData<S>> data;

  SceneRows(const Scene& of, const VecX<S>& q, const VecX<S>& v) : scene(of) {
    for (const Robot& robot : scene.robots) {
      const Model& model = *robot.model;
      kin.emplace_back(model);
      forward_kinematics<S>(model, robot.base, q.segment(robot.idx_q, model.nq), kin.back());
      forward_accelerations<S>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, kin.back());
    }
    for (const Contact& c : scene.contacts) {
      support.push_back(contact_support(scene, c));
      data.emplace_back(c, support.back());
      contact_rows<S>(scene, c, support.back(), kin[c.A.robot], c.B.robot < 0 ? nullptr : &kin[c.B.robot], data.back());
    }
  }
  int size() const { return static_cast<int>(data.size()); }

  /// Returns J of contact k, in all columns of the scene.
  MatX<S> J(int k) const {
    const Contact& c = scene.contacts[k];
    MatX<S> J = MatX<S>::Zero(c.rows(), scene.nv);
    int column = 0;
    for (int i : support[k].a) J.col(scene.robots[c.A.robot].idx_v + i) += data[k].J.col(column++);
    for (int i : support[k].b) J.col(scene.robots[c.B.robot].idx_v + i) += data[k].J.col(column++);
    return J;
  }
  VecX<S> a0(int k) const { return data[k].a0; }

  /// Returns the placement in the world, from its definition. More digits than those of double make it orthogonal.
  SE3<S> world(const Attachment& at) const {
    if (at.robot < 0) return at.placement.template cast<S>();
    SE3<S> M = scene.robots[at.robot].base.template cast<S>();
    if (at.joint >= 0)
      M = SE3<S>{Mat3<S>::Identity(), kin[at.robot].origin(at.joint)} * kin[at.robot].oMi[at.joint];
    M = M * at.placement.template cast<S>();
    if constexpr (!std::is_same_v<S, double>)
      M.R = Mat3<S>(M.R * (S(3) * Mat3<S>::Identity() - M.R.transpose() * M.R)) / S(2);
    return M;
  }
  SE3<S> A(int k) const { return world(scene.contacts[k].A); }
  SE3<S> B(int k) const { return world(scene.contacts[k].B); }
  SE3<S> G(int k) const { return B(k).inverse() * A(k); }
};

/// Returns the components of x, given in A's axes, that contact c constrains, rotated into its frame.
template <class S>
VecX<S> selected(const Contact& c, const SE3<S>& oMA, Vec6<S> x) {
  if (c.reference_frame != ReferenceFrame::kLocal) {
    x.template head<3>() = Vec3<S>(oMA.R * x.template head<3>());
    x.template tail<3>() = Vec3<S>(oMA.R * x.template tail<3>());
  }
  switch (c.type) {
    case ContactType::k1D:
      return VecX<S>::Constant(1, c.axis.cast<S>().dot(x.template head<3>()));
    case ContactType::k2D:
      return Eigen::Matrix<S, 2, 1>(x[0], x[2]);
    case ContactType::k3D:
      return x.template head<3>();
    case ContactType::k5D: {
      VecX<S> out(5);
      out << x.template head<3>(), across(c.axis).cast<S>() * x.template tail<3>();
      return out;
    }
    case ContactType::k6D:
      return x;
  }
  return {};
}

/// Returns q (+) v for the whole scene.
template <class S>
VecX<S> moved(const Scene& scene, const VecX<S>& q, const VecX<S>& v) {
  VecX<S> out(scene.nq);
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    integrate<S>(model, q.segment(robot.idx_q, model.nq), v.segment(robot.idx_v, model.nv),
                 out.segment(robot.idx_q, model.nq));
  }
  return out;
}

}  // namespace manycontact::test
