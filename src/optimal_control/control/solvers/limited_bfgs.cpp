#include "manycontact/detail/control/limited_bfgs.hpp"

#include <algorithm>
#include <cmath>

namespace manycontact {

namespace {

constexpr double kLeastCurvature = 1e-10;  // smallest accepted s^T y / (|s| |y|) of a step s with gradient change y

void add_scaled(double a, const LimitedBfgs::Vectors& x, LimitedBfgs::Vectors& to) {
  for (std::size_t t = 0; t < x.size(); ++t) to[t] += a * x[t];
}

}  // namespace

double dot(const LimitedBfgs::Vectors& a, const LimitedBfgs::Vectors& b) {
  double sum = 0;
  for (std::size_t t = 0; t < a.size(); ++t) sum += a[t].dot(b[t]);
  return sum;
}

void LimitedBfgs::reserve(const Vectors& sizes) {
  pairs_.resize(most_);
  for (Pair& pair : pairs_) pair.s = pair.y = sizes;
}

void LimitedBfgs::add(double step, const Vectors& direction, const Vectors& g, const Vectors& g_next) {
  if (pairs_.empty() || pairs_.front().s.size() != direction.size()) reserve(direction);
  Pair& pair = pairs_[next_];
  for (std::size_t t = 0; t < direction.size(); ++t) {
    pair.s[t] = step * direction[t];
    pair.y[t] = g_next[t] - g[t];
  }
  pair.curvature = dot(pair.s, pair.y);
  if (!(pair.curvature > kLeastCurvature * std::sqrt(dot(pair.s, pair.s) * dot(pair.y, pair.y)))) return;
  next_ = (next_ + 1) % most_;
  count_ = std::min(count_ + 1, most_);
}

void LimitedBfgs::begin(Vectors& q) {
  for (std::size_t i = 0; i < count_; ++i) {
    Pair& pair = newest(i);
    pair.a = dot(pair.s, q) / pair.curvature;
    add_scaled(-pair.a, pair.y, q);
  }
}

void LimitedBfgs::finish(Vectors& r) const {
  for (std::size_t i = count_; i-- > 0;) {
    const Pair& pair = newest(i);
    add_scaled(pair.a - dot(pair.y, r) / pair.curvature, pair.s, r);
  }
}

}  // namespace manycontact
