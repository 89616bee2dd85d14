// Contact rows agree with the motion that they describe, from differences in quadruple precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "contact/scene_rows.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact::test {
namespace {

using VectorQ = VecX<Quad>;
using MotionQ = Vec6<Quad>;

// Placements in a scene are rotations to double precision only; differences below are accurate to 1e-15.
constexpr double kTightQuad = 1e-13;

class Scenes : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 rng{GetParam()};
  RandomScene s = random_scene(rng, {.ncontacts = 12});
  const Scene& scene = s.scene;
  VectorQ q = s.q.cast<Quad>(), v = s.v.cast<Quad>(), a = random_vector(s.scene.nv, rng).cast<Quad>();

  /// Returns the rows at q (+) (t v + t^2/2 a), with velocity v + t a.
  SceneRows<Quad> at(const Quad& t) const {
    return SceneRows<Quad>(scene, moved<Quad>(scene, q, t * v + (t * t / Quad(2)) * a), v + t * a);
  }
  /// Returns the size of the terms of a0; they cancel where little moves.
  static double terms(const SceneRows<Quad>& rows, int k) {
    return std::max({size_of(rows.data[k].aA), size_of(rows.data[k].aB), size_of(rows.data[k].a0)});
  }
  Scene scene_without_gains() const {
    Scene bare = scene;
    for (Contact& c : bare.contacts) c.alpha = c.beta = 0;
    return bare;
  }
};
INSTANTIATE_TEST_SUITE_P(Seed, Scenes, testing::Range(9u, 18u));

TEST(RandomScenes, HoldEveryKindOfContact) {
  std::set<std::pair<ContactType, ReferenceFrame>> kinds;
  int world = 0, loops = 0, pairs = 0, base_as_A = 0;
  for (unsigned seed = 9; seed < 18; ++seed) {
    std::mt19937 rng(seed);
    const Scene scene = random_scene(rng, {.ncontacts = 12}).scene;
    for (const Contact& c : scene.contacts) {
      kinds.insert({c.type, c.reference_frame});
      (c.B.robot < 0 ? world : c.B.robot == c.A.robot ? loops : pairs)++;
      base_as_A += c.A.joint < 0;
    }
  }
  EXPECT_EQ(kinds.size(), 13u);
  EXPECT_GE(world, 10);
  EXPECT_GE(loops, 5);
  EXPECT_GE(pairs, 5);
  EXPECT_GE(base_as_A, 1);
}

// nu is the rate of G = B'MA in A's axes; every column of J is that rate for one coordinate alone.
TEST_P(Scenes, JacobianIsTheRelativeMotionsDerivative) {
  const Quad h(1e-10);
  const SceneRows<Quad> now(scene, q, v);
  const auto differences = [&](const VectorQ& direction, auto&& check) {
    const SceneRows<Quad> forth(scene, moved<Quad>(scene, q, h * direction), v);
    const SceneRows<Quad> back(scene, moved<Quad>(scene, q, -h * direction), v);
    for (int k = 0; k < now.size(); ++k)
      check(k, MotionQ(log6<Quad>(back.G(k).inverse() * forth.G(k)) / (Quad(2) * h)));
  };
  differences(v, [&](int k, const MotionQ& rate) { EXPECT_LE(error_of(now.data[k].nu, rate), kTightQuad) << k; });
  for (int i = 0; i < scene.nv; ++i)
    differences(VectorQ::Unit(scene.nv, i), [&](int k, const MotionQ& rate) {
      EXPECT_LE(difference_of(now.J(k).col(i), selected(scene.contacts[k], now.A(k), rate)), kTightQuad) << k << ' ' << i;
    });
  for (int k = 0; k < now.size(); ++k) {
    EXPECT_LE(difference_of(now.data[k].G, now.G(k)), 1e-30);
    EXPECT_LE(error_of(VectorQ(now.J(k) * v), selected(scene.contacts[k], now.A(k), now.data[k].nu)), kTightQuad);
  }
}

// J a + a0 without gains is the second derivative of the constrained quantity: log6(G0^-1 G) for 6D, and A's origin as
// seen from B' (then rotated into A's axes) for points. Only placements are differenced, no velocities.
TEST_P(Scenes, AccelerationRowsAreTheSecondDerivative) {
  const Quad h(1e-9);
  const Scene bare = scene_without_gains();
  const SceneRows<Quad> now(bare, q, v), forth = at(h), back = at(-h);
  for (int k = 0; k < now.size(); ++k) {
    const Contact& c = bare.contacts[k];
    const SE3<Quad> G0 = now.G(k), Gf = forth.G(k), Gb = back.G(k);
    MotionQ second = MotionQ::Zero();
    if (c.type == ContactType::k6D)
      second = (log6<Quad>(G0.inverse() * Gf) + log6<Quad>(G0.inverse() * Gb)) / (h * h);
    else
      second.head<3>() = G0.R.transpose() * Vec3<Quad>((Gf.p - Quad(2) * G0.p + Gb.p) / (h * h));
    if (c.type == ContactType::k5D)
      second.tail<3>() =
          (log3<Quad>(Mat3<Quad>(G0.R.transpose() * Gf.R)) + log3<Quad>(Mat3<Quad>(G0.R.transpose() * Gb.R))) / (h * h);
    const VectorQ actual = now.J(k) * a + now.a0(k);
    EXPECT_LE(difference_of(actual, selected(c, now.A(k), second)), kTightQuad * terms(now, k)) << k;
    EXPECT_GT(size_of(actual), 1e-6 * terms(now, k));
  }
}

TEST_P(Scenes, AccelerationRowsOf6DAreTheRateOfNu) {
  const Quad h(1e-10);
  const Scene bare = scene_without_gains();
  const SceneRows<Quad> now(bare, q, v), forth = at(h), back = at(-h);
  for (int k = 0; k < now.size(); ++k) {
    const Contact& c = bare.contacts[k];
    if (c.type != ContactType::k6D) continue;
    const MotionQ rate = (forth.data[k].nu - back.data[k].nu) / (Quad(2) * h);
    EXPECT_LE(difference_of(VectorQ(now.J(k) * a + now.a0(k)), selected(c, now.A(k), rate)), kTightQuad * terms(now, k))
        << k;
  }
}

// Each gain alone adds its error: alpha the placement error, beta the relative velocity.
TEST_P(Scenes, GainsAddPositionAndVelocityErrors) {
  const Scene bare = scene_without_gains();
  const SceneRows<Quad> without(bare, q, v);
  for (bool position : {true, false}) {
    Scene one = bare;
    for (Contact& c : one.contacts) (position ? c.alpha : c.beta) = 7;
    const SceneRows<Quad> with(one, q, v);
    for (int k = 0; k < with.size(); ++k) {
      const Contact& c = one.contacts[k];
      MotionQ error = with.data[k].nu;
      if (position && c.type == ContactType::k6D) error = log6<Quad>(with.G(k));
      if (position && c.type != ContactType::k6D)
        error.head<3>() = with.A(k).R.transpose() * (with.A(k).p - with.B(k).p);
      if (position && c.type == ContactType::k5D) {
        const Vec3<Quad> n = c.axis.cast<Quad>();
        error.tail<3>() = Vec3<Quad>(with.G(k).R.transpose() * n).cross(n);
      }
      const VectorQ expected = Quad(7) * selected(c, with.A(k), error);
      EXPECT_GT(size_of(expected), 1e-6);
      EXPECT_LE(difference_of(VectorQ(with.a0(k) - without.a0(k)), expected), kTightQuad * size_of(with.a0(k))) << k;
    }
  }
}

TEST_P(Scenes, TrueErrorsOfDouble) {
  const SceneRows<Quad> truth(scene, q, v);
  const SceneRows<double> rows(scene, s.q, s.v);
  for (int k = 0; k < rows.size(); ++k) {
    EXPECT_LE(error_of(rows.data[k].J, truth.data[k].J), 256 * kEps) << k;
    const ContactData<Quad>& t = truth.data[k];
    EXPECT_LE(difference_of(rows.data[k].a0, t.a0), 256 * kEps * terms(truth, k)) << k;
    EXPECT_LE(difference_of(rows.data[k].G, truth.data[k].G), 64 * kEps) << k;
  }
}

}  // namespace
}  // namespace manycontact::test
