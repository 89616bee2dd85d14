#pragma once
// Weights of contact rows: 1 for translational rows, Scene::moment_length for rotational rows. They affect least-norm
// forces and least squares of inconsistent rows, but not solutions of independent rows. If rows may be dependent, the
// contact rows of K and b are multiplied by the diagonal matrix S of these weights, and K's unknown y is -S^-1 f.

#include <cmath>
#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

/// Whether damping and moment_length are valid. check_input reports an invalid number.
inline bool usable_numbers(const Scene& scene) {
  return scene.damping >= 0 && std::isfinite(scene.damping) && scene.moment_length > 0 &&
         std::isfinite(scene.moment_length);
}

/// Returns the weight of a contact's row: 1 with damping (rows need not be dropped) and for pairs (weighted already).
inline double row_unit(const Scene& scene, const Contact& contact, int row) {
  return row < 3 || scene.damping > 0 || contact.pair ? 1 : scene.moment_length;
}

/// Whether the weight of any row is not 1. If so, dependent rows can be dropped only from the whole, weighted K.
inline bool has_row_units(const Scene& scene, std::span<const int> contacts) {
  if (scene.damping > 0 || scene.moment_length == 1) return false;
  for (int c : contacts)
    if (scene.contacts[c].rows() > 3 && !scene.contacts[c].pair) return true;
  return false;
}

/// Whether systems other than the whole K may drop dependent rows: without damping, and with all weights 1.
inline bool may_drop_rows(const Scene& scene, std::span<const int> contacts) {
  return scene.damping == 0 && !has_row_units(scene, contacts);
}

}  // namespace manycontact::internal
