// CRBA, RNEA and ABA agree with each other, in double.


#include "algorithm/shapes.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTightChain = 1e3 * kEps;  // sums along chains of up to 60 links

INSTANTIATE_TEST_SUITE_P(Of, Robots, testing::ValuesIn(shapes()), shape_name);

TEST_P(Robots, InertiaMatrixIsRneaColumnByColumn) {
  const MatrixXd M = inertia_matrix<double>(s, s.q);
  const VectorXd zero = VectorXd::Zero(model.nv);
  MatrixXd columns(model.nv, model.nv);
  for (int k = 0; k < model.nv; ++k)
    columns.col(k) = torques<double>(s, s.q, zero, VectorXd::Unit(model.nv, k), Vec3<double>::Zero());
  EXPECT_LE(error_of(M, columns), kTightChain);
  EXPECT_EQ(M, M.transpose());
  EXPECT_GT(eigenvalues(M).minCoeff(), 0);
}

// Entries are zero if neither coordinate is the other's ancestor.
TEST_P(Robots, InertiaMatrixHasTheTreesPattern) {
  const MatrixXd M = inertia_matrix<double>(s, s.q);
  for (int i = 0; i < model.nv; ++i)
    for (int j = 0; j < i; ++j) {
      int k = i;
      while (k > j) k = model.dof_parent[k];
      if (k != j) {
        EXPECT_EQ(M(i, j), 0) << i << ' ' << j;
      }
    }
}

TEST_P(Robots, InverseDynamicsIsLinearInTheAcceleration) {
  const VectorXd zero = VectorXd::Zero(model.nv);
  const VectorXd h = torques<double>(s, s.q, s.v, zero, s.gravity);
  const VectorXd tau = torques<double>(s, s.q, s.v, s.qdd, s.gravity);
  EXPECT_LE(error_of(VectorXd(inertia_matrix<double>(s, s.q) * s.qdd + h), tau), kTightChain);

  Kinematics<double> kin(model);  // without qdd: h, the armature left out
  forward_kinematics<double>(model, s.base, s.q, kin);
  forward_accelerations<double>(model, s.v, nullptr, s.gravity, kin);
  std::vector<Vec6<double>> f;
  VectorXd bias = VectorXd::Constant(model.nv, NAN);
  inverse_dynamics<double>(model, kin, nullptr, {}, f, bias);
  EXPECT_LE(error_of(bias, h), kTightChain);
}

TEST_P(Robots, ForwardDynamicsSolvesTheEquationOfMotion) {
  const MatrixXd M = inertia_matrix<double>(s, s.q);
  const VectorXd zero = VectorXd::Zero(model.nv);
  for (bool pushed : {false, true}) {
    const std::vector<Vec6<double>> fext = pushed ? s.fext : std::vector<Vec6<double>>{};
    const VectorXd h = torques<double>(s, s.q, s.v, zero, s.gravity, fext);
    const VectorXd qdd = accelerations<double>(s, s.q, s.v, s.tau, s.gravity, fext);
    EXPECT_LE(error_of(qdd, VectorXd(solved(M, s.tau - h))), 100 * kEps * condition_1(M)) << pushed;
    EXPECT_LE(error_of(torques<double>(s, s.q, s.v, qdd, s.gravity, fext), s.tau), 100 * kEps * condition_1(M));
  }
}

// tau(fext) - tau(0) = -sum J_i^T f_i, with explicit Jacobians of the bodies.
TEST_P(Robots, ExternalForcesEnterByTheJacobianTransposed) {
  Kinematics<double> kin(model);
  forward_kinematics<double>(model, s.base, s.q, kin);
  VectorXd expected = VectorXd::Zero(model.nv);
  for (int i = 0; i < model.njoints(); ++i) {
    MatrixXd J = MatrixXd::Zero(6, model.nv);  // of the body, in its child frame
    for (int k = model.joints[i].idx_v + model.joints[i].nv() - 1; k >= 0; k = model.dof_parent[k])
      J.col(k) = kin.oMi[i].act_inverse(kin.J.col(k));
    expected -= J.transpose() * s.fext[i];
  }
  const VectorXd with = torques<double>(s, s.q, s.v, s.qdd, s.gravity, s.fext);
  const VectorXd without = torques<double>(s, s.q, s.v, s.qdd, s.gravity);
  EXPECT_LE(difference_of(VectorXd(with - without), expected), kTightChain * std::max(size_of(with), size_of(without)));
}

// Gravity is an acceleration of the base: both computations give the same weight.
TEST_P(Robots, GravityTorquesAreTheWeightsByTheJacobian) {
  Kinematics<double> kin(model);
  forward_kinematics<double>(model, s.base, s.q, kin);
  VectorXd expected = VectorXd::Zero(model.nv);
  for (int i = 0; i < model.njoints(); ++i) {
    Vec6<double> weight;  // in the tree frame
    weight << kin.Y[i].m * s.gravity, kin.Y[i].h.cross(s.gravity);
    for (int k = model.joints[i].idx_v + model.joints[i].nv() - 1; k >= 0; k = model.dof_parent[k])
      expected[k] -= kin.J.col(k).dot(weight);
  }
  const VectorXd zero = VectorXd::Zero(model.nv);
  EXPECT_LE(error_of(torques<double>(s, s.q, zero, zero, s.gravity), expected), kTightChain);
}

// The tree frame's origin is at the base: a robot 1000 m away is the same robot, to the last bit.
TEST_P(Robots, FarAwayNoDigitIsLost) {
  Specimen far = s;
  const Vec3<double> shift(1000, -2000, 500);
  far.base.p += shift;
  if (model.floating_base) far.q.head<3>() += shift;
  EXPECT_EQ(inertia_matrix<double>(far, far.q), inertia_matrix<double>(s, s.q));
  EXPECT_EQ(torques<double>(far, far.q, s.v, s.qdd, s.gravity), torques<double>(s, s.q, s.v, s.qdd, s.gravity));
  EXPECT_EQ(accelerations<double>(far, far.q, s.v, s.tau, s.gravity),
            accelerations<double>(s, s.q, s.v, s.tau, s.gravity));
}

// Coordinate axes and placements without rotation have special code; the general code must agree.
TEST_P(Robots, ShortCutsChangeNothing) {
  Specimen general = s;
  for (Joint& joint : general.model.joints) joint.axis_kind = 3, joint.placement_rotates = true;
  EXPECT_LE(error_of(inertia_matrix<double>(general, s.q), inertia_matrix<double>(s, s.q)), kTightChain);
  EXPECT_LE(
      error_of(torques<double>(general, s.q, s.v, s.qdd, s.gravity), torques<double>(s, s.q, s.v, s.qdd, s.gravity)),
      kTightChain);
}

TEST_P(Robots, AllocateNothingAfterTheFirstCall) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  Kinematics<double> kin(model);
  AbaData<double> data(model);
  std::vector<Inertia<double>> Yc;
  std::vector<Vec6<double>> f;
  VectorXd tau(model.nv), qdd(model.nv), packed(model.M_begin[model.nv]), q(model.nq);
  MatrixXd M(model.nv, model.nv);
  bool regular = true;
  const auto all = [&] {
    forward_kinematics<double>(model, s.base, s.q, kin);
    forward_accelerations<double>(model, s.v, s.qdd.data(), s.gravity, kin);
    inverse_dynamics<double>(model, kin, s.qdd.data(), s.fext, f, tau);
    rnea<double>(model, s.base, s.q, s.v, s.qdd, s.gravity, {}, kin, f, tau);
    crba<double>(model, kin, Yc, packed.data());
    unpack_inertia<double>(model, packed.data(), M);
    regular = aba<double>(model, s.base, s.q, s.v, s.tau, s.gravity, s.fext, kin, data, qdd) && regular;
    integrate<double>(model, s.q, s.v, q);
    difference<double>(model, s.q, q, qdd);
  };
  all();
  EXPECT_EQ(allocations(all), 0u);
  EXPECT_TRUE(regular);
}

TEST(ForwardDynamics, SaysWhenTheInertiaIsSingular) {
  Specimen s({.njoints = 4, .types = {JointType::kRevolute}, .branching = 0});
  s.model.joints[3].inertia = {};  // a massless last link
  Kinematics<double> kin(s.model);
  AbaData<double> data(s.model);
  VectorXd qdd = VectorXd::Zero(4);
  EXPECT_FALSE(aba<double>(s.model, s.base, s.q, s.v, s.tau, s.gravity, {}, kin, data, qdd));
  EXPECT_TRUE(qdd.array().isNaN().all());
  s.model.armature[3] = 0.1;  // a rotor suffices
  EXPECT_TRUE(aba<double>(s.model, s.base, s.q, s.v, s.tau, s.gravity, {}, kin, data, qdd));
  EXPECT_TRUE(qdd.allFinite());
}

}  // namespace
}  // namespace manycontact::test
