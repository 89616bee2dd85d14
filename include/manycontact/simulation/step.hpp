#pragma once
// Simulates a scene, on the manifold of its configurations, with its active contacts.
//
// Semi-implicit Euler constrains velocities by impulses h f. Let M be the joint-space inertia, J the contact rows, ID
// the inverse dynamics, delta the scene's damping, and alpha, beta the gains. A step solves
//
//     [ M  J^T     ] [ x    ]   [ -h ID(q, v, s) + h tau     ]      s = -(v / h + w x v)
//     [ J  -delta I] [ -h f ] = [ (1 - beta h) c - alpha h e ]      c+ = J(q) x
//
// x is the velocity at the end of the step, in the body axes at its start, and w the body's angular velocity. Joints
// move by h x. The axes of free joints rotate with their bodies, which move by p+ = p + h R x, R+ = R exp(h w+),
// v+ = R+^T R x. For joints with fixed axes s = -v / h, and the right-hand side is M v + h (tau - ID(q, v, 0)).
//
// tau is the torque of motors and external wrenches at the start of the step. Dampers and PD laws act with their force
// at the end of the step, for any h. A spring of stiffness k between masses m adds h^2 k to M along the spring, and
// (1 - r^2) h^2 k v to the right-hand side, with r = z / (1 + z), z = h^2 k / m. Oscillations that the step resolves
// keep their energy; faster ones are damped. Coulomb friction of a joint is at most its limit, and the joint sticks
// below 1e-6 rad/s or m/s. Momenta of bodies not connected to the world are corrected (detail/simulation/momentum.hpp).
//
// e is the contact's placement error. c is the contact's velocity after the last step: J v initially, then J of the
// last configuration times x. If e = c = 0, x is the velocity allowed by the contacts that is nearest to v + h a_free
// in the mass-weighted norm (a_free: acceleration without contacts). Contacts then never add energy.
//
// Prescribing accelerations J a = -J' v - beta J v - alpha e with beta near 1/h adds energy instead. J v has grown by
// h J' v since the last step, so that both J' v and beta J v compensate the curvature J' v. For legs that straighten,
// whose J' v grows from step to step, this added half the energy of a scene in 10 ms. For the scheme without gains see
// Stewart and Trinkle, International Journal for Numerical Methods in Engineering 39 (1996).
//
// RK4 is the scheme of Munthe-Kaas: classical Runge-Kutta for (w, v) from w = 0, where w(t) is the tangent vector with
// q(t) = q0 (+) w(t), [ , ] is the Lie bracket, and
//
//     dw/dt = dexp^-1_w v,   dv/dt = a(q0 (+) w, v)
//     dexp^-1_w v = v + [w, v]/2 + [w, [w, v]]/12 + O(|w|^4 |v|)
//
// All forces are evaluated at the stages. Dampers, springs and PD laws bound the step size, and joint friction is
// smoothed as in solve. Truncating the series changes a step by O(h^5), the order of the scheme's own error. Without
// the brackets, floating bases and planar joints would have order 2.
//
// If the motion passes a configuration where J loses rank (a loop of joints in line), nearby stages turn their O(h^2)
// constraint error into an impulse of arbitrary size. Every solve is correct, but energy jumps, less with shorter
// steps. Damping bounds the impulse, but lets contacts accelerate by damping times force, and also changes the energy.
//
// The rows of a 1D or 2D contact may rotate while its point moves across them (local axes of a rotating body). Then
// J a + a0 = 0 of `solve`, Crocoddyl's formula, does not keep J v constant (turning_rows in analysis/findings.hpp);
// both integrators do. Gains beta act on J v, and gains alpha only on placement errors of rows that do not rotate in
// this way. After a step of RK4 with such rotating rows `dynamics` has no derivatives.
//
// Source: Munthe-Kaas, High order Runge-Kutta methods on manifolds, Applied Numerical Mathematics 29 (1999).

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/detail/simulation/momentum.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

template <class S>
struct AppliedForces;    // private to the module algorithm
struct ResistingForces;  // private to the module simulation

/// The result of a step.
enum class StepStatus {
  kOk,
  kSolverFailed,  // a solve failed; its report contains the reason
  kNotFinite,     // the state after the step is not finite
  kTooFast,       // a velocity after the step exceeds SimulationData::velocity_limit
};

/// The scene at rest, with workspace, for solves that prescribe velocities instead of accelerations (semi-implicit
/// Euler, impacts). It has no gravity, bias, wrenches and springs, and its gains turn placement errors into velocities.
struct SceneAtRest {
  explicit SceneAtRest(const Scene& scene);  // copies `scene` without gravity
  /// Copies from scene `of` all that may change between steps. Each contact's gain alpha becomes alpha h [1/s], beta 0.
  void follow(const Scene& of, double h);
  /// Computes c = J v of all contacts whose f_offset is not -1. Call it after inverse_dynamics_of at q, v.
  void contact_velocities(const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// Computes c = J v for another v (nv) at the q of the last call of inverse_dynamics_of.
  void contact_velocities_at(const Eigen::VectorXd& v, const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// Computes the inverse dynamics tau = ID(q, v, a) of scene `of`, without contacts. q: nq; v, a, tau: nv.
  void inverse_dynamics_of(const Scene& of, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                           const Eigen::VectorXd& a, const Vec3<double>& gravity, Eigen::VectorXd& tau);

  Scene scene;
  Vec3<double> gravity = Vec3<double>::Zero();  // gravity of the scene last given to follow [m/s^2]
  Eigen::VectorXd zero;                         // nv zeros
  std::vector<Kinematics<double>> kin;          // one entry per robot
  std::vector<Vec6<double>> f;                  // workspace
  std::vector<ContactData<double>> contacts;
};

/// PD laws of joints: the torque kp (q_ref - q) + kd (v_ref - v) on velocity coordinates. All vectors have length nv,
/// or all are empty if no joint has a PD law.
struct PdLaws {
  Eigen::VectorXd kp, kd;        // not negative [N m / rad, N m s / rad]; kp is 0 for joints of several coordinates
  Eigen::VectorXd q_ref, v_ref;  // references at the end of the step [rad, rad/s]; RK4 uses them at all stages
};

/// The work of forces in a step [J]. Semi-implicit Euler multiplies each force by h times the mean of the velocities
/// before and after the step. RK4 adds h times the power at each stage, times the stage's weight.
struct StepWork {
  double pd = 0, dampers = 0, friction = 0;  // PD laws; dampers in joints and between points; joint friction
  double springs = 0;                        // numerical damping of springs too fast for h: their work on the bodies
                                             // plus the change of their energy
};

struct SimulationData {  // A simulation: state, step size, integrator, and the workspace of its solves. One per thread.
  /// Starts at q (nq), v (nv) with steps of h [s]. Throws std::invalid_argument for wrong sizes, and unless h is finite
  /// and positive.
  SimulationData(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v, Integrator integrator, double h,
                 const Options& options = {});

  Integrator integrator;
  double h;                     // s
  double velocity_limit = 1e5;  // m/s, rad/s; a faster state ends the simulation as kTooFast

  int condition_every = 0;  // number of steps between estimates of `condition`; 0: never
  double condition = std::numeric_limits<double>::quiet_NaN();  // largest 1-norm condition number of an island's KKT
                                                                // matrix at the last estimate; NaN before

  Eigen::VectorXd q, v;        // the state: initial, then updated by step
  long steps = 0;              // number of completed steps
  long solves = 0;             // number of solves of all steps
  Status worst = Status::kOk;  // the worst status of all solves
  SceneData dynamics;          // a, f and report of the last solve; with semi-implicit Euler a is a mean acceleration,
                               // and there are no derivatives. Between steps, `dynamics.active` may be
                               // switched (simulation/switch.hpp) and `dynamics.wrenches` changed
  PdLaws pd;                   // may be changed between steps
  Eigen::VectorXd pd_torque;   // nv, set by step: mean torque of the PD laws [N m, N]
  StepWork work;               // set by step
  Eigen::VectorXd f;           // set by step: contact forces at the state before the step, rows as in Solution::f
  std::vector<int> f_offset;   // set by step: first row of each contact in f; -1: it was not active
  Eigen::VectorXd next_q, next_v;  // set by step: the state that a failed step computed; otherwise the previous state

  SceneAtRest at_rest;
  std::vector<char> kept_active;  // active flags of the contacts for which the dependent rows are known

  // Used by semi-implicit Euler.
  FreeGroups free_groups;
  std::shared_ptr<AppliedForces<double>> applied;  // nullptr: no wrenches and springs
  std::shared_ptr<ResistingForces> resisting;      // nullptr if there are no springs, dampers, friction and PD laws
  long unsettled = 0;              // number of steps in which joint friction did not converge within 50 solves
  Eigen::VectorXd contact_v;       // contact velocities c after the last step (see the top), rows as in f
  Eigen::VectorXd left_q, left_v;  // state and active flags at the end of the last step, to which contact_v belongs
  std::vector<char> left_active;

  // workspace
  bool in_batches = false;  // whether the solve itself, in SIMD batches, adds -h ID(q, v, stop) to b
  Eigen::VectorXd stop;     // nv: the acceleration s, which brings v to zero within the step
  Eigen::VectorXd b, wanted, next_contact_v;
  Eigen::VectorXd stage_q, stage_v, tau, w, w_rate, v_rate, w_sum, v_sum;

  double time() const { return static_cast<double>(steps) * h; }  // s, since the start
};

/// Makes one step with torques u (nu) [N m, N]. If the result is not kOk, data.q, v and steps remain unchanged.
/// Allocates as `solve` does: with method sparse-ldl, only in the first step. Throws std::invalid_argument if u has a
/// wrong size. Thread-safe for distinct data. Cost: one solve (semi-implicit Euler) or four (RK4).
[[nodiscard]] StepStatus step(const Scene& scene, const ConstVectorRef& u, SimulationData& data);

/// Returns the rows of data.f of a contact, given by name or number: the force on A in the last step, in the contact's
/// reference frame [N, N m]. The view remains valid until the next step. Throws std::invalid_argument for an unknown
/// contact, std::logic_error for a contact that was not active, and before the first step.
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data,
                                                        const std::string& contact);
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data,
                                                        ContactIndex contact);

/// Describes why a step was not kOk: "the solver failed: singular inertia", "r0/knee moves at 3e+05".
std::string failure(const Scene& scene, const SimulationData& data, StepStatus status);

}  // namespace manycontact
