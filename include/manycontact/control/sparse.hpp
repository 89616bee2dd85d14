#pragma once
// FDDP on a problem whose nodes are ActionModelParts: robots that never meet have value functions of their own, so that
// the direction and the feedback gains are block diagonal,
//
//     Vxx = diag(Vxx_1, Vxx_2, ...),    u_i = us_i - s k_i - K_i (x_i (-) xs_i),
//
// at the cost of each part's backward pass: N T n^3 for N robots of n states, where SolverFDDP's is T (N n)^3. Steps,
// regularisation and stopping are those of the sums over the parts: iterates are SolverFDDP's on the whole problem, but
// for rounding; of one part they are the same bits. Parts are worked on in parallel, over the problem's threads; the
// numbers do not depend on how many. A part whose nodes are ActionModelJoined takes its directions by
// control/joined_solver.hpp, where gains differ.
//
// With limits the iterates are SolverBoxFDDP's: the box QP of a node is that of each part's controls, since Quu and the
// box are. (Each is solved to the tolerance that the whole is.)

#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/parts.hpp"

namespace manycontact {

/// A part's share: passes, gains, gradients. Without limits the Hessians (Vxx, Qxx, Qxu, Quu) are empty: of them only
/// the node at hand's are kept, which halves a node's memory.
class SolverSparsePart : public SolverFDDP {
 public:
  using Source = ShootingPart;
  const ShootingPart& part() const { return part_; }
  /// How its directions are found.
  virtual const char* direction() const { return "Riccati"; }
  /// Controls of the matrices Quu that are factorized at a node: the largest number over the nodes, of each matrix.
  virtual std::vector<int> blocks() const;

 protected:
  explicit SolverSparsePart(ShootingPart part) : SolverSparsePart(std::move(part), WithoutMatrices{}) {
    keeps_values_ = false;
    SolverFDDP::allocateData();
  }
  SolverSparsePart(ShootingPart part, WithoutMatrices none) : SolverFDDP(part.problem, none), part_(std::move(part)) {}

 private:
  friend class SolverSparse;
  ShootingPart part_;
  std::vector<Eigen::VectorXd> feed_forward_;  // its share of SolverSparse's
};

extern template class SolverWithBox<SolverSparsePart>;

/// Of what SolverDDP holds of the backward pass, get_Vx and get_k are the whole's; get_K, get_Vxx and the others are
/// empty: parts() have theirs.
class SolverSparse : public SolverFDDP {
 public:
  /// limits: controls stay within the models'. Throws std::invalid_argument where nodes differ in their parts (see
  /// `separate`), and for limits of ActionModelJoined without dense matrices (with them, parts that hold each other are
  /// one dense part, whose steps are SolverBoxFDDP's). A problem without ActionModelParts is one part.
  explicit SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits = false);

  double calcDiff() override;
  void backwardPass() override;
  void forwardPass(double steplength) override;
  const Eigen::Vector2d& expectedImprovement() override;
  /// Of every part; in the backward pass' order.
  void computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                  const std::shared_ptr<ActionDataAbstract>& data) override;
  void computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model) override;
  void computeGains(std::size_t t) override;
  void allocateData() override;
  bool keeps_limits() const override { return limits_; }
  double expectedReduction() const override;

  const std::vector<std::unique_ptr<SolverSparsePart>>& parts() const { return parts_; }
  /// Controls of each part (of one joined by bonds, of each cluster of it): the sizes of the matrices Quu that are
  /// factorized at a node.
  std::vector<int> blocks() const;
  /// How directions are found: "Riccati", or of parts that are joined by bonds lq::DirectionSolver's name.
  std::string direction() const;

 protected:
  void adoptScale() override;
  void prepareImprovement() override;
  void setFeedForward(const std::vector<Eigen::VectorXd>& nu) override;
  void computeFeedForwardGradient(std::vector<Eigen::VectorXd>& g) override;
  void preconditionFeedForward(std::vector<Eigen::VectorXd>& g) override;
  void holdFeedForward(std::vector<Eigen::VectorXd>& nu) override;

 private:
  void share_candidate();
  template <class Work>
  void each_feed_forward(std::vector<Eigen::VectorXd>& whole, Work&& work);
  template <class Work>
  void each_part(Work&& work);
  std::unique_ptr<SolverSparsePart> solver_of(ShootingPart part) const;
  bool limits_;
  std::vector<std::unique_ptr<SolverSparsePart>> parts_;
  std::vector<std::shared_ptr<ActionDataAbstract>> nodes_;  // that the parts were made of
  std::shared_ptr<ActionDataAbstract> terminal_;
};

}  // namespace manycontact
