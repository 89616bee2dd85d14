// manycontact batch reads many states from a .npy file and writes another, for any number of threads and processes.

#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include "cli/program.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/scenes.hpp"

namespace manycontact::cli {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Returns a file as NumPy writes it, padded to 64 bytes.
std::string npy(const std::string& dictionary, int version = 1) {
  const std::size_t before = version == 1 ? 10 : 12;
  std::string text = dictionary;
  while ((before + text.size() + 1) % 64) text += ' ';
  text += '\n';
  std::string out = "\x93NUMPY" + std::string{static_cast<char>(version), '\0'};
  for (std::size_t k = 0; k < before - 8; ++k) out += static_cast<char>(text.size() >> (8 * k) & 0xff);
  return out + text;
}
std::string dictionary(const std::vector<std::int64_t>& shape) {
  std::string text = "{'descr': '<f8', 'fortran_order': False, 'shape': (";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k ? ", " : "") + std::to_string(shape[k]);
  return text + "), }";
}
std::string bytes(const Matrix& X) {
  return {reinterpret_cast<const char*>(X.data()), sizeof(double) * static_cast<std::size_t>(X.size())};
}

bool have_mpi() {
  return std::filesystem::exists(MANYCONTACT_BINARY "-mpi") && std::system("mpirun --version > /dev/null 2>&1") == 0;
}

class Batch : public Program {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  /// Writes states.npy of the scene, away from rest; states `failing` are not finite.
  Matrix states(const std::string& scene, int count, const std::vector<int>& failing = {}) const {
    const SceneFile start = load_scene(scene);
    Matrix X(count, start.scene.nq + start.scene.nv + start.scene.nu);
    std::mt19937 rng(4);
    for (int k = 0; k < count; ++k) {
      SceneFile file = start;
      test::disturb(file, rng, 0.05);
      X.row(k) << file.q.transpose(), file.v.transpose(), file.u.transpose();
    }
    for (int k : failing) X(k, 0) = std::numeric_limits<double>::quiet_NaN();
    write("states.npy", npy(dictionary({X.rows(), X.cols()})) + bytes(X));
    return X;
  }
  std::vector<std::string> words(const std::string& scene, const std::string& out,
                                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"batch", scene, "--states", path("states.npy"), "--out", path(out)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Runs under mpirun with two processes; each first runs `shell`.
  Outcome run_two(const std::vector<std::string>& all, const std::string& shell = "") const {
    std::string line = shell;
    line += "exec '" MANYCONTACT_BINARY "'";
    for (const std::string& word : all) line += " '" + word + "'";
    return run({"mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", "sh", "-c", line}, "/usr/bin/env");
  }
  std::string file(const std::string& name) const { return read_text(path(name)); }
  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }
  void expect_nothing_left(const std::string& out) const {
    for (const std::string& name : {out + ".npy", out + ".derivatives.npy"}) EXPECT_FALSE(exists(name)) << name;
    expect_no_parts();
  }
};

TEST_F(Batch, RowsAreWhatSolveGives) {
  for (const char* name : {"humanoid_standing.xml", "feet_on_corners.xml", "two_humanoids_carry_beam.xml"}) {
    const std::string scene = model(name);
    const Matrix X = states(scene, 9, {4});
    const Outcome outcome = run(words(scene, "o.npy", {"--derivatives"}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "");
    expect_contains(outcome.out, "9 states: ");
    expect_contains(outcome.out, "1 failed");

    const SceneFile file_of = load_scene(scene);
    const Scene& s = file_of.scene;
    SceneData one(s);
    const Eigen::Index nf = one.f.size(), cols = 2 * s.nv + s.nu;
    Matrix A(9, s.nv + nf + 1), D(9 * (s.nv + nf), cols);
    for (int k = 0; k < 9; ++k) {
      SceneData data(s);
      const Status status =
          manycontact::solve(s, X.row(k).head(s.nq).transpose(), X.row(k).segment(s.nq, s.nv).transpose(),
                             X.row(k).tail(s.nu).transpose(), data)
              .status;
      A.row(k) << data.a.transpose(), data.f.transpose(), static_cast<double>(status);
      differentiate(s, data);
      const SceneDerivatives d = dense_derivatives(s, data);
      D.middleRows(k * (s.nv + nf), s.nv) << d.da_dq, d.da_dv, d.da_du;
      D.middleRows(k * (s.nv + nf) + s.nv, nf) << d.dforces_dq, d.dforces_dv, d.dforces_du;
    }
    EXPECT_EQ(A(4, s.nv + nf), 4);
    EXPECT_EQ(file("o.npy"), npy(dictionary({9, s.nv + nf + 1})) + bytes(A));
    EXPECT_EQ(file("o.derivatives.npy"), npy(dictionary({9, s.nv + nf, cols})) + bytes(D));
    expect_no_parts();
  }
}

TEST_F(Batch, TheSameBytesForAnyNumberOfThreadsAndAnyBlocks) {
  const std::string scene = model("feet_on_corners.xml");
  states(scene, 5000, {17, 4444});  // more than one block
  for (const char* threads : {"1", "2", "3"})
    EXPECT_EQ(run(words(scene, std::string("o") + threads + ".npy", {"--threads", threads})).status, 1);
  EXPECT_GT(file("o1.npy").size(), 5000u * 8);
  EXPECT_EQ(file("o1.npy"), file("o2.npy"));
  EXPECT_EQ(file("o1.npy"), file("o3.npy"));
}

TEST_F(Batch, ExitStatusIsTheWorstStates) {
  const std::string scene = model("humanoid_standing.xml");
  states(scene, 3);
  EXPECT_EQ(run(words(scene, "o.npy")).status, 0);
  states(scene, 0);
  const Outcome none = run(words(scene, "o.npy", {"--derivatives"}));
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_EQ(file("o.npy").size(), 128u);
  states(model("feet_on_corners.xml"), 3);
  EXPECT_EQ(run(words(model("feet_on_corners.xml"), "o.npy")).status, 0);  // redundant
}

TEST_F(Batch, VersionsAndHeadersOfOthersAreRead) {
  const std::string scene = model("humanoid_standing.xml");
  const Matrix X = states(scene, 2);
  ASSERT_EQ(run(words(scene, "o.npy")).status, 0);
  const std::string expected = file("o.npy"), cols = std::to_string(X.cols());
  write("states.npy", npy(dictionary({2, X.cols()}), 2) + bytes(X));
  EXPECT_EQ(run(words(scene, "o.npy")).status, 0);
  EXPECT_EQ(file("o.npy"), expected);
  write("states.npy", npy("{\"shape\":(2 ,\t" + cols + ",),\"fortran_order\" : False , \"descr\":\"<f8\"}") + bytes(X));
  EXPECT_EQ(run(words(scene, "o.npy")).status, 0);
  EXPECT_EQ(file("o.npy"), expected);
}

TEST_F(Batch, BadFilesAreOneLine) {
  const std::string scene = model("humanoid_standing.xml");
  const Matrix X = states(scene, 2);
  const std::int64_t cols = X.cols();
  const std::string c = std::to_string(cols), numbers = bytes(X), good = npy(dictionary({2, cols}));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = dictionary({2, cols});
    return npy(text.replace(text.find(from), from.size(), to)) + numbers;
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is no .npy file"},
      {"q,v,u\n1,2,3\n4,5,6\n", "is no .npy file"},
      {npy(dictionary({2, cols}), 3) + numbers, "is a .npy file of version 3.0"},
      {good.substr(0, 9), "is no .npy file"},
      {good.substr(0, 40), "ends within its header"},
      {with("<f8", "<f4"), "has numbers of type '<f4'"},
      {with("<f8", ">f8"), "has numbers of type '>f8'"},
      {with("'<f8'", "[('x', '<f8')]"), "has a header that NumPy does not write"},
      {with("False", "True"), "has its numbers in Fortran order"},
      {with("False", "Maybe"), "has a header that NumPy does not write"},
      {with("'shape'", "'descr'"), "has a header that NumPy does not write"},
      {with(", 'shape'", ", 'more': 1, 'shape'"), "has a header that NumPy does not write"},
      {with("(2, ", "(-2, "), "has a header that NumPy does not write"},
      {with("(2, ", "(99999999999999999999, "), "has a header that NumPy does not write"},
      {with("(2, ", "(4611686018427387904, "), "more than any file has"},
      {with("(2, " + c + ")", "(" + std::to_string(2 * cols) + ",)"),
       "has an array of 1 dimensions, not of two or three"},
      {good + numbers.substr(8), "bytes of numbers where its shape requires"},
      {good + numbers + "x", "bytes of numbers where its shape requires"},
      {npy(dictionary({cols, 2})) + numbers, "has shape (" + c + ", 2), expected (states, " + c + "): q "},
      {npy(dictionary({1, 2, cols})) + numbers, "has shape (1, 2, " + c + "), expected (states, " + c + ")"},
  };
  for (const auto& [text, message] : cases) {
    write("states.npy", text);
    const Outcome outcome = run(words(scene, "o.npy", {"--derivatives"}));
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_EQ(outcome.out, "") << message;
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("manycontact: " + path("states.npy") + ":1: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("expected"), std::string::npos) << outcome.err;
    expect_nothing_left("o");
  }
}

TEST_F(Batch, FilesThatCannotBeReadOrWritten) {
  const std::string scene = model("humanoid_standing.xml");
  states(scene, 2);
  const auto expect_refused = [&](const std::string& in, const std::string& out, const std::string& start) {
    const Outcome outcome = run({"batch", scene, "--states", in, "--out", out});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("manycontact: " + start)) << outcome.err;
  };
  const std::string in = path("states.npy");
  expect_refused("/nowhere/s.npy", path("o.npy"), "/nowhere/s.npy:1: cannot be read");
  expect_refused(path(""), path("o.npy"), path("") + ":1: is not a regular file");
  expect_refused(in, "/nowhere/o.npy", "/nowhere/o.npy:1: cannot be written");
  expect_refused(in, "/dev/null", "/dev/null:1: is not a regular file");
  expect_refused(in, "-", "-:1: is not a regular file");
  expect_refused(in, path(""), path("") + ":1: is not a regular file");
  const std::string long_name = path(std::string(300, 'o'));
  expect_refused(in, long_name, long_name + ":1: cannot be written");
  expect_nothing_left("o");
}

// A file would grow too large: the old file stays, and no partial file remains.
TEST_F(Batch, AFailedRunLeavesTheOldFile) {
  const std::string scene = model("humanoid_standing.xml");
  states(scene, 300);
  write("o.npy", "old");
  std::string line = "ulimit -f 20; exec '" MANYCONTACT_BINARY "'";
  for (const std::string& word : words(scene, "o.npy")) line += " '" + word + "'";
  const Outcome outcome = run({"-c", line}, "/bin/sh");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  expect_contains(outcome.err, "o.npy:1: cannot be written: File too large");
  EXPECT_EQ(file("o.npy"), "old");
  expect_no_parts();
}

TEST_F(Batch, BadUsage) {
  const std::string scene = model("humanoid_standing.xml");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"batch"}, "SCENE is missing"},
      {{"batch", scene, "--out", path("o.npy")}, "option --states is missing"},
      {{"batch", scene, "--states", "x"}, "option --out is missing"},
      {words(scene, "o.npy", {"--threads", "0"}), "option --threads is '0'"},
      {words(scene, "o.npy", {"--threads", "two"}), "option --threads is 'two'"},
      {words(scene, "o.npy", {"--threads", "4097"}), "expected a whole number from 1 to 4096"},
      {{"batch", scene, "--states", path("o.npy"), "--out", path("o.npy")}, "--out would overwrite"},
      {{"batch", scene, "--states", path("o.derivatives.npy"), "--out", path("o.npy"), "--derivatives"},
       "--derivatives would overwrite"},
      {words(scene, "o.npy", {"--method", "magic"}), "unknown method 'magic'"},
      {words(scene, "o.npy", {"--method", "dense-schur", "--islands"}), "solves the scene as one system"},
  };
  for (const auto& [command, message] : cases) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 2) << message;
    const std::vector<std::string> lines = lines_of(outcome.err);
    ASSERT_EQ(lines.size(), 2u) << outcome.err;
    EXPECT_NE(lines[0].find(message), std::string::npos) << lines[0];
    expect_nothing_left("o");
  }
}

TEST_F(Batch, UnderMpirunAnotherProgramIsNeeded) {
  std::filesystem::copy_file(MANYCONTACT_BINARY, path("manycontact"));
  const std::string scene = model("humanoid_standing.xml");
  states(scene, 2);
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    setenv(variable, "2", 1);
    const Outcome outcome = run(words(scene, "o.npy"), path("manycontact"));
    unsetenv(variable);
    EXPECT_EQ(outcome.status, 1);
    ASSERT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    expect_contains(outcome.err, path("manycontact-mpi"));
    expect_contains(outcome.err, "./run build --mpi");
    expect_nothing_left("o");
  }
}

// A herd has islands to split; the beam is a single one.
TEST_F(Batch, TheSameBytesFromTwoProcesses) {
  if (!have_mpi()) GTEST_SKIP() << "no mpirun, or no manycontact-mpi beside the program";
  const std::string herd = scene(
      "<robot name=\"herd\" urdf=\"quadruped.urdf\" base=\"floating\" xyz=\"0 0 0.4\" copies=\"5\" spacing=\"1\"/>"
      "<robot name=\"arm\" urdf=\"arm.urdf\" base=\"fixed\"/><robot name=\"box\" urdf=\"box.urdf\" base=\"floating\"/>"
      "<contact name=\"LF\" type=\"3d\" frame=\"herd/LF_foot\"/><contact name=\"RH\" type=\"3d\" "
      "frame=\"herd/RH_foot\"/>"
      "<contact name=\"hold\" type=\"6d\" frame=\"herd0/RF_foot\" to=\"herd3/LH_foot\"/>"
      "<contact name=\"off\" type=\"3d\" frame=\"herd1/RF_foot\" to=\"herd4/LH_foot\" active=\"false\"/>"
      "<contact name=\"push\" type=\"3d\" frame=\"arm/tool\" to=\"box/face_back\"/>"
      "<contact name=\"lean\" type=\"3d\" frame=\"arm/base\" to=\"herd1/RF_foot\"/>",
      "gravity=\"0 1 -9\"");
  for (const std::string& of : {herd, model("two_humanoids_carry_beam.xml")}) {
    states(of, 37, {3, 30});
    EXPECT_EQ(run(words(of, "one.npy", {"--derivatives"})).status, 1);
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{"--derivatives"}, {"--derivatives", "--islands", "--threads", "2"}}) {
      const Outcome two = run_two(words(of, "two.npy", more));
      EXPECT_EQ(two.status, 1);
      EXPECT_EQ(lines_of(two.out).size(), 1u) << two.out;
      expect_contains(two.out, "37 states: ");
      EXPECT_EQ(file("two.npy"), file("one.npy"));
      EXPECT_EQ(file("two.derivatives.npy"), file("one.derivatives.npy"));
      expect_no_parts();
      std::filesystem::remove(path("two.npy"));
    }
  }
}

// One of two processes is killed while it writes, or meets an error: the run ends, and there is no file.
TEST_F(Batch, AProcessThatDiesEndsTheRun) {
  if (!have_mpi()) GTEST_SKIP() << "no mpirun, or no manycontact-mpi beside the program";
  const std::string of = model("humanoid_standing.xml");
  states(of, 20000);
  const std::string second = "if [ \"$OMPI_COMM_WORLD_RANK$PMI_RANK\" = 1 ]; then ",
                    kill = "(while kill -0 $$ && ! ls '" + path("") +
                           "'/*.part >/dev/null 2>&1; do :; done; kill -KILL $$) 2>&- & ";
  const Outcome killed = run_two(words(of, "o.npy"), second + kill + "fi; ");
  EXPECT_NE(killed.status, 0);
  EXPECT_NE(killed.err, "");
  EXPECT_FALSE(exists("o.npy"));
  for (const std::string& part : parts()) std::filesystem::remove(part);

  states(of, 300);
  const Outcome failed = run_two(words(of, "o.npy"), second + "ulimit -f 20; fi; ");
  EXPECT_NE(failed.status, 0);
  expect_contains(failed.err, "o.npy:1: cannot be written: File too large");
  expect_nothing_left("o");
}

TEST_F(Batch, BadInputOfSeveralProcessesIsSaidOnce) {
  if (!have_mpi()) GTEST_SKIP() << "no mpirun, or no manycontact-mpi beside the program";
  write("states.npy", "nothing");
  const Outcome outcome = run_two(words(model("humanoid_standing.xml"), "o.npy"));
  EXPECT_EQ(outcome.status, 2);
  const std::size_t first = outcome.err.find("is no .npy file");
  EXPECT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("is no .npy file", first + 1), std::string::npos) << outcome.err;
  expect_nothing_left("o");
}

}  // namespace
}  // namespace manycontact::cli
