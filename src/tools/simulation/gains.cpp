#include "manycontact/simulation/gains.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

namespace manycontact {

namespace {

using Complex = std::complex<double>;

struct Roots {  // the roots of z^2 - trace z + det = 0; `first` has the larger magnitude
  Complex first, second;
  Roots(double trace, double det) {
    const Complex root = std::sqrt(Complex(trace * trace / 4 - det));
    first = trace / 2 + (trace < 0 ? -root : root);  // this sign avoids cancellation
    second = first == 0.0 ? 0.0 : det / first;
  }
};

double rk4_factor(Complex x) { return std::abs(1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0)))); }

double rk4_growth(const Gains& gains, double h) {
  const Roots L(-gains.beta, gains.alpha);
  return std::max(rk4_factor(h * L.first), rk4_factor(h * L.second));
}

// Finds the largest stable step by bisection, because every ray from 0 into the left half plane leaves RK4's stability
// region exactly once, within |x| < 3.
double rk4_largest_step(const Gains& gains) {
  const Roots L(-gains.beta, gains.alpha);
  double low = 0, high = 3 / std::max(std::abs(L.first), std::abs(L.second));
  while (high - low > 1e-9 * high) {
    const double h = (low + high) / 2;
    (rk4_growth(gains, h) <= 1 + 1e-13 ? low : high) = h;
  }
  return low;
}

}  // namespace

std::string to_string(Integrator integrator) { return integrator == Integrator::kRk4 ? "rk4" : "semi-implicit-euler"; }

std::optional<Integrator> integrator_from_string(const std::string& name) {
  for (Integrator integrator : kIntegrators)
    if (to_string(integrator) == name) return integrator;
  return std::nullopt;
}

Gains recommended_gains(Integrator integrator, double h) {
  if (!(h > 0) || !std::isfinite(h))
    throw std::invalid_argument("recommended_gains: the step h is not a finite number above 0");
  if (integrator == Integrator::kSemiImplicitEuler) return {1 / (4 * h * h), 3 / (4 * h)};
  const double omega = 0.1 / h;
  return {omega * omega, 2 * omega};
}

double error_growth(Integrator integrator, const Gains& gains, double h) {
  if (integrator == Integrator::kRk4) return rk4_growth(gains, h);
  const double a = gains.alpha * h * h, b = gains.beta * h;
  return std::abs(Roots(2 - a - b, 1 - b).first);
}

double largest_stable_step(Integrator integrator, const Gains& gains) {
  if (gains.alpha < 0 || gains.beta < 0) return 0;
  if (gains.alpha == 0 && gains.beta == 0) return std::numeric_limits<double>::infinity();
  if (integrator == Integrator::kRk4) return rk4_largest_step(gains);
  return 4 / (gains.beta + std::sqrt(gains.beta * gains.beta + 4 * gains.alpha));
}

}  // namespace manycontact
