#include "scenes.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "../tests/support/chains.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/urdf.hpp"
#include "settings.hpp"

namespace manycontact::bench {

namespace {

constexpr char kModels[] = MANYCONTACT_SOURCE_DIR "/models/";

std::string robot_file() {
  return settings().robot.empty() ? std::string(kModels) + "humanoid.urdf" : settings().robot;
}

// Returns the positions of the frames in the base, at the neutral configuration.
std::vector<Vec3<double>> frame_places(const Model& model) {
  Kinematics<double> kin(model);
  forward_kinematics<double>(model, {}, neutral(model), kin);
  std::vector<Vec3<double>> places;
  for (const Frame& f : model.frames)
    places.push_back(f.joint < 0 ? f.placement.p : (kin.oMi[f.joint] * f.placement).p);
  return places;
}

// Returns the frame of largest `score` left (y > 0) or right of the base; among equals the deepest in the tree.
template <class Score>
std::string best_frame(const Model& model, bool left, const Score& score) {
  const std::vector<Vec3<double>> places = frame_places(model);
  int best = -1;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (model.frames[k].joint <= 0 || (left ? places[k].y() : -places[k].y()) < 1e-3) continue;
    if (best < 0 || score(places[k]) >= score(places[best]) - 1e-9) best = static_cast<int>(k);
  }
  if (best < 0) throw std::invalid_argument(robot_file() + ": no frame left and right of the base, name --feet A,B");
  return model.frames[best].name;
}

struct Measured {
  std::shared_ptr<const Model> model;
  std::vector<std::string> feet, hands;  // left, right
};

const Measured& measured() {
  static const Measured robot = [] {
    Measured m;
    m.model = std::make_shared<const Model>(load_urdf(robot_file(), {.floating_base = true}));
    m.feet = settings().feet;
    m.hands = settings().hands;
    for (const bool left : {true, false}) {
      if (settings().feet.empty())
        m.feet.push_back(best_frame(*m.model, left, [](const Vec3<double>& p) { return -p.z(); }));
      if (settings().hands.empty())
        m.hands.push_back(best_frame(*m.model, left, [](const Vec3<double>& p) { return std::abs(p.y()); }));
    }
    return m;
  }();
  return robot;
}

void add_in_circle(Scene& scene, const std::shared_ptr<const Model>& model, int count) {
  const double radius = count == 1 ? 0 : 0.5 / std::sin(M_PI / count);  // 1 m apart
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * M_PI * k / count;
    add_robot(scene, "r" + std::to_string(k), model,
              {rotation_about<double>({0, 0, 1}, angle), {radius * std::cos(angle), radius * std::sin(angle), 0}});
  }
}

void hold(Scene& scene, int robot, const std::string& frame, ContactType type, const SE3<double>& offset = {}) {
  Contact c;
  c.name = "hold" + std::to_string(scene.contacts.size());
  c.type = type;
  c.A = attach(scene, scene.robots[robot].name, frame, offset);
  add_contact(scene, c);
}

// Returns the velocity nearest to v, in kinetic energy, that the contacts allow: M v' + J^T l = M v, J v' = 0. These
// are the accelerations of the scene at rest, without weight, under the forces M v.
Eigen::VectorXd allowed(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  Scene massless = scene;
  massless.gravity.setZero();
  for (Contact& c : massless.contacts) c.alpha = c.beta = 0;
  Eigen::VectorXd momentum(scene.nv);
  for (const Robot& r : scene.robots) {
    const Model& model = *r.model;
    Kinematics<double> kin(model);
    std::vector<Vec6<double>> f(model.njoints());
    Eigen::VectorXd tau(model.nv);
    const Eigen::VectorXd at = q.segment(r.idx_q, model.nq), qdd = v.segment(r.idx_v, model.nv);
    rnea<double>(model, r.base, at, Eigen::VectorXd::Zero(model.nv), qdd, Vec3<double>::Zero(), {}, kin, f, tau);
    momentum.segment(r.idx_v, model.nv) = tau;
  }
  SceneData data(massless);
  (void)solve_tau(massless, q, Eigen::VectorXd::Zero(scene.nv), momentum, data);
  return data.a;
}

using Bends = std::map<std::string, double>;  // key: the end of a joint's name

// Bends the joints off the symmetric configuration, each robot with the same noise.
Posed posed(Scene scene, const Bends& bends) {
  Posed s;
  s.scene = std::move(scene);
  s.q = neutral(s.scene);
  s.v.resize(s.scene.nv);
  s.u.resize(s.scene.nu);
  for (const Robot& r : s.scene.robots) {
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> noise(-0.1, 0.1);
    const auto random = [&](int n) { return Eigen::VectorXd::NullaryExpr(n, [&] { return noise(rng); }).eval(); };
    const Model& model = *r.model;
    Eigen::VectorXd from = s.q.segment(r.idx_q, model.nq);
    const Eigen::VectorXd by = random(model.nv);
    for (const Joint& j : model.joints)
      for (const auto& [ending, angle] : bends)
        if (j.name.ends_with(ending) && j.nq() == 1) from[j.idx_q] = angle;
    integrate<double>(model, from, by, s.q.segment(r.idx_q, model.nq));
    s.v.segment(r.idx_v, model.nv) = random(model.nv);
    s.u.segment(r.idx_u, model.nu()) = 50 * random(model.nu());
  }
  resolve_references(s.scene, s.q);
  s.v = allowed(s.scene, s.q, s.v);
  return s;
}

std::shared_ptr<const Model> quadruped() {
  static const auto model = [] {
    Model m = load_urdf(std::string(kModels) + "quadruped.urdf", {.floating_base = true});
    return std::make_shared<const Model>(std::move(m));
  }();
  return model;
}

Posed quadrupeds(int count, int held) {
  Scene scene;
  add_in_circle(scene, quadruped(), count);
  const char* const feet[] = {"LF_foot", "RH_foot", "RF_foot", "LH_foot"};
  for (int c = 0; c < held; ++c) hold(scene, c % count, feet[c / count], ContactType::k3D);
  return posed(std::move(scene), {{"_hip", 0.7}, {"_knee", -1.4}});
}

}  // namespace

std::string robot_name() { return std::filesystem::path(robot_file()).stem(); }

std::string robot_frames() {
  const Measured& m = measured();
  return m.feet[0] + " " + m.feet[1] + ", hands " + m.hands[0] + " " + m.hands[1];
}

Posed robots(int count, bool hand_in_hand) {
  const Measured& m = measured();
  Scene scene;
  add_in_circle(scene, m.model, count);
  for (int k = 0; k < count; ++k)
    for (const std::string& foot : m.feet) hold(scene, k, foot, ContactType::k6D);
  if (hand_in_hand && count > 1)
    for (int k = 0; k < count; ++k) {
      Contact c;
      c.name = "hands" + std::to_string(k);
      c.A = attach(scene, scene.robots[k].name, m.hands[0]);
      c.B = attach(scene, scene.robots[(k + 1) % count].name, m.hands[1]);
      add_contact(scene, c);
    }
  return posed(std::move(scene), {{"_knee", 0.5}});
}

Posed on_points(int points) {
  const Measured& m = measured();
  Scene scene;
  add_in_circle(scene, m.model, 1);
  for (int k = 0; k < points; ++k) {
    const double angle = 2.4 * (k / 2);  // each one is different
    hold(scene, 0, m.feet[k % 2], ContactType::k3D, {{}, {0.1 * std::cos(angle), 0.05 * std::sin(angle), 0}});
  }
  return posed(std::move(scene), {{"_knee", 0.5}});
}

Posed herd_on_feet(int held) { return quadrupeds(16, held); }
Posed herd(int count) { return quadrupeds(count, 4 * count); }

namespace {

void add_box(Scene& scene, double x, double y, double z) {
  static const auto box =
      std::make_shared<const Model>(load_urdf(std::string(kModels) + "box.urdf", {.floating_base = true}));
  add_robot(scene, "b" + std::to_string(scene.nrobots()), box, {Mat3<double>::Identity(), {x, y, z}});
}

// Attaches a point or frame of a box to another box, or to the world (to < 0).
void join(Scene& scene, int box, int to, ContactType type, const Vec3<double>& at) {
  const auto name = [&scene](int k) { return scene.robots[static_cast<std::size_t>(k)].name; };
  Contact c;
  c.name = "c" + std::to_string(scene.contacts.size());
  c.type = type;
  c.A = attach(scene, name(box), "crate", {Mat3<double>::Identity(), at});
  if (to >= 0) c.B = attach(scene, name(to), "crate");
  add_contact(scene, c);
}

void stand(Scene& scene, int box, int to, double half = 0.15) {
  for (const double x : {-half, half})
    for (const double y : {-half, half}) join(scene, box, to, ContactType::k3D, {x, y, -0.2});
}

}  // namespace

Posed tower(int boxes) {
  Scene scene;
  for (int k = 0; k < boxes; ++k) add_box(scene, 0, 0, 0.4 * k);
  for (int k = 0; k < boxes; ++k) stand(scene, k, k - 1);
  return posed(std::move(scene), {});
}

Posed table(int boxes) {
  Scene scene;
  const int side = static_cast<int>(std::ceil(std::sqrt(boxes)));
  add_box(scene, 0, 0, 0);
  stand(scene, 0, -1, 0.5 * side);
  for (int k = 0; k < boxes; ++k) add_box(scene, 0.5 * (k % side), 0.5 * (k / side), 0.4);
  for (int k = 0; k < boxes; ++k) stand(scene, k + 1, 0);
  return posed(std::move(scene), {});
}

Posed wall(int boxes) {
  Scene scene;
  const int side = static_cast<int>(std::lround(std::sqrt(boxes)));
  for (int k = 0; k < boxes; ++k) add_box(scene, 0.4 * (k % side), 0, 0.4 * (k / side));
  for (int k = 0; k < boxes; ++k) {
    if (k < side) join(scene, k, -1, ContactType::k6D, {0, 0, -0.2});
    if (k >= side) join(scene, k, k - side, ContactType::k3D, {0, 0, -0.2});
    if (k % side) join(scene, k, k - 1, ContactType::k3D, {-0.2, 0, 0});
  }
  return posed(std::move(scene), {});
}

Posed chain(int links) {
  test::ChainOptions options;
  options.links = links;
  test::Chain c = make_chain(options);
  resolve_references(c.scene, c.q);
  Posed s{std::move(c.scene), std::move(c.q), std::move(c.v), std::move(c.u)};
  s.v = allowed(s.scene, s.q, s.v);
  return s;
}

}  // namespace manycontact::bench
