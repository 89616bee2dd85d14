#include <algorithm>
#include <cmath>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

Eigen::Matrix<double, 2, 3> across(const Vec3<double>& axis) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(axis[k]) < std::abs(axis[least])) least = k;
  const Vec3<double> first = (Vec3<double>::Unit(least) - axis[least] * axis).normalized();
  Eigen::Matrix<double, 2, 3> out;
  out << first.transpose(), axis.cross(first).transpose();
  return out;
}

std::vector<int> dof_chain(const Model& model, int joint) {
  std::vector<int> dofs;
  if (joint < 0) return dofs;
  for (int i = model.joints[joint].idx_v + model.joints[joint].nv() - 1; i >= 0; i = model.dof_parent[i])
    dofs.push_back(i);
  std::reverse(dofs.begin(), dofs.end());
  return dofs;
}

ContactSupport contact_support(const Scene& scene, const Contact& contact) {
  ContactSupport s;
  s.a = dof_chain(*scene.robots[contact.A.robot].model, contact.A.joint);
  if (contact.B.robot < 0) return s;
  s.b = dof_chain(*scene.robots[contact.B.robot].model, contact.B.joint);
  if (contact.A.robot != contact.B.robot) return s;
  std::size_t common = 0;
  while (common < s.a.size() && common < s.b.size() && s.a[common] == s.b[common]) ++common;
  s.a.erase(s.a.begin(), s.a.begin() + static_cast<std::ptrdiff_t>(common));
  s.b.erase(s.b.begin(), s.b.begin() + static_cast<std::ptrdiff_t>(common));
  return s;
}

}  // namespace manycontact
