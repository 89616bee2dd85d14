#include "manycontact/sparse/condition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace manycontact::sparse {

namespace {
double sum_abs(const std::vector<double>& x) {
  double s = 0;
  for (double v : x) s += std::abs(v);
  return s;
}
}  // namespace

double inverse_norm_1(int n, const std::function<void(double*)>& solve) { return norm_1_estimate(n, solve, solve); }

double norm_1_by_columns(int n, const std::function<void(double*)>& multiply) {
  double norm = 0;
  std::vector<double> x(n);
  for (int j = 0; j < n; ++j) {
    std::fill(x.begin(), x.end(), 0.0);
    x[j] = 1;
    multiply(x.data());
    const double s = sum_abs(x);
    if (!std::isfinite(s)) return std::numeric_limits<double>::infinity();
    norm = std::max(norm, s);
  }
  return norm;
}

double norm_1_estimate(int n, const std::function<void(double*)>& multiply,
                       const std::function<void(double*)>& multiply_transposed) {
  if (n == 0) return 0;
  std::vector<double> x(n, 1.0 / n), z(n);
  double estimate = 0;
  int last = -1;
  for (int step = 0; step < 5; ++step) {
    multiply(x.data());
    const double s = sum_abs(x);
    if (!std::isfinite(s)) return std::numeric_limits<double>::infinity();
    if (step > 0 && s <= estimate) break;
    estimate = s;
    for (int k = 0; k < n; ++k) z[k] = x[k] >= 0 ? 1 : -1;
    multiply_transposed(z.data());
    const auto largest =
        std::max_element(z.begin(), z.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    const int j = static_cast<int>(largest - z.begin());
    if (j == last) break;
    last = j;
    std::fill(x.begin(), x.end(), 0.0);
    x[j] = 1;
  }
  // The product with an alternating vector gives a second lower bound, if the starting vector above was unlucky.
  for (int k = 0; k < n; ++k) x[k] = (k % 2 ? -1 : 1) * (1 + (n > 1 ? static_cast<double>(k) / (n - 1) : 0));
  multiply(x.data());
  return std::max(estimate, 2 * sum_abs(x) / (3 * n));
}

}  // namespace manycontact::sparse
