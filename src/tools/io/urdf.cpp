#include "manycontact/io/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "urdf_check.hpp"

namespace manycontact {
namespace {

using io::UrdfDetails;
using io::UrdfJoint;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Silences urdfdom while it exists. urdfdom would use names from the file as printf formats in its messages.
class Silence {
 public:
  Silence() : lock_(mutex()) { console_bridge::noOutputHandler(); }
  ~Silence() { console_bridge::restorePreviousOutputHandler(); }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
};

urdf::ModelInterfaceSharedPtr parse(io::XmlFile& file, const UrdfDetails& details) {
  urdf::ModelInterfaceSharedPtr robot;
  std::string reason;
  try {
    const Silence silence;
    robot = urdf::parseURDF(io::text_for_urdfdom(file));
  } catch (const std::exception& e) {
    reason = std::string(" (") + e.what() + ")";
  }
  if (!robot)
    throw InputError(file.path(), details.robot, "urdfdom refuses the robot" + reason + ", expected URDF 1.0");
  return robot;
}

SE3<double> placement_of(const urdf::Pose& pose) {
  double x, y, z, w;
  pose.rotation.getQuaternion(x, y, z, w);
  return {rotation_of_quaternion(x, y, z, w), Vec3<double>(pose.position.x, pose.position.y, pose.position.z)};
}

Inertia<double> joint_space_inertia(const urdf::Inertial& i) {
  const SE3<double> at = placement_of(i.origin);
  Mat3<double> I;
  I << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  return Inertia<double>::from_com(i.mass, at.p, at.R * I * at.R.transpose());
}

Vec3<double> axis_of(const urdf::Joint& joint) {
  const Vec3<double> axis(joint.axis.x, joint.axis.y, joint.axis.z);
  return axis / axis.stableNorm();
}

// Returns the smallest rotation from the z axis to the unit vector a. If a = -z, the rotation is about x.
Mat3<double> rotation_from_z(const Vec3<double>& a) {
  const double s2 = a.x() * a.x() + a.y() * a.y();
  if (s2 == 0) return a.z() > 0 ? Mat3<double>::Identity() : Mat3<double>(Vec3<double>(1, -1, -1).asDiagonal());
  const Vec3<double> v(-a.y(), a.x(), 0);  // z x a (cross product)
  const double k = a.z() > 0 ? 1 / (1 + a.z()) : (1 - a.z()) / s2;
  const Mat3<double> V = skew<double>(v);
  return Mat3<double>::Identity() + V + k * V * V;
}

JointType type_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::PRISMATIC:
      return JointType::kPrismatic;
    case urdf::Joint::FLOATING:
      return JointType::kFloating;
    case urdf::Joint::PLANAR:
      return JointType::kPlanar;
    default:
      return JointType::kRevolute;
  }
}

// Sets the limits of the joint `out` to those of the file. Without `details` there are no limits.
void set_limits(Joint& out, const UrdfJoint& details = {}) {
  const auto all = [&](double x) { return Eigen::VectorXd::Constant(out.nv(), x); };
  out.lower = all(details.lower);
  out.upper = all(details.upper);
  out.velocity_limit = all(details.velocity);
  out.effort_limit = all(details.effort);
}

struct Place {  // The placement of a link's frame on the body of a joint. joint = -1 means the fixed base.
  int joint = -1;
  SE3<double> placement;
};

// Builds a Model from urdfdom's tree in depth-first order. Links on fixed and locked joints are merged.
class Builder {
 public:
  Builder(const urdf::ModelInterface& robot, const UrdfOptions& options, const std::string& path, UrdfDetails& details)
      : robot_(robot), options_(options), path_(path), details_(details) {}

  Model build() {
    model_.name = robot_.getName();
    model_.floating_base = options_.floating_base;
    check_locks();
    // A stack replaces recursion, because a chain of links could overflow the call stack.
    std::vector<Step> stack{{&root_link()}};
    while (!stack.empty()) {
      const Step step = stack.back();
      stack.pop_back();
      const Place place = step.joint ? cross(step) : root(step.link->name);
      add_link(*step.link, place);
      const std::size_t first = stack.size();
      for (const urdf::LinkSharedPtr& child : step.link->child_links)
        if (child->parent_joint.get() != step.joint) stack.push_back({child.get(), child->parent_joint.get(), place});
      if (const urdf::Joint* joint = step.link->parent_joint.get(); joint && joint != step.joint)
        stack.push_back({robot_.getLink(joint->parent_link_name).get(), joint, place, true});
      std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end(),
                // The order is descending, because the loop takes the last step first.
                [](const Step& a, const Step& b) { return a.joint->name > b.joint->name; });
    }
    for (int i = 0; i < model_.njoints(); ++i) judge(i);
    set_passive();
    try {
      finalize(model_);
    } catch (const std::invalid_argument& e) {
      throw InputError(path_, details_.robot, std::string(e.what()) + ", expected a shallower tree");
    }
    set_armature();
    if (options_.model_dynamics) set_dynamics();
    set_joint_damping();
    return std::move(model_);
  }

 private:
  // A step of the traversal over a joint to `link`, from a link placed at `from`. backwards: from child to parent.
  struct Step {
    const urdf::Link* link;
    const urdf::Joint* joint = nullptr;  // null for the root
    Place from = {};
    bool backwards = false;
  };

  const urdf::Link& root_link() const {
    if (options_.root.empty()) return *robot_.getRoot();
    const auto found = robot_.links_.find(options_.root);
    if (found != robot_.links_.end()) return *found->second;
    std::vector<std::string> names;
    for (const auto& [name, link] : robot_.links_) names.push_back(name);
    refuse("", "the robot has no link " + quote(options_.root) + " for the root, " + suggestion(options_.root, names));
  }

  Place root(const std::string& link) {
    if (!options_.floating_base) return {};
    Joint base;
    base.name = "root";
    while (robot_.joints_.count(base.name)) base.name += "_";
    base.type = JointType::kFloating;
    set_limits(base);
    return {append(std::move(base), link), {}};
  }

  // Adds the joint of a step to the model and returns the placement of the reached link. A joint moves its child by
  // T(q) in the frame X of its parent: oMchild = oMparent X T(q). Backwards, oMparent = oMchild T(q)^-1 X^-1. T(q)^-1
  // is the motion by q about or along -axis.
  Place cross(const Step& step) {
    const urdf::Joint& joint = *step.joint;
    const Place& parent = step.from;
    const SE3<double> X = placement_of(joint.parent_to_joint_origin_transform), none;
    const SE3<double> at = parent.placement * (step.backwards ? none : X), behind = step.backwards ? X.inverse() : none;
    const double sign = step.backwards ? -1 : 1;
    const auto lock = options_.locked.find(joint.name);
    if (joint.type == urdf::Joint::FIXED) {
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
      refuse("", "joint " + quote(joint.name) + " has several coordinates and is between the file's root " +
                     quote(robot_.getRoot()->name) + " and " + quote(options_.root) +
                     ", expected a root that is not beyond this joint");
    SE3<double> link = behind;
    // The z axis of the joint frame becomes the plane's normal; the link's frame does not change.
    if (out.type == JointType::kPlanar) {
      link.R = rotation_from_z(axis_of(joint)).transpose();
      out.placement.R = at.R * link.R.transpose();
    } else if (out.type != JointType::kFloating) {
      out.axis = sign * axis_of(joint);
    }
    set_limits(out, details_.joint.at(joint.name));
    return {append(std::move(out), step.link->name), link};
  }

  static SE3<double> motion(const urdf::Joint& joint, double q) {
    const Vec3<double> axis = axis_of(joint);
    if (joint.type == urdf::Joint::PRISMATIC) return {Mat3<double>::Identity(), Vec3<double>(q * axis)};
    return {rotation_about<double>(axis, q), Vec3<double>::Zero()};
  }

  int append(Joint joint, const std::string& link) {
    model_.joints.push_back(std::move(joint));
    body_link_.push_back(link);
    return model_.njoints() - 1;
  }

  void add_link(const urdf::Link& link, const Place& place) {
    Frame frame;
    frame.name = link.name;
    if (link.parent_joint) frame.parent_joint = link.parent_joint->name;
    frame.joint = place.joint;
    frame.placement = place.placement;
    frame.merged = place.joint >= 0 && body_link_[place.joint] != link.name;
    if (link.inertial) frame.inertia = joint_space_inertia(*link.inertial);
    if (place.joint >= 0 && frame.inertia.m < 0)
      tell("inertia", link.name, details_.link.at(link.name),
           "the mass " + io::show(frame.inertia.m) + " kg is compensated by the bodies merged with the link");
    if (place.joint >= 0) model_.joints[place.joint].inertia += frame.inertia.transformed(place.placement);
    model_.frames.push_back(std::move(frame));
  }

  void tell(const char* kind, const std::string& name, int line, const std::string& text) {
    details_.findings.push_back({kind, name, text, path_, line});
  }

  // Reports properties of a movable joint that are ignored, or not modelled as most users expect.
  void note(const urdf::Joint& joint, const Place& parent) {
    const UrdfJoint& details = details_.joint.at(joint.name);
    const auto refuse = [&](const std::string& what) { throw InputError(path_, details.line, what); };
    if (joint.mimic) {
      if (options_.refuse_mimic)
        refuse("joint " + quote(joint.name) + " mimics " + quote(joint.mimic->joint_name) +
               ", expected no <mimic>, because mimic=\"refuse\" is set");
      model_.notes.mimic.push_back(joint.name);
      tell("mimic", joint.name, details.line, "<mimic> is not modelled: the joint moves independently");
    }
    if (joint.type == urdf::Joint::FLOATING && options_.floating_base && parent.joint == 0)
      tell("base", joint.name, details.line,
           "the joint is floating and below the floating base: the robot has two bases, expected base=\"fixed\" for "
           "this file");
    if (details.damping == 0 && details.friction == 0) return;
    if (!options_.model_dynamics) {
      model_.notes.dynamics.push_back(joint.name);
      return tell("dynamics", joint.name, details.line, "damping and friction are not modelled");
    }
    for (const double x : {details.damping, details.friction}) {
      if (!std::isfinite(x))
        refuse("joint " + quote(joint.name) + " has the damping or friction " + io::show(x) +
               ", expected a finite number, because dynamics=\"model\" is set");
      if (x < 0)
        tell("dynamics", joint.name, details.line,
             "the damping or friction " + io::show(x) + ", which drives the joint, is used as given");
    }
  }

  void judge(int i) {
    const std::string& link = body_link_[i];
    const int line = details_.link.at(link);
    const io::InertiaVerdict verdict = io::judge_inertia(model_.joints[i].inertia);
    const std::string owner = "link " + quote(link) + ", with the links merged into this link, has ";
    if (!verdict.refused.empty()) throw InputError(path_, line, owner + verdict.refused);
    if (verdict.odd.empty()) return;
    if (options_.refuse_inertia)
      throw InputError(path_, line,
                       owner + verdict.odd + ", expected physical moments, because inertia=\"refuse\" is set");
    tell("inertia", link, line,
         "the body, with the bodies merged into this body, has " + verdict.odd + "; the moments are used as given");
  }

  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const auto& [name, joint] : robot_.joints_) names.push_back(name);
    return names;
  }

  void check_locks() const {
    for (const auto& [name, position] : options_.locked) {
      const auto refuse_lock = [&name = name](const std::string& what) { throw UrdfOptionError(name, true, what); };
      const auto found = robot_.joints_.find(name);
      if (found == robot_.joints_.end())
        refuse_lock("the robot has no joint " + quote(name) + " that could be locked, " +
                    suggestion(name, joint_names()));
      const auto type = found->second->type;
      if (type == urdf::Joint::FIXED)
        refuse_lock("joint " + quote(name) + " is fixed and cannot be locked, expected a joint that moves");
      if (type == urdf::Joint::FLOATING || type == urdf::Joint::PLANAR)
        refuse_lock("joint " + quote(name) +
                    " has several coordinates and cannot be locked, expected a joint with one coordinate");
      if (!std::isfinite(position))
        refuse_lock("joint " + quote(name) + " is locked at a position that is not finite, expected a finite position");
    }
  }

  // Throws UrdfOptionError. joint: the joint that the option names, or "" if it names none.
  [[noreturn]] static void refuse(const std::string& joint, const std::string& what) {
    throw UrdfOptionError(joint, false, what);
  }

  int moving_joint(const std::string& name) const {
    const int i = model_.find_joint(name);
    if (i < 0) refuse(name, why_absent(name));
    return i;
  }

  int joint_with_torques(const std::string& name) const {
    const int i = moving_joint(name);
    if (model_.floating_base && i == 0)
      refuse(name, "joint " + quote(name) + " is the floating base, which has no torques, expected another joint");
    return i;
  }

  // Sets Joint::actuated. Floating joints of the file are passive unless options.actuated contains them.
  void set_passive() {
    for (int i = model_.floating_base ? 1 : 0; i < model_.njoints(); ++i) {
      Joint& joint = model_.joints[i];
      if (joint.type != JointType::kFloating) continue;
      joint.actuated = false;
      if (options_.passive.count(joint.name) || options_.actuated.count(joint.name)) continue;
      tell("passive", joint.name, details_.joint.at(joint.name).line,
           "the floating joint is taken as passive, without torques in u; actuated=\"true\" gives the joint torques");
    }
    for (const std::string& name : options_.actuated) model_.joints[joint_with_torques(name)].actuated = true;
    for (const std::string& name : options_.passive) model_.joints[joint_with_torques(name)].actuated = false;
  }

  void set_armature() {
    const auto sound = [](double a) { return std::isfinite(a) && a >= 0; };
    if (!sound(options_.armature)) refuse("", "the armature is negative, expected 0 or more");
    model_.armature.setConstant(options_.armature);
    if (model_.floating_base) model_.armature.head<6>().setZero();
    for (const auto& [name, values] : options_.joint_armature) {
      const Joint& joint = model_.joints[moving_joint(name)];
      if (values.size() != 1 && values.size() != static_cast<std::size_t>(joint.nv()))
        refuse(name, "the armature of joint " + quote(name) + " has " + std::to_string(values.size()) +
                         " numbers, expected 1" + (joint.nv() > 1 ? " or " + std::to_string(joint.nv()) : ""));
      for (int k = 0; k < joint.nv(); ++k) {
        const double a = values[values.size() == 1 ? 0 : static_cast<std::size_t>(k)];
        if (!sound(a))
          refuse(name, "the armature of joint " + quote(name) + " is " + io::show(a) + ", expected 0 or more");
        model_.armature[joint.idx_v + k] = a;
      }
    }
  }

  // Sets damping and friction of joints with one coordinate.
  void set_dynamics() {
    model_.damping = model_.friction = Eigen::VectorXd::Zero(model_.nv);
    for (const Joint& joint : model_.joints) {
      const auto found = details_.joint.find(joint.name);
      if (found == details_.joint.end() || joint.nv() > 1) continue;
      model_.damping[joint.idx_v] = found->second.damping;
      model_.friction[joint.idx_v] = found->second.friction;
    }
  }

  void set_joint_damping() {
    if (!options_.joint_damping.empty() && model_.damping.size() == 0)
      model_.damping = Eigen::VectorXd::Zero(model_.nv);
    for (const auto& [name, damping] : options_.joint_damping) {
      const Joint& joint = model_.joints[moving_joint(name)];
      if (joint.nv() != 1)
        refuse(name, "joint " + quote(name) + " has a damping and several coordinates, expected one coordinate");
      if (!(damping >= 0 && std::isfinite(damping)))
        refuse(name, "the damping of joint " + quote(name) + " is " + io::show(damping) + ", expected 0 or more");
      model_.damping[joint.idx_v] = damping;
    }
  }

  std::string why_absent(const std::string& name) const {
    if (options_.locked.count(name)) return "joint " + quote(name) + " is locked, expected a joint that moves";
    if (robot_.joints_.count(name)) return "joint " + quote(name) + " is fixed, expected a joint that moves";
    return "the robot has no joint " + quote(name) + ", " + suggestion(name, joint_names());
  }

  const urdf::ModelInterface& robot_;
  const UrdfOptions& options_;
  const std::string& path_;
  UrdfDetails& details_;  // results of check_urdf; the builder appends findings
  Model model_;
  std::vector<std::string> body_link_;  // name of each joint's body
};

}  // namespace

Model load_urdf(const std::string& path, const UrdfOptions& options, std::vector<Finding>* findings) {
  io::XmlFile file(path, io::read_file_of(path, "a URDF file"), "robot");
  UrdfDetails details = io::check_urdf(file.root());
  const urdf::ModelInterfaceSharedPtr robot = parse(file, details);
  // The links of urdfdom own their children. Unlink releases them singly, because recursion could exhaust the stack.
  struct Unlink {
    urdf::ModelInterface& robot;
    ~Unlink() {
      for (auto& [name, link] : robot.links_) link->child_links.clear();
    }
  } unlink{*robot};
  Model model = Builder(*robot, options, path, details).build();
  if (findings) {
    std::ranges::stable_sort(details.findings, {}, &Finding::line);
    *findings = std::move(details.findings);
  }
  return model;
}

}  // namespace manycontact
