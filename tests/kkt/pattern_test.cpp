// The sparse K of an island agrees with the dense one in every elimination order.

#include "manycontact/kkt/pattern.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "kkt/island_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/factor/refined.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/pivot_ratio.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class Patterns : public testing::TestWithParam<unsigned> {
 protected:
  RandomScene s = kkt_scene(GetParam());
  std::deque<IslandNumbers> islands = islands_of(s);
  std::mt19937 rng{GetParam()};

  struct System {
    KktMatrix K;
    KktVectors v;
  };
  static System assembled(const IslandNumbers& n, Order order, double delta) {
    System system;
    system.K.reset(n.shape.pattern(order));
    system.v.resize(system.K.size());
    assemble(n.M_spans, n.J_spans, delta, system.K);
    return system;
  }
};
INSTANTIATE_TEST_SUITE_P(Seed, Patterns, testing::Range(1u, 9u));

// Returns K in the elimination order: entry (k, l) of P K P^T is K(perm[k], perm[l]).
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
        const System system = assembled(n, order, delta);
        const KktPattern& p = *system.K.pattern;
        EXPECT_EQ(p.nv, n.island.nv);
        EXPECT_EQ(p.nc, n.island.nc);
        EXPECT_EQ(p.order, order);
        for (int k = 0; k < p.size(); ++k) ASSERT_EQ(p.iperm[p.perm[k]], k);
        EXPECT_EQ(dense(p.K, system.K.values), permuted(n.K(delta), p.perm)) << to_string(order);
      }
}

TEST_P(Patterns, OrdersPutContactsWhereTheySay) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders) {
      const KktPattern& p = *n.shape.pattern(order);
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
    const KktPattern& p = *n.shape.pattern(Order::kLeafToRoot);
    EXPECT_EQ(p.ldl.nonzeros() + p.nv, p.K.nonzeros());
    EXPECT_EQ(p.K.nonzeros(), static_cast<int>(n.packed[0].size()));
  }
}

// Full rank gives nv positive pivots, nc negative ones, and the dense solution. Undamped, contacts-early counts joints
// but does not know whether they move the contact in as many directions; otherwise the pivots must show it.
TEST_P(Patterns, LdlHasTheInertiaAndSolvesOrTheRatioTells) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders)
      for (double delta : {0.0, 0.1}) {
        System system = assembled(n, order, delta);
        const KktPattern& p = *system.K.pattern;
        const double* Kx = system.K.values.data();
        sparse::LdlWorkspace work;
        std::vector<double> L(p.ldl.nonzeros()), D(p.size()), scale(p.size());
        const int done = sparse::ldl_factor(p.K, p.ldl, Kx, work, L.data(), D.data());
        const bool may_fail = order == Order::kContactsEarly && delta == 0;
        sparse::pivot_terms(p.K, p.ldl, Kx, L.data(), D.data(), scale.data());
        const double ratio = done < p.size() ? 0 : smallest_pivot_ratio(p.size(), D.data(), scale.data());
        for (Method method : {Method::kSparseLdl, Method::kSuiteSparseLdl}) {
          SCOPED_TRACE(to_string(method) + " " + to_string(order));
          FactorScratch scratch;
          const std::unique_ptr<Factor> factor = make_ldl_factor(method);
          const Reason reason = factor->factorize(system.K, scratch);
          EXPECT_EQ(reason == Reason::kNone, ratio >= 1e-11);
          if (may_fail && ratio < 1e-11) continue;
          ASSERT_EQ(done, p.size());
          EXPECT_GT(ratio, 1e-9);
          EXPECT_EQ(std::count_if(D.begin(), D.end(), [](double d) { return d > 0; }), p.nv);

          const MatrixXd K = n.K(delta);
          const VectorXd truth = random_vector(p.size(), rng), b = K * truth;
          for (int k = 0; k < p.size(); ++k) system.v.b[k] = b[p.perm[k]];
          const sparse::Refinement refinement = factor->solve_refined(system.K, system.v, 5);
          EXPECT_LE(refinement.backward_error, 1e-15);
          VectorXd x(p.size());
          for (int k = 0; k < p.size(); ++k) x[p.perm[k]] = system.v.x[k];
          EXPECT_LE(error_of(x, truth), 20 * kEps * condition_1(K));
        }
      }
}

// Returns a floating body with limbs of three revolute joints each.
Model body_with_limbs(std::mt19937& rng, int limbs) {
  RandomScene s = random_scene(rng, {.nrobots = 1, .models = {{.njoints = 1, .floating_base = true}}, .ncontacts = 0});
  Model model = *s.scene.robots[0].model;
  for (int limb = 0; limb < limbs; ++limb)
    for (int k = 0; k < 3; ++k) {
      Joint joint;
      joint.parent = k == 0 ? 0 : model.njoints() - 1;
      joint.placement = random_placement(rng);
      joint.inertia = random_inertia(rng);
      model.joints.push_back(joint);
    }
  model.armature.resize(0);
  finalize(model);
  return model;
}

// A leg of three revolute joints gives a point contact its pivots before the body is reached.
TEST(ContactsEarly, FillsLessThanContactsLast) {
  std::mt19937 rng(3);
  const Model model = body_with_limbs(rng, 4);
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
  const std::deque<IslandNumbers> islands = islands_of(legged);
  const KktPattern& early = *islands[0].shape.pattern(Order::kContactsEarly);
  const KktPattern& last = *islands[0].shape.pattern(Order::kLeafToRoot);
  int before_body = 0;  // one leg is too weak a lever in a posture, and its rows wait for a coordinate of the body
  for (int row = 18; row < 30; ++row) {
    EXPECT_LT(early.iperm[row], early.iperm[0]);
    before_body += early.iperm[row] < early.iperm[5];
  }
  EXPECT_EQ(before_body, 9);
  EXPECT_LT(early.ldl.nonzeros(), last.ldl.nonzeros());
  EXPECT_LT(early.ldl.flops, last.ldl.flops);
}

TEST_P(Patterns, CountsAreThoseOfThePattern) {
  for (const IslandNumbers& n : islands)
    for (Order order : kOrders) {
      const KktPattern& p = *n.shape.pattern(order);
      EXPECT_EQ(n.shape.permutation(order), p.perm);
      const double counted = n.shape.counts(order).nonzeros;
      EXPECT_GE(p.ldl.nonzeros(), counted);  // relaxed supernodes, by a twelfth at most
      EXPECT_LE(11 * p.ldl.nonzeros(), 12 * counted);
      EXPECT_EQ(n.shape.counts(order).flops, p.ldl.flops);
    }
}

// Returns robots of one leg each, fixed at the foot, whose bodies are attached to one box. All of them affect the box.
RandomScene star(int robots, bool box_first) {
  std::mt19937 rng(4);
  RandomScene leg =
      random_scene(rng, {.nrobots = 1, .models = {{.njoints = 1, .floating_base = true}}, .ncontacts = 0});
  Model model = *leg.scene.robots[0].model;
  for (int k = 0; k < 4; ++k) {
    Joint joint;
    joint.parent = k;
    joint.placement = random_placement(rng);
    joint.inertia = random_inertia(rng);
    model.joints.push_back(joint);
  }
  model.armature.resize(0);
  finalize(model);
  const std::shared_ptr<const Model> box = leg.scene.robots[0].model, legged = std::make_shared<Model>(model);
  RandomScene s;
  if (box_first) add_robot(s.scene, "box", box);
  for (int r = 0; r < robots; ++r) add_robot(s.scene, "r" + std::to_string(r), legged);
  if (!box_first) add_robot(s.scene, "box", box);
  for (int r = 0; r < robots; ++r) {
    Contact foot, hold;
    foot.name = "foot" + std::to_string(r), hold.name = "hold" + std::to_string(r);
    foot.type = hold.type = ContactType::k3D;
    foot.A = {r + box_first, 4, random_placement(rng)};
    hold.A = {r + box_first, 0, random_placement(rng)};
    hold.B = {box_first ? 0 : robots, 0, random_placement(rng)};
    add_contact(s.scene, foot), add_contact(s.scene, hold);
  }
  return s;
}

TEST(ContactsEarly, AHubGoesLastWhereverItStands) {
  const auto counts = [](const RandomScene& s) {
    const std::vector<Island> islands = find_islands(s.scene, active_flags(s.scene));
    EXPECT_EQ(islands.size(), 1u);
    IslandShape shape(s.scene, islands[0]);
    return shape.counts(Order::kContactsEarly);
  };
  const sparse::LdlCounts last = counts(star(20, false)), first = counts(star(20, true)),
                          twice = counts(star(40, true));
  EXPECT_LE(first.flops, 1.1 * last.flops);
  EXPECT_LE(first.nonzeros, 1.1 * last.nonzeros);
  EXPECT_LE(twice.flops, 2.2 * first.flops);
}

// There are so many fingers that some are in a poor configuration, and that their sum on the box, which they are
// attached to, is large: few contacts wait.
TEST(ContactsEarly, HundredsHoldABox) {
  const auto nonzeros = [](int fingers) {
    Model palm;
    for (int k = 0; k < 4 * fingers; ++k) {
      Joint joint;
      joint.parent = k % 4 == 0 ? -1 : k - 1;
      joint.axis = Vec3<double>::Unit(k % 3);
      joint.placement.p = {0.05 * (k % 3 - 1), 0.04 * (k % 5 - 2), -0.1};
      joint.inertia = Inertia<double>::from_com(1, {0.02, 0.01, 0.05}, 0.01 * Mat3<double>::Identity());
      palm.joints.push_back(joint);
    }
    finalize(palm);
    Model box;
    Joint floating;
    floating.type = JointType::kFloating;
    floating.inertia = Inertia<double>::from_com(5, {0, 0, 0}, 0.1 * Mat3<double>::Identity());
    box.joints.push_back(floating);
    finalize(box);
    Scene scene;
    add_robot(scene, "hand", std::make_shared<const Model>(palm));
    add_robot(scene, "box", std::make_shared<const Model>(box));
    for (int k = 0; k < fingers; ++k) {
      Contact c;
      c.name = "tip" + std::to_string(k);
      c.type = ContactType::k3D;
      c.A = {0, 4 * k + 3, {}};
      c.B = {1, 0, {}};
      add_contact(scene, c);
    }
    const std::vector<Island> islands = find_islands(scene, active_flags(scene));
    IslandShape shape(scene, islands[0]);
    return shape.counts(Order::kContactsEarly).nonzeros;
  };
  EXPECT_LE(nonzeros(320), 200 * 320);  // 370,000 where all wait
}

// A contact is at the origin of the last joint, which moves it by rounding error alone.
TEST(ContactsEarly, RoundingMovesNothing) {
  std::mt19937 rng(8);
  const Model model = body_with_limbs(rng, 6);
  RandomScene hand;
  add_robot(hand.scene, "hand", std::make_shared<Model>(model));
  for (int finger = 0; finger < 6; ++finger) {
    Contact c;
    c.name = "tip" + std::to_string(finger);
    c.type = ContactType::k1D;
    c.A = {0, 3 * finger + 3, {}};
    add_contact(hand.scene, c);
  }
  hand.q = random_configuration(model, rng);
  hand.v = random_vector(model.nv, rng);
  const std::deque<IslandNumbers> islands = islands_of(hand);
  const KktPattern& early = *islands[0].shape.pattern(Order::kContactsEarly);
  for (int finger = 0; finger < 6; ++finger) {
    const int row = early.iperm[24 + finger];
    EXPECT_GT(row, early.iperm[6 + 3 * finger + 1]) << "the joint before the last moves it";
    EXPECT_LT(row, early.iperm[5]) << "the body is not needed";
  }
  KktMatrix K;
  K.reset(islands[0].shape.pattern(Order::kContactsEarly));
  assemble(islands[0].M_spans, islands[0].J_spans, 0, K);
  FactorScratch scratch;
  EXPECT_EQ(make_ldl_factor(Method::kSparseLdl)->factorize(K, scratch), Reason::kNone);
}

TEST_P(Patterns, ResidualOfAnySolution) {
  const IslandNumbers& n = islands[0];
  System system = assembled(n, Order::kLeafToRoot, 0.1);
  const int size = system.K.size();
  const MatrixXd K = dense(system.K.pattern->K, system.K.values);
  const VectorXd x = random_vector(size, rng), b = random_vector(size, rng);
  std::copy(x.begin(), x.end(), system.v.x.begin());
  std::copy(b.begin(), b.end(), system.v.b.begin());
  residual(system.K, system.v);
  const VectorXd r = b - K * x, scale = b.cwiseAbs() + K.cwiseAbs() * x.cwiseAbs();
  EXPECT_LE(error_of(Eigen::Map<VectorXd>(system.v.r.data(), size), r), 64 * kEps);
  EXPECT_LE(error_of(Eigen::Map<VectorXd>(system.v.scale.data(), size), scale), 64 * kEps);
}

TEST_P(Patterns, AssembleAllocatesNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  const IslandNumbers& n = islands.back();
  System system = assembled(n, Order::kLeafToRoot, 0);
  FactorScratch scratch;
  for (Method method : {Method::kSparseLdl, Method::kSuiteSparseLdl}) {
    const std::unique_ptr<Factor> factor = make_ldl_factor(method);
    ASSERT_EQ(factor->factorize(system.K, scratch), Reason::kNone);
    Reason reason = Reason::kNone;
    const auto count = allocations([&] {
      assemble(n.M_spans, n.J_spans, 0, system.K);
      reason = factor->factorize(system.K, scratch);
      (void)factor->solve_refined(system.K, system.v, 3);
    });
    EXPECT_EQ(count, 0u);
    EXPECT_EQ(reason, Reason::kNone);
  }
}

TEST(EmptyIsland, ARobotWithoutJointsHasNoEquations) {
  Scene scene;
  const auto block = std::make_shared<Model>();
  finalize(*block);
  add_robot(scene, "block", block);
  const std::vector<Island> islands = find_islands(scene, {});
  ASSERT_EQ(islands.size(), 1u);
  IslandShape shape(scene, islands[0]);
  for (Order order : kOrders) EXPECT_EQ(shape.pattern(order)->size(), 0);
}

}  // namespace
}  // namespace manycontact::test
