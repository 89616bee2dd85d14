#include "manycontact/algorithm/inertia_factor.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace manycontact {

namespace {

constexpr double kNothing = 64 * std::numeric_limits<double>::epsilon();  // of the entry a pivot was computed from

}  // namespace

std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal) {
  std::vector<int> nothing;
  for (int k = 0; k < model.nv; ++k) diagonal[k] = M[model.M_begin[k]];
  for (int k = model.nv - 1; k >= 0; --k) {
    double* row = M + model.M_begin[k];
    if (!(row[0] > kNothing * diagonal[k])) {
      nothing.push_back(k);
      continue;
    }
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a) {
      const double l = row[a] / row[0];
      double* above = M + model.M_begin[i];
      for (int j = i, b = a; j >= 0; j = model.dof_parent[j], ++b) above[b - a] -= l * row[b];  // M_ij -= L_ki D_k L_kj
      row[a] = l;
    }
  }
  std::reverse(nothing.begin(), nothing.end());
  return nothing;
}

namespace {

// x -= l y
void subtract(int n, double l, const double* __restrict y, double* __restrict x) {
  for (int c = 0; c < n; ++c) x[c] -= l * y[c];
}

}  // namespace

void solve_inertia(const Model& model, const double* factor, int n, double* X) {
  const auto row_of = [&](int k) { return X + static_cast<std::ptrdiff_t>(k) * n; };
  for (int k = model.nv - 1; k >= 0; --k) {  // X = L^T\X
    const double* row = factor + model.M_begin[k];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a)
      subtract(n, row[a], row_of(k), row_of(i));
  }
  for (int k = 0; k < model.nv; ++k) {  // X = L\(D\X)
    const double* row = factor + model.M_begin[k];
    for (int c = 0; c < n; ++c) row_of(k)[c] /= row[0];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a)
      subtract(n, row[a], row_of(i), row_of(k));
  }
}

}  // namespace manycontact
