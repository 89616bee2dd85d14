#pragma once
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Moves B' of `contact` onto A at configuration q (the scene's nq), so that the placement error is zero: its origin
/// when `position`, its axes when `orientation`. contact: as for add_contact, before or after it. Throws
/// std::invalid_argument unless q has scene.nq numbers.
void resolve_reference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, bool position, bool orientation,
                       Contact& contact);

/// The same for every contact of the scene, origin and axes: at q they all hold. What files leave out is resolved so.
/// SceneData in use see the new places.
void resolve_references(Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace manycontact
