#pragma once
// Values of one island's KKT system K x = b, x = [a; -f], b = [tau_b; -a0], in a pattern's elimination order.

#include <memory>
#include <span>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

struct KktMatrix {
  std::shared_ptr<const KktPattern> pattern;
  std::vector<double> values;  // entries in the pattern's slots
  double damping = 0;          // delta
  /// Reference for the sizes of J's rows: the largest motion from which they are selected (motion_scale in
  /// detail/contact/rows.hpp). J itself may contain only rounding errors.
  double row_scale = 0;

  /// Sets the pattern and allocates the values.
  void reset(std::shared_ptr<const KktPattern> p);
  int nv() const { return pattern->nv; }
  int nc() const { return pattern->nc; }
  int size() const { return pattern->size(); }
};

/// Writes K's values into their slots. M: packed inertia per robot; J: by columns, per contact; in the island's order.
void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double damping,
              KktMatrix& K);

/// Vectors of a system in K's elimination order.
struct KktVectors {
  std::vector<double> b, x;
  std::vector<double> r, scale;        // residual b - K x, and |b| + |K| |x|
  std::vector<double> null_component;  // null-space part of b: the inconsistency of dependent rows

  void resize(int n);
};

void residual(const KktMatrix& K, KktVectors& v);

}  // namespace manycontact
