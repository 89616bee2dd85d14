// Solves every case by every method: each solution must be correct, and the page lists the outcomes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>

#include "manycontact/dynamics/solve.hpp"
#include "stability/condition.hpp"
#include "stability/table.hpp"
#include "support/dense.hpp"
#include "support/sample.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

std::vector<std::pair<std::string, std::vector<Row>>> done;  // the causes judged so far

int count(const std::vector<Row>& rows, Outcome outcome) {
  int n = 0;
  for (const Row& row : rows)
    n += static_cast<int>(
        std::count_if(row.cells.begin(), row.cells.end(), [=](const Cell& cell) { return cell.outcome == outcome; }));
  return n;
}

// Prints the sums over all causes at the end, and writes the page on request.
class Summary : public testing::Environment {
  void TearDown() override {
    std::vector<Row> all;
    for (const auto& [cause, rows] : done) all.insert(all.end(), rows.begin(), rows.end());
    if (all.empty()) return;
    std::cout << "\n" << all.size() << " cases: " << counts(all) << "\n";
    std::cout << "wrong answers with a good status: " << count(all, Outcome::kWrong) << "\n";
    std::vector<double> beyond;
    for (const Row& row : all)
      for (const Cell& cell : row.cells)
        if (cell.beyond_bound > 0) beyond.push_back(cell.beyond_bound);
    std::sort(beyond.begin(), beyond.end());
    if (!beyond.empty())
      std::cout << "bound over true error: least " << 1 / beyond.back() << ", median " << 1 / beyond[beyond.size() / 2]
                << ", 95 % below " << 1 / beyond[beyond.size() / 20] << "\n";
    if (!std::getenv("MANYCONTACT_WRITE_PAGE") || done.size() != all_causes().size()) return;
    std::ofstream(page_path()) << page(done);
    std::ofstream(errors_path()) << errors_by_precision(all);
  }
};
const testing::Environment* const summary = testing::AddGlobalTestEnvironment(new Summary);

class Stability : public testing::TestWithParam<int> {};

TEST_P(Stability, NoWrongAnswers) {
  const Cases& cases = all_causes()[GetParam()];
  std::vector<Row> rows;
  for (std::size_t k = 0; k < cases.list.size(); k += test::sample()) rows.push_back(judge(cases.list[k]));
  std::cout << text_table(cases.cause, rows);
  EXPECT_EQ(count(rows, Outcome::kWrong), 0) << "wrong answers with a good status";
  EXPECT_EQ(count(rows, Outcome::kMislabelled), 0) << "statuses mixed up";
  for (const Row& row : rows)
    for (std::size_t k = 0; k < row.cells.size(); ++k)
      EXPECT_LE(row.cells[k].beyond_bound, 1)
          << row.which->name << " by " << judged_ways()[k].name << " " << row.cells[k].note;
  for (const Row& row : rows) {
    if (!row.which->demanded) continue;
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      if (judged_ways()[k].options.method == Method::kDenseSchur) continue;
      EXPECT_TRUE(row.cells[k].answered && row.cells[k].outcome != Outcome::kRegularised)
          << row.which->name << " by " << judged_ways()[k].name << " " << row.cells[k].note;
      const bool single = judged_ways()[k].options.precision == Precision::kSingle;
      EXPECT_LE(row.cells[k].error_a, single ? 1e-2 : 1e-9) << row.which->name << " by " << judged_ways()[k].name;
    }
  }
// The page is that of the release build, since the compiler's choices change outcomes near thresholds.
#ifdef NDEBUG
  if (!std::getenv("MANYCONTACT_WRITE_PAGE")) {
    auto committed = read_page()[cases.cause];
    for (const Row& row : rows)
      EXPECT_TRUE(agree(classes(row.letters()), committed[row.which->name]))
          << row.which->name << ": " << classes(row.letters()) << ", " << committed[row.which->name] << " on the page";
    EXPECT_EQ((committed.size() + test::sample() - 1) / test::sample(), rows.size());
  }
#endif
  done.emplace_back(cases.cause, std::move(rows));
}

std::vector<int> numbers() {
  std::vector<int> out(all_causes().size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<int>(k);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Causes, Stability, testing::ValuesIn(numbers()),
                         [](const auto& info) { return readable(all_causes()[info.param].cause); });

TEST(Cases, AreManyAndDistinct) {
  std::set<std::string> names;
  std::size_t n = 0;
  for (const Cases& cases : all_causes())
    for (const Case& c : cases.list) names.insert(c.cause + ": " + c.name), ++n;
  EXPECT_EQ(names.size(), n);
  EXPECT_GE(n, 200u);
}

// The page lists the outcomes of the cases; each kind of outcome that the library has today is on it.
TEST(Cases, ReachEveryOutcome) {
  std::string letters;
  for (const auto& [cause, rows] : read_page())
    for (const auto& [name, cells] : rows) letters += cells;
  for (char c : std::string("aDIGd-")) EXPECT_NE(letters.find(c), std::string::npos) << c;
  EXPECT_EQ(letters.find_first_of("WM"), std::string::npos);
}

// The judge must detect a wrong number, a missing one and one that should not exist.
TEST(Judge, SeesWrongAnswers) {
  Problem p = robot("arm", false);
  hold(p, ContactType::k3D, "tool");
  const Truths truths(p);
  ASSERT_TRUE(truths.exists);
  const Way way = table_ways().front();
  const auto outcome = [&](const std::function<void(SceneData&)>& spoil, const Truths& against) {
    SceneData data(p.scene, way.options);
    (void)solve(p.scene, p.q, p.v, p.u, data);
    spoil(data);
    return judge_answer(p, against, data, way).outcome;
  };
  EXPECT_EQ(outcome([](SceneData&) {}, truths), Outcome::kExact);
  EXPECT_EQ(outcome([](SceneData& d) { d.a[3] *= 1 + 1e-6; }, truths), Outcome::kWrong);
  EXPECT_EQ(outcome([](SceneData& d) { d.f[1] *= 1 + 1e-6; }, truths), Outcome::kWrong);
  EXPECT_EQ(outcome([](SceneData& d) { d.a[0] = std::nan(""); }, truths), Outcome::kWrong);
  EXPECT_EQ(outcome([](SceneData& d) { d.report.status = d.report.islands[0].status = Status::kFailed; }, truths),
            Outcome::kWrong);  // status failed, but with numbers
  Truths none = truths;
  none.exists = false;
  EXPECT_EQ(outcome([](SceneData&) {}, none), Outcome::kWrong);
  Truths turned = truths;
  for (Direction& d : turned.directions) d.da *= Quad(1 + 1e-6);
  EXPECT_EQ(outcome([](SceneData&) {}, turned), Outcome::kWrong);  // derivatives
}

// Two claims of a regularised solution are judged: it is the one without damping, and damping is lost.
TEST(Judge, SeesWrongRegularisedAnswers) {
  Problem p = robot("arm", false);
  hold(p, ContactType::k6D, "tool");
  hold(p, ContactType::k6D, "tool", {0.1, 0, 0});
  const Problem neighbour = without_damping(p);
  const Truths undamped(neighbour);
  ASSERT_TRUE(undamped.exists);
  const Way way = table_ways().front();
  const auto outcome = [&](double damping, const std::function<void(SceneData&)>& spoil) {
    p.scene.damping = damping;
    SceneData data(neighbour.scene, way.options);
    (void)solve(neighbour.scene, p.q, p.v, p.u, data);
    data.report.status = data.report.islands[0].status = Status::kRegularised;
    data.report.islands[0].reason = Reason::kDampingLost;
    spoil(data);
    return judge_answer(neighbour, claimed(Truths(p), undamped, data.report), data, way).outcome;
  };
  EXPECT_EQ(outcome(1e-16, [](SceneData&) {}), Outcome::kRegularised);
  EXPECT_EQ(outcome(1e-16, [](SceneData& d) { d.a *= 1 + 1e-6; }), Outcome::kWrong);
  EXPECT_EQ(outcome(1e-16, [](SceneData& d) { d.f *= 1 + 1e-6; }), Outcome::kWrong);
  EXPECT_EQ(outcome(1e-16, [](SceneData& d) { d.f[8] = std::nan(""); }), Outcome::kWrong);
  EXPECT_EQ(outcome(1e-16, [](SceneData& d) { d.report.islands[0].reason = Reason::kNone; }), Outcome::kMislabelled);
  EXPECT_EQ(outcome(1e-4, [](SceneData&) {}), Outcome::kMislabelled);
}

// Only the regularised one of two islands is compared with the solution without damping.
TEST(Judge, TellsIslandsApart) {
  Problem p = two_robots("arm", false, "box");
  hold(p, ContactType::k3D, "tool", {0, 0, 0}, ReferenceFrame::kLocal, "a");
  hold(p, ContactType::k3D, "bottom_4", {0, 0, 0}, ReferenceFrame::kLocal, "b");
  p.scene.damping = 1e-3;
  const Truths damped(p), undamped(without_damping(p));
  Report report;
  report.islands.resize(2);
  report.islands[1].status = Status::kRegularised;
  const Truths mixed = claimed(damped, undamped, report);
  ASSERT_TRUE(mixed.exists);
  const auto same = [&](std::size_t i, const Truths& other) {
    const IslandTruth& island = mixed.islands[i];
    bool equal = mixed.a(island.v) == other.a(island.v) && mixed.f(island.f) == other.f(island.f);
    for (std::size_t k = 0; k < mixed.directions.size(); ++k)
      equal = equal && mixed.directions[k].df(island.f) == other.directions[k].df(island.f);
    return equal && island.condition.product() == other.islands[i].condition.product();
  };
  EXPECT_EQ(mixed.directions.size(), 3u);
  EXPECT_TRUE(same(0, damped));
  EXPECT_TRUE(same(1, undamped));
  EXPECT_FALSE(same(0, undamped));
  EXPECT_FALSE(same(1, damped));
}

// The condition of K (regular, damped, singular) is compared with its pseudo-inverse from singular values in double.
TEST(Condition, IsThatOfTheGeneralisedInverse) {
  struct Kind {
    int times;
    double damping;
    int rank;
  };
  for (const auto& [times, damping, rank] : {Kind{1, 0, 6}, Kind{1, 1e-3, 6}, Kind{2, 1e-3, 12}, Kind{2, 0, 6}}) {
    Problem p = robot("arm", false);
    for (int k = 0; k < times; ++k) hold(p, ContactType::k6D, "tool", {0.1 * k, 0, 0}, ReferenceFrame::kWorld);
    const IslandSystem<Quad> system = island_systems<Quad>(p)[0];
    const Eigen::Index nv = system.M.rows(), nc = system.J.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(nv + nc, nv + nc);
    K.topLeftCorner(nv, nv) = system.M.cast<double>();
    K.bottomLeftCorner(nc, nv) = system.J.cast<double>();
    K.topRightCorner(nv, nc) = system.J.cast<double>().transpose();
    K.bottomRightCorner(nc, nc).diagonal().setConstant(-damping);
    const Eigen::MatrixXd inverse = least_norm(K, Eigen::MatrixXd::Identity(nv + nc, nv + nc), 1e-11);
    const auto norm_1 = [](const Eigen::MatrixXd& A) { return A.cwiseAbs().colwise().sum().maxCoeff(); };
    const double expected = norm_1(K) * norm_1(inverse);
    EXPECT_NEAR(condition(system, damping, rank).product() / expected, 1, 1e-9)
        << times << " times, damping " << damping;
    if (times == 2 && damping == 0) continue;
    const double estimate = estimated_condition(island_systems<double>(p)[0], damping).product();
    EXPECT_LE(estimate, expected * (1 + 1e-9));
    EXPECT_GE(estimate, expected / 3);
  }
}

}  // namespace
}  // namespace manycontact::test
