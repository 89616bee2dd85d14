#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <set>
#include <unordered_map>

#include "scene_parts.hpp"

namespace manycontact::io {
namespace {

constexpr int kMostCopies = 1000000;

// Returns the children named `child` (<joint> or <lock>) by joint name. Throws InputError if a joint occurs twice.
std::map<std::string, Element> by_joint(const Element& robot, const char* child, const char* key) {
  std::map<std::string, Element> out;
  for (const Element& e : robot.children(child)) {
    e.allow_children({});
    const std::string name = e.required(key);
    if (!out.emplace(name, e).second)
      e.where(key).fail("joint " + quote(name) + " has a second <" + child + ">, expected only one");
  }
  return out;
}

void read_name(const Element& e, RobotGroup& group) {
  group.line = e.line();
  group.name = e.not_empty("name");
  if (group.name.find_first_of("/+") != std::string::npos)
    e.where("name").fail("name of <robot> is " + quote(group.name) + ", expected a name without '/' and '+'");
  group.copied = e.has("copies");
  if (group.copied) group.count = e.count("copies", 1, kMostCopies);
  for (const char* a : {"arrange", "spacing"})
    if (e.has(a) && !group.copied) e.refuse(a, " needs copies, expected also a 'copies' attribute");
}

void read_options(const Element& e, RobotElement& robot) {
  UrdfOptions& options = robot.options;
  options.floating_base = e.choice("base", {"floating", "fixed"}, 1) == 0;
  if (e.has("root")) options.root = e.required("root");
  options.refuse_mimic = e.choice("mimic", {"ignore", "refuse"}, 0) == 1;
  options.refuse_inertia = e.choice("inertia", {"tell", "refuse"}, 0) == 1;
  options.model_dynamics = e.choice("dynamics", {"ignore", "model"}, 0) == 1;
  options.armature = e.number_from_0("armature", 0);
  robot.joints = by_joint(e, "joint", "name");
  for (const auto& [name, joint] : robot.joints) {
    joint.allow_attributes({"name", "q", "v", "u", "armature", "actuated", "stiffness", "rest", "damping"});
    if (joint.has("actuated")) (joint.flag("actuated", true) ? options.actuated : options.passive).insert(name);
    if (joint.has("damping")) options.joint_damping[name] = joint.required_number("damping");
    if (!joint.has("armature")) continue;
    const std::string what = "armature of joint " + quote(name);
    const auto values = parse_numbers(joint.where("armature"), what, joint.required("armature"));
    for (const double a : values)
      if (a < 0) joint.where("armature").fail(what + " is " + show(a) + ", expected 0 or more");
    options.joint_armature[name] = values;
  }
  robot.locks = by_joint(e, "lock", "joint");
  for (const auto& [name, lock] : robot.locks) {
    lock.allow_attributes({"joint", "at"});
    options.locked[name] = lock.required_number("at");
  }
}

// Reads a <robot> element. A relative URDF path is relative to the folder of the scene file.
RobotElement read_robot(const Element& e) {
  e.allow({"name", "urdf", "base", "xyz", "rpy", "armature", "mimic", "inertia", "dynamics", "u", "copies", "arrange",
           "spacing", "root"},
          {"joint", "lock", "q", "v", "u"});
  RobotElement robot(e);
  read_name(e, robot.group);
  const std::filesystem::path urdf = e.not_empty("urdf", "a path");
  robot.group.urdf = (std::filesystem::path(*e.where().file).parent_path() / urdf).string();
  read_options(e, robot);
  for (const char* vector : {"q", "v", "u"}) {
    const std::vector<Element> given = e.children(vector);
    if (!given.empty()) given[0].allow_attributes({});
    if (given.size() > 1)
      given[1].fail("robot " + quote(robot.group.name) + " has a second <" + vector + ">, expected only one");
  }
  if (e.has("u")) {
    (void)e.choice("u", {"gravity"}, -1);
    robot.gravity_torques = true;
    const Where here = e.where("u");
    if (e.child("u")) here.fail("u=\"gravity\" and <u> both give the torques, expected only one of the two");
    for (const auto& [name, joint] : robot.joints)
      if (joint.has("u"))
        here.fail("u=\"gravity\" and u of joint " + quote(name) +
                  " both give the torques, expected only one of the two");
  }
  return robot;
}

// A cache of models by file and options, so that robots with the same file and options share one model.
class ModelCache {
 public:
  // Returns the robot's model. The findings of a URDF file are added once for all robots that share the model.
  std::shared_ptr<const Model> get(const RobotElement& robot, std::vector<Finding>& findings) {
    const UrdfOptions& o = robot.options;
    std::error_code failed;
    const auto canonical = std::filesystem::weakly_canonical(robot.group.urdf, failed);
    auto& of_file = models_[failed ? robot.group.urdf : canonical.string()];
    const auto known = std::ranges::find_if(of_file, [&](const auto& of) { return of.first == o; });
    if (known != of_file.end()) return known->second;

    const Element& e = robot.element;
    const std::string problem = file_problem(robot.group.urdf, true);
    if (!problem.empty())
      e.where("urdf").fail("the robot file " + quote(robot.group.urdf) + " " + problem + ", expected a URDF file");
    try {
      std::vector<Finding> found;
      of_file.emplace_back(o, std::make_shared<const Model>(load_urdf(robot.group.urdf, o, &found)));
      for (Finding& finding : found) {
        finding.name = robot.group.name + "/" + finding.name;
        findings.push_back(std::move(finding));
      }
    } catch (const UrdfOptionError& error) {
      const auto& blamed = error.lock ? robot.locks : robot.joints;
      const auto joint = blamed.find(error.joint);
      (joint == blamed.end() ? e : joint->second).fail(error.what());
    }
    return of_file.back().second;
  }

 private:
  std::map<std::string, std::vector<std::pair<UrdfOptions, std::shared_ptr<const Model>>>> models_;  // key: the path
};

struct Arrangement {
  int kind = 0;  // 0: line, 1: circle, 2: grid
  double spacing = 1;
  int count = 1;

  void place(int i, Vec3<double>& translation, double& yaw) const {
    yaw = 0;
    if (kind == 0) {
      translation = Vec3<double>(i * spacing, 0, 0);
    } else if (kind == 1) {
      // spacing is the distance of neighbours on the circle, a chord: spacing = 2 r sin(pi / n)
      const double radius = count > 1 ? spacing / (2 * std::sin(std::numbers::pi / count)) : 0;
      yaw = 2 * std::numbers::pi * i / count;
      translation = Vec3<double>(radius * std::cos(yaw), radius * std::sin(yaw), 0);
    } else {
      int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
      translation = Vec3<double>((i % columns) * spacing, (i / columns) * spacing, 0);
    }
  }
};

Arrangement read_arrangement(const Element& e, int count) {
  Arrangement out;
  out.kind = e.choice("arrange", {"line", "circle", "grid"}, 0);
  out.spacing = e.number_from_0("spacing", 1);
  out.count = count;
  return out;
}

// Moves the configuration q of a floating base by a rotation by yaw about the world's z, and then by a translation.
void move_base(Eigen::VectorXd& q, const Vec3<double>& translation, double yaw) {
  if (yaw != 0) {
    const double s = std::sin(yaw / 2), c = std::cos(yaw / 2);
    q.head<3>() = rotation_about<double>(Vec3<double>::UnitZ(), yaw) * q.head<3>();
    // Computes the product of (0, 0, s, c), the quaternion x, y, z, w of the yaw, and p.
    const Eigen::Vector4d p = q.segment<4>(3);
    q.segment<4>(3) << c * p[0] - s * p[1], c * p[1] + s * p[0], c * p[2] + s * p[3], c * p[3] - s * p[2];
  }
  q.head<3>() += translation;
}

struct Growing {  // the scene's q, v, u, to which each added robot appends its own
  std::vector<double> q, v, u;
  static void append(std::vector<double>& to, const Eigen::VectorXd& x) {
    to.insert(to.end(), x.data(), x.data() + x.size());
  }
  static Eigen::VectorXd done(const std::vector<double>& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  }
};

void add_copies(const RobotElement& robot, const std::shared_ptr<const Model>& model, SceneFile& out, Growing& all) {
  const Element& e = robot.element;
  const RobotGroup& group = robot.group;
  const double room = std::numeric_limits<int>::max() - static_cast<double>(out.scene.nq);
  if (static_cast<double>(group.count) * model->nq > room)
    e.fail("robot " + quote(group.name) + " brings the scene above 2^31 - 1 coordinates, expected fewer coordinates");
  const Arrangement arrangement = read_arrangement(e, group.count);
  const RobotState state = read_state(robot, *model);
  const SE3<double> base = read_base(e);
  for (int i = 0; i < group.count; ++i) {
    Vec3<double> translation;
    double yaw;
    arrangement.place(i, translation, yaw);
    Eigen::VectorXd q = state.q;
    SE3<double> at;
    const SE3<double> arranged{rotation_about<double>(Vec3<double>::UnitZ(), yaw), translation};
    if (model->floating_base) {
      move_base(q, translation, yaw);
      at = placement_of_pose(q.head<7>());
    } else {
      at = arranged * base;
    }
    const std::string name = group.copied ? group.name + std::to_string(i) : group.name;
    if (out.scene.robot_index.count(name))
      e.where("name").fail("a robot named " + quote(name) + " exists already, expected names used once");
    const int number = add_robot(out.scene, name, model, at);
    if (robot.gravity_torques) out.gravity_robots.push_back(number);
    Growing::append(all.q, q);
    Growing::append(all.v, state.v);
    Growing::append(all.u, state.u);
    out.robot_group.push_back(static_cast<int>(out.robot_groups.size()));
    out.moved.push_back(arranged);
  }
}

// Returns whether a robot's name could also mean a neighbouring copy, as "herd-1" does if `herd` is a copied robot.
bool is_neighbour(const std::string& name, const std::set<std::string>& copied) {
  const std::size_t sign = name.rfind('-');
  return sign != std::string::npos && sign + 1 < name.size() &&
         name.find_first_not_of("0123456789", sign + 1) == std::string::npos && copied.count(name.substr(0, sign)) > 0;
}

// Checks that each name refers to one robot, or to the copies of one robot.
void check_names(const SceneFile& file, const std::unordered_map<std::string, Where>& names) {
  std::set<std::string> copied;
  for (const RobotGroup& group : file.robot_groups)
    if (group.copied) copied.insert(group.name);
  for (const RobotGroup& group : file.robot_groups) {
    const Where& here = names.at(group.name);
    if (group.copied && file.scene.robot_index.count(group.name))
      here.fail("the copied robot " + quote(group.name) + " has the name of another robot, expected names used once");
    if (is_neighbour(group.name, copied) || (group.copied && is_neighbour(group.name + "0", copied)))
      here.fail("robot " + quote(group.name) +
                " has a name that is reserved for neighbours among copies, expected a name that is not "
                "the name of a copied robot with '-' and a number");
  }
}

}  // namespace

void add_name(const Element& e, const std::string& what, const std::string& name,
              std::unordered_map<std::string, Where>& names) {
  const auto [at, is_new] = names.emplace(name, e.where());
  const Where& known = at->second;
  if (!is_new)
    e.where("name").fail(what + " named " + quote(name) + " exists already on line " + std::to_string(known.line) +
                         (*known.file == *e.where().file ? "" : " of " + *known.file) + ", expected names used once");
}

void add_robots(const std::vector<Element>& elements, SceneFile& out) {
  ModelCache models;
  Growing all;
  std::unordered_map<std::string, Where> names;  // key: name of <robot>
  for (const Element& e : elements) {
    RobotElement robot = read_robot(e);
    add_name(e, "a robot", robot.group.name, names);
    robot.group.first = out.scene.nrobots();
    add_copies(robot, models.get(robot, out.findings), out, all);
    out.robot_groups.push_back(robot.group);
  }
  check_names(out, names);
  out.q = Growing::done(all.q);
  out.v = Growing::done(all.v);
  out.u = Growing::done(all.u);
}

}  // namespace manycontact::io
