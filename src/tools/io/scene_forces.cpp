#include "manycontact/algorithm/applied_forces.hpp"
#include "scene_parts.hpp"

namespace manycontact::io {
namespace {

Vec3<double> three(const Element& e, const char* attribute) {
  Vec3<double> x = Vec3<double>::Zero();
  (void)e.read(attribute, x);
  return x;
}

SE3<double> offset(const Element& e, const char* attribute) {
  SE3<double> at;
  at.p = three(e, attribute);
  return at;
}

// Returns the element's name, or `otherwise` if it has no name. If `copied`, the number of the copy is appended.
std::string name_of(const Element& e, const std::string& otherwise, bool copied, int copy) {
  if (!e.has("name")) return otherwise;
  const std::string name = e.not_empty("name");
  return copied ? name + std::to_string(copy) : name;
}

std::string frame_name(const SceneFile& file, const Attachment& at) {
  return file.scene.robots[at.robot].name + "/" + at.frame;
}

}  // namespace

void add_wrenches(const std::vector<Element>& elements, SceneFile& out) {
  EndReader ends(out);
  for (const Element& e : elements) {
    e.allow({"name", "frame", "offset", "force", "torque", "reference_frame"});
    const End end = ends.read_first(e, "frame");
    for (int i = 0; i < end.count; ++i) {
      ExternalWrench push;
      push.at = end.on(end.first + i, offset(e, "offset"));
      push.name = name_of(e, frame_name(out, push.at), end.copied, i);
      push.reference_frame = read_reference_frame(e);
      const Vec3<double> force = three(e, "force"), torque = three(e, "torque");
      push.wrench << force, torque;
      add_or_fail(e, [&] { add_external_wrench(out.scene, std::move(push)); });
    }
  }
}

void add_springs(const std::vector<Element>& elements, SceneFile& out) {
  EndReader ends(out);
  for (const Element& e : elements) {
    e.allow({"name", "frame", "offset", "to", "to_offset", "wrap", "xyz", "stiffness", "length", "damping"});
    const EndPair pair = ends.read_pair(e);
    if (pair.to_robot == e.has("xyz"))
      e.fail(pair.to_robot ? "<spring> has both 'to' and xyz, expected either 'to' or xyz"
                           : "<spring> has neither 'to' nor xyz, expected a frame or a point of the world");
    for (const char* a : {"to_offset", "wrap"})
      if (!pair.to_robot && e.has(a)) e.refuse(a, " needs a target, expected also a 'to' attribute");
    Spring like;
    (void)e.required_number("stiffness");
    like.stiffness = e.number_from_0("stiffness", 0);
    like.length = e.number_from_0("length", 0);
    like.damping = e.number_from_0("damping", 0);
    for (int i = 0; i < pair.A.count; ++i) {
      const std::optional<int> target = pair.target(i);
      if (!target) continue;
      Spring spring = like;
      spring.A = pair.A.on(pair.A.first + i, offset(e, "offset"));
      std::string to = "the world";
      if (pair.to_robot)
        spring.B = pair.B.on(*target, offset(e, "to_offset")), to = frame_name(out, spring.B);
      else
        spring.B.placement.p = three(e, "xyz");
      spring.name = name_of(e, frame_name(out, spring.A) + " to " + to, pair.A.copied, i);
      if (!e.has("length")) spring.length = spring_length(out.scene, out.q, spring);
      add_or_fail(e, [&] {
        const int number = add_spring(out.scene, std::move(spring));
        if (!e.has("length")) out.open_lengths.push_back(number);
      });
    }
  }
}

void add_joint_springs(const std::vector<Element>& robots, SceneFile& out) {
  for (std::size_t g = 0; g < robots.size(); ++g) {  // robot_groups has one entry per <robot> element
    const RobotGroup& group = out.robot_groups[g];
    for (const Element& joint : robots[g].children("joint")) {
      if (joint.has("rest") && !joint.has("stiffness"))
        joint.refuse("rest", " needs a spring, expected also a 'stiffness' attribute");
      if (!joint.has("stiffness")) continue;
      const double stiffness = joint.number_from_0("stiffness", 0), rest = joint.number("rest", 0);
      for (int i = 0; i < group.count; ++i)
        add_or_fail(joint, [&] {
          add_joint_spring(out.scene, out.scene.robots[group.first + i].name, joint.required("name"), stiffness, rest);
        });
    }
  }
}

}  // namespace manycontact::io
