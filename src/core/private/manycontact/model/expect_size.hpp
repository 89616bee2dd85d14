#pragma once
#include <stdexcept>
#include <string>

#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

/// Throws std::invalid_argument "FUNCTION: WHAT has 3 numbers, expected 4" unless they are equal.
inline void expect_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected) {
  if (given != expected)
    throw std::invalid_argument(std::string(function) + ": " + what + " has " + std::to_string(given) +
                                " numbers, expected " + std::to_string(expected));
}

}  // namespace manycontact
