// The k-th allocation fails, k = 0, 1, 2, ...: it throws, nothing leaks, and the same objects work afterwards.

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/rank/least_norm.hpp"
#include "manycontact/sparse/cholmod.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "sparse/saddle_point.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

const auto kNoCheck = [] {};

class FailingAllocations : public testing::Test {
 protected:
  void SetUp() override {
    if (!MANYCONTACT_FAILS_ALLOCATIONS) GTEST_SKIP() << "allocations cannot fail in this build";
  }
};

// ---- the injector itself

// The compiler must allocate what is stored here.
void* volatile sink = nullptr;

TEST_F(FailingAllocations, AreThoseOfAllWaysToAllocate) {
  const auto fails = [](auto&& take) {
    const FailingAllocation failing(0, false);
    sink = take();
    const bool failed = sink == nullptr && failing.reached();
    std::free(sink);
    return failed;
  };
  EXPECT_TRUE(fails([] { return std::malloc(10); }));
  EXPECT_TRUE(fails([] { return std::calloc(10, 1); }));
  EXPECT_TRUE(fails([] { return std::realloc(nullptr, 10); }));
  EXPECT_TRUE(fails([] { return std::aligned_alloc(64, 64); }));
  const auto throws = [](auto&& take) {
    const FailingAllocation failing(0, false);
    try {
      const auto taken = take();
      sink = const_cast<void*>(static_cast<const void*>(&*taken.begin()));
    } catch (const std::bad_alloc&) {
      return failing.reached();
    }
    return false;
  };
  struct alignas(128) Wide {
    char c;
  };
  EXPECT_TRUE(throws([] { return std::vector<double>(5); }));
  EXPECT_TRUE(throws([] { return std::vector<Wide>(1); }));
  EXPECT_TRUE(throws([] { return VectorXd(VectorXd::Zero(5)); }));
}

TEST_F(FailingAllocations, AreTheOneNamedOrAllBehindIt) {
  for (bool all_after : {false, true}) {
    const FailingAllocation failing(1, all_after);
    void* p[] = {std::malloc(1), std::malloc(1), std::malloc(1)};
    EXPECT_TRUE(p[0]);
    EXPECT_FALSE(p[1]);
    EXPECT_EQ(p[2] == nullptr, all_after);
    for (void* q : p) std::free(q);
  }
  const FailingAllocation failing(1, true);
  std::free(std::malloc(1));
  EXPECT_FALSE(failing.reached());
}

TEST_F(FailingAllocations, DriverTriesEachAndFindsWhatIsWrong) {
  int checks = 0;
  const FailedRuns runs = fail_each_allocation([] { VectorXd(3).setZero(), VectorXd(4).setZero(); }, [&] { ++checks; });
  EXPECT_EQ(runs.failed, 4) << "two allocations, each alone and with all behind it";
  EXPECT_EQ(runs.survived, 0);
  EXPECT_EQ(checks, 5) << "and the run in which none failed";
  const auto takes = [](auto&& otherwise) {
    sink = std::malloc(1);
    if (!sink) otherwise();
    std::free(sink);
  };
  EXPECT_EQ(fail_each_allocation([&] { takes([] {}); }, kNoCheck).survived, 2);

  const auto complaints = [](auto&& work) {
    testing::TestPartResultArray found;
    {
      const testing::ScopedFakeTestPartResultReporter reporter(
          testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &found);
      fail_each_allocation(work, kNoCheck);
    }
    return std::string(found.size() == 0 ? "" : found.GetTestPartResult(0).message());
  };
  EXPECT_NE(complaints([&] { takes([] { throw 3; }); }).find("not std::bad_alloc"), std::string::npos);
  EXPECT_NE(complaints([] { throw std::bad_alloc(); }).find("none failed"), std::string::npos);
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) return;
  std::vector<void*> leaked;
  leaked.reserve(10);
  EXPECT_NE(complaints([&] { takes([&] { leaked.push_back(std::malloc(1)); }); }).find("blocks were leaked"),
            std::string::npos);
  for (void* p : leaked) std::free(p);
}

// ---- layer sparse

TEST_F(FailingAllocations, InPatternsOrdersAndSymbolicPhases) {
  std::mt19937 rng(81);
  const Symmetric A(random_positive(30, 0.1, rng));
  const std::vector<int> order = sparse::camd_order(A.pattern, {});
  const sparse::LdlSymbolic truth = sparse::ldl_analyze(sparse::permute(A.pattern, sparse::inverse(order)));
  EXPECT_GT(fail_each_allocation([&] { sparse::camd_order(A.pattern, {}); },
                                 [&] { EXPECT_EQ(sparse::camd_order(A.pattern, {}), order); })
                .failed,
            0);
  EXPECT_GT(fail_each_allocation([&] { sparse::permute(A.pattern, sparse::inverse(order)); }, kNoCheck).failed, 0);
  const auto analyze = [&] { return sparse::ldl_analyze(sparse::permute(A.pattern, sparse::inverse(order))); };
  EXPECT_GT(fail_each_allocation([&] { analyze(); }, [&] { EXPECT_EQ(analyze().Li, truth.Li); }).failed, 0);
}

// One workspace goes through all failures: if it grew before a failure, that is not mistaken for all it needs.
TEST_F(FailingAllocations, InTheFactorsWorkspace) {
  std::mt19937 rng(82);
  const Symmetric A(random_positive(30, 0.1, rng));
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
  std::vector<double> L(symbolic.nonzeros()), D(A.n());
  long failed = 0;
  for (long k = 0;; ++k) {
    sparse::LdlWorkspace work;
    const VectorXd truth = random_matrix(A.n(), 1, rng);
    bool reached = false;
    {
      const FailingAllocation failing(k, false);
      try {
        (void)sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data());
      } catch (const std::bad_alloc&) {
        reached = true;
      }
    }
    ASSERT_EQ(sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data()), A.n());
    EXPECT_GE(std::min({work.pattern.size(), work.flag.size(), work.Lnz.size(), work.Y.size()}), 30u);
    EXPECT_GE(work.Li.size(), L.size());
    VectorXd x = A.dense * truth;
    sparse::ldl_solve(symbolic, L.data(), D.data(), x.data());
    EXPECT_LE(error_of(x, truth), 64 * kEps);
    if (!reached) break;
    ++failed;
  }
  EXPECT_EQ(failed, 5) << "one per array";
}

TEST_F(FailingAllocations, InDependentRows) {
  for (const SaddlePoint& s : saddle_points()) {
    SCOPED_TRACE(s.name);
    const Symmetric K(s.dense());
    const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(K.pattern);
    std::vector<double> L(symbolic.nonzeros()), D(K.n());
    sparse::LdlWorkspace work;
    rank::DependentRows rows;
    std::vector<int> row(K.n());
    for (int k = 0; k < K.n(); ++k) row[k] = k;
    MatrixXd X(3, K.n());
    const std::vector<double> row_scale(K.n(), s.J_size());
    std::vector<char> of_M(K.n(), 0);
    std::fill_n(of_M.begin(), s.nv(), 1);
    const auto solve_panel = [&](double* Y, int ld, int cols) {
      sparse::ldl_solve_panel(symbolic, L.data(), D.data(), nullptr, Y, ld, 0, cols, nullptr);
    };
    const auto solve = [&] {
      if (rank::ldl_factor_dependent(K.pattern, symbolic, K.x.data(), of_M, 1, row_scale.data(), work, L.data(),
                                     D.data(), rows) == K.n())
        find_null_space(K.pattern, symbolic, K.x.data(), of_M, row_scale.data(), L.data(), solve_panel, rows);
      X.setOnes();
      project_out(rows, X.data());
      project_out_panel(rows, row.data(), X.data(), 3, 0, 3);
    };
    solve();
    const MatrixXd truth = X;
    const auto fresh = [&] { work = {}, rows = {}; };
    fresh();
    fail_each_allocation(
        solve,
        [&] {
          solve();
          EXPECT_EQ(X, truth);
          fresh();
        },
        true);
  }
}

TEST_F(FailingAllocations, InCholmod) {
  using sparse::Cholmod, sparse::CholmodSymbolic;
  std::mt19937 rng(83);
  const Symmetric A(random_positive(40, 0.1, rng));
  const VectorXd truth = random_matrix(40, 1, rng);
  const auto expect_solves = [&](Cholmod& cholmod) {
    ASSERT_TRUE(cholmod.factorize(A.x.data()));
    VectorXd x = A.dense * truth;
    cholmod.solve(x.data(), 1);
    EXPECT_LE(error_of(x, truth), 64 * kEps);
  };
  const auto symbolic = std::make_shared<const CholmodSymbolic>(A.pattern);
  Cholmod used(symbolic);
  expect_solves(used);
  EXPECT_GT(fail_each_allocation([&] { CholmodSymbolic(A.pattern); }, kNoCheck).failed, 20);
  const auto check = [&] {
    Cholmod cholmod(symbolic);  // the shared part is as it was
    expect_solves(cholmod);
  };
  EXPECT_GT(fail_each_allocation([&] { Cholmod cholmod(symbolic); }, check).failed, 20);
  VectorXd x(40);
  const auto solve = [&] {
    (void)used.factorize(A.x.data());
    used.solve(x.data(), 1);
  };
  const FailedRuns runs = fail_each_allocation(solve, [&] { expect_solves(used); });
  EXPECT_EQ(runs.failed, 0) << "factorize and solve allocate nothing, as the header says";
  EXPECT_EQ(runs.survived, 0);
}

TEST_F(FailingAllocations, InLeastNormSolutions) {
  std::mt19937 rng(84);
  for (const bool hidden : {false, true}) {
    MatrixXd A = random_matrix(5, 8, rng);
    A.row(4) = A.row(0) + A.row(1) + (hidden ? 1e-9 : 0) * A.row(4);  // hidden: found by a dense decomposition
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < A.rows(); ++i)
      for (int j = 0; j < A.cols(); ++j) entries.emplace_back(i, j, A(i, j));
    const VectorXd b = random_matrix(5, 1, rng), truth = rank::least_norm_solution(5, 8, entries, b);
    EXPECT_GT(fail_each_allocation([&] { rank::least_norm_solution(5, 8, entries, b); },
                                   [&] { EXPECT_EQ(rank::least_norm_solution(5, 8, entries, b), truth); })
                  .failed,
              20);
  }
}

}  // namespace
}  // namespace manycontact::test
