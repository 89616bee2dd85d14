#pragma once
// StateVector describes states in a vector space, x (+) dx = x + dx with nx = ndx. The name is Crocoddyl's.

#include "manycontact/action/state.hpp"

namespace manycontact {

class StateVector : public StateAbstract {  // States that form a vector space.
 public:
  explicit StateVector(std::size_t nx) : StateAbstract(nx, nx) {}  // number of coordinates

  Eigen::VectorXd zero() const override { return Eigen::VectorXd::Zero(nx_); }
  /// Returns a random state with entries between -1 and 1.
  Eigen::VectorXd rand() const override;
  void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const override;
  void integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef xout) const override;
  void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
             Jcomponent firstsecond = both) const override;
  void Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                  Jcomponent firstsecond = both, AssignmentOp op = setto) const override;
  void JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                           Jcomponent firstsecond) const override;
};

}  // namespace manycontact
