#include "manycontact/kkt/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace manycontact {

void KktSystem::reset(std::shared_ptr<const KktPattern> p) {
  pattern = std::move(p);
  const std::size_t n = pattern->size();
  Kx.assign(pattern->K.nonzeros(), 0.0);
  b.assign(n, 0.0);
  x.assign(n, 0.0);
  r.assign(n, 0.0);
  scale.assign(n, 0.0);
}

void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double delta,
              KktSystem& system) {
  double* Kx = system.Kx.data();
  const int* slot = system.pattern->M_slot.data();
  for (const auto& values : M)
    for (double value : values) Kx[*slot++] = value;
  slot = system.pattern->J_slot.data();
  for (const auto& values : J)
    for (double value : values) Kx[*slot++] = value;
  for (int k : system.pattern->diagonal_slot) Kx[k] = -delta;
}

double backward_error(KktSystem& s) {
  sparse::residual(s.pattern->K, s.Kx.data(), s.x.data(), s.b.data(), s.r.data(), s.scale.data());
  const std::size_t n = s.x.size();
  double largest = 0;
  for (std::size_t k = 0; k < n; ++k) largest = std::max(largest, s.scale[k]);
  const double floor = largest * std::numeric_limits<double>::epsilon();
  double error = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double e = std::abs(s.r[k]);
    const double bound = std::max(s.scale[k], floor);
    if (!(e <= error * bound)) {
      error = e / bound;
      if (std::isnan(error)) return error;
    }
  }
  return error;
}

}  // namespace manycontact
