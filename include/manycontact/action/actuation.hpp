#pragma once
// tau(x, u): how controls become torques on the velocity coordinates. Interface of Crocoddyl's ActuationModelAbstract;
// the matrices are sparse, so that a scene of many robots does not pay n^2.

#include <Eigen/SparseCore>

#include "manycontact/action/state.hpp"

namespace manycontact {

class ActuationModelAbstract;

/// A sparse matrix that reads and is written as a dense one where an actuation written for Crocoddyl does so.
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
  double& operator()(Eigen::Index i, Eigen::Index j) { return coeffRef(i, j); }  // there is an entry from then on
  double operator()(Eigen::Index i, Eigen::Index j) const { return coeff(i, j); }
  bool isZero(double precision = Eigen::NumTraits<double>::dummy_precision()) const {
    return Eigen::MatrixXd(*this).isZero(precision);
  }
  friend Eigen::MatrixXd operator-(const ActuationMatrix& a, const ActuationMatrix& b) {
    return Eigen::MatrixXd(a) - Eigen::MatrixXd(b);
  }
};

struct ActuationDataAbstract {  // tau and its derivatives
  explicit ActuationDataAbstract(const ActuationModelAbstract* model);
  virtual ~ActuationDataAbstract() = default;

  Eigen::VectorXd tau;        // nv: by calc
  Eigen::VectorXd u;          // nu: by commands
  ActuationMatrix dtau_dx;    // nv x ndx: by calcDiff
  ActuationMatrix dtau_du;    // nv x nu: by calcDiff
  ActuationMatrix Mtau;       // nu x nv: by torqueTransform
  std::vector<bool> tau_set;  // nv: actuated coordinates
};

class ActuationModelAbstract {  // tau(x, u): torques on all coordinates
 public:
  ActuationModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu);
  virtual ~ActuationModelAbstract() = default;

  /// data->tau.
  virtual void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Without control: nothing to do.
  virtual void calc(const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&) {}
  /// data->dtau_dx, dtau_du.
  virtual void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u) = 0;
  virtual void calcDiff(const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&) {}
  /// data->u: the controls that give tau where the actuation can.
  virtual void commands(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& tau) = 0;
  /// data->Mtau: u = Mtau tau. By default the pseudo-inverse of dtau_du at (x, u), which it computes.
  virtual void torqueTransform(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                               const ConstVectorRef& u);
  virtual std::shared_ptr<ActuationDataAbstract> createData() { return std::make_shared<ActuationDataAbstract>(this); }

  /// Where each control is the torque of one coordinate: that coordinate, for each of the nu; empty otherwise. Lets the
  /// derivatives be written in place without a product.
  virtual const std::vector<int>& selection() const { return selection_; }

  std::size_t get_nu() const { return nu_; }
  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  virtual void print(std::ostream& os) const;

 protected:
  void check(const char* where, const ConstVectorRef& x, const ConstVectorRef& u) const;
  std::size_t nu_;
  std::shared_ptr<StateAbstract> state_;
  std::vector<int> selection_;
};
std::ostream& operator<<(std::ostream& os, const ActuationModelAbstract& model);

/// u is the torque of a selection of coordinates. A class derived from it, or from those below, that has a calc or
/// calcDiff of its own is called as any actuation: its selection() is empty.
class ActuationModelSelection : public ActuationModelAbstract {
 public:
  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc;
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  using ActuationModelAbstract::calcDiff;
  void commands(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& tau) override;
  void torqueTransform(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                       const ConstVectorRef& u) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  const std::vector<int>& selection() const override;
  void print(std::ostream& os) const override;

 protected:
  ActuationModelSelection(std::shared_ptr<StateAbstract> state, std::vector<int> selection, std::string name);
  std::string name_;
};

/// Every coordinate, floating bases and passive joints included: nu = nv.
class ActuationModelFull : public ActuationModelSelection {
 public:
  explicit ActuationModelFull(std::shared_ptr<StateAbstract> state);
};

/// The actuated coordinates of every robot: all but floating bases and passive joints, the u of `solve`. All of them
/// where no robot has either.
class ActuationModelFloatingBase : public ActuationModelSelection {
 public:
  explicit ActuationModelFloatingBase(std::shared_ptr<StateMultibody> state);
};

}  // namespace manycontact
