#pragma once
// A scene on its way through time, on the manifold of its configurations, contacts held as the scene says.
//
// RK4 is Munthe-Kaas': q(t) = q0 (+) w(t), and the classical scheme on (w, v) from w = 0 with
//
//     dw/dt = dexp^-1_w v,   dv/dt = a(q0 (+) w, v)
//     dexp^-1_w v = v + [w, v]/2 + [w, [w, v]]/12 + O(|w|^4 |v|)
//
// v is already in the body's frame and needs no correction. What the series leaves out changes a step by O(h^5), as
// the scheme itself does. Without the brackets floating bases and planar joints fall back to order 2.
//
// Where the motion passes a configuration in which J loses rank (a loop of joints in line), stages that come close to
// it turn their O(h^2) error of the contact into a blow of any size. Every solve is right, energy jumps all the same.
// The scene's damping bounds the blow, at the price of an acceleration of damping times force in the contacts; 1e-8 to
// 1e-6 kg^-1 serves.
//
// Source: Munthe-Kaas, High order Runge-Kutta methods on manifolds, Applied Numerical Mathematics 29 (1999).

#include "manycontact/dynamics/solve.hpp"
#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

/// What became of a step.
enum class StepStatus {
  kOk,
  kSolverFailed,  // a solve of the step has status kFailed; its report says why
  kNotFinite,     // the state after the step is not finite
  kTooFast,       // a velocity after the step is beyond SimulationData::velocity_limit
};

struct SimulationData {  // A motion: its state, step size and integrator, and the memory of its solves.
  /// Starts at q (nq), v (nv). Throws std::invalid_argument unless sizes fit and h is finite and positive.
  SimulationData(const Scene& scene, const ConstVector& q, const ConstVector& v, Integrator integrator, double h,
                 const Options& options = {});

  Integrator integrator;
  double h;                     // s
  double velocity_limit = 1e5;  // m/s, rad/s: nothing real is faster, but for light

  Eigen::VectorXd q, v;            // the state: of the start, then by step
  long steps = 0;                  // done so far
  Status worst = Status::kOk;      // of all solves so far
  SceneData dynamics;              // of the last solve; dynamics.active may be switched between steps
  Eigen::VectorXd next_q, next_v;  // by step: the state tried; after a step that is kOk the one before it

  // scratch
  Eigen::VectorXd stage_q, stage_v, w, w_rate, v_rate, w_sum, v_sum;

  double time() const { return static_cast<double>(steps) * h; }  // s, since the start
};

/// One step with torques u (nu). Where it is not kOk, q, v and steps stay what they were. Allocates what solve does:
/// nothing after the first with sparse-ldl. Throws std::invalid_argument when u's size does not fit the scene.
[[nodiscard]] StepStatus step(const Scene& scene, const ConstVector& u, SimulationData& data);

/// Why a step was not kOk, for people: "the solver failed: singular inertia", "r0/knee moves at 3e+05".
std::string failure(const Scene& scene, const SimulationData& data, StepStatus status);

}  // namespace manycontact
