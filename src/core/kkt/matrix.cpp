#include "manycontact/kkt/matrix.hpp"

namespace manycontact {

void KktMatrix::reset(std::shared_ptr<const KktPattern> p) {
  values.assign(p->K.nonzeros(), 0.0);  // first, so that K keeps its old pattern if this throws
  pattern = std::move(p);
}

void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double damping,
              KktMatrix& K) {
  double* Kx = K.values.data();
  const int* slot = K.pattern->M_slot.data();
  for (const auto& values : M)
    for (double value : values) Kx[*slot++] = value;
  slot = K.pattern->J_slot.data();
  for (const auto& values : J)
    for (double value : values) Kx[*slot++] = value;
  for (int k : K.pattern->diagonal_slot) Kx[k] = -damping;
  K.damping = damping;
}

void KktVectors::resize(int n) {
  for (auto* v : {&b, &x, &r, &scale, &null_component}) v->resize(n);
}

void residual(const KktMatrix& K, KktVectors& v) {
  sparse::residual(K.pattern->K, K.values.data(), v.x.data(), v.b.data(), v.r.data(), v.scale.data());
}

}  // namespace manycontact
