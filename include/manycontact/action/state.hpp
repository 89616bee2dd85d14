#pragma once
// The state x = [q; v] of a scene (nx = nq + nv), and tangent vectors dx = [dq; dv] (ndx = 2 nv), with dq in each
// joint's own child frame. Interfaces are those of Crocoddyl's classes. Wrong sizes throw std::invalid_argument.

#include "manycontact/action/multibody.hpp"

namespace manycontact {

/// Selects derivatives of a function with respect to its first argument, its second argument, or both arguments.
enum Jcomponent { both = 0, first = 1, second = 2 };
/// Selects whether a result is set, added, or subtracted.
enum AssignmentOp { setto, addto, rmfrom };

class StateAbstract {  // A manifold with differences and sums.
 public:
  StateAbstract(std::size_t nx, std::size_t ndx);  // sizes of a state and of a tangent vector
  virtual ~StateAbstract() = default;

  virtual Eigen::VectorXd zero() const = 0;  // the neutral state (nx)
  virtual Eigen::VectorXd rand() const = 0;  // a random state (nx)
  /// Computes dxout = x1 (-) x0.
  virtual void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const = 0;
  /// Computes xout = x (+) dx.
  virtual void integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef xout) const = 0;
  /// Computes Jfirst = d diff/dx0, Jsecond = d diff/dx1 (ndx x ndx). Matrices that are not requested remain unchanged.
  virtual void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
                     Jcomponent firstsecond = both) const = 0;
  /// Computes Jfirst = d integrate/dx and Jsecond = d integrate/d(dx). op: sets, adds or subtracts the derivatives.
  virtual void Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                          Jcomponent firstsecond = both, AssignmentOp op = setto) const = 0;
  /// Computes Jin (ndx rows) <- J Jin, with J the `first` or `second` derivative of Jintegrate.
  virtual void JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                                   Jcomponent firstsecond) const = 0;

  Eigen::VectorXd diff_dx(const ConstVectorRef& x0, const ConstVectorRef& x1) const;     // the result of diff
  Eigen::VectorXd integrate_x(const ConstVectorRef& x, const ConstVectorRef& dx) const;  // the result of integrate
  /// Returns the results of Jdiff.
  std::vector<Eigen::MatrixXd> Jdiff_Js(const ConstVectorRef& x0, const ConstVectorRef& x1,
                                        Jcomponent firstsecond = both) const;
  /// Returns the results of Jintegrate.
  std::vector<Eigen::MatrixXd> Jintegrate_Js(const ConstVectorRef& x, const ConstVectorRef& dx,
                                             Jcomponent firstsecond = both) const;

  std::size_t get_nx() const { return nx_; }             // size of a state
  std::size_t get_ndx() const { return ndx_; }           // size of a tangent vector
  std::size_t get_nq() const { return nq_; }             // size of a configuration
  std::size_t get_nv() const { return nv_; }             // number of velocity coordinates
  const Eigen::VectorXd& get_lb() const { return lb_; }  // lower bounds
  const Eigen::VectorXd& get_ub() const { return ub_; }  // upper bounds
  bool get_has_limits() const { return has_limits_; }    // whether any bound is finite
  void set_lb(const Eigen::VectorXd& lb);                // throws std::invalid_argument for a wrong size
  void set_ub(const Eigen::VectorXd& ub);                // throws std::invalid_argument for a wrong size

 protected:
  void update_has_limits();  // called after the bounds have changed
  std::size_t nx_, ndx_, nq_, nv_;
  Eigen::VectorXd lb_, ub_;  // nx
  bool has_limits_ = false;
};

/// Returns whether parts made for state a can be used with state b: a and b are one object, or have the same Multibody.
bool same_space(const StateAbstract& a, const StateAbstract& b);

class StateMultibody : public StateAbstract {  // The state x = [q; v] of a scene.
 public:
  /// The bounds are the joint and velocity limits of the robots' URDF files, infinite for joints without limits.
  explicit StateMultibody(std::shared_ptr<const Multibody> model);
  /// Makes the state of the robots of a scene.
  explicit StateMultibody(const Scene& scene) : StateMultibody(std::make_shared<const Multibody>(scene)) {}
  /// Makes the state of a single robot.
  explicit StateMultibody(std::shared_ptr<const Model> model)
      : StateMultibody(std::make_shared<const Multibody>(std::move(model))) {}

  Eigen::VectorXd zero() const override;
  /// Returns a random state. q is within the joints' limits if these are finite, else within +-pi (+-1 m), with any
  /// orientation; v is within +-1.
  Eigen::VectorXd rand() const override;
  void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const override;
  void integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef xout) const override;
  void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
             Jcomponent firstsecond = both) const override;
  void Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                  Jcomponent firstsecond = both, AssignmentOp op = setto) const override;
  void JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                           Jcomponent firstsecond) const override;

  const std::shared_ptr<const Multibody>& get_pinocchio() const { return model_; }  // the robots; Crocoddyl's name
  const std::shared_ptr<const Multibody>& get_model() const { return model_; }      // the robots

 private:
  std::shared_ptr<const Multibody> model_;
};

}  // namespace manycontact
