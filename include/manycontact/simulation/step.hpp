#pragma once
// A scene on its way through time, on the manifold of its configurations, contacts held as the scene says.
//
// Semi-implicit Euler holds contacts in the velocity, by an impulse h f:
//
//     [ M  J^T     ] [ v+   ]   [ M v + h (tau - h(q, v))   ]
//     [ J  -delta I] [ -h f ] = [ (1 - beta h) c - alpha h e ]      c+ = J(q) v+,   q+ = q (+) h v+
//
// with tau = tau(q, v, u, w) of motors and pushes at the start of the step. Forces that resist are those at its end, for
// any h: dampers, springs and PD laws, which add h^2 k + h c to M along them, so that what swings faster than steps can
// follow dies out; and joint friction, which is Coulomb's, at most F, and sticks below 1e-6 rad/s or m/s. A step then
// gives what nothing ties to the world the momentum that it has to have (simulation/momentum.hpp). Here e is the contact's error and c its velocity as the last
// step left it: J v at the start, then J of the last configuration times v. Where e = c = 0 this takes v + h a_free to
// the nearest velocity that the contacts allow, in the kinetic metric: contacts never add energy but for e and c.
// (Accelerations J a = -J' v - beta J v - alpha e with beta near 1/h do: J v has grown by h J' v since the last step,
// so that the curvature J' v is answered twice, and where it grows from step to step, as legs straighten, half the
// energy of a scene was added in 10 ms.) For the scheme without gains see Stewart and Trinkle, International Journal
// for Numerical Methods in Engineering 39 (1996).
//
// RK4 is Munthe-Kaas': q(t) = q0 (+) w(t), and the classical scheme on (w, v) from w = 0 with
//
//     dw/dt = dexp^-1_w v,   dv/dt = a(q0 (+) w, v)
//     dexp^-1_w v = v + [w, v]/2 + [w, [w, v]]/12 + O(|w|^4 |v|)
//
// with all forces at the stages: dampers, springs and PD laws bound its steps (simulation/spring_steps.hpp), and joint
// friction is smoothed as in solve. v is already in the body's frame and needs no correction. What the series leaves out changes a step by O(h^5), as
// the scheme itself does. Without the brackets floating bases and planar joints fall back to order 2.
//
// Where the motion passes a configuration in which J loses rank (a loop of joints in line), stages that come close to
// it turn their O(h^2) error of the contact into a blow of any size. Every solve is right, energy jumps all the same.
// The scene's damping bounds the blow, at the price of an acceleration of damping times force in the contacts; 1e-8 to
// 1e-6 kg^-1 serves.
//
// Source: Munthe-Kaas, High order Runge-Kutta methods on manifolds, Applied Numerical Mathematics 29 (1999).

#include "manycontact/algorithm/kinematics.hpp"
#include "manycontact/contact/rows.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/simulation/integrator.hpp"
#include "manycontact/simulation/momentum.hpp"

namespace manycontact {

template <class S>
struct AppliedForces;    // private to floor algorithm
struct ResistingForces;  // private to this floor

/// What became of a step.
enum class StepStatus {
  kOk,
  kSolverFailed,  // a solve of the step has status kFailed; its report says why
  kNotFinite,     // the state after the step is not finite
  kTooFast,       // a velocity after the step is beyond SimulationData::velocity_limit
};

/// The scene at rest, of which semi-implicit Euler and impacts ask for a velocity in the place of an acceleration: no
/// gravity, no bias, no pushes and springs, and a contact's error e is to be answered by a velocity. With the memory
/// for that.
struct SceneAtRest {
  explicit SceneAtRest(const Scene& scene);  // a copy of it, without gravity
  /// Takes over what may change in `of`. alpha becomes alpha h [1/s], beta 0.
  void follow(const Scene& of, double h);
  /// c = J v of the contacts with a first row in f_offset, after inverse_dynamics_of at q, v.
  void contact_velocities(const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// The same with that q, for another v (nv).
  void contact_velocities_at(const Eigen::VectorXd& v, const std::vector<int>& f_offset, Eigen::VectorXd& c);
  /// tau = ID(q, v, a), without contacts. q: nq; v, a, tau: nv.
  void inverse_dynamics_of(const Scene& of, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                           const Eigen::VectorXd& a, const Vec3<double>& gravity, Eigen::VectorXd& tau);

  Scene scene;
  Eigen::VectorXd zero;                 // nv
  std::vector<Kinematics<double>> kin;  // per robot
  std::vector<Vec6<double>> f;          // scratch
  std::vector<ContactData<double>> contacts;
};

/// PD laws of joints: the torque kp (q_ref - q) + kd (v_ref - v) on velocity coordinates. Vectors are nv long, or all
/// are empty: no joint has one.
struct PdLaws {
  Eigen::VectorXd kp, kd;        // none negative [N m / rad, N m s / rad]; kp is 0 where a joint has several coordinates
  Eigen::VectorXd q_ref, v_ref;  // what a step ends with [rad, rad/s]; RK4 takes them at all stages
};

/// Work of forces in a step, each force times the mean of the velocities before and after [J].
struct StepWork {
  double pd = 0, dampers = 0, friction = 0;  // PD laws; dampers in joints and between points; joint friction
  double springs = 0;                        // what the step took from springs beside what they lost or gained
};

struct SimulationData {  // A motion: its state, step size and integrator, and the memory of its solves.
  /// Starts at q (nq), v (nv). Throws std::invalid_argument unless sizes fit and h is finite and positive.
  SimulationData(const Scene& scene, const ConstVector& q, const ConstVector& v, Integrator integrator, double h,
                 const Options& options = {});

  Integrator integrator;
  double h;                     // s
  double velocity_limit = 1e5;  // m/s, rad/s: nothing real is faster, but for light

  int condition_every = 0;  // estimates the condition of K in every so many steps; 0: never
  double condition = 0;     // 1-norm condition of K, the largest of the islands, when last estimated

  Eigen::VectorXd q, v;        // the state: of the start, then by step
  long steps = 0;              // done so far
  Status worst = Status::kOk;  // of all solves so far
  SceneData dynamics;          // a, f, report: of the last solve; by semi-implicit Euler a mean acceleration, and
                               // no derivatives. dynamics.active may be switched between steps (simulation/switch.hpp),
                               // and dynamics.pushes changed
  PdLaws pd;                   // may be changed between steps
  Eigen::VectorXd pd_torque;   // nv: by step: what the PD laws exerted, on average [N m, N]
  StepWork work;               // by step
  Eigen::VectorXd f;           // by step: contact forces at the state it started from, rows as in Solution::f
  std::vector<int> f_offset;   // by step: per contact its first row in f, -1 where it was not active
  Eigen::VectorXd next_q, next_v;  // by step: the state tried; after a step that is kOk the one before it

  SceneAtRest at_rest;
  std::vector<char> kept_active;  // contacts whose rows that depended on each other are kept so

  // by semi-implicit Euler
  FreeGroups free_groups;
  std::shared_ptr<AppliedForces<double>> applied;  // nullptr: the scene has none
  std::shared_ptr<ResistingForces> resisting;      // nullptr: it has no springs, dampers, friction and PD laws
  long unsettled = 0;  // steps so far in which a joint neither sticks nor slides as Coulomb says, after 50 solves
  Eigen::VectorXd contact_v;                       // c, rows as in f, for the state and contacts
  Eigen::VectorXd left_q, left_v;
  std::vector<char> left_active;

  // scratch
  Eigen::VectorXd wanted;
  Eigen::VectorXd stage_q, stage_v, tau, w, w_rate, v_rate, w_sum, v_sum;

  double time() const { return static_cast<double>(steps) * h; }  // s, since the start
};

/// One step with torques u (nu). Where it is not kOk, q, v and steps stay what they were. Allocates what solve does:
/// nothing after the first with sparse-ldl. Throws std::invalid_argument when u's size does not fit the scene.
[[nodiscard]] StepStatus step(const Scene& scene, const ConstVector& u, SimulationData& data);

/// The rows of data.f that are a contact's, by its name or number: what it exerted on A in the last step, in its
/// reference frame [N, N m]. Valid until the next step. Throws std::invalid_argument for a contact that does not exist,
/// with the nearest name, std::logic_error for one that was not active and before the first step.
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data,
                                                        const std::string& contact);
Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data, int contact);

/// Why a step was not kOk, for people: "the solver failed: singular inertia", "r0/knee moves at 3e+05".
std::string failure(const Scene& scene, const SimulationData& data, StepStatus status);

}  // namespace manycontact
