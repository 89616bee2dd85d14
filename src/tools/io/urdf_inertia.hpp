#pragma once
// Whether a moving body's inertia is one that something can be computed with, and one that a body can have.

#include <string>

#include "manycontact/spatial/inertia.hpp"

namespace manycontact::io {

/// Both return a description, or nothing if there is no fault. The text continues "link x and what is merged into it
/// have".
struct InertiaVerdict {
  std::string refused;  // not finite, a negative mass, a principal moment below -1e-9 of the trace
  std::string odd;      // principal moments that violate the triangle inequality; they are used as they are
};

/// Y: of the body with all that is merged into it, about any origin. Massless bodies are ideal ones: a rotor about one
/// axis is allowed. (What is merged first may be anything: Talos' gripper motors alone lack 1.3 % of their trace.)
InertiaVerdict judge_inertia(const Inertia<double>& Y);

}  // namespace manycontact::io
