#include "scene_of_bytes.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "manycontact/detail/contact/reference.hpp"

namespace manycontact::fuzz {

namespace {

// Bytes are read from the front; zeros follow the end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  int byte() { return at_ == end_ ? 0 : *at_++; }
  int below(int n) { return byte() % n; }
  bool one_in(int n) { return byte() % n == n - 1; }

  // Bytes below 200 are numbers within +-2, the others are special ones as far as `wild` allows.
  double number(int wild) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    static constexpr double kSpecial[] = {0,      1,     -1,     1e-3,  -1e3,      1e-6,       1e6,    -1e6,
                                          1e-9,   1e9,   1e-12,  -1e12, 1e-20,     1e20,       1e-150, 1e150,
                                          1e-300, 1e300, 5e-324, -0.0,  kInfinity, -kInfinity, kNan,   1e-8};
    constexpr int kCount[] = {3, 8, 24};
    const int b = byte();
    if (b < 200) return (b - 100) / 50.0;
    if (wild == 2 && b == 255) {
      std::uint64_t bits = 0;
      for (int i = 0; i < 8; ++i) bits = bits << 8 | static_cast<unsigned>(byte());
      double x;
      std::memcpy(&x, &bits, sizeof x);
      return x;
    }
    return kSpecial[(b - 200) % kCount[wild]];
  }
  Vec3<double> point(int wild) {
    const double x = number(wild), y = number(wild), z = number(wild);
    return {x, y, z};
  }
  // Returns a unit quaternion, or any four numbers if `wild` is 2 and they have no direction.
  Eigen::Vector4d quaternion(int wild) {
    if (one_in(3)) return {0, 0, 0, 1};
    Eigen::Vector4d quat;
    for (double& x : quat) x = number(wild);
    const double norm = quat.stableNorm();
    if (norm > 1e-3 && norm < 1e3) return quat / norm;
    return wild == 2 ? quat : Eigen::Vector4d(0, 0, 0, 1);
  }
  SE3<double> placement(int wild) {
    const Eigen::Vector4d r = quaternion(std::min(wild, 1));
    return {rotation_of_quaternion(r[0], r[1], r[2], r[3]), point(wild)};
  }

 private:
  const std::uint8_t *at_, *end_;
};

// Returns a rotated box: m/12 (b^2 + c^2), ...; massless if its number is 0, a point or a stick if sides are.
Inertia<double> inertia(Bytes& in, int wild) {
  const double mass = std::abs(in.number(wild));
  const Vec3<double> sides2 = in.point(wild).cwiseAbs2();
  const Vec3<double> principal = mass / 12 * (sides2.sum() - sides2.array());
  const SE3<double> at = in.placement(wild);
  return Inertia<double>::from_com(mass, mass > 0 ? at.p : Vec3<double>::Zero(),
                                   at.R * principal.asDiagonal() * at.R.transpose());
}

std::shared_ptr<const Model> model(Bytes& in, int wild) {
  constexpr JointType kTypes[] = {JointType::kRevolute,  JointType::kRevolute, JointType::kRevolute,
                                  JointType::kPrismatic, JointType::kPlanar,   JointType::kFloating};
  Model model;
  model.name = "made";
  model.floating_base = in.below(2) == 0;
  const int njoints = 1 + in.below(8);
  for (int i = 0; i < njoints; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i - 1;
    for (int up = in.below(4); up > 1 && joint.parent > (model.floating_base ? 0 : -1); --up)
      joint.parent = model.joints[static_cast<std::size_t>(joint.parent)].parent;
    if (i == 0 && model.floating_base) {
      joint.type = JointType::kFloating;
    } else {
      joint.type = kTypes[in.below(6)];
      joint.placement = in.placement(wild);
      joint.axis = in.one_in(2) ? in.point(0) : Vec3<double>(Vec3<double>::Unit(in.below(3)));
      const double length = joint.axis.norm();
      joint.axis = length > 0.01 ? Vec3<double>(joint.axis / length) : Vec3<double>::UnitZ();
    }
    joint.inertia = inertia(in, wild);
    const auto all = [&](double x) { return Eigen::VectorXd::Constant(joint.nv(), x); };
    joint.upper = joint.velocity_limit = joint.effort_limit = all(std::numeric_limits<double>::infinity());
    joint.lower = -joint.upper;
    model.joints.push_back(std::move(joint));
  }
  finalize(model);
  const double armature = in.one_in(3) ? std::abs(in.number(wild)) : 0;
  for (int i = model.first_actuated(); i < model.nv; ++i) model.armature[i] = armature;
  return std::make_shared<const Model>(std::move(model));
}

Eigen::VectorXd configuration(Bytes& in, const Model& model, int wild) {
  Eigen::VectorXd q(model.nq);
  for (const Joint& joint : model.joints) {
    for (int k = 0; k < joint.nq(); ++k) q[joint.idx_q + k] = k < 3 ? in.number(wild) : 0;
    if (joint.type == JointType::kFloating) q.segment<4>(joint.idx_q + 3) = in.quaternion(wild);
  }
  return q;
}

Attachment body(Bytes& in, const Scene& scene, int wild) {
  const int robot = in.below(scene.nrobots());
  const Model& model = *scene.robots[static_cast<std::size_t>(robot)].model;
  const int joint = in.below(model.njoints() + !model.floating_base) - !model.floating_base;
  return {robot, joint, in.placement(wild)};
}

// Returns a contact of any kind, or an earlier one again, perhaps in other axes or with another request.
Contact contact(Bytes& in, const MadeScene& made) {
  const Scene& scene = made.scene;
  Contact c;
  if (!scene.contacts.empty() && in.one_in(4)) {
    c = scene.contacts[static_cast<std::size_t>(in.below(static_cast<int>(scene.contacts.size())))];
    if (in.one_in(2)) c.B.placement.p += in.point(made.wild);
    if (in.one_in(2)) c.alpha = in.number(made.wild);
    if (in.one_in(2)) c.A.placement.p += 1e-3 * in.point(made.wild);
  } else {
    c.type = static_cast<ContactType>(in.below(4));
    c.A = body(in, scene, made.wild);
    if (in.one_in(2)) c.B = body(in, scene, made.wild);
    if (c.type == ContactType::k1D) c.axis = in.point(made.wild);
    if (in.one_in(2)) c.alpha = in.number(made.wild), c.beta = in.number(made.wild);
    const int given = in.below(4);
    resolve_reference(scene, made.q, given != 0, given != 1, c);
  }
  c.reference_frame = static_cast<ReferenceFrame>(in.below(3));
  c.name = "contact" + std::to_string(scene.contacts.size());
  c.active = !in.one_in(8);
  return c;
}

}  // namespace

MadeScene scene_of_bytes(const std::uint8_t* data, std::size_t size) {
  Bytes in(data, size);
  MadeScene made;
  made.wild = in.below(3);
  const int wild = made.wild;
  constexpr double kDampings[] = {0, 0, 0, 0, 1e-12, 1e-6, 1e-3, 1};
  made.scene.damping = in.one_in(16) ? in.number(wild) : kDampings[in.below(8)];
  if (in.one_in(4)) made.scene.gravity = in.point(wild);

  std::shared_ptr<const Model> last;
  for (int r = 0, n = 1 + in.below(3); r < n; ++r) {
    if (!last || !in.one_in(3)) last = model(in, wild);
    SE3<double> base = in.placement(wild);
    if (!base.p.allFinite()) base.p.setZero();
    (void)add_robot(made.scene, "r" + std::to_string(r), last, base);
    made.q.conservativeResize(made.scene.nq);
    made.q.tail(last->nq) = configuration(in, *last, wild);
  }
  const auto numbers = [&](int n) {
    const bool any = !in.one_in(2);
    return Eigen::VectorXd::NullaryExpr(n, [&] { return any ? in.number(wild) : 0; }).eval();
  };
  made.v = numbers(made.scene.nv);
  made.u = numbers(made.scene.nu);
  for (int c = in.below(9); c > 0; --c) try {
      (void)add_contact(made.scene, contact(in, made));
    } catch (const std::invalid_argument&) {  // e.g. a body attached to itself
    }
  return made;
}

}  // namespace manycontact::fuzz
