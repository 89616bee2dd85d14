#include "manycontact/simulation/step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "internal.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/model/suggestion.hpp"
#include "resisting_forces.hpp"

namespace manycontact {

namespace internal {

void integrate_scene(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& w, Eigen::VectorXd& out) {
  for (const Robot& r : scene.robots)
    integrate<double>(*r.model, q.segment(r.idx_q, r.model->nq), w.segment(r.idx_v, r.model->nv),
                      out.segment(r.idx_q, r.model->nq));
}

bool solve_stage(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const ConstVector& u,
                 SimulationData& data) {
  if (u.size() != scene.nu) throw std::invalid_argument("step: u has a wrong size, nu numbers are expected");
  torques_of_motors(scene, u, data.tau);
  if (data.pd.kp.size() > 0) add_pd_torques(scene, data.pd, q, v, data.tau);
  bool turning = rows_may_turn(scene, data);
  if (turning) {
    prepare(scene, data.dynamics);
    data.wanted.setZero(data.dynamics.f.size());
    turning = follow_turning_rows(scene, q, v, data);
  }
  const Status status = turning ? solve_tau(scene, q, v, data.tau, data.wanted, data.dynamics).status
                                : solve_tau(scene, q, v, data.tau, data.dynamics).status;
  ++data.solves;
  data.worst = std::max(data.worst, status);
  return status != Status::kFailed;
}

void watch_condition(const Scene& scene, SceneData& of, SimulationData& data) {
  if (data.condition_every == 0 || data.steps % data.condition_every != 0) return;
  estimate_condition(scene, of);
  data.condition = of.report.condition;
}

void keep_what_depends(SceneData& of, SimulationData& data) {
  if (data.kept_active == data.dynamics.active) return;
  keep_dependent(of);
  data.kept_active = data.dynamics.active;
}

void keep_forces(SimulationData& data) {
  data.f = data.dynamics.f;
  data.f_offset = data.dynamics.f_offset;
}

}  // namespace internal

SimulationData::SimulationData(const Scene& scene, const ConstVector& q_, const ConstVector& v_, Integrator integrator_,
                               double h_, const Options& options)
    : integrator(integrator_), h(h_), q(q_), v(v_), dynamics(scene, options), at_rest(scene), free_groups(scene) {
  if (q.size() != scene.nq || v.size() != scene.nv)
    throw std::invalid_argument("SimulationData: q or v has a wrong size, nq and nv numbers are expected");
  if (!(h > 0) || !std::isfinite(h))
    throw std::invalid_argument("SimulationData: the step h is not a finite number above 0");
  if (has_applied_forces(scene)) applied = std::make_shared<AppliedForces<double>>(scene);
  if (!scene.springs.empty() || !scene.joint_springs.empty() ||
      std::ranges::any_of(scene.robots, [](const Robot& r) { return has_friction(*r.model); }))
    resisting = std::make_shared<ResistingForces>(scene);
  for (Eigen::VectorXd* x : {&next_q, &stage_q}) *x = q;
  left_q.setConstant(scene.nq, std::numeric_limits<double>::quiet_NaN());  // NaN differs from any q
  left_v = v;
  for (Eigen::VectorXd* x : {&next_v, &stop, &stage_v, &tau, &w, &w_rate, &v_rate, &w_sum, &v_sum})
    x->setZero(scene.nv);
}

StepStatus step(const Scene& scene, const ConstVector& u, SimulationData& data) {
  internal::check_pd(scene, data.pd);
  const bool solved = data.integrator == Integrator::kRk4 ? internal::step_rk4(scene, u, data)
                                                          : internal::step_semi_implicit_euler(scene, u, data);
  if (!solved) return StepStatus::kSolverFailed;
  if (!data.next_q.allFinite() || !data.next_v.allFinite()) return StepStatus::kNotFinite;
  if ((data.next_v.array().abs() > data.velocity_limit).any()) return StepStatus::kTooFast;
  data.q.swap(data.next_q);
  data.v.swap(data.next_v);
  ++data.steps;
  return StepStatus::kOk;
}

Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data,
                                                        const std::string& contact) {
  return contact_force(scene, data, contact_called(scene, contact));
}

Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SimulationData& data, int contact) {
  (void)contact_at(scene, contact, "contact_force");
  if (data.f_offset.empty()) throw std::logic_error("contact_force: there are no forces yet, call step first");
  if (data.f_offset.size() != scene.contacts.size())
    throw std::invalid_argument("contact_force: the data belong to another scene, data of this scene are expected");
  const std::string& name = scene.contacts[contact].name;
  if (data.f_offset[contact] < 0)
    throw std::logic_error("contact_force: contact " + quote(name) +
                           " was not active in the last step and has no force");
  return data.f.segment(data.f_offset[contact], scene.contacts[contact].rows());
}

std::string failure(const Scene& scene, const SimulationData& data, StepStatus status) {
  switch (status) {
    case StepStatus::kOk:
      return "";
    case StepStatus::kSolverFailed:
      for (const IslandReport& island : data.dynamics.report.islands)
        if (island.status == Status::kFailed) return "the solver failed: " + to_string(island.reason);
      return "the solver failed";
    case StepStatus::kNotFinite:
      return "the state is no longer finite";
    case StepStatus::kTooFast:
      break;
  }
  Eigen::Index fastest;
  const double speed = data.next_v.cwiseAbs().maxCoeff(&fastest);
  char text[80];
  std::snprintf(text, sizeof text, " moves at %.2g m/s or rad/s, faster than the limit %.2g", speed,
                data.velocity_limit);
  return velocity_names(scene)[fastest] + text;
}

}  // namespace manycontact
