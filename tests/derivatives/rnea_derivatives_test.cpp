// Derivatives of inverse dynamics, and products with them, agree with central differences in quadruple precision.

#include "manycontact/detail/algorithm/rnea_derivatives.hpp"

#include "algorithm/shapes.hpp"
#include "manycontact/algorithm/rnea_products.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using VectorQ = VecX<Quad>;
using MatrixQ = MatX<Quad>;

constexpr double kAllowed = 1e-12;  // sums along chains of up to 60 links
const Quad kStep = Quad(1) / Quad(10000000000LL);

struct Derivatives {
  MatrixXd dq, dv;
};

class RneaDerivativesOf : public testing::TestWithParam<Shape> {
 protected:
  RneaDerivativesOf() : kin(model), terms(model) {
    forward_kinematics<double>(model, s.base, s.q, kin);
    forward_accelerations<double>(model, s.v, s.qdd.data(), s.gravity, kin);
    std::vector<double> M(model.M_begin[model.nv]);
    crba<double>(model, kin, Yc, M.data());
    for (int i = 0; i < model.njoints(); ++i) fext.push_back(kin.oMi[i].act_force(s.fext[i]));
  }

  // Uses the library, with every number of the output poisoned beforehand. `pushed`: with external forces.
  Derivatives analytical(bool pushed) {
    for (auto* numbers : {&terms.dq_lower, &terms.dv_lower, &terms.dq_upper, &terms.dv_upper})
      std::fill(numbers->begin(), numbers->end(), NAN);
    for (Mat6X<double>* columns : {&terms.Psid, &terms.Psidd, &terms.Sv}) columns->setConstant(NAN);
    for (int i = 0; i < model.njoints(); ++i) terms.l[i].setConstant(NAN), terms.C[i].setConstant(NAN);
    for (Vec6<double>& f : terms.f) f.setConstant(NAN);
    rnea_derivatives<double>(model, kin, Yc, pushed ? fext : std::vector<Vec6<double>>{}, terms);
    Derivatives d{MatrixXd::Constant(model.nv, model.nv, NAN), MatrixXd::Constant(model.nv, model.nv, NAN)};
    unpack_tree(model, terms.dq_lower, terms.dq_upper, d.dq);
    unpack_tree(model, terms.dv_lower, terms.dv_upper, d.dv);
    return d;
  }

  // Uses central differences; the external forces rotate with their bodies.
  void differences(bool pushed, MatrixQ& dq, MatrixQ& dv) const {
    const VectorQ q = s.q.cast<Quad>(), v = s.v.cast<Quad>(), qdd = s.qdd.cast<Quad>();
    std::vector<Vec6<Quad>> forces;
    for (const Vec6<double>& f : s.fext) forces.push_back(f.cast<Quad>());
    if (!pushed) forces.clear();
    const auto at = [&](int k, const Quad& h, bool of_q) {
      const VectorQ step = h * VectorQ::Unit(model.nv, k);
      VectorQ moved = q;
      if (of_q) integrate<Quad>(model, q, step, moved);
      return torques<Quad>(s, moved, of_q ? v : VectorQ(v + step), qdd, s.gravity, forces);
    };
    dq.resize(model.nv, model.nv);
    dv.resize(model.nv, model.nv);
    for (int k = 0; k < model.nv; ++k) {
      dq.col(k) = (at(k, kStep, true) - at(k, -kStep, true)) / (2 * kStep);
      dv.col(k) = (at(k, kStep, false) - at(k, -kStep, false)) / (2 * kStep);
    }
  }

  bool related(int i, int j) const {
    int low = std::max(i, j);
    while (low > std::min(i, j)) low = model.dof_parent[low];
    return low == std::min(i, j);
  }

  // Some derivatives are zero up to the noise of the differences, e.g. those of bodies that do not rotate.
  static bool vanishes(const MatrixQ& differences) { return size_of(differences) < 1e-15; }

  Specimen s{GetParam().options, GetParam().seed};
  const Model& model = s.model;
  Kinematics<double> kin;
  std::vector<Inertia<double>> Yc;
  std::vector<Vec6<double>> fext;  // in the tree frame
  RneaDerivatives terms;
};

INSTANTIATE_TEST_SUITE_P(Of, RneaDerivativesOf, testing::ValuesIn(shapes()), shape_name);

void expect_equal(const MatrixXd& answer, const MatrixQ& differences, bool vanishes) {
  if (vanishes) {
    EXPECT_LE(size_of(answer), 1e-15);
    return;
  }
  EXPECT_LE(error_of(answer, differences), kAllowed);
  EXPECT_GT(size_of(answer), 0.1);
  EXPECT_FALSE(answer == differences.cast<double>());  // they are not one and the same
  // The test can fail.
  MatrixXd wrong = answer;
  Eigen::Index row, column;
  wrong.cwiseAbs().maxCoeff(&row, &column);
  wrong.col(column) *= 1 + 1e-11;
  EXPECT_GT(error_of(wrong, differences), kAllowed);
}

TEST_P(RneaDerivativesOf, AreTheDifferences) {
  for (bool pushed : {false, true}) {
    SCOPED_TRACE(pushed ? "with external forces" : "without external forces");
    MatrixQ dq, dv;
    differences(pushed, dq, dv);
    const Derivatives d = analytical(pushed);
    expect_equal(d.dq, dq, vanishes(dq));
    expect_equal(d.dv, dv, vanishes(dv));
    if (GetParam().name.starts_with("mixed")) {
      EXPECT_FALSE(vanishes(dq) || vanishes(dv));
    }
  }
}

// Entries are zero if neither coordinate is the other's ancestor, in truth and in the solution.
TEST_P(RneaDerivativesOf, HaveTheTreesPattern) {
  MatrixQ dq, dv;
  differences(true, dq, dv);
  const Derivatives d = analytical(true);
  for (int i = 0; i < model.nv; ++i)
    for (int j = 0; j < model.nv; ++j) {
      if (related(i, j)) continue;
      EXPECT_LE(std::abs(static_cast<double>(dq(i, j))), 1e-20) << i << ' ' << j;  // the tree frame moves along
      EXPECT_EQ(dv(i, j), 0) << i << ' ' << j;
      EXPECT_EQ(d.dq(i, j), 0) << i << ' ' << j;
      EXPECT_EQ(d.dv(i, j), 0) << i << ' ' << j;
    }
}

TEST_P(RneaDerivativesOf, TangentIsTheMatricesTimesADirection) {
  const int n = model.njoints();
  const VectorXd dq = random_vector(model.nv, s.rng), dv = random_vector(model.nv, s.rng);
  const Vec6<double> nan = Vec6<double>::Constant(NAN), zero = Vec6<double>::Zero();
  for (bool pushed : {false, true}) {
    const Derivatives d = analytical(pushed);
    std::vector<BodyVariation> motion(n, {nan, nan, nan, nan});
    std::vector<Vec6<double>> forces(n, zero), rates(n, zero), f(n, nan), df(n, nan);
    VectorXd dtau = VectorXd::Constant(model.nv, NAN);
    tangent_motions(model, kin, s.qdd.data(), dq.data(), dv.data(), motion);
    for (int i = 0; i < n && pushed; ++i) forces[i] = fext[i], rates[i] = cross_force(motion[i].xi, fext[i]);
    tangent_torques(model, kin, motion, forces, rates, f, df, dtau.data());
    const double size = size_of(d.dq * dq) + size_of(d.dv * dv);
    EXPECT_LE(difference_of(dtau, d.dq * dq + d.dv * dv), kAllowed * size);
  }
}

TEST_P(RneaDerivativesOf, PullBackIsTheTransposedTimesAVector) {
  const int n = model.njoints();
  const VectorXd w = random_vector(model.nv, s.rng);
  const Vec6<double> nan = Vec6<double>::Constant(NAN), zero = Vec6<double>::Zero();
  std::vector<Vec6<double>> u(n, nan);
  std::vector<BodyVariation> adjoint(n, {zero, zero, zero, zero});
  VectorXd wq = VectorXd::Constant(model.nv, NAN), wv = wq;
  virtual_velocities(model, kin, w.data(), u);
  add_body_adjoints(model, kin, u, adjoint);
  pull_back(model, kin, s.qdd.data(), u, adjoint, wq.data(), wv.data());
  const Derivatives d = analytical(false);
  EXPECT_LE(difference_of(wq, d.dq.transpose() * w), kAllowed * size_of(d.dq) * size_of(w));
  EXPECT_LE(difference_of(wv, d.dv.transpose() * w), kAllowed * std::max(size_of(d.dv) * size_of(w), 1e-3));
}

// Forces on the bodies affect dtau/dq as the bodies rotate; they do not enter dtau/dv.
TEST_P(RneaDerivativesOf, FollowTheForcesOnTheBodies) {
  const Derivatives with = analytical(true), without = analytical(false);
  EXPECT_EQ(with.dv, without.dv);
  if (GetParam().name.starts_with("mixed")) {
    EXPECT_GT(difference_of(with.dq, without.dq), 1e-2 * size_of(without.dq));
  }
}

}  // namespace
}  // namespace manycontact::test
