#pragma once
// Accelerations of a scene whose contacts constrain velocities (control/symplectic.hpp). The dynamics are solved and
// differentiated at the state (q, s v) with gains (alpha, beta / s), so that J a + s^2 J' v = -beta J v - alpha e,
// where J' is the time derivative of J. With s = 2^-30 the term with J' v is below rounding errors, while beta J v is
// unchanged. The torques tau include the bias at v, as -ID(q, v, -w x v). ID is the inverse dynamics, and -w x v is the
// acceleration of a free body of angular velocity w and world-constant linear velocity, in its own axes.

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/simulation/momentum_derivatives.hpp"
#include "manycontact/simulation/resisting_joints.hpp"

namespace manycontact::internal {

struct HeldVelocities {
  /// Makes the workspace for the dynamics in `of`, for steps of h [s] and nw controls.
  HeldVelocities(const DataCollector& of, std::size_t nw, double h);
  HeldVelocities(const HeldVelocities&) = delete;

  /// Returns whether this workspace fits the current robots of `of` and steps of h. If not, a new workspace is needed.
  bool serve(const DataCollector& of, double h);

  /// solve_at computes a = (x - v) / h, with the velocity x of simulation/free_joints.hpp. finish_step computes xnext.
  /// The differential model's calc must be called before at the same state, because `of` provides the torques.
  void solve_at(const ConstVectorRef& state, double h, const DataCollector& of);
  void finish_step(const DataCollector& of, double h, Eigen::VectorXd& xnext);

  /// Computes a_x, a_w (nv x ndx, nv x nw) in F. Requires calcDiff of the differential model.
  void differentiate_at(const DataCollector& of, Eigen::Ref<Eigen::MatrixXd> F);
  /// Replaces the derivatives of [q + h x; x] in F (ndx x (ndx + nw)) by the derivatives of the next state.
  void differentiate_finish(const DataCollector& of, double h, Eigen::MatrixXd& F);

  ResistingJoints joints;  // joints with friction or damping, at the end of the step
  Scene scene;  // scene of `of` without gravity, with inertias that include `joints`, and with contact gains beta / s
  SceneData solution;
  Eigen::VectorXd q, v, slow;  // q, v: the state; slow: s v
  Eigen::VectorXd tau;         // torques on all coordinates, minus ID(q, v, -w x v)
  std::vector<Kinematics<double>> kin;
  std::vector<ContactData<double>> contacts;  // data of the contacts of `scene`
  FreeGroups groups;
  FreeMotionDerivatives of_groups;
  Eigen::VectorXd x, q_next, v_next;

 private:
  struct RobotWork {
    explicit RobotWork(const Model& model);
    std::vector<Vec6<double>> f;
    std::vector<Inertia<double>> Yc;
    std::vector<double> M;
    RneaDerivatives rnea;
    Eigen::MatrixXd by_q, by_v, inertia;  // nv x nv: derivatives of ID(q, v, -w x v), and M
  };
  std::vector<std::shared_ptr<const Model>> models_;  // models of the robots of `of`
  double h_;
  void kinematics_at_start(const DataCollector& of);
  void leave_out_alpha_of_turning_rows();
  // take_torques adds torques of external wrenches and springs to the motors'; differentiate_torques computes dtau_dx_.
  void take_torques(const DataCollector& of);
  void differentiate_torques(const DataCollector& of);
  const Eigen::SparseMatrix<double>& dtau_dx(const DataCollector& of) const {
    return applied_ ? dtau_dx_ : of.actuation->dtau_dx;
  }
  std::vector<RobotWork> robots_;
  Eigen::VectorXd turn_, scratch_of_end_;           // turn_: -w x v (nv); scratch_of_end_: workspace of finish_step
  Eigen::VectorXd torques_, torques_of_motion_;     // torques of motors, external wrenches, springs; without bias
  Eigen::SparseMatrix<double> dtau_dx_;             // nv x ndx: derivatives of torques_; every entry is stored
  std::unique_ptr<AppliedForces<double>> applied_;  // null if there are no applied forces
  std::unique_ptr<AppliedScratch> scratch_;
  std::vector<int> all_robots_;
  Eigen::VectorXd unit_, by_q_, by_v_;  // workspace of differentiate_torques (nv)
  Eigen::MatrixXd dtau_;                // nv x (ndx + nw): derivatives of tau
  Eigen::MatrixXd of_island_, done_;    // derivatives of torques and of accelerations of one island
};

}  // namespace manycontact::internal
