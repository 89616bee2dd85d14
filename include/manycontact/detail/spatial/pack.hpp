#pragma once
// Pack is a SIMD vector of W numbers (double or float), one per robot of a batch. It serves as scalar type of the
// templates from kinematics to the solution (spatial/scalar.hpp). Operations act on each element alone, in the order in
// which they are written. The result of a robot is therefore bitwise independent of W and of the other robots. A Pack
// of width 1 is used for a single robot. Compile with -ffp-contract=off, so that the compiler does not fuse products
// and sums; `multiply_add` is fused if the processor can do so. The types are vector extensions of GCC and clang, as
// wide as registers of the instruction set.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#ifdef __SSE2__
#include <immintrin.h>
#endif

#include <Eigen/Core>

#ifndef MANYCONTACT_LANES  // the code of a SIMD level shares no Eigen memory with its callers
#include "manycontact/abi.hpp"
#endif

namespace manycontact {

namespace detail {
template <class E>
struct BitsOf;
template <>
struct BitsOf<double> {
  using Int = std::int64_t;
};
template <>
struct BitsOf<float> {
  using Int = std::int32_t;
};
template <int W, class E>
struct PackOf {
  typedef E Real __attribute__((vector_size(sizeof(E) * W)));
  typedef typename BitsOf<E>::Int Int __attribute__((vector_size(sizeof(E) * W)));
};
template <class E>
struct PackOf<1, E> {
  using Real = E;
  using Int = typename BitsOf<E>::Int;
};
}  // namespace detail

/// A SIMD vector of W elements of type E, double or float.
template <int W, class E = double>
struct Pack {
  static constexpr int width = W;
  using Element = E;
  using Bits = typename detail::BitsOf<E>::Int;  // an integer with the bits of one element
  using Real = typename detail::PackOf<W, E>::Real;
  using Int = typename detail::PackOf<W, E>::Int;
  /// The result of a comparison, one element per element of the packs: all bits set if true, 0 if false.
  struct Mask {
    Int bits;
    bool operator[](int lane) const { return reinterpret_cast<const Bits*>(&bits)[lane] != 0; }
    friend Mask operator&(Mask a, Mask b) { return {a.bits & b.bits}; }
    bool any() const {
      Bits all = 0;
      for (int l = 0; l < W; ++l) all |= reinterpret_cast<const Bits*>(&bits)[l];
      return all != 0;
    }
    bool all() const {
      Bits every = -1;
      for (int l = 0; l < W; ++l) every &= reinterpret_cast<const Bits*>(&bits)[l];
      return every != 0;
    }
  };

  Real v;

  Pack() = default;
  // The copies are written out, because compilers would copy packs bytewise, and a load of a whole pack stalls after
  // bytewise stores.
  [[gnu::always_inline]] Pack(const Pack& b) : v(b.v) {}
  [[gnu::always_inline]] Pack& operator=(const Pack& b) {
    v = b.v;
    return *this;
  }
  Pack(double x) : v(Real{} + static_cast<E>(x)) {}  // NOLINT: implicit conversion is intended
  /// Converts a pack of the other element type. Doubles are rounded to floats.
  template <class Other>
    requires(!std::is_same_v<Other, E>)
  explicit Pack(const Pack<W, Other>& b) {
    if constexpr (W == 1)
      v = static_cast<E>(b.v);
    else
      v = __builtin_convertvector(b.v, Real);
  }
  static Pack of(Real x) {
    Pack p;
    p.v = x;
    return p;
  }
  static Pack load(const E* x) {
    Pack p;
    std::memcpy(&p.v, x, sizeof p.v);
    return p;
  }
  void store(E* x) const { std::memcpy(x, &v, sizeof v); }
  E operator[](int lane) const { return reinterpret_cast<const E*>(&v)[lane]; }
  void set(int lane, double x) { reinterpret_cast<E*>(&v)[lane] = static_cast<E>(x); }

  Pack& operator+=(Pack b) { return v += b.v, *this; }
  Pack& operator-=(Pack b) { return v -= b.v, *this; }
  Pack& operator*=(Pack b) { return v *= b.v, *this; }
  Pack& operator/=(Pack b) { return v /= b.v, *this; }
  [[gnu::always_inline]] friend Pack operator+(Pack a, Pack b) { return of(a.v + b.v); }
  [[gnu::always_inline]] friend Pack operator-(Pack a, Pack b) { return of(a.v - b.v); }
  [[gnu::always_inline]] friend Pack operator*(Pack a, Pack b) { return of(a.v * b.v); }
  [[gnu::always_inline]] friend Pack operator/(Pack a, Pack b) { return of(a.v / b.v); }
  [[gnu::always_inline]] friend Pack operator-(Pack a) { return of(-a.v); }

  friend Mask operator<(Pack a, Pack b) { return mask(a.v < b.v); }
  friend Mask operator<=(Pack a, Pack b) { return mask(a.v <= b.v); }
  friend Mask operator>(Pack a, Pack b) { return mask(a.v > b.v); }
  friend Mask operator>=(Pack a, Pack b) { return mask(a.v >= b.v); }

  friend Pack select(Mask m, Pack a, Pack b) {
    if constexpr (W == 1)
      return m.bits ? a : b;
    else
      return of(m.bits ? a.v : b.v);
  }
  friend Pack absolute(Pack a) { return of(from_bits(to_bits(a.v) & (Int{} + std::numeric_limits<Bits>::max()))); }
  friend Pack abs(Pack a) { return absolute(a); }
  /// Returns the larger of a and b; b if one of them is NaN.
  [[gnu::always_inline]] friend Pack larger(Pack a, Pack b) {
    if constexpr (W == 1) return of(a.v > b.v ? a.v : b.v);
#ifdef __SSE2__
    if constexpr (kBytes == 16 && kDouble) return of((Real)_mm_max_pd((__m128d)a.v, (__m128d)b.v));
    if constexpr (kBytes == 16 && !kDouble) return of((Real)_mm_max_ps((__m128)a.v, (__m128)b.v));
#endif
#ifdef __AVX__
    if constexpr (kBytes == 32 && kDouble) return of((Real)_mm256_max_pd((__m256d)a.v, (__m256d)b.v));
    if constexpr (kBytes == 32 && !kDouble) return of((Real)_mm256_max_ps((__m256)a.v, (__m256)b.v));
#endif
#ifdef __AVX512F__
    // The masked form compares all elements; _mm512_max_pd makes GCC 12 warn about an intentionally undefined value.
    if constexpr (kBytes == 64 && kDouble) return of((Real)_mm512_maskz_max_pd(0xff, (__m512d)a.v, (__m512d)b.v));
    if constexpr (kBytes == 64 && !kDouble) return of((Real)_mm512_maskz_max_ps(0xffff, (__m512)a.v, (__m512)b.v));
#endif
    return select(a > b, a, b);
  }

  /// Returns a b + c.
  [[gnu::always_inline]] friend Pack multiply_add(Pack a, Pack b, Pack c) {
#ifdef __FMA__
    if constexpr (W == 1 && kDouble) return of(__builtin_fma(a.v, b.v, c.v));
    if constexpr (W == 1 && !kDouble) return of(__builtin_fmaf(a.v, b.v, c.v));
    if constexpr (kBytes == 16 && kDouble) return of((Real)_mm_fmadd_pd((__m128d)a.v, (__m128d)b.v, (__m128d)c.v));
    if constexpr (kBytes == 16 && !kDouble) return of((Real)_mm_fmadd_ps((__m128)a.v, (__m128)b.v, (__m128)c.v));
    if constexpr (kBytes == 32 && kDouble) return of((Real)_mm256_fmadd_pd((__m256d)a.v, (__m256d)b.v, (__m256d)c.v));
    if constexpr (kBytes == 32 && !kDouble) return of((Real)_mm256_fmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v));
#ifdef __AVX512F__
    if constexpr (kBytes == 64 && kDouble) return of((Real)_mm512_fmadd_pd((__m512d)a.v, (__m512d)b.v, (__m512d)c.v));
    if constexpr (kBytes == 64 && !kDouble) return of((Real)_mm512_fmadd_ps((__m512)a.v, (__m512)b.v, (__m512)c.v));
#endif
#endif
    return of(a.v * b.v + c.v);
  }
  /// Returns c - a b, rounded as multiply_add(-a, b, c) is.
  [[gnu::always_inline]] friend Pack subtract_product(Pack a, Pack b, Pack c) {
#ifdef __FMA__
    if constexpr (W == 1 && kDouble) return of(__builtin_fma(-a.v, b.v, c.v));
    if constexpr (W == 1 && !kDouble) return of(__builtin_fmaf(-a.v, b.v, c.v));
    if constexpr (kBytes == 16 && kDouble) return of((Real)_mm_fnmadd_pd((__m128d)a.v, (__m128d)b.v, (__m128d)c.v));
    if constexpr (kBytes == 16 && !kDouble) return of((Real)_mm_fnmadd_ps((__m128)a.v, (__m128)b.v, (__m128)c.v));
    if constexpr (kBytes == 32 && kDouble) return of((Real)_mm256_fnmadd_pd((__m256d)a.v, (__m256d)b.v, (__m256d)c.v));
    if constexpr (kBytes == 32 && !kDouble) return of((Real)_mm256_fnmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v));
#ifdef __AVX512F__
    if constexpr (kBytes == 64 && kDouble) return of((Real)_mm512_fnmadd_pd((__m512d)a.v, (__m512d)b.v, (__m512d)c.v));
    if constexpr (kBytes == 64 && !kDouble) return of((Real)_mm512_fnmadd_ps((__m512)a.v, (__m512)b.v, (__m512)c.v));
#endif
#endif
    return of(c.v - a.v * b.v);
  }

  static Int to_bits(Real x) {
    Int bits;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
  }
  static Real from_bits(Int bits) {
    Real x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
  }

 private:
  static constexpr int kBytes = static_cast<int>(sizeof(E)) * W;  // bytes of a pack: 16, 32 or 64 fill a register
  static constexpr bool kDouble = sizeof(E) == sizeof(double);
  template <class Compared>
  static Mask mask(Compared holds) {
    if constexpr (W == 1)
      return {holds ? Bits(-1) : Bits(0)};
    else
      return {(Int)holds};
  }
};

namespace detail {
/// Exchanges the off-diagonal H x H blocks of each 2H x 2H block of x (W packs): one step of a transposition.
template <int H, int W, class E>
inline void exchange(Pack<W, E>* x) {
  typename Pack<W, E>::Int low, high;
  for (int l = 0; l < W; ++l) {
    low[l] = (l & H) ? W + l - H : l;
    high[l] = (l & H) ? W + l : l + H;
  }
  for (int k = 0; k < W; ++k) {
    if (k & H) continue;
    const auto a = x[k].v, b = x[k + H].v;
#ifdef __clang__
    for (int l = 0; l < W; ++l) {
      x[k].v[l] = low[l] < W ? a[low[l]] : b[low[l] - W];
      x[k + H].v[l] = high[l] < W ? a[high[l]] : b[high[l] - W];
    }
#else
    x[k].v = __builtin_shuffle(a, b, low);
    x[k + H].v = __builtin_shuffle(a, b, high);
#endif
  }
  if constexpr (H > 1) exchange<H / 2>(x);
}
}  // namespace detail

/// Transposes W packs in place: exchanges element l of x[k] with element k of x[l].
template <int W, class E>
inline void transpose(Pack<W, E>* x) {
  if constexpr (W > 1) detail::exchange<W / 2>(x);
}

/// The largest angles [rad] for which sin_cos computes results; it returns NaN for larger angles. Errors are at most
/// one unit in the last place for doubles and two for floats.
inline constexpr double kLargestAngle = 1e6, kLargestFloatAngle = 1e3;

namespace detail {
/// Computes sine s and cosine c of an angle from those of its remainder in `quadrant`; NaN where `known` is false.
template <int W, class E>
[[gnu::always_inline]] inline void turn(typename Pack<W, E>::Int quadrant, typename Pack<W, E>::Mask known,
                                        Pack<W, E> sine, Pack<W, E> cosine, Pack<W, E>& s, Pack<W, E>& c) {
  using P = Pack<W, E>;
  const auto where = [&quadrant](typename P::Bits bit) {
    if constexpr (W == 1)
      return typename P::Mask{(quadrant & bit) ? typename P::Bits(-1) : typename P::Bits(0)};
    else
      return typename P::Mask{(typename P::Int)((quadrant & bit) != 0)};
  };
  const auto swapped = where(1);
  const P sq = select(swapped, cosine, sine), cq = select(swapped, sine, cosine);
  s = select(where(2), -sq, sq);
  c = select(where(2), -cq, cq);
  c = select(swapped, -c, c);
  s = select(known, s, P(std::nan("")));
  c = select(known, c, P(std::nan("")));
}
}  // namespace detail

/// Computes sine and cosine of doubles. Source: fdlibm's k_sin.c, k_cos.c and the three-step reduction of e_rem_pio2.c
/// (Sun, 1993), here without branches.
template <int W>
[[gnu::always_inline]] inline void sin_cos(Pack<W> angle, Pack<W>& s, Pack<W>& c) {
  using P = Pack<W>;
  using Int = typename P::Int;
  // n = round(2 angle / pi) is also in the low bits of `shifted`. The remainder is angle - n pi/2 = y + tail
  const P shift = 6755399441055744.0;  // 1.5 * 2^52
  const P shifted = angle * P(6.36619772367581382433e-01) + shift;
  const P n = shifted - shift;
  const Int quadrant = P::to_bits(shifted.v);
  const P t = angle - n * P(1.57079632673412561417e+00);  // 33 bits of pi/2: this product and the next are exact
  P w = n * P(6.07710050630396597660e-11);
  const P r = t - w;
  w = n * P(2.02226624879595063154e-21) - ((t - r) - w);
  const P y = r - w, tail = (r - y) - w;

  const P z = y * y, h = P(0.5) * z;
  const auto horner = [&z](P sum, auto... rest) { return ((sum = multiply_add(z, sum, P(rest))), ...); };
  const P ps = horner(1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
                      -1.98412698298579493134e-04, 8.33333333332248946124e-03);
  const P v = z * y;
  const P sine = y - ((z * (P(0.5) * tail - v * ps) - tail) - v * P(-1.66666666666666324348e-01));
  const P pc = z * horner(-1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
                          2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02);
  const P one_less_h = P(1) - h;
  const P cosine = one_less_h + (((P(1) - one_less_h) - h) + (z * pc - y * tail));

  detail::turn(quadrant, absolute(angle) <= P(kLargestAngle), sine, cosine, s, c);
}

/// Computes sine and cosine of floats, accurate to two units in the last place. Source: Cephes' sinf.c, cosf.c
/// (Moshier), with three steps of reduction.
template <int W>
[[gnu::always_inline]] inline void sin_cos(Pack<W, float> angle, Pack<W, float>& s, Pack<W, float>& c) {
  using P = Pack<W, float>;
  using Int = typename P::Int;
  const P shift = 12582912.0;  // 1.5 * 2^23
  const P shifted = angle * P(0.636619772367581343) + shift, n = shifted - shift;
  const Int quadrant = P::to_bits(shifted.v);
  const P y = ((angle - n * P(1.5703125)) - n * P(4.837512969970703125e-4)) - n * P(7.549789948768648e-8), z = y * y;
  const P ps = multiply_add(multiply_add(P(-1.9515295891e-4), z, P(8.3321608736e-3)), z, P(-1.6666654611e-1));
  const P sine = multiply_add(ps * z, y, y);
  const P pc =
      multiply_add(multiply_add(P(2.443315711809948e-5), z, P(-1.388731625493765e-3)), z, P(4.166664568298827e-2));
  const P cosine = multiply_add(pc * z, z, P(1) - P(0.5) * z);
  detail::turn(quadrant, absolute(angle) <= P(kLargestFloatAngle), sine, cosine, s, c);
}

/// Computes sines and cosines of `count` angles of one robot, in groups of as many as a SIMD register has elements.
template <int count, class E>
inline void sin_cos(const Pack<1, E>* angle, Pack<1, E>* s, Pack<1, E>* c) {
#if defined __AVX512F__
  constexpr int W = 8;
#elif defined __AVX__
  constexpr int W = 4;
#else
  constexpr int W = 2;
#endif
  static_assert(count % W == 0);
  for (int k = 0; k < count; k += W) {
    Pack<W, E> sine, cosine;
    sin_cos(Pack<W, E>::load(&angle[k].v), sine, cosine);
    sine.store(&s[k].v);
    cosine.store(&c[k].v);
  }
}

}  // namespace manycontact

template <int W, class E>
struct Eigen::NumTraits<manycontact::Pack<W, E>> : Eigen::GenericNumTraits<E> {
  using Real = manycontact::Pack<W, E>;
  using NonInteger = Real;
  using Literal = Real;
  using Nested = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
