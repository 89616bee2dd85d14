#include "manycontact/algorithm/inertia_factor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace manycontact {

std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal, double least) {
  std::vector<int> nothing;
  for (int k = 0; k < model.nv; ++k) diagonal[k] = M[model.M_begin[k]];
  for (int k = model.nv - 1; k >= 0; --k) {
    double* row = M + model.M_begin[k];
    if (!(row[0] > least * diagonal[k]) || !std::isfinite(1 / row[0])) {
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

void subtract(int n, double l, const double* __restrict y, double* __restrict x) {
  for (int c = 0; c < n; ++c) x[c] -= l * y[c];
}

}  // namespace

void solve_inertia_transposed(const Model& model, const double* factor, int n, double* X) {
  const auto row_of = [&](int k) { return X + static_cast<std::ptrdiff_t>(k) * n; };
  for (int k = model.nv - 1; k >= 0; --k) {
    const double* row = factor + model.M_begin[k];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a)
      subtract(n, row[a], row_of(k), row_of(i));
  }
}

void solve_inertia_unit(const Model& model, const double* factor, int n, double* X) {
  const auto row_of = [&](int k) { return X + static_cast<std::ptrdiff_t>(k) * n; };
  for (int k = 0; k < model.nv; ++k) {
    const double* row = factor + model.M_begin[k];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a)
      subtract(n, row[a], row_of(i), row_of(k));
  }
}

void solve_inertia(const Model& model, const double* factor, int n, double* X) {
  solve_inertia_transposed(model, factor, n, X);
  for (int k = 0; k < model.nv; ++k)
    for (int c = 0; c < n; ++c) X[static_cast<std::ptrdiff_t>(k) * n + c] /= factor[model.M_begin[k]];
  solve_inertia_unit(model, factor, n, X);
}

}  // namespace manycontact
