// The table in src/doc/action.md is complete and names tests that exist; action.hpp and tpl.hpp include everything.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = MANYCONTACT_SOURCE_DIR;
const fs::path kHeaders = kRoot / "include/manycontact/action";

std::string read(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

std::string page() { return read(kRoot / "src/doc/action.md"); }

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) out.push_back((*it)[1]);
  return out;
}

std::vector<fs::path> headers() {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(kHeaders))
    if (entry.path().extension() == ".hpp") out.push_back(entry.path());
  return out;
}

// The members are those of both original pages, inherited and protected ones included.
const std::set<std::string> members = {"ActuationModelAbstract",
                                       "Base",
                                       "ConstraintModelManager",
                                       "ContactModelMultiple",
                                       "crocoContactModelMultiple",
                                       "CostModelSum",
                                       "Data",
                                       "DifferentialActionDataAbstract",
                                       "MathBase",
                                       "MatrixXs",
                                       "Scalar",
                                       "StateAbstract",
                                       "StateMultibody",
                                       "VectorXs",
                                       "DifferentialActionModelContactFwdDynamicsTpl",
                                       "~DifferentialActionModelContactFwdDynamicsTpl",
                                       "DifferentialActionModelAbstractTpl",
                                       "calc",
                                       "calcDiff",
                                       "checkData",
                                       "createData",
                                       "get_actuation",
                                       "get_armature",
                                       "get_constraints",
                                       "get_contacts",
                                       "get_costs",
                                       "get_damping_factor",
                                       "get_g_lb",
                                       "get_g_ub",
                                       "get_ng",
                                       "get_nh",
                                       "get_pinocchio",
                                       "print",
                                       "quasiStatic",
                                       "set_armature",
                                       "set_damping_factor",
                                       "get_has_control_limits",
                                       "get_nr",
                                       "get_nu",
                                       "get_state",
                                       "get_u_lb",
                                       "get_u_ub",
                                       "quasiStatic_x",
                                       "set_g_lb",
                                       "set_g_ub",
                                       "set_u_lb",
                                       "set_u_ub",
                                       "g_lb_",
                                       "g_ub_",
                                       "has_control_limits_",
                                       "ng_",
                                       "nh_",
                                       "nr_",
                                       "nu_",
                                       "state_",
                                       "u_lb_",
                                       "u_ub_",
                                       "unone_",
                                       "update_has_control_limits"};

// Returns the tests of tests/action as "Suite.Test".
std::set<std::string> all_tests() {
  std::set<std::string> out;
  const std::regex test(R"(TEST(?:_F|_P)?\((\w+), (\w+)\))");
  for (const auto& entry : fs::directory_iterator(kRoot / "tests/action")) {
    const std::string text = read(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), test), end; it != end; ++it)
      out.insert((*it)[1].str() + "." + (*it)[2].str());
  }
  return out;
}

TEST(ActionReadme, TableNamesEveryMemberAndItsTest) {
  const std::set<std::string> tests = all_tests();
  EXPECT_GT(tests.size(), 40u);
  std::set<std::string> in_table;
  std::istringstream text(page().substr(page().find("## Members")));
  const std::regex row(R"(\| `([^`]+)` \| (.+) \| (.+) \|)");
  std::string line;
  while (std::getline(text, line)) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    EXPECT_TRUE(members.contains(match[1])) << match[1] << " is no member of the seeds";
    EXPECT_TRUE(in_table.insert(match[1]).second) << match[1] << " is listed twice";
    const std::vector<std::string> named = matches(match[3], "`([^`]+)`");
    EXPECT_FALSE(named.empty()) << line;
    for (const std::string& test : named) EXPECT_TRUE(tests.contains(test)) << test << " in: " << line;
  }
  for (const std::string& member : members) EXPECT_TRUE(in_table.contains(member)) << member << " is missing";
}

TEST(ActionReadme, OtherTestsItNamesExist) {
  const std::set<std::string> tests = all_tests();
  const std::vector<std::string> named = matches(page(), R"(`([A-Z]\w+\.[A-Z]\w+)`)");
  EXPECT_GT(named.size(), 60u);
  for (const std::string& test : named) EXPECT_TRUE(tests.contains(test)) << test;
}

TEST(ActionReadme, UmbrellaIncludesEveryHeader) {
  const std::string umbrella = read(kRoot / "include/manycontact/action.hpp");
  for (const fs::path& header : headers()) {
    const std::string line = "#include \"" + header.lexically_relative(kRoot / "include").generic_string() + "\"";
    EXPECT_NE(umbrella.find(line), std::string::npos) << line;
  }
}

// Classes without a name in Crocoddyl need no name with Tpl.
TEST(ActionReadme, EveryClassHasItsTplName) {
  const std::set<std::string> own = {"BlockSparse",
                                     "IslandColumns",
                                     "ResidualBlock",
                                     "Dependence",
                                     "CostDerivatives",
                                     "NamedResidual",
                                     "ResidualWithReference",
                                     "NodeAbstract",
                                     "NumDiffOf",
                                     "NodeDataNumDiff",
                                     "NodeNumDiff",
                                     "PartNumDiff",
                                     "NamedParts",
                                     "Printable",
                                     "NamedActivation",
                                     "ActivationWithAlpha",
                                     "FrameResidual",
                                     "ControlResidual",
                                     "ContactResidual",
                                     "CentroidalResidual",
                                     "GravityResidual",
                                     "Vector3MaskType",
                                     "MatrixStorage",
                                     "CostGroup",
                                     "CostGroups",
                                     "CostSquare",
                                     "Impact",
                                     "ImpulseModelBetweenBodies",
                                     "ActuationMatrix",
                                     "MultibodyData",
                                     "SpatialForce",
                                     "ContactForce",
                                     "Step",
                                     "Range",
                                     "NodeOf",
                                     "NodeWithData",
                                     "Reevaluation",
                                     "OwnCost"};
  const fs::path build = fs::path(MANYCONTACT_BINARY).parent_path().parent_path();
  const std::string tpl = read(build / "include/manycontact/action/tpl.hpp");
  std::size_t count = 0;
  for (const fs::path& header : headers())
    for (const std::string& name : matches(read(header), R"((?:^|\n)(?:class|struct) (\w+)(?: :| \{))")) {
      if (own.contains(name)) continue;
      ++count;
      const std::string alias = "template <std::same_as<double> Scalar> using " + name + "Tpl = " + name + ";";
      EXPECT_NE(tpl.find(alias), std::string::npos) << alias;
    }
  EXPECT_GT(count, 50u);
}

}  // namespace
