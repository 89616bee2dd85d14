#pragma once
// The node of an optimal control problem in discrete time,
//
//     x' = f(x, u),    cost l(x, u),    g_lb <= g(x, u) <= g_ub,    h(x, u) = 0,
//
// and of a terminal node, where all depend on x alone. Interface of Crocoddyl's ActionModelAbstract. Derivatives are on
// the tangent space: Fx = d(f (-) f)/dx is ndx x ndx.

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

class ActionModelAbstract;

struct WithoutMatrices {};

/// Sizes in terms of the model.
struct ActionDataAbstract {
  explicit ActionDataAbstract(const ActionModelAbstract* model);
  /// Derivatives stay empty: for data that keep them elsewhere.
  ActionDataAbstract(const ActionModelAbstract* model, WithoutMatrices);
  virtual ~ActionDataAbstract() = default;

  double cost = 0;                // by calc
  Eigen::VectorXd xnext;          // nx: by calc
  Eigen::MatrixXd Fx, Fu;         // ndx x ndx, ndx x nu: by calcDiff
  Eigen::VectorXd r;              // nr: by calc
  Eigen::VectorXd Lx, Lu;         // ndx, nu: by calcDiff
  Eigen::MatrixXd Lxx, Lxu, Luu;  // ndx x ndx, ndx x nu, nu x nu: by calcDiff
  Eigen::VectorXd g, h;           // ng, nh (of a terminal node ng_T, nh_T): by calc
  Eigen::MatrixXd Gx, Gu;         // ng x ndx, ng x nu: by calcDiff
  Eigen::MatrixXd Hx, Hu;         // nh x ndx, nh x nu: by calcDiff

  /// False where the derivatives are kept in a shape of their own, and matrices above are empty: of
  /// IntegratedActionModelEuler with storage kPanel, of ActionModelParts with kSparse.
  virtual bool has_matrices() const { return true; }
  /// gx = Fx^T p, gu = Fu^T p for p of ndx numbers, and [Fx Fu] as matrices: of the last calcDiff. Throw
  /// std::logic_error where only the parts' data have derivatives.
  virtual void pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const;
  virtual void dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const;

 protected:
  void allocate_matrices(const ActionModelAbstract* model);
};

class ActionModelAbstract {  // a node in discrete time
 public:
  using Scalar = double;
  using MathBase = manycontact::MathBase;
  using VectorXs = MathBase::VectorXs;
  using MatrixXs = MathBase::MatrixXs;
  using StateAbstract = manycontact::StateAbstract;
  using ActionDataAbstract = manycontact::ActionDataAbstract;

  ActionModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr = 0, std::size_t ng = 0,
                      std::size_t nh = 0, std::size_t ng_T = 0, std::size_t nh_T = 0);
  virtual ~ActionModelAbstract() = default;

  /// Next state, cost and constraints.
  virtual void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Cost and constraints of a terminal node; xnext = x.
  virtual void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x);
  /// Derivatives at the last calc.
  virtual void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u) = 0;
  virtual void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x);
  virtual std::shared_ptr<ActionDataAbstract> createData();
  virtual bool checkData(const std::shared_ptr<ActionDataAbstract>& data);

  /// Controls that keep x still. By default Gauss-Newton on xnext (-) x: at most maxiter steps, until one is shorter
  /// than tol.
  virtual void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                           std::size_t maxiter = 100, double tol = 1e-9);
  Eigen::VectorXd quasiStatic_x(const std::shared_ptr<ActionDataAbstract>& data, const Eigen::VectorXd& x,
                                std::size_t maxiter = 100, double tol = 1e-9);
  virtual void print(std::ostream& os) const;

  std::size_t get_nu() const { return nu_; }
  virtual std::size_t get_nr() const { return nr_; }
  virtual std::size_t get_ng() const { return ng_; }
  virtual std::size_t get_nh() const { return nh_; }
  virtual std::size_t get_ng_T() const { return ng_T_; }
  virtual std::size_t get_nh_T() const { return nh_T_; }
  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  virtual const Eigen::VectorXd& get_g_lb() const { return g_lb_; }
  virtual const Eigen::VectorXd& get_g_ub() const { return g_ub_; }
  /// Of a terminal node's g.
  virtual const Eigen::VectorXd& get_g_lb_T() const { return get_g_lb(); }
  virtual const Eigen::VectorXd& get_g_ub_T() const { return get_g_ub(); }
  const Eigen::VectorXd& get_u_lb() const { return u_lb_; }
  const Eigen::VectorXd& get_u_ub() const { return u_ub_; }
  bool get_has_control_limits() const { return has_control_limits_; }
  /// Throw std::invalid_argument on a wrong size: max(ng, ng_T), nu.
  virtual void set_g_lb(const Eigen::VectorXd& g_lb);
  virtual void set_g_ub(const Eigen::VectorXd& g_ub);
  void set_u_lb(const Eigen::VectorXd& u_lb);
  void set_u_ub(const Eigen::VectorXd& u_ub);

 protected:
  /// Throw std::invalid_argument "where: x has 3 numbers, 7 expected".
  void check(const char* where, const ConstVectorRef& x) const;
  void check(const char* where, const ConstVectorRef& x, const ConstVectorRef& u) const;
  void update_has_control_limits();
  std::size_t nu_, nr_, ng_, nh_, ng_T_, nh_T_;
  std::shared_ptr<StateAbstract> state_;
  Eigen::VectorXd unone_, g_lb_, g_ub_, u_lb_, u_ub_;
  bool has_control_limits_ = false;
};
std::ostream& operator<<(std::ostream& os, const ActionModelAbstract& model);

}  // namespace manycontact
