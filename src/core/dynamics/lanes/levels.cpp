#include "simd/levels.hpp"

#include <algorithm>

#include "lanes.hpp"
#include "manycontact/contact/pair_rows.hpp"

namespace manycontact {
namespace lanes {

const simd::Level* level_of(SimdLevel lanes) {
  if (lanes == SimdLevel::kOff) return nullptr;
  if (lanes == SimdLevel::kAuto) return &simd::levels().front();
  for (const simd::Level& level : simd::levels())
    if (level.name == to_string(lanes)) return &level;
  return nullptr;
}

}  // namespace lanes

std::vector<SimdLevel> available_simd_levels() {
  std::vector<SimdLevel> out;
  for (const simd::Level& level : simd::levels()) out.push_back(*simd_level_from_string(level.name));
  return out;
}

namespace lanes {

namespace {
bool alike_ends(const Attachment& x, const Attachment& y) {  // whether they differ at most in placements
  return x.joint == y.joint && (x.robot < 0) == (y.robot < 0);
}
}  // namespace

bool alike_rows(const Contact& c, const Contact& d) {
  if (c.reference_frame != d.reference_frame || c.alpha != d.alpha || c.beta != d.beta || c.axis != d.axis ||
      kind_of(c) != kind_of(d))
    return false;
  return !c.pair || std::ranges::equal(c.pair->members, d.pair->members, alike_rows);
}

bool alike(const Scene& scene, std::span<const int> x, std::span<const int> y) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Contact& c = scene.contacts[x[k]];
    const Contact& d = scene.contacts[y[k]];
    if (!alike_rows(c, d) || !alike_ends(c.A, d.A) || !alike_ends(c.B, d.B)) return false;
  }
  return true;
}

}  // namespace lanes
}  // namespace manycontact
