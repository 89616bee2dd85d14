// The dense reference solver agrees with plain LU in quadruple precision if K is regular, with its definition if not.

#include "manycontact/kkt/dense.hpp"

#include <gtest/gtest.h>


#include "kkt/island_numbers.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTight = 1e-11;  // least squares of scenes whose K has conditions up to 1e4

struct Solved {
  DenseKkt<double> kkt;
  MatrixXd b1, b2, a, f;

  Solved(const MatrixXd& M, const MatrixXd& J, double delta, const MatrixXd& b1_, const MatrixXd& b2_)
      : b1(b1_), b2(b2_) {
    kkt.M = M, kkt.J = J, kkt.delta = delta;
    factor<double>(kkt);
    solve<double>(kkt, b1, b2, a, f);
  }
  MatrixXd residual1() const { return kkt.M * a - kkt.J.transpose() * f - b1; }
  MatrixXd residual2() const { return kkt.J * a + kkt.delta * f - b2; }
};

// Returns x of K x = b from LU in quadruple precision, as [a; f].
MatX<Quad> truth_of(const Solved& s) {
  MatX<Quad> b(s.kkt.nv() + s.kkt.nc(), s.b1.cols());
  b << s.b1.cast<Quad>(), s.b2.cast<Quad>();
  MatX<Quad> x = kkt_matrix<double>(s.kkt).cast<Quad>().eval().partialPivLu().solve(b);
  x.bottomRows(s.kkt.nc()) *= Quad(-1);
  return x;
}

void expect_true(const Solved& s) {
  ASSERT_TRUE(s.kkt.regular);
  const MatX<Quad> x = truth_of(s);
  const double allowed = std::max(1e-12, 100 * kEps * condition_1(kkt_matrix<double>(s.kkt)));
  EXPECT_LE(error_of(s.a, MatX<Quad>(x.topRows(s.kkt.nv()))), allowed);
  if (s.kkt.nc() > 0) {
    EXPECT_LE(error_of(s.f, MatX<Quad>(x.bottomRows(s.kkt.nc()))), allowed);
  }
}

// The definition requires J a nearest to b2, then a nearest to M^-1 b1 in the M-norm, then the shortest f.
void expect_optimal(const Solved& s) {
  ASSERT_TRUE(s.kkt.regular);
  const MatrixXd& J = s.kkt.J;
  const Svd svd(J);
  const int rank = static_cast<int>((svd.sigma.array() > 1e-9 * svd.sigma[0]).count());
  EXPECT_EQ(s.kkt.rank, rank);
  const MatrixXd null_JT = svd.U.rightCols(J.rows() - rank), null_J = svd.V.rightCols(J.cols() - rank);
  const double size1 = size_of(s.b1) + size_of(MatrixXd(s.kkt.M * s.a)), size2 = size_of(s.b2) + size_of(s.a);
  EXPECT_LE(size_of(s.residual1()), kTight * size1);                                          // J^T f = M a - b1
  EXPECT_LE(size_of(MatrixXd(J.transpose() * s.residual2())), kTight * size2);                // least squares
  EXPECT_LE(size_of(MatrixXd(null_JT.transpose() * s.f)), kTight * size_of(s.f));             // least norm
  EXPECT_LE(size_of(MatrixXd(null_J.transpose() * (s.kkt.M * s.a - s.b1))), kTight * size1);  // M-nearest
  EXPECT_LE(difference_of(MatrixXd(s.kkt.N * s.kkt.N.transpose()), MatrixXd(null_J * null_J.transpose())), kTight);
}

class Dense : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 rng{GetParam()};
  MatrixXd random(Eigen::Index rows, int cols = 3) {
    return random_vector(static_cast<int>(rows) * cols, rng, 5).reshaped(rows, cols);
  }
  static int independent_rows(const RandomScene& s, const Island& island) {
    int rows = 0;
    for (int c : island.contacts)
      if (s.scene.contacts[c].name.starts_with("contact")) rows += s.scene.contacts[c].rows();
    return rows;
  }
};
INSTANTIATE_TEST_SUITE_P(Seed, Dense, testing::Range(1u, 7u));

TEST_P(Dense, FullRankEqualsLuInQuad) {
  const RandomScene scene = kkt_scene(GetParam());
  for (const IslandNumbers& n : islands_of(scene))
    for (double delta : {0.0, 1e-3, 10.0}) {
      const Solved s(n.M, n.J, delta, random(n.M.rows()), random(n.J.rows()));
      EXPECT_EQ(s.kkt.rank, n.island.nc);
      EXPECT_EQ(kkt_matrix<double>(s.kkt), n.K(delta));
      expect_true(s);
      if (delta == 0 && n.island.nc > 0) expect_optimal(s);
    }
}

TEST_P(Dense, OracleInQuadIsGoodToQuad) {
  const RandomScene scene = kkt_scene(GetParam());
  const std::deque<IslandNumbers> islands = islands_of(scene);
  const IslandNumbers& n = islands.front();
  const Solved s(n.M, n.J, 0, random(n.M.rows(), 1), random(n.J.rows(), 1));
  DenseKkt<Quad> kkt;
  kkt.M = n.M.cast<Quad>();
  kkt.J = n.J.cast<Quad>();
  factor<Quad>(kkt);
  ASSERT_TRUE(kkt.regular);
  MatX<Quad> a, f;
  solve<Quad>(kkt, s.b1.cast<Quad>(), s.b2.cast<Quad>(), a, f);
  const MatX<Quad> x = truth_of(s);
  EXPECT_LE(error_of(a, MatX<Quad>(x.topRows(n.island.nv))), 1e-26);
  if (n.island.nc > 0) {
    EXPECT_LE(error_of(f, MatX<Quad>(x.bottomRows(n.island.nc))), 1e-26);
  }
}

// Some rows repeat others: the solution is that without them, and the force is shared.
TEST_P(Dense, RedundantRowsThatAgree) {
  const RandomScene scene = kkt_scene(GetParam(), 3);
  int redundant = 0;
  for (const IslandNumbers& n : islands_of(scene)) {
    if (n.island.nc == 0) continue;
    const int rank = independent_rows(scene, n.island);
    redundant += n.island.nc - rank;
    const VectorXd b2 = -n.a0;
    const Solved s(n.M, n.J, 0, random(n.M.rows(), 1), b2);
    EXPECT_EQ(s.kkt.rank, rank);
    expect_optimal(s);
    EXPECT_LE(size_of(s.residual2()), kTight * size_of(b2));
    const Solved alone(n.M, n.J.topRows(rank), 0, s.b1, b2.head(rank));  // the repeated ones are at the end
    EXPECT_LE(error_of(s.a, alone.a), kTight);
    EXPECT_LE(error_of(MatrixXd(n.J.transpose() * s.f), MatrixXd(n.J.topRows(rank).transpose() * alone.f)), kTight);
  }
  EXPECT_GT(redundant, 0);
}

TEST_P(Dense, ContradictingRowsAreMetInLeastSquares) {
  const RandomScene scene = kkt_scene(GetParam(), 0, 3);
  double contradiction = 0;
  for (const IslandNumbers& n : islands_of(scene)) {
    if (n.island.nc == 0) continue;
    const Solved s(n.M, n.J, 0, random(n.M.rows(), 1), -n.a0);
    expect_optimal(s);
    contradiction = std::max(contradiction, size_of(s.residual2()));
  }
  EXPECT_GT(contradiction, 1e-3);
}

TEST_P(Dense, DampingMakesRedundantRowsRegular) {
  const RandomScene scene = kkt_scene(GetParam(), 2, 2);
  for (const IslandNumbers& n : islands_of(scene)) {
    const Solved s(n.M, n.J, 1e-2, random(n.M.rows()), random(n.J.rows()));
    expect_true(s);
  }
}

TEST_P(Dense, MoreRowsThanCoordinates) {
  const MatrixXd M = random(4, 4), J = random(9, 4);
  const Solved s(M * M.transpose() + MatrixXd::Identity(4, 4), J, 0, random(4), random(9));
  EXPECT_EQ(s.kkt.rank, 4);
  EXPECT_EQ(s.kkt.N.cols(), 0);
  expect_optimal(s);
}

TEST_P(Dense, SeveralRightHandSidesAreSolvedAlike) {
  const RandomScene scene = kkt_scene(GetParam(), 2);
  for (const IslandNumbers& n : islands_of(scene)) {
    const Solved s(n.M, n.J, 0, random(n.M.rows(), 4), random(n.J.rows(), 4));
    for (int k = 0; k < 4; ++k) {
      const Solved one(n.M, n.J, 0, s.b1.col(k), s.b2.col(k));
      EXPECT_LE(error_of(MatrixXd(s.a.col(k)), one.a), kTight);
      EXPECT_LE(error_of(MatrixXd(s.f.col(k)), one.f), kTight);
    }
  }
}

// ---- singular M: semidefinite along one direction, which a contact row constrains or not ---------------------------

struct SingularInertia {
  MatrixXd M, held, loose;  // J that constrains the lost direction, and one that does not

  explicit SingularInertia(std::mt19937& rng) {
    const MatrixXd B = random_vector(48, rng).reshaped(8, 6);
    const MatrixXd Q = Svd(B).U;
    VectorXd lambda = VectorXd::Constant(8, 2);
    lambda[7] = 0;
    M = Q * lambda.asDiagonal() * Q.transpose();
    held = random_vector(24, rng).reshaped(3, 8);
    loose = held - (held * Q.col(7)) * Q.col(7).transpose();
  }
};

TEST_P(Dense, SingularInertiaHeldByContacts) {
  const SingularInertia s(rng);
  const Solved held(s.M, s.held, 0, random(8), random(3));
  expect_true(held);
  expect_optimal(held);
  const Solved damped(s.M, s.held, 0.1, held.b1, held.b2);
  expect_true(damped);
}

TEST_P(Dense, SingularInertiaNotHeldIsNotRegular) {
  for (int trial = 0; trial < 50; ++trial) {
    const SingularInertia s(rng);
    for (double delta : {0.0, 0.1}) {
      const Solved loose(s.M, s.loose, delta, random(8), random(3));
      EXPECT_FALSE(loose.kkt.regular) << delta;
      EXPECT_TRUE(loose.a.array().isNaN().all());
      EXPECT_TRUE(loose.f.array().isNaN().all());
      EXPECT_EQ(loose.a.rows(), 8);
      EXPECT_EQ(loose.f.rows(), 3);
    }
    const Solved free(s.M, MatrixXd(0, 8), 0, random(8), MatrixXd(0, 3));
    EXPECT_FALSE(free.kkt.regular);
  }
}

TEST(DenseKkt, IndefiniteInertiaIsNotRegular) {
  const MatrixXd M = Eigen::Vector3d(1, 2, -1).asDiagonal();
  EXPECT_FALSE(Solved(M, MatrixXd(0, 3), 0, MatrixXd::Ones(3, 1), MatrixXd(0, 1)).kkt.regular);
}

TEST(DenseKkt, WhatIsNotANumberIsNotRegular) {
  MatrixXd M = MatrixXd::Identity(3, 3), J = MatrixXd::Ones(1, 3);
  J(0, 1) = NAN;
  EXPECT_FALSE(Solved(M, J, 0, MatrixXd::Ones(3, 1), MatrixXd::Ones(1, 1)).kkt.regular);
  M(2, 2) = INFINITY;
  EXPECT_FALSE(Solved(M, MatrixXd::Ones(1, 3), 0.1, MatrixXd::Ones(3, 1), MatrixXd::Ones(1, 1)).kkt.regular);
}

TEST(DenseKkt, RowsOfZerosCarryNoForce) {
  MatrixXd J = MatrixXd::Zero(2, 3);
  J(0, 0) = 2;
  const Solved s(MatrixXd::Identity(3, 3), J, 0, Eigen::Vector3d(1, 2, 3), Eigen::Vector2d(4, 0));
  EXPECT_EQ(s.kkt.rank, 1);
  EXPECT_LE(difference_of(s.a, Eigen::Vector3d(2, 2, 3)), 16 * kEps);
  EXPECT_LE(difference_of(s.f, Eigen::Vector2d(0.5, 0)), 16 * kEps);
}

}  // namespace
}  // namespace manycontact::test
