#include "manycontact/algorithm/inertia_factor.hpp"

#include <algorithm>
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

void solve_inertia(const Model& model, const double* factor, double* x) {
  for (int k = model.nv - 1; k >= 0; --k) {  // x = L^T\x
    const double* row = factor + model.M_begin[k];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a) x[i] -= row[a] * x[k];
  }
  for (int k = 0; k < model.nv; ++k) {  // x = L\(D\x)
    const double* row = factor + model.M_begin[k];
    x[k] /= row[0];
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a) x[k] -= row[a] * x[i];
  }
}

}  // namespace manycontact
