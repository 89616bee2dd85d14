// Derivatives with redundant contacts are those of the unique accelerations and the forces of least norm if the
// contacts are consistent, and of the least-squares accelerations if they are not. The truth ranks with the same
// tolerance.

#include "derivatives/judge.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

State state_of(const SceneFile& file) { return {file.q, file.v, file.u}; }

// Moves joints and leaves the contacts' references: without gains the errors have no effect.
void move_joints(SceneFile& file, std::mt19937& rng) {
  for (const Robot& r : file.scene.robots) {
    Eigen::VectorXd q(r.model->nq);
    integrate<double>(*r.model, file.q.segment(r.idx_q, r.model->nq), random_vector(r.model->nv, rng, 0.1), q);
    file.q.segment(r.idx_q, r.model->nq) = q;
  }
  for (double& u : file.u) u += uniform(rng, -5, 5);
}

// Sets velocities that all contacts allow.
void move_within_the_contacts(SceneFile& file, std::mt19937& rng) {
  const Eigen::MatrixXd J = contact_jacobian(file.scene, file.q);
  const Eigen::VectorXd v = random_vector(file.scene.nv, rng, 0.3);
  file.v = v - least_norm(J, J * v, 1e-9);
}

// Tests at rest, with the joints elsewhere, and moving with the contacts.
void expect_redundant_differences(const std::string& name, SceneFile file) {
  std::mt19937 rng(3);
  expect_differences(name + " as given", file.scene, state_of(file), Status::kRedundant);
  move_joints(file, rng);
  expect_differences(name + " elsewhere", file.scene, state_of(file), Status::kRedundant);
  move_within_the_contacts(file, rng);
  expect_differences(name + " moving", file.scene, state_of(file), Status::kRedundant);
}

TEST(Redundant, FeetOnCorners) {
  expect_redundant_differences("feet_on_corners", load_scene(kModels + "feet_on_corners.xml"));
}

// Contacts with zero errors have gains: the errors' derivatives are not zero.
TEST(Redundant, FeetOnCornersWithGains) {
  SceneFile file = load_edited(kModels + "feet_on_corners.xml", {{"type=\"3d\"", "type=\"3d\" gains=\"25 10\""}});
  expect_differences("feet_on_corners with gains", file.scene, state_of(file), Status::kRedundant);
}

TEST(Redundant, BothFeetHeldTwice) {
  expect_redundant_differences(
      "humanoid on feet held twice",
      load_edited(kModels + "humanoid_standing.xml",
                  {{"</scene>",
                    R"(<contact name="left again" type="6d" frame="humanoid/left_sole" offset="0.1 0.02 0"/>
                       <contact name="right again" type="6d" frame="humanoid/right_sole" offset="-0.1 0 0"
                                offset_quat_xyzw="0 0 0.6 0.8" reference_frame="local_world_aligned"/></scene>)"}}));
}

TEST(Redundant, EveryPointHeldTwice) {
  expect_redundant_differences(
      "quadruped on feet held twice",
      load_edited(kModels + "herd.xml", {{"copies=\"64\" arrange=\"grid\" spacing=\"1\"", ""},
                                         {"</scene>",
                                          R"(<contact name="LF again" type="3d" frame="herd/LF_foot"/>
                       <contact name="RF again" type="3d" frame="herd/RF_foot" reference_frame="world"/>
                       <contact name="LH again" type="3d" frame="herd/LH_foot" reference_frame="local_world_aligned"/>
                       <contact name="RH again" type="2d" frame="herd/RH_foot"/></scene>)"}}));
}

// Two feet on the ground are tied together: the tie between bodies is redundant.
TEST(Redundant, FeetOnTheGroundAndTiedTogether) {
  expect_redundant_differences(
      "humanoid with tied feet",
      load_edited(kModels + "humanoid_standing.xml",
                  {{"</scene>",
                    R"(<contact name="tie" type="6d" frame="humanoid/left_sole" offset="0.05 0 0.02"
                                to="humanoid/right_sole" reference_frame="world"/></scene>)"}}));
}

// Two links of one arm are fixed, a wrist of three joints apart: angular rows of the hand are retained, not those of
// its short moment arm.
TEST(Redundant, ForearmAndHandHeld) {
  const SceneFile file = load_edited(kModels + "humanoid_standing.xml",
                                     {{"</scene>", R"(<contact name="forearm" type="6d" frame="humanoid/left_forearm"/>
                       <contact name="palm" type="6d" frame="humanoid/left_hand" reference_frame="world"/></scene>)"}});
  SceneData data(file.scene);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.islands[0].method, Method::kSparseLdl);
  expect_redundant_differences("humanoid on forearm and hand", file);
}

TEST(Inconsistent, FeetOnCornersMovingWithGains) {
  for (const char* gains : {"0 0", "25 0", "0 10", "25 10"}) {
    SceneFile file = load_edited(kModels + "feet_on_corners.xml",
                                 {{"type=\"3d\"", std::string("type=\"3d\" gains=\"") + gains + "\""}});
    std::mt19937 rng(5);
    disturb(file, rng);
    expect_differences(std::string("feet_on_corners gains ") + gains, file.scene, state_of(file),
                       Status::kInconsistent);
  }
}

TEST(Inconsistent, BothFeetHeldTwice) {
  SceneFile file = load_edited(
      kModels + "humanoid_standing.xml",
      {{"</scene>",
        R"(<contact name="left again" type="6d" frame="humanoid/left_sole" offset="0.1 0.02 0" gains="25 10"/>
           <contact name="right again" type="3d" frame="humanoid/right_sole" reference_frame="world" gains="30 5"/>
           <contact name="tie" type="6d" frame="humanoid/left_sole" to="humanoid/right_sole"
                    reference_frame="local_world_aligned" gains="10 10"/></scene>)"}});
  std::mt19937 rng(5);
  disturb(file, rng);
  expect_differences("humanoid on feet held twice", file.scene, state_of(file), Status::kInconsistent);
}

// In a robot of ten micrometres the angular inconsistency of contacts is 1e-5, and counts as much. Errors that K's
// condition (1e14) would allow are not allowed: least squares do not depend on the units of columns.
TEST(Inconsistent, TurnsBesideMicrometres) {
  SceneFile file = load_text(R"(<scene><robot name="a" urdf="arm.urdf" base="fixed"/>
      <contact name="c" type="6d" frame="a/link_5" gains="25 10"/>
      <contact name="d" type="3d" frame="a/tool" gains="25 10"/></scene>)");
  std::mt19937 rng(6);
  disturb(file, rng, 0.5);
  scale_lengths(file, 1e-5);
  SceneData oracle(file.scene, {Method::kDense, {}});
  ASSERT_EQ(solve(file.scene, file.q, file.v, file.u, oracle).status, Status::kInconsistent);
  const MatX<Quad> truth = differences(file.scene, oracle, state_of(file))[0];
  for (const Way& way : ways(true)) {
    if (way.options.method == Method::kDenseSchur) continue;
    SceneData data(file.scene, way.options);
    (void)solve(file.scene, file.q, file.v, file.u, data);
    (void)differentiate(file.scene, data);
    const Island island = islands_at(file.scene, data)[0];
    const DerivativeErrors e = derivative_errors(file.scene, island, answer_of(file.scene, data, island, 0), truth,
                                                 column_kinds(island, truth), 1);
    for (double error : e.quantity) EXPECT_LE(error, kExpected) << way.name;
  }
}

// Repeated contacts have all types and frames, in the world and between bodies.
TEST(RandomDependent, AllMatricesByEveryMethod) {
  for (int seed = 1; seed <= 8; ++seed) {
    std::mt19937 rng(600 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 2;
    options.redundant = 2;
    options.contradicting = seed > 4;
    RandomScene s = random_scene(rng, options);
    s.scene.moment_length = seed % 2 ? 0.2 : 1;
    expect_differences("random dependent " + std::to_string(seed), s.scene, {s.q, s.v, s.u},
                       seed > 4 ? Status::kInconsistent : Status::kRedundant);
  }
}

}  // namespace
}  // namespace manycontact::test
