// In quadruple precision velocities and accelerations agree with differences, and laws and errors of double are tested.

#include "algorithm/shapes.hpp"
#include "manycontact/spatial/explog.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using VectorQ = VecX<Quad>;
using Force = Vec6<Quad>;

// Central differences are accurate to step^2; the placements in the model are rotations to double precision only.
const Quad kStep(1e-10);
constexpr double kTightQuad = 1e-13;

class InQuad : public Robots {};
INSTANTIATE_TEST_SUITE_P(Of, InQuad, testing::ValuesIn(shapes()), shape_name);

class FreeInQuad : public Robots {
 public:
  static std::vector<Shape> floating() {
    std::vector<Shape> free;
    for (const Shape& shape : shapes())
      if (shape.options.floating_base) free.push_back(shape);
    return free;
  }
};
INSTANTIATE_TEST_SUITE_P(Of, FreeInQuad, testing::ValuesIn(FreeInQuad::floating()), shape_name);

// The robot a moment t later, moving with v and qdd.
struct Moved {
  VectorQ q, v;
  Kinematics<Quad> kin;

  Moved(const Specimen& s, const VectorQ& qdd, const Quad& t) : q(s.model.nq), kin(s.model) {
    v = s.v.cast<Quad>() + t * qdd;
    integrate<Quad>(s.model, s.q.cast<Quad>(), t * s.v.cast<Quad>(), q);
    forward_kinematics<Quad>(s.model, s.base, q, kin);
    forward_accelerations<Quad>(s.model, v, qdd.data(), Vec3<double>::Zero(), kin);
  }
  SE3<Quad> origin(int joint) const { return {Mat3<Quad>::Identity(), kin.origin(joint)}; }
};

template <class Of>
auto rate(const Moved& forth, const Moved& back, Of&& of) {
  return ((of(forth) - of(back)) / (Quad(2) * kStep)).eval();
}

TEST_P(InQuad, VelocitiesAreThePlacementsRate) {
  const VectorQ qdd = s.qdd.cast<Quad>();
  const Moved now(s, qdd, Quad(0)), forth(s, qdd, kStep), back(s, qdd, -kStep);
  for (int i = 0; i < model.njoints(); ++i) {
    const SE3<Quad> before = back.origin(i) * back.kin.oMi[i], after = forth.origin(i) * forth.kin.oMi[i];
    const Vec6<Quad> twist = log6<Quad>(before.inverse() * after) / (Quad(2) * kStep);  // in the child frame
    EXPECT_LE(error_of(now.kin.oMi[i].act_inverse(now.kin.v[i]), twist), kTightQuad) << i;
  }
}

TEST_P(InQuad, AccelerationsAreTheVelocitiesRate) {
  const VectorQ qdd = s.qdd.cast<Quad>();
  const Moved now(s, qdd, Quad(0)), forth(s, qdd, kStep), back(s, qdd, -kStep);
  for (int i = 0; i < model.njoints(); ++i) {
    // the anchor moves the tree frame: differences are about the world's origin
    const Vec6<Quad> a = rate(forth, back, [i](const Moved& m) { return m.origin(i).act(m.kin.v[i]); });
    EXPECT_LE(error_of(now.kin.a[i], now.origin(i).act_inverse(a)), kTightQuad) << i;
  }
}

TEST_P(InQuad, GravityOnlyShiftsAccelerations) {
  Kinematics<double> with(model), without(model);
  for (Kinematics<double>* kin : {&with, &without}) {
    forward_kinematics<double>(model, s.base, s.q, *kin);
    forward_accelerations<double>(model, s.v, s.qdd.data(), kin == &with ? s.gravity : Vec3<double>::Zero(), *kin);
  }
  for (int i = 0; i < model.njoints(); ++i) {
    Vec6<double> shifted = without.a[i];
    shifted.head<3>() -= s.gravity;
    EXPECT_LE(error_of(with.a[i], shifted), 64 * kEps);
    EXPECT_EQ(with.v[i], without.v[i]);
  }
}

using Scalar1 = Eigen::Matrix<Quad, 1, 1>;

// d/dt (kinetic + potential) = v . tau along ABA's motion. Rotors have kinetic energy, too.
TEST_P(InQuad, PowerIsTheEnergysRate) {
  const VectorQ tau = s.tau.cast<Quad>(), v = s.v.cast<Quad>();
  const VectorQ qdd = accelerations<Quad>(s, s.q.cast<Quad>(), v, tau, s.gravity);
  const auto kinetic = [&](const Moved& m) {
    Quad T = m.v.cwiseAbs2().dot(model.armature.cast<Quad>());
    for (int i = 0; i < model.njoints(); ++i) T += m.kin.v[i].dot(m.kin.Y[i] * m.kin.v[i]);
    return Scalar1(T / Quad(2));
  };
  const auto potential = [&](const Moved& m) {
    Quad V(0);
    for (int i = 0; i < model.njoints(); ++i)
      V -= s.gravity.cast<Quad>().dot(m.kin.Y[i].m * m.kin.origin(i) + m.kin.Y[i].h);
    return Scalar1(V);
  };
  const Moved forth(s, qdd, kStep), back(s, qdd, -kStep);
  const double dT = static_cast<double>(rate(forth, back, kinetic)(0));
  const double dV = static_cast<double>(rate(forth, back, potential)(0));
  const double power = s.v.dot(s.tau), scale = s.v.cwiseAbs().dot(s.tau.cwiseAbs()) + std::abs(dT) + std::abs(dV);
  EXPECT_LE(std::abs(dT + dV - power), kTightQuad * scale);
  EXPECT_GT(std::abs(dT), 1e-6 * scale);
}

// The total momentum about a point fixed in the world changes by the weight alone: without gravity it is constant.
TEST_P(FreeInQuad, MomentumOfAFreeRobotChangesByItsWeight) {
  VectorQ tau = s.tau.cast<Quad>();
  tau.head(6).setZero();  // internal torques only
  for (const Vec3<double>& gravity : {Vec3<double>(0, 0, 0), s.gravity}) {
    const VectorQ qdd = accelerations<Quad>(s, s.q.cast<Quad>(), s.v.cast<Quad>(), tau, gravity);
    const Moved now(s, qdd, Quad(0)), forth(s, qdd, kStep), back(s, qdd, -kStep);
    const Force change = rate(forth, back, [&](const Moved& m) {
      Force h = Force::Zero();
      for (int i = 0; i < model.njoints(); ++i) h += m.kin.Y[i] * m.kin.v[i];
      return m.origin(0).act_force(h);
    });
    Force weight = Force::Zero();
    Quad scale(0);
    for (int i = 0; i < model.njoints(); ++i) {
      Vec3<Quad> g = gravity.cast<Quad>();
      weight.head<3>() += now.kin.Y[i].m * g;
      weight.tail<3>() += now.kin.Y[i].h.cross(g);
      scale += (now.kin.Y[i] * now.kin.a[i]).norm();
    }
    EXPECT_LE(difference_of(change, now.origin(0).act_force(weight)), kTightQuad * static_cast<double>(scale));
  }
}

// ---- double against Quad
// ----------------------------------------------------------------------------------------------

TEST_P(InQuad, TrueErrorsOfDouble) {
  constexpr double kAllowed = 2e-13;
  const VectorQ q = s.q.cast<Quad>(), v = s.v.cast<Quad>(), qdd = s.qdd.cast<Quad>(), tau = s.tau.cast<Quad>();
  std::vector<Force> fext;
  for (const Vec6<double>& f : s.fext) fext.push_back(f.cast<Quad>());
  Kinematics<double> kin(model);
  Kinematics<Quad> truth(model);
  forward_kinematics<double>(model, s.base, s.q, kin);
  forward_kinematics<Quad>(model, s.base, q, truth);
  forward_accelerations<double>(model, s.v, s.qdd.data(), s.gravity, kin);
  forward_accelerations<Quad>(model, v, qdd.data(), s.gravity, truth);
  EXPECT_LE(error_of(kin.J, truth.J), kAllowed);
  for (int i = 0; i < model.njoints(); ++i) {
    EXPECT_LE(difference_of(kin.origin(i), truth.origin(i)), kAllowed) << i;
    EXPECT_LE(difference_of(kin.oMi[i], truth.oMi[i]), kAllowed) << i;
    EXPECT_LE(error_of(kin.Y[i].matrix(), truth.Y[i].matrix()), kAllowed) << i;
    EXPECT_LE(error_of(kin.v[i], truth.v[i]), kAllowed) << i;
    EXPECT_LE(error_of(kin.a[i], truth.a[i]), kAllowed) << i;
  }
  const MatX<Quad> M = inertia_matrix<Quad>(s, q);
  EXPECT_LE(error_of(inertia_matrix<double>(s, s.q), M), kAllowed);
  EXPECT_LE(
      error_of(torques<double>(s, s.q, s.v, s.qdd, s.gravity, s.fext), torques<Quad>(s, q, v, qdd, s.gravity, fext)),
      kAllowed);

  const double condition = condition_1(M.cast<double>());
  EXPECT_LE(error_of(accelerations<double>(s, s.q, s.v, s.tau, s.gravity, s.fext),
                     accelerations<Quad>(s, q, v, tau, s.gravity, fext)),
            std::max(1e-12, 10 * kEps * condition));

  Eigen::VectorXd moved(model.nq), back(model.nv);
  VectorQ moved_truth(model.nq), back_truth(model.nv);
  integrate<double>(model, s.q, s.v, moved);
  integrate<Quad>(model, q, v, moved_truth);
  EXPECT_LE(error_of(moved, moved_truth), 16 * kEps);
  difference<double>(model, s.q, moved, back);
  difference<Quad>(model, q, moved.cast<Quad>(), back_truth);
  EXPECT_LE(error_of(back, back_truth), 16 * kEps);
}

}  // namespace
}  // namespace manycontact::test
