#include "manycontact/io/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <mutex>

#include "urdf_check.hpp"

namespace manycontact {
namespace {

using io::UrdfLines;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Silences urdfdom. No handler at all, rather than one that listens: urdfdom uses names from the file as
// printf formats.
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

urdf::ModelInterfaceSharedPtr parse(io::XmlFile& file, const UrdfLines& lines) {
  urdf::ModelInterfaceSharedPtr robot;
  std::string reason;
  try {
    const Silence silence;
    robot = urdf::parseURDF(io::text_for_urdfdom(file));
  } catch (const std::exception& e) {
    reason = std::string(" (") + e.what() + ")";
  }
  if (!robot) throw InputError(file.path(), lines.robot, "urdfdom refuses the robot" + reason + ", expected URDF 1.0");
  return robot;
}

SE3<double> placement_of(const urdf::Pose& pose) {
  double x, y, z, w;
  pose.rotation.getQuaternion(x, y, z, w);
  return {rotation_of_quaternion(x, y, z, w), Vec3<double>(pose.position.x, pose.position.y, pose.position.z)};
}

Inertia<double> inertia_of(const urdf::Inertial& i) {
  const SE3<double> at = placement_of(i.origin);
  Mat3<double> I;
  I << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  return Inertia<double>::from_com(i.mass, at.p, at.R * I * at.R.transpose());
}

Vec3<double> axis_of(const urdf::Joint& joint) {
  const Vec3<double> axis(joint.axis.x, joint.axis.y, joint.axis.z);
  return axis / axis.stableNorm();
}

// The smallest rotation that takes z to the unit vector a (about x when a = -z).
Mat3<double> rotation_from_z(const Vec3<double>& a) {
  const double s2 = a.x() * a.x() + a.y() * a.y();
  if (s2 == 0) return a.z() > 0 ? Mat3<double>::Identity() : Mat3<double>(Vec3<double>(1, -1, -1).asDiagonal());
  const Vec3<double> v(-a.y(), a.x(), 0);  // z x a
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

void set_limits(Joint& out, const urdf::Joint* joint) {
  const auto all = [&](double x) { return Eigen::VectorXd::Constant(out.nv(), x); };
  out.lower = all(-kInfinity);
  out.upper = out.velocity_limit = out.effort_limit = all(kInfinity);
  if (!joint || !joint->limits) return;
  out.velocity_limit = all(joint->limits->velocity);
  out.effort_limit = all(joint->limits->effort);
  if (joint->type == urdf::Joint::CONTINUOUS) return;
  out.lower = all(joint->limits->lower);
  out.upper = all(joint->limits->upper);
}

// Where a link's frame is: on a joint's body (-1: the immovable base).
struct Place {
  int joint = -1;
  SE3<double> placement;
};

// Builds a Model from urdfdom's tree: walks it depth first, merging as it goes.
class Builder {
 public:
  Builder(const urdf::ModelInterface& robot, const UrdfOptions& options, const std::string& path,
          const UrdfLines& lines)
      : robot_(robot), options_(options), path_(path), lines_(lines) {}

  Model build() {
    model_.name = robot_.getName();
    model_.floating_base = options_.floating_base;
    check_locks();
    // Explicit stack: a chain of links may be longer than the machine's.
    struct Todo {
      const urdf::Link* link;
      Place parent;
    };
    std::vector<Todo> stack{{robot_.getRoot().get(), {}}};
    while (!stack.empty()) {
      const Todo todo = stack.back();
      stack.pop_back();
      const urdf::Joint* joint = todo.link->parent_joint.get();
      const Place place = joint ? cross(*joint, todo.parent, todo.link->name) : root();
      add_link(*todo.link, place);
      for (auto c = todo.link->child_links.rbegin(); c != todo.link->child_links.rend(); ++c)
        stack.push_back({c->get(), place});
    }
    for (int i = 0; i < model_.njoints(); ++i) judge(i);
    set_passive();
    try {
      finalize(model_);
    } catch (const std::invalid_argument& e) {
      throw InputError(path_, lines_.robot, std::string(e.what()) + ", expected a shallower one");
    }
    set_armature();
    if (options_.model_dynamics) set_dynamics();
    return std::move(model_);
  }

 private:
  Place root() {
    if (!options_.floating_base) return {};
    Joint base;
    base.name = "root";
    while (robot_.joints_.count(base.name)) base.name += "_";
    base.type = JointType::kFloating;
    set_limits(base, nullptr);
    return {append(std::move(base), robot_.getRoot()->name), {}};
  }

  // From the parent's link over a joint to the child's link.
  Place cross(const urdf::Joint& joint, const Place& parent, const std::string& child) {
    const SE3<double> at = parent.placement * placement_of(joint.parent_to_joint_origin_transform);
    const auto lock = options_.locked.find(joint.name);
    if (joint.type == urdf::Joint::FIXED) {
      model_.notes.merged.push_back(joint.name);
      return {parent.joint, at};
    }
    if (lock != options_.locked.end()) {
      model_.notes.locked.push_back(joint.name);
      return {parent.joint, at * motion(joint, lock->second)};
    }
    note(joint);
    Joint out;
    out.name = joint.name;
    out.type = type_of(joint);
    out.parent = parent.joint;
    out.placement = at;
    SE3<double> link;
    if (out.type == JointType::kPlanar) {  // z of the joint frame is the normal; the link keeps URDF's frame
      link.R = rotation_from_z(axis_of(joint)).transpose();
      out.placement.R = at.R * link.R.transpose();
    } else if (out.type != JointType::kFloating) {
      out.axis = axis_of(joint);
    }
    set_limits(out, &joint);
    return {append(std::move(out), child), link};
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
    if (link.inertial) frame.inertia = inertia_of(*link.inertial);
    if (place.joint >= 0) model_.joints[place.joint].inertia += frame.inertia.transformed(place.placement);
    model_.frames.push_back(std::move(frame));
  }

  void note(const urdf::Joint& joint) {
    if (joint.mimic) {
      if (options_.refuse_mimic)
        throw InputError(path_, lines_.joint.at(joint.name),
                         "joint " + quote(joint.name) + " mimics " + quote(joint.mimic->joint_name) +
                             ", expected none, for mimic=\"refuse\"");
      model_.notes.mimic.push_back(joint.name);
    }
    if (!joint.dynamics || (joint.dynamics->damping == 0 && joint.dynamics->friction == 0)) return;
    if (!options_.model_dynamics) return model_.notes.dynamics.push_back(joint.name);
    for (const double x : {joint.dynamics->damping, joint.dynamics->friction})
      if (!(x >= 0) || !std::isfinite(x))
        throw InputError(path_, lines_.joint.at(joint.name),
                         "joint " + quote(joint.name) + " has the damping or friction " + io::show(x) +
                             ", expected 0 or more, for dynamics=\"model\"");
  }

  // The inertia of joint i's body: no negative mass; about the centre of mass no negative principal moment, and none
  // above the sum of the other two, I_1 + I_2 - I_3 = 2 int x_3^2 dm >= 0. (Massless bodies are ideal ones: a rotor
  // about one axis is allowed. What is merged first may be anything: Talos' gripper motors alone lack 1.3 % of their
  // trace.)
  void judge(int i) const {
    const Inertia<double>& Y = model_.joints[i].inertia;
    const std::string& link = body_link_[i];
    const auto refuse = [&](const std::string& what) {
      throw InputError(path_, lines_.link.at(link), "link " + quote(link) + " and what is merged into it have " + what);
    };
    if (!std::isfinite(Y.m) || !Y.h.allFinite() || !Y.I.allFinite())
      refuse("an inertia too large to compute with, expected finite numbers");
    if (Y.m < 0) refuse("the mass " + io::show(Y.m) + " kg, expected none below 0");
    if (Y.m == 0 && Y.h.squaredNorm() > 0) refuse("no mass but a first moment of it, expected none");
    const Vec3<double> c = Y.m > 0 ? Vec3<double>(Y.h / Y.m) : Vec3<double>::Zero();
    const Mat3<double> shift = Y.m * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose());
    const Mat3<double> Ic = Y.I - shift;
    const Eigen::SelfAdjointEigenSolver<Mat3<double>> eigen(Ic, Eigen::EigenvaluesOnly);
    const Vec3<double> moments = eigen.eigenvalues();  // ascending
    const double trace = Ic.trace();
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * (Y.I.norm() + shift.norm());
    const double allowed = 1e-9 * std::max(trace, 0.0) + rounding;
    if (!(moments[0] >= -allowed))
      refuse("the principal moment of inertia " + io::show(moments[0]) + " kg m^2 (trace " + io::show(trace) +
             "), expected none below -1e-9 of the trace");
    if (Y.m > 0 && !(moments[0] + moments[1] - moments[2] >= -allowed))
      refuse("the principal moments of inertia " + io::show(moments[0]) + ", " + io::show(moments[1]) + ", " +
             io::show(moments[2]) + " kg m^2, which no body has, expected none above the sum of the other two");
  }

  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const auto& [name, joint] : robot_.joints_) names.push_back(name);
    return names;
  }

  void check_locks() const {
    for (const auto& [name, position] : options_.locked) {
      const auto found = robot_.joints_.find(name);
      if (found == robot_.joints_.end())
        throw UrdfOptionError(name, true,
                              "the robot has no joint " + quote(name) + " to lock, " + suggestion(name, joint_names()));
      const auto type = found->second->type;
      if (type == urdf::Joint::FIXED)
        throw UrdfOptionError(name, true, "joint " + quote(name) + " is fixed, expected one that moves, to lock");
      if (type == urdf::Joint::FLOATING || type == urdf::Joint::PLANAR)
        throw UrdfOptionError(name, true,
                              "joint " + quote(name) + " has several coordinates, expected one with one, to lock");
      if (!std::isfinite(position))
        throw UrdfOptionError(name, true, "joint " + quote(name) + " is locked at no finite position, expected one");
    }
  }

  void set_passive() {
    for (const std::string& name : options_.passive) {
      const int i = model_.find_joint(name);
      if (i < 0) throw UrdfOptionError(name, false, why_absent(name));
      if (model_.floating_base && i == 0)
        throw UrdfOptionError(name, false,
                              "joint " + quote(name) + " is the floating base, which has no torques, expected another");
      model_.joints[i].actuated = false;
    }
  }

  void set_armature() {
    const auto sound = [](double a) { return std::isfinite(a) && a >= 0; };
    if (!sound(options_.armature)) throw UrdfOptionError("", false, "the armature is negative, expected 0 or more");
    model_.armature.setConstant(options_.armature);
    if (model_.floating_base) model_.armature.head<6>().setZero();
    for (const auto& [name, values] : options_.joint_armature) {
      const int i = model_.find_joint(name);
      if (i < 0) throw UrdfOptionError(name, false, why_absent(name));
      const Joint& joint = model_.joints[i];
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

  // A joint's damping and friction, on each of its coordinates.
  void set_dynamics() {
    model_.damping = model_.friction = Eigen::VectorXd::Zero(model_.nv);
    for (const Joint& joint : model_.joints) {
      const auto found = robot_.joints_.find(joint.name);
      if (found == robot_.joints_.end() || !found->second->dynamics) continue;
      model_.damping.segment(joint.idx_v, joint.nv()).setConstant(found->second->dynamics->damping);
      model_.friction.segment(joint.idx_v, joint.nv()).setConstant(found->second->dynamics->friction);
    }
  }

  std::string why_absent(const std::string& name) const {
    if (options_.locked.count(name)) return "joint " + quote(name) + " is locked, expected one that moves";
    if (robot_.joints_.count(name)) return "joint " + quote(name) + " is fixed, expected one that moves";
    return "the robot has no joint " + quote(name) + ", " + suggestion(name, joint_names());
  }

  const urdf::ModelInterface& robot_;
  const UrdfOptions& options_;
  const std::string& path_;
  const UrdfLines& lines_;
  Model model_;
  std::vector<std::string> body_link_;  // per joint: the link it carries
};

}  // namespace

Model load_urdf(const std::string& path, const UrdfOptions& options) {
  std::string problem;
  const std::string text = io::read_file(path, problem);
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected a URDF file");
  io::XmlFile file(path, text, "robot");
  const UrdfLines lines = io::check_urdf(file.root());
  const urdf::ModelInterfaceSharedPtr robot = parse(file, lines);
  // urdfdom's links own their children: let go one by one, a long chain is not freed recursively.
  struct Unlink {
    urdf::ModelInterface& robot;
    ~Unlink() {
      for (auto& [name, link] : robot.links_) link->child_links.clear();
    }
  } unlink{*robot};
  return Builder(*robot, options, path, lines).build();
}

}  // namespace manycontact
