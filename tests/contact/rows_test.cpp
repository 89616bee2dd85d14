// Contact rows have symmetries: frames, types, swapped bodies, moved worlds, fixed bases, loops.

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/scene_rows.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTight = 512 * kEps;

class Rows : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 rng{GetParam()};
  RandomScene s = random_scene(rng, {.ncontacts = 12});
  SceneRows<double> rows(const Scene& scene) const { return SceneRows<double>(scene, s.q, s.v); }
  // Returns the scene with every contact of this type and frame.
  Scene all(ContactType type, ReferenceFrame frame) const {
    Scene scene = s.scene;
    for (Contact& c : scene.contacts) c.type = type, c.reference_frame = frame;
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(Seed, Rows, testing::Range(9u, 18u));

TEST_P(Rows, VelocityRowsAreTheRelativeVelocity) {
  const SceneRows<double> r = rows(s.scene);
  for (int k = 0; k < r.size(); ++k) {
    const VectorXd nu = selected<double>(s.scene.contacts[k], r.A(k), r.data[k].nu);
    EXPECT_LE(error_of(VectorXd(r.J(k) * s.v), nu), kTight) << k;
    EXPECT_LE(difference_of(MatrixXd(r.data[k].W * r.data[k].Jl), r.data[k].J), kTight);
    EXPECT_LE(error_of(VectorXd(r.data[k].W * r.data[k].x), r.data[k].a0), kTight);
  }
}

TEST_P(Rows, WorldAndLocalWorldAlignedAreTheSame) {
  for (ContactType type : {ContactType::k1D, ContactType::k2D, ContactType::k3D, ContactType::k6D}) {
    const Scene one = all(type, ReferenceFrame::kWorld), other = all(type, ReferenceFrame::kLocalWorldAligned);
    const SceneRows<double> a = rows(one), b = rows(other);
    for (int k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a.data[k].J, b.data[k].J);
      EXPECT_EQ(a.data[k].a0, b.data[k].a0);
    }
  }
}

// Errors and bias accelerations, too, are rotated by oR_A.
TEST_P(Rows, WorldIsLocalTurned) {
  for (ContactType type : {ContactType::k3D, ContactType::k6D}) {
    const Scene local = all(type, ReferenceFrame::kLocal), world = all(type, ReferenceFrame::kWorld);
    const SceneRows<double> l = rows(local), w = rows(world);
    for (int k = 0; k < l.size(); ++k)
      for (int part = 0; part < local.contacts[k].rows(); part += 3) {
        const Mat3<double> R = l.A(k).R;
        EXPECT_LE(error_of(w.J(k).middleRows<3>(part), MatrixXd(R * l.J(k).middleRows<3>(part))), kTight);
        EXPECT_LE(error_of(w.a0(k).segment<3>(part), VectorXd(R * l.a0(k).segment<3>(part))), kTight);
      }
  }
}

TEST_P(Rows, OneAndTwoDKeepComponentsOf3D) {
  for (ReferenceFrame frame : {ReferenceFrame::kLocal, ReferenceFrame::kWorld}) {
    const Scene scene1 = all(ContactType::k1D, frame), scene2 = all(ContactType::k2D, frame),
                scene3 = all(ContactType::k3D, frame);
    const SceneRows<double> one = rows(scene1), two = rows(scene2), three = rows(scene3);
    for (int k = 0; k < three.size(); ++k) {
      const MatrixXd J = three.J(k);
      const VectorXd a0 = three.a0(k);
      const Vec3<double> axis = scene1.contacts[k].axis;
      EXPECT_LE(difference_of(one.J(k), MatrixXd(axis.transpose() * J)), kTight);
      EXPECT_NEAR(one.a0(k)[0], axis.dot(a0), kTight * size_of(a0));
      EXPECT_LE(difference_of(two.J(k).row(0), J.row(0)), kTight);
      EXPECT_LE(difference_of(two.J(k).row(1), J.row(2)), kTight);
      EXPECT_LE(difference_of(two.a0(k), Eigen::Vector2d(a0[0], a0[2])), kTight * size_of(a0));
    }
  }
}

// The whole world is moved and rotated, gravity with it: nothing changes in the bodies' own axes.
TEST_P(Rows, MovingEverythingRigidlyChangesNothing) {
  for (ContactType type : {ContactType::k3D, ContactType::k6D}) {
    const Scene before = all(type, ReferenceFrame::kLocal);
    const SE3<double> T = random_placement(rng, 3);
    Scene after = before;
    VectorXd q = s.q;
    after.gravity = T.R * before.gravity;
    for (Robot& robot : after.robots) {
      robot.base = T * robot.base;
      if (!robot.model->floating_base) continue;
      const auto x = s.q.segment<7>(robot.idx_q);
      const SE3<double> moved_base =
          T * SE3<double>{rotation_of_quaternion<double>(x[3], x[4], x[5], x[6]), x.head<3>()};
      q.segment<7>(robot.idx_q) << moved_base.p, quaternion_of_rotation<double>(moved_base.R);
    }
    for (Contact& c : after.contacts)
      if (c.B.robot < 0) c.B.placement = T * c.B.placement;
    const SceneRows<double> a = rows(before), b(after, q, s.v);
    for (int k = 0; k < a.size(); ++k) {
      EXPECT_LE(error_of(b.J(k), a.J(k)), kTight);
      EXPECT_LE(difference_of(b.a0(k), a.a0(k)), 4 * kTight * std::max(1.0, size_of(a.a0(k))));  // may vanish
    }
  }
}

// Everything is 1e5 m away: the two bodies are as near as before, and only q itself loses digits.
TEST_P(Rows, BodiesInContactFarAwayLoseNoDigits) {
  Scene far = s.scene;
  const Vec3<double> shift(131072, -65536, 0);  // powers of two, q's own rounding is 1e-11
  VectorXd q = s.q;
  for (Robot& robot : far.robots) {
    robot.base.p += shift;
    if (robot.model->floating_base) q.segment<3>(robot.idx_q) += shift;
  }
  const SceneRows<double> a = rows(s.scene), b(far, q, s.v);
  for (int k = 0; k < a.size(); ++k) {
    const Contact& c = s.scene.contacts[k];
    const bool own = c.B.robot == c.A.robot, world = c.B.robot < 0;
    if (!world) {
      EXPECT_LE(difference_of(b.data[k].G, a.data[k].G), own ? kTight : 1e-10);
    }
    EXPECT_LE(error_of(b.J(k), a.J(k)), own || world ? kTight : 1e-10);
  }
}

// ---- loops and fixed bases ------------------------------------------------------------------------------------------

TEST_P(Rows, JointsAboveACommonAncestorHaveNoColumns) {
  const SceneRows<double> r = rows(s.scene);
  for (int k = 0; k < r.size(); ++k) {
    const Contact& c = s.scene.contacts[k];
    const auto ancestors = [&](const Attachment& at) {
      std::vector<int> dofs;
      if (at.robot < 0 || at.joint < 0) return dofs;
      const Model& model = *s.scene.robots[at.robot].model;
      for (int i = 0; i < model.nv; ++i)
        for (int j = at.joint; j >= 0; j = model.joints[j].parent)
          if (model.dof_joint[i] == j) dofs.push_back(i);
      return dofs;
    };
    std::vector<int> a = ancestors(c.A), b = ancestors(c.B), only_a = a, only_b = b;
    if (c.A.robot == c.B.robot) {
      only_a.clear(), only_b.clear();
      std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only_a));
      std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::back_inserter(only_b));
    }
    EXPECT_EQ(r.support[k].a, only_a) << k;
    EXPECT_EQ(r.support[k].b, only_b) << k;
  }
}

// A body on the base link of another robot has the rows of a contact with the world at that base.
TEST(FixedBase, AsBIsAPlaceInTheWorld) {
  std::mt19937 rng(1);
  RandomScene s = random_scene(rng, {.nrobots = 2, .models = {{.floating_base = true}, {}}, .ncontacts = 0});
  for (ContactType type : {ContactType::k3D, ContactType::k6D}) {
    Contact c;
    c.name = "on base link";
    c.type = type;
    c.A = {0, 4, random_placement(rng)};
    c.B = {1, -1, random_placement(rng)};
    c.alpha = 3, c.beta = 2;
    Contact w = c;
    w.name = "in the world";
    w.B = {-1, -1, s.scene.robots[1].base * c.B.placement};
    Scene scene = s.scene;
    add_contact(scene, c);
    add_contact(scene, w);
    const SceneRows<double> r(scene, s.q, s.v);
    EXPECT_TRUE(r.support[0].b.empty());
    EXPECT_LE(error_of(r.J(0), r.J(1)), kTight);
    EXPECT_LE(error_of(r.a0(0), r.a0(1)), kTight);
  }
}

// A is on the base link, the other body is B': only B' moves, and A is at rest.
TEST(FixedBase, AsA) {
  std::mt19937 rng(2);
  RandomScene s = random_scene(rng, {.nrobots = 2, .models = {{}, {.floating_base = true}}, .ncontacts = 0});
  Contact c;
  c.name = "c";
  c.type = ContactType::k3D;
  c.reference_frame = ReferenceFrame::kWorld;
  c.A = {0, -1, random_placement(rng)};
  c.B = {1, 3, random_placement(rng)};
  resolve_reference(s.scene, s.q, true, true, c);  // B' onto A
  add_contact(s.scene, c);
  s.v.segment(s.scene.robots[0].idx_v, s.scene.robots[0].model->nv).setRandom();  // moves the robot, not its base
  const SceneRows<double> r(s.scene, s.q, s.v);
  EXPECT_TRUE(r.support[0].a.empty());
  EXPECT_EQ(size_of(r.data[0].vA), 0);
  // its velocity at A's origin is that of a point contact of B' with the world, with the other sign
  Contact w = c;
  w.name = "w";
  w.A = c.B;
  w.B = {-1, -1, r.A(0)};
  add_contact(s.scene, w);
  const SceneRows<double> both(s.scene, s.q, s.v);
  EXPECT_LE(error_of(both.J(0), MatrixXd(-both.J(1))), kTight);
}

// ---- action and reaction --------------------------------------------------------------------------------------------

// Points coincide without relative velocity, in world axes: swapping A and B' only changes the sign.
TEST_P(Rows, SwappingCoincidentPointsTurnsTheSign) {
  for (int k = 0; k < static_cast<int>(s.scene.contacts.size()); ++k) {
    Contact c = s.scene.contacts[k];
    if (c.B.robot < 0) continue;
    c.type = ContactType::k3D;
    c.reference_frame = ReferenceFrame::kWorld;
    resolve_reference(s.scene, s.q, true, false, c);
    Contact swapped = c;
    std::swap(swapped.A, swapped.B);
    swapped.name = "swapped";
    Scene scene = s.scene;
    scene.contacts = {c, swapped};
    const MatrixXd J = SceneRows<double>(scene, s.q, s.v).J(0);
    const VectorXd v = s.v - least_norm(J, J * s.v);
    const SceneRows<double> r(scene, s.q, v);
    EXPECT_LE(error_of(r.J(1), MatrixXd(-r.J(0))), kTight);
    EXPECT_LE(difference_of(r.a0(1), VectorXd(-r.a0(0))), kTight * std::max(1.0, size_of(r.a0(0)))) << k;
  }
}

TEST_P(Rows, ResolvedReferencesHaveNoError) {
  Scene scene = s.scene;
  for (Contact& c : scene.contacts) resolve_reference(scene, s.q, true, true, c);
  const SceneRows<double> whole = rows(scene);
  for (int k = 0; k < whole.size(); ++k) EXPECT_LE(difference_of(whole.data[k].G, SE3<double>()), kTight);

  Scene partly = s.scene;
  for (Contact& c : partly.contacts) resolve_reference(partly, s.q, true, false, c);
  const SceneRows<double> position = rows(partly);
  for (int k = 0; k < position.size(); ++k) {
    EXPECT_LE(size_of(position.data[k].G.p), kTight);
    EXPECT_EQ(difference_of(partly.contacts[k].B.placement.R, s.scene.contacts[k].B.placement.R), 0);
  }
  for (std::size_t k = 0; k < partly.contacts.size(); ++k) {
    Contact c = s.scene.contacts[k];
    resolve_reference(s.scene, s.q, false, true, c);
    EXPECT_EQ(difference_of(c.B.placement.p, s.scene.contacts[k].B.placement.p), 0);
  }
}

TEST_P(Rows, AllocateNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  SceneRows<double> r = rows(s.scene);
  const auto all = [&] {
    for (int k = 0; k < r.size(); ++k) {
      const Contact& c = s.scene.contacts[k];
      contact_rows<double>(s.scene, c, r.support[k], r.kin[c.A.robot], c.B.robot < 0 ? nullptr : &r.kin[c.B.robot],
                           r.data[k]);
    }
  };
  EXPECT_EQ(allocations(all), 0u);
}

}  // namespace
}  // namespace manycontact::test
