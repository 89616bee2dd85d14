// Violations and KKT residuals are correct for nodes of every kind: without controls, not finite, of one part.

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

// The node is x' = x with cost x^2 / 2 and no controls. g = [x; 2 x], h = 3 x; a running node has g = x alone.
class Still : public ActionModelAbstract {
 public:
  explicit Still(double factor = 1) : ActionModelAbstract(std::make_shared<StateVector>(1), 0, 0, 1, 0, 2, 1) {
    factor_ = factor;
    g_lb_ = Eigen::Vector2d(-5, -5);
    g_ub_ = Eigen::Vector2d(5, 5);
  }
  const Eigen::VectorXd& get_g_lb_T() const override { return lower_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return upper_; }
  void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef&) override {
    calc(data, x);
    data->g.conservativeResize(1);
    data->h.conservativeResize(0);
  }
  void calc(const NodeDataPtr& data, const ConstVectorRef& x) override {
    data->xnext = x;
    data->cost = 0.5 * x.squaredNorm();
    data->g = factor_ * Eigen::Vector2d(x[0], 2 * x[0]);
    data->h = factor_ * Eigen::VectorXd::Constant(1, 3 * x[0]);
  }
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef&) override { calcDiff(data, x); }
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x) override {
    data->Fx.setIdentity();
    data->Lx = x;
    data->Lxx.setIdentity();
  }

 private:
  double factor_;
  Eigen::VectorXd lower_ = Eigen::Vector2d(-1, 0), upper_ = Eigen::Vector2d(0.5, 1);
};

TEST(Feasibility, OfNodesWithoutControlsIsThatOfTheirOwnRows) {
  const auto node = std::make_shared<Still>();
  const auto problem = std::make_shared<ShootingProblem>(Eigen::VectorXd::Ones(1), std::vector<NodePtr>(2, node), node);
  SolverFDDP solver(problem);
  problem->calc(Vectors(3, Eigen::VectorXd::Ones(1)), Vectors(2, Eigen::VectorXd(0)));
  EXPECT_EQ(solver.computeInequalityFeasibility(), 1);  // the last node's: g = [1; 2], bounds 0.5 and 1
  EXPECT_EQ(solver.computeEqualityFeasibility(), 3);
  solver.set_feasnorm(L1);
  EXPECT_EQ(solver.computeInequalityFeasibility(), 1.5);  // g = 1 in the others is within -5 and 5
  EXPECT_EQ(solver.computeEqualityFeasibility(), 3);
}

TEST(Feasibility, IsNotANumberWhereAConstraintIsNot) {
  const NodePtr node = std::make_shared<Still>(), bad = std::make_shared<Still>(NAN);
  for (const std::vector<NodePtr>& nodes : {std::vector<NodePtr>{bad, node, node}, {node, bad, node}}) {
    const auto problem = std::make_shared<ShootingProblem>(Eigen::VectorXd::Ones(1), nodes, node);
    SolverFDDP solver(problem);
    problem->calc(Vectors(4, Eigen::VectorXd::Ones(1)), Vectors(3, Eigen::VectorXd(0)));
    for (const FeasibilityNorm norm : {LInf, L1}) {
      solver.set_feasnorm(norm);
      EXPECT_TRUE(std::isnan(solver.computeInequalityFeasibility()));
    }
  }
  const auto problem = std::make_shared<ShootingProblem>(Eigen::VectorXd::Ones(1), std::vector<NodePtr>{node}, bad);
  SolverFDDP solver(problem);
  problem->calc(Vectors(2, Eigen::VectorXd::Ones(1)), Vectors(1, Eigen::VectorXd(0)));
  EXPECT_TRUE(std::isnan(solver.computeEqualityFeasibility()));
}

// In a node of one part only the part's data store matrices.
TEST(KktResidual, OfOnePartIsThatOfItsNodes) {
  const auto own = std::make_shared<ActionModelUnicycle>();
  const auto parts = std::make_shared<ActionModelParts>(own->get_state(), 2,
                                                        std::vector<ActionPart>{{own, {2, 0, 1}, {2, 0, 1}, {1, 0}}});
  parts->set_storage(MatrixStorage::kSparse);
  const Eigen::Vector3d x0(-1, -1, 1);
  ShootingProblem plain(x0, std::vector<NodePtr>(4, own), own);
  ShootingProblem of_part(Eigen::Vector3d(-1, 1, -1), std::vector<NodePtr>(4, parts), parts);
  std::mt19937 rng(8);
  Vectors xs, us, l, part_xs, part_us, part_l;
  for (int t = 0; t <= 4; ++t) {
    xs.push_back(random_vector(3, rng)), l.push_back(random_vector(3, rng));
    part_xs.push_back(xs.back()({1, 2, 0})), part_l.push_back(l.back()({1, 2, 0}));
    if (t == 4) break;
    us.push_back(random_vector(2, rng));
    part_us.push_back(us.back()({1, 0}));
  }
  const double residual = kkt_residual(plain, xs, us, l, false);
  EXPECT_GT(residual, 0.1);
  EXPECT_EQ(kkt_residual(of_part, part_xs, part_us, part_l, false), residual);
}

TEST(AugmentedLagrangian, RefusesANodeWhoseDataHoldNoMatrices) {
  class Bounded : public ActionModelUnicycle {
   public:
    Bounded() { nh_ = nh_T_ = 1; }
  };
  const auto own = std::make_shared<Bounded>();
  const auto parts = std::make_shared<ActionModelParts>(own->get_state(), 2,
                                                        std::vector<ActionPart>{{own, {0, 1, 2}, {0, 1, 2}, {0, 1}}});
  parts->set_storage(MatrixStorage::kSparse);
  try {
    (void)ActionModelAugmentedLagrangian(parts).createData();
    ADD_FAILURE() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("kDense is expected"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace manycontact::test
