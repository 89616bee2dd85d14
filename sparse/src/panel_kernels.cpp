#include "manycontact/sparse/panel_kernels.hpp"

#include <vector>

#include "simd/levels.hpp"

namespace manycontact::sparse {

const PanelKernels& panel_kernels() {
  static const PanelKernels& best = simd::levels().front().panels;
  return best;
}

std::span<const PanelKernels* const> panel_levels() {
  static const std::vector<const PanelKernels*> here = [] {
    std::vector<const PanelKernels*> list;
    for (const simd::Level& level : simd::levels()) list.push_back(&level.panels);
    return list;
  }();
  return here;
}

}  // namespace manycontact::sparse
