#pragma once
// Access to the structural analyses of a scene's islands (IslandShape of kkt/shape.hpp).

#include <string>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/kkt/matrix.hpp"

namespace manycontact {

/// Returns the shape of an island: its trees and contacts, and their analyses. Throws as functions of views.hpp do.
const std::shared_ptr<IslandShape>& shape_of(const SceneData& data, std::size_t i);
/// Returns the coordinates of J's columns for each contact of solved_island.
const IslandSupport& island_support_of(const Scene& scene, const SceneData& data, std::size_t i);
/// Returns K of an island at the last solve, in the chosen elimination order or, if report.changed_order, leaf-to-root.
const KktMatrix& assembled_matrix_of(const Scene& scene, const SceneData& data, std::size_t i);
/// Return the scene and data that are actually solved: the reduced ones if contacts between two bodies are reduced
/// (Options::reduce_pairs), else the arguments. Islands of shape_of and chosen_method are those of this scene.
const Scene& scene_solved(const Scene& scene, const SceneData& data);
const SceneData& data_solved(const SceneData& data);
/// Lists the attempts to solve an island, in order: "robot by robot in SIMD batches; sparse-ldl in leaf-to-root order;
/// sparse-ldl in leaf-to-root order without dependent rows; dense".
std::string ways_of(const Scene& scene, const SceneData& data, std::size_t i);

}  // namespace manycontact
