// Task files that do not fit are refused with file, line and a message; the meaning of files that fit is tested.

#include <gtest/gtest.h>

#include "manycontact/task/problem.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

// The robot's base is in line 2; contacts are in lines 4 to 7.
constexpr const char* kScene = R"(<scene name="s">
  <robot name="r" urdf="%quadruped.urdf" base="floating" xyz="0 0 0.5"/>
  <robot name="a" urdf="%arm.urdf" base="fixed" xyz="5 0 0"/>
  <contact name="lf" type="3d" frame="r/LF_foot"/>
  <contact name="rf" type="3d" frame="r/RF_foot"/>
  <contact name="lh" type="3d" frame="r/LH_foot"/>
  <contact name="tool" type="6d" frame="a/tool"/>
</scene>
)";

class BadTask : public testing::Test {
 protected:
  BadTask() {
    std::string scene = kScene;
    for (std::size_t at; (at = scene.find('%')) != std::string::npos;)
      scene.replace(at, 1, MANYCONTACT_SOURCE_DIR "/models/");
    (void)folder_.write("scene.xml", scene);
  }

  std::string write(const std::string& text) const { return folder_.write("task.xml", text); }
  static std::string head() { return R"(<task name="t" scene="scene.xml" step="0.01">)"; }
  // Writes a task whose line 3 is `inside`, in a phase.
  std::string phase(const std::string& inside, const std::string& contacts = "lf rf tool") const {
    return write(head() + "\n<phase nodes=\"3\" contacts=\"" + contacts + "\">\n" + inside + "\n</phase>\n</task>\n");
  }

  void refused(const std::string& path, int line, const std::string& says) const {
    try {
      (void)make_problem(read_task(path));
      ADD_FAILURE() << "accepted, though '" << says << "' was expected";
    } catch (const InputError& e) {
      EXPECT_EQ(e.file, path) << e.what();
      EXPECT_EQ(e.line, line) << e.what();
      EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what() << "\nshould say: " << says;
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    } catch (const std::exception& e) {
      ADD_FAILURE() << "not an InputError: " << e.what();
    }
  }
  void bad_term(const std::string& inside, const std::string& says) const { refused(phase(inside), 3, says); }

  test::TemporaryFolder folder_;
};

TEST_F(BadTask, Structure) {
  refused((folder_ / "none.xml").string(), 1, "expected a task file");
  refused(write("<scene/>"), 1, "expected XML with one root element <task>");
  refused(write("<task step=\"1\"/>"), 1, "<task> has no attribute 'scene'");
  refused(write("<task scene=\"none.xml\" step=\"1\"/>"), 1, "cannot be opened");
  refused(write("<task scene=\"scene.xml\"/>"), 1, "<task> has no attribute 'step'");
  refused(write("<task scene=\"scene.xml\" step=\"0\"/>"), 1, "expected a number above 0");
  refused(write("<task scene=\"scene.xml\" step=\"1\" integrater=\"rk4\"/>"), 1, "unknown attribute 'integrater'");
  refused(write("<task scene=\"scene.xml\" step=\"1\" integrator=\"rk5\"/>"), 1, "integrator of <task> is 'rk5'");
  refused(write(head() + "</task>"), 1, "has no <phase>");
  refused(write(head() + "\n<phaze/></task>"), 2, "unknown element <phaze>");
  refused(write(head() + "\n<phase nodes=\"0\" contacts=\"\"/></task>"), 2, "expected a whole number from 1");
  refused(write(head() + "\n<phase contacts=\"\"/></task>"), 2, "no attribute 'nodes'");
  refused(write(head() + "\n<phase nodes=\"1\"/></task>"), 2, "no attribute 'contacts'");
  refused(write(head() + "\n<phase nodes=\"1\" contacts=\"lf lg\"/></task>"), 2, "there is no contact 'lg'");
  refused(write(head() + "\n<phase nodes=\"1\" contacts=\"lf lf\"/></task>"), 2, "names 'lf' twice");
  refused(write(head() + "\n<phase nodes=\"1\" contacts=\"lf\" impact=\"true\"/></task>"), 2,
          "true in the first phase");
  refused(write(head() +
                "<phase nodes=\"1\" contacts=\"lf rf\"/>\n<phase nodes=\"1\" contacts=\"lf\" impact=\"true\"/></task>"),
          2, "expected a contact that closes");
  refused(
      write(head() + "<phase nodes=\"1\" contacts=\"lf\"/>\n<phase nodes=\"1\" contacts=\"rf\" impact=\"1\"/></task>"),
      2, "impact of <phase> is '1'");
  const std::string good = head() + "<phase nodes=\"1\" contacts=\"\"/>\n";
  refused(write(good + "<terminal/>\n<terminal/></task>"), 3, "has a second <terminal>, the first is on line 2");
  refused(write(good + "<solver type=\"ddp\"/></task>"), 2, "type of <solver> is 'ddp'");
  refused(write(good + "<solver iterations=\"-1\"/></task>"), 2, "expected a whole number above 0");
  refused(write(good + "<solver tolerance=\"0\"/></task>"), 2, "expected a number above 0");
  refused(write(good + "<solver guess=\"random\"/></task>"), 2, "guess of <solver> is 'random'");
  refused(write(good + "<terminal><cost name=\"c\" type=\"control\"/></terminal></task>"), 2, "in <terminal>");
}

TEST_F(BadTask, Terms) {
  bad_term(R"(<cost type="state"/>)", "no attribute 'name'");
  bad_term(R"(<cost name="c" type="stat"/>)", "'stat', did you mean 'state'?");
  bad_term(R"(<cost name="c" type="state" wieght="1"/>)", "unknown attribute 'wieght'");
  bad_term(R"(<cost name="c" type="state" mu="1"/>)", "mu of <cost> cannot be combined with type state");
  bad_term(R"(<cost name="c" type="state" weight="-1"/>)", "expected 0 or more");
  bad_term(R"(<cost name="c" type="state" weight="x"/>)", "weight of <cost>");
  bad_term(R"(<cost name="c" type="state" weights="1 2"/>)", "has 2 numbers, expected 50");
  bad_term(R"(<cost name="c" type="state" robot="r" weights="1 2"/>)", "has 2 numbers, expected 36");
  bad_term(R"(<cost name="c" type="state" robot="q"/>)", "there is no robot 'q', expected one of 'r', 'a'");
  bad_term(R"(<cost name="c" type="state" robot="a" reference="1"/>)", "has 1 number, expected 14");
  bad_term(R"(<cost name="c" type="control" robot="r" reference="1"/>)", "has 1 number, expected 12");
  bad_term(R"(<cost name="c" type="com"/>)", "no attribute 'reference'");
  bad_term(R"(<cost name="c" type="com" reference="0 0"/>)", "has 2 numbers, expected 3");
  bad_term(R"(<cost name="c" type="frame_placement" frame="r/LF_foot" xyz="0 0 0"/>)", "no attribute 'quat_xyzw'");
  bad_term(R"(<cost name="c" type="frame_rotation" frame="r/LF_foot" quat_xyzw="0 0 0 2"/>)", "unit quaternion");
  bad_term(R"(<cost name="c" type="frame_translation" frame="r/LF_fot" xyz="0 0 0"/>)", "did you mean 'LF_foot'?");
  bad_term(R"(<cost name="c" type="frame_translation" frame="LF_foot" xyz="0 0 0"/>)", "expected robot/link");
  bad_term(R"(<cost name="c" type="frame_velocity" frame="r/LF_foot" twist="0 0 0"/>)", "has 3 numbers, expected 6");
  bad_term(R"(<cost name="c" type="friction_cone" contact="lf"/>)", "no attribute 'mu'");
  bad_term(R"(<cost name="c" type="friction_cone" contact="lh" mu="1"/>)", "'lh' is not active in this phase");
  bad_term(R"(<cost name="c" type="friction_cone" contact="lg" mu="1"/>)", "there is no contact 'lg'");
  bad_term(R"(<cost name="c" type="wrench_cone" contact="lf" mu="1" box="1 1"/>)", "expected a 6d contact");
  bad_term(R"(<cost name="c" type="cop" contact="tool" box="1 -1"/>)", "expected numbers above 0");
  bad_term(R"(<cost name="c" type="state" activation="quadd"/>)", "activation of <cost> is 'quadd'");
  bad_term(R"(<cost name="c" type="com" reference="0 0 0" activation="weighted_quad"/>)", "no attribute 'weights'");
  bad_term(R"(<cost name="c" type="com" reference="0 0 0" activation="quadratic_barrier"/>)", "has no bounds");
  bad_term(R"(<cost name="c" type="com" reference="0 0 0" lower="0 0 0"/>)", "expected bounds only with a barrier");
  bad_term(R"(<constraint name="c" type="com" reference="0 0 0"/>)", "has no bounds");
  bad_term(R"(<constraint name="c" type="com" reference="0 0 0" lower="0 1" upper="0 0 0"/>)", "expected 3");
  bad_term(R"(<constraint name="c" type="com" reference="0 0 0" lower="0 1 0" upper="0 0 0"/>)", "lower <= upper");
  bad_term(R"(<constraint name="c" type="com" reference="0 0 0" lower="0 0 0" weight="1"/>)", "unknown attribute");
  refused(phase("<cost name=\"c\" type=\"state\"/>\n<cost name=\"c\" type=\"control\"/>"), 4,
          "exists already on line 3");
}

TEST_F(BadTask, EveryTermIsMade) {
  const TaskFile task = read_task(phase(R"(
    <cost name="state" type="state"/>
    <cost name="state_r" type="state" robot="r" activation="smooth_1norm" eps="0.1"/>
    <cost name="control" type="control" weight="1e-3"/>
    <cost name="control_a" type="control" robot="a" weights="1 1 1 1 1 1 1"/>
    <cost name="effort" type="joint_effort"/>
    <cost name="acceleration" type="joint_acceleration" robot="a"/>
    <cost name="com" type="com" reference="1 2 3"/>
    <cost name="com_r" type="com_position" reference="1 2 3" robot="r"/>
    <cost name="momentum" type="centroidal_momentum" robot="r"/>
    <cost name="placement" type="frame_placement" frame="a/tool" xyz="1 2 3" quat_xyzw="0 0 0 1"/>
    <cost name="translation" type="frame_translation" frame="r/RH_foot" xyz="1 2 3"/>
    <cost name="rotation" type="frame_rotation" frame="r/RH_foot" quat_xyzw="0 0 0 1"/>
    <cost name="velocity" type="frame_velocity" frame="r/RH_foot" reference_frame="local_world_aligned"/>
    <cost name="force" type="contact_force" contact="lf" reference="0 0 70"/>
    <cost name="friction" type="friction_cone" contact="lf" mu="0.6"/>
    <cost name="wrench" type="wrench_cone" contact="tool" mu="0.6" box="0.1 0.05"/>
    <cost name="cop" type="cop" contact="tool" box="0.1 0.05"/>
    <cost name="gravity" type="control_grav"/>
    <cost name="contact_gravity" type="contact_control_grav"/>
    <cost name="barrier" type="frame_translation" activation="weighted_quadratic_barrier" weights="1 1 0"
          frame="r/RH_foot" xyz="0 0 0" lower="-inf -1 0" upper="0 1 inf"/>
    <constraint name="table" type="frame_translation" frame="a/tool" xyz="0 0 0" lower="-inf 0 1" upper="inf 0 inf"/>
    <constraint name="cone" type="friction_cone" contact="rf" mu="0.6"/>
    <constraint name="still" type="state" robot="a" lower="0 0 0 0 0 0 0 -1 -1 -1 -1 -1 -1 -1"
                upper="0 0 0 0 0 0 0 1 1 1 1 1 1 1"/>)"));
  const TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  const auto& model = *problem.models[0];
  EXPECT_EQ(model.get_costs()->get_costs().size(), 20u);
  // state, state_r, control x2, effort, acceleration, com x2, momentum, frames, force, cones, gravity, barrier
  EXPECT_EQ(model.get_nr(), 50u + 36 + 19 + 7 + 19 + 7 + 3 + 3 + 6 + 6 + 3 + 3 + 6 + 3 + 5 + 17 + 4 + 25 + 25 + 3);
  EXPECT_EQ(model.get_nh(), 1u + 7);
  EXPECT_EQ(model.get_ng(), 1u + 5 + 7);
  EXPECT_EQ(model.get_contacts()->get_active_set(), (std::set<std::string>{"lf", "rf", "tool"}));
  EXPECT_EQ(problem.xs.size(), 4u);
  EXPECT_EQ(problem.us.size(), 3u);
}

TEST_F(BadTask, ExternalWrenches) {
  bad_term(R"(<push name="wind" force="1 0 0"/>)",
           "there is no external wrench 'wind' in the scene, since there are no names to choose from");
  bad_term(R"(<push force="1 0 0"/>)", "<push> has no attribute 'name'");
  refused(write(head() + "\n<phase nodes=\"3\" contacts=\"\"/>\n<terminal>\n<push name=\"x\"/></terminal></task>"), 4,
          "<push>");
}

}  // namespace
}  // namespace manycontact
