// Part of ProximalFactor (proximal.hpp) that tests with random vectors which rows are in the null space of J^T, and how
// often the operator E = delta (S + delta)^-1 must be applied to project on this null space.

#include "proximal.hpp"

#include <cstdint>

namespace manycontact {

namespace internal {

// Checks the rank, and sets applications_ to the k for which E^k approximates the projector P (proximal.hpp). In place
// of all columns of P, it tests random vectors, the probes. E^k and P agree on the probes once J^T E^k probes is a
// rounding error. This never happens if a dropped row is only nearly dependent: S then has an eigenvector that E
// neither removes nor preserves, with a component in nearly all probes. If the pivot alone decided that a row is
// dependent, S may have an eigenvalue of kPivotOfDependent delta, whose component each E divides by kPivotOfDependent.
// Forces have larger components than probes along the smallest eigenvalues, and need one more application.
bool ProximalFactor::certify(FactorScratch& scratch) {
  left_ = drift_ = 0;
  applications_ = 1;
  std::fill(in_null_space_.begin(), in_null_space_.end(), 0);
  if (dropped_.empty()) return true;
  start_probes();
  const double slowest = in_doubt_ ? tolerance::kSlowest : 0.5 / tolerance::kPivotOfDependent;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 1; k < tolerance::kMostApplications; ++k, last = left_) {
    before_ = probes_;
    apply(probes_.data(), kProbes, kProbes, nullptr);
    measure_drift();
    left_ = left_of_probes(scratch);
    const bool vanishes = left_ <= std::max(tolerance::kRowLeft, tolerance::kGrown * kEps * growth_);
    if (!vanishes && left_ < slowest * last) continue;
    left_ = std::min(left_, last);  // the decrease has stopped, at rounding errors or, if larger, at an eigenvector
    if (!vanishes && !(left_ <= tolerance::kMostLeft)) return false;
    applications_ = vanishes ? k + 1 : k;
    take_null_space_rows();
    return true;
  }
  return false;
}

void ProximalFactor::start_probes() {
  const KktPattern& p = *ldl_.pattern;
  std::uint32_t random = 1;
  for (int row = 0; row < p.size(); ++row)
    for (int c = 0; c < kProbes; ++c) {
      random = random * 1664525u + 1013904223u;
      probe(p.iperm[row])[c] = row < p.nv ? 0 : random >> 31 ? 1 : -1;
    }
}

// Returns the largest entry of J^T probes relative to its terms or, if larger, to the largest term of a row of J.
double ProximalFactor::left_of_probes(const FactorScratch& scratch) {
  const KktPattern& p = *ldl_.pattern;
  double rows = 0, left = 0;
  for (int k = 0; k < p.size(); ++k)
    if (!of_M(k))
      rows = std::max(rows, sparse::largest({probe(k), kProbes}) * size_of_row(*K_, scratch, p.perm[k] - p.nv));
  std::fill(sums_.begin(), sums_.end(), 0.0);
  for (int k = 0; k < p.size(); ++k)
    for (int q = p.K.p[k]; q < p.K.p[k + 1]; ++q) {
      const int i = p.K.i[q];
      if (of_M(i) == of_M(k)) continue;
      const double J = K_->values[q], *y = probe(of_M(i) ? k : i);
      double* sums = terms_of(of_M(i) ? i : k);
      for (int c = 0; c < kProbes; ++c) sums[c] += J * y[c], sums[kProbes + c] += std::abs(J * y[c]);
    }
  for (int k = 0; k < p.size(); ++k)
    for (int c = 0; of_M(k) && c < kProbes; ++c)
      left = sparse::larger_or_nan(left, std::abs(terms_of(k)[c]) / std::max(terms_of(k)[kProbes + c], rows));
  return left;
}

// Sets drift_, the relative rounding error of E, to the change of the probes by E, once they are in the null space.
void ProximalFactor::measure_drift() {
  double change = 0;
  for (std::size_t k = 0; k < probes_.size(); ++k)
    change = sparse::larger_or_nan(change, std::abs(probes_[k] - before_[k]));
  drift_ = change / sparse::largest(probes_);
}

void ProximalFactor::take_null_space_rows() {
  for (int k = 0; k < ldl_.pattern->size(); ++k)
    in_null_space_[k] = !of_M(k) && sparse::largest({probe(k), kProbes}) > tolerance::kInNullSpace;
}

}  // namespace internal

std::unique_ptr<Factor> make_proximal_factor() { return std::make_unique<internal::ProximalFactor>(); }

}  // namespace manycontact
