#include <array>

#include "manycontact/sparse/instruction_levels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact::sparse {

extern const PanelKernels level_baseline, level_avx2, level_avx512;

std::span<const PanelKernels* const> panel_levels() {
  static const std::span<const PanelKernels* const> here = [] {
    static std::array<const PanelKernels*, 3> list;
    std::size_t count = 0;
#ifdef MANYCONTACT_LEVEL_avx512
    if (runs_avx512()) list[count++] = &level_avx512;
#endif
#ifdef MANYCONTACT_LEVEL_avx2
    if (runs_avx2()) list[count++] = &level_avx2;
#endif
    list[count++] = &level_baseline;
    return std::span<const PanelKernels* const>(list.data(), count);
  }();
  return here;
}

const PanelKernels& panel_kernels() { return *panel_levels().front(); }

}  // namespace manycontact::sparse
