#pragma once
// A floating base with thrusters, as in a multicopter: u = [thrusts; torques of the actuated joints]. Names and
// interface are those of Crocoddyl's ActuationModelFloatingBaseThrusters.

#include "manycontact/action/actuation.hpp"

namespace manycontact {

/// The direction of rotation of a propeller. CW causes a torque along the thrust, CCW a torque against the thrust.
enum ThrusterType { CW = 0, CCW };

/// A propeller on the base.
struct Thruster {
  /// at: placement on the base. torque: torque per thrust [m]. min, max: bounds of the thrust [N].
  Thruster(const SE3<double>& at, double torque, ThrusterType turning = CW, double min = 0,
           double max = std::numeric_limits<double>::infinity())
      : pose(at), ctorque(torque), type(turning), min_thrust(min), max_thrust(max) {}
  /// torque: torque per thrust [m]. min, max: bounds of the thrust [N].
  explicit Thruster(double torque = 0, ThrusterType turning = CW, double min = 0,
                    double max = std::numeric_limits<double>::infinity())
      : Thruster(SE3<double>{}, torque, turning, min, max) {}

  SE3<double> pose;  // placement in the base's frame; the thrust is along its z axis
  double ctorque;    // torque about that axis per thrust [m]
  ThrusterType type;
  double min_thrust, max_thrust;  // N: bounds of u; the user must set them as control limits of action models
};
std::ostream& operator<<(std::ostream& os, const Thruster& thruster);  // prints the thruster

/// The torques tau = W u of a floating base with thrusters.
class ActuationModelFloatingBaseThrusters : public ActuationModelAbstract {
 public:
  /// Throws std::invalid_argument unless the state has one robot with a floating base.
  ActuationModelFloatingBaseThrusters(std::shared_ptr<StateMultibody> state, const std::vector<Thruster>& thrusters);
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  /// Computes the controls u that minimise |W u - tau|, and among these the u of least norm.
  void commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) override;
  void torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  void print(std::ostream& os) const override;

  const std::vector<Thruster>& get_thrusters() const { return thrusters_; }  // the propellers
  std::size_t get_nthrusters() const { return thrusters_.size(); }           // number of propellers
  /// Replaces the thrusters; their number must not change. Existing data are updated at their next use.
  void set_thrusters(const std::vector<Thruster>& thrusters);
  const Eigen::MatrixXd& get_Wthrust() const { return W_; }  // nv x nu: tau = W u
  const Eigen::MatrixXd& get_S() const { return S_; }        // nv x nv: W times its pseudoinverse

 private:
  void update(ActuationDataAbstract& data) const;
  std::vector<Thruster> thrusters_;
  Eigen::MatrixXd W_, Mtau_, S_;
};

}  // namespace manycontact
