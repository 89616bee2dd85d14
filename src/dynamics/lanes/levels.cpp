#include <algorithm>

#include "lanes.hpp"
#include "simd/levels.hpp"

namespace manycontact {
namespace lanes {

const Level* level_of(Lanes lanes) {
  if (lanes == Lanes::kOff) return nullptr;
  if (lanes == Lanes::kAuto) return &simd::levels().front().robots;
  for (const simd::Level& level : simd::levels())
    if (level.name == to_string(lanes)) return &level.robots;
  return nullptr;
}

}  // namespace lanes

std::vector<Lanes> lanes_here() {
  std::vector<Lanes> out;
  for (const simd::Level& level : simd::levels()) out.push_back(*lanes_from_string(level.name));
  return out;
}

namespace lanes {

namespace {
constexpr int kLargest = 400;  // rows of K: the scratch memory of W robots side by side stays in the processor's caches

bool same(const SE3<double>& x, const SE3<double>& y) { return x.R == y.R && x.p == y.p; }
}  // namespace

bool fits(const Scene& scene, const Island& island) {
  if (island.robots.size() != 1 || island.nv == 0 || island.size() > kLargest) return false;
  return std::all_of(island.contacts.begin(), island.contacts.end(),
                     [&](int c) { return moves_at_both_ends(scene.contacts[c]); });
}

bool moves_at_both_ends(const Contact& c) { return c.A.joint >= 0 && (c.B.robot < 0 || c.B.joint >= 0); }

bool alike_rows(const Contact& c, const Contact& d) {
  return c.reference_frame == d.reference_frame && c.alpha == d.alpha && c.beta == d.beta && c.axis == d.axis;
}

bool alike(const Scene& scene, std::span<const int> x, std::span<const int> y) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Contact& c = scene.contacts[x[k]];
    const Contact& d = scene.contacts[y[k]];
    if (!alike_rows(c, d) || c.type != d.type || c.A.joint != d.A.joint || (c.B.robot < 0) != (d.B.robot < 0) ||
        c.B.joint != d.B.joint || !same(c.A.placement, d.A.placement) ||
        (c.B.robot >= 0 && !same(c.B.placement, d.B.placement)))
      return false;
  }
  return true;
}

}  // namespace lanes
}  // namespace manycontact
