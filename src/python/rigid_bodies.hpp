#pragma once
// Arguments of rigid-body functions in Python. Bodies are a Scene, a Model or RigidBodies; frames can be given by name.

#include <variant>

#include "manycontact/model/rigid_bodies.hpp"
#include "objects.hpp"

namespace manycontact::python {

struct Bodies {  // the bodies that a function was called with, and the Python object that keeps them alive
  std::shared_ptr<void> keeper;
  std::optional<RigidBodies> view;
};

/// A frame, given by its name or as an Attachment, or a joint, given by its name.
using FrameName = std::variant<std::string, Attachment>;
inline Attachment frame_in(const RigidBodies& bodies, const FrameName& frame) {
  const auto* name = std::get_if<std::string>(&frame);
  return name ? find_frame(bodies, *name) : std::get<Attachment>(frame);
}

}  // namespace manycontact::python

namespace pybind11::detail {

template <>
struct type_caster<manycontact::RigidBodies> {
  static constexpr auto name = const_name("Union[manycontact.Scene, manycontact.Model, manycontact.RigidBodies]");
  template <class>
  using cast_op_type = const manycontact::RigidBodies&;

  bool load(handle source, bool convert) {
    using namespace manycontact;
    make_caster<std::shared_ptr<python::Bodies>> bodies;
    make_caster<std::shared_ptr<Scene>> scene;
    make_caster<std::shared_ptr<Model>> model;
    if (source.is_none()) return false;
    if (bodies.load(source, convert)) {
      view_.emplace(*cast_op<std::shared_ptr<python::Bodies>&>(bodies)->view);
    } else if (scene.load(source, convert)) {
      view_.emplace(*cast_op<std::shared_ptr<Scene>&>(scene));
    } else if (model.load(source, convert)) {
      view_.emplace(*cast_op<std::shared_ptr<Model>&>(model));
    } else {
      return false;
    }
    return true;
  }
  operator const manycontact::RigidBodies&() { return *view_; }

 private:
  std::optional<manycontact::RigidBodies> view_;
};

}  // namespace pybind11::detail
