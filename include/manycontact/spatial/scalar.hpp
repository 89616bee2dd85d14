#pragma once
// Scalars and fixed-size matrices.
//
// The forward path is templated on the scalar: double for use, quadruple precision as the truth that tests and
// charts measure against. Its templates live in .cpp files, instantiated there for InstantiatedScalar; the library
// manycontact_quad compiles the same files with MANYCONTACT_QUAD defined.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "manycontact/abi.hpp"

#ifdef MANYCONTACT_QUAD
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/float128.hpp>
#endif

namespace manycontact {

#ifdef MANYCONTACT_QUAD
using Quad = boost::multiprecision::number<boost::multiprecision::float128_backend, boost::multiprecision::et_off>;
using InstantiatedScalar = Quad;
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
template <class S> using ConstVecRef = Eigen::Ref<const VecX<S>>;
template <class S> using VecRef = Eigen::Ref<VecX<S>>;
// clang-format on

}  // namespace manycontact
