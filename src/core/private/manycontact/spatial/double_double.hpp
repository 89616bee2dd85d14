#pragma once
// The unevaluated sum of two doubles, hi + lo with |lo| <= ulp(hi)/2: 106 bits, a double's range. It is the scalar of
// precision `extended`. Compile it with -ffp-contract=off. Errors of sums (AccurateDWPlusDW) and products (DWTimesDW2)
// are below 2^-103. Sources: Dekker, Numerische Mathematik 18 (1971); Knuth, The Art of Computer Programming 2, theorem
// 4.2.2 B; Joldes, Muller, Popescu, ACM Transactions on Mathematical Software 44 (2017), algorithms 6, 11.

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace manycontact {

struct DoubleDouble {
  double hi = 0, lo = 0;

  DoubleDouble() = default;
  DoubleDouble(double x) : hi(x) {}  // NOLINT: implicit conversion is intended
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
  explicit operator double() const { return hi; }
  DoubleDouble& operator+=(const DoubleDouble& b);
  DoubleDouble& operator-=(const DoubleDouble& b);
  DoubleDouble& operator*=(const DoubleDouble& b);
  DoubleDouble& operator/=(const DoubleDouble& b);
};

namespace detail {
/// Returns a + b exactly, for |a| >= |b| or a = 0.
[[gnu::always_inline]] inline DoubleDouble fast_two_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
[[gnu::always_inline]] inline DoubleDouble two_sum(double a, double b) {  // a + b exactly
  const double s = a + b, other = s - a;
  return {s, (a - (s - other)) + (b - other)};
}
/// Returns a b exactly, except for underflow.
[[gnu::always_inline]] inline DoubleDouble two_product(double a, double b) {
  const double p = a * b;
#ifdef __FMA__
  return {p, __builtin_fma(a, b, -p)};
#else
  constexpr double kSplit = 134217729;  // 2^27 + 1
  const double ca = kSplit * a, ah = ca - (ca - a), al = a - ah, cb = kSplit * b, bh = cb - (cb - b), bl = b - bh;
  return {p, al * bl - (((p - ah * bh) - al * bh) - ah * bl)};
#endif
}
/// Returns a b + c in double, for small correction terms.
[[gnu::always_inline]] inline double product_plus(double a, double b, double c) {
#ifdef __FMA__
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}
}  // namespace detail

[[gnu::always_inline]] inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
[[gnu::always_inline]] inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble s = detail::two_sum(a.hi, b.hi), t = detail::two_sum(a.lo, b.lo);
  const DoubleDouble v = detail::fast_two_sum(s.hi, s.lo + t.hi);
  return detail::fast_two_sum(v.hi, t.lo + v.lo);
}
[[gnu::always_inline]] inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }
[[gnu::always_inline]] inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = detail::two_product(a.hi, b.hi);
  const double cross = detail::product_plus(a.lo, b.hi, detail::product_plus(a.hi, b.lo, a.lo * b.lo));
  return detail::fast_two_sum(p.hi, p.lo + cross);
}
[[gnu::always_inline]] inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double q1 = a.hi / b.hi;
  if (!std::isfinite(q1)) return q1;
  DoubleDouble r = a - b * DoubleDouble(q1);
  const double q2 = r.hi / b.hi;
  r = r - b * DoubleDouble(q2);
  const DoubleDouble q = detail::fast_two_sum(q1, q2);
  return q + DoubleDouble(r.hi / b.hi);
}
inline DoubleDouble& DoubleDouble::operator+=(const DoubleDouble& b) { return *this = *this + b; }
inline DoubleDouble& DoubleDouble::operator-=(const DoubleDouble& b) { return *this = *this - b; }
inline DoubleDouble& DoubleDouble::operator*=(const DoubleDouble& b) { return *this = *this * b; }
inline DoubleDouble& DoubleDouble::operator/=(const DoubleDouble& b) { return *this = *this / b; }

inline bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}
inline bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
inline bool operator<=(const DoubleDouble& a, const DoubleDouble& b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo <= b.lo);
}
inline bool operator>=(const DoubleDouble& a, const DoubleDouble& b) { return b <= a; }
inline bool operator==(const DoubleDouble& a, const DoubleDouble& b) { return a.hi == b.hi && a.lo == b.lo; }

inline DoubleDouble abs(const DoubleDouble& a) { return a.hi < 0 || (a.hi == 0 && a.lo < 0) ? -a : a; }
inline DoubleDouble sqrt(const DoubleDouble& a) {
  const double s = std::sqrt(a.hi);
  if (!(s > 0) || !std::isfinite(s)) return s;
  return detail::fast_two_sum(s, (a - detail::two_product(s, s)).hi / (2 * s));  // one step of Newton's method
}

namespace detail {
/// The numbers 1/n!. They are constants since code compiled for a SIMD level must not run before the level is chosen.
inline constexpr DoubleDouble kInverseFactorials[] = {{0x1p+0, 0},
                                                      {0x1p+0, 0},
                                                      {0x1p-1, 0},
                                                      {0x1.5555555555555p-3, 0x1.5555555555555p-57},
                                                      {0x1.5555555555555p-5, 0x1.5555555555555p-59},
                                                      {0x1.1111111111111p-7, 0x1.1111111111111p-63},
                                                      {0x1.6c16c16c16c17p-10, -0x1.f49f49f49f49fp-65},
                                                      {0x1.a01a01a01a01ap-13, 0x1.a01a01a01a01ap-73},
                                                      {0x1.a01a01a01a01ap-16, 0x1.a01a01a01a01ap-76},
                                                      {0x1.71de3a556c734p-19, -0x1.c154f8ddc6c00p-73},
                                                      {0x1.27e4fb7789f5cp-22, 0x1.cbbc05b4fa99ap-76},
                                                      {0x1.ae64567f544e4p-26, -0x1.c062e06d1f209p-80},
                                                      {0x1.1eed8eff8d898p-29, -0x1.2aec959e14c06p-83},
                                                      {0x1.6124613a86d09p-33, 0x1.f28e0cc748ebep-87},
                                                      {0x1.93974a8c07c9dp-37, 0x1.05d6f8a2efd1fp-92},
                                                      {0x1.ae7f3e733b81fp-41, 0x1.1d8656b0ee8cbp-97},
                                                      {0x1.ae7f3e733b81fp-45, 0x1.1d8656b0ee8cbp-101},
                                                      {0x1.952c77030ad4ap-49, 0x1.ac981465ddc6cp-103},
                                                      {0x1.6827863b97d97p-53, 0x1.eec01221a8b0bp-107},
                                                      {0x1.2f49b46814157p-57, 0x1.2650f61dbdcb4p-112},
                                                      {0x1.e542ba4020225p-62, 0x1.ea72b4afe3c2fp-120},
                                                      {0x1.71b8ef6dcf572p-66, -0x1.d043ae40c4647p-120},
                                                      {0x1.0ce396db7f853p-70, -0x1.aebcdbd20331cp-124},
                                                      {0x1.761b41316381ap-75, -0x1.3423c7d91404fp-130},
                                                      {0x1.f2cf01972f578p-80, -0x1.9ada5fcc1ab14p-135}};
/// Sums power^k / (first + step k)! over k = 0 ... terms-1, last term first; terms from `small` on are in double.
inline DoubleDouble series(const DoubleDouble& power, int first, int step, int terms, int small) {
  const auto factor = [&](int k) { return kInverseFactorials[first + step * k]; };
  double tail = 0;
  int k = terms - 1;
  for (; k >= small; --k) tail = factor(k).hi + power.hi * tail;
  DoubleDouble sum(tail);
  for (; k >= 0; --k) sum = factor(k) + power * sum;
  return sum;
}
}  // namespace detail

/// Computes the sine s and cosine c of an angle [rad]. They are NaN for angles beyond 2^50.
inline void sin_cos(const DoubleDouble& angle, DoubleDouble& s, DoubleDouble& c) {
  // pi/8 in three doubles, whose multiples are exact enough up to 2^50
  constexpr double kEighth[3] = {0x1.921fb54442d18p-2, 0x1.1a62633145c07p-56, -0x1.f1976b7ed8fbcp-112};
  constexpr DoubleDouble kSine[3] = {
      {0, 0}, {0x1.87de2a6aea963p-2, -0x1.72cedd3d5a61p-57}, {0x1.6a09e667f3bcdp-1, -0x1.bdd3413b26456p-55}};
  constexpr DoubleDouble kCosine[3] = {
      {1, 0}, {0x1.d906bcf328d46p-1, 0x1.457e610231ac2p-56}, {0x1.6a09e667f3bcdp-1, -0x1.bdd3413b26456p-55}};
  if (!(std::abs(angle.hi) < 0x1p50)) {
    s = c = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const double n = std::nearbyint(angle.hi * (8 / 3.14159265358979323846));
  DoubleDouble t = angle;
  for (const double part : kEighth) t -= detail::two_product(part, n);
  // |t| <= pi/16: 12 terms give 2^-106, and terms from the seventh on are below 2^-53
  const DoubleDouble minus_t2 = -(t * t);
  const DoubleDouble sine = t * detail::series(minus_t2, 1, 2, 12, 6), cosine = detail::series(minus_t2, 0, 2, 13, 7);
  const int k = static_cast<int>(std::fmod(n, 16)), sixteenth = k < 0 ? k + 16 : k;
  // rotate by j eighths of pi, j = -2 ... 2, then by quarter revolutions
  const int quarter = (sixteenth + 2) / 4, j = sixteenth - 4 * quarter, size = j < 0 ? -j : j;
  const DoubleDouble sj = j < 0 ? -kSine[size] : kSine[size], &cj = kCosine[size];
  const DoubleDouble sum = sine * cj + cosine * sj, other = cosine * cj - sine * sj;
  const bool swaps = quarter % 2 != 0, turns = quarter % 4 == 2 || quarter % 4 == 3;
  const DoubleDouble a = swaps ? other : sum, b = swaps ? -sum : other;
  s = turns ? -a : a;
  c = turns ? -b : b;
}
inline DoubleDouble sin(const DoubleDouble& x) {
  DoubleDouble s, c;
  sin_cos(x, s, c);
  return s;
}
inline DoubleDouble cos(const DoubleDouble& x) {
  DoubleDouble s, c;
  sin_cos(x, s, c);
  return c;
}
inline DoubleDouble tan(const DoubleDouble& x) {
  DoubleDouble s, c;
  sin_cos(x, s, c);
  return s / c;
}
/// Returns the angle of the point (x, y), computed in double and corrected once, which leaves an error of third order.
inline DoubleDouble atan2(const DoubleDouble& y, const DoubleDouble& x) {
  const double angle = std::atan2(y.hi, x.hi);
  if (!std::isfinite(angle) || (y.hi == 0 && x.hi == 0)) return angle;
  DoubleDouble s, c;
  sin_cos(DoubleDouble(angle), s, c);
  return DoubleDouble(angle) + (y * c - x * s) / (x * c + y * s);
}
/// Returns exp(x) - 1 for |x| <= 1/2.
inline DoubleDouble small_expm1(const DoubleDouble& x) { return x * detail::series(x, 1, 1, 24, 24); }
inline DoubleDouble tanh(const DoubleDouble& x) {
  if (std::abs(x.hi) > 40) return x.hi > 0 ? 1 : -1;  // 1 - 2 exp(-80) rounds to 1
  int halvings = 0;
  DoubleDouble y = x;
  for (; std::abs(y.hi) > 0.25; ++halvings) y = y * DoubleDouble(0.5);
  const DoubleDouble e = small_expm1(y + y);
  DoubleDouble t = e / (e + DoubleDouble(2));
  for (; halvings > 0; --halvings) t = (t + t) / (DoubleDouble(1) + t * t);
  return t;
}

}  // namespace manycontact

template <>
struct Eigen::NumTraits<manycontact::DoubleDouble> : Eigen::GenericNumTraits<double> {
  using Real = manycontact::DoubleDouble;
  using NonInteger = Real;
  using Literal = Real;
  using Nested = Real;
  static Real epsilon() { return 0x1p-104; }
  static Real dummy_precision() { return 0x1p-90; }
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 20,
    MulCost = 9
  };
};
