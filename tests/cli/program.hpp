#pragma once
// Runs the program as a user does, with a folder of its own for output.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/folder.hpp"

namespace manycontact::cli {

struct Outcome {
  int status = -1;  // exit status, -1 if a signal ended it
  std::string out, err;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline std::string model(const std::string& name) { return MANYCONTACT_SOURCE_DIR "/models/" + name; }

inline std::vector<std::string> model_scenes() {
  std::vector<std::string> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(model("")))
    if (entry.path().extension() == ".xml") scenes.push_back(entry.path().string());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Whether a python3 of PATH draws.
inline bool has_matplotlib() {
  static const bool has = std::system(
                              "IFS=:; for f in $PATH; do \"$f/python3\" -c 'import matplotlib' 2>/dev/null && "
                              "exit 0; done; exit 1") == 0;
  return has;
}

/// Returns the text with blanks and line breaks as one blank, so that wrapped text can be searched.
inline std::string unwrapped(const std::string& text) {
  std::istringstream words(text);
  std::string out;
  for (std::string word; words >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(unwrapped(text).find(part), std::string::npos) << "no '" << part << "' in:\n" << text;
}
inline void expect_lacks(const std::string& text, const std::string& part) {
  EXPECT_EQ(unwrapped(text).find(part), std::string::npos) << "'" << part << "' in:\n" << text;
}

class Program : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Writes a scene next to the models' URDF files; `inside` is between <scene> and </scene>.
  std::string scene(const std::string& inside, const std::string& attributes = "") const {
    for (const auto& entry : std::filesystem::directory_iterator(model("")))
      if (entry.path().extension() == ".urdf")
        std::filesystem::copy_file(entry.path(), folder_ / entry.path().filename(),
                                   std::filesystem::copy_options::overwrite_existing);
    std::ofstream(path("scene.xml")) << "<scene name=\"test\" " << attributes << ">\n" << inside << "\n</scene>\n";
    return path("scene.xml");
  }

  Outcome run(const std::vector<std::string>& words, const std::string& binary = MANYCONTACT_BINARY) const {
    const std::string out = path("stdout.txt"), err = path("stderr.txt");
    std::vector<char*> argv{const_cast<char*>(binary.c_str())};
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      if (!freopen(out.c_str(), "w", stdout) || !freopen(err.c_str(), "w", stderr)) _exit(126);
      execv(argv[0], argv.data());
      _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
  }

  /// Runs with a PATH that has only this shell script as python3, or nothing if the script is empty.
  Outcome run_with_python(const std::string& script, const std::vector<std::string>& words) const {
    std::filesystem::create_directory(path("bin"));
    if (!script.empty()) {
      std::ofstream(path("bin/python3")) << "#!/bin/sh\n" << script << "\n";
      std::filesystem::permissions(path("bin/python3"), std::filesystem::perms::owner_all);
    }
    const std::string before = std::getenv("PATH");
    setenv("PATH", path("bin").c_str(), 1);
    const Outcome outcome = run(words);
    setenv("PATH", before.c_str(), 1);
    return outcome;
  }

  /// Runs a program that gets a signal once it has begun a file.
  Outcome run_interrupted(const std::vector<std::string>& words, int signal) const {
    const pid_t sender = fork();
    if (sender == 0) {
      for (int k = 0; k < 2000; ++k) {
        usleep(10000);
        if (parts().empty()) continue;
        usleep(300000);
        std::ifstream pid(path("pid.txt"));
        int child = 0;
        if (pid >> child) kill(child, signal);
        break;
      }
      _exit(0);
    }
    std::vector<std::string> by_shell{"-c", "echo $$ > \"$0\"; exec \"$@\"", path("pid.txt"), MANYCONTACT_BINARY};
    by_shell.insert(by_shell.end(), words.begin(), words.end());
    Outcome outcome = run(by_shell, "/bin/sh");
    waitpid(sender, nullptr, 0);
    return outcome;
  }

  /// Returns files under the names that they have until they are complete.
  std::vector<std::string> parts() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      if (entry.path().extension() == ".part") found.push_back(entry.path());
    return found;
  }
  void expect_no_parts() const {
    for (const std::string& part : parts()) ADD_FAILURE() << part << " was left";
  }

  nlohmann::json solve(std::vector<std::string> words, int expected_status = 0) const {
    words.insert(words.begin(), "solve");
    words.insert(words.end(), {"--json", "-"});
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, expected_status) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }

 private:
  test::TemporaryFolder folder_;
};

}  // namespace manycontact::cli
