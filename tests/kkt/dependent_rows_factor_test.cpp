// The factor that drops dependent rows is used again after rows were dropped.

#include <gtest/gtest.h>

#include "kkt/island_numbers.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/matrix.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// One island at several states has alike matrices.
struct Matrices {
  std::deque<std::deque<IslandNumbers>> islands;  // per state
  std::shared_ptr<const KktPattern> pattern;      // of the largest island

  Matrices(unsigned seed, int states) {
    RandomScene s = kkt_scene(seed, 4);
    std::mt19937 rng(seed);
    for (int k = 0; k < states; ++k) {
      for (const Robot& r : s.scene.robots) s.q.segment(r.idx_q, r.model->nq) = random_configuration(*r.model, rng);
      islands.push_back(islands_of(s));
    }
    pattern = largest(0).shape.pattern(Order::kLeafToRoot);
  }
  const IslandNumbers& largest(int state) const {
    return *std::max_element(islands[state].begin(), islands[state].end(), [](const auto& x, const auto& y) {
      return x.island.contacts.size() < y.island.contacts.size();
    });
  }
  KktMatrix K(int state) const {
    const IslandNumbers& n = largest(state);
    KktMatrix K;
    K.reset(pattern);
    assemble(n.M_spans, n.J_spans, 0, K);
    K.row_scale = n.J.cwiseAbs().maxCoeff();
    return K;
  }
};

// Returns the condition of K without its null space.
double condition_of(const IslandNumbers& n) {
  const VectorXd sizes = eigenvalues(n.K(0)).cwiseAbs();
  double least = sizes.maxCoeff();
  for (double size : sizes)
    if (size > 1e-12 * sizes.maxCoeff()) least = std::min(least, size);
  return sizes.maxCoeff() / least;
}

struct Answers {
  int rank;
  std::vector<int> dependent;
  VectorXd x;
  RowMajor X;
};

// Solves for one vector and for the identity's first columns.
Answers answers_of(Factor& factor, const KktMatrix& K, const VectorXd& b) {
  Answers out{factor.rank(), {}, b, RowMajor::Identity(K.size(), 24)};
  factor.dependent_rows(out.dependent);
  std::sort(out.dependent.begin(), out.dependent.end());
  factor.solve(out.x.data());
  std::vector<char> nonzero(K.size(), 1);
  factor.solve_panel(out.X.data(), 24, 0, 24, nonzero.data());
  return out;
}

class DroppedRows : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seed, DroppedRows, testing::Range(1u, 9u));

TEST_P(DroppedRows, AreDroppedAgainWithTheOraclesAnswers) {
  const Matrices m(GetParam(), 4);
  FactorScratch scratch;
  const auto again = make_waiting_ldl_factor();
  std::mt19937 rng(GetParam());
  int dropped = 0;
  for (int state = 0; state < 4; ++state) {
    SCOPED_TRACE(state);
    const KktMatrix K = m.K(state);
    const auto fresh = make_waiting_ldl_factor(), oracle = make_dense_factor();
    const Reason reason = fresh->factorize(K, scratch);
    ASSERT_EQ(again->factorize(K, scratch), reason);
    if (reason != Reason::kNone) continue;
    ASSERT_EQ(oracle->factorize(K, scratch), Reason::kNone);
    const VectorXd b = random_vector(K.size(), rng);
    const Answers x = answers_of(*fresh, K, b), y = answers_of(*again, K, b), truth = answers_of(*oracle, K, b);
    EXPECT_EQ(x.rank, truth.rank);
    EXPECT_EQ(y.rank, truth.rank);
    EXPECT_EQ(y.dependent, x.dependent);
    EXPECT_EQ(y.x, x.x);  // the same bits
    EXPECT_EQ(y.X, x.X);
    EXPECT_EQ(again->growth(), fresh->growth());
    dropped += K.nc() - y.rank;
    const double most = 1e2 * kEps * condition_of(m.largest(state));
    EXPECT_LE(error_of(y.x, truth.x), most);
    EXPECT_LE(error_of(MatrixXd(y.X), MatrixXd(truth.X)), most);
  }
  EXPECT_GT(dropped, 0);
}

// Rows that depended on others no longer do, and others do.
TEST_P(DroppedRows, AreOthersWhereOthersDepend) {
  const Matrices m(GetParam(), 1);
  FactorScratch scratch;
  const auto again = make_waiting_ldl_factor();
  std::mt19937 rng(GetParam());
  KktMatrix K = m.K(0);
  if (again->factorize(K, scratch) != Reason::kNone) GTEST_SKIP() << "for the oracle";
  ASSERT_LT(again->rank(), K.nc());
  // every row of J is independent, except for a zero one
  const sparse::UpperCsc& A = m.pattern->K;
  const auto noise = random_vector(static_cast<int>(K.values.size()), rng);
  for (int k = K.nv(); k < K.size(); ++k)
    for (int p = A.p[k]; p < A.p[k + 1] - 1; ++p) K.values[p] += noise[p];
  std::vector<int> before;
  again->dependent_rows(before);
  for (int vanishing = K.nv(); vanishing < K.size(); ++vanishing) {
    if (std::find(before.begin(), before.end(), m.pattern->perm[vanishing] - K.nv()) != before.end()) continue;
    for (int p = A.p[vanishing]; p < A.p[vanishing + 1] - 1; ++p) K.values[p] = 0;
    break;
  }
  const auto fresh = make_waiting_ldl_factor();
  const Reason reason = fresh->factorize(K, scratch);
  ASSERT_EQ(again->factorize(K, scratch), reason);
  if (reason != Reason::kNone) return;
  const VectorXd b = random_vector(K.size(), rng);
  const Answers x = answers_of(*fresh, K, b), y = answers_of(*again, K, b);
  EXPECT_EQ(y.rank, x.rank);
  EXPECT_EQ(y.dependent, x.dependent);
  EXPECT_EQ(y.x, x.x);
}

// Each row in turn is dropped in addition; rows that depended on it may no longer do.
TEST_P(DroppedRows, AreMoreWhereARowVanishes) {
  const Matrices m(GetParam(), 1);
  FactorScratch scratch;
  const KktMatrix K = m.K(0);
  const auto again = make_waiting_ldl_factor();
  if (again->factorize(K, scratch) != Reason::kNone) GTEST_SKIP() << "for the oracle";
  std::vector<int> before;
  again->dependent_rows(before);
  std::mt19937 rng(GetParam());
  const VectorXd b = random_vector(K.size(), rng);
  int answered = 0;
  for (int row = K.nv(); row < K.size(); ++row) {
    SCOPED_TRACE(row);
    KktMatrix one_less = K;
    for (int p = m.pattern->K.p[row]; p < m.pattern->K.p[row + 1]; ++p) one_less.values[p] = 0;
    const auto fresh = make_waiting_ldl_factor();
    const Reason reason = fresh->factorize(one_less, scratch);
    ASSERT_EQ(again->factorize(one_less, scratch), reason);
    if (reason == Reason::kNone) {
      ++answered;
      const Answers x = answers_of(*fresh, one_less, b), y = answers_of(*again, one_less, b);
      EXPECT_EQ(y.dependent, x.dependent);
      EXPECT_EQ(std::count(y.dependent.begin(), y.dependent.end(), m.pattern->perm[row] - K.nv()), 1);
      EXPECT_EQ(y.x, x.x);
    }
    ASSERT_EQ(again->factorize(K, scratch), Reason::kNone);
    std::vector<int> after;
    again->dependent_rows(after);
    EXPECT_EQ(after, before);
  }
  EXPECT_GT(answered, 0);
}

MatrixXd dense_of(const KktMatrix& K) {
  MatrixXd out = MatrixXd::Zero(K.size(), K.size());
  for (int j = 0; j < K.size(); ++j)
    for (int p = K.pattern->K.p[j]; p < K.pattern->K.p[j + 1]; ++p)
      out(K.pattern->K.i[p], j) = out(j, K.pattern->K.i[p]) = K.values[p];
  return out;
}

double condition_of(const KktMatrix& K) {
  const VectorXd sizes = eigenvalues(dense_of(K)).cwiseAbs();
  double least = sizes.maxCoeff();
  for (double size : sizes)
    if (size > 1e-12 * sizes.maxCoeff()) least = std::min(least, size);
  return sizes.maxCoeff() / least;
}

// Some retained rows are a hundredth of those that depend on them: the others are retained instead, or coefficients of
// a hundred would show in the projector's error. The rows listed are those that depend on earlier ones, as before.
TEST_P(DroppedRows, TakeTurnsWithSmallerRows) {
  const Matrices m(GetParam(), 3);
  FactorScratch scratch;
  const auto again = make_waiting_ldl_factor();
  std::mt19937 rng(GetParam());
  int judged = 0;
  for (int state = 0; state < 3; ++state) {
    SCOPED_TRACE(state);
    KktMatrix K = m.K(state);
    const auto before = make_waiting_ldl_factor(), fresh = make_waiting_ldl_factor(), oracle = make_dense_factor();
    if (before->factorize(K, scratch) != Reason::kNone || before->rank() == K.nc()) continue;
    std::vector<int> dropped, instead;
    before->dependent_rows(dropped);
    std::vector<char> small(K.nc());
    before->null_space_rows(small);
    for (int k : dropped) small[k] = 0;
    for (int k = 0; k < K.nc(); ++k) {
      const int row = m.pattern->iperm[m.pattern->nv + k];
      for (int p = m.pattern->K.p[row]; small[k] && p < m.pattern->K.p[row + 1]; ++p) K.values[p] *= 0.01;
    }
    ASSERT_EQ(fresh->factorize(K, scratch), Reason::kNone);
    ASSERT_EQ(again->factorize(K, scratch), Reason::kNone);
    ASSERT_EQ(oracle->factorize(K, scratch), Reason::kNone);
    fresh->dependent_rows(instead);
    std::sort(dropped.begin(), dropped.end());
    std::sort(instead.begin(), instead.end());
    EXPECT_EQ(instead, dropped);
    ++judged;
    EXPECT_LE(fresh->projector_error(), 8 * 5 * kEps * K.nc());  // no coefficient above 2
    const VectorXd b = random_vector(K.size(), rng);
    const Answers x = answers_of(*fresh, K, b), y = answers_of(*again, K, b), truth = answers_of(*oracle, K, b);
    EXPECT_EQ(x.rank, truth.rank);
    EXPECT_EQ(y.dependent, x.dependent);
    EXPECT_EQ(y.x, x.x);  // the same bits
    EXPECT_EQ(y.X, x.X);
    const double most = 1e2 * kEps * condition_of(K);
    EXPECT_LE(error_of(x.x, truth.x), most);
    EXPECT_LE(error_of(MatrixXd(x.X), MatrixXd(truth.X)), most);
    // P of the contacts' rows agrees
    VectorXd kept = b, kept_in_truth = b;
    fresh->project_out(kept.data(), nullptr);
    oracle->project_out(kept_in_truth.data(), nullptr);
    EXPECT_LE(error_of(kept, kept_in_truth), most);
  }
  EXPECT_GT(judged, 0);
}

TEST_P(DroppedRows, OfNumbersThatAreNotFinite) {
  const Matrices m(GetParam(), 1);
  FactorScratch scratch;
  KktMatrix K = m.K(0);
  const auto again = make_waiting_ldl_factor();
  if (again->factorize(K, scratch) != Reason::kNone) GTEST_SKIP() << "for the oracle";
  for (std::size_t k = 0; k < K.values.size(); k += 7) {
    const double was = K.values[k];
    K.values[k] = NAN;
    EXPECT_NE(again->factorize(K, scratch), Reason::kNone) << k;
    K.values[k] = was;
    EXPECT_EQ(again->factorize(K, scratch), Reason::kNone) << k;
  }
}

// An inertia whose diagonal is positive is not definite: all factors see it by a pivot, whatever was dropped before.
TEST_P(DroppedRows, OfAnInertiaThatIsNotDefinite) {
  const Matrices m(GetParam(), 1);
  FactorScratch scratch;
  KktMatrix K = m.K(0), damped = m.K(0);
  const IslandNumbers& n = m.largest(0);
  assemble(n.M_spans, n.J_spans, 0.1, damped);
  const auto again = make_waiting_ldl_factor(), ldl = make_ldl_factor(Method::kSparseLdl),
             suitesparse = make_ldl_factor(Method::kSuiteSparseLdl);
  if (again->factorize(K, scratch) != Reason::kNone) GTEST_SKIP() << "for the oracle";
  ASSERT_EQ(ldl->factorize(damped, scratch), Reason::kNone);
  const sparse::UpperCsc& A = m.pattern->K;
  int spoilt = 0;
  for (int k = 0; k < K.size(); ++k)
    for (int p = A.p[k]; p < A.p[k + 1] - 1; ++p) {
      const int i = A.i[p];
      if (m.pattern->perm[k] >= K.nv() || m.pattern->perm[i] >= K.nv() || ++spoilt % 8 != 1) continue;
      const double was = K.values[p];
      K.values[p] = damped.values[p] = 2 * std::sqrt(K.values[A.p[k + 1] - 1] * K.values[A.p[i + 1] - 1]);
      EXPECT_NE(again->factorize(K, scratch), Reason::kNone) << i << " and " << k;
      EXPECT_EQ(ldl->factorize(damped, scratch), Reason::kWrongInertia) << i << " and " << k;
      EXPECT_EQ(suitesparse->factorize(damped, scratch), Reason::kWrongInertia) << i << " and " << k;
      K.values[p] = damped.values[p] = was;
      EXPECT_EQ(again->factorize(K, scratch), Reason::kNone) << i << " and " << k;
      EXPECT_EQ(ldl->factorize(damped, scratch), Reason::kNone) << i << " and " << k;
    }
  EXPECT_GT(spoilt, 0);
}

}  // namespace
}  // namespace manycontact::test
