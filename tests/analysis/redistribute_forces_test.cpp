// Redistributed forces are compared with the null space of J^T from a dense decomposition.

#include "manycontact/analysis/redistribute_forces.hpp"

#include <cmath>

#include "support/dense.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

struct SolvedWithNullSpace {
  explicit SolvedWithNullSpace(SceneFile of, Method method = Method::kAuto)
      : file(std::move(of)),
        data(file.scene, {method, {}}),
        terms(file.scene, active(file.scene), file.q, file.v, file.u) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
  }
  static std::vector<char> active(const Scene& scene) {
    std::vector<char> out;
    for (const Contact& contact : scene.contacts) out.push_back(contact.active);
    return out;
  }
  // Uses the singular vectors of J^T.
  Eigen::MatrixXd null_space() const {
    const Svd svd(terms.J.transpose());
    Eigen::Index rank = 0;
    while (rank < svd.sigma.size() && svd.sigma[rank] > 1e-9 * svd.sigma[0]) ++rank;
    return svd.V.rightCols(terms.J.rows() - rank);
  }

  SceneFile file;
  SceneData data;
  Terms terms;
};

// The robots are a door on two hinges in one line, a quadruped on four feet and its trunk, two quadrupeds that share
// two contacts, and one robot without redundant contacts.
SceneFile redundant_scene() {
  return load_text(
      "<scene moment_length=\"0.3\"><robot name=\"q\" urdf=\"quadruped.urdf\" base=\"floating\" copies=\"4\">"
      "<joint name=\"LF_knee\" q=\"0.4\"/></robot>"
      "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
      "<contact name=\"lower\" type=\"5d\" frame=\"b/crate\" offset=\"-0.2 0 -0.2\"/>"
      "<contact name=\"upper\" type=\"5d\" frame=\"b/crate\" offset=\"-0.2 0 0.2\"/>"
      "<contact name=\"a\" type=\"6d\" frame=\"q0/LF_foot\"/><contact name=\"b\" type=\"3d\" frame=\"q0/RH_foot\"/>"
      "<contact name=\"c\" type=\"6d\" frame=\"q0/trunk\"/><contact name=\"d\" type=\"3d\" frame=\"q1/LF_foot\"/>"
      "<contact name=\"e\" type=\"6d\" frame=\"q2/LF_foot\"/><contact name=\"f\" type=\"2d\" frame=\"q2/trunk\" "
      "to=\"q3/trunk\"/><contact name=\"g\" type=\"3d\" frame=\"q3/trunk\" to=\"q2/trunk\"/></scene>");
}

Eigen::VectorXd uneven(Eigen::Index n, double offset) {
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = offset + std::sin(1.7 * static_cast<double>(i + 1));
  return x;
}

// The null space has a rounding error of about 1e-12 from solves with |J| of order 1.
constexpr double kRounding = 1e-10;

TEST(RedistributeForces, BasisSpansTheNullSpace) {
  for (const Method method : methods()) {
    if (method == Method::kDenseSchur) continue;  // it fails where contacts are redundant
    const SolvedWithNullSpace s(redundant_scene(), method);
    const Eigen::MatrixXd N = force_null_space(s.file.scene, s.file.q, s.data), expected = s.null_space();
    ASSERT_EQ(N.cols(), expected.cols()) << to_string(method);
    EXPECT_GT(N.cols(), 5);
    EXPECT_LE((s.terms.J.transpose() * N).cwiseAbs().maxCoeff(), kRounding) << to_string(method);
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(N.cols(), N.cols());
    EXPECT_LE((N.transpose() * N - one).cwiseAbs().maxCoeff(), kRounding) << to_string(method);
    EXPECT_LE((N - expected * (expected.transpose() * N)).cwiseAbs().maxCoeff(), kRounding) << to_string(method);
  }
}

TEST(RedistributeForces, MinimisesTheWeightedDistance) {
  const SolvedWithNullSpace s(redundant_scene());
  const Eigen::Index n = s.data.f.size();
  const Eigen::VectorXd reference = 30 * uneven(n, 1), weights = uneven(n, 1.5);
  const Eigen::VectorXd f = redistribute_forces(s.file.scene, s.file.q, s.data, reference, weights);
  const double size = s.data.f.cwiseAbs().maxCoeff() + reference.cwiseAbs().maxCoeff();
  EXPECT_LE((s.terms.J.transpose() * (f - s.data.f)).cwiseAbs().maxCoeff(), kRounding * size);
  const Eigen::MatrixXd N = s.null_space();  // at the optimum no null vector reduces the distance
  EXPECT_LE((N.transpose() * weights.cwiseProduct(f - reference)).cwiseAbs().maxCoeff(), kRounding * size);
  EXPECT_GT((f - s.data.f).cwiseAbs().maxCoeff(), 1);
}

TEST(RedistributeForces, WithoutArgumentsHaveLeastNorm) {
  const SolvedWithNullSpace s(redundant_scene());
  const Eigen::VectorXd f = redistribute_forces(s.file.scene, s.file.q, s.data);
  EXPECT_LE((s.null_space().transpose() * f).cwiseAbs().maxCoeff(), kRounding * f.cwiseAbs().maxCoeff());
  EXPECT_LT(f.norm(), s.data.f.norm());  // this norm weights moments by moment_length
  SceneFile plain = redundant_scene();
  plain.scene.moment_length = 1;
  const SolvedWithNullSpace least(std::move(plain));
  EXPECT_LE((least.data.f - f).cwiseAbs().maxCoeff(), kRounding * f.cwiseAbs().maxCoeff());
}

TEST(RedistributeForces, AreTheSolutionsWhereAllAreUnique) {
  const SolvedWithNullSpace s(load_scene(kModels + "humanoid_standing.xml"));
  EXPECT_EQ(force_null_space(s.file.scene, s.file.q, s.data).cols(), 0);
  EXPECT_EQ(redistribute_forces(s.file.scene, s.file.q, s.data, Eigen::VectorXd::Ones(s.data.f.size())), s.data.f);
  SceneFile damped = redundant_scene();
  damped.scene.damping = 1e-6;
  const SolvedWithNullSpace d(std::move(damped));
  EXPECT_EQ(force_null_space(d.file.scene, d.file.q, d.data).cols(), 0);
}

TEST(RedistributeForces, RefuseWhatDoesNotFit) {
  const SceneFile file = redundant_scene();
  const SceneData fresh(file.scene);
  EXPECT_THROW(force_null_space(file.scene, file.q, fresh), std::logic_error);
  EXPECT_THROW(redistribute_forces(file.scene, file.q, fresh), std::logic_error);
  const SolvedWithNullSpace s(redundant_scene());
  const Eigen::Index n = s.data.f.size();
  const auto refused = [&](const Eigen::VectorXd& reference, const Eigen::VectorXd& weights) {
    EXPECT_THROW(redistribute_forces(s.file.scene, s.file.q, s.data, reference, weights), std::invalid_argument);
  };
  refused(Eigen::VectorXd::Ones(n - 1), {});
  refused({}, Eigen::VectorXd::Ones(n + 1));
  refused({}, Eigen::VectorXd::Zero(n));
  refused({}, -Eigen::VectorXd::Ones(n));
  refused(Eigen::VectorXd::Constant(n, NAN), {});
  refused({}, Eigen::VectorXd::Constant(n, INFINITY));
  EXPECT_THROW(redistribute_forces(s.file.scene, s.file.q.head(3), s.data), std::invalid_argument);
}

// A failed island has no forces to redistribute; the others have.
TEST(RedistributeForces, LeaveFailedIslandsAsTheyAre) {
  SceneFile file = redundant_scene();
  const SceneData whole(file.scene);
  SceneData data(file.scene);
  Eigen::VectorXd u = file.u;
  u[0] = NAN;
  (void)solve(file.scene, file.q, file.v, u, data);
  ASSERT_EQ(data.report.status, Status::kFailed);
  const Eigen::VectorXd f = redistribute_forces(file.scene, file.q, data);
  for (Eigen::Index i = 0; i < f.size(); ++i) EXPECT_EQ(std::isnan(f[i]), std::isnan(data.f[i])) << i;
  EXPECT_GT(force_null_space(file.scene, file.q, data).cols(), 0);
}

}  // namespace
}  // namespace manycontact::test
