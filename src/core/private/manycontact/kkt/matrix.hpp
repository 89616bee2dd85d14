#pragma once
// The numbers of one island's KKT system K x = b, x = [a; -f], b = [tau_b; -a0], in the elimination order of a pattern.

#include <memory>
#include <span>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

struct KktMatrix {
  std::shared_ptr<const KktPattern> pattern;
  std::vector<double> values;  // values of K's entries in the pattern's slots
  double damping = 0;          // delta of K
  /// The size relative to which rows of J are judged: the largest motion from which rows are selected (motion_scale in
  /// detail/contact/rows.hpp). The entries of J cannot give it, as they may all be rounding errors.
  double row_scale = 0;

  void reset(std::shared_ptr<const KktPattern> p);  // allocates the values
  int nv() const { return pattern->nv; }
  int nc() const { return pattern->nc; }
  int size() const { return pattern->size(); }
};

/// Writes M (packed, per robot), J (by columns, per contact) and -damping to K, in the island's order.
void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double damping,
              KktMatrix& K);

/// Vectors of the system K x = b, in K's elimination order.
struct KktVectors {
  std::vector<double> b, x;
  std::vector<double> r, scale;        // residual b - K x; scale = |b| + |K| |x|
  std::vector<double> null_component;  // part of b in the null space of J^T: inconsistency of rows

  void resize(int n);
};

void residual(const KktMatrix& K, KktVectors& v);

}  // namespace manycontact
