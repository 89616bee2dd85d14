// Output files are complete under their names, or absent; what is no regular file is written directly.

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
  /// Runs with a limit on the size of files, in blocks of 512 bytes.
  Outcome limited(const std::vector<std::string>& words, int blocks) const {
    return shell("ulimit -f " + std::to_string(blocks) + "; exec " + line_of(words));
  }
  std::string old(const std::string& name) const {
    std::ofstream(path(name)) << "old";
    return path(name);
  }
  void expect_old(const std::string& name) const {
    EXPECT_EQ(read_text(path(name)), "old") << name;
    expect_no_parts();
  }
  /// Expects status 2 and one line that begins like this; lines of progress come before it.
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

// Before the work the program tries whether files can be written: no file remains if the work is refused.
TEST_F(Output, AskingLeavesNoFile) {
  const std::string task = model("tasks/humanoid_reaches.xml");
  const Outcome outcome =
      run({"optimize", task, "--out", path("m.csv"), "--json", old("m.json"), "--charts", old("f")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_FALSE(fs::exists(path("m.csv")));
  expect_old("m.json");
}

TEST_F(Output, PicturesAreWhole) {
  if (!has_matplotlib()) GTEST_SKIP() << "there is no matplotlib here";
  fs::create_directory(path("c"));
  const Outcome outcome =
      limited({"chart", model("arm_pushes_box.xml"), "--seconds", "0", "--out", path("c")}, 100);  // chart.json fits
  expect_refused(outcome, path("c/chart.svg") + ":1: cannot be written: File too large");
  EXPECT_TRUE(fs::exists(path("c/chart.csv")));
  for (const char* name : {"c/chart.svg", "c/chart.png"}) EXPECT_FALSE(fs::exists(path(name))) << name;
  expect_no_parts();
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
  (void)shell(line_of(words) + " & k=0; while ! ls '" + path("") +
              "'/*.part >/dev/null 2>&1 && [ $k -lt 1000 ]; do sleep 0.01; k=$((k + 1)); done; kill -KILL $!; wait $!");
  EXPECT_EQ(read_text(path("o")), "old");
  EXPECT_EQ(parts().size(), 1u);
  EXPECT_EQ(run({"solve", scene_, "--json", path("o")}).status, 0);  // the next run does not mind it
  EXPECT_TRUE(solved("o").contains("acceleration"));
  EXPECT_EQ(parts().size(), 1u);
}

TEST_F(Output, DevicesAndPipesAreWrittenStraight) {
  EXPECT_EQ(run({"solve", scene_, "--json", "/dev/null"}).status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));

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

// Standard output contains nothing else.
TEST_F(Output, AFileOnStandardOutputIsAlone) {
  for (const char* out : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
    SCOPED_TRACE(out);
    const std::vector<std::string> simulate{"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out"};
    const auto simulated = [&](const std::vector<std::string>& more) {
      std::vector<std::string> words = simulate;
      words.insert(words.end(), more.begin(), more.end());
      return run(words);
    };
    const Outcome json = simulated({path("t.csv"), "--json", out});
    EXPECT_EQ(json.status, 0) << json.err;
    EXPECT_TRUE(nlohmann::json::parse(json.out, nullptr, false).contains("steps")) << json.out;
    for (const Outcome& csv : {simulated({out}), simulated({path("t.csv"), "--forces", out})}) {
      EXPECT_EQ(csv.status, 0) << csv.err;
      EXPECT_TRUE(csv.out.starts_with("t,")) << csv.out;
      EXPECT_EQ(lines_of(csv.out).size(), 12u) << csv.out;
    }
    const Outcome picture = run({"inspect", scene_, "--picture", out});
    EXPECT_TRUE(picture.out.starts_with("<?xml")) << picture.out;
    EXPECT_TRUE(picture.out.ends_with("</svg>\n")) << picture.out;
    EXPECT_EQ(simulated({path("t.csv"), "--view", out}).status, 2);
    EXPECT_EQ(simulated({out, "--json", "-"}).status, 2);
  }
}

// A file never becomes standard error.
TEST_F(Output, ClosedDescriptorsStayClosed) {
  const Outcome outcome =
      shell(line_of({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", path("t.csv"), "--progress"}) +
            " <&- 2>&-");
  EXPECT_EQ(outcome.status, 0);
  const std::vector<std::string> rows = lines_of(read_text(path("t.csv")));
  ASSERT_EQ(rows.size(), 12u);
  for (const std::string& row : rows)
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(rows[0].begin(), rows[0].end(), ',')) << row;
  EXPECT_EQ(shell("exec " + line_of({"solve", scene_}) + " >&-").status, 2);
}

// All files that are read for a scene are protected, under any name.
TEST_F(Output, FilesThatAreReadStay) {
  const std::string outer = path("outer.xml"), inner = scene("<robot name=\"r\" urdf=\"arm.urdf\" base=\"fixed\"/>");
  std::ofstream(outer) << "<scene><include file=\"scene.xml\"/></scene>";
  fs::create_symlink("arm.urdf", path("link"));
  const std::string arm = read_text(path("arm.urdf")), scene = read_text(inner);
  for (const std::string& out : {path("arm.urdf"), inner, outer, path("./arm.urdf"), path("link")}) {
    SCOPED_TRACE(out);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"solve", outer, "--json", out},
             {"inspect", outer, "--picture", out},
             {"view", outer, "--out", out},
             {"simulate", outer, "--time", "0.01", "--step", "0.001", "--out", out},
             {"simulate", outer, "--time", "0.01", "--step", "0.001", "--out", path("t"), "--json", out},
             {"batch", outer, "--states", path("x.npy"), "--out", out}}) {
      const Outcome outcome = run(words);
      EXPECT_EQ(outcome.status, 2) << words[0];
      expect_contains(outcome.err, "would overwrite");
    }
  }
  EXPECT_EQ(read_text(path("arm.urdf")), arm);
  EXPECT_EQ(read_text(inner), scene);
  EXPECT_FALSE(fs::exists(path("t")));

  fs::rename(inner, path("README.md"));
  const Outcome charted = run({"chart", path("README.md"), path("README.md"), "--seconds", "0", "--out", path("")});
  EXPECT_EQ(charted.status, 2);
  expect_contains(charted.err, "--out would overwrite");
  EXPECT_EQ(read_text(path("README.md")), scene);
}

TEST_F(Output, TasksToo) {
  const std::string scene = model("tasks/humanoid_scene.xml"), before = read_text(scene);
  const auto optimize = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"optimize", model("tasks/humanoid_reaches.xml"), "--out"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  expect_contains(optimize({path("m"), "--json", scene}).err, "--json would overwrite");
  expect_contains(optimize({path("c/forces.svg"), "--charts", path("c")}).err, "--charts would overwrite");
  EXPECT_EQ(read_text(scene), before);
  EXPECT_FALSE(fs::exists(path("c")));
}

TEST_F(Output, OneFileByTwoNames) {
  old("there");
  fs::create_symlink("there", path("link"));
  for (const std::string& other : {path("./z"), path("no/../z")}) {
    const Outcome outcome =
        run({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", path("z"), "--json", other});
    EXPECT_EQ(outcome.status, 2) << other;
    expect_contains(outcome.err, "--out and --json are the same file");
  }
  const Outcome relative =
      shell("cd '" + path("") + "' && " +
            line_of({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", "z", "--json", "./z"}));
  expect_contains(relative.err, "--out and --json are the same file");
  EXPECT_FALSE(fs::exists(path("z")));
  const Outcome linked =
      run({"simulate", scene_, "--time", "0.01", "--step", "0.001", "--out", path("there"), "--json", path("link")});
  expect_contains(linked.err, "--out and --json are the same file");
  expect_old("there");
}

// Two names of one file on the disk are two files once one of them is renamed: neither is overwritten.
TEST_F(Output, HardLinksPart) {
  fs::create_hard_link(old("other"), path("o"));
  EXPECT_EQ(run({"solve", scene_, "--json", path("o")}).status, 0);
  EXPECT_TRUE(solved("o").contains("acceleration"));
  expect_old("other");
}

TEST_F(Output, LongNames) {
  const std::string name(255, 'n');  // as long as names may be: an ending does not fit
  EXPECT_EQ(run({"solve", scene_, "--json", path(name)}).status, 0);
  EXPECT_TRUE(solved(name).contains("acceleration"));
  expect_refused(run({"solve", scene_, "--json", path(name + "n")}),
                 path(name + "n") + ":1: cannot be written: File name too long");
  expect_no_parts();
}

// The last run to end has the name; neither writes into the other's file.
TEST_F(Output, TwoRunsAtATime) {
  const std::string line = line_of({"simulate", scene_, "--time", "0.2", "--step", "0.001", "--out", path("o")});
  EXPECT_EQ(shell(line + " & " + line + "; s=$?; wait $! && exit $s").status, 0);
  EXPECT_EQ(lines_of(read_text(path("o"))).size(), 202u);
  expect_no_parts();
}

TEST_F(Output, SimulateAsksBeforeItsWork) {
  expect_refused(run({"simulate", scene_, "--time", "1000000", "--step", "0.001", "--out", path("t.csv"), "--json",
                      path("nowhere/o.json")}),
                 path("nowhere/o.json") + ":1: cannot be written: No such file");
  expect_no_parts();
}

TEST_F(Output, LinksAndModesStay) {
  old("real.json");
  fs::create_directory(path("d"));
  fs::create_symlink("../real.json", path("d/link.json"));
  EXPECT_EQ(run({"solve", scene_, "--json", path("d/link.json")}).status, 0);
  EXPECT_TRUE(fs::is_symlink(path("d/link.json")));
  EXPECT_TRUE(solved("real.json").contains("acceleration"));

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
