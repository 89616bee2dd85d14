#pragma once
// Weights of contact rows of motion and of rotation (Scene::moment_length). Forces of least norm and least squares of
// inconsistent rows depend on them, solutions of independent rows do not. Where rows may depend, contact rows of K and
// b are multiplied by S = diag(1, or the length for rows that rotate), and K's unknown y is -f divided by S.

#include <cmath>
#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

/// Whether the scene's own numbers can be used at all (check_input reports which cannot).
inline bool usable_numbers(const Scene& scene) {
  return scene.damping >= 0 && std::isfinite(scene.damping) && scene.moment_length > 0 &&
         std::isfinite(scene.moment_length);
}

/// Unit of a contact's row: 1 for every row with damping, which makes all of them independent, and for a pair's, which
/// are weighed already.
inline double row_unit(const Scene& scene, const Contact& contact, int row) {
  return row < 3 || scene.damping > 0 || contact.pair ? 1 : scene.moment_length;
}

/// Whether any is not 1: rows that depend on each other are then dropped from the whole K alone, which is weighed where
/// they may be (dependent rows, the dense reference solver).
inline bool has_row_units(const Scene& scene, std::span<const int> contacts) {
  if (scene.damping > 0 || scene.moment_length == 1) return false;
  for (int c : contacts)
    if (scene.contacts[c].rows() > 3 && !scene.contacts[c].pair) return true;
  return false;
}

/// Whether rows that depend may be dropped from anything but the whole K: nothing damps them, and all count the same.
inline bool may_drop_rows(const Scene& scene, std::span<const int> contacts) {
  return scene.damping == 0 && !has_row_units(scene, contacts);
}

}  // namespace manycontact::internal
