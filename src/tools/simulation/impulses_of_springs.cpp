// Adds the impulses of springs between points to the momentum of free groups (detail/simulation/momentum.hpp).

#include <algorithm>
#include <numeric>

#include "manycontact/sparse/union_find.hpp"

namespace manycontact::internal {

namespace {

// Adds an impulse at the point `at` to a group's momentum, and updates its centre of mass C_next = C + h P_next / m.
void add_impulse(FreeGroup& group, double h, const Vec3<double>& at, const Vec3<double>& impulse) {
  const Vec3<double> C = group.Y.h / group.Y.m;
  group.P_next += impulse;
  group.L_next += (at - group.reference - C).cross(impulse);
  group.C_next += h / group.Y.m * impulse;
}

int group_number(const FreeGroups& groups, const Attachment& at) {
  if (!moves(at)) return groups.group[0];
  return groups.group[groups.node[groups.first_body[at.robot] + at.joint]];
}

// Adds the angular momentum dL to groups coupled by springs, by rotating them as one body about their centre of mass.
void turn_together(std::span<const int> members, const Vec3<double>& dL, double h, FreeGroups& groups) {
  const OneBody body = one_body(members, groups);
  const Vec3<double> dw = turn_for(body.plane, body.I, dL);
  for (const int g : members) {
    FreeGroup& group = groups.groups[g];
    const Vec3<double> C = centre_of(group);
    add_impulse(group, h, C, group.Y.m * dw.cross(Vec3<double>(C - body.C)));
    group.L_next += joint_space_inertia(group) * dw;
  }
}

}  // namespace

void add_impulses_of_springs(const Scene& scene, SimulationData& d) {
  FreeGroups& groups = d.free_groups;
  if (!groups.any || !d.resisting || !d.resisting->springs) return;
  ResistingSprings& s = *d.resisting->springs;
  s.cluster.resize(groups.groups.size());
  s.couple.assign(groups.groups.size(), Vec3<double>::Zero());
  sparse::UnionFind clusters(s.cluster);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const Spring& spring = scene.springs[s.rows[i].spring];
    const int a = group_number(groups, spring.A), b = group_number(groups, spring.B);
    if (a == b) continue;
    const Vec3<double> impulse = s.p[i] * s.rows[i].direction;
    FreeGroup &A = groups.groups[a], &B = groups.groups[b];
    const Vec3<double> at_A = place_of(spring.A, d.at_rest.kin), at_B = place_of(spring.B, d.at_rest.kin);
    if (!A.tied) add_impulse(A, d.h, at_A, impulse);
    if (!B.tied) add_impulse(B, d.h, at_B, -impulse);
    if (A.tied || B.tied) continue;
    clusters.join(a, b);
    s.couple[a] += (at_B - at_A).cross(impulse);  // cancels the pair's change of angular momentum
  }
  for (std::size_t g = 0; g < s.cluster.size(); ++g) {
    const int root = clusters.root(static_cast<int>(g));
    s.cluster[g] = root;
    if (root != static_cast<int>(g)) s.couple[root] += s.couple[g];
  }
  s.members.resize(s.cluster.size());
  std::iota(s.members.begin(), s.members.end(), 0);
  std::ranges::sort(s.members, {}, [&](int g) { return std::pair(s.cluster[g], g); });
  for (std::size_t first = 0, end = 0; first < s.members.size(); first = end) {
    while (end < s.members.size() && s.cluster[s.members[end]] == s.cluster[s.members[first]]) ++end;
    const Vec3<double>& dL = s.couple[s.cluster[s.members[first]]];
    if (end - first > 1 && !dL.isZero(0)) turn_together({s.members.data() + first, end - first}, dL, d.h, groups);
  }
}

}  // namespace manycontact::internal
