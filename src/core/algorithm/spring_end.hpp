#pragma once

#include "manycontact/algorithm/applied_forces.hpp"

namespace manycontact {

template <class S>
struct SpringEnd {
  WorldPoint<S> origin;            // origin of the body's tree frame; for an end in the world, the end itself
  Vec3<S> p = Vec3<S>::Zero();     // position of the end relative to `origin`
  Vec6<S> body = Vec6<S>::Zero();  // velocity of the body in its tree frame

  Vec3<S> velocity() const { return add_cross(body.template head<3>(), body.template tail<3>(), p); }
};

/// Returns the end of a spring at `at`. kin: kinematics of the end's robot; not used for an end in the world.
template <class S>
SpringEnd<S> spring_end(const Attachment& at, const Kinematics<S>* kin) {
  SpringEnd<S> end;
  if (at.robot < 0) {
    end.origin.p = at.placement.p.template cast<S>();
    return end;
  }
  const SE3<S>& M = kin->oMi[at.joint];
  end.origin = kin->origins[kin->tree_of[at.joint]];
  end.p = add_times<S>(M.p, M.R, Vec3<S>(at.placement.p.template cast<S>()));
  end.body = kin->v[at.joint];
  return end;
}

template <class S>
SpringEnd<S> spring_end(const Attachment& at, const AppliedForces<S>& forces) {  // the end in the state of `forces`
  return spring_end<S>(at, at.robot < 0 ? nullptr : &forces.robots[forces.number[at.robot]].kin);
}

template <class S>
Vec3<S> between(const SpringEnd<S>& A, const SpringEnd<S>& B) {  // vector from B to A
  return A.origin.seen_from(B.origin) + Vec3<S>(A.p - B.p);
}

}  // namespace manycontact
