// The sparse K of an island in every elimination order, against the dense one.

#include "manycontact/kkt/pattern.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <memory>

#include "kkt/island_numbers.hpp"
#include "manycontact/kkt/system.hpp"
#include "sparse/allocations.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class Patterns : public testing::TestWithParam<unsigned> {
 protected:
  RandomScene s = kkt_scene(GetParam());
  std::vector<IslandNumbers> islands = islands_of(s);
  std::mt19937 rng{GetParam()};

  KktSystem assembled(const IslandNumbers& n, Order order, double delta) const {
    KktSystem system;
    system.reset(std::make_shared<KktPattern>(analyze(s.scene, n.island, n.support, order)));
    assemble(n.M_spans, n.J_spans, delta, system);
    return system;
  }
};
INSTANTIATE_TEST_SUITE_P(Seed, Patterns, testing::Range(1u, 9u));

// In the elimination order: entry (k, l) of P K P^T is K(perm[k], perm[l]).
MatrixXd permuted(const MatrixXd& K, const std::vector<int>& perm) {
  MatrixXd out(K.rows(), K.cols());
  for (int k = 0; k < K.rows(); ++k)
    for (int l = 0; l < K.cols(); ++l) out(k, l) = K(perm[k], perm[l]);
  return out;
}

MatrixXd dense(const sparse::UpperCsc& A, const std::vector<double>& x) {
  MatrixXd out = MatrixXd::Zero(A.n, A.n);
  for (int j = 0; j < A.n; ++j)
    for (int k = A.p[j]; k < A.p[j + 1]; ++k) out(A.i[k], j) = out(j, A.i[k]) = x[k];
  return out;
}

TEST_P(Patterns, AssembledSlotsAreTheDenseMatrix) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders)
      for (double delta : {0.0, 0.5}) {
        const KktSystem system = assembled(n, order, delta);
        const KktPattern& p = *system.pattern;
        EXPECT_EQ(p.nv, n.island.nv);
        EXPECT_EQ(p.nc, n.island.nc);
        EXPECT_EQ(p.order, order);
        for (int k = 0; k < p.size(); ++k) ASSERT_EQ(p.iperm[p.perm[k]], k);
        EXPECT_EQ(dense(p.K, system.Kx), permuted(n.K(delta), p.perm)) << to_string(order);
      }
}

TEST_P(Patterns, OrdersPutContactsWhereTheySay) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders) {
      const KktPattern p = analyze(s.scene, n.island, n.support, order);
      const int nv = p.nv;
      if (order != Order::kContactsEarly) {
        for (int k = 0; k < p.size(); ++k) EXPECT_EQ(p.perm[k] < nv, k < nv) << to_string(order);
      }
      if (order == Order::kCamd) continue;
      for (std::size_t r = 0; r < n.island.robots.size(); ++r) {  // children before parents
        const Model& model = *s.scene.robots[n.island.robots[r]].model;
        const int o = n.island.dof_offset[r];
        for (int i = 0; i < model.nv; ++i) {
          if (model.dof_parent[i] >= 0) {
            EXPECT_LT(p.iperm[o + i], p.iperm[o + model.dof_parent[i]]);
          }
        }
      }
      for (std::size_t c = 0; c < n.island.contacts.size(); ++c) {  // a row comes after as many of its joints as rows
        const int rows = s.scene.contacts[n.island.contacts[c]].rows();
        for (int row = 0; row < rows; ++row) {
          const int at = p.iperm[nv + n.island.row_offset[c] + row];
          const auto before = std::count_if(n.support.columns[c].begin(), n.support.columns[c].end(),
                                            [&](int column) { return p.iperm[column] < at; });
          EXPECT_GE(before, rows);
        }
      }
    }
}

TEST_P(Patterns, LeafToRootFillsNothingInTheInertia) {
  RandomScene free = s;
  free.scene.contacts.clear();
  for (const IslandNumbers& n : islands_of(free)) {
    const KktPattern p = analyze(free.scene, n.island, n.support, Order::kLeafToRoot);
    EXPECT_EQ(p.ldl.nonzeros() + p.nv, p.K.nonzeros());
    EXPECT_EQ(p.K.nonzeros(), static_cast<int>(n.packed[0].size()));
  }
}

// Full rank: nv positive pivots and nc negative ones, and the dense solution. Undamped, contacts-early counts joints
// but does not know whether they move the contact in as many directions: where they do not, the pivots must say so.
TEST_P(Patterns, LdlHasTheInertiaAndSolvesOrTheRatioTells) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders)
      for (double delta : {0.0, 0.1}) {
        KktSystem system = assembled(n, order, delta);
        const KktPattern& p = *system.pattern;
        sparse::LdlWorkspace work;
        std::vector<double> L(p.ldl.nonzeros()), D(p.size()), scale(p.size());
        const int done = sparse::ldl_factor(p.K, p.ldl, system.Kx.data(), work, L.data(), D.data());
        const bool may_fail = order == Order::kContactsEarly && delta == 0;
        const double ratio = done < p.size() ? 0
                                             : sparse::smallest_pivot_ratio(p.K, p.ldl, system.Kx.data(), L.data(),
                                                                            D.data(), scale.data());
        if (may_fail && ratio < 1e-11) continue;
        ASSERT_EQ(done, p.size()) << to_string(order);
        EXPECT_GT(ratio, 1e-9) << to_string(order);
        EXPECT_EQ(std::count_if(D.begin(), D.end(), [](double d) { return d > 0; }), p.nv) << to_string(order);

        const MatrixXd K = n.K(delta);
        const VectorXd truth = random_vector(p.size(), rng), b = K * truth;
        for (int k = 0; k < p.size(); ++k) system.x[k] = system.b[k] = b[p.perm[k]];
        const auto solve = [&](double* x) { sparse::ldl_solve(p.ldl, L.data(), D.data(), x); };
        solve(system.x.data());
        const Refinement refinement = refine(system, 5, solve);
        EXPECT_LE(refinement.backward_error, 1e-15) << to_string(order);
        VectorXd x(p.size());
        for (int k = 0; k < p.size(); ++k) x[p.perm[k]] = system.x[k];
        EXPECT_LE(error_of(x, truth), 20 * kEps * condition_1(K)) << to_string(order);
      }
}

// A leg of three turning joints gives a point contact its pivots before the body is reached.
TEST(ContactsEarly, FillsLessThanContactsLast) {
  std::mt19937 rng(3);
  RandomScene s = random_scene(rng, {.nrobots = 1, .models = {{.njoints = 1, .floating_base = true}}, .ncontacts = 0});
  Model model = *s.scene.robots[0].model;
  for (int leg = 0; leg < 4; ++leg)
    for (int k = 0; k < 3; ++k) {
      Joint joint;
      joint.parent = k == 0 ? 0 : model.njoints() - 1;
      joint.placement = random_placement(rng);
      joint.inertia = random_inertia(rng);
      model.joints.push_back(joint);
    }
  model.armature.resize(0);
  finalize(model);
  RandomScene legged;
  add_robot(legged.scene, "legged", std::make_shared<Model>(model));
  for (int leg = 0; leg < 4; ++leg) {
    Contact c;
    c.name = "foot" + std::to_string(leg);
    c.type = ContactType::k3D;
    c.A = {0, 3 * leg + 3, random_placement(rng)};
    add_contact(legged.scene, c);
  }
  legged.q = random_configuration(model, rng);
  legged.v = random_vector(model.nv, rng);
  const std::vector<IslandNumbers> islands = islands_of(legged);
  const KktPattern early = analyze(legged.scene, islands[0].island, islands[0].support, Order::kContactsEarly);
  const KktPattern last = analyze(legged.scene, islands[0].island, islands[0].support, Order::kLeafToRoot);
  for (int leg = 0; leg < 4; ++leg)
    for (int row = 0; row < 3; ++row) EXPECT_LT(early.iperm[18 + 3 * leg + row], early.iperm[5]);
  EXPECT_LT(early.ldl.nonzeros(), last.ldl.nonzeros());
  EXPECT_LT(early.ldl.flops, last.ldl.flops);
}

TEST_P(Patterns, BackwardErrorSeesAWrongSolution) {
  const IslandNumbers& n = islands[0];
  KktSystem system = assembled(n, Order::kLeafToRoot, 0.1);
  const int size = system.pattern->size();
  const MatrixXd K = dense(system.pattern->K, system.Kx);
  const VectorXd x = random_vector(size, rng), b = random_vector(size, rng);
  std::copy(x.begin(), x.end(), system.x.begin());
  std::copy(b.begin(), b.end(), system.b.begin());
  const double error = backward_error(system);
  const VectorXd r = b - K * x, scale = b.cwiseAbs() + K.cwiseAbs() * x.cwiseAbs();
  EXPECT_NEAR(error, r.cwiseQuotient(scale).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE(error_of(Eigen::Map<VectorXd>(system.r.data(), size), r), 64 * kEps);
  system.x[size / 2] = NAN;
  EXPECT_TRUE(std::isnan(backward_error(system)));
}

TEST_P(Patterns, AssembleAllocatesNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  const IslandNumbers& n = islands.back();
  KktSystem system = assembled(n, Order::kContactsEarly, 0);
  const KktPattern& p = *system.pattern;
  sparse::LdlWorkspace work;
  std::vector<double> L(p.ldl.nonzeros()), D(p.size());
  int done = sparse::ldl_factor(p.K, p.ldl, system.Kx.data(), work, L.data(), D.data());
  const auto solve = [&](double* x) { sparse::ldl_solve(p.ldl, L.data(), D.data(), x); };
  const auto count = allocations([&] {
    assemble(n.M_spans, n.J_spans, 0, system);
    done = sparse::ldl_factor(p.K, p.ldl, system.Kx.data(), work, L.data(), D.data());
    solve(system.x.data());
    refine(system, 3, solve);
  });
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(done, p.size());
}

TEST(EmptyIsland, ARobotWithoutJointsHasNoEquations) {
  Scene scene;
  const auto block = std::make_shared<Model>();
  finalize(*block);
  add_robot(scene, "block", block);
  const std::vector<Island> islands = find_islands(scene, {});
  ASSERT_EQ(islands.size(), 1u);
  const IslandSupport support = island_support(scene, islands[0]);
  for (Order order : kOrders) EXPECT_EQ(analyze(scene, islands[0], support, order).size(), 0);
}

}  // namespace
}  // namespace manycontact::test
