#include "row_terms.hpp"

#include <algorithm>
#include <cmath>

namespace manycontact::internal {

namespace {

// How far a tree frame's origin is off, in units of rounding: none where the axes that joints displace it along are as
// given, for its sum is exact then.
double origin_rounding(const Scene& scene, const Workspace& work, const Attachment& at) {
  if (!moves(at)) return 0;
  const Model& model = *scene.robots[at.robot].model;
  const int tree = model.tree_of[at.joint];
  bool turned = false;
  double off = 0;
  for (int i : model.trees[tree].path) {
    turned = turned || model.joints[i].placement_rotates;
    if (turned) off = work.robots[at.robot].kin.origins[tree].p.cwiseAbs().maxCoeff();
    turned = turned || model.joints[i].type != JointType::kPrismatic;
  }
  return model.floating_base ? 0 : off;
}

}  // namespace

double row_terms(const Scene& scene, const Workspace& work, int contact) {
  const auto largest = [](const auto& x) { return x.cwiseAbs().maxCoeff(); };
  const Contact& c = scene.contacts[contact];
  const ContactData<double>& d = work.contacts[contact];
  const double v = std::max(largest(d.vA), largest(d.vB));
  const double origin = origin_rounding(scene, work, c.A) + origin_rounding(scene, work, c.B);
  return largest(d.aA) + largest(d.aB) + v * v + std::abs(c.beta) * v +
         std::abs(c.alpha) *
             (1 + largest(d.aMA.p) + largest(d.bMA.p) + origin + (c.B.robot >= 0 ? largest(c.B.placement.p) : 0));
}

}  // namespace manycontact::internal
