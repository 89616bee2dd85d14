#pragma once
// The scalar S of templates, and Eigen types with this scalar.
//
// The computations from kinematics to the solution are templates on S: double, quadruple precision (reference values of
// tests and charts) or packs (SIMD batches, detail/spatial/pack.hpp). The templates are defined in .cpp files, and
// instantiated there for InstantiatedScalar. The library manycontact_quad compiles these files with MANYCONTACT_QUAD
// defined, and each SIMD level compiles them with MANYCONTACT_LANES.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#ifdef MANYCONTACT_LANES
#include "manycontact/detail/spatial/pack.hpp"
#else
#include "manycontact/abi.hpp"
#endif

#ifdef MANYCONTACT_QUAD
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/float128.hpp>
#endif

namespace manycontact {

#ifdef MANYCONTACT_QUAD
using Quad = boost::multiprecision::number<boost::multiprecision::float128_backend, boost::multiprecision::et_off>;
using InstantiatedScalar = Quad;
#elif defined MANYCONTACT_LANES
using InstantiatedScalar = Pack<MANYCONTACT_LANES>;
#else
using InstantiatedScalar = double;
#endif

// clang-format off
template <class S> using Vec3 = Eigen::Matrix<S, 3, 1>;
template <class S> using Vec6 = Eigen::Matrix<S, 6, 1>;
template <class S> using Mat3 = Eigen::Matrix<S, 3, 3>;
template <class S> using Mat6 = Eigen::Matrix<S, 6, 6>;
template <class S> using VecX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S> using MatX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <class S> using Mat6X = Eigen::Matrix<S, 6, Eigen::Dynamic>;
// These types repeat Eigen's default strides, because clang and GCC mangle a default differently. Without this, objects
// of both compilers would not link.
template <class S> using ConstVecRef = Eigen::Ref<const VecX<S>, 0, Eigen::InnerStride<1>>;
template <class S> using VecRef = Eigen::Ref<VecX<S>, 0, Eigen::InnerStride<1>>;
using ConstVectorRef = ConstVecRef<double>;
using VectorRef = VecRef<double>;
template <class S> using MatRef = Eigen::Ref<MatX<S>, 0, Eigen::OuterStride<>>;
template <class S> using Mat6XRef = Eigen::Ref<Mat6X<S>, 0, Eigen::OuterStride<>>;
// clang-format on

/// Computes sine s and cosine c of an angle [rad].
template <class S>
void sin_cos(const S& angle, S& s, S& c) {
  using std::cos;
  using std::sin;
  const S x = angle, sine = sin(x);  // x is a copy, since s may alias angle; the compiler can combine both calls
  c = cos(x);
  s = sine;
}
/// The number of angles that one call of sin_cos gets. With Pack<1>, a single robot, the angles fill SIMD registers
/// (detail/spatial/pack.hpp).
template <class S>
inline constexpr int kAngles = 1;
#ifdef MANYCONTACT_LANES
template <int W>
inline constexpr int kAngles<Pack<W>> = W == 1 ? 8 : 4;
#endif
/// Computes sines s and cosines c of `count` angles [rad].
template <int count, class S>
void sin_cos(const S* angle, S* s, S* c) {
  for (int k = 0; k < count; ++k) sin_cos(angle[k], s[k], c[k]);
}
/// Returns a b + c.
template <class S>
S multiply_add(const S& a, const S& b, const S& c) {
  return a * b + c;
}
/// Returns a if `holds` is true, otherwise b.
template <class S>
S select(bool holds, const S& a, const S& b) {
  return holds ? a : b;
}
/// Returns |x|.
template <class S>
S absolute(const S& x) {
  using std::abs;
  return abs(x);
}
/// Returns the larger of a and b.
template <class S>
S larger(const S& a, const S& b) {
  return a > b ? a : b;
}

}  // namespace manycontact
