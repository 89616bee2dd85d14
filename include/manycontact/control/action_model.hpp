#pragma once
// A node of an optimal control problem in discrete time,
//
//     x' = f(x, u),    cost l(x, u),    g_lb <= g(x, u) <= g_ub,    h(x, u) = 0,
//
// or a terminal node, where everything depends on x alone. The interface is that of Crocoddyl's ActionModelAbstract.
// Derivatives are on the tangent space: Fx = d(f (-) f)/dx is ndx x ndx.

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

class ActionModelAbstract;

struct WithoutMatrices {};

/// The results of a node. Sizes are those of the model.
struct ActionDataAbstract {
  explicit ActionDataAbstract(const ActionModelAbstract* model);  // allocates the data of the model
  /// Leaves the derivatives empty, for data that store them elsewhere.
  ActionDataAbstract(const ActionModelAbstract* model, WithoutMatrices);
  virtual ~ActionDataAbstract() = default;

  double cost = 0;                // set by calc
  Eigen::VectorXd xnext;          // nx: set by calc
  Eigen::MatrixXd Fx, Fu;         // ndx x ndx, ndx x nu: set by calcDiff
  Eigen::VectorXd r;              // nr: set by calc
  Eigen::VectorXd Lx, Lu;         // ndx, nu: set by calcDiff
  Eigen::MatrixXd Lxx, Lxu, Luu;  // ndx x ndx, ndx x nu, nu x nu: set by calcDiff
  Eigen::VectorXd g, h;           // ng, nh (in a terminal node ng_T, nh_T): set by calc
  Eigen::MatrixXd Gx, Gu;         // ng x ndx, ng x nu: set by calcDiff
  Eigen::MatrixXd Hx, Hu;         // nh x ndx, nh x nu: set by calcDiff

  /// False if the derivatives are stored in another form, and the matrices above are empty. This applies to
  /// IntegratedActionModelEuler with storage kPanel, and to ActionModelParts with kSparse.
  virtual bool has_matrices() const { return true; }
  /// Computes gx = Fx^T p and gu = Fu^T p for p with ndx entries, or copies Fx and Fu, as of the last calcDiff. They
  /// throw std::logic_error if only the subproblems' data contain derivatives.
  virtual void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const;
  virtual void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

 protected:
  void allocate_matrices(const ActionModelAbstract* model);  // allocates the derivatives
};

class ActionModelAbstract {  // A node in discrete time.
 public:
  using Scalar = double;
  using MathBase = manycontact::MathBase;
  using VectorXs = MathBase::VectorXs;
  using MatrixXs = MathBase::MatrixXs;
  using StateAbstract = manycontact::StateAbstract;
  using ActionDataAbstract = manycontact::ActionDataAbstract;

  /// Throws std::invalid_argument for null pointers and numbers out of range.
  ActionModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr = 0, std::size_t ng = 0,
                      std::size_t nh = 0, std::size_t ng_T = 0, std::size_t nh_T = 0);
  virtual ~ActionModelAbstract() = default;

  /// Computes the next state, cost and constraints. x: nx, u: nu. Throws std::invalid_argument for wrong sizes.
  virtual void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Computes cost and constraints of a terminal node, with xnext = x.
  virtual void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x);
  /// Computes the derivatives at the last calc. x, u: as in calc.
  virtual void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u) = 0;
  virtual void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x);
  virtual std::shared_ptr<ActionDataAbstract> createData();
  virtual bool checkData(const std::shared_ptr<ActionDataAbstract>& data);

  /// Computes controls u (nu) that keep x at rest. By default it makes Gauss-Newton steps on xnext (-) x: at most
  /// maxiter, until one is shorter than tol.
  virtual void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                           std::size_t maxiter = 100, double tol = 1e-9);
  Eigen::VectorXd quasiStatic_x(const std::shared_ptr<ActionDataAbstract>& data, const Eigen::VectorXd& x,
                                std::size_t maxiter = 100, double tol = 1e-9);
  virtual void print(std::ostream& os) const;

  std::size_t get_nu() const { return nu_; }              // number of controls
  virtual std::size_t get_nr() const { return nr_; }      // number of rows of the residual
  virtual std::size_t get_ng() const { return ng_; }      // number of inequality constraints
  virtual std::size_t get_nh() const { return nh_; }      // number of equality constraints
  virtual std::size_t get_ng_T() const { return ng_T_; }  // number of inequality constraints in a terminal node
  virtual std::size_t get_nh_T() const { return nh_T_; }  // number of equality constraints in a terminal node
  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }  // the state that it was made for
  virtual const Eigen::VectorXd& get_g_lb() const { return g_lb_; }           // lower bounds of g
  virtual const Eigen::VectorXd& get_g_ub() const { return g_ub_; }           // upper bounds of g
  /// Bounds of g in a terminal node.
  virtual const Eigen::VectorXd& get_g_lb_T() const { return get_g_lb(); }
  virtual const Eigen::VectorXd& get_g_ub_T() const { return get_g_ub(); }  // upper bounds of g in a terminal node
  const Eigen::VectorXd& get_u_lb() const { return u_lb_; }                 // lower limits of controls; infinite: none
  const Eigen::VectorXd& get_u_ub() const { return u_ub_; }                 // upper limits of controls; infinite: none
  bool get_has_control_limits() const { return has_control_limits_; }       // whether any limit of controls is finite
  /// They throw std::invalid_argument for a wrong size: max(ng, ng_T), or nu.
  virtual void set_g_lb(const Eigen::VectorXd& g_lb);
  virtual void set_g_ub(const Eigen::VectorXd& g_ub);  // throws std::invalid_argument for a wrong size
  void set_u_lb(const Eigen::VectorXd& u_lb);          // throws std::invalid_argument for a wrong size
  void set_u_ub(const Eigen::VectorXd& u_ub);          // throws std::invalid_argument for a wrong size

 protected:
  /// Throw std::invalid_argument "where: x has 3 numbers, 7 expected".
  void check(const char* where, const ConstVectorRef& x) const;
  /// Throws std::invalid_argument for wrong sizes of x and u.
  void check(const char* where, const ConstVectorRef& x, const ConstVectorRef& u) const;
  void update_has_control_limits();  // called after the bounds have changed
  std::size_t nu_, nr_, ng_, nh_, ng_T_, nh_T_;
  std::shared_ptr<StateAbstract> state_;
  Eigen::VectorXd unone_, g_lb_, g_ub_, u_lb_, u_ub_;
  bool has_control_limits_ = false;
};
std::ostream& operator<<(std::ostream& os, const ActionModelAbstract& model);  // prints it as `print` does

}  // namespace manycontact
