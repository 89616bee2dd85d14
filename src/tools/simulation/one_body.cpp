#include "one_body.hpp"

#include "manycontact/spatial/explog.hpp"

namespace manycontact::internal {

PartOfBody part_of(const FreeGroup& group) {
  const Vec3<double> C = group.Y.h / group.Y.m;
  return {group.Y.m, group.reference + C, group.Y.seen_at(-C).I, group.P_next, group.L_next, group.C_next};
}

namespace {

Mat3<double> about(const Vec3<double>& r, double m) {
  return m * (r.squaredNorm() * Mat3<double>::Identity() - r * r.transpose());
}

}  // namespace

OneBody one_body(std::span<const int> members, const std::vector<PartOfBody>& parts, const FreeGroups& groups,
                 bool moves) {
  OneBody out;
  Vec3<double> first = Vec3<double>::Zero(), P = first;
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    const FreeGroup& group = groups.groups[static_cast<std::size_t>(g)];
    out.m += part.m, first += part.m * part.C, P += part.P;
    if (group.in_plane) out.plane.in_plane = true, out.plane.normal = group.normal;
  }
  out.C = first / out.m;
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    out.I += part.I + about(part.C - out.C, part.m);
    out.L += part.L + (part.C - out.C).cross(part.P);
  }
  if (moves) out.V = P / out.m, out.w = turn_for(out.plane, out.I, out.L);
  return out;
}

void keep_all(std::span<const int> members, const std::vector<PartOfBody>& parts, FreeGroups& groups) {
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    FreeGroup& group = groups.groups[static_cast<std::size_t>(g)];
    group.P_next = part.P, group.L_next = part.L, group.C_next = part.C_next;
  }
}

// A share of what the parts have, r+ = r + h (P / m - V), P, L, and the rest of the one body turned by R = exp(h w),
//
//     r+ = R r        P+ = m (V + w+ x r+)        L+ = R I R^T w+        sum of r+ x P+ + L+ = sum of r x P + L
//
// with r from its C. Their mixture has another sum, which all are turned by.
void approach(const OneBody& body, std::span<const int> members, const std::vector<PartOfBody>& parts, double share,
              bool moves, double h, FreeGroups& groups) {
  const Mat3<double> R = exp3<double>(h * body.w);
  Mat3<double> I = Mat3<double>::Zero();
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    I += R * (part.I + about(part.C - body.C, part.m)) * R.transpose();
  }
  const Vec3<double> w = moves ? turn_for(body.plane, I, body.L) : Vec3<double>(Vec3<double>::Zero());
  Vec3<double> L = body.L;
  I.setZero();
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    FreeGroup& group = groups.groups[static_cast<std::size_t>(g)];
    const Vec3<double> r = part.C - body.C, turned = R * r;
    group.C_next = share * (r + h * (part.P / part.m - body.V)) + (1 - share) * turned;  // from the body's C
    group.P_next = share * part.P + (1 - share) * part.m * (body.V + w.cross(turned));
    group.L_next = share * part.L + (1 - share) * (R * (part.I * (R.transpose() * w)));
    L -= group.C_next.cross(group.P_next) + group.L_next;
    I += R * part.I * R.transpose() + about(group.C_next, part.m);
  }
  const Vec3<double> dw = moves ? turn_for(body.plane, I, L) : Vec3<double>(Vec3<double>::Zero());
  for (const int g : members) {
    const PartOfBody& part = parts[static_cast<std::size_t>(g)];
    FreeGroup& group = groups.groups[static_cast<std::size_t>(g)];
    group.P_next += part.m * dw.cross(group.C_next);
    group.L_next += R * (part.I * (R.transpose() * dw));
    group.C_next += body.C + h * body.V - group.reference;
  }
}

}  // namespace manycontact::internal
