// Input without a solution is refused, with a reason, and only in the islands concerned.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/islands.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Robots 0 and 2 are tied together, 1 and 3 are fixed to the world: three islands.
RandomScene three_islands() {
  std::mt19937 rng(81);
  SceneOptions options;
  options.nrobots = 4;
  options.ncontacts = 0;
  ModelOptions model;
  model.floating_base = true;
  options.models = {model};
  RandomScene s = random_scene(rng, options);
  const int partner[] = {2, -1, -1, -1};
  for (int r : {0, 1, 3}) {
    Contact c;
    c.name = "hold" + std::to_string(r);
    c.type = r == 3 ? ContactType::k3D : ContactType::k6D;
    c.A = {r, 4, random_placement(rng, 0.2)};
    if (partner[r] >= 0) c.B = {partner[r], 3, {}};
    resolve_reference(s.scene, s.q, true, true, c);
    add_contact(s.scene, c);
  }
  return s;
}

bool none_finite(const Eigen::VectorXd& x) { return !x.array().isFinite().any(); }

// Expects that only island `bad` failed, for `reason`; the others have the bits they had.
void expect_failed_alone(const Scene& scene, const SceneData& data, const SceneData& before, int bad, Reason reason) {
  EXPECT_EQ(data.report.status, Status::kFailed);
  for (double left : {data.report.backward_error, data.report.residual_dynamics, data.report.residual_contact})
    EXPECT_TRUE(std::isnan(left)) << left;  // whichever island it is
  const std::vector<Island> islands = islands_at(scene, data);
  ASSERT_EQ(islands.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE("island " + std::to_string(i));
    const IslandReport& report = data.report.islands[i];
    EXPECT_EQ(report.status, i == bad ? Status::kFailed : Status::kOk);
    if (i == bad) {
      EXPECT_EQ(report.reason, reason) << to_string(report.reason);
    }
    for (int r : islands[i].robots) {
      const Robot& robot = scene.robots[r];
      const auto a = data.a.segment(robot.idx_v, robot.model->nv);
      EXPECT_TRUE(i == bad ? none_finite(a) : a == before.a.segment(robot.idx_v, robot.model->nv));
    }
    for (int c : islands[i].contacts) {
      const auto f = data.f.segment(data.f_offset[c], scene.contacts[c].rows());
      EXPECT_TRUE(i == bad ? none_finite(f) : f == before.f.segment(data.f_offset[c], scene.contacts[c].rows()));
    }
  }
}

void expect_all_failed(const SceneData& data, Reason reason) {
  EXPECT_EQ(data.report.status, Status::kFailed);
  EXPECT_TRUE(none_finite(data.a));
  EXPECT_TRUE(none_finite(data.f));
  for (const IslandReport& report : data.report.islands) EXPECT_EQ(report.status, Status::kFailed);
  EXPECT_EQ(data.report.islands[0].reason, reason) << to_string(data.report.islands[0].reason);
}

// Returns the island of a coordinate of q (nq), v (nv) or u (nu), found with the scene's offsets.
int island_moved_by(const Scene& scene, const SceneData& data, int which, int k) {
  int r = scene.nrobots() - 1;
  const auto first = [&](const Robot& robot) {
    return which == 0 ? robot.idx_q : which == 1 ? robot.idx_v : robot.idx_u;
  };
  while (first(scene.robots[r]) > k) --r;
  return island_numbers(scene, data.active)[r];
}

TEST(Failure, NotFinite) {
  const RandomScene s = three_islands();
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData before(s.scene, way.options), data(s.scene, way.options);
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, before).status, Status::kOk);
    for (int which = 0; which < 3; ++which) {
      const int size = which == 0 ? s.scene.nq : which == 1 ? s.scene.nv : s.scene.nu;
      for (int k = 0; k < size; ++k) {
        SCOPED_TRACE(std::string(1, "qvu"[which]) + std::to_string(k));
        for (double bad : {kNaN, kInf, -kInf}) {
          Eigen::VectorXd x[] = {s.q, s.v, s.u};
          x[which][k] = bad;
          (void)solve(s.scene, x[0], x[1], x[2], data);
          if (way.options.method == Method::kDenseSchur) {
            expect_all_failed(data, Reason::kNotFinite);
          } else {
            expect_failed_alone(s.scene, data, before, island_moved_by(s.scene, data, which, k), Reason::kNotFinite);
          }
        }
      }
    }
    EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);  // no trace of it remains
    EXPECT_TRUE(data.a == before.a);
    EXPECT_TRUE(data.f == before.f);
  }
}

// The bias of this finite input overflows.
TEST(Failure, Overflow) {
  const RandomScene s = three_islands();
  Eigen::VectorXd v = s.v;
  v[s.scene.robots[1].idx_v + 3] = 1e200;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData before(s.scene, way.options), data(s.scene, way.options);
    (void)solve(s.scene, s.q, s.v, s.u, before);
    (void)solve(s.scene, s.q, v, s.u, data);
    if (way.options.method == Method::kDenseSchur) {
      EXPECT_EQ(data.report.status, Status::kFailed);
    } else {
      expect_failed_alone(s.scene, data, before, island_with_robot(data, 1), Reason::kNotFinite);
    }
  }
}

TEST(Failure, QuaternionNotOfUnitLength) {
  const RandomScene s = three_islands();
  const int at = s.scene.robots[3].idx_q + 3;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData before(s.scene, way.options), data(s.scene, way.options);
    (void)solve(s.scene, s.q, s.v, s.u, before);
    for (double length : {0.0, 0.5, 1 - 2e-6, 1 + 2e-6, 3.0, 1e200}) {
      SCOPED_TRACE(length);
      Eigen::VectorXd q = s.q;
      q.segment<4>(at) *= length;
      (void)solve(s.scene, q, s.v, s.u, data);
      if (way.options.method == Method::kDenseSchur) {
        expect_all_failed(data, Reason::kBadQuaternion);
      } else {
        expect_failed_alone(s.scene, data, before, island_with_robot(data, 3), Reason::kBadQuaternion);
      }
    }
    Eigen::VectorXd q = s.q;
    q.segment<4>(at) *= 1 + 5e-7;  // accepted as a unit quaternion, and used as if it were one
    EXPECT_EQ(solve(s.scene, q, s.v, s.u, data).status, Status::kOk);
    EXPECT_LE(error_of(data.a, before.a), 1e-12);
  }
}

TEST(Failure, WrongSizes) {
  const RandomScene s = three_islands();
  SceneData data(s.scene);
  for (int which = 0; which < 3; ++which)
    for (int change : {-1, 1, -1000}) {
      Eigen::VectorXd x[] = {s.q, s.v, s.u};
      x[which].conservativeResize(std::max<Eigen::Index>(0, x[which].size() + change));
      EXPECT_THROW((void)solve(s.scene, x[0], x[1], x[2], data), std::invalid_argument);
    }
  EXPECT_THROW(quasi_static(s.scene, s.v), std::invalid_argument);
  data.active.pop_back();
  EXPECT_THROW((void)solve(s.scene, s.q, s.v, s.u, data), std::invalid_argument);
  data.active.assign(s.scene.contacts.size(), 1);
  EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
}

// ---- singular inertias ---------------------------------------------------------------------------------------------

// Returns a slider of 2 kg along x that carries a massless one along y.
std::shared_ptr<const Model> massless_slider() {
  Model model;
  model.joints.resize(2);
  for (int i = 0; i < 2; ++i) {
    model.joints[i].name = "slide" + std::to_string(i);
    model.joints[i].type = JointType::kPrismatic;
    model.joints[i].axis = Vec3<double>::Unit(i);
    model.joints[i].parent = i - 1;
  }
  model.joints[0].inertia = Inertia<double>::from_com(2, Vec3<double>::Zero(), Mat3<double>::Identity());
  finalize(model);
  return std::make_shared<Model>(model);
}

Contact hold(ContactType type, int joint, const Vec3<double>& axis = Vec3<double>::UnitZ()) {
  Contact c;
  c.name = "hold";
  c.type = type;
  c.axis = axis;
  c.A = {0, joint, {}};
  return c;
}

TEST(SingularInertia, Free) {
  for (double damping : {0.0, 1e-3}) {
    Scene scene;
    scene.damping = damping;
    add_robot(scene, "r", massless_slider());
    add_contact(scene, hold(ContactType::k1D, 1, {1, 0, 0}));  // it constrains the wrong direction
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(scene, way.options);
      (void)solve(scene, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d(3, 0), data);
      expect_all_failed(data, Reason::kSingularInertia);
      data.active = {0};
      (void)solve(scene, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d(3, 0), data);
      expect_all_failed(data, Reason::kSingularInertia);
    }
  }
}

TEST(SingularInertia, HeldByAContact) {
  for (double damping : {0.0, 1e-3}) {
    Scene scene;
    scene.damping = damping;
    add_robot(scene, "r", massless_slider());
    Contact c = hold(ContactType::k1D, 1, {0, 1, 0});
    c.beta = 4;
    add_contact(scene, c);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(scene, way.options);
      (void)solve(scene, Eigen::Vector2d::Zero(), Eigen::Vector2d(0, 0.5), Eigen::Vector2d(3, 7), data);
      if (way.options.method == Method::kDenseSchur) {  // it factorizes M by itself
        expect_all_failed(data, Reason::kSingularInertia);
        continue;
      }
      EXPECT_EQ(data.report.status, Status::kOk);
      EXPECT_LE(error_of(data.a, Eigen::Vector2d(1.5, -2 + damping * 7)), 4 * kEps);
      EXPECT_LE(error_of(data.f, Eigen::Matrix<double, 1, 1>(-7)), 4 * kEps);
    }
  }
}

// On random trees the last body is massless, free or constrained in all directions.
TEST(SingularInertia, MasslessLastLink) {
  for (int seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(90 + seed);
    ModelOptions options;
    options.floating_base = seed % 2;
    options.types = {JointType::kRevolute, JointType::kPrismatic};
    auto model = std::make_shared<Model>(random_model(rng, options));
    const int last = model->njoints() - 1;
    model->joints[last].inertia = {};
    RandomScene s;
    add_robot(s.scene, "r", model);
    s.q = random_configuration(*model, rng);
    s.v = random_vector(s.scene.nv, rng);
    s.u = random_vector(s.scene.nu, rng, 5);
    // the 1D axis is along the last joint's motion: along the slide, or along the circle of a point off the axis
    Contact c = hold(ContactType::k1D, last);
    const bool slides = model->joints[last].type == JointType::kPrismatic;
    const Vec3<double> axis = model->joints[last].axis, off = axis.unitOrthogonal();
    c.A.placement.p = off;
    c.axis = slides ? axis : axis.cross(off);
    resolve_reference(s.scene, s.q, true, true, c);
    add_contact(s.scene, c);
    const Truth<Quad> truth = solve_truth<Quad>(s.scene, {1}, s.q.cast<Quad>(), s.v.cast<Quad>(), s.u.cast<Quad>());
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(s.scene, way.options);
      (void)solve(s.scene, s.q, s.v, s.u, data);
      if (way.options.method == Method::kDenseSchur) {
        expect_all_failed(data, Reason::kSingularInertia);
      } else {
        EXPECT_EQ(data.report.status, Status::kOk);
        const Errors e = errors<Quad>(s.scene, data, truth.a, truth.f, conditions(s.scene, data));
        EXPECT_LE(e.excess, 1) << e;
      }
      data.active = {0};
      (void)solve(s.scene, s.q, s.v, s.u, data);
      expect_all_failed(data, Reason::kSingularInertia);
    }
  }
}

// ---- next to nothing -----------------------------------------------------------------------------------------------

TEST(Empty, Scene) {
  const Scene scene;
  const Eigen::VectorXd none;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    EXPECT_EQ(solve(scene, none, none, none, data).status, Status::kOk);
    estimate_condition(scene, data);
    EXPECT_EQ(quasi_static(scene, none).size(), 0);
  }
}

// A robot that cannot move has another one attached to it.
TEST(Empty, RobotWithoutJoints) {
  Model model;
  finalize(model);
  Scene scene;
  add_robot(scene, "wall", std::make_shared<Model>(model));
  add_robot(scene, "r", massless_slider());
  scene.robots[1].model = [] {
    Model m = *massless_slider();
    m.joints[1].inertia.m = 1;
    finalize(m);
    return std::make_shared<Model>(m);
  }();
  Contact c = hold(ContactType::k3D, 1);
  c.A.robot = 1;
  c.B = {0, -1, {}};
  add_contact(scene, c);
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    (void)solve(scene, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d(1, 2), data);
    if (way.options.method == Method::kDenseSchur) {
      EXPECT_EQ(data.report.status, Status::kFailed);
      continue;
    }
    EXPECT_EQ(data.report.status, Status::kRedundant);  // the slider does not move along z
    EXPECT_EQ(data.report.rank, 2);
    EXPECT_LE(size_of(data.a), 1e-15);
    EXPECT_LE(difference_of(data.f, Eigen::Vector3d(-1, -2, 0)), 1e-15);
  }
}

}  // namespace
}  // namespace manycontact::test
