// The rows that a report lists as dependent: without them J has the rank that it has with them.

#include <gtest/gtest.h>

#include <algorithm>

#include "manycontact/contact/jacobian.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/dense.hpp"
#include "support/several_contacts.hpp"

namespace manycontact::test::names {
namespace {

// The rank by singular values of rows of unit length; -1 where it is in doubt.
int clear_rank(Eigen::MatrixXd J) {
  if (J.size() == 0) return 0;
  for (Eigen::Index k = 0; k < J.rows(); ++k)
    if (const double size = J.row(k).norm(); size > 1e-12) J.row(k) /= size;
  const Eigen::VectorXd sigma = Svd(J).sigma;
  const auto above = [&](double least) { return static_cast<int>((sigma.array() > least).count()); };
  return above(1e-11) == above(1e-5) ? above(1e-8) : -1;
}

Eigen::MatrixXd without(const Eigen::MatrixXd& J, const std::vector<int>& rows) {
  std::vector<int> kept;
  for (int k = 0; k < J.rows(); ++k)
    if (std::ranges::find(rows, k) == rows.end()) kept.push_back(k);
  return J(kept, Eigen::all);
}

// What is wrong with the list of a scene; empty if nothing is.
std::string fault_of(const RandomScene& s, const Options& options, int& judged) {
  const Eigen::MatrixXd J = contact_jacobian(s.scene, s.q);
  const int rank = clear_rank(J);
  SceneData data(s.scene, options);
  const Report& report = solve(s.scene, s.q, s.v, s.u, data);
  if (rank < 0 || report.status == Status::kFailed) return "";
  std::vector<int> listed;
  for (const IslandReport& island : report.islands)
    listed.insert(listed.end(), island.dependent_rows.begin(), island.dependent_rows.end());
  if (report.rank != rank) return "rank " + std::to_string(report.rank) + ", right is " + std::to_string(rank);
  if (static_cast<int>(listed.size()) != J.rows() - rank) return std::to_string(listed.size()) + " rows are listed";
  ++judged;
  const int left = clear_rank(without(J, listed));
  return left == rank || left < 0 ? "" : "rank " + std::to_string(rank) + ", of the others " + std::to_string(left);
}

class DependentRows : public testing::TestWithParam<Method> {};

TEST_P(DependentRows, AreImpliedByTheOthers) {
  int judged = 0, faults = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    std::mt19937 rng(seed);
    const RandomScene s = seed % 4 == 0 ? random_boxes(rng) : random_hinges(rng);
    const std::string fault = fault_of(s, {GetParam()}, judged);
    if (!fault.empty() && ++faults <= 20) ADD_FAILURE() << "seed " << seed << ": " << fault;
  }
  EXPECT_GT(judged, 500);
  EXPECT_EQ(faults, 0) << "of " << judged << " scenes";
}

INSTANTIATE_TEST_SUITE_P(Of, DependentRows,
                         testing::Values(Method::kAuto, Method::kSparseLdl, Method::kSparseBodies, Method::kDense,
                                         Method::kSparseCholmod),
                         [](const auto& info) {
                           std::string name = to_string(info.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace manycontact::test::names
