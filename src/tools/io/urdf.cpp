#include "manycontact/io/urdf.hpp"

#include <algorithm>
#include <cmath>

#include "urdf_inertia.hpp"
#include "urdf_robot.hpp"

namespace manycontact {
namespace {

using io::UrdfJoint;
using io::UrdfLink;
using io::UrdfRobot;

// The smallest rotation that takes z to the unit vector a (about x when a = -z).
Mat3<double> rotation_from_z(const Vec3<double>& a) {
  const double s2 = a.x() * a.x() + a.y() * a.y();
  if (s2 == 0) return a.z() > 0 ? Mat3<double>::Identity() : Mat3<double>(Vec3<double>(1, -1, -1).asDiagonal());
  const Vec3<double> v(-a.y(), a.x(), 0);  // z x a
  const double k = a.z() > 0 ? 1 / (1 + a.z()) : (1 - a.z()) / s2;
  const Mat3<double> V = skew<double>(v);
  return Mat3<double>::Identity() + V + k * V * V;
}

JointType type_of(const UrdfJoint& joint) {
  switch (joint.type) {
    case UrdfJoint::kPrismatic:
      return JointType::kPrismatic;
    case UrdfJoint::kFloating:
      return JointType::kFloating;
    case UrdfJoint::kPlanar:
      return JointType::kPlanar;
    default:
      return JointType::kRevolute;
  }
}

// from: of the file; none: no limits.
void set_limits(Joint& out, const UrdfJoint& from = {}) {
  const auto all = [&](double x) { return Eigen::VectorXd::Constant(out.nv(), x); };
  out.lower = all(from.lower);
  out.upper = all(from.upper);
  out.velocity_limit = all(from.velocity);
  out.effort_limit = all(from.effort);
}

// The placement of a link's frame on a joint's body (-1: the immovable base).
struct Place {
  int joint = -1;
  SE3<double> placement;
};

// Builds a Model from the file's tree: walks it depth first, merging as it goes.
class Builder {
 public:
  Builder(UrdfRobot& robot, const UrdfOptions& options, const std::string& path)
      : robot_(robot), options_(options), path_(path) {}

  Model build() {
    model_.name = robot_.name;
    model_.floating_base = options_.floating_base;
    check_locks();
    std::vector<Step> stack{{&root_link()}};  // a chain of links may be longer than the machine's stack
    while (!stack.empty()) {
      const Step step = stack.back();
      stack.pop_back();
      const Place place = step.joint ? cross(step) : root(*step.link);
      const UrdfLink& link = robot_.links.at(*step.link);
      add_link(*step.link, link, place);
      const std::size_t first = stack.size();
      for (const UrdfJoint* joint : link.below)
        if (joint != step.joint) stack.push_back({&joint->child, joint, place});
      if (link.above && link.above != step.joint) stack.push_back({&link.above->parent, link.above, place, true});
      std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end(),
                [](const Step& a, const Step& b) { return a.joint->name > b.joint->name; });  // the last is next
    }
    for (int i = 0; i < model_.njoints(); ++i) judge(i);
    set_passive();
    try {
      finalize(model_);
    } catch (const std::invalid_argument& e) {
      throw InputError(path_, robot_.line, std::string(e.what()) + ", expected a shallower one");
    }
    set_armature();
    if (options_.model_dynamics) set_dynamics();
    set_joint_damping();
    return std::move(model_);
  }

 private:
  // A step from a placed link over a joint to another link. backwards: from the file's child to its parent.
  struct Step {
    const std::string* link;
    const UrdfJoint* joint = nullptr;  // null: the step to the root
    Place from = {};
    bool backwards = false;
  };

  const std::string& root_link() const {
    if (options_.root.empty()) return robot_.root;
    const auto found = robot_.links.find(options_.root);
    if (found != robot_.links.end()) return found->first;
    std::vector<std::string> names;
    for (const auto& [name, link] : robot_.links) names.push_back(name);
    throw UrdfOptionError(
        "", false,
        "the robot has no link " + quote(options_.root) + " for its root, " + suggestion(options_.root, names));
  }

  Place root(const std::string& link) {
    if (!options_.floating_base) return {};
    Joint base;
    base.name = "root";
    while (robot_.joints.count(base.name)) base.name += "_";
    base.type = JointType::kFloating;
    set_limits(base);
    return {append(std::move(base), link), {}};
  }

  // A joint moves its child by T(q) in the frame X of its parent: oMchild = oMparent X T(q). In the other direction
  // oMparent = oMchild T(q)^-1 X^-1, where T(q)^-1 is the motion by q about or along -axis.
  Place cross(const Step& step) {
    const UrdfJoint& joint = *step.joint;
    const Place& parent = step.from;
    const SE3<double> X = joint.placement, none;
    const SE3<double> at = parent.placement * (step.backwards ? none : X), behind = step.backwards ? X.inverse() : none;
    const double sign = step.backwards ? -1 : 1;
    const auto lock = options_.locked.find(joint.name);
    if (joint.type == UrdfJoint::kFixed) {
      model_.notes.merged.push_back(joint.name);
      return {parent.joint, at * behind};
    }
    if (lock != options_.locked.end()) {
      model_.notes.locked.push_back(joint.name);
      return {parent.joint, at * motion(joint, sign * lock->second) * behind};
    }
    note(joint, parent);
    Joint out;
    out.name = joint.name;
    out.type = type_of(joint);
    out.parent = parent.joint;
    out.placement = at;
    if (step.backwards && out.nv() > 1)
      throw UrdfOptionError("", false,
                            "joint " + quote(joint.name) + " has several coordinates and is between the file's root " +
                                quote(robot_.root) + " and " + quote(options_.root) +
                                ", expected a root on this side of it");
    SE3<double> link = behind;
    if (out.type == JointType::kPlanar) {  // z of the joint frame is the normal; the link keeps URDF's frame
      link.R = rotation_from_z(joint.axis).transpose();
      out.placement.R = at.R * link.R.transpose();
    } else if (out.type != JointType::kFloating) {
      out.axis = sign * joint.axis;
    }
    set_limits(out, joint);
    return {append(std::move(out), *step.link), link};
  }

  static SE3<double> motion(const UrdfJoint& joint, double q) {
    if (joint.type == UrdfJoint::kPrismatic) return {Mat3<double>::Identity(), Vec3<double>(q * joint.axis)};
    return {rotation_about<double>(joint.axis, q), Vec3<double>::Zero()};
  }

  int append(Joint joint, const std::string& link) {
    model_.joints.push_back(std::move(joint));
    body_link_.push_back(link);
    return model_.njoints() - 1;
  }

  void add_link(const std::string& name, const UrdfLink& link, const Place& place) {
    Frame frame;
    frame.name = name;
    if (link.above) frame.parent_joint = link.above->name;
    frame.joint = place.joint;
    frame.placement = place.placement;
    frame.merged = place.joint >= 0 && body_link_[place.joint] != name;
    if (link.inertia) frame.inertia = *link.inertia;
    if (place.joint >= 0 && frame.inertia.m < 0)
      tell("inertia", name, link.line,
           "the mass " + io::show(frame.inertia.m) + " kg, compensated by the bodies that the link is merged with");
    if (place.joint >= 0) model_.joints[place.joint].inertia += frame.inertia.transformed(place.placement);
    model_.frames.push_back(std::move(frame));
  }

  void tell(const char* kind, const std::string& name, int line, const std::string& text) {
    robot_.findings.push_back({kind, name, text, path_, line});
  }

  // Lists properties of a movable joint that are not modelled, or not as most users expect.
  void note(const UrdfJoint& joint, const Place& parent) {
    const auto refuse = [&](const std::string& what) { throw InputError(path_, joint.line, what); };
    if (joint.mimic) {
      if (options_.refuse_mimic)
        refuse("joint " + quote(joint.name) + " mimics " + quote(*joint.mimic) +
               ", expected none, for mimic=\"refuse\"");
      model_.notes.mimic.push_back(joint.name);
      tell("mimic", joint.name, joint.line, "<mimic> is not modelled: the joint moves independently");
    }
    if (joint.type == UrdfJoint::kFloating && options_.floating_base && parent.joint == 0)
      tell("base", joint.name, joint.line,
           "a floating joint below the floating base: two bases, expected base=\"fixed\" for this file");
    if (joint.damping == 0 && joint.friction == 0) return;
    if (!options_.model_dynamics) {
      model_.notes.dynamics.push_back(joint.name);
      return tell("dynamics", joint.name, joint.line, "damping and friction are not modelled");
    }
    for (const double x : {joint.damping, joint.friction}) {
      if (!std::isfinite(x))
        refuse("joint " + quote(joint.name) + " has the damping or friction " + io::show(x) +
               ", expected a finite number, for dynamics=\"model\"");
      if (x < 0)
        tell("dynamics", joint.name, joint.line,
             "the damping or friction " + io::show(x) + ", which drives the joint, is used as given");
    }
  }

  void judge(int i) {
    const std::string& link = body_link_[i];
    const int line = robot_.links.at(link).line;
    const io::InertiaVerdict verdict = io::judge_inertia(model_.joints[i].inertia);
    const std::string owner = "link " + quote(link) + " and what is merged into it have ";
    if (!verdict.refused.empty()) throw InputError(path_, line, owner + verdict.refused);
    if (verdict.odd.empty()) return;
    if (options_.refuse_inertia)
      throw InputError(path_, line, owner + verdict.odd + ", expected those of one, for inertia=\"refuse\"");
    tell("inertia", link, line,
         "the body, with what is merged into it, has " + verdict.odd + "; they are used as given");
  }

  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const auto& [name, joint] : robot_.joints) names.push_back(name);
    return names;
  }

  void check_locks() const {
    for (const auto& [name, position] : options_.locked) {
      const auto refuse = [&name](const std::string& what) { throw UrdfOptionError(name, true, what); };
      const std::string joint = "joint " + quote(name);
      const auto found = robot_.joints.find(name);
      if (found == robot_.joints.end())
        refuse("the robot has no " + joint + " to lock, " + suggestion(name, joint_names()));
      const auto type = found->second.type;
      if (type == UrdfJoint::kFixed) refuse(joint + " is fixed, expected one that moves, to lock");
      if (type == UrdfJoint::kFloating || type == UrdfJoint::kPlanar)
        refuse(joint + " has several coordinates, expected one with one, to lock");
      if (!std::isfinite(position)) refuse(joint + " is locked at no finite position, expected one");
    }
  }

  // A joint that an option names.
  Joint& moving_joint(const std::string& name) {
    const int i = model_.find_joint(name);
    if (i < 0) throw UrdfOptionError(name, false, why_absent(name));
    return model_.joints[i];
  }

  Joint& joint_with_torques(const std::string& name) {
    Joint& joint = moving_joint(name);
    if (model_.floating_base && &joint == &model_.joints[0])
      throw UrdfOptionError(name, false,
                            "joint " + quote(name) + " is the floating base, which has no torques, expected another");
    return joint;
  }

  // No motors carry a body in the air: a floating joint of the file is passive unless the options specify otherwise.
  void set_passive() {
    for (int i = model_.floating_base ? 1 : 0; i < model_.njoints(); ++i) {
      Joint& joint = model_.joints[i];
      if (joint.type != JointType::kFloating) continue;
      joint.actuated = false;
      if (options_.passive.count(joint.name) || options_.actuated.count(joint.name)) continue;
      tell("passive", joint.name, robot_.joints.at(joint.name).line,
           "a floating joint of the file, taken as passive: without torques in u; actuated=\"true\" gives it some");
    }
    for (const std::string& name : options_.actuated) joint_with_torques(name).actuated = true;
    for (const std::string& name : options_.passive) joint_with_torques(name).actuated = false;
  }

  void set_armature() {
    const auto sound = [](double a) { return std::isfinite(a) && a >= 0; };
    if (!sound(options_.armature)) throw UrdfOptionError("", false, "the armature is negative, expected 0 or more");
    model_.armature.setConstant(options_.armature);
    if (model_.floating_base) model_.armature.head<6>().setZero();
    for (const auto& [name, values] : options_.joint_armature) {
      const Joint& joint = moving_joint(name);
      if (values.size() != 1 && values.size() != static_cast<std::size_t>(joint.nv()))
        throw UrdfOptionError(name, false,
                              "the armature of joint " + quote(name) + " has " + std::to_string(values.size()) +
                                  " numbers, expected 1" + (joint.nv() > 1 ? " or " + std::to_string(joint.nv()) : ""));
      for (int k = 0; k < joint.nv(); ++k) {
        const double a = values[values.size() == 1 ? 0 : static_cast<std::size_t>(k)];
        if (!sound(a))
          throw UrdfOptionError(name, false,
                                "the armature of joint " + quote(name) + " is " + io::show(a) + ", expected 0 or more");
        model_.armature[joint.idx_v + k] = a;
      }
    }
  }

  // Reads the limits of joints with one coordinate.
  void set_dynamics() {
    model_.damping = model_.friction = Eigen::VectorXd::Zero(model_.nv);
    for (const Joint& joint : model_.joints) {
      const auto found = robot_.joints.find(joint.name);
      if (found == robot_.joints.end() || joint.nv() > 1) continue;
      model_.damping[joint.idx_v] = found->second.damping;
      model_.friction[joint.idx_v] = found->second.friction;
    }
  }

  void set_joint_damping() {
    if (!options_.joint_damping.empty() && model_.damping.size() == 0)
      model_.damping = Eigen::VectorXd::Zero(model_.nv);
    for (const auto& [name, damping] : options_.joint_damping) {
      const Joint& joint = moving_joint(name);
      if (joint.nv() != 1)
        throw UrdfOptionError(name, false,
                              "joint " + quote(name) + " has a damping and several coordinates, expected one");
      if (!(damping >= 0 && std::isfinite(damping)))
        throw UrdfOptionError(
            name, false, "the damping of joint " + quote(name) + " is " + io::show(damping) + ", expected 0 or more");
      model_.damping[joint.idx_v] = damping;
    }
  }

  std::string why_absent(const std::string& name) const {
    if (options_.locked.count(name)) return "joint " + quote(name) + " is locked, expected one that moves";
    if (robot_.joints.count(name)) return "joint " + quote(name) + " is fixed, expected one that moves";
    return "the robot has no joint " + quote(name) + ", " + suggestion(name, joint_names());
  }

  UrdfRobot& robot_;  // the builder adds to its findings
  const UrdfOptions& options_;
  const std::string& path_;
  Model model_;
  std::vector<std::string> body_link_;  // one entry per joint: the link of its body
};

}  // namespace

Model load_urdf(const std::string& path, const UrdfOptions& options, std::vector<Finding>* findings) {
  std::string problem;
  const std::string text = io::read_file(path, problem);
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected a URDF file");
  const io::XmlFile file(path, text, "robot");
  UrdfRobot robot = io::read_urdf(file.root());
  Model model = Builder(robot, options, path).build();
  if (findings) {
    std::stable_sort(robot.findings.begin(), robot.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.line < b.line; });
    *findings = std::move(robot.findings);
  }
  return model;
}

}  // namespace manycontact
