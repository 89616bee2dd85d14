#pragma once
// A search direction of SolverDDP: the solution of the linear-quadratic problem around the candidate of a subproblem,
// with its feedback gains. Only SolverSparse has several subproblems. Solvers choose step length and regularisation.
//
//   RiccatiDirection   the recursion of ddp.hpp, on dense derivatives of nodes (control/riccati_direction.hpp)
//   BoxDirection       RiccatiDirection with the models' limits on controls
//   CoupledDirection   coupled robots, by an lq::DirectionSolver (control/coupled_direction.hpp)

#include "manycontact/detail/control/parts.hpp"

namespace manycontact {

class Direction {
 public:
  using Vectors = std::vector<Eigen::VectorXd>;

  virtual ~Direction() = default;
  const ShootingPart& part() const { return part_; }  // includes indices in the solver's x, dx, u
  const std::shared_ptr<ShootingProblem>& get_problem() const { return part_.problem; }
  virtual const char* name() const = 0;     // the name of the method
  virtual std::vector<int> blocks() const;  // sizes of the dense matrices factorized per node, largest of all nodes
  /// The feedback of some of the subproblem's coordinates: u = us - s k - K (x (-) xs) for a step of length s.
  struct Gains {
    std::vector<int> dx, u;  // indices among the solver's coordinates
    Eigen::MatrixXd K;
  };
  /// Returns the gains of node t, in which each control occurs once. Empty before a direction is computed.
  virtual std::vector<Gains> gains(std::size_t t) const = 0;

  /// get_Vx: gradients of the value function (T + 1). get_k: feed-forward terms (T), which a step s multiplies by -s.
  const Vectors& get_Vx() const { return Vx_; }
  const Vectors& get_k() const { return k_; }

  // ---- interface for the solvers

  /// resize allocates memory for the problem's nodes. follow replaces the subproblem by one with the same coordinates.
  virtual void resize();
  void follow(ShootingPart part) { part_ = std::move(part); }
  /// Copies the subproblem's share of the solver's candidate. fs: its gaps, which are ignored if is_feasible.
  void take_candidate(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& fs,
                      bool is_feasible);
  /// Computes Vx and k at the candidate. Returns false if numbers are not finite or the problem is not convex.
  virtual bool compute(double preg, double dreg) = 0;
  /// Computes trial states and controls. Returns the cost, or NaN if numbers are not finite. keep_gaps and
  /// keep_terminal_gap multiply the gaps of running nodes, or of the terminal node, by 1 - steplength. Other gaps
  /// close.
  double roll_out(double steplength, bool keep_gaps, bool keep_terminal_gap);
  /// Returns (dg, dq): a step s is expected to reduce the cost by s (dg + s dq / 2). gaps: includes gap terms.
  virtual Eigen::Vector2d improvement(bool gaps) = 0;
  virtual double gap_improvement() { return 0; }  // the term dv of fddp.cpp at the trial states
  virtual double expected_reduction() const = 0;  // cost reduction by a full step without gaps

  /// Functions for SolverDDP::descend. They set k = -nu, compute the gradient g at the trial controls from
  /// differentiated nodes, or replace g by H^-1 g, where H is the Gauss-Newton Hessian with respect to nu.
  virtual void set_feed_forward(const Vectors& nu);
  virtual void feed_forward_gradient(Vectors& g) = 0;
  virtual void precondition_feed_forward(Vectors& g) = 0;
  virtual void hold_feed_forward(Vectors&) {}  // zeroes entries whose controls were at a limit in the last gradient
  virtual void set_scale(double) {}            // sets the size of the cost, which multiplies thresholds

 protected:
  /// is_whole: whether the subproblem is the solver's whole problem, with its coordinates in the same order.
  Direction(ShootingPart part, bool is_whole) : part_(std::move(part)), is_whole_(is_whole) {}
  virtual void step_control(std::size_t t, double steplength) = 0;  // computes us_try[t] at xs_try[t]

  ShootingPart part_;
  Vectors xs_, us_, fs_, xs_try_, us_try_;  // the subproblem's share of the solver's candidate, and of the trial step
  bool is_feasible_ = false;
  Vectors Vx_, k_, dx_;        // Vx_ of all nodes (T + 1); k_ and dx_ of running nodes (T)
  Eigen::VectorXd step_;       // ndx: workspace
  bool held_changed_ = false;  // whether the last gradient has other controls at limits than the gradient before it

 private:
  friend class SolverDDP;
  using Vector = Eigen::VectorXd;
  void take(const Vector& whole, const std::vector<int>& index, Vector& own) const;
  void give(const Vector& own, const std::vector<int>& index, Vector& whole) const;
  void take_x(const Vector& whole, Vector& own) const { take(whole, part_.x, own); }
  void take_dx(const Vector& whole, Vector& own) const { take(whole, part_.dx, own); }
  void take_u(const Vectors& whole, Vectors& own) const;
  void give_x(const Vector& own, Vector& whole) const { give(own, part_.x, whole); }
  void give_dx(const Vector& own, Vector& whole) const { give(own, part_.dx, whole); }
  void give_u(const Vectors& own, Vectors& whole) const;
  bool is_whole_;
  Eigen::VectorXd xnext_;  // nx: workspace
  Vectors feed_forward_;   // the subproblem's share of the solver's feed-forward terms
  double cost_try_ = 0;
  bool is_sound_ = false;
};

}  // namespace manycontact
