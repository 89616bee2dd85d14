// `manycontact chart` is tested: its CSV, its errors, its pictures.

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "cli/program.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/kkt/options.hpp"

namespace manycontact::cli {
namespace {

constexpr char kHeader[] =
    "scene,method,order,regularisation,status,time_us,error_acceleration,error_forces,error_derivatives,front";

using Row = std::map<std::string, std::string>;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells{""};
  for (char c : line)
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  return cells;
}

std::vector<Row> read_csv(const std::string& path) {
  const std::vector<std::string> lines = lines_of(read_text(path)), names = cells_of(kHeader);
  std::vector<Row> rows;
  if (lines.empty()) return rows;
  EXPECT_EQ(lines[0], kHeader);
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::vector<std::string> cells = cells_of(lines[k]);
    EXPECT_EQ(cells.size(), names.size()) << lines[k];
    Row& row = rows.emplace_back();
    for (std::size_t j = 0; j < std::min(cells.size(), names.size()); ++j) row[names[j]] = cells[j];
  }
  return rows;
}

double value(const Row& row, const std::string& name) {
  return row.at(name).empty() ? NAN : std::strtod(row.at(name).c_str(), nullptr);
}

std::vector<Row> of(const std::vector<Row>& rows, const std::string& method, const std::string& regularisation) {
  std::vector<Row> out;
  for (const Row& row : rows)
    if (row.at("method") == method && row.at("regularisation") == regularisation) out.push_back(row);
  return out;
}

void expect_picture(const std::string& base) {
  if (!has_matplotlib()) return;
  const std::string svg = read_text(base + ".svg"), png = read_text(base + ".png");
  EXPECT_TRUE(svg.starts_with("<?xml")) << base;
  EXPECT_NE(svg.find("</svg>"), std::string::npos) << base;
  std::size_t open = 0, close = 0;
  for (std::size_t at = 0; (at = svg.find("<g", at)) != std::string::npos; at += 2)
    open += svg[at + 2] == ' ' || svg[at + 2] == '>';
  for (std::size_t at = 0; (at = svg.find("</g>", at)) != std::string::npos; at += 4) ++close;
  EXPECT_EQ(open, close) << base;
  for (const char* text : {"Accelerations", "Contact forces", "Derivatives", "sparse-ldl", "auto", "relative error"})
    EXPECT_NE(svg.find(text), std::string::npos) << base << " lacks " << text;
  EXPECT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n")) << base;
  EXPECT_GT(png.size(), 10000u) << base;
}

class ChartOf : public Program {
 protected:
  std::vector<Row> chart(const std::vector<std::string>& scenes) {
    std::vector<std::string> words{"chart", "--seconds", "0", "--out", path("out")};
    words.insert(words.end(), scenes.begin(), scenes.end());
    const auto outcome = run(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    out = outcome.out;
    return read_csv(path("out/chart.csv"));
  }
  std::string out;
  const std::vector<std::string> words_{"chart", model("arm_pushes_box.xml"), "--seconds", "0", "--out", path("out")};
};

// Returns max(1e-12, 100 eps cond), computed with the library.
double allowed_of(const std::string& path) {
  const SceneFile file = load_scene(path);
  SceneData data(file.scene, {Method::kDense, {}});
  (void)solve(file.scene, file.q, file.v, file.u, data);
  estimate_condition(file.scene, data);
  return std::max(1e-12, 100 * 2.2e-16 * data.report.condition);
}

TEST_F(ChartOf, EveryMethodOrderAndDampingHasALine) {
  const std::vector<Row> rows = chart({model("humanoid_hands_and_feet.xml")});
  for (const char* regularisation : {"none", "1e-12", "1e-9", "1e-6", "1e-3"})
    for (Method method : kMethods) {
      const std::vector<Row> lines = of(rows, to_string(method), regularisation);
      std::set<std::string> orders;
      for (const Row& row : lines) {
        orders.insert(row.at("order"));
        EXPECT_EQ(row.at("scene"), "humanoid_hands_and_feet");
        EXPECT_EQ(row.at("status"), std::string(regularisation) == "none" ? "ok" : "regularised");
        EXPECT_GT(value(row, "time_us"), 0);
      }
      EXPECT_EQ(orders.size(), lines.size()) << to_string(method);
      if (method == Method::kSparseLdl) {
        EXPECT_EQ(orders, (std::set<std::string>{"leaf-to-root", "contacts-early", "camd"}));
      } else {
        EXPECT_FALSE(orders.empty()) << to_string(method) << " " << regularisation;
      }
    }
  expect_picture(path("out/chart"));
}

TEST_F(ChartOf, ErrorsAreThoseOfTheSceneAsGiven) {
  const std::string scene = model("humanoid_hands_and_feet.xml");
  const std::vector<Row> rows = chart({scene});
  const double allowed = allowed_of(scene);
  for (const char* method : {"dense", "sparse-ldl", "sparse-cholmod", "auto"})
    for (const Row& row : of(rows, method, "none")) {
      EXPECT_LE(value(row, "error_acceleration"), allowed) << method;
      EXPECT_LE(value(row, "error_forces"), allowed) << method;
      EXPECT_LE(value(row, "error_derivatives"), 10 * allowed) << method;
      EXPECT_LE(value(row, "error_derivatives"), 1e-12) << method;
      EXPECT_GT(value(row, "error_derivatives"), 0) << method;
    }
  // to first order in the damping: a thousandfold damping, a thousandfold error
  for (const char* error : {"error_acceleration", "error_forces", "error_derivatives"}) {
    const double small = value(of(rows, "sparse-ldl", "1e-9")[0], error);
    const double large = value(of(rows, "sparse-ldl", "1e-6")[0], error);
    EXPECT_GT(small, 1e-10) << error;
    EXPECT_NEAR(large / small, 1000, 20) << error;
  }
}

TEST_F(ChartOf, FrontHoldsWhatNothingDominates) {
  const std::vector<Row> rows = chart({model("arm_pushes_box.xml")});
  int fronts = 0;
  for (const Row& row : rows) {
    bool dominated = false;
    const double t = value(row, "time_us"), e = value(row, "error_acceleration");
    for (const Row& other : rows) {
      const double to = value(other, "time_us"), eo = value(other, "error_acceleration");
      dominated = dominated || (to <= t && eo <= e && (to < t || eo < e));
    }
    if (row.at("front") == "yes") {
      EXPECT_FALSE(dominated);
      ++fronts;
    } else {
      EXPECT_EQ(row.at("front"), "no");
      EXPECT_TRUE(dominated) << row.at("method");
    }
  }
  EXPECT_GT(fronts, 0);
}

TEST_F(ChartOf, FailuresAreRows) {
  const std::vector<Row> rows = chart({model("feet_on_corners.xml")});
  const std::vector<Row> baseline = of(rows, "dense-schur", "none");
  ASSERT_EQ(baseline.size(), 1u);
  EXPECT_EQ(baseline[0].at("status"), "failed");
  for (const char* error : {"error_acceleration", "error_forces", "error_derivatives"})
    EXPECT_EQ(baseline[0].at(error), "");
  EXPECT_EQ(baseline[0].at("front"), "no");
  for (const Row& row : of(rows, "auto", "none")) {
    EXPECT_EQ(row.at("status"), "redundant");
    EXPECT_LE(value(row, "error_acceleration"), 1e-12);  // against the dense truth: K is singular
    EXPECT_LE(value(row, "error_derivatives"), 1e-11);
  }
  expect_contains(out, "Failed: dense-schur");
  expect_contains(out, "Accelerations of 1 robot vanish");
  if (has_matplotlib()) {
    EXPECT_NE(read_text(path("out/chart.svg")).find("failed, skipped or unknown"), std::string::npos);
  }
}

TEST_F(ChartOf, SceneWithADampingOfItsOwnIsJudgedByIt) {
  const std::vector<Row> rows = chart({model("quadruped_loop.xml")});
  EXPECT_TRUE(of(rows, "sparse-ldl", "none").empty());
  for (const Row& row : of(rows, "sparse-ldl", "1e-6")) {
    EXPECT_EQ(row.at("status"), "ok");
    EXPECT_LE(value(row, "error_forces"), 1e-12);
  }
  for (const Row& row : of(rows, "sparse-ldl", "1e-3")) {
    EXPECT_EQ(row.at("status"), "regularised");
    EXPECT_GT(value(row, "error_forces"), 1e-5);
  }
}

TEST_F(ChartOf, SeveralScenesShareOnePage) {
  const std::vector<Row> rows = chart({model("arm_pushes_box.xml"), model("humanoid_standing.xml")});
  std::set<std::string> scenes;
  for (const Row& row : rows) scenes.insert(row.at("scene"));
  EXPECT_EQ(scenes, (std::set<std::string>{"arm_pushes_box", "humanoid_standing"}));
  const std::string page = read_text(path("out/README.md"));
  for (const std::string& name : scenes) {
    expect_picture(path("out/" + name));
    EXPECT_NE(page.find("## " + name), std::string::npos);
    EXPECT_EQ(page.find("![" + name + "](" + name + ".svg)") != std::string::npos, has_matplotlib());
  }
  EXPECT_FALSE(std::filesystem::exists(path("out/chart.svg")));
}

// Rows of two scenes with one name are distinguished by their files.
TEST_F(ChartOf, NamesakesHaveTheirPaths) {
  const std::string one = scene(R"(<robot name="b" urdf="box.urdf" base="floating"/>)");
  std::filesystem::copy_file(one, path("other.xml"));
  std::set<std::string> scenes;
  for (const Row& row : chart({one, path("other.xml")})) scenes.insert(row.at("scene"));
  EXPECT_EQ(scenes, (std::set<std::string>{"test (" + one + ")", "test (" + path("other.xml") + ")"}));
  expect_contains(read_text(path("out/README.md")), "## test (" + one + ")");
}

TEST_F(ChartOf, WhatWouldTakeTooLongIsSkipped) {
  const std::vector<Row> rows = chart({model("arm_pushes_box.xml"), "--longest", "0"});
  for (const Row& row : rows) {
    const bool dense = row.at("method").starts_with("dense");
    EXPECT_EQ(row.at("status") == "skipped", dense) << row.at("method");
    EXPECT_EQ(row.at("time_us").empty(), dense) << row.at("method");
    EXPECT_EQ(row.at("error_acceleration").empty(), dense) << row.at("method");
  }
  expect_contains(out, "Skipped as too slow or too large, wholly or for derivatives: dense, dense-schur,");
  if (has_matplotlib()) {
    EXPECT_NE(read_text(path("out/chart.svg")).find("failed, skipped or unknown"), std::string::npos);
  }
}

// A box is at rest: its accelerations and most of its derivatives are exactly zero.
TEST_F(ChartOf, ZerosAreJudgedByWhatIsNot) {
  const std::vector<Row> rows = chart({scene(R"(<robot name="b" urdf="box.urdf" base="floating" copies="2"/>
    <contact name="c" type="6d" frame="b/face_top"/>)")});
  for (const Row& row : of(rows, "dense-schur", "none")) EXPECT_LT(value(row, "error_derivatives"), 1e-12);
  for (const Row& row : of(rows, "dense-schur", "1e-6")) {
    EXPECT_GT(value(row, "error_acceleration"), 1e-8);
    EXPECT_LT(value(row, "error_derivatives"), 1e-3);
  }
  expect_picture(path("out/chart"));
}

TEST_F(ChartOf, WithoutPythonThereAreTheNumbers) {
  const Outcome outcome = run_with_python("", words_);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "");
  expect_contains(outcome.err, "python3 with matplotlib is not installed (Debian: python3-matplotlib), no charts");
  EXPECT_GT(read_csv(path("out/chart.csv")).size(), 40u);
  const auto written = nlohmann::json::parse(read_text(path("out/chart.json")));
  EXPECT_EQ(written["charts"][0]["rows"].size(), read_csv(path("out/chart.csv")).size());
  EXPECT_FALSE(std::filesystem::exists(path("out/chart.svg")));
}

// Python without matplotlib writes the sentences and the page.
TEST_F(ChartOf, WithoutMatplotlibThereIsTheText) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "there is no /usr/bin/python3 here";
  const Outcome outcome = run_with_python(
      "exec /usr/bin/python3 -S -E \"$@\"",
      {"chart", model("arm_pushes_box.xml"), model("humanoid_standing.xml"), "--seconds", "0", "--out", path("out")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "The fastest accurate method is");
  expect_contains(outcome.err, "python3 with matplotlib is not installed");
  const std::string page = read_text(path("out/README.md"));
  EXPECT_NE(page.find("## humanoid_standing"), std::string::npos);
  EXPECT_EQ(page.find(".svg"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("out/humanoid_standing.svg")));
}

// A Python that fails is not reported as one that is not installed.
TEST_F(ChartOf, PythonThatFailsIsReported) {
  const Outcome outcome = run_with_python("[ \"$1\" = -c ]", words_);
  EXPECT_EQ(outcome.status, 1);
  expect_contains(outcome.err, "run by " + path("bin/python3") + ", failed");
  expect_lacks(outcome.err, "not installed");
  EXPECT_GT(read_csv(path("out/chart.csv")).size(), 40u);
}

TEST_F(ChartOf, FolderThatCannotBeIsBadInput) {
  std::ofstream(path("file")) << "x";
  const auto outcome = run({"chart", model("arm_pushes_box.xml"), "--out", path("file")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("manycontact: " + path("file") + ":1: ")) << outcome.err;
  EXPECT_EQ(run({"chart", "/nowhere/scene.xml", "--out", path("out")}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

}  // namespace
}  // namespace manycontact::cli
