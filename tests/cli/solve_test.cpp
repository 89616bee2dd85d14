// `manycontact solve` is tested: its JSON, its summary, its exit status.

#include "manycontact/dynamics/solve.hpp"

#include <map>

#include "cli/program.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/analysis/names.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::cli {
namespace {

using nlohmann::json;

class Solve : public Program {};

std::vector<double> numbers(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

// 1,000 humanoids have 50,000 x 108,000 numbers.
TEST_F(Solve, RefusesDenseMatricesThatFillTheMemory) {
  const std::string many = scene("<robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\" copies=\"1000\"/>");
  const Outcome outcome = run({"solve", many, "--derivatives", "--json", "-"});
  EXPECT_EQ(outcome.status, 2);
  expect_contains(outcome.err, "would write dense matrices of");
  EXPECT_EQ(outcome.out, "");
}

// Accelerations agree in each precision to its accuracy; a dense solution is in double for any requested precision.
TEST_F(Solve, TellsThePrecision) {
  const std::string loop = model("quadruped_loop.xml");
  const auto accelerations = [](const json& j) { return j.at("acceleration").get<std::vector<double>>(); };
  const std::vector<double> truth = accelerations(solve({loop, "--precision", "extended"}));
  for (const auto& [precision, most] :
       std::map<std::string, double>{{"single", 1e-2}, {"double", 1e-10}, {"extended", 1e-15}}) {
    SCOPED_TRACE(precision);
    const json j = solve({loop, "--precision", precision});
    EXPECT_EQ(j.at("report").at("precision"), precision);
    for (const json& island : j.at("report").at("island_list")) EXPECT_EQ(island.at("precision"), precision);
    const std::vector<double> a = accelerations(j);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], truth[k], 10 * most) << k;
    const Outcome words = run({"solve", loop, "--precision", precision});
    if (precision != "double") expect_contains(words.out, precision);
  }
  const json dense = solve({loop, "--method", "dense", "--precision", "single"});
  EXPECT_EQ(dense.at("report").at("precision"), "double");
  EXPECT_EQ(dense.at("report").at("island_list").at(0).at("reason"), to_string(Reason::kLowPrecision));
}

TEST_F(Solve, QualityOnRequest) {
  const std::string herd = model("herd.xml");
  EXPECT_FALSE(solve({herd}).at("report").at("island_list").at(0).contains("quality"));
  for (const json& island : solve({herd, "--quality"}).at("report").at("island_list")) {
    const json& of = island.at("quality");
    EXPECT_EQ(of.at("signature"), json({island.at("nv"), island.at("rank"), 0}));
    EXPECT_GE(of.at("growth").get<double>(), 1);
    EXPECT_LE(of.at("normwise_backward_error"), of.at("componentwise_backward_error"));
  }
  EXPECT_NE(run({"solve", herd, "--quality"}).out.find("Equations K x = b"), std::string::npos);
}

TEST_F(Solve, JsonHasTheSizesOfTheScene) {
  for (const std::string& path : model_scenes()) {
    SCOPED_TRACE(path);
    const SceneFile file = load_scene(path);
    const json j = solve({path});
    EXPECT_EQ(j.at("scene"), file.scene.name);
    EXPECT_EQ(j.at("velocity_names").size(), static_cast<std::size_t>(file.scene.nv));
    EXPECT_EQ(j.at("acceleration").size(), static_cast<std::size_t>(file.scene.nv));
    EXPECT_EQ(j.at("forces").size(), j.at("force_names").size());
    EXPECT_FALSE(j.contains("quasi_static_u"));
    EXPECT_FALSE(j.contains("da_dq"));
    const json& r = j.at("report");
    for (const char* key : {"status", "method", "islands", "nv", "nc", "rank", "factor_nonzeros", "residual_dynamics",
                            "residual_contact", "condition", "refinement_steps", "rounding", "time_us"})
      EXPECT_TRUE(r.contains(key)) << key;
    EXPECT_EQ(r.at("nv"), file.scene.nv);
    EXPECT_EQ(r.at("nc").get<std::size_t>(), j.at("forces").size());
    EXPECT_EQ(r.at("islands").get<std::size_t>(), r.at("island_list").size());
    EXPECT_GT(r.at("time_us").at("symbolic").get<double>(), 0);
    EXPECT_GT(r.at("time_us").at("setup").get<double>(), 0);
    EXPECT_GT(r.at("time_us").at("solve").get<double>(), 0);
    EXPECT_FALSE(r.at("time_us").contains("derivatives"));
    EXPECT_GT(r.at("condition").get<double>(), 1);
    int rank = 0, nonzeros = 0;
    std::size_t robots = 0;
    for (const json& island : r.at("island_list")) {
      rank += island.at("rank").get<int>();
      nonzeros += island.at("factor_nonzeros").get<int>();
      robots += island.at("robots").size();
      for (const char* key : {"status", "method", "order", "reason", "nv", "nc", "refinement_steps",
                              "residual_dynamics", "residual_contact", "condition", "rounding"})
        EXPECT_TRUE(island.contains(key)) << key;
    }
    EXPECT_EQ(r.at("rank"), rank);
    EXPECT_EQ(r.at("factor_nonzeros"), nonzeros);
    EXPECT_EQ(robots, file.scene.robots.size());
  }
}

TEST_F(Solve, JsonReadsBackToTheLibrarysBits) {
  const std::string path = model("humanoid_hands_and_feet.xml");
  const SceneFile file = load_scene(path);
  SceneData data(file.scene, {Method::kSparseLdl, Order::kLeafToRoot});
  (void)manycontact::solve(file.scene, file.q, file.v, file.u, data);
  const json j = solve({path, "--method", "sparse-ldl", "--order", "leaf-to-root", "--quasi-static"});
  EXPECT_EQ(j.at("acceleration").get<std::vector<double>>(), numbers(data.a));
  EXPECT_EQ(j.at("forces").get<std::vector<double>>(), numbers(data.f));
  EXPECT_EQ(j.at("quasi_static_u").get<std::vector<double>>(), numbers(quasi_static(file.scene, file.q)));
  EXPECT_EQ(j.at("velocity_names"), json(velocity_names(file.scene)));
  EXPECT_EQ(j.at("force_names"), json(force_names(file.scene, data)));
}

TEST_F(Solve, MethodAndOrderAreObeyed) {
  const std::string path = model("two_humanoids_carry_beam.xml");
  for (const char* order : {"leaf-to-root", "contacts-early", "camd"}) {
    const json r = solve({path, "--method", "sparse-cholmod", "--order", order}).at("report");
    EXPECT_EQ(r.at("method"), "sparse-cholmod");
    EXPECT_EQ(r.at("island_list")[0].at("method"), "sparse-cholmod");
    EXPECT_EQ(r.at("island_list")[0].at("order"), order);
  }
  const json r = solve({path, "--method", "dense"}).at("report");
  EXPECT_EQ(r.at("island_list")[0].at("method"), "dense");
  EXPECT_TRUE(r.at("island_list")[0].at("order").is_null());
}

// The report of dense-schur has one entry for the whole scene; the scene still has its islands.
TEST_F(Solve, DenseSchurCountsTheScenesIslands) {
  const std::string path = scene(R"(<robot name="b" urdf="box.urdf" base="floating" copies="3" spacing="1"/>
    <contact name="c" type="3d" frame="b/top_1"/>)");
  const json sparse = solve({path}).at("report"), r = solve({path, "--method", "dense-schur"}).at("report");
  EXPECT_EQ(sparse.at("island_list").size(), 3u);
  EXPECT_EQ(r.at("island_list").size(), 1u);
  for (const char* key : {"islands", "nv", "nc", "rank"}) EXPECT_EQ(r.at(key), sparse.at(key)) << key;
  EXPECT_EQ(r.at("islands"), 3);
  expect_contains(run({"solve", path, "--method", "dense-schur"}).out, "9 contact rows in 3 islands");
}

// The summary's statements in words are in the JSON too.
TEST_F(Solve, TextAndJsonAgreeOnWhatIsRounding) {
  const auto check = [this](const std::string& path, bool at_rest) {
    const json r = solve({path}).at("report");
    const std::string out = unwrapped(run({"solve", path}).out);
    const std::vector<std::string> rounding = r.at("rounding");
    EXPECT_EQ(rounding, at_rest ? std::vector<std::string>{"acceleration"} : std::vector<std::string>{}) << path;
    EXPECT_EQ(r.at("error_acceleration").get<double>() > 1, at_rest) << path;
    for (const char* text : {"accelerations are rounding errors", "all accelerations are rounding"})
      EXPECT_EQ(out.find(text) != std::string::npos, at_rest) << path << ": " << text;
    for (const json& island : r.at("island_list")) EXPECT_EQ(island.at("rounding"), r.at("rounding"));
  };
  for (const char* name : {"humanoid_standing.xml", "herd.xml", "two_humanoids_carry_beam.xml"})
    check(model(name), true);
  for (const char* name : {"humanoid_hands_and_feet.xml", "arm_pushes_box.xml"}) check(model(name), false);

  const std::string mixed = scene(R"(<robot name="still" urdf="quadruped.urdf" base="floating" u="gravity"/>
    <robot name="moving" urdf="box.urdf" base="floating" xyz="3 0 0"><v>0 0 0 1 0 2</v></robot>
    <contact name="LF" type="3d" frame="still/LF_foot"/> <contact name="RF" type="3d" frame="still/RF_foot"/>
    <contact name="LH" type="3d" frame="still/LH_foot"/> <contact name="RH" type="3d" frame="still/RH_foot"/>
    <contact name="c" type="3d" frame="moving/top_1"/>)");
  const json r = solve({mixed}).at("report");
  EXPECT_EQ(r.at("rounding"), json{"acceleration"});
  EXPECT_EQ(r.at("island_list")[0].at("rounding"), json{"acceleration"});
  EXPECT_EQ(r.at("island_list")[1].at("rounding"), json::array());
  const std::string out = run({"solve", mixed}).out;
  expect_contains(out, "errors: accelerations are rounding errors");
  expect_contains(out, "of the largest acceleration");
  expect_lacks(out, "all accelerations are rounding");
}

TEST_F(Solve, RedundantIsAnAnswer) {
  const json r = solve({model("feet_on_corners.xml")}).at("report");
  EXPECT_EQ(r.at("status"), "redundant");
  EXPECT_EQ(r.at("rank"), 12);
  EXPECT_EQ(r.at("nc"), 24);
  EXPECT_EQ(r.at("island_list")[0].at("reason"), "none");  // the rows of each sole are reduced to six
}

TEST_F(Solve, InconsistentIsAnAnswer) {
  const std::string path = scene(R"(<robot name="b" urdf="box.urdf" base="floating"><v>0 0 0 1 0 0</v></robot>
    <contact name="c1" type="6d" frame="b/face_top"/> <contact name="c2" type="6d" frame="b/top_1" gains="10 10"/>)");
  EXPECT_EQ(solve({path}).at("report").at("status"), "inconsistent");
  expect_contains(run({"solve", path}).out, "contradict each other");
}

TEST_F(Solve, FailureIsStatusOneWithNulls) {
  const std::vector<std::string> words{model("feet_on_corners.xml"), "--method", "dense-schur"};
  const json j = solve(words, 1);
  EXPECT_EQ(j.at("report").at("status"), "failed");
  for (const char* key : {"acceleration", "forces"})
    for (const json& x : j.at(key)) EXPECT_TRUE(x.is_null());
  const Outcome summary = run({"solve", words[0], words[1], words[2]});
  EXPECT_EQ(summary.status, 1);
  EXPECT_EQ(summary.err, "");
  expect_contains(summary.out, "Status failed");
}

TEST_F(Solve, JsonFileIsThatOfStandardOutput) {
  const std::string path = model("arm_pushes_box.xml");
  const Outcome outcome = run({"solve", path, "--json", this->path("out.json")});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "");
  json file = json::parse(read_text(this->path("out.json"))), direct = solve({path});
  for (json* j : {&file, &direct}) j->at("report").erase("time_us");
  EXPECT_EQ(file, direct);
}

TEST_F(Solve, DerivativesAreListsOfRows) {
  const std::string path = model("arm_pushes_box.xml");
  const SceneFile file = load_scene(path);
  const json j = solve({path, "--derivatives"});
  const auto nv = static_cast<std::size_t>(file.scene.nv), nu = static_cast<std::size_t>(file.scene.nu);
  const std::size_t nc = j.at("forces").size();
  const auto expect_size = [&j](const char* name, std::size_t rows, std::size_t columns) {
    ASSERT_EQ(j.at(name).size(), rows) << name;
    for (const json& row : j.at(name)) EXPECT_EQ(row.size(), columns) << name;
  };
  expect_size("da_dq", nv, nv);
  expect_size("da_dv", nv, nv);
  expect_size("da_du", nv, nu);
  expect_size("dforces_dq", nc, nv);
  expect_size("dforces_dv", nc, nv);
  expect_size("dforces_du", nc, nu);
  EXPECT_GT(j.at("report").at("time_us").at("derivatives").get<double>(), 0);
}

TEST_F(Solve, SummaryNamesTheLargestDerivatives) {
  const std::string path = model("humanoid_standing.xml");
  const SceneFile file = load_scene(path);
  SceneData data(file.scene);
  (void)manycontact::solve(file.scene, file.q, file.v, file.u, data);
  differentiate(file.scene, data);
  const SceneDerivatives d = dense_derivatives(file.scene, data);
  const Outcome outcome = run({"solve", path, "--derivatives"});
  EXPECT_EQ(outcome.status, 0);
  const Model& humanoid = *file.scene.robots[0].model;
  const DerivativeBounds error = estimate_derivative_errors(file.scene, data).front();
  const auto line_of = [&](const char* name, const Eigen::MatrixXd& block, double bound, bool forces) {
    Eigen::Index row = 0, column = 0;
    block.cwiseAbs().maxCoeff(&row, &column);
    char value[32], within[32];
    std::snprintf(value, sizeof value, "%.4g", block(row, column));
    std::snprintf(within, sizeof within, "%.2g", bound);
    const std::string of =
        forces ? row_name(file.scene.contacts.at(static_cast<std::size_t>(row / 6)), static_cast<int>(row % 6))
               : "humanoid/" + dof_name(humanoid, static_cast<int>(row));
    return std::vector<std::string>{name, value, within, of,
                                    "humanoid/" + dof_name(humanoid, static_cast<int>(column))};
  };
  std::vector<std::vector<std::string>> found;
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    found.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  for (const auto& line :
       {line_of("da/dq", d.da_dq, error.da_dq, false), line_of("df/dq", d.dforces_dq, error.dforces_dq, true)})
    EXPECT_NE(std::find(found.begin(), found.end(), line), found.end()) << line[0] << ' ' << line[1] << ' ' << line[2];
}

// Two contacts are a nanometre apart: values are printed, with a warning that derivatives may be rounding error.
TEST_F(Solve, DerivativesThatAreRoundingAreTold) {
  const std::string path = scene(R"(<robot name="a" urdf="box.urdf" base="floating" xyz="0 0 1"/>
    <contact type="3d" name="one" frame="a/crate" offset="0.1 0.1 0"/>
    <contact type="3d" name="two" frame="a/crate" offset="0.1 0.1 1e-9"/>)");
  expect_contains(run({"solve", path, "--derivatives"}).out,
                  "da/dq, df/dq of some island may consist of rounding errors");
  const nlohmann::json errors = solve({path, "--derivatives"})["derivative_errors"];
  EXPECT_GE(errors["da_dq"], 1);
  EXPECT_EQ(errors.size(), 6U);
}

TEST_F(Solve, SummariesFitTheScreen) {
  for (const std::string& path : model_scenes()) {
    const Outcome outcome = run({"solve", path, "--quasi-static", "--repeat", "2"});
    EXPECT_EQ(outcome.status, 0) << path;
    EXPECT_EQ(outcome.err, "") << path;
    const auto lines = lines_of(outcome.out);
    EXPECT_LT(lines.size(), 80u) << path;
    for (const std::string& line : lines) EXPECT_TRUE(line.size() <= 100 || line.starts_with("Scene ")) << line;
  }
}

TEST_F(Solve, SummaryOfTwoHumanoidsSaysWhatMatters) {
  const std::string out = run({"solve", model("two_humanoids_carry_beam.xml")}).out;
  for (const char* part : {"Status ok", "82 velocities and 48 contact rows", "rank 48 of 48", "auto chose", "beam.urdf",
                           "a_left_foot 6d local", "weight of the floating robots 0.00 0.00 -1271.38",
                           "Comparison with the dense rank-revealing method", "all accelerations are rounding"})
    expect_contains(out, part);
}

TEST_F(Solve, AlikeCopiesShareALine) {
  const std::string out = run({"solve", model("herd.xml")}).out;
  expect_contains(out, "64 islands of 18 velocities and 12 contact rows (herd0 .. herd63)");
  expect_contains(out, "LF0 .. LF63");
}

// With copies or not, a summary does not grow with the robots, and few robots are all named.
TEST_F(Solve, ManyRobotsAreCutShort) {
  std::string robots;
  for (int k = 0; k < 300; ++k)
    robots += "<robot name=\"b" + std::to_string(k) + "\" urdf=\"" + (k % 100 == 50 ? "arm" : "box") +
              ".urdf\" base=\"floating\"/>\n";
  for (const std::string command : {"solve", "inspect"}) {
    const std::string out = run({command, scene(robots)}).out;
    EXPECT_LT(lines_of(out).size(), 150u) << out;
    expect_contains(out, "b0 .. b49 box.urdf");
    expect_contains(out, "b251 .. b299 box.urdf");
  }
  const std::string few = run({"solve", model("two_humanoids_carry_beam.xml")}).out;
  expect_contains(few, "a humanoid.urdf");
  expect_contains(few, "b humanoid.urdf");
}

TEST_F(Solve, ManyContactsAreCutShort) {
  std::string contacts;
  for (int k = 0; k < 30; ++k)
    contacts += "<contact name=\"c" + std::to_string(k) + "\" type=\"1d\" frame=\"b/top_1\" offset=\"" +
                std::to_string(0.01 * k) + " 0 0\" reference_frame=\"world\"/>\n";
  const Outcome outcome = run({"solve", scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>\n" + contacts)});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "... and 6 more, none larger");
}

TEST_F(Solve, MimicJointsAreNamed) {
  std::ofstream(path("m.urdf")) << R"(<robot name="m"><link name="a"/>
    <link name="b"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <link name="c"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="first" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
    <joint name="second" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
      <mimic joint="first"/></joint>
    </robot>)";
  const std::string scene = this->scene("<robot name=\"m\" urdf=\"m.urdf\" base=\"fixed\"/>");
  for (const char* command : {"solve", "inspect"})
    expect_contains(run({command, scene}).out,
                    "mimic: m/second (m.urdf:7): <mimic> is not modelled: the joint moves independently");
}

}  // namespace
}  // namespace manycontact::cli
