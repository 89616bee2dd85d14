#pragma once
// The numbers of one island's KKT system, K x = b with x = [a; -f], b = [tau_b; -a0], in a pattern's order of
// elimination.

#include <memory>
#include <span>

#include "manycontact/kkt/pattern.hpp"

namespace manycontact {

/// K itself.
struct KktMatrix {
  std::shared_ptr<const KktPattern> pattern;
  std::vector<double> values;  // entries in the pattern's slots
  double damping = 0;          // delta
  /// Reference for the sizes of J's rows: the largest of the motions from which they are picked
  /// (detail/contact/rows.hpp, motion_scale). J itself may consist of rounding errors only.
  double row_scale = 0;

  /// Takes a pattern and the memory its values need.
  void reset(std::shared_ptr<const KktPattern> p);
  int nv() const { return pattern->nv; }
  int nc() const { return pattern->nc; }
  int size() const { return pattern->size(); }
};

/// Writes K's values into their slots. M: per robot its packed inertia, J: per contact its J by columns, in the
/// island's order.
void assemble(std::span<const std::span<const double>> M, std::span<const std::span<const double>> J, double damping,
              KktMatrix& K);

/// Vectors of a system, all in K's order of elimination.
struct KktVectors {
  std::vector<double> b, x;
  std::vector<double> r, scale;        // residual b - K x, and |b| + |K| |x|
  std::vector<double> null_component;  // null-space part of b: the inconsistency of dependent rows

  void resize(int n);
};

/// r = b - K x and scale = |b| + |K| |x|.
void residual(const KktMatrix& K, KktVectors& v);

}  // namespace manycontact
