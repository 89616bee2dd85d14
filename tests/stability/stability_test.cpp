// Every case by every method: whatever is called an answer must be one, and the page says what happens.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>

#include "manycontact/dynamics/solve.hpp"
#include "stability/table.hpp"
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

// At the end: the sum of all, and the page if asked for.
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
      std::cout << "true error over its bound: median " << beyond[beyond.size() / 2] << ", largest " << beyond.back()
                << "\n";
    if (std::getenv("MANYCONTACT_WRITE_PAGE") && done.size() == all_causes().size())
      std::ofstream(page_path()) << page(done);
  }
};
const testing::Environment* const summary = testing::AddGlobalTestEnvironment(new Summary);

class Stability : public testing::TestWithParam<int> {};

TEST_P(Stability, NoWrongAnswers) {
  const Cases& cases = all_causes()[GetParam()];
  std::vector<Row> rows;
  for (const Case& c : cases.list) rows.push_back(judge(c));
  std::cout << text_table(cases.cause, rows);
  EXPECT_EQ(count(rows, Outcome::kWrong), 0) << "wrong answers with a good status";
  EXPECT_EQ(count(rows, Outcome::kMislabelled), 0) << "statuses mixed up";
  for (const Row& row : rows)
    for (std::size_t k = 0; k < row.cells.size(); ++k)
      EXPECT_LE(row.cells[k].beyond_bound, 1)
          << row.which->name << " by " << table_ways()[k].name << " " << row.cells[k].note;
  for (const Row& row : rows) {
    if (!row.which->demanded) continue;
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      if (table_ways()[k].options.method == Method::kDenseSchur) continue;
      EXPECT_TRUE(row.cells[k].answered) << row.which->name << " by " << table_ways()[k].name << " "
                                         << row.cells[k].note;
      EXPECT_LE(row.cells[k].error_a, 1e-9) << row.which->name << " by " << table_ways()[k].name;
    }
  }
  if (!std::getenv("MANYCONTACT_WRITE_PAGE")) {
    auto committed = read_page()[cases.cause];
    for (const Row& row : rows)
      EXPECT_EQ(classes(row.letters()), classes(committed[row.which->name]))
          << row.which->name << ": not as on the page";
    EXPECT_EQ(committed.size(), rows.size());
  }
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

// The page is what the cases gave; each outcome that the library has today is on it.
TEST(Cases, ReachEveryOutcome) {
  std::string letters;
  for (const auto& [cause, rows] : read_page())
    for (const auto& [name, cells] : rows) letters += cells;
  for (char c : std::string("erofDI-")) EXPECT_NE(letters.find(c), std::string::npos) << c;
  EXPECT_EQ(letters.find_first_of("WM"), std::string::npos);
}

// The judge sees a wrong number, a missing one and one where there is none.
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
            Outcome::kWrong);  // refused, but with numbers
  Truths none = truths;
  none.exists = false;
  EXPECT_EQ(outcome([](SceneData&) {}, none), Outcome::kWrong);
}

}  // namespace
}  // namespace manycontact::test
