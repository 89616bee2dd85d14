// Inconsistent contacts are distinguished from those that agree up to rounding error, by all terms of their rows.

#include <gtest/gtest.h>

#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/rounding.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

struct Answer {
  explicit Answer(const SceneFile& f, Method method = Method::kAuto) : file(f), data(file.scene, {method, {}}) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
    estimate_errors(file.scene, data);
  }
  Status status() const { return data.report.status; }
  SceneFile file;
  SceneData data;
};

const Method kMethods[] = {Method::kDense, Method::kSparseLdl, Method::kSparseCholmod};

// Two ends of one box are constrained with gains; their references are `apart` farther from each other than the frames.
SceneFile ends(double apart, const std::string& more = "", const std::string& scene = "gravity=\"0 0 0\"") {
  char place[64];
  std::snprintf(place, sizeof place, "%.17g 0 0.5", 1 + apart);
  return load_text("<scene " + scene + "><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 0.5\"" + more +
                   "/><contact name=\"near\" type=\"3d\" frame=\"b/crate\" gains=\"2500 50\"/>"
                   "<contact name=\"far\" type=\"3d\" frame=\"b/crate\" offset=\"1 0 0\" gains=\"2500 50\" xyz=\"" +
                   place + "\"/></scene>");
}

// Without gravity, at rest, a rounding error is not inconsistent, but an error of a micrometre is.
TEST(Contradictions, GainsTimesRoundingIsNone) {
  for (Method method : kMethods) {
    SCOPED_TRACE(to_string(method));
    for (double apart : {0.0, 1.2e-16, -3e-16, 2.3e-16})
      EXPECT_EQ(Answer(ends(apart), method).status(), Status::kRedundant) << apart;
    for (double apart : {1e-6, -1e-9, 1e-11}) {
      const Answer a(ends(apart), method);
      EXPECT_EQ(a.status(), Status::kInconsistent) << apart;
      ASSERT_EQ(contradictions(a.file.scene, a.data).size(), 2u);
      EXPECT_NEAR(contradictions(a.file.scene, a.data)[0].linear, 2500 * std::abs(apart) / 2, 1e-5 * 2500 * 1e-6);
    }
  }
}

// If the box is rotated, moved far or spinning in place, rows have larger terms and agree up to their rounding error.
TEST(Contradictions, RowsOfLargeTermsThatAgree) {
  for (Method method : kMethods)
    for (const std::string scene : {"gravity=\"0 0 0\"", "gravity=\"0 0 -9.81\""})
      for (double x : {0.0, 10.0, 1e4}) {
        SceneFile file = ends(0, "", scene);
        std::mt19937 rng(3);
        SE3<double> M;
        M.R = rotation_about<double>(Vec3<double>(1, 2, -2) / 3, 0.07);
        M.p = Vec3<double>(x, -x, x / 3);
        file.q = pose_of_placement(M);
        for (Contact& c : file.scene.contacts) c.B.placement.p = M.p + M.R * c.A.placement.p;
        for (double spin : {0.0, 3.0, 1000.0}) {
          file.v << 0, 0, 0, spin, 0, 0;  // about the line through both ends
          EXPECT_EQ(Answer(file, method).status(), Status::kRedundant)
              << to_string(method) << " " << x << " " << spin << " " << scene;
        }
      }
}

// An arm without gravity is at rest against torques (../shared/attack, row 09): only rounding error remains.
TEST(Contradictions, TorquesAgainstAHeldArm) {
  for (Method method : kMethods)
    for (int seed = 0; seed < 20; ++seed) {
      SceneFile file = load_text(
          "<scene gravity=\"0 0 0\"><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/>"
          "<contact name=\"c\" type=\"6d\" frame=\"a/tool\"/><contact name=\"d\" type=\"3d\" frame=\"a/tool\" "
          "offset=\"0.1 0 0.05\"/></scene>");
      std::mt19937 rng(seed);
      disturb(file, rng, 0.3);
      file.v.setZero();
      for (Contact& c : file.scene.contacts) resolve_reference(file.scene, file.q, true, true, c);
      EXPECT_EQ(Answer(file, method).status(), Status::kRedundant) << to_string(method) << " " << seed;
    }
}

// A table on four points, whose velocity is made consistent, is at rest up to rounding errors, which contradict each
// other.
TEST(Contradictions, NoneBesideGravity) {
  const std::string place = "<contact type=\"3d\" frame=\"b/crate\" name=";
  SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0.3 0.1 1\" "
      "rpy=\"0.1 0.2 0.3\"/>" +
      place + "\"k\" offset=\"0.3 0.2 -0.5\"/>" + place + "\"l\" offset=\"0.3 -0.2 -0.5\"/>" + place +
      "\"m\" offset=\"-0.3 0.2 -0.5\"/>" + place + "\"n\" offset=\"-0.3 -0.2 -0.5\"/></scene>");
  Options each;
  each.reduce_pairs = false;
  std::mt19937 rng(7);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::VectorXd v = make_consistent(file.scene, file.q, random_vector(file.scene.nv, rng)).v;
    for (Options options : {Options{}, each, Options{Method::kDense}, Options{Method::kSparseBodies}}) {
      SceneData data(file.scene, options);
      EXPECT_EQ(solve(file.scene, file.q, v, file.u, data).status, Status::kRedundant) << trial;
    }
  }
}

// A contradiction is compared with gravity, or with the acceleration of an external force: it is less or more than
// 1e-12 of that, a rounding error.
TEST(Contradictions, AreComparedWithTheLoads) {
  for (const bool gravity : {true, false})
    for (const double apart : {1e-13, 1e-9}) {
      SceneFile file = ends(apart, "", gravity ? "gravity=\"0 0 -9.81\"" : "gravity=\"0 0 0\"");
      if (!gravity) {
        ExternalWrench pull;
        pull.name = "pull";
        pull.at = file.scene.contacts[0].A;
        pull.wrench << 0, 0, 9.81 * file.scene.robots[0].model->joints[0].inertia.m, 0, 0, 0;
        file.scene.wrenches.push_back(pull);
      }
      for (Contact& c : file.scene.contacts) c.alpha = 1;
      for (const bool pairs : {true, false})
        for (Method method : {Method::kAuto, Method::kDense, Method::kSparseLdl, Method::kSparseBodies}) {
          Options options{method};
          options.reduce_pairs = pairs;
          SceneData data(file.scene, options);
          EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status,
                    apart < 1e-11 ? Status::kRedundant : Status::kInconsistent)
              << to_string(method) << " " << apart;
        }
    }
}

// The least-squares solution has error bounds, which do not contain the contacts' residuals.
TEST(Contradictions, AreNotRounding) {
  const SceneFile file = load_text(
      "<scene><robot name=\"box\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 0.5\"/>"
      "<contact name=\"a\" type=\"6d\" frame=\"box/crate\" gains=\"100 20\"/>"
      "<contact name=\"b\" type=\"3d\" frame=\"box/crate\" xyz=\"0 0 0.6\" gains=\"100 20\"/></scene>");
  for (Method method : kMethods) {
    const Answer a(file, method);
    EXPECT_EQ(a.status(), Status::kInconsistent);
    EXPECT_NEAR(a.data.a[2], 5, 1e-12);
    EXPECT_LE(a.data.report.error_acceleration, 1e-11);
    EXPECT_LE(a.data.report.error_forces, 1e-11);
    EXPECT_TRUE(find_rounding(a.data.report).names().empty());
  }
}

}  // namespace
}  // namespace manycontact::test
