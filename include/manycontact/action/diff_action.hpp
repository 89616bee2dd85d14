#pragma once
// The interface of Crocoddyl's DifferentialActionModelAbstract: continuous dynamics, cost and constraints of one node.

#include "manycontact/action/state.hpp"
#include "manycontact/detail/action/cost_derivatives.hpp"

namespace manycontact {

class DifferentialActionModelAbstract;

/// The results of a node. Depending on the storage, dense or sparse matrices may be empty.
struct DifferentialActionDataAbstract : CostDerivatives {
  DifferentialActionDataAbstract() = default;  // allocates nothing
  /// Allocates the data of the model.
  explicit DifferentialActionDataAbstract(const DifferentialActionModelAbstract* model);
  virtual ~DifferentialActionDataAbstract() = default;

  double cost = 0;         // set by calc
  Eigen::VectorXd xout;    // nv: accelerations, set by calc(data, x, u)
  Eigen::MatrixXd Fx, Fu;  // nv x ndx, nv x nu: set by calcDiff(data, x, u)
  Eigen::VectorXd r;       // nr: residuals of the active costs, stacked in the order of their names
  Eigen::VectorXd g, h;    // ng, nh: set by calc; equality constraints are h = 0
  Eigen::MatrixXd Gx, Gu;  // ng x ndx, ng x nu
  Eigen::MatrixXd Hx, Hu;  // nh x ndx, nh x nu

  PanelView panel{nullptr, 0, 0, Eigen::OuterStride<>(0)};  // row-major [Fx Fu] for storage kPanel: set by calcDiff

  BlockSparse Fx_blocks, Fu_blocks, Gx_blocks, Gu_blocks, Hx_blocks, Hu_blocks;
  const Eigen::SparseMatrix<double>& Fx_sparse() const { return Fx_blocks.matrix; }    // Fx as a sparse matrix
  const Eigen::SparseMatrix<double>& Fu_sparse() const { return Fu_blocks.matrix; }    // Fu as a sparse matrix
  const Eigen::SparseMatrix<double>& Lxx_sparse() const { return Lxx_blocks.matrix; }  // Lxx as a sparse matrix
  const Eigen::SparseMatrix<double>& Lxu_sparse() const { return Lxu_blocks.matrix; }  // Lxu as a sparse matrix
  const Eigen::SparseMatrix<double>& Luu_sparse() const { return Luu_blocks.matrix; }  // Luu as a sparse matrix
  const Eigen::SparseMatrix<double>& Gx_sparse() const { return Gx_blocks.matrix; }    // Gx as a sparse matrix
  const Eigen::SparseMatrix<double>& Gu_sparse() const { return Gu_blocks.matrix; }    // Gu as a sparse matrix
  const Eigen::SparseMatrix<double>& Hx_sparse() const { return Hx_blocks.matrix; }    // Hx as a sparse matrix
  const Eigen::SparseMatrix<double>& Hu_sparse() const { return Hu_blocks.matrix; }    // Hu as a sparse matrix
};

/// The sizes and bounds of a node, in continuous or in discrete time.
class NodeAbstract : public Printable {
 public:
  using Scalar = double;
  using MathBase = manycontact::MathBase;
  using VectorXs = MathBase::VectorXs;
  using MatrixXs = MathBase::MatrixXs;
  using StateAbstract = manycontact::StateAbstract;

  void print(std::ostream& os) const override;  // prints type and sizes

  std::size_t get_nu() const { return nu_; }                                              // number of controls
  virtual std::size_t get_nr() const { return sized_by() ? sized_by()->get_nr() : nr_; }  // rows of the residual
  virtual std::size_t get_ng() const { return sized_by() ? sized_by()->get_ng() : ng_; }  // inequality constraints
  virtual std::size_t get_nh() const { return sized_by() ? sized_by()->get_nh() : nh_; }  // equality constraints
  virtual std::size_t get_ng_T() const { return sized_by() ? sized_by()->get_ng_T() : ng_T_; }  // ng, terminal node
  virtual std::size_t get_nh_T() const { return sized_by() ? sized_by()->get_nh_T() : nh_T_; }  // nh, terminal node
  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }  // the state given to the constructor

  /// Return the lower and upper bounds of g in a running node (ng). The functions with _T return those in a terminal
  /// node (ng_T).
  virtual const Eigen::VectorXd& get_g_lb() const { return sized_by() ? sized_by()->get_g_lb() : g_lb_; }
  virtual const Eigen::VectorXd& get_g_ub() const { return sized_by() ? sized_by()->get_g_ub() : g_ub_; }
  virtual const Eigen::VectorXd& get_g_lb_T() const { return sized_by() ? sized_by()->get_g_lb_T() : get_g_lb(); }
  virtual const Eigen::VectorXd& get_g_ub_T() const { return sized_by() ? sized_by()->get_g_ub_T() : get_g_ub(); }

  const Eigen::VectorXd& get_u_lb() const { return u_lb_; }            // lower limits of controls; may be infinite
  const Eigen::VectorXd& get_u_ub() const { return u_ub_; }            // upper limits of controls; may be infinite
  bool get_has_control_limits() const { return has_control_limits_; }  // whether any limit of controls is finite
  /// Set bounds of g (max(ng, ng_T)) or limits of controls (nu). Wrong sizes throw std::invalid_argument.
  virtual void set_g_lb(const Eigen::VectorXd& g_lb);
  virtual void set_g_ub(const Eigen::VectorXd& g_ub);  // throws std::invalid_argument for a wrong size
  void set_u_lb(const Eigen::VectorXd& u_lb);          // throws std::invalid_argument for a wrong size
  void set_u_ub(const Eigen::VectorXd& u_ub);          // throws std::invalid_argument for a wrong size

 protected:
  /// kind: the name that is printed. Throws std::invalid_argument for a null pointer.
  NodeAbstract(const char* kind, std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr, std::size_t ng,
               std::size_t nh, std::size_t ng_T, std::size_t nh_T);
  /// Returns the wrapped node, whose sizes and bounds of g become those of this node; null if there is none.
  virtual const NodeAbstract* sized_by() const { return nullptr; }
  void update_has_control_limits();  // called after the bounds have changed
  /// Throws std::invalid_argument "name::function: ..." for wrong sizes of x, and of u unless u is null.
  void check_sizes(const char* name, const char* function, const ConstVectorRef& x, const ConstVectorRef* u) const;
  const char* kind_;
  std::size_t nu_, nr_, ng_, nh_, ng_T_, nh_T_;  // arguments of the constructor; overridden getters may differ
  std::shared_ptr<StateAbstract> state_;
  Eigen::VectorXd g_lb_, g_ub_, u_lb_, u_ub_, unone_;
  bool has_control_limits_ = false;
};

/// The functions of a node, in continuous or in discrete time, whose data are of class Data.
template <class Data>
class NodeOf : public NodeAbstract {
 public:
  using DataPtr = std::shared_ptr<Data>;

  /// Computes accelerations or next state, cost and constraints at x, u. Wrong sizes throw std::invalid_argument.
  virtual void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;
  /// Computes cost and constraints of a terminal node, which depend on the state alone; its next state is x.
  virtual void calc(const DataPtr& data, const ConstVectorRef& x) { calc(data, x, unone_); }

  /// Computes the derivatives at the last calc. x, u: as in calc.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;
  /// Computes the derivatives of a terminal node at the last calc.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x) { calcDiff(data, x, unone_); }

  virtual DataPtr createData() = 0;                                        // creates data; each thread needs its own
  virtual bool checkData(const DataPtr& data) { return data != nullptr; }  // whether this model created the data

  /// Computes controls u (nu) that keep x at rest; in continuous time v must be 0. The default makes at most maxiter
  /// Gauss-Newton steps from u = 0, which minimise |xout|, or |xnext (-) x| in discrete time. The first step that
  /// is not longer than tol is the last.
  virtual void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                           double tol = 1e-9) = 0;
  /// Returns the controls that quasiStatic computes.
  Eigen::VectorXd quasiStatic_x(const DataPtr& data, const Eigen::VectorXd& x, std::size_t maxiter = 100,
                                double tol = 1e-9) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(nu_);
    quasiStatic(data, u, x, maxiter, tol);
    return u;
  }

 protected:
  using NodeAbstract::NodeAbstract;
};

/// A node of this library with data of class Data. Derived classes implement evaluate and differentiate for running and
/// for terminal nodes (u is null). Model: the derived class, with its name kName for messages. Base: a class of nodes.
template <class Model, class Base, class Data>
class NodeWithData : public Base {
 public:
  using DataPtr = typename Base::DataPtr;

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    evaluate(own("calc", data, x, &u), x, &u);
  }
  void calc(const DataPtr& data, const ConstVectorRef& x) override { evaluate(own("calc", data, x), x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    differentiate(own("calcDiff", data, x, &u), x, &u);
  }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override {
    differentiate(own("calcDiff", data, x), x, nullptr);
  }
  DataPtr createData() override { return std::make_shared<Data>(static_cast<Model*>(this)); }
  bool checkData(const DataPtr& data) override { return dynamic_cast<Data*>(data.get()) && Base::checkData(data); }
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override {
    const ConstVectorRef given = u;
    (void)own("quasiStatic", data, x, &given);
    Base::quasiStatic(data, u, x, maxiter, tol);
  }

 protected:
  using Base::Base;
  /// Returns the data as Data. Throws std::invalid_argument for data of another model, and for wrong sizes of x and u.
  Data& own(const char* function, const DataPtr& data, const ConstVectorRef& x,
            const ConstVectorRef* u = nullptr) const {
    this->check_sizes(Model::kName, function, x, u);
    Data* own = dynamic_cast<Data*>(data.get());
    return own ? *own : internal::own_data<Data>((std::string(Model::kName) + "::" + function).c_str(), data);
  }

 private:
  /// Compute the results of calc and of calcDiff; u is null in a terminal node.
  virtual void evaluate(Data& data, const ConstVectorRef& x, const ConstVectorRef* u) = 0;
  virtual void differentiate(Data& data, const ConstVectorRef& x, const ConstVectorRef* u) = 0;
};

class DifferentialActionModelAbstract : public NodeOf<DifferentialActionDataAbstract> {  // A node in continuous time.
 public:
  using DifferentialActionDataAbstract = manycontact::DifferentialActionDataAbstract;

  /// Throws std::invalid_argument for null pointers and numbers out of range.
  DifferentialActionModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr = 0,
                                  std::size_t ng = 0, std::size_t nh = 0)
      : NodeOf("DifferentialActionModel", std::move(state), nu, nr, ng, nh, ng, nh) {}

  DataPtr createData() override { return std::make_shared<DifferentialActionDataAbstract>(this); }
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;

  std::size_t get_ng_T() const override { return sized_by() ? NodeAbstract::get_ng_T() : get_ng(); }
  std::size_t get_nh_T() const override { return sized_by() ? NodeAbstract::get_nh_T() : get_nh(); }
  MatrixStorage get_storage() const { return storage_; }  // the kind of matrices that data created afterwards contain
  void set_storage(MatrixStorage storage) { storage_ = storage; }  // affects data created afterwards

 protected:
  MatrixStorage storage_ = MatrixStorage::kBoth;
};

}  // namespace manycontact
