#include "one_body.hpp"

namespace manycontact::internal {

OneBody one_body(std::span<const int> members, const FreeGroups& groups) {
  OneBody out;
  Vec3<double> first = Vec3<double>::Zero(), P = first, L = first;
  for (const int g : members) {
    const FreeGroup& group = groups.groups[g];
    out.m += group.Y.m, first += group.Y.m * centre_of(group), P += group.momentum.head<3>();
    if (group.in_plane) out.plane.in_plane = true, out.plane.normal = group.normal;
  }
  out.C = first / out.m;
  for (const int g : members) {
    const FreeGroup& group = groups.groups[g];
    const Vec3<double> r = centre_of(group) - out.C;
    out.I += joint_space_inertia(group) + group.Y.m * (r.squaredNorm() * Mat3<double>::Identity() - r * r.transpose());
    L += spin(group, group.Y.h / group.Y.m) + r.cross(Vec3<double>(group.momentum.head<3>()));
  }
  out.V = P / out.m, out.w = turn_for(out.plane, out.I, L);
  return out;
}

}  // namespace manycontact::internal
