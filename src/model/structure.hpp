#pragma once
// What models of one structure have in common.

#include "manycontact/model/model.hpp"

namespace manycontact {

struct ModelStructure {
  std::vector<double> key;
};

/// The one of a model, whose other fields finalize has filled: the same for all that are alive and equal in it.
std::shared_ptr<const ModelStructure> find_structure(const Model& model);

}  // namespace manycontact
