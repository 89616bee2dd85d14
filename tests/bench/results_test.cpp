// The results of the benchmarks are read back as written, split into series, and exponents are fitted.

#include "../../bench/results.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "../../bench/fit.hpp"
#include "support/folder.hpp"

namespace manycontact::bench {
namespace {

Run example() {
  Run run{"manycontact", "1.2", "humanoid", {{"processor", "one, \"quoted\""}, {"date", "today"}}, {}};
  run.results = {{"parts/rnea", 3.25, 0, -1},
                 {"sweep/ring/16/solve", 160, 4096, 0},
                 {"sweep/ring/4/solve", 40.125, 1024, 2e-5},
                 {"sweep/ring/4/vjp", 20, 0, -1},
                 {"sweep/separate/4/solve", 12, 0, -1}};
  return run;
}

TEST(Fit, RecoversThePower) {
  std::vector<std::pair<double, double>> points;
  for (const double n : {1., 3., 10., 1000.}) points.emplace_back(n, 7.5 * std::pow(n, 1.75));
  EXPECT_NEAR(exponent(points), 1.75, 1e-14);
}

// By hand, y = 0, 1, 1 over x = 0, 1, 2 (in decades) has the slope 1/2.
TEST(Fit, IsOfLeastSquares) { EXPECT_NEAR(exponent({{1, 1}, {10, 10}, {100, 10}}), 0.5, 1e-15); }

TEST(Fit, OfOneSizeIsNoNumber) {
  EXPECT_TRUE(std::isnan(exponent({})));
  EXPECT_TRUE(std::isnan(exponent({{4, 1}, {4, 2}})));
}

TEST(Results, AreReadAsWritten) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "results.json";
  const bench::Run run = example();
  write_runs({run, {"MuJoCo", "2", "humanoid", {}, {}}}, path);
  const std::vector<bench::Run> read = read_runs(path);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].program, "MuJoCo");
  EXPECT_EQ(read[0].version, run.version);
  EXPECT_EQ(read[0].machine, run.machine);
  ASSERT_EQ(read[0].results.size(), run.results.size());
  for (std::size_t k = 0; k < run.results.size(); ++k) {
    EXPECT_EQ(read[0].results[k].name, run.results[k].name);
    EXPECT_EQ(read[0].results[k].us, run.results[k].us);
    EXPECT_EQ(read[0].results[k].bytes, run.results[k].bytes);
    EXPECT_EQ(read[0].results[k].difference, run.results[k].difference);
  }
}

TEST(Results, OfAFileThatHoldsNoneAreRefused) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "results.json";
  EXPECT_THROW(read_runs(path), std::runtime_error);
  for (const char* text : {"", "[1]", "[{\"program\": \"p\"}]", "[{"}) {
    std::ofstream(path) << text;
    EXPECT_THROW(read_runs(path), std::runtime_error) << text;
  }
}

TEST(Results, OfATaskAscendInSize) {
  const bench::Run run = example();
  const std::vector<Point> points = series(run, "ring", "solve");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].size, 4);
  EXPECT_EQ(points[0].result->us, 40.125);
  EXPECT_EQ(points[1].size, 16);
  EXPECT_EQ(tasks(run, "ring"), (std::vector<std::string>{"solve", "vjp"}));
  EXPECT_TRUE(series(run, "chain", "solve").empty());
}

TEST(Results, AsCsvHaveARowEach) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "results.json";
  write_csv({example()}, path);
  std::ifstream in(path);
  std::string title, row;
  std::getline(in, title);
  EXPECT_TRUE(title.starts_with("program,version,robot,name,us,bytes,difference,processor,")) << title;
  std::getline(in, row);
  EXPECT_EQ(row, "manycontact,1.2,humanoid,parts/rnea,3.25,,,\"one, \"\"quoted\"\"\",,,,today");
  int rows = 1;
  while (std::getline(in, row)) ++rows;
  EXPECT_EQ(rows, 5);
}

}  // namespace
}  // namespace manycontact::bench
