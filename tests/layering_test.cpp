// A folder includes only its own layer and strictly lower ones; some headers are private to one layer.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, int> level = {
    {"abi", -1},     {"version", -1},     {"simd", -1},    {"sparse", 0},     {"lq", 1},      {"spatial", 1},
    {"model", 2},    {"algorithm", 3},    {"contact", 4},  {"io", 5},         {"rank", 5},    {"kkt", 6},
    {"dynamics", 7}, {"analysis", 8},     {"action", 8},   {"simulation", 8}, {"control", 9}, {"crocoddyl", 10},
    {"task", 10},    {"manycontact", 11}, {"program", 12}, {"python", 12},
};

struct Guarded {
  std::string what;
  std::regex header;
  std::regex allowed;  // the files that may include it
};

const std::vector<Guarded> guarded = {
    {"SuiteSparse belongs to the sources of sparse",
     std::regex("suitesparse/.*|(ldl|c?camd|c?colamd|amd|btf|cs|klu|umfpack|spqr|cholmod\\w*)\\.h"
                "|SuiteSparse\\w*\\.h(pp)?|Eigen/(Cholmod|UmfPack|SPQR|KLU)Support"),
     std::regex("sparse/src/.*")},
    {"urdfdom and tinyxml2 belong to the sources of io",
     std::regex("(urdf\\w*|console_bridge|tinyxml2?)/.*|tinyxml2?\\.h"), std::regex("src/tools/io/.*")},
    {"JSON belongs to the programs", std::regex("nlohmann/.*"), std::regex("src/(optimal_control/)?program/.*")},
    {"OpenMP belongs to one file, which sees no Eigen", std::regex("omp\\.h"),
     std::regex("src/core/dynamics/workspace/parallel\\.cpp")},
    {"MPI belongs to the program manycontact-mpi", std::regex("mpi\\.h"), std::regex("src/program/mpi_main\\.cpp")},
    {"assimp belongs to the program manycontact-mesh", std::regex("assimp/.*"),
     std::regex("src/program/mesh_main\\.cpp")},
    {"boost belongs to spatial/scalar.hpp and quad.hpp", std::regex("boost/.*"),
     std::regex("include/manycontact/spatial/scalar\\.hpp|(.*/)?quad\\.hpp")},
};

// The folder of src that a module is in, as a level: tools, optimal_control, programs; all others are in core.
const std::map<std::string, int> folder_level = {
    {"io", 1},        {"analysis", 1}, {"simulation", 1}, {"lq", 2},          {"action", 2}, {"control", 2},
    {"crocoddyl", 2}, {"task", 2},     {"program", 3},    {"manycontact", 3}, {"python", 3},
};

// Returns the layer of a file from its path in the repository: "kkt" for src/core/kkt/assemble.cpp. The umbrella
// include/manycontact/action.hpp is part of "action"; include/manycontact/manycontact.hpp is above all but the program.
std::optional<std::string> floor_of(const std::string& file) {
  static const std::regex place(
      "(?:(?:include|src/(?:core|tools|optimal_control)/private|sparse/private)/manycontact|"
      "src/(?:core|tools|optimal_control)|src)/(?:detail/)?(\\w+)(?:/.*|\\.hpp)|(sparse)/src/.*");
  std::smatch match;
  if (!std::regex_match(file, match, place)) return std::nullopt;
  const std::string name = match[1].matched ? match[1] : match[2];
  if (!level.contains(name)) return std::nullopt;
  return name;
}

int folder_of(const std::string& module) {
  const auto found = folder_level.find(module);
  return found == folder_level.end() ? 0 : found->second;
}

// Returns our file that `header` means when `file` includes it, from the top of the repository.
std::optional<std::string> own_target(const std::string& file, const std::string& header, bool quoted) {
  const fs::path top = MANYCONTACT_SOURCE_DIR;
  for (const char* folder :
       {"src/core/private", "src/tools/private", "src/optimal_control/private", "sparse/private", "src", "src/core"})
    if (quoted && fs::exists(top / folder / header)) return std::string(folder) + "/" + header;
  if (header.starts_with("manycontact/")) return "include/" + header;
  if (!quoted) return std::nullopt;
  return (fs::path(file).parent_path() / header).lexically_normal().generic_string();
}

// Returns what is wrong with `file` including `header`; empty if nothing is.
std::string complaint(const std::string& file, const std::string& header, bool quoted) {
  for (const Guarded& guard : guarded)
    if (std::regex_match(header, guard.header))
      return std::regex_match(file, guard.allowed) ? "" : "includes " + header + ": " + guard.what;

  const auto target = own_target(file, header, quoted);
  if (!target) return "";
  const auto from = floor_of(file);
  const auto to = floor_of(*target);
  if (!to) return "includes " + header + ", which stands on no floor";
  const bool up = folder_of(*to) > folder_of(*from) || level.at(*to) > level.at(*from);
  if (*from == *to || (!up && level.at(*to) < level.at(*from))) return "";
  const std::string direction = up ? "up" : "sideways";
  return "includes " + header + ": from " + *from + " " + direction + " to " + *to;
}

// Returns every complaint about one file, as "file:line: what".
std::vector<std::string> check_file(const std::string& file, std::istream& text) {
  if (!floor_of(file)) return {file + ":1: stands on no floor"};
  static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)");
  std::vector<std::string> complaints;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::smatch match;
    if (!std::regex_match(line, match, include)) continue;
    const std::string what = complaint(file, match[2], match[1] == "\"");
    if (!what.empty()) complaints.push_back(file + ":" + std::to_string(number) + ": " + what);
  }
  return complaints;
}

std::vector<fs::path> code_files(const fs::path& top) {
  std::vector<fs::path> files;
  for (const char* folder : {"include", "src", "sparse"}) {
    if (!fs::exists(top / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      const std::string extension = entry.path().extension().string();
      if (entry.is_regular_file() && (extension == ".hpp" || extension == ".h" || extension == ".cpp"))
        files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> check_text(const std::string& file, const std::string& text) {
  std::istringstream stream(text);
  return check_file(file, stream);
}

TEST(Layering, EveryIncludeGoesDown) {
  const fs::path top = MANYCONTACT_SOURCE_DIR;
  const auto files = code_files(top);
  ASSERT_FALSE(files.empty()) << "nothing to check under " << top;
  for (const fs::path& path : files) {
    std::ifstream stream(path);
    ASSERT_TRUE(stream) << path;
    for (const std::string& what : check_file(path.lexically_relative(top).generic_string(), stream))
      ADD_FAILURE() << what;
  }
}

// Returns our headers that `file` includes, from the top of the repository.
std::vector<std::string> own_headers(const std::string& file) {
  static const std::regex include(R"(^\s*#\s*include\s*"(manycontact/[^"]+)\".*)");
  std::ifstream text(fs::path(MANYCONTACT_SOURCE_DIR) / file);
  std::vector<std::string> headers;
  std::string line;
  for (std::smatch match; std::getline(text, line);)
    if (std::regex_match(line, match, include)) headers.push_back(match[1]);
  return headers;
}

// Headers that the build writes, and that are installed too.
const std::set<std::string> written_by_the_build = {"manycontact/abi.hpp", "manycontact/version.hpp",
                                                    "manycontact/action/tpl.hpp", "manycontact/control/tpl.hpp",
                                                    "manycontact/crocoddyl/names.hpp"};

// Returns the place of each installed header of the sources.
std::map<std::string, std::string> installed_headers() {
  const fs::path top = MANYCONTACT_SOURCE_DIR;
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(top / "include"))
    if (entry.path().extension() == ".hpp")
      files[entry.path().lexically_relative(top / "include").generic_string()] =
          entry.path().lexically_relative(top).generic_string();
  return files;
}

// Installed headers are self-contained: they include nothing of src/private and sparse/private.
TEST(Layering, InstalledHeadersIncludeInstalledHeaders) {
  const auto installed = installed_headers();
  for (const auto& [name, file] : installed)
    for (const std::string& header : own_headers(file))
      EXPECT_TRUE(installed.contains(header) || written_by_the_build.contains(header))
          << file << " includes " << header;
}

// tests/installed_headers.txt lists the installed headers; a star marks those that manycontact.hpp includes.
TEST(Layering, WhatIsInstalledIsListed) {
  const auto installed = installed_headers();
  std::set<std::string> brought;
  std::vector<std::string> open = {"manycontact/manycontact.hpp"};
  while (!open.empty()) {
    const auto file = installed.find(open.back());
    open.pop_back();
    if (file == installed.end() || !brought.insert(file->first).second) continue;
    for (const std::string& header : own_headers(file->second)) open.push_back(header);
  }
  std::string expected;
  for (const auto& [name, file] : installed)
    expected += (brought.contains(name) ? "* " : "  ") + name.substr(std::string("manycontact/").size()) + "\n";
  std::ostringstream listed;
  listed << std::ifstream(fs::path(MANYCONTACT_SOURCE_DIR) / "tests/installed_headers.txt").rdbuf();
  EXPECT_EQ(listed.str(), expected);
}

TEST(Layering, CheckerNamesFileAndLineOfABadInclude) {
  EXPECT_EQ(check_text("src/core/kkt/assemble.cpp",
                       "#include \"manycontact/kkt/assemble.hpp\"\n"
                       "\n"
                       "  #  include <manycontact/dynamics/solve.hpp>  // up\n"
                       "#include \"manycontact/sparse/pattern.hpp\"\n"
                       "#include <cholmod.h>\n"),
            (std::vector<std::string>{
                "src/core/kkt/assemble.cpp:3: includes manycontact/dynamics/solve.hpp: from kkt up to dynamics",
                "src/core/kkt/assemble.cpp:5: includes cholmod.h: SuiteSparse belongs to the sources of sparse"}));
}

// Returns whether header `file`, or one of ours that it includes, includes manycontact/abi.hpp.
bool reaches_abi(const fs::path& top, const std::string& file) {
  for (const std::string& header : own_headers(file)) {
    if (header == "manycontact/abi.hpp") return true;
    if (fs::exists(top / "include" / header) && reaches_abi(top, "include/" + header)) return true;
  }
  return false;
}

// A program whose flags change Eigen's matrices relative to the library's is refused, whichever header it includes.
TEST(Layering, HeadersWithEigenIncludeTheGuardOfItsFlags) {
  const fs::path top = MANYCONTACT_SOURCE_DIR;
  int with_eigen = 0;
  for (const fs::path& path : code_files(top)) {
    const std::string file = path.lexically_relative(top).generic_string();
    if (file.find("include/manycontact/") == std::string::npos) continue;
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    if (text.str().find("#include <Eigen/") == std::string::npos) continue;
    ++with_eigen;
    EXPECT_TRUE(reaches_abi(top, file)) << file << " includes Eigen without manycontact/abi.hpp";
  }
  EXPECT_GT(with_eigen, 3);
}

struct Include {
  std::string file;
  std::string header;  // with its quotes or brackets
};

TEST(Layering, CheckerLetsGoodIncludesPass) {
  const std::vector<Include> good = {
      {"src/program/main.cpp", "\"manycontact/io/scene_file.hpp\""},
      {"src/program/main.cpp", "\"commands.hpp\""},
      {"src/program/main.cpp", "<nlohmann/json.hpp>"},
      {"include/manycontact/model/scene.hpp", "\"manycontact/model/model.hpp\""},
      {"include/manycontact/model/scene.hpp", "<vector>"},
      {"include/manycontact/spatial/scalar.hpp", "<boost/multiprecision/float128.hpp>"},
      {"sparse/src/ldl.cpp", "\"manycontact/sparse/ldl.hpp\""},
      {"sparse/src/ldl.cpp", "<ldl.h>"},
      {"src/tools/io/urdf.cpp", "<urdf_parser/urdf_parser.h>"},
      {"include/manycontact/manycontact.hpp", "\"manycontact/simulation/step.hpp\""},
      {"src/program/main.cpp", "\"manycontact/manycontact.hpp\""},
      {"src/tools/analysis/load_scene.cpp", "\"manycontact/io/scene_file.hpp\""},
      {"src/tools/io/urdf.cpp", "<tinyxml2.h>"},
  };
  for (const auto& [file, header] : good)
    EXPECT_TRUE(check_text(file, "#include " + header).empty()) << file << " includes " << header;
}

TEST(Layering, CheckerRefusesBadIncludes) {
  const std::vector<Include> bad = {
      {"include/manycontact/model/scene.hpp", "\"manycontact/detail/contact/reference.hpp\""},  // up
      {"src/core/model/scene.cpp", "\"../kkt/assemble.hpp\""},
      {"sparse/src/ldl.cpp", "\"manycontact/spatial/scalar.hpp\""},
      {"src/optimal_control/action/action.cpp", "\"manycontact/simulation/integrate.hpp\""},  // sideways
      {"src/tools/simulation/step.cpp", "\"manycontact/manycontact.hpp\""},                   // up to an umbrella
      {"src/tools/io/scene_file.cpp", "\"manycontact/kkt/assemble.hpp\""},
      {"src/core/kkt/assemble.cpp", "\"manycontact/io/scene_file.hpp\""},            // the folder above
      {"src/tools/io/scene_file.cpp", "\"manycontact/dynamics/quasi_static.hpp\""},  // io uses no solver
      {"src/core/model/scene.cpp", "\"manycontact/nowhere/scene.hpp\""},             // nowhere
      {"src/nowhere/scene.cpp", "<vector>"},
      {"src/core/kkt/assemble.cpp", "<suitesparse/ldl.h>"},  // headers private to one layer
      {"src/core/kkt/assemble.cpp", "<Eigen/CholmodSupport>"},
      {"sparse/private/manycontact/sparse/ldl.hpp", "<cholmod.h>"},
      {"src/program/main.cpp", "<urdf_model/model.h>"},
      {"include/manycontact/io/scene_file.hpp", "<tinyxml2.h>"},
      {"src/tools/io/scene_file.cpp", "<nlohmann/json.hpp>"},
      {"src/core/dynamics/solve.cpp", "<boost/multiprecision/float128.hpp>"},
      {"src/core/dynamics/batch.cpp", "<omp.h>"},
      {"src/program/batch/batch.cpp", "<mpi.h>"},
      {"src/program/view/mesh.cpp", "<assimp/scene.h>"},
  };
  for (const auto& [file, header] : bad)
    EXPECT_EQ(check_text(file, "#include " + header).size(), 1u) << file << " includes " << header;
}

// Returns classes and structures of a header, declared at the level of its namespace.
std::vector<std::string> classes_of(const fs::path& header) {
  static const std::regex declared(R"(^(?:class|struct) (\w+)(?: final)?(?: :.*| \{.*)?$)");
  std::ifstream text(header);
  std::vector<std::string> names;
  std::string line;
  for (std::smatch match; std::getline(text, line);)
    if (std::regex_match(line, match, declared)) names.push_back(match[1]);
  return names;
}

TEST(CrocoddylNames, AreThoseOfTheHeaders) {
  const fs::path headers = fs::path(MANYCONTACT_SOURCE_DIR) / "include/manycontact";
  const fs::path build = fs::path(MANYCONTACT_BINARY).parent_path().parent_path();
  std::ifstream text(build / "include/manycontact/crocoddyl/names.hpp");
  const std::string names{std::istreambuf_iterator<char>(text), {}};
  const std::set<std::string> of_its_own = {"CostModelSum",
                                            "ConstraintModelManager",
                                            "ContactModelMultiple",
                                            "ImpulseModelMultiple",
                                            "LoopTime",
                                            "Range",
                                            "Reevaluation",
                                            "Step"};  // the last four are internal
  int seen = 0;
  for (const char* folder : {"action", "control"})
    for (const auto& entry : fs::recursive_directory_iterator(headers / folder)) {
      if (entry.path().extension() != ".hpp") continue;
      for (const std::string& name : classes_of(entry.path())) {
        const bool listed = names.find("using manycontact::" + name + ";\n") != std::string::npos;
        EXPECT_NE(listed, of_its_own.contains(name)) << name << " of " << entry.path();
        ++seen;
      }
    }
  EXPECT_GT(seen, 100);
}

}  // namespace
