#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "manycontact/contact/body_rows.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"

namespace manycontact {

BodyForm::BodyForm(const std::shared_ptr<IslandShape>& shape, const lanes::Level* level)
    : parts(&shape->body_parts()), factor(shape->bodies()) {
  for (const Robot& robot : shape->scene().robots) kin.emplace_back(*robot.model);
  if (parts->cuts.empty()) return;
  held.resize(parts->cuts.size());
  pull.resize(parts->cuts.size());
  for (const BodyPart& part : parts->parts)
    if (part.shape == static_cast<int>(shapes.size())) shapes.emplace_back(part.pattern, level);
}

BodyForm::Shape::Shape(std::shared_ptr<const BodyPattern> of, const lanes::Level* level) : pattern(std::move(of)) {
  ldl.resize(*pattern);
  if (level && lanes::PartPlan::fits(*pattern)) {
    auto plan = std::make_shared<const lanes::PartPlan>(pattern);
    if (plan->schedule.compiled) lanes = level->make_parts(std::move(plan));
  }
  slots.resize(lanes ? static_cast<std::size_t>(level->width) : 1);
  side_by_side.reserve(slots.size());
  for (Slot& slot : slots) {
    slot.system.reset(pattern);
    slot.solution.resize(*pattern);
    slot.row.resize(pattern->nc);
  }
}

namespace internal {

namespace {

using V6 = Vec6<double>;

}  // namespace

void evaluate_node(const Scene& scene, const SceneData& data, const IslandWork& d, std::size_t k, int joint, int at,
                   int dof, BodySystem& s, BodyVectors& b) {
  const Robot& robot = scene.robots[d.island.robots[k]];
  const Model& model = *robot.model;
  const Joint& of = model.joints[joint];
  body_kinematics<double>(model, robot.base, joint, data.workspace->q.segment(robot.idx_q, model.nq),
                          data.v.segment(robot.idx_v, model.nv), d.bodies->kin[k],
                          {&s.r[at], s.S.col(dof).data(), &s.Y[at], &b.motion[at], &b.force[at]});
  for (int i = 0; i < of.nv(); ++i) {
    s.armature[dof + i] = model.armature[of.idx_v + i];
    b.joints[dof + i] = data.tau[robot.idx_v + of.idx_v + i];
  }
  if (of.parent < 0) b.motion[at].head<3>() -= scene.gravity;  // what bases accelerate with
}

// The rows' forces on their bodies, and what is left of them where bodies do not accelerate.
void evaluate_rows(const Scene& scene, const SceneData& data, const IslandWork& d, std::size_t k, int first,
                   BodySystem& s, BodyVectors& b) {
  const V6 none = V6::Zero();
  const int c = d.island.contacts[k];
  const Contact& contact = scene.contacts[c];
  ContactData<double>& rows = data.workspace->contacts[c];
  body_rows(scene, contact, kinematics_at(*d.bodies, d.island, contact.A),
            kinematics_at(*d.bodies, d.island, contact.B), none, none, rows);
  rows.Jl.setConstant(std::numeric_limits<double>::quiet_NaN());  // not known now, should there be memory for it
  rows.J.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < contact.rows(); ++i) {
    const V6 unit = rows.W.row(i).transpose();
    if (s.pattern->A[first + i] >= 0) s.GA.col(first + i) = rows.aMA.act_force(unit);
    if (s.pattern->B[first + i] >= 0) s.GB.col(first + i) = -rows.bMA.act_force(unit);
    b.rows[first + i] = wanted_in(data, c, i) - rows.a0[i];
  }
}

namespace {

void evaluate_bodies(const Scene& scene, const SceneData& data, IslandWork& d) {
  BodyForm& form = *d.bodies;
  form.factor.make_room();
  form.solution.resize(*form.factor.system.pattern);
  BodySystem& s = form.factor.system;
  s.delta = scene.damping;
  begin_evaluation(scene, data, d);
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const int o = s.pattern->node_offset[k];
    for (int i = 0; i < scene.robots[d.island.robots[k]].model->njoints(); ++i)
      evaluate_node(scene, data, d, k, i, o + i, s.pattern->first_dof[o + i], s, form.solution.b);
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k)
    evaluate_rows(scene, data, d, k, d.island.row_offset[k], s, form.solution.b);
}

bool all_finite(const BodyVectors& x) {
  const auto finite = [](const V6& y) { return y.allFinite(); };
  return x.joints.allFinite() && x.rows.allFinite() && std::all_of(x.motion.begin(), x.motion.end(), finite) &&
         std::all_of(x.force.begin(), x.force.end(), finite);
}

// kNone: the factor and form.solution are sound.
Reason solve_whole(const Scene& scene, const SceneData& data, IslandWork& d, sparse::Refinement& refinement) {
  BodyForm& form = *d.bodies;
  evaluate_bodies(scene, data, d);
  form.in_parts = false;
  return factorize_and_solve(form.factor.system, form.factor.ldl, form.solution, refinement);
}

// Whether a row moves no coordinate by more than rounding: its E_kk is then noise, and has nothing to cancel with.
bool has_vanishing_row(const BodySystem& s) {
  const BodyPattern& p = *s.pattern;
  if (s.delta > 0) return false;
  const auto moved = [&](int node, V6 G) {  // the largest entry of J met first that is no rounding
    double largest = 0, size = 0;
    for (; node >= 0; G = force_from(G, s.r[node]), node = p.parent[node])
      for (int k = p.first_dof[node]; k < p.first_dof[node] + p.ndof[node]; ++k) {
        largest = std::max(largest, std::abs(G.dot(s.S.col(k))));
        size = std::max(size, G.cwiseAbs().dot(s.S.col(k).cwiseAbs()));
        if (largest > tolerance::kPlainlyMoves * size && largest > 0) return true;
      }
    return largest > tolerance::kRank * size;
  };
  for (int k = 0; k < p.nc; ++k)
    if (!moved(p.A[k], s.GA.col(k)) && !moved(p.B[k], s.GB.col(k))) return true;
  return false;
}

}  // namespace

void begin_evaluation(const Scene& scene, const SceneData& data, IslandWork& d) {
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    data.workspace->robots[d.island.robots[k]].known = false;
    place_trees<double>(*robot.model, robot.base, data.workspace->q.segment(robot.idx_q, robot.model->nq),
                        d.bodies->kin[k]);
  }
}

Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodySolve& solve, sparse::Refinement& refinement) {
  if (has_vanishing_row(system)) return Reason::kSmallPivot;
  const Reason reason = factorize_bodies(system, ldl, &solve.b);
  if (reason != Reason::kNone) return reason;
  refinement = solve_refined(system, ldl, solve, tolerance::kRefinementSteps, true);
  if (refinement.backward_error <= tolerance::kConverged) return Reason::kNone;  // NaN where x is not finite
  return all_finite(solve.b) ? Reason::kLargeResidual : Reason::kNotFinite;
}

void BodyAnswer::add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& r) {
  const auto take = [](auto& largest, auto x) { largest = std::max(largest, x); };
  nonzeros += factor_nonzeros;
  take(refinement.steps, r.steps);
  take(refinement.backward_error, r.backward_error), take(refinement.first, r.first);
  take(dynamics, left.dynamics), take(dynamics_scale, left.dynamics_scale);
  take(contact, left.contact), take(contact_scale, left.contact_scale);
}

void report_bodies(const Scene& scene, const BodyAnswer& x, IslandWork& d, IslandReport& report) {
  d.factor = &d.bodies->factor;
  d.first_error = x.refinement.first;
  d.contradiction = d.was_dependent = false;
  report.method = Method::kSparseBodies;
  report.reason = Reason::kNone;
  report.factor_nonzeros = x.nonzeros;
  report.refinement_steps = x.refinement.steps;
  report.backward_error = x.refinement.backward_error;
  report.residual_dynamics = x.dynamics == 0 ? 0 : x.dynamics / x.dynamics_scale;
  report.residual_contact = x.contact == 0 ? 0 : x.contact / std::max(x.contact_scale, scene.gravity.norm());
}

const BodyKinematics<double>* kinematics_at(const BodyForm& form, const Island& island, const Attachment& at) {
  return moves(at) ? &form.kin[local_robot(island, at.robot)] : nullptr;
}

bool solve_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, IslandReport& report) {
  BodyForm& form = *d.bodies;
  if (solve_in_parts(scene, data, d, report)) return true;
  report.method = Method::kSparseBodies;
  sparse::Refinement refinement;
  report.reason = solve_whole(scene, data, d, refinement);
  if (report.reason != Reason::kNone) return false;
  BodyAnswer answer;
  answer.add(form.factor.nonzeros(), form.solution.residual, refinement);
  report_bodies(scene, answer, d, report);
  const BodyVectors& x = form.solution.x;
  each_velocity_block(scene, d.island,
                      [&](int to, int from, int n) { data.a.segment(to, n) = x.joints.segment(from, n); });
  each_force_block(scene, data.f_offset, d.island,
                   [&](int to, int from, int n) { data.f.segment(to, n) = -x.rows.segment(from, n); });
  return true;
}

void complete_bodies(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  if (!by_bodies(d) || !d.bodies->in_parts) return;
  sparse::Refinement refinement;
  if (solve_whole(scene, data, d, refinement) == Reason::kNone) {
    d.first_error = refinement.first;
    return;
  }
  d.factor = nullptr;
  if (joint_space_size(*d.shape) > kMostJointSpace) return;
  make_joint_space(scene, *data.workspace, d);
  evaluate(scene, data.workspace->q, data.v, *data.workspace, d.island);
  factorize_again(scene, data, d, thread);
}

void make_joint_space(const Scene& scene, Workspace& w, IslandWork& d) {
  d.M.clear();
  d.J.clear();
  for (int r : d.island.robots) {
    if (w.robots[r].M.empty()) w.robots[r].M.resize(packed_size(*scene.robots[r].model));
    d.M.emplace_back(w.robots[r].M);
  }
  for (int c : d.island.contacts) {
    if (!w.joint_space[c]) {
      w.supports[c] = contact_support(scene, scene.contacts[c]);
      w.contacts[c] = ContactData<double>(scene.contacts[c], w.supports[c]);
      w.joint_space[c] = 1;
    }
    const Eigen::MatrixXd& J = w.contacts[c].J;
    d.J.emplace_back(J.data(), static_cast<std::size_t>(J.size()));
  }
}

void check_joint_space(const IslandWork& d, const char* function, const char* instead) {
  if (joint_space_size(*d.shape) > kMostJointSpace)
    throw std::length_error(std::string(function) + ": the blocks of an island with " + std::to_string(d.island.nv) +
                            " velocities are too many" + instead);
}

void joint_space_terms(const Scene& scene, const SceneData& data, IslandWork& d, const char* function) {
  if (!by_bodies(d) || data.workspace->robots[d.island.robots.front()].known) return;
  check_joint_space(d, function, ", ask for products (jvp, vjp)");
  make_joint_space(scene, *data.workspace, d);
  evaluate(scene, data.workspace->q, data.v, *data.workspace, d.island);
}

}  // namespace internal

}  // namespace manycontact
