#pragma once
// Tiles of N values: doubles in SIMD registers, or packs with one double per robot of a SIMD batch. This header is
// compiled for several SIMD levels, so it has templates and plain memory only and includes no other library.

#include <cstddef>
#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace manycontact::sparse {

/// Returns a b + c, fused if the processor supports it.
inline double multiply_add(double a, double b, double c) {
#ifdef __FMA__
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}
inline double subtract_product(double a, double b, double c) { return multiply_add(-a, b, c); }
inline double absolute(double x) { return __builtin_fabs(x); }
inline float multiply_add(float a, float b, float c) {
#ifdef __FMA__
  return __builtin_fmaf(a, b, c);
#else
  return a * b + c;
#endif
}
inline float subtract_product(float a, float b, float c) { return multiply_add(-a, b, c); }
inline float absolute(float x) { return __builtin_fabsf(x); }

namespace kernel {

template <class V, int N>
struct Tile {
  V v[N];

  static Tile load(const V* x) {
    Tile t;
    for (int k = 0; k < N; ++k) t.v[k] = x[k];
    return t;
  }
  static Tile all(const V& s) {
    Tile t;
    for (int k = 0; k < N; ++k) t.v[k] = s;
    return t;
  }
  void store(V* x) const {
    for (int k = 0; k < N; ++k) x[k] = v[k];
  }
  void add(const V& l, const V* x) {  // this tile += l x
    for (int k = 0; k < N; ++k) v[k] = multiply_add(l, x[k], v[k]);
  }
  void add(const Tile& a, const Tile& b) {  // this tile += a b, element by element
    for (int k = 0; k < N; ++k) v[k] = multiply_add(a.v[k], b.v[k], v[k]);
  }
  void subtract(const V& l, const Tile& x) {  // this tile -= l x
    for (int k = 0; k < N; ++k) v[k] = subtract_product(l, x.v[k], v[k]);
  }
  Tile times(const V& s) const {
    Tile t;
    for (int k = 0; k < N; ++k) t.v[k] = v[k] * s;
    return t;
  }
};

#if defined(__AVX512F__)
constexpr int kRegister = 8;
#elif defined(__AVX__)
constexpr int kRegister = 4;
#else
constexpr int kRegister = 2;
#endif

template <int N>
struct Register;
template <>
struct Register<2> {
  typedef double Vector __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct Register<4> {
  typedef double Vector __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct Register<8> {
  typedef double Vector __attribute__((vector_size(64), aligned(8), may_alias));
};

template <int N>
requires(N > 1) struct Tile<double, N> {
  // Tiles of at most 8 doubles are soon loaded again, shifted by one row. An 8-wide load would wait for two stores.
  static constexpr int kWidest = N <= 8 && kRegister == 8 ? 4 : kRegister;
  static constexpr int kWidth = N < kWidest ? N : kWidest, kVectors = N / kWidth;
  using Vector = typename Register<kWidth>::Vector;
  Vector v[kVectors];

  static Vector fused(Vector a, Vector b, Vector c) {
#ifdef __FMA__
    if constexpr (kWidth == 2) return (Vector)_mm_fmadd_pd((__m128d)a, (__m128d)b, (__m128d)c);
    if constexpr (kWidth == 4) return (Vector)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#ifdef __AVX512F__
    if constexpr (kWidth == 8) return (Vector)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#endif
#endif
    return a * b + c;
  }
  static Vector fused_away(Vector a, Vector b, Vector c) {  // c - a b, fused if the processor supports it
#ifdef __FMA__
    if constexpr (kWidth == 2) return (Vector)_mm_fnmadd_pd((__m128d)a, (__m128d)b, (__m128d)c);
    if constexpr (kWidth == 4) return (Vector)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#ifdef __AVX512F__
    if constexpr (kWidth == 8) return (Vector)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#endif
#endif
    return c - a * b;
  }
  static Vector at(const double* x, int k) { return *reinterpret_cast<const Vector*>(x + kWidth * k); }
  static Vector every(double s) {
    if constexpr (kWidth == 2) return Vector{s, s};
    if constexpr (kWidth == 4) return Vector{s, s, s, s};
    if constexpr (kWidth == 8) return Vector{s, s, s, s, s, s, s, s};  // compiled to one instruction, unlike a loop
  }

  static Tile load(const double* x) {
    Tile t;
    for (int k = 0; k < kVectors; ++k) t.v[k] = at(x, k);
    return t;
  }
  static Tile all(double s) {
    Tile t;
    for (int k = 0; k < kVectors; ++k) t.v[k] = every(s);
    return t;
  }
  void store(double* x) const {
    for (int k = 0; k < kVectors; ++k) *reinterpret_cast<Vector*>(x + kWidth * k) = v[k];
  }
  /// Stores the tile past the caches. x: aligned to a register. Other threads see the values after finish_streams.
  void stream(double* x) const {
#ifdef __SSE2__
    for (int k = 0; k < kVectors; ++k) {
      if constexpr (kWidth == 2) _mm_stream_pd(x + kWidth * k, (__m128d)v[k]);
#ifdef __AVX__
      if constexpr (kWidth == 4) _mm256_stream_pd(x + kWidth * k, (__m256d)v[k]);
#endif
#ifdef __AVX512F__
      if constexpr (kWidth == 8) _mm512_stream_pd(x + kWidth * k, (__m512d)v[k]);
#endif
    }
#else
    store(x);
#endif
  }
  void add(double l, const double* x) {
    const Vector s = every(l);
    for (int k = 0; k < kVectors; ++k) v[k] = fused(s, at(x, k), v[k]);
  }
  void add(const Tile& a, const Tile& b) {
    for (int k = 0; k < kVectors; ++k) v[k] = fused(a.v[k], b.v[k], v[k]);
  }
  void subtract(double l, const Tile& x) {
    const Vector s = every(l);
    for (int k = 0; k < kVectors; ++k) v[k] = fused_away(s, x.v[k], v[k]);
  }
  Tile times(double s) const {
    Tile t;
    for (int k = 0; k < kVectors; ++k) t.v[k] = v[k] * s;
    return t;
  }
};

inline void finish_streams() {
#ifdef __SSE2__
  _mm_sfence();
#endif
}

/// Prefetches the same entries of the next matrix, which has the same pattern and is `bytes` further in memory.
struct PrefetchNext {
  std::ptrdiff_t bytes;
  template <class V>
  void fetch(const V* x) const {
    __builtin_prefetch(reinterpret_cast<const char*>(x) + bytes, 0, 2);
  }
  template <class V>
  void fetch_to_write(const V* x) const {
    __builtin_prefetch(reinterpret_cast<const char*>(x) + bytes, 1, 2);
  }
};
struct NoPrefetch {
  template <class V>
  void fetch(const V*) const {}
  template <class V>
  void fetch_to_write(const V*) const {}
};

template <class V>
inline constexpr int kRows = 4;  // rows that are computed at a time; chunks of half the size, and so on, take the rest
template <>
inline constexpr int kRows<double> = 8;

template <int N>
struct Size {  // a number as a type
  static constexpr int value = N;
};
template <int N, class F>
inline void in_chunks(int begin, int end, F&& f) {  // calls f(first, Size<n>) for n = N, N/2, ..., 1
  for (; end - begin >= N; begin += N) f(begin, Size<N>{});
  if constexpr (N > 1) in_chunks<N / 2>(begin, end, f);
}

}  // namespace kernel

}  // namespace manycontact::sparse
