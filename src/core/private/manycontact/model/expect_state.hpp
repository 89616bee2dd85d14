#pragma once
#include <stdexcept>
#include <string>

#include "manycontact/model/rigid_bodies.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Throws std::invalid_argument "FUNCTION: WHAT has 3 numbers, expected 4" unless `given` equals `expected`.
inline void expect_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected) {
  if (given != expected)
    throw std::invalid_argument(std::string(function) + ": " + what + " has " + std::to_string(given) +
                                " numbers, expected " + std::to_string(expected));
}

/// Returns why q (nq numbers), called `what` in the text, is not a configuration, or "": a number is not finite, or the
/// norm of a floating joint's quaternion differs from 1 by more than `tolerance`.
std::string unusable_configuration(const char* what, const ConstVectorRef& q, const RigidBodies& bodies,
                                   double tolerance = tolerance::kQuaternion);

/// Throws std::invalid_argument "FUNCTION: WHAT ..." unless q has bodies.nq() numbers and is a configuration.
void expect_configuration(const char* function, const char* what, const ConstVectorRef& q, const RigidBodies& bodies);

/// Throws std::invalid_argument unless x has `size` numbers, all of them finite.
void expect_numbers(const char* function, const char* what, const ConstVectorRef& x, Eigen::Index size);

}  // namespace manycontact
