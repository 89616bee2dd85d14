#pragma once
// A scene and its state are made of bytes: any bytes make one, and a changed byte changes little.

#include <cstddef>
#include <cstdint>

#include "manycontact/model/scene.hpp"

namespace manycontact::fuzz {

struct MadeScene {
  Scene scene;
  Eigen::VectorXd q, v, u;
  int wild = 0;  // 0: numbers of moderate size; 1: 1e-6 to 1e6, too; 2: any
};

/// Returns up to three robots of up to eight joints, with up to eight contacts.
MadeScene scene_of_bytes(const std::uint8_t* data, std::size_t size);

}  // namespace manycontact::fuzz
