// Contacts are redundant, exactly or nearly. A status of ok or redundant with an error above the allowed one is a
// failure here.

#include <gtest/gtest.h>

#include <sstream>

#include "manycontact/analysis/errors.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/chains.hpp"
#include "support/dense.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

std::vector<char> all_active(const Scene& scene) { return std::vector<char>(scene.contacts.size(), 1); }

// Compares every method with the truth, least squares where contacts are redundant. Returns the status of the dense
// reference solver; the others must report the same, but the baseline may refuse.
Status judge(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& u) {
  const Truth<Quad> truth = solve_truth<Quad>(scene, all_active(scene), q.cast<Quad>(), v.cast<Quad>(), u.cast<Quad>());
  SceneData oracle(scene, {Method::kDense, {}});
  const Status status = solve(scene, q, v, u, oracle).status;
  EXPECT_NE(status, Status::kFailed);
  const std::vector<double> condition = conditions(scene, oracle);
  int rank = 0;
  for (int r : truth.rank) rank += r;
  EXPECT_EQ(oracle.report.rank, scene.damping > 0 ? oracle.report.nc : rank);
  for (const Way& way : ways(true)) {
    SceneData data(scene, way.options);
    (void)solve(scene, q, v, u, data);
    SCOPED_TRACE(way.name + ": " + to_string(data.report.status) + ", condition " +
                 testing::PrintToString(oracle.report.condition));
    if (way.options.method == Method::kDenseSchur && data.report.status == Status::kFailed) {
      EXPECT_FALSE(data.a.array().isFinite().any());
      continue;
    }
    EXPECT_EQ(data.report.status, status);
    const Errors e = errors<Quad>(scene, data, truth.a, truth.f, condition);
    EXPECT_LE(e.excess, 1) << e;
  }
  return status;
}

Status judge(const SceneFile& file) { return judge(file.scene, file.q, file.v, file.u); }

// ---- exactly dependent ---------------------------------------------------------------------------------------------

// Checks the definition of the solution, condition by condition.
void expect_least_squares(const RandomScene& s, Status status) {
  const Terms terms(s.scene, all_active(s.scene), s.q, s.v, s.u);
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    if (way.options.method == Method::kDenseSchur) {
      EXPECT_EQ(data.report.status, Status::kFailed);
      continue;
    }
    EXPECT_EQ(data.report.status, status);
    EXPECT_LT(data.report.rank, data.report.nc);
    EXPECT_LE(terms.dynamics_error(data.a, data.f), 1e-12);
    EXPECT_LE(terms.least_squares_error(data.a), 1e-12);
    EXPECT_LE(terms.least_norm_error(data.f), 1e-11);
  }
}

TEST(Dependent, RepeatedContactsThatAgree) {
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(310 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.redundant = 1 + seed % 3;
    const RandomScene s = random_scene(rng, options);
    EXPECT_EQ(judge(s.scene, s.q, s.v, s.u), Status::kRedundant);
    expect_least_squares(s, Status::kRedundant);
  }
}

// The least norm weights moments by a length: accelerations are the same, and f satisfies that W f is in J's range, W =
// diag(1, 1 / length^2) on forces and moments.
TEST(Dependent, MomentsCountByTheScenesLength) {
  SceneFile file = load_edited(kModels + "humanoid_standing.xml",
                               {{"</scene>", R"(<contact name="again" type="6d" frame="humanoid/left_sole"
                                                         offset="0.1 0.02 0"/></scene>)"}});
  for (Method method : methods()) {
    if (method == Method::kDenseSchur) continue;
    SCOPED_TRACE(to_string(method));
    file.scene.moment_length = 1;
    SceneData data(file.scene, {method, {}}), weighed(file.scene, {method, {}});
    EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kRedundant);
    file.scene.moment_length = 0.1;
    EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, weighed).status, Status::kRedundant);
    const Eigen::MatrixXd J = contact_jacobian(file.scene, file.q);
    const double size = data.f.cwiseAbs().maxCoeff();
    EXPECT_LE((weighed.a - data.a).cwiseAbs().maxCoeff(), 1e-10 * 9.81);
    EXPECT_LE((J.transpose() * (weighed.f - data.f)).cwiseAbs().maxCoeff(), 1e-10 * size);
    EXPECT_GE((weighed.f - data.f).cwiseAbs().maxCoeff(), 1e-3 * size);
    Eigen::VectorXd Wf = weighed.f;
    for (Eigen::Index k = 0; k < Wf.size(); ++k)
      if (k % 6 >= 3) Wf[k] /= 0.1 * 0.1;
    EXPECT_LE((J * least_norm(J, Wf, 1e-9) - Wf).cwiseAbs().maxCoeff(), 1e-10 * Wf.cwiseAbs().maxCoeff());
    if (weighed.report.islands[0].method != Method::kSparseBodies) {  // K has unweighted rows
      const Eigen::MatrixXd K = kkt_matrix(file.scene, weighed, 0);
      EXPECT_LE((K.bottomLeftCorner(J.rows(), J.cols()) - J).cwiseAbs().maxCoeff(), 1e-14 * J.cwiseAbs().maxCoeff());
    }
    estimate_errors(file.scene, weighed);
    EXPECT_LE(weighed.report.error_forces, 1e-9);
    const auto truth =
        solve_truth<Quad>(file.scene, weighed.active, file.q.cast<Quad>(), file.v.cast<Quad>(), file.u.cast<Quad>());
    EXPECT_LE(largest_entry(weighed.f.cast<Quad>() - truth.f),
              weighed.report.error_forces * weighed.f.cwiseAbs().maxCoeff());
    for (const double bad : {0.0, -1.0, std::nan("")}) {
      file.scene.moment_length = bad;
      EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kFailed);
      EXPECT_EQ(data.report.islands[0].reason, Reason::kBadMomentLength);
    }
  }
}

// A bad value that no row needs is refused all the same, by every method.
TEST(Dependent, MomentLengthIsCheckedWhereRowsAreIndependent) {
  SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  file.scene.moment_length = std::nan("");
  for (const Method method : methods()) {
    SceneData data(file.scene, {method, {}});
    EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kFailed) << to_string(method);
    EXPECT_EQ(data.report.islands[0].reason, Reason::kBadMomentLength) << to_string(method);
  }
}

TEST(Dependent, RepeatedContactsThatContradict) {
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(400 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.contradicting = 1 + seed % 2;
    const RandomScene s = random_scene(rng, options);
    EXPECT_EQ(judge(s.scene, s.q, s.v, s.u), Status::kInconsistent);
    expect_least_squares(s, Status::kInconsistent);
  }
}

// Only the island with the redundant contacts is reported as such.
TEST(Dependent, OneIslandOfTwo) {
  std::mt19937 rng(17);
  SceneOptions options;
  options.nrobots = 2;
  options.between_bodies = 0;
  options.ncontacts = 6;
  RandomScene s = random_scene(rng, options);
  Contact again = s.scene.contacts[0];
  again.name = "again";
  add_contact(s.scene, again);
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    if (way.options.method == Method::kDenseSchur) continue;
    SceneData data(s.scene, way.options);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    ASSERT_EQ(data.report.islands.size(), 2u);
    EXPECT_EQ(data.report.status, Status::kRedundant);
    for (int r = 0; r < 2; ++r) {
      const IslandReport& island = data.report.islands[island_with_robot(data, r)];
      EXPECT_EQ(island.status, r == again.A.robot ? Status::kRedundant : Status::kOk);
    }
  }
}

// States with dependent rows, and dampings, come and go in the same data: a state's bits are those of new data.
TEST(Dependent, NothingIsLeftForTheStatesAfter) {
  const char* scenes[] = {R"(<scene>
  <robot name="arm" urdf="arm.urdf" base="fixed" copies="9" arrange="line" spacing="2"/>
  <contact name="hold" type="6d" frame="arm/tool" gains="100 20"/>
</scene>)",
                          R"(<scene>
  <robot name="dog" urdf="quadruped.urdf" base="floating" copies="16" arrange="circle" spacing="0.6"/>
  <contact name="tie" type="3d" frame="dog/LF_foot" to="dog+1/RH_foot" wrap="true"/>
  <contact name="stand" type="3d" frame="dog/RF_foot"/>
  <contact name="trunk" type="6d" frame="dog/trunk"/>
</scene>)"};
  for (const char* text : scenes) {
    SceneFile file = load_text(text);
    Scene& scene = file.scene;
    std::mt19937 rng(31);
    SceneFile bent = file;
    disturb(bent, rng, 0.5);
    SceneFile some = bent;  // every third robot is as it was
    for (int r = 0; r < scene.nrobots(); r += 3) {
      const Robot& robot = scene.robots[r];
      some.q.segment(robot.idx_q, robot.model->nq) = file.q.segment(robot.idx_q, robot.model->nq);
    }
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(scene, way.options);
      bool dependent = false;
      for (const double damping : {0.0, 1e-6, 0.0})
        for (const SceneFile* state : {&bent, &some, &bent, &file, &some, &bent}) {
          scene.damping = damping;
          (void)solve(scene, state->q, bent.v, bent.u, data);
          dependent =
              dependent || data.report.status == Status::kRedundant || data.report.status == Status::kInconsistent;
          SceneData fresh(scene, way.options);
          (void)solve(scene, state->q, bent.v, bent.u, fresh);
          EXPECT_EQ(data.report.status, fresh.report.status);
          EXPECT_EQ(data.report.rank, fresh.report.rank);
          EXPECT_TRUE(((data.a.array() == fresh.a.array()) || fresh.a.array().isNaN()).all());
          EXPECT_TRUE(((data.f.array() == fresh.f.array()) || fresh.f.array().isNaN()).all());
          if (way.options.method != Method::kAuto || fresh.report.status != Status::kOk) continue;
          estimate_condition(scene, data), estimate_condition(scene, fresh);  // from K, whatever method solved
          EXPECT_EQ(data.report.condition, fresh.report.condition);
          const Eigen::SparseMatrix<double> D = (differentiate(scene, data), sparse_derivatives(scene, data));
          const Eigen::SparseMatrix<double> E = (differentiate(scene, fresh), sparse_derivatives(scene, fresh));
          EXPECT_EQ((D - E).norm(), 0);
        }
      EXPECT_TRUE(dependent || way.options.method == Method::kDenseSchur);
    }
    scene.damping = 0;
  }
}

// Many robots are attached to one box, the first in the scene, and a row of one of them is there twice. The order that
// drops it eliminates the box last; with all of M before all rows the box couples those of all robots.
TEST(Dependent, AHubIsEliminatedLast) {
  SceneFile file = load_text(R"(<scene name="hub"><robot name="box" urdf="box.urdf" base="floating" xyz="0 0 1"/>
    <robot name="r" urdf="humanoid.urdf" base="floating" xyz="0 0 1" copies="64" arrange="line"/>
    <contact name="left" type="6d" frame="r/left_sole"/>
    <contact name="right" type="6d" frame="r/right_sole"/>
    <contact name="hold" type="6d" frame="r/left_hand" to="box/crate"/>
    <contact name="once" type="1d" axis="1 0 0" frame="r3/pelvis"/>
    <contact name="again" type="1d" axis="1 0 0" frame="r3/pelvis"/></scene>)");
  std::mt19937 rng(9);
  disturb(file, rng, 0.3);
  file.v.setZero();
  SceneData data(file.scene, {Method::kSparseLdl, {}}), last(file.scene, {Method::kSparseLdl, Order::kLeafToRoot});
  for (SceneData* d : {&data, &last}) (void)solve(file.scene, file.q, file.v, file.u, *d);
  const IslandReport &island = data.report.islands[0], &other = last.report.islands[0];
  EXPECT_EQ(island.status, Status::kRedundant);
  EXPECT_EQ(island.rank, other.rank);
  EXPECT_EQ(island.method, Method::kSparseLdl);
  EXPECT_EQ(island.order, Order::kContactsEarly);
  EXPECT_LT(2 * island.factor_nonzeros, other.factor_nonzeros);
  const Errors e = errors<double>(file.scene, data, last.a, last.f, conditions(file.scene, last));
  EXPECT_LE(e.excess, 1) << e;
  const Eigen::VectorXd x = random_vector(file.scene.nv, rng), y = random_vector(file.scene.nv, rng),
                        z = random_vector(file.scene.nu, rng);
  Eigen::VectorXd da(file.scene.nv), df(data.f.size()), da_last = da, df_last = df;
  jvp(file.scene, data, x, y, z, da, df);
  jvp(file.scene, last, x, y, z, da_last, df_last);
  EXPECT_LE((da - da_last).norm(), 1e-9 * da_last.norm());
  EXPECT_LE((df - df_last).norm(), 1e-9 * df_last.norm());
}

// An inconsistency counts from 1e-8 of the terms on.
TEST(Dependent, ThresholdOfContradiction) {
  std::mt19937 rng(23);
  SceneOptions options;
  options.nrobots = 1;
  options.gains = 0;
  for (double off : {0.0, 1e-10, 1e-6, 1e-2}) {
    RandomScene s = random_scene(rng, options);
    Contact again = s.scene.contacts[0];
    again.name = "again";
    add_contact(s.scene, again);
    SceneData plain(s.scene, {Method::kDense, {}});
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, plain).status, Status::kRedundant);
    // a velocity gain on one of the two requests another acceleration, by `off` of the terms
    const Terms terms(s.scene, all_active(s.scene), s.q, s.v, s.u);
    const double size = size_of(terms.J.cwiseAbs() * plain.a.cwiseAbs()) + size_of(terms.a0);
    const double velocity = size_of(terms.J.topRows(s.scene.contacts[0].rows()) * s.v);
    s.scene.contacts.back().beta = off * size / velocity;
    SceneData data(s.scene, {Method::kDense, {}});
    EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, off > 1e-8 ? Status::kInconsistent : Status::kRedundant)
        << off;
  }
}

// ---- nearly dependent ----------------------------------------------------------------------------------------------

std::string number(double x) {
  std::ostringstream out;
  out.precision(17);
  out << x;
  return out.str();
}

const double kSmall[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14, 0};

// A point on the axis of its link's own joint is constrained twice, at points apart by rounding error. Where contacts
// come early, that joint gives the rows pivots that are pure rounding error.
TEST(NearlyDependent, OnTheAxisOfTheirOwnJoint) {
  for (const double apart : {1e-17, 1e-15, 1e-14, 1e-13, 1e-12}) {
    ChainOptions options;
    options.links = 7;
    options.held_every = 0;
    Chain c = make_chain(options);
    for (const double offset : {0.0, apart}) {
      Contact contact;
      contact.name = "at" + std::to_string(c.scene.contacts.size());
      contact.type = ContactType::k1D;
      contact.A = {0, 4, SE3<double>()};
      contact.A.placement.p = Vec3<double>(0, offset, 0.5 * offset);
      contact.axis = {0.3, 0.2, 0.9};
      add_contact(c.scene, contact);
    }
    SceneData oracle(c.scene, {Method::kDense, {}});
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, oracle).status, Status::kRedundant) << apart;
    for (const Way& way : ways(true)) {
      SceneData data(c.scene, way.options);
      (void)solve(c.scene, c.q, c.v, c.u, data);
      if (way.options.method == Method::kDenseSchur) continue;
      EXPECT_EQ(data.report.status, Status::kRedundant) << way.name << ", " << apart;
      EXPECT_LE((data.a - oracle.a).norm(), 1e-9 * oracle.a.norm()) << way.name << ", " << apart;
    }
  }
}

TEST(NearlyDependent, StraightKneesBothFeetHeld) {
  for (double knee : kSmall) {
    SCOPED_TRACE(knee);
    SceneFile file = load_edited(std::string(kModels) + "humanoid_standing.xml",
                                 {{"q=\"0.8\"", "q=\"" + number(knee) + "\" v=\"0.3\""},
                                  {"q=\"-0.4\"", "q=\"" + number(-knee / 2) + "\" v=\"-0.1\""},
                                  {"u=\"gravity\"", ""}});
    EXPECT_EQ(judge(file), Status::kOk);
  }
}

// The trunk is fixed, too: at the straight leg each foot loses one direction.
TEST(NearlyDependent, StraightKneesAndTrunkHeld) {
  for (double knee : kSmall) {
    SCOPED_TRACE(knee);
    std::string joints, contacts = "<contact name=\"trunk\" type=\"6d\" frame=\"r/trunk\"/>";
    for (const char* leg : {"LF", "RF", "LH", "RH"}) {
      joints += "<joint name=\"" + std::string(leg) + "_hip\" q=\"" + number(knee / 2) + "\"/><joint name=\"" + leg +
                "_knee\" q=\"" + number(-knee) + "\" v=\"0.01\"/>";
      contacts += "<contact name=\"" + std::string(leg) + "\" type=\"3d\" frame=\"r/" + leg + "_foot\"/>";
    }
    const SceneFile file =
        load_text("<scene><robot name=\"r\" urdf=\"quadruped.urdf\" base=\"floating\" rpy=\"0.3 0.2 0\">" + joints +
                  "</robot>" + contacts + "</scene>");
    const Status status = judge(file);
    if (knee >= 1e-9) {
      EXPECT_EQ(status, Status::kOk);
    } else if (knee <= 1e-12) {  // beyond the rank's tolerance
      EXPECT_NE(status, Status::kOk);
    }
  }
}

// Two points of one sole are `apart` along y: the second has x and z only, since their distance is the body's.
TEST(NearlyDependent, PointsClosely) {
  for (double apart : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    SCOPED_TRACE(apart);
    SceneFile file = load_edited(std::string(kModels) + "humanoid_standing.xml",
                                 {{"<contact name=\"left\" type=\"6d\" frame=\"humanoid/left_sole\"/>",
                                   "<contact name=\"left\" type=\"3d\" frame=\"humanoid/left_sole\"/>"
                                   "<contact name=\"near\" type=\"2d\" frame=\"humanoid/left_sole\" offset=\"0 " +
                                       number(apart) + " 0\"/>"}});
    std::mt19937 rng(3);
    disturb(file, rng);
    for (std::size_t c = 0; c < file.scene.contacts.size(); ++c)
      resolve_reference(file.scene, file.q, true, true, file.scene.contacts[c]);
    const Status status = judge(file);
    if (apart >= 1e-9) {
      EXPECT_EQ(status, Status::kOk);
    }
  }
}

TEST(NearlyDependent, TwoRobotsTiedAtPointsAMillimetreApart) {
  std::mt19937 rng(29);
  SceneOptions options;
  options.nrobots = 2;
  options.ncontacts = 0;
  ModelOptions model;
  model.floating_base = true;
  options.models = {model};
  for (int trial = 0; trial < 5; ++trial) {
    RandomScene s = random_scene(rng, options);
    const SE3<double> place = random_placement(rng, 0.2);
    for (int k = 0; k < 2; ++k) {
      Contact c;
      c.name = "tie" + std::to_string(k);
      c.type = k == 0 ? ContactType::k3D : ContactType::k2D;
      c.A = {0, 4, place * SE3<double>{Mat3<double>::Identity(), Vec3<double>(0, 1e-3 * k, 0)}};
      c.B = {1, 4, {}};
      resolve_reference(s.scene, s.q, true, true, c);
      add_contact(s.scene, c);
    }
    EXPECT_EQ(judge(s.scene, s.q, s.v, s.u), Status::kOk);
  }
}

// Masses range from grams to tons on one tree: M is badly scaled, not singular.
TEST(NearlyDependent, MassesFarApart) {
  for (int seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(500 + seed);
    ModelOptions options;
    options.njoints = 8;
    options.floating_base = seed % 2;
    auto model = std::make_shared<Model>(random_model(rng, options));
    for (int i = 0; i < model->njoints(); ++i) {
      const double scale = std::pow(10.0, uniform(rng, -3, 3));
      Inertia<double>& Y = model->joints[i].inertia;
      Y.m *= scale, Y.h *= scale, Y.I *= scale;
    }
    RandomScene s;
    add_robot(s.scene, "r", model);
    s.q = random_configuration(*model, rng);
    s.v = random_vector(s.scene.nv, rng);
    s.u = random_vector(s.scene.nu, rng, 5);
    Contact c;
    c.name = "tip";
    c.type = options.floating_base ? ContactType::k3D : ContactType::k1D;
    c.A = {0, model->njoints() - 1, random_placement(rng, 0.2)};
    resolve_reference(s.scene, s.q, true, true, c);
    add_contact(s.scene, c);
    EXPECT_EQ(judge(s.scene, s.q, s.v, s.u), Status::kOk);
  }
}

}  // namespace
}  // namespace manycontact::test
