// Files that the program writes: whole under their names, or not there; what is no regular file is written straight.

#include <sys/stat.h>
#include <unistd.h>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

namespace fs = std::filesystem;

class Output : public Program {
 protected:
  const std::string scene_ = model("humanoid_standing.xml");

  static std::string line_of(const std::vector<std::string>& words) {
    std::string line = "'" MANYCONTACT_BINARY "'";
    for (const std::string& word : words) line += " '" + word + "'";
    return line;
  }
  Outcome shell(const std::string& line) const { return run({"-c", line}, "/bin/sh"); }
  /// No file may grow beyond so many blocks of 512 bytes.
  Outcome limited(const std::vector<std::string>& words, int blocks) const {
    return shell("ulimit -f " + std::to_string(blocks) + "; exec " + line_of(words));
  }
  std::string old(const std::string& name) const {
    std::ofstream(path(name)) << "old";
    return path(name);
  }
  void expect_old(const std::string& name) const {
    EXPECT_EQ(read_text(path(name)), "old") << name;
    EXPECT_FALSE(fs::exists(path(name + ".part"))) << name;
  }
  /// Status 2, and one line that begins so; lines of progress come before it.
  static void expect_refused(const Outcome& outcome, const std::string& start) {
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    const std::vector<std::string> lines = lines_of(outcome.err);
    ASSERT_FALSE(lines.empty());
    EXPECT_TRUE(lines.back().starts_with("manycontact: " + start)) << outcome.err;
    EXPECT_EQ(outcome.err.find("cannot be written"), outcome.err.rfind("cannot be written")) << outcome.err;
  }
  nlohmann::json solved(const std::string& name) const {
    return nlohmann::json::parse(read_text(path(name)), nullptr, false);
  }
};

TEST_F(Output, ALimitOfSizesLeavesTheOldFile) {
  const std::vector<std::vector<std::string>> commands = {
      {"solve", scene_, "--derivatives", "--json", old("o")},
      {"inspect", scene_, "--picture", old("o")},
      {"simulate", scene_, "--time", "0.1", "--step", "0.001", "--out", old("o")},
      {"simulate", scene_, "--time", "0.1", "--step", "0.001", "--every", "100", "--out", old("o")},
      {"simulate", scene_, "--time", "0.1", "--step", "0.001", "--out", "/dev/null", "--forces", old("o")},
  };
  for (const std::vector<std::string>& words : commands) {
    SCOPED_TRACE(line_of(words));
    const Outcome outcome = limited(words, 4);
    expect_refused(outcome, path("o") + ":1: cannot be written: File too large");
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    expect_old("o");
  }
  if (const std::vector<std::string> view{"view", scene_, "--out", old("o")}; run(view).status == 0) {
    old("o");
    expect_refused(limited(view, 4), path("o") + ":1: cannot be written: File too large");
    expect_old("o");
  }
}

TEST_F(Output, OptimizeToo) {
  const std::string task = model("tasks/humanoid_reaches.xml");
  expect_refused(limited({"optimize", task, "--out", old("m.csv"), "--json", old("m.json")}, 20),
                 path("m.csv") + ":1: cannot be written: File too large");
  expect_old("m.csv");
  expect_old("m.json");
}

// Before the work it is tried whether files can be written: nothing is left where the work is refused.
TEST_F(Output, AskingLeavesNoFile) {
  const std::string task = model("tasks/humanoid_reaches.xml");
  const Outcome outcome =
      run({"optimize", task, "--out", path("m.csv"), "--json", old("m.json"), "--charts", old("f")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_FALSE(fs::exists(path("m.csv")));
  EXPECT_FALSE(fs::exists(path("m.csv.part")));
  expect_old("m.json");
}

// Gnuplot does not tell of it.
TEST_F(Output, PicturesAreWhole) {
  if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no gnuplot here";
  fs::create_directory(path("c"));
  const Outcome outcome =
      limited({"chart", model("arm_pushes_box.xml"), "--seconds", "0", "--out", path("c")}, 40);  // chart.csv fits
  expect_refused(outcome, path("c/chart.svg") + ":1: cannot be written whole");
  EXPECT_TRUE(fs::exists(path("c/chart.csv")));
  for (const char* name : {"chart.svg", "chart.png", "chart.svg.part", "chart.png.part"})
    EXPECT_FALSE(fs::exists(path(std::string("c/") + name))) << name;
}

TEST_F(Output, AFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const std::string full = "/dev/full:1: cannot be written: No space left on device";
  expect_refused(run({"solve", scene_, "--json", "/dev/full"}), full);
  expect_refused(run({"inspect", scene_, "--picture", "/dev/full"}), full);
  expect_refused(run({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", "/dev/full"}), full);
  expect_refused(shell("exec " + line_of({"solve", scene_, "--json", "-"}) + " > /dev/full"),
                 "-:1: cannot be written: No space left on device");
  expect_refused(shell("exec " + line_of({"solve", scene_}) + " > /dev/full"), "cannot write to standard output");
}

TEST_F(Output, AKilledRunLeavesTheOldFile) {
  const std::vector<std::string> words{"simulate", scene_, "--time", "1000", "--step", "0.001", "--out", old("o")};
  (void)shell(line_of(words) + " & k=0; while [ ! -e '" + path("o.part") +
              "' ] && [ $k -lt 1000 ]; do sleep 0.01; k=$((k + 1)); done; kill -KILL $!; wait $!");
  EXPECT_EQ(read_text(path("o")), "old");
  EXPECT_TRUE(fs::exists(path("o.part")));
  EXPECT_EQ(run({"solve", scene_, "--json", path("o")}).status, 0);  // which the next run does not mind
  EXPECT_TRUE(solved("o").contains("acceleration"));
  EXPECT_FALSE(fs::exists(path("o.part")));
}

TEST_F(Output, DevicesAndPipesAreWrittenStraight) {
  EXPECT_EQ(run({"solve", scene_, "--json", "/dev/null"}).status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(fs::exists("/dev/null.part"));

  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const Outcome piped = shell("cat '" + path("pipe") + "' > '" + path("got") + "' & " +
                              line_of({"solve", scene_, "--json", path("pipe")}) + "; s=$?; wait; exit $s");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_TRUE(solved("got").contains("acceleration"));
  EXPECT_TRUE(fs::is_fifo(path("pipe")));

  const Outcome named = run({"solve", scene_, "--json", "/dev/stdout"});
  EXPECT_EQ(named.status, 0) << named.err;
  EXPECT_TRUE(nlohmann::json::parse(named.out, nullptr, false).contains("acceleration"));
}

// The summary, and then the file on standard output.
TEST_F(Output, StandardOutputKeepsItsOrder) {
  const Outcome outcome =
      run({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", path("t.csv"), "--json", "-"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(outcome.out.starts_with("humanoid_standing: 10 steps")) << outcome.out;
  EXPECT_TRUE(outcome.out.ends_with("\n}\n")) << outcome.out;
  const Outcome picture = run({"inspect", scene_, "--picture", "-"});
  EXPECT_TRUE(picture.out.starts_with("<?xml")) << picture.out;
  EXPECT_TRUE(picture.out.ends_with("</svg>\n")) << picture.out;
}

TEST_F(Output, LinksAndModesStay) {
  old("real.json");
  fs::create_directory(path("d"));
  fs::create_symlink("../real.json", path("d/link.json"));
  fs::create_symlink("later.json", path("d/dangling.json"));
  for (const char* name : {"d/link.json", "d/dangling.json"}) {
    EXPECT_EQ(run({"solve", scene_, "--json", path(name)}).status, 0);
    EXPECT_TRUE(fs::is_symlink(path(name))) << name;
  }
  EXPECT_TRUE(solved("real.json").contains("acceleration"));
  EXPECT_TRUE(solved("d/later.json").contains("acceleration"));

  fs::permissions(path("real.json"), fs::perms(0600));
  EXPECT_EQ(run({"solve", scene_, "--json", path("real.json")}).status, 0);
  EXPECT_EQ(fs::status(path("real.json")).permissions(), fs::perms(0600));
}

TEST_F(Output, ReadOnlyFilesAndFoldersAreRefused) {
  expect_refused(run({"solve", scene_, "--json", path("")}), path("") + ":1: cannot be written: Is a directory");
  if (geteuid() == 0) GTEST_SKIP() << "nothing is read-only for root";
  fs::permissions(old("o"), fs::perms(0444));
  expect_refused(run({"solve", scene_, "--json", path("o")}), path("o") + ":1: cannot be written: Permission denied");
  expect_old("o");
}

}  // namespace
}  // namespace manycontact::cli
