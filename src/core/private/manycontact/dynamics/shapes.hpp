#pragma once
// Access to the structural analyses of a scene's islands (IslandShape of kkt/shape.hpp).

#include <string>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/kkt/matrix.hpp"

namespace manycontact {

/// Returns the shape of island i: its trees and contacts, and their analyses. Throws the exceptions that functions of
/// dynamics/views.hpp throw for a wrong island.
const std::shared_ptr<IslandShape>& shape_of(const SceneData& data, std::size_t i);
/// Returns the coordinates of J's columns for each contact of island i, as solved_island numbers them.
const IslandSupport& island_support_of(const Scene& scene, const SceneData& data, std::size_t i);
/// Returns K of island i at the last solve, in the chosen elimination order or, if the island's report has
/// changed_order, in the order leaf-to-root.
const KktMatrix& assembled_matrix_of(const Scene& scene, const SceneData& data, std::size_t i);
/// Return the scene and the data that are actually solved. These are the reduced ones if contacts between two bodies
/// are reduced (Options::reduce_pairs), otherwise the arguments. shape_of and chosen_method number islands as this
/// scene.
const Scene& scene_solved(const Scene& scene, const SceneData& data);
const SceneData& data_solved(const SceneData& data);
/// Returns the attempts to solve island i, in order: "robot by robot in SIMD batches; sparse-ldl in leaf-to-root order;
/// sparse-ldl in leaf-to-root order without dependent rows; dense".
std::string ways_of(const Scene& scene, const SceneData& data, std::size_t i);

}  // namespace manycontact
