#pragma once
// The axes that a reference frame's motions are in.

#include "manycontact/algorithm/frames.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

inline FrameAxes axes_of(ReferenceFrame frame) {
  return frame == ReferenceFrame::kLocal   ? FrameAxes::kLocal
         : frame == ReferenceFrame::kWorld ? FrameAxes::kWorld
                                           : FrameAxes::kLocalWorldAligned;
}

}  // namespace manycontact
