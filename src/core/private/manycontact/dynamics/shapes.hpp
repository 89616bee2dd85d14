#pragma once
// The analyses that a scene's islands rest on (kkt/shape.hpp), to be looked at.

#include <string>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/kkt/matrix.hpp"

namespace manycontact {

/// The island's trees and contacts, with the analyses made of them. Throws as views.hpp does.
const std::shared_ptr<IslandShape>& shape_of(const SceneData& data, std::size_t i);
/// The coordinates of J's columns, for each contact of solved_island; after complete.
const IslandSupport& island_support_of(const Scene& scene, const SceneData& data, std::size_t i);
/// K of an island as solved last, in the choice's order or, where report.changed_order, leaf-to-root.
const KktMatrix& assembled_matrix_of(const Scene& scene, const SceneData& data, std::size_t i);
/// Return the scene and data that are actually solved. If contacts between the same two bodies are reduced to one
/// (Options::reduce_pairs), these differ from the arguments; otherwise they are the arguments. shape_of and
/// chosen_method refer to their islands.
const Scene& scene_solved(const Scene& scene, const SceneData& data);
const SceneData& data_solved(const SceneData& data);
/// The ways in which `solve` tries to solve an island, in their order: "robot by robot in SIMD batches; sparse-ldl in
/// leaf-to-root order; sparse-ldl in leaf-to-root order without dependent rows; dense".
std::string ways_of(const Scene& scene, const SceneData& data, std::size_t i);

}  // namespace manycontact
