// view, and --view of simulate and optimize, write this page. browser_test.cpp tests it in a browser.

#include <cmath>
#include <regex>

#include "cli/mesh.hpp"
#include "cli/page.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/manycontact.hpp"

namespace manycontact::cli {
namespace {

class View : public Program {
 protected:
  // If it was built without three.js, the program reports it, and the tests are skipped.
  void SetUp() override {
    const Outcome outcome = run({"view", model("arm_pushes_box.xml"), "--out", path("try.html")});
    if (outcome.status == 0) return;
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    expect_contains(outcome.err, "install libjs-three");
    EXPECT_FALSE(std::filesystem::exists(path("try.html")));
    GTEST_SKIP() << "this build has no three.js";
  }
  ViewPage view(const std::string& scene, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"view", scene, "--out", path("v.html")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    out = outcome.out;
    return ViewPage(path("v.html"));
  }
  mutable std::string out;
};

// Compares a frame's bodies with forward kinematics: positions in floats, unit quaternions in 1/32767.
void expect_bodies(const Scene& scene, const Eigen::VectorXd& q, const ViewPage& page, std::size_t frame) {
  const auto p = page.list<float>("positions");
  const auto w = page.list<std::int16_t>("quaternions");
  ASSERT_EQ(p.size(), 3 * page.frames() * page.bodies());
  ASSERT_EQ(w.size(), 4 * page.frames() * page.bodies());
  std::size_t body = frame * page.bodies();
  for (const Robot& robot : scene.robots) {
    Kinematics<double> kin(*robot.model);
    forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
    for (std::size_t i = 0; i < kin.oMi.size(); ++i) {
      const SE3<double>& oMi = kin.oMi[i];
      const Vec3<double> expected = kin.origin(static_cast<int>(i)) + oMi.p;
      const double largest = std::max(1., expected.cwiseAbs().maxCoeff());
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(p[3 * body + k], expected[static_cast<Eigen::Index>(k)], 6e-8 * largest) << body;
      const auto quat = quaternion_of_rotation<double>(oMi.R);
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(w[4 * body + k] / 32767., quat[static_cast<Eigen::Index>(k)], 0.51 / 32767) << body;
      ++body;
    }
  }
}

// Compares a frame's forces with a solve: 3D and 6D contacts, both kinds of axes.
void expect_forces(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& u,
                   const std::vector<char>& active, const ViewPage& page, std::size_t frame) {
  SceneData data(scene);
  data.active = active;
  (void)solve(scene, q, v, u, data);
  update_kinematics(scene, q, v, data);
  const auto forces = page.list<float>("forces"), points = page.list<float>("points");
  const auto flags = page.list<std::uint8_t>("flags");
  SceneData solved(scene);
  solved.active = active;
  (void)solve(scene, q, v, u, solved);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    const std::size_t at = frame * scene.contacts.size() + c;
    EXPECT_EQ(flags[at] & 1, active[c]);
    if (!active[c]) {
      EXPECT_TRUE(std::isnan(forces[3 * at]));
      continue;
    }
    const Robot& robot = scene.robots[static_cast<std::size_t>(contact.A.robot)];
    const SE3<double> oMA = frame_placement<double>(robot_kinematics(scene, data, contact.A.robot), robot.base,
                                                    contact.A.joint, contact.A.placement);
    const Vec3<double> f = contact_force(scene, solved, static_cast<int>(c)).head<3>();
    const Vec3<double> in_world = contact.reference_frame == ReferenceFrame::kLocal ? Vec3<double>(oMA.R * f) : f;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(points[3 * at + k], oMA.p[static_cast<Eigen::Index>(k)], 1e-6) << contact.name;
      EXPECT_NEAR(forces[3 * at + k], in_world[static_cast<Eigen::Index>(k)], 1e-4)
          << contact.name;  // relative to 1e2 N: floats
    }
  }
}

TEST_F(View, ASceneIsOnePageThatLoadsNothing) {
  const ViewPage page = view(model("two_humanoids_carry_beam.xml"), {"--friction", "0.7"});
  EXPECT_EQ(page.scene["name"], "two_humanoids_carry_beam");
  EXPECT_EQ(page.scene["robots"].size(), 3u);
  EXPECT_EQ(page.bodies(), 33u + 33 + 1);
  EXPECT_EQ(page.frames(), 1u);
  EXPECT_EQ(page.scene["models"][0]["shapes"].size(), 33u);  // the URDF's visuals
  EXPECT_EQ(page.scene["models"].back()["shapes"][0]["size"], nlohmann::json({3.0, 0.08, 0.08}));
  EXPECT_EQ(page.scene["contacts"].size(), 8u);
  EXPECT_EQ(page.scene["contacts"][0]["friction"], 0.7);
  EXPECT_EQ(page.scene["contacts"][4]["friction"], 0);  // not with the world
  EXPECT_EQ(page.scene["contacts"][4]["b"], "beam/grasp_1");

  EXPECT_EQ(page.own.find("http:"), std::string::npos);
  EXPECT_EQ(page.own.find("https:"), std::string::npos);
  expect_contains(page.own, "default-src 'none'");  // the browser itself refuses anything else
  for (const char* word : {" src=", "@import", "url(", "fetch(", "XMLHttpRequest", "import("})
    EXPECT_EQ(page.own.find(word), std::string::npos) << word;
  const std::regex href("href=\"(?!data:,\")");
  EXPECT_FALSE(std::regex_search(page.own, href));
  EXPECT_EQ(page.html.find("{{"), std::string::npos);

  const SceneFile file = load_scene(model("two_humanoids_carry_beam.xml"));
  expect_bodies(file.scene, file.q, page, 0);
  expect_forces(file.scene, file.q, file.v, file.u, std::vector<char>(8, 1), page, 0);
}

// Without a browser, a name that the script reads and the page does not have would not be noticed.
TEST_F(View, TheScriptReadsNamesThatThePageHas) {
  const ViewPage page = view(model("two_humanoids_carry_beam.xml"));
  const auto expect_names = [&page](const char* pattern, const nlohmann::json& known) {
    const std::regex names(pattern), word("\\w+");
    std::size_t count = 0;
    for (std::sregex_iterator at(page.own.begin(), page.own.end(), names), end; at != end; ++at) {
      const std::string list = (*at)[1];
      for (std::sregex_iterator name(list.begin(), list.end(), word); name != end; ++name, ++count)
        EXPECT_TRUE(known.contains(name->str())) << at->str();
    }
    EXPECT_GT(count, 4u) << pattern;
  };
  expect_names("\\bdata\\.(\\w+)", page.scene);
  expect_names("\\bframes\\.(\\w+)", page.scene["frames"]);
  expect_names("const \\{([^}]*)\\}[^;{}]* = this\\.data\\.frames\\b", page.scene["frames"]);
}

TEST_F(View, EveryModel) {
  for (const std::string& path_of_scene : model_scenes()) {
    const ViewPage page = view(path_of_scene);
    const SceneFile file = load_scene(path_of_scene);
    std::size_t bodies = 0;
    for (const Robot& robot : file.scene.robots) bodies += robot.model->joints.size();
    EXPECT_EQ(page.bodies(), bodies) << path_of_scene;
    EXPECT_EQ(page.list<float>("points").size(), 3 * file.scene.contacts.size()) << path_of_scene;
    expect_bodies(file.scene, file.q, page, 0);
  }
}

TEST_F(View, RedundantContactsAndIslands) {
  const auto flags = view(model("feet_on_corners.xml")).list<std::uint8_t>("flags");
  ASSERT_EQ(flags.size(), 8u);
  int marked = 0;
  for (const auto flag : flags) marked += (flag & 2) != 0;
  EXPECT_GE(marked, 4);  // 12 dependent rows, three per contact
  const auto islands = view(model("herd.xml")).list<std::int32_t>("islands");
  ASSERT_EQ(islands.size(), 64u);
  for (int k = 0; k < 64; ++k) EXPECT_EQ(islands[static_cast<std::size_t>(k)], k);
  for (const auto island : view(model("ring_of_humanoids.xml")).list<std::int32_t>("islands")) EXPECT_EQ(island, 0);
}

TEST_F(View, SimulateShowsWhatItWrites) {
  const std::string scene = model("humanoid_hands_and_feet.xml");
  const std::vector<std::string> words{"simulate", scene,   "--time",      "0.105",  "--step",
                                       "0.001",    "--out", path("t.csv"), "--view", path("s.html")};
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, path("s.html") + ": 7 frames");
  const ViewPage page(path("s.html"));
  const auto t = page.list<double>("t");
  ASSERT_EQ(t.size(), 7u);  // 50 per second, and the last
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(t[k], 0.02 * static_cast<double>(k), 1e-12);
  EXPECT_NEAR(t[6], 0.105, 1e-12);

  const SceneFile file = load_scene(scene);
  SimulationData sim(file.scene, file.q, file.v, Integrator::kSemiImplicitEuler, 1e-3);
  while (sim.steps < 40) ASSERT_EQ(step(file.scene, file.u, sim), StepStatus::kOk);
  expect_bodies(file.scene, sim.q, page, 2);
  expect_forces(file.scene, sim.q, sim.v, file.u, sim.dynamics.active, page, 2);

  // The CSV gives the same, except for the forces, which it does not contain.
  const ViewPage again = view(scene, {"--trajectory", path("t.csv")});
  for (const char* name : {"t", "positions", "quaternions", "points", "kinetic", "violation_position"})
    EXPECT_EQ(again.scene["frames"][name], page.scene["frames"][name]) << name;
  EXPECT_EQ(view(scene, {"--trajectory", path("t.csv"), "--rate", "1000"}).frames(), 106u);
}

TEST_F(View, TrajectoryWithForces) {
  const std::string scene = model("humanoid_standing.xml");
  ASSERT_EQ(run({"simulate", scene, "--time", "0.003", "--step", "0.001", "--out", path("t.csv")}).status, 0);
  const std::vector<std::string> lines = lines_of(read_text(path("t.csv")));
  std::ofstream csv(path("f.csv"));
  csv << "f:right[5],t";
  for (const std::string name : {"left", "right"})
    for (int k = 0; k < 6 - (name == "right"); ++k) csv << ",f:" << name << "[" << k << "]";
  csv << "\n26,0,10,11,12,13,14,15,20,21,22,23,24\n";
  for (const std::size_t row : {2u, 4u})
    csv << "0," << lines[row].substr(0, lines[row].find(',')) << ",1,1,1,1,1,1,0,0,0,0,0\n";
  csv.close();
  const ViewPage page = view(scene, {"--trajectory", path("t.csv"), "--forces", path("f.csv"), "--rate", "1000"});
  const auto forces = page.list<float>("forces");
  ASSERT_EQ(forces.size(), 24u);
  const std::vector<float> expected{10, 11, 12, 20, 21, 22, 1, 1, 1};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(forces[k], expected[k], 1e-2);  // the soles lie flat, to 1e-4 or so
  for (std::size_t k = 9; k < 18; ++k) EXPECT_TRUE(std::isnan(forces[k])) << k;   // not active; no row at 0.002
  EXPECT_EQ(page.list<std::uint8_t>("flags"), (std::vector<std::uint8_t>{1, 1, 1, 0, 1, 1, 1, 0}));
}

TEST_F(View, OptimizeShowsItsMotion) {
  const std::string task = model("tasks/humanoid_reaches.xml");
  const Outcome outcome =
      run({"optimize", task, "--out", path("m.csv"), "--json", path("m.json"), "--view", path("m.html")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const ViewPage page(path("m.html"));
  ASSERT_EQ(page.frames(), 41u);
  const TaskFile file = read_task(task);
  const Scene& scene = file.scene.scene;
  const auto json = nlohmann::json::parse(read_text(path("m.json")));
  const auto vector_of = [](const nlohmann::json& list) {
    const std::vector<double> x = list;
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  };
  const Eigen::VectorXd x = vector_of(json["xs"][7]), u = vector_of(json["us"][7]);
  expect_bodies(scene, x.head(scene.nq), page, 7);
  expect_forces(scene, x.head(scene.nq), x.tail(scene.nv), u, std::vector<char>(scene.contacts.size(), 1), page, 7);
  EXPECT_TRUE(std::isnan(page.list<float>("forces").back()));  // the terminal node has no torques
}

// The ring of 16 humanoids takes at most 5 MB over 2 s.
TEST_F(View, TwoSecondsOfTheRingAreSmall) {
  const std::string scene = model("ring_of_humanoids.xml");
  ASSERT_EQ(run({"simulate", scene, "--time", "0.001", "--step", "0.001", "--out", path("t.csv")}).status, 0);
  const std::vector<std::string> lines = lines_of(read_text(path("t.csv")));
  std::ofstream csv(path("long.csv"));
  csv << lines[0] << "\n";
  for (int k = 0; k <= 100; ++k) csv << 0.02 * k << lines[1].substr(lines[1].find(',')) << "\n";
  csv.close();
  EXPECT_EQ(view(scene, {"--trajectory", path("long.csv")}).frames(), 101u);
  EXPECT_LT(std::filesystem::file_size(path("v.html")), 5000000u);
}

// Without visuals there are capsules between the joints; with meshes, those that are found.
TEST_F(View, CapsulesAndMeshes) {
  const auto robot = [&](const std::string& name, const std::string& visual) {
    const std::string link =
        "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
        "izz=\"1\"/></inertial>" +
        visual;
    std::ofstream(path(name))
        << "<robot name=\"r\"><link name=\"a\"/><joint name=\"j\" type=\"continuous\"><parent "
           "link=\"a\"/><child link=\"b\"/><origin xyz=\"0 0 1\"/><axis xyz=\"0 1 0\"/></joint><link "
           "name=\"b\">"
        << link << "</link></robot>";
  };
  const std::string one = scene("<robot name=\"r\" urdf=\"one.urdf\" base=\"fixed\"/>");
  robot("one.urdf", "");
  const auto bare = view(one).scene["models"][0]["shapes"];
  ASSERT_EQ(bare.size(), 2u);
  EXPECT_EQ(bare[0]["shape"], "capsule");
  EXPECT_EQ(bare[0]["body"], -1);
  EXPECT_EQ(bare[0]["size"][1], 1);
  EXPECT_EQ(bare[1]["body"], 0);

  const std::string mesh =
      "<visual><origin xyz=\"0 0 2\"/><geometry><mesh filename=\"package://parts/m/tip.obj\" "
      "scale=\"1 2 3\"/></geometry></visual>";
  robot("one.urdf", mesh);
  EXPECT_EQ(view(one).scene["models"][0]["shapes"][1]["shape"], "capsule");
  expect_contains(out, "capsules represent 1 mesh: package://parts/m/tip.obj (not found)");
  std::filesystem::create_directories(path("parts/m"));
  std::ofstream(path("parts/m/tip.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1/1 2/1 4/1\n";
  const ViewPage page = view(one);
  if (!reads_meshes()) {
    expect_contains(out, "capsules represent 1 mesh: ");
    expect_contains(out, "install libassimp-dev");
    GTEST_SKIP() << "built without assimp";
  }
  expect_lacks(out, "capsules");
  const auto shape = page.scene["models"][0]["shapes"][0];
  EXPECT_EQ(shape["shape"], "mesh");
  EXPECT_EQ(shape["size"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(shape["at"][2], 2);
  EXPECT_EQ(from_base64<float>(page.scene["meshes"][0]["vertices"]).size(), 12u);
  EXPECT_EQ(from_base64<std::uint32_t>(page.scene["meshes"][0]["triangles"]),
            (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3}));

  const Outcome over = run({"view", one, "--out", path("parts/m/tip.obj")});
  EXPECT_EQ(over.status, 2);
  expect_contains(over.err, "tip.obj': choose another file");
  view(one);
  expect_lacks(out, "capsules");

  // assimp follows this one until its stack overflows.
  std::ofstream(path("parts/m/cycle.dae")) << collada("", R"(<node id="a"><instance_node url="#a"/></node>)");
  robot("one.urdf", std::regex_replace(mesh, std::regex("tip.obj"), "cycle.dae"));
  EXPECT_EQ(view(one).scene["models"][0]["shapes"][1]["shape"], "capsule");
  expect_contains(out, "cycle.dae:1: cannot be read by assimp");
}

// A leaf ends at its farthest frame, not in the ground below; one whose mass reaches farther ends there.
TEST_F(View, LeavesEndAtTheirFrames) {
  const auto length = [&](double mass_at, double frame_at) {
    std::ofstream(path("leg.urdf"))
        << "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><origin xyz=\"0 0 " << mass_at
        << "\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
           "iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"j\" "
           "type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis "
           "xyz=\"0 1 0\"/></joint><link name=\"foot\"/><joint name=\"f\" "
           "type=\"fixed\"><parent link=\"b\"/><child link=\"foot\"/><origin xyz=\"0 0 "
        << frame_at << "\"/></joint></robot>";
    const auto shape =
        view(scene("<robot name=\"r\" urdf=\"leg.urdf\" base=\"fixed\"/>")).scene["models"][0]["shapes"].back();
    EXPECT_EQ(shape["shape"], "capsule");
    return shape["size"][1].get<double>() + shape["size"][0].get<double>();  // to the tip of its round end
  };
  EXPECT_NEAR(length(-0.115, -0.213), 0.213, 1e-6);
  EXPECT_NEAR(length(-0.2, -0.213), 0.213, 1e-6);
  EXPECT_NEAR(length(-0.2, -0.05), 0.4, 1e-6);
}

// The page has a contact's reference and the frame attached to it: the line between them.
TEST_F(View, ContactsKnowWhereTheyHold) {
  const std::string apart = scene(R"(<robot name="b" urdf="box.urdf" base="floating" copies="2" spacing="3"/>
    <contact name="rope" type="3d" frame="b0/crate" to="b1/face_top"/>
    <contact name="far" type="3d" frame="b0/crate" xyz="0 0 2"/>)");
  const ViewPage page = view(apart);
  const auto held = page.list<float>("held"), points = page.list<float>("points");
  ASSERT_EQ(held.size(), 12u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(held[k], points[k], 1e-6) << k;  // where it was found
  EXPECT_NEAR(held[3], 3, 1e-6);                                                   // the other box's frame
  EXPECT_GT(held[5], 0.1);
  for (const std::size_t k : {6u, 9u}) {
    EXPECT_NEAR(held[k], 0, 1e-6);
    EXPECT_NEAR(held[k + 2], 2, 1e-6);
  }
}

// Names cannot leave the data that contain them.
TEST_F(View, NamesAreData) {
  const ViewPage page =
      view(scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
                 "<contact name=\"&lt;/script&gt;&lt;b&gt;\" type=\"3d\" frame=\"b/bottom_1\"/>"));
  ASSERT_EQ(page.scene["contacts"].size(), 1u);
  EXPECT_EQ(page.scene["contacts"][0]["name"], "</script><b>");
}

TEST_F(View, BadInput) {
  const std::string scene = model("arm_pushes_box.xml"), v = path("v.html");
  const auto one_line = [&](const std::vector<std::string>& words, const std::string& message) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(v)) << message;
  };
  one_line({"view", scene}, "option --out is missing");
  one_line({"view", scene, "--out", v, "--rate", "2000"}, "--rate is above 1000");
  one_line({"view", scene, "--out", v, "--forces", path("f.csv")}, "--forces needs --trajectory");
  one_line({"view", scene, "--out", "/nowhere/v.html"}, "/nowhere/v.html:1: cannot be written");
  one_line({"simulate", scene, "--time", "1", "--step", "1", "--out", path("t.csv"), "--view", "-"},
           "--view is standard output");
  one_line({"simulate", scene, "--time", "1", "--step", "1", "--out", path("t.csv"), "--view", "/nowhere/v.html"},
           "/nowhere/v.html:1: cannot be written");

  ASSERT_EQ(run({"simulate", scene, "--time", "0.002", "--step", "0.001", "--out", path("t.csv")}).status, 0);
  const std::vector<std::string> lines = lines_of(read_text(path("t.csv")));
  const auto trajectory = [&](const std::vector<std::string>& rows, const std::string& message) {
    std::ofstream csv(path("bad.csv"));
    for (const std::string& row : rows) csv << row << "\n";
    csv.close();
    one_line({"view", scene, "--out", v, "--trajectory", path("bad.csv")}, path("bad.csv") + message);
  };
  one_line({"view", scene, "--out", v, "--trajectory", path("none.csv")}, "none.csv:1: cannot be read");
  trajectory({}, ":1: cannot be read or is empty");
  trajectory({lines[0]}, ":1: has no states");
  trajectory({"t,x", "0,0"}, ":1: there is no column");
  trajectory({lines[0], lines[1], lines[1]}, ":3: the time does not increase");
  trajectory({lines[0], lines[1] + ",1"}, ":2: the row has");
  trajectory({lines[0], "nan" + lines[1].substr(lines[1].find(','))},
             ":2: column 't' has 'nan', expected a finite number");

  // forces of other times: all of them, one between two states, one after the last
  ASSERT_EQ(
      run({"simulate", scene, "--time", "0.002", "--step", "0.001", "--out", path("t.csv"), "--forces", path("f.csv")})
          .status,
      0);
  const std::vector<std::string> forces = lines_of(read_text(path("f.csv")));
  const std::string row = forces[1].substr(forces[1].find(','));
  const std::vector<std::pair<std::vector<std::string>, int>> wrong{
      {{"90", "90.001"}, 2}, {{"0", "0.0005", "0.001"}, 3}, {{"0", "0.001", "0.002", "0.003"}, 5}, {{"-1"}, 2}};
  for (const auto& [times, line] : wrong) {
    std::ofstream csv(path("bad.csv"));
    csv << forces[0] << "\n";
    for (const std::string& t : times) csv << t << row << "\n";
    csv.close();
    one_line({"view", scene, "--out", v, "--trajectory", path("t.csv"), "--forces", path("bad.csv")},
             path("bad.csv") + ":" + std::to_string(line) + ": contains forces at t = ");
  }
}

TEST_F(View, PushesAndSprings) {
  const std::string file = scene(R"(<robot name="b" urdf="box.urdf" base="floating" xyz="1 2 3"/>
    <push frame="b/crate" offset="0 0 0.5" force="0 7 0"/>
    <spring frame="b/crate" xyz="1 2 5" stiffness="3"/>)");
  const ViewPage page = view(file);
  EXPECT_EQ(page.list<float>("wrenches"), (std::vector<float>{1, 2, 3.5F, 0, 7, 0}));
  EXPECT_EQ(page.list<float>("springs"), (std::vector<float>{1, 2, 3, 1, 2, 5}));
}

}  // namespace
}  // namespace manycontact::cli
