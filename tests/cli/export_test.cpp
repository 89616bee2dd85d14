// `manycontact export` writes files that solve each other and agree with the output of solve.

#include <Eigen/Dense>
#include <cmath>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

namespace fs = std::filesystem;
using Long = long double;
using LongMatrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

struct MatrixFile {
  std::string kind;
  LongMatrix values;
  long entries = 0;  // lines of a coordinate file
};

// 17 digits identify a double but do not equal it.
Long number_of(const std::string& text) {
  return text.size() > 30 ? std::strtold(text.c_str(), nullptr) : std::strtod(text.c_str(), nullptr);
}

MatrixFile read_matrix(const std::string& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in.good()) << path;
  MatrixFile out;
  std::string line;
  std::getline(in, out.kind);
  while (std::getline(in, line) && line.starts_with("%")) continue;
  std::istringstream sizes(line);
  long rows = 0, columns = 0;
  sizes >> rows >> columns >> out.entries;
  out.values.setZero(rows, columns);
  std::string number;
  if (out.kind.find("array") != std::string::npos) {
    for (long k = 0; k < rows * columns && in >> number; ++k) out.values(k % rows, k / rows) = number_of(number);
  } else {
    const bool symmetric = out.kind.find("symmetric") != std::string::npos;
    long i = 0, j = 0;
    for (long k = 0; k < out.entries && in >> i >> j >> number; ++k) {
      EXPECT_TRUE(!symmetric || i >= j) << path << " has an entry above the diagonal: " << i << " " << j;
      out.values(i - 1, j - 1) = number_of(number);
      if (symmetric) out.values(j - 1, i - 1) = out.values(i - 1, j - 1);
    }
  }
  EXPECT_FALSE(in.fail()) << path << " ends early";
  return out;
}

LongMatrix column_of(const nlohmann::json& list, Long sign = 1) {
  LongMatrix out(static_cast<Eigen::Index>(list.size()), 1);
  for (std::size_t k = 0; k < list.size(); ++k) out(static_cast<Eigen::Index>(k), 0) = sign * list[k].get<double>();
  return out;
}

LongMatrix rows_of(const nlohmann::json& rows) {
  if (rows.empty()) return {};
  LongMatrix out(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows[0].size()));
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = column_of(rows[i]).transpose();
  return out;
}

// Returns max |b - K x| divided by max (|K| |x| + |b|), which is below n eps for the numbers as written.
Long backward_error(const LongMatrix& K, const LongMatrix& x, const LongMatrix& b) {
  const LongMatrix r = b - K * x, terms = K.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
  return r.cwiseAbs().maxCoeff() / terms.maxCoeff();
}

constexpr Long kLongEpsilon = std::numeric_limits<Long>::epsilon();
constexpr double kGravity = 9.81;  // scale of accelerations at rest
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

class Export : public Program {
 protected:
  Outcome write(const std::string& scene, std::vector<std::string> options = {"--truth"}) const {
    options.insert(options.begin(), {"export", scene, "--out", path("out")});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome;
  }
  MatrixFile read(const std::string& name) const { return read_matrix(path("out/" + name)); }
};

// For one island x is the output of solve, and solves K x = b to more digits than doubles have.
TEST_F(Export, SolutionIsThatOfSolve) {
  const std::string file = model("two_humanoids_carry_beam.xml");
  expect_contains(write(file).out, "1 system, all with solutions");
  const auto json = solve({file});
  const MatrixFile K = read("island_0.mtx"), b = read("island_0_b.mtx"), x = read("island_0_x.mtx");
  EXPECT_EQ(K.kind, "%%MatrixMarket matrix coordinate real symmetric");
  EXPECT_EQ(b.kind, "%%MatrixMarket matrix array real general");
  const LongMatrix a = column_of(json.at("acceleration")), f = column_of(json.at("forces"), -1);
  ASSERT_EQ(x.values.rows(), a.rows() + f.rows());
  EXPECT_LT(backward_error(K.values, x.values, b.values), static_cast<Long>(x.values.rows()) * kLongEpsilon);
  EXPECT_LT((x.values.topRows(a.rows()) - a).cwiseAbs().maxCoeff(), 1e-10 * (kGravity + a.cwiseAbs().maxCoeff()));
  EXPECT_LT((x.values.bottomRows(f.rows()) - f).cwiseAbs().maxCoeff(), 1e-10 * f.cwiseAbs().maxCoeff());
  // every number has the digits of quadruple precision
  const std::string text = lines_of(read_text(path("out/island_0_x.mtx"))).back();
  EXPECT_GE(text.find('e') - text.find('.'), 33u) << text;
}

// The scene's x has the last digits of a solve in extended precision; those of x differ, as K and b are rounded.
TEST_F(Export, WritesTheSolutionOfTheScene) {
  const std::string file = model("two_humanoids_carry_beam.xml");
  write(file);
  const auto json = solve({file, "--precision", "extended"});
  ASSERT_EQ(json.at("report").at("precision"), "extended");
  const LongMatrix f = column_of(json.at("forces"), -1);
  const LongMatrix of_scene = read("island_0_scene_x.mtx").values.bottomRows(f.rows()),
                   of_k = read("island_0_x.mtx").values.bottomRows(f.rows());
  EXPECT_LT((of_scene - f).cwiseAbs().maxCoeff(), 4 * kEpsilon * f.cwiseAbs().maxCoeff());
  EXPECT_GT((of_k - of_scene).cwiseAbs().maxCoeff(), 0);
}

// Every contact has its own rows, though solve reduces those between the same bodies, and x has forces of least norm.
TEST_F(Export, KeepsRowsThatDependOnEachOther) {
  const std::string file = model("feet_on_corners.xml");
  write(file);
  const auto json = solve({file});
  const MatrixFile K = read("island_0.mtx"), b = read("island_0_b.mtx"), x = read("island_0_x.mtx");
  const LongMatrix a = column_of(json.at("acceleration")), f = column_of(json.at("forces"), -1);
  ASSERT_EQ(f.rows(), 24);
  ASSERT_EQ(K.values.rows(), a.rows() + 24);
  EXPECT_LT(backward_error(K.values, x.values, b.values), 100 * kEpsilon);
  EXPECT_LT((x.values.topRows(a.rows()) - a).cwiseAbs().maxCoeff(), 1e-9 * (kGravity + a.cwiseAbs().maxCoeff()));
  EXPECT_LT((x.values.bottomRows(f.rows()) - f).cwiseAbs().maxCoeff(), 1e-9 * f.cwiseAbs().maxCoeff());
  expect_contains(read_text(path("out/README.md")), "| 24 | 12 |");
  expect_contains(read_text(path("out/README.md")), "of the scene, 32");
  const auto island = nlohmann::json::parse(read_text(path("out/export.json")))["islands"][0];
  EXPECT_EQ(island["nc"], 24);
  EXPECT_EQ(island["rank"], 12);
  EXPECT_EQ(island["x_is_of_the_scene"], true);
}

TEST_F(Export, WithoutPythonThereIsTheList) {
  const Outcome outcome = run_with_python("", {"export", model("arm_pushes_box.xml"), "--out", path("out")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "manycontact: python3 is not installed, so README.md is not written; export.json has the numbers\n");
  EXPECT_EQ(nlohmann::json::parse(read_text(path("out/export.json")))["islands"].size(), 1u);
  EXPECT_TRUE(fs::exists(path("out/island_0.mtx")));
  EXPECT_FALSE(fs::exists(path("out/README.md")));
}

TEST_F(Export, DerivativesSolveTheirSystem) {
  const std::string file = model("arm_pushes_box.xml");
  write(file, {"--truth", "--derivatives"});
  const auto json = solve({file, "--derivatives"});
  const MatrixFile K = read("island_0.mtx"), db = read("island_0_db.mtx"), dx = read("island_0_dx.mtx");
  EXPECT_EQ(db.kind, "%%MatrixMarket matrix coordinate real general");
  EXPECT_LT(db.entries, 0.6 * static_cast<double>(db.values.size()));  // the box does not depend on most joints
  for (Eigen::Index j = 0; j < db.values.cols(); ++j)
    EXPECT_LT(backward_error(K.values, dx.values.col(j), db.values.col(j)),
              static_cast<Long>(dx.values.rows()) * kLongEpsilon)
        << j;
  const LongMatrix da_dq = rows_of(json.at("da_dq")), df_du = rows_of(json.at("dforces_du"));
  const Eigen::Index nv = da_dq.rows();
  EXPECT_LT((dx.values.topLeftCorner(nv, nv) - da_dq).cwiseAbs().maxCoeff(), 1e-9 * da_dq.cwiseAbs().maxCoeff());
  EXPECT_LT((dx.values.bottomRightCorner(df_du.rows(), df_du.cols()) + df_du).cwiseAbs().maxCoeff(),
            1e-9 * df_du.cwiseAbs().maxCoeff());
}

// ExternalWrenches, springs and joint friction are part of b.
TEST_F(Export, AppliedForcesAreInTheRightHandSide) {
  const std::string file = scene(
      "<robot name=\"load\" urdf=\"box.urdf\" base=\"floating\"/><spring frame=\"load/crate\" xyz=\"0 0 2\" "
      "stiffness=\"100\" length=\"0.8\"/><push name=\"hand\" frame=\"load/crate\" force=\"1 2 3\"/>"
      "<contact name=\"c\" type=\"3d\" frame=\"load/crate\"/>",
      "damping=\"1e-3\"");
  write(file, {"--truth", "--derivatives"});
  const auto json = solve({file, "--derivatives"});
  const LongMatrix K = read("island_0.mtx").values, x = read("island_0_x.mtx").values,
                   dx = read("island_0_dx.mtx").values;
  EXPECT_EQ(K(6, 6), -1e-3L + (K(6, 6) + 1e-3L));  // delta, as a double
  EXPECT_NEAR(static_cast<double>(K(6, 6)), -1e-3, 1e-18);
  const LongMatrix a = column_of(json.at("acceleration")), da_dq = rows_of(json.at("da_dq"));
  EXPECT_LT((x.topRows(6) - a).cwiseAbs().maxCoeff(), 1e-12 * a.cwiseAbs().maxCoeff());
  EXPECT_LT((dx.topLeftCorner(6, 6) - da_dq).cwiseAbs().maxCoeff(), 1e-10 * da_dq.cwiseAbs().maxCoeff());
}

// With a condition of 1e14 doubles have two digits, and the file has the digits that quadruple precision leaves.
TEST_F(Export, BadConditions) {
  const std::string humanoid = "<robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\"/>";
  const std::string file =
      scene(humanoid +
            "<contact name=\"a\" type=\"3d\" frame=\"h/left_sole\"/>"
            "<contact name=\"b\" type=\"3d\" frame=\"h/left_sole\" offset=\"1e-6 0 0\"/>"
            "<contact name=\"c\" type=\"1d\" axis=\"0 0 1\" frame=\"h/left_sole\" offset=\"0 1e-6 0\"/>");
  write(file);
  const LongMatrix K = read("island_0.mtx").values, x = read("island_0_x.mtx").values,
                   b = read("island_0_b.mtx").values;
  EXPECT_LT(backward_error(K, x, b), 1e-15L);
  const std::string page = read_text(path("out/README.md"));
  const std::size_t row = page.find("| island_0 |");
  ASSERT_NE(row, std::string::npos);
  std::istringstream cells(page.substr(row));
  std::vector<std::string> cell;
  for (std::string text; std::getline(cells, text, '|') && cell.size() < 12;) cell.push_back(text);
  EXPECT_GT(std::stod(cell[7]), 1e10) << page;
}

// Islands and names are written, and nothing that was not requested.
TEST_F(Export, OneSystemPerIsland) {
  const std::string file = scene(
      "<robot name=\"a\" urdf=\"box.urdf\" base=\"floating\"/><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
      "<contact name=\"c\" type=\"3d\" frame=\"b/crate\"/>");
  expect_contains(write(file, {}).out, "2 systems");
  for (const char* name : {"island_0.mtx", "island_0_b.mtx", "island_1.mtx", "island_1_names.txt", "README.md"})
    EXPECT_TRUE(fs::exists(path("out/") + name)) << name;
  for (const char* name : {"island_0_x.mtx", "island_0_db.mtx", "island_2.mtx"})
    EXPECT_FALSE(fs::exists(path("out/") + name)) << name;
  const auto names = lines_of(read_text(path("out/island_1_names.txt")));
  ASSERT_EQ(names.size(), 9u);
  EXPECT_EQ(names[0], "b/root[0]");
  EXPECT_EQ(names[8], "c[2]");
  EXPECT_EQ(read("island_0.mtx").values.rows(), 6);
  expect_no_parts();
}

// The error is one line, and no input file is overwritten.
// Robots without velocities have an empty system, alone and beside others: their only joints are fixed or locked.
TEST_F(Export, SystemsWithoutVelocities) {
  const auto put = [this](const std::string& name, const std::string& joint) {
    std::ofstream(path(name))
        << "<robot name=\"r\"><link name=\"w\"/><link name=\"b\"><inertial><origin xyz=\"0.3 0 0\"/>"
           "<mass value=\"1\"/><inertia ixx=\"0.1\" iyy=\"0.2\" izz=\"0.3\" ixy=\"0\" ixz=\"0\" "
           "iyz=\"0\"/></inertial></link>" +
               joint + "</robot>";
  };
  const std::string ends = "<parent link=\"w\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/></joint>";
  put("table.urdf", "<joint name=\"j\" type=\"fixed\">" + ends);
  put("swing.urdf", "<joint name=\"j\" type=\"continuous\">" + ends);
  const std::string table = "<robot name=\"t\" urdf=\"table.urdf\"/>",
                    swing = "<robot name=\"a\" urdf=\"swing.urdf\"/>",
                    locked = "<robot name=\"l\" urdf=\"swing.urdf\"><lock joint=\"j\" at=\"0.1\"/></robot>",
                    touch = "<contact name=\"c\" type=\"3d\" frame=\"l/b\" to=\"a/b\"/>";
  for (const std::string& inside : {table, table + locked, table + swing, locked + swing + touch})
    for (const std::string damping : {"0", "0.01"})
      for (const std::vector<std::string>& options :
           {std::vector<std::string>{"--truth"}, std::vector<std::string>{"--truth", "--derivatives"}}) {
        SCOPED_TRACE(inside + damping);
        write(scene(inside, "damping=\"" + damping + "\""), options);
      }
  expect_contains(write(scene(table + swing)).out, "2 systems, all with solutions");
  EXPECT_EQ(read("island_0.mtx").values.size(), 0);
  EXPECT_EQ(read("island_0_x.mtx").values.size(), 0);
  EXPECT_NEAR(static_cast<double>(read("island_1_x.mtx").values(0, 0)), 0.3 * kGravity / 0.29, 1e-13);
}

TEST_F(Export, RefusesBadInput) {
  const auto refused = [&](const std::vector<std::string>& words, const std::string& message) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2) << message;
    expect_contains(outcome.err, message);
    EXPECT_EQ(outcome.out, "");
    return lines_of(outcome.err).size();
  };
  const std::string file = model("arm_pushes_box.xml");
  EXPECT_EQ(refused({"export", file}, "--out DIR is missing"), 2u);  // bad usage: and the usage
  EXPECT_EQ(refused({"export", path("none.xml"), "--out", path("out")}, "none.xml:1: "), 1u);
  EXPECT_FALSE(fs::exists(path("out")));
  std::ofstream(path("file")) << "old";
  EXPECT_EQ(refused({"export", file, "--out", path("file")}, "file:1: cannot be created as a folder"), 1u);
  const std::string own = scene("<robot name=\"a\" urdf=\"box.urdf\" base=\"floating\"/>");
  fs::rename(own, path("README.md"));
  refused({"export", path("README.md"), "--out", path("")}, "--out would overwrite");
  EXPECT_TRUE(read_text(path("README.md")).starts_with("<scene"));
}

}  // namespace
}  // namespace manycontact::cli
