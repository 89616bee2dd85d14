// The command line itself is tested: help, version, bad usage, bad input.

#include <regex>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

class Usage : public Program {};

TEST_F(Usage, HelpNamesEveryCommandAndOption) {
  const Outcome top = run({"--help"});
  EXPECT_EQ(top.status, 0);
  for (const char* part : {"solve SCENE", "inspect SCENE", "simulate SCENE --time T --step H --out FILE",
                           "batch SCENE --states FILE.npy --out FILE.npy", "stability SCENE --out DIR",
                           "chart SCENE... --out DIR", "export SCENE --out DIR", "--truth", "--method M", "--order O",
                           "--quasi-static", "--repeat N", "--json FILE", "--picture FILE.svg", "Exit status"})
    expect_contains(top.out, part);
  for (const char* command : {"solve", "inspect", "chart", "simulate", "batch", "stability", "export", "view"}) {
    const Outcome help = run({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    expect_contains(help.out, std::string("usage: manycontact ") + command + " SCENE");
  }
}

// After `./run demo` the folder contains the program without those that it executes.
TEST_F(Usage, CommandsOfAnAbsentProgramSayHowToGetIt) {
  std::filesystem::copy_file(MANYCONTACT_BINARY, path("manycontact"));
  const std::pair<const char*, const char*> beside[] = {
      {"chart", "-chart"}, {"stability", "-chart"}, {"export", "-chart"}, {"optimize", "-optimize"}};
  for (const auto& [command, program] : beside) {
    const Outcome outcome = run({command, model("arm_pushes_box.xml"), "--out", path("out")}, path("manycontact"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "");
    ASSERT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("manycontact: ")) << outcome.err;
    expect_contains(outcome.err, path("manycontact") + program);
    expect_contains(outcome.err, "./run build");
    const Outcome help = run({command, "--help"}, path("manycontact"));
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.out, run({command, "--help"}, std::string(MANYCONTACT_BINARY) + program).out);
  }
  const Outcome solved = run({"solve", model("arm_pushes_box.xml")}, path("manycontact"));
  EXPECT_EQ(solved.status, 0) << solved.err;
}

TEST_F(Usage, VersionIsTheProjects) {
  const std::string cmake = read_text(MANYCONTACT_SOURCE_DIR "/CMakeLists.txt");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(cmake, match, std::regex("project\\(manycontact VERSION ([0-9.]+)")));
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "manycontact " + match[1].str() + "\n");
}

TEST_F(Usage, BadUsageIsOneLineAndAHint) {
  const std::string scene = model("humanoid_standing.xml");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "a command is missing"},
      {{"chart", "--out", "x"}, "SCENE is missing"},
      {{"chart", scene}, "--out DIR is missing"},
      {{"chart", scene, "--out"}, "option --out needs a value DIR"},
      {{"chart", scene, "--out", "x", "--seconds", "long"}, "option --seconds is 'long', expected a whole number"},
      {{"simulated", scene}, "unknown command 'simulated'"},
      {{"Solve", scene}, "unknown command 'Solve'"},
      {{"--verbose"}, "unknown option '--verbose'"},
      {{"--version", "now"}, "nothing is expected after --version"},
      {{"solve"}, "SCENE is missing"},
      {{"solve", scene, scene}, "one SCENE is expected"},
      {{"solve", scene, "--fast"}, "unknown option '--fast'"},
      {{"solve", scene, "--method"}, "option --method needs a value M"},
      {{"solve", scene, "--method", "magic"}, "unknown method 'magic', expected one of dense, "},
      {{"solve", scene, "--order", "random"}, "unknown order 'random', expected one of leaf-to-root, "},
      {{"solve", scene, "--method", "dense", "--order", "camd"}, "method dense has no elimination order"},
      {{"solve", scene, "--precision", "half"}, "unknown precision 'half', expected one of single, double, "},
      {{"solve", scene, "--repeat", "0"}, "option --repeat is '0', expected a whole number"},
      {{"solve", scene, "--repeat", "3x"}, "option --repeat is '3x'"},
      {{"solve", scene, "--threads", "4097"}, "option --threads is '4097', expected a whole number from 1 to 4096"},
      {{"solve", scene, "--repeat", "1", "--repeat", "2"}, "option --repeat is given twice"},
      {{"solve", scene, "--quasi-static=1"}, "option --quasi-static takes no value"},
      {{"solve", scene, "--json="}, "option --json has an empty value"},
      {{"inspect"}, "SCENE is missing"},
      {{"inspect", scene, "--json", "x"}, "unknown option '--json'"},
      {{"inspect", scene, "--picture"}, "option --picture needs a value"},
      {{"inspect", path("s.xml"), "--picture", path("s.xml")}, "--picture would overwrite"},
  };
  for (const auto& [words, message] : cases) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_EQ(outcome.out, "") << message;
    const std::vector<std::string> lines = lines_of(outcome.err);
    ASSERT_EQ(lines.size(), 2u) << outcome.err;
    EXPECT_TRUE(lines[0].starts_with("manycontact: ")) << lines[0];
    EXPECT_NE(lines[0].find(message), std::string::npos) << lines[0];
    EXPECT_TRUE(lines[1].starts_with("usage: manycontact ")) << lines[1];
  }
}

TEST_F(Usage, OptionsMayStandAnywhereAndCarryTheirValue) {
  const std::string scene = model("humanoid_standing.xml");
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"solve", "--method", "dense", scene},
                                             {"solve", "--method=dense", "--", scene},
                                             {"solve", scene, "--method=dense"}})
    expect_contains(run(words).out, "method dense");
}

void expect_bad_input(const Outcome& outcome, const std::string& start) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("manycontact: " + start)) << outcome.err;
}

TEST_F(Usage, BadInputIsOneLineWithFileAndLine) {
  const std::string out = path("out");
  const std::vector<std::vector<std::string>> commands = {{"solve"},
                                                          {"inspect"},
                                                          {"simulate", "--time=1", "--step=1", "--out=" + out},
                                                          {"stability", "--out=" + out},
                                                          {"batch", "--states=x.npy", "--out=" + out}};
  for (const std::vector<std::string>& command : commands) {
    const auto on = [&](const std::string& file) {
      std::vector<std::string> words = command;
      words.push_back(file);
      return run(words);
    };
    expect_bad_input(on("/nowhere/scene.xml"), "/nowhere/scene.xml:1: ");
    const std::string bad = scene(
        "<robot name=\"r\" urdf=\"arm.urdf\" base=\"fixed\"/>\n<contact name=\"c\" type=\"4d\" frame=\"r/tool\"/>");
    expect_bad_input(on(bad), bad + ":3: ");
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

#ifndef __SANITIZE_ADDRESS__
// If address space is scarce, OpenBLAS' own thread would request memory for ever, and the program would not end.
TEST_F(Usage, EndsWhereAddressesAreFew) {
  for (const char* kilobytes : {"100000", "150000", "400000"}) {
    const Outcome outcome =
        run({"-c", std::string("ulimit -v ") + kilobytes +
                       " && unset OPENBLAS_NUM_THREADS && exec timeout 60 '" MANYCONTACT_BINARY "' solve '" +
                       model("humanoid_standing.xml") + "'"},
            "/bin/sh");
    EXPECT_NE(outcome.status, 124) << kilobytes;  // status of timeout
  }
}
#endif

TEST_F(Usage, OutputThatCannotBeWrittenIsSaid) {
  const std::string scene = model("humanoid_standing.xml");
  expect_bad_input(run({"solve", scene, "--json", "/nowhere/out.json"}), "/nowhere/out.json:1: cannot be written");
  expect_bad_input(run({"inspect", scene, "--picture", "/nowhere/out.svg"}), "/nowhere/out.svg:1: cannot be written");
}

}  // namespace
}  // namespace manycontact::cli
