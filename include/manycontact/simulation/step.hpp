#pragma once
// Simulates a scene, on the manifold of its configurations, with its active contacts.
//
// Semi-implicit Euler constrains the velocities of contacts, by an impulse h f:
//
//     [ M  J^T     ] [ x    ]   [ -h ID(q, v, s) + h tau     ]      s = -(v / h + w x v)
//     [ J  -delta I] [ -h f ] = [ (1 - beta h) c - alpha h e ]      c+ = J(q) x
//
// x is the velocity at the end of the step, in the body axes at its start. Joints move by h x. The axes of free joints
// rotate with their bodies, and these move by p+ = p + h R x, R+ = R exp(h w+), v+ = R+^T R x. Adding one velocity to
// all bodies changes nothing else. With fixed axes s = -v / h, and the right-hand side is M v + h (tau - ID(q, v, 0)).
//
// tau = tau(q, v, u, w) is the torque of motors and external wrenches at the start of the step. Dampers and PD laws act
// with their force at the end of the step, for any h. A spring of stiffness k between masses m adds h^2 k to M along
// the spring, and (1 - r^2) h^2 k v to the right-hand side, with r = z / (1 + z), z = h^2 k / m. Oscillations that the
// step resolves keep their energy; faster ones are damped. Coulomb friction of a joint is at most its limit, and the
// joint sticks below 1e-6 rad/s or m/s. Afterwards, the momentum of bodies without connection to the world is corrected
// (detail/simulation/momentum.hpp).
//
// e is the contact's placement error. c is the contact's velocity after the last step: J v initially, then J of the
// last configuration times x. If e = c = 0, x is the velocity nearest to v + h a_free, in the mass-weighted norm, that
// the contacts allow. Contacts then never add energy.
//
// Prescribed accelerations J a = -J' v - beta J v - alpha e with beta near 1/h do add energy. J v has grown by h J' v
// since the last step, so that the curvature J' v is compensated twice. Where J' v grows from step to step, as for legs
// that straighten, this added half the energy of a scene in 10 ms. For the scheme without gains see Stewart and
// Trinkle, International Journal for Numerical Methods in Engineering 39 (1996).
//
// RK4 is the scheme of Munthe-Kaas: q(t) = q0 (+) w(t), and classical Runge-Kutta for (w, v) from w = 0 with
//
//     dw/dt = dexp^-1_w v,   dv/dt = a(q0 (+) w, v)
//     dexp^-1_w v = v + [w, v]/2 + [w, [w, v]]/12 + O(|w|^4 |v|)
//
// All forces are evaluated at the stages. Dampers, springs and PD laws bound the step size, and joint friction is
// smoothed as in solve. v is expressed in the body's frame already and needs no correction. The truncated series
// changes a step by O(h^5), as the scheme does. Without the brackets, floating bases and planar joints have order 2.
//
// If the motion passes a configuration where J loses rank (a loop of joints in line), nearby stages turn their O(h^2)
// constraint error into an impulse of arbitrary size. Every solve is correct, but energy jumps, less with shorter
// steps. Damping bounds the impulse, but causes contact accelerations of damping times force, and changes energy, too.
//
// Contacts constrain J v, also where the rows of a 1D or 2D contact rotate while its point moves across them (local
// axes of a body that rotates). J a + a0 = 0 of solve, Crocoddyl's formula, does not keep J v constant there
// (turning_rows in analysis/findings.hpp). Both integrators keep it. Gains beta act on J v, and alpha on placement
// errors of rows that do not rotate like that. After a step of RK4 with such rows `dynamics` has no derivatives.
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
struct ResistingForces;  // private to this module

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
  /// Copies everything from `of` that may change. alpha becomes alpha h [1/s], beta 0.
  void follow(const Scene& of, double h);
  /// Computes c = J v of the contacts with a first row in f_offset. Call it after inverse_dynamics_of at q, v.
  void contact_velocities(const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// Computes c for another v (nv) at the same q.
  void contact_velocities_at(const Eigen::VectorXd& v, const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// Computes tau = ID(q, v, a), without contacts. q: nq; v, a, tau: nv.
  void inverse_dynamics_of(const Scene& of, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                           const Eigen::VectorXd& a, const Vec3<double>& gravity, Eigen::VectorXd& tau);

  Scene scene;
  Vec3<double> gravity = Vec3<double>::Zero();  // gravity of the scene followed
  Eigen::VectorXd zero;                         // nv
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

/// Work of forces in a step, each force times the mean of the velocities before and after [J].
struct StepWork {
  double pd = 0, dampers = 0, friction = 0;  // PD laws; dampers in joints and between points; joint friction
  double springs = 0;                        // energy that the step took from springs too fast for it, beyond their
                                             // change of energy
};

struct SimulationData {  // A simulation: state, step size, integrator, and the workspace of its solves. One per thread.
  /// Starts at q (nq), v (nv) with steps of h [s]. Throws std::invalid_argument for wrong sizes, and unless h is finite
  /// and positive.
  SimulationData(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v, Integrator integrator, double h,
                 const Options& options = {});

  Integrator integrator;
  double h;                     // s
  double velocity_limit = 1e5;  // m/s, rad/s; a faster state ends the simulation as kTooFast

  int condition_every = 0;  // number of steps between estimates of the condition of K; 0: never
  double condition = std::numeric_limits<double>::quiet_NaN();  // 1-norm condition number of K, the largest of the
                                                                // islands, at the last estimate; NaN before

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
  Eigen::VectorXd f;           // set by step: contact forces at the state before it, rows as in Solution::f
  std::vector<int> f_offset;   // set by step: per contact its first row in f, or -1 if it was not active
  Eigen::VectorXd next_q, next_v;  // set by step: the state tried; after a successful step, the previous state

  SceneAtRest at_rest;
  std::vector<char> kept_active;  // contacts whose dependent rows are remembered

  // Used by semi-implicit Euler.
  FreeGroups free_groups;
  std::shared_ptr<AppliedForces<double>> applied;  // nullptr if the scene has none
  std::shared_ptr<ResistingForces> resisting;      // nullptr if there are no springs, dampers, friction and PD laws
  long unsettled = 0;         // number of steps in which joint friction did not converge within 50 solves
  Eigen::VectorXd contact_v;  // c, rows as in f, for the current state and contacts
  Eigen::VectorXd left_q, left_v;
  std::vector<char> left_active;

  // workspace
  bool in_batches = false;  // whether the solve adds -h ID(q, v, stop) to b, in its SIMD batches
  Eigen::VectorXd stop;     // the acceleration that brings v to zero within the step
  Eigen::VectorXd b, wanted, next_contact_v;
  Eigen::VectorXd stage_q, stage_v, tau, w, w_rate, v_rate, w_sum, v_sum;

  double time() const { return static_cast<double>(steps) * h; }  // s, since the start
};

/// Makes one step with torques u (nu) [N m, N]. If the result is not kOk, q, v and steps remain unchanged. Allocates
/// what solve allocates: nothing after the first step with sparse-ldl. Throws std::invalid_argument if u has a wrong
/// size. Thread-safe for distinct data. Cost: one solve (semi-implicit Euler) or four (RK4).
[[nodiscard]] StepStatus step(const Scene& scene, const ConstVectorRef& u, SimulationData& data);

/// Returns the rows of data.f of a contact, given by name or number: the force on A in the last step, in the contact's
/// reference frame [N, N m]. The view remains valid until the next step. Throws std::invalid_argument for an unknown
/// contact, std::logic_error for a contact that was not active, and before the first step.
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data,
                                                        const std::string& contact);
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data, int contact);

/// Describes why a step was not kOk: "the solver failed: singular inertia", "r0/knee moves at 3e+05".
std::string failure(const Scene& scene, const SimulationData& data, StepStatus status);

}  // namespace manycontact
