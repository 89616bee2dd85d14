#pragma once
// The data that models of one structure share.

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Known by its address alone.
struct ModelStructure {};

/// The one of a model, whose other fields finalize has filled.
std::shared_ptr<const ModelStructure> find_structure(const Model& model);

}  // namespace manycontact
