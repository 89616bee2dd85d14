#include <cmath>
#include <limits>

#include "manycontact/spatial/rpy.hpp"
#include "scene_parts.hpp"

namespace manycontact::io {

void normalise_quaternion(const Where& where, const std::string& what, Eigen::Ref<Eigen::Vector4d> quat) {
  const double norm = quat.norm();
  if (!(std::abs(norm - 1) <= 1e-6))
    where.fail(what + " has length " + show(norm) + ", expected a unit quaternion x y z w (within 1e-6)");
  quat /= norm;
}

ReferenceFrame read_reference_frame(const Element& e) {
  return static_cast<ReferenceFrame>(e.choice("reference_frame", {"local", "world", "local_world_aligned"}, 0));
}

bool read_quaternion(const Element& e, const char* attribute, Mat3<double>& R) {
  Eigen::Vector4d quat;
  if (!e.read(attribute, quat)) return false;
  normalise_quaternion(e.where(attribute), e.label(attribute), quat);
  R = rotation_of_quaternion(quat[0], quat[1], quat[2], quat[3]);
  return true;
}

SE3<double> read_base(const Element& robot) {
  SE3<double> base;
  (void)robot.read("xyz", base.p);
  if (const auto rpy = robot.numbers<3>("rpy")) base.R = rotation_of_rpy((*rpy)[0], (*rpy)[1], (*rpy)[2]);
  return base;
}

namespace {

// A part of the state, q, v or u: its letter, the number of values per joint, and the index of a joint's first value.
struct Quantity {
  const char* letter;
  int (*count)(const Joint&);
  int (*begin)(const Model&, const Joint&);
};

const Quantity kQ{"q", [](const Joint& j) { return j.nq(); }, [](const Model&, const Joint& j) { return j.idx_q; }};
const Quantity kV{"v", [](const Joint& j) { return j.nv(); }, [](const Model&, const Joint& j) { return j.idx_v; }};
const Quantity kU{"u", [](const Joint& j) { return j.nv(); },
                  [](const Model& m, const Joint& j) { return m.torque_index(j); }};

class StateReader {
 public:
  StateReader(const RobotElement& robot, const Model& model) : robot_(robot), model_(model) {
    for (int i = 0; i < model.njoints(); ++i) index_.emplace(model.joints[i].name, i);
  }

  RobotState read() {
    RobotState state{neutral(model_), Eigen::VectorXd::Zero(model_.nv), Eigen::VectorXd::Zero(model_.nu())};
    for (const auto& [name, element] : robot_.joints) (void)joint(name, element);
    const bool base_given = read_quantity(kQ, state.q);
    read_quantity(kV, state.v);
    read_quantity(kU, state.u);
    if (robot_.gravity_torques) state.u.setConstant(std::numeric_limits<double>::quiet_NaN());
    normalise(state.q);
    const Element& e = robot_.element;
    if (!model_.floating_base || (!e.has("xyz") && !e.has("rpy"))) return state;
    const char* placed = e.has("xyz") ? "xyz" : "rpy";
    if (base_given) e.refuse(placed, " and q both place the floating base, expected only one of the two");
    state.q.head<7>() = pose_of_placement(read_base(e));
    return state;
  }

 private:
  const Joint& joint(const std::string& name, const Element& element) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return model_.joints[found->second];
    element.where("name").fail(no_joint(model_, name));
  }

  // Fills x from the child <q> (<v>, <u>) or from attributes of <joint>. Returns whether the floating base was given.
  bool read_quantity(const Quantity& what, Eigen::VectorXd& x) {
    const bool floating = model_.floating_base;
    const auto whole = robot_.element.child(what.letter);
    if (whole) {
      const std::string label = std::string("<") + what.letter + "> of robot " + quote(robot_.group.name);
      const auto values = parse_numbers(whole->where(), label, whole->text(), static_cast<std::size_t>(x.size()));
      x = Eigen::Map<const Eigen::VectorXd>(values.data(), x.size());
    }
    bool base_given = whole && floating;
    for (const auto& [name, element] : robot_.joints) {
      if (!element.has(what.letter)) continue;
      const Where here = element.where(what.letter);
      if (whole)
        here.fail("joint " + quote(name) + " has " + what.letter + "=, and <" + what.letter +
                  "> also gives this value, expected only one of the two");
      const Joint& j = joint(name, element);
      const bool base = floating && j.idx_v == 0;
      if (base && what.letter == kU.letter)
        here.fail("joint " + quote(name) + " is the floating base, expected u of an actuated joint");
      if (!j.actuated && what.letter == kU.letter)
        here.fail("joint " + quote(name) + " is passive, expected u of an actuated joint");
      const std::string label = std::string(what.letter) + " of joint " + quote(name);
      const auto values =
          parse_numbers(here, label, element.required(what.letter), static_cast<std::size_t>(what.count(j)));
      std::copy(values.begin(), values.end(), x.data() + what.begin(model_, j));
      base_given = base_given || base;
    }
    return base_given;
  }

  void normalise(Eigen::VectorXd& q) const {  // normalises the quaternions of floating joints
    for (const Joint& j : model_.joints) {
      if (j.type != JointType::kFloating) continue;
      Where here = robot_.element.where();
      if (const auto whole = robot_.element.child("q")) here = whole->where();
      const auto own = robot_.joints.find(j.name);
      if (own != robot_.joints.end() && own->second.has("q")) here = own->second.where("q");
      const std::string what = "the quaternion of joint " + quote(j.name) + " of robot " + quote(robot_.group.name);
      normalise_quaternion(here, what, q.segment<4>(j.idx_q + 3));
    }
  }

  const RobotElement& robot_;
  const Model& model_;
  std::map<std::string, int> index_;
};

}  // namespace

RobotState read_state(const RobotElement& robot, const Model& model) { return StateReader(robot, model).read(); }

}  // namespace manycontact::io
