#pragma once
#include "manycontact/model/rigid_bodies.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// What keeps q (nq numbers) from being a configuration of these robots, in words: a number that is not finite, the
/// quaternion of a floating joint that is further than `tolerance` from unit length. "" where it is one.
/// what: "q". tolerance: by default solve's.
std::string unusable_configuration(const char* what, const ConstVectorRef& q, const RigidBodies& bodies,
                                   double tolerance = tolerance::kQuaternion);

/// Throws std::invalid_argument "FUNCTION: WHAT ..." unless q has bodies.nq() numbers and is a configuration.
void expect_configuration(const char* function, const char* what, const ConstVectorRef& q, const RigidBodies& bodies);

/// Throws std::invalid_argument unless x has `size` numbers, all of them finite.
void expect_numbers(const char* function, const char* what, const ConstVectorRef& x, Eigen::Index size);

}  // namespace manycontact
