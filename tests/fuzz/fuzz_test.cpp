// The corpus and random bytes run through the fuzzed functions in this build.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz/targets.hpp"

namespace manycontact::fuzz {
namespace {

namespace fs = std::filesystem;
using Target = void (*)(const std::uint8_t*, std::size_t);
using File = std::vector<std::uint8_t>;

std::vector<std::pair<std::string, File>> corpus(const std::string& name) {
  std::vector<std::pair<std::string, File>> files;
  for (const auto& entry : fs::directory_iterator(fs::path(MANYCONTACT_SOURCE_DIR) / "tests/fuzz/corpus" / name)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    files.emplace_back(entry.path().filename().string(), File(text.begin(), text.end()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Numbers of changes of each file.
constexpr int kReads = 300, kSolves = 20;  // ./run fuzz tries many more

// Runs each file as it is, and with a few bytes changed, removed or doubled.
void replay(const std::string& name, Target target, int changed) {
  const auto files = corpus(name);
  EXPECT_GE(files.size(), 3u);
  std::mt19937 random(7);
  for (const auto& [file, bytes] : files) {
    SCOPED_TRACE(file);
    EXPECT_NO_THROW(target(bytes.data(), bytes.size()));
    for (int k = 0; k < changed && !bytes.empty(); ++k) {
      SCOPED_TRACE("change " + std::to_string(k));
      File other = bytes;
      for (unsigned n = 1 + random() % 4; n > 0 && !other.empty(); --n) {
        const auto at = other.begin() + static_cast<std::ptrdiff_t>(random() % other.size());
        const unsigned what = random() % 3;
        if (what == 0) *at = static_cast<std::uint8_t>(random());
        if (what == 1) other.erase(at);
        if (what == 2) other.insert(at, *at);
      }
      EXPECT_NO_THROW(target(other.data(), other.size()));
    }
  }
}

TEST(Fuzz, Urdf) { replay("urdf", fuzz_urdf, kReads); }
TEST(Fuzz, Scene) { replay("scene", fuzz_scene, kReads); }
TEST(Fuzz, Task) { replay("task", fuzz_task, kReads); }
TEST(Fuzz, Solve) { replay("solve", fuzz_solve, kSolves); }

}  // namespace
}  // namespace manycontact::fuzz
