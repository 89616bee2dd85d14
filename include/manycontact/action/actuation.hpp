#pragma once
// Actuations tau(x, u), which convert controls to torques on the velocity coordinates. The interface is that of
// Crocoddyl's ActuationModelAbstract. Matrices are sparse, because dense matrices of many robots would be too large.

#include <Eigen/SparseCore>

#include "manycontact/action/state.hpp"

namespace manycontact {

class ActuationModelAbstract;

/// A sparse matrix that code written for Crocoddyl can read and write like a dense matrix.
class ActuationMatrix : public Eigen::SparseMatrix<double> {
 public:
  using Base = Eigen::SparseMatrix<double>;
  using Base::Base;
  template <class D>
  ActuationMatrix& operator=(const Eigen::SparseMatrixBase<D>& other) {
    Base::operator=(other.derived());
    return *this;
  }
  template <class D>
  ActuationMatrix& operator=(const Eigen::MatrixBase<D>& dense) {
    Base::operator=(dense.derived().sparseView());
    return *this;
  }
  double& operator()(Eigen::Index i, Eigen::Index j) { return coeffRef(i, j); }    // creates the entry
  double operator()(Eigen::Index i, Eigen::Index j) const { return coeff(i, j); }  // entry (i, j); 0 if not stored
  /// Returns whether all entries are zero.
  bool isZero(double precision = Eigen::NumTraits<double>::dummy_precision()) const {
    return Eigen::MatrixXd(*this).isZero(precision);
  }
  /// Returns a - b as a dense matrix.
  friend Eigen::MatrixXd operator-(const ActuationMatrix& a, const ActuationMatrix& b) {
    return Eigen::MatrixXd(a) - Eigen::MatrixXd(b);
  }
};

struct ActuationDataAbstract {                                          // The torques tau and their derivatives.
  explicit ActuationDataAbstract(const ActuationModelAbstract* model);  // allocates the data of the model
  virtual ~ActuationDataAbstract() = default;

  Eigen::VectorXd tau;        // nv: set by calc
  Eigen::VectorXd u;          // nu: set by commands
  ActuationMatrix dtau_dx;    // nv x ndx: set by calcDiff
  ActuationMatrix dtau_du;    // nv x nu: set by calcDiff
  ActuationMatrix Mtau;       // nu x nv: set by torqueTransform
  std::vector<bool> tau_set;  // nv: whether a coordinate is actuated
};

class ActuationModelAbstract : public Printable {  // A function tau(x, u): the torques on all velocity coordinates.
 public:
  using DataPtr = std::shared_ptr<ActuationDataAbstract>;

  /// Throws std::invalid_argument for a state of another kind.
  ActuationModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu);

  /// Computes data->tau (nv) from x (nx) and u (nu).
  virtual void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;
  virtual void calc(const DataPtr&, const ConstVectorRef&) {}  // for a terminal node: does nothing
  /// Computes data->dtau_dx and data->dtau_du.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;
  virtual void calcDiff(const DataPtr&, const ConstVectorRef&) {}
  /// Computes data->u, the controls whose torques are nearest to tau (nv).
  virtual void commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) = 0;
  /// Computes data->Mtau in u = Mtau tau: by default the pseudoinverse of dtau_du, after calcDiff at (x, u).
  virtual void torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u);
  virtual std::shared_ptr<ActuationDataAbstract> createData() { return std::make_shared<ActuationDataAbstract>(this); }

  /// Returns for each control (nu) the velocity coordinate whose torque it is; empty for other kinds of actuations.
  /// With a selection, derivatives with respect to u are computed without a matrix product.
  virtual const std::vector<int>& selection() const { return selection_; }

  std::size_t get_nu() const { return nu_; }                                  // number of controls
  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }  // the state given to the constructor
  void print(std::ostream& os) const override { os << "ActuationModelAbstract {nu=" << nu_ << "}"; }

 protected:
  /// Throws std::invalid_argument for wrong sizes of x and u.
  void check(const char* where, const ConstVectorRef& x, const ConstVectorRef& u) const;
  std::size_t nu_;
  std::shared_ptr<StateAbstract> state_;
  std::vector<int> selection_;
};

/// Controls are torques of selected coordinates. If a derived class overrides calc or calcDiff, selection() is empty.
class ActuationModelSelection : public ActuationModelAbstract {
 public:
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  void commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) override;
  void torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  const std::vector<int>& selection() const override;
  void print(std::ostream& os) const override { os << name_ << " {nu=" << nu_ << "}"; }

 protected:
  /// selection: the actuated coordinates.
  ActuationModelSelection(std::shared_ptr<StateAbstract> state, std::vector<int> selection, std::string name);
  std::string name_;
};

/// Actuates every coordinate, floating bases and passive joints included: nu = nv.
class ActuationModelFull : public ActuationModelSelection {
 public:
  /// Throws std::invalid_argument for a state of another kind.
  explicit ActuationModelFull(std::shared_ptr<StateAbstract> state);
};

/// Actuates all coordinates except those of floating bases and passive joints, like the torques u of `solve`.
class ActuationModelFloatingBase : public ActuationModelSelection {
 public:
  /// Throws std::invalid_argument for a state of another kind.
  explicit ActuationModelFloatingBase(std::shared_ptr<StateMultibody> state);
};

}  // namespace manycontact
