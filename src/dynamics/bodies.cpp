#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "manycontact/contact/body_rows.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"

namespace manycontact {

BodyForm::BodyForm(const std::shared_ptr<IslandShape>& shape) : factor(shape->bodies()) {
  const BodyPattern& p = *shape->bodies();
  for (std::size_t k = 0; k < shape->scene().robots.size(); ++k) {
    const Model& model = *shape->scene().robots[k].model;
    kin.emplace_back(model);
    factor.system.armature.segment(shape->island().dof_offset[k], model.nv) = model.armature;
  }
  solution.resize(p);
}

namespace internal {

namespace {

using V6 = Vec6<double>;

// The rows' forces on their bodies, and what is left of them where bodies do not accelerate.
void evaluate_rows(const Scene& scene, const SceneData& data, const IslandWork& d, BodyForm& form) {
  Workspace& w = *data.workspace;
  BodySystem& s = form.factor.system;
  const V6 none = V6::Zero();
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const Contact& contact = scene.contacts[c];
    ContactData<double>& rows = w.contacts[c];
    body_rows(scene, contact, kinematics_at(form, d.island, contact.A), kinematics_at(form, d.island, contact.B), none,
              none, rows);
    rows.Jl.setConstant(std::numeric_limits<double>::quiet_NaN());  // not known now, should there be memory for it
    rows.J.setConstant(std::numeric_limits<double>::quiet_NaN());
    const int first = d.island.row_offset[k];
    for (int i = 0; i < contact.rows(); ++i) {
      const V6 unit = rows.W.row(i).transpose();
      if (s.pattern->A[first + i] >= 0) s.GA.col(first + i) = rows.aMA.act_force(unit);
      if (s.pattern->B[first + i] >= 0) s.GB.col(first + i) = -rows.bMA.act_force(unit);
      form.solution.b.rows[first + i] = wanted_in(data, c, i) - rows.a0[i];
    }
  }
}

void evaluate_bodies(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data, IslandWork& d) {
  BodyForm& form = *d.bodies;
  BodySystem& s = form.factor.system;
  BodyVectors& b = form.solution.b;
  s.delta = scene.damping;
  V6 base = V6::Zero();  // what bases accelerate with
  base.head<3>() = -scene.gravity;
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Model& model = *robot.model;
    data.workspace->robots[d.island.robots[k]].known = false;
    BodyKinematics<double>& kin = form.kin[k];
    const int o = s.pattern->node_offset[k], first = d.island.dof_offset[k];
    body_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), v.segment(robot.idx_v, model.nv), kin,
                            {s.r.data() + o,
                             {s.S.data() + static_cast<std::ptrdiff_t>(6) * first, 6, model.nv},
                             s.Y.data() + o,
                             b.motion.data() + o,
                             b.force.data() + o});
    b.joints.segment(first, model.nv) = data.tau.segment(robot.idx_v, model.nv);
    for (int i = o; i < o + model.njoints(); i = s.pattern->end[i]) b.motion[i] += base;
  }
  evaluate_rows(scene, data, d, form);
}

// Whether a row moves no coordinate by more than rounding: its E_kk is then noise, and has nothing to cancel with.
bool has_vanishing_row(const BodyForm& form) {
  const BodySystem& s = form.factor.system;
  const BodyPattern& p = *s.pattern;
  if (s.delta > 0) return false;
  const auto moved = [&](int node, V6 G) {  // the largest entry of J met first that is no rounding
    double largest = 0, size = 0;
    for (; node >= 0; G = force_from(G, s.r[node]), node = p.parent[node])
      for (int k = p.first_dof[node]; k < p.first_dof[node] + p.ndof[node]; ++k) {
        largest = std::max(largest, std::abs(G.dot(s.S.col(k))));
        size = std::max(size, G.cwiseAbs().dot(s.S.col(k).cwiseAbs()));
        if (largest > 1e-3 * size && largest > 0) return true;
      }
    return largest > tolerance::kRank * size;
  };
  for (int k = 0; k < p.nc; ++k)
    if (!moved(p.A[k], s.GA.col(k)) && !moved(p.B[k], s.GB.col(k))) return true;
  return false;
}

bool all_finite(const BodyVectors& x) {
  const auto finite = [](const V6& y) { return y.allFinite(); };
  return x.joints.allFinite() && x.rows.allFinite() && std::all_of(x.motion.begin(), x.motion.end(), finite) &&
         std::all_of(x.force.begin(), x.force.end(), finite);
}

}  // namespace

const BodyKinematics<double>* kinematics_at(const BodyForm& form, const Island& island, const Attachment& at) {
  return moves(at) ? &form.kin[local_robot(island, at.robot)] : nullptr;
}

bool solve_by_bodies(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data, IslandWork& d,
                     IslandReport& report) {
  BodyForm& form = *d.bodies;
  evaluate_bodies(scene, q, v, data, d);
  report.method = Method::kSparseBodies;
  report.reason = has_vanishing_row(form) ? Reason::kSmallPivot
                                          : factorize_bodies(form.factor.system, form.factor.ldl, &form.solution.b);
  if (report.reason != Reason::kNone) return false;
  const sparse::Refinement refinement =
      solve_refined(form.factor.system, form.factor.ldl, form.solution, tolerance::kRefinementSteps, true);
  report.factor_nonzeros = form.factor.nonzeros();
  report.refinement_steps = refinement.steps;
  const BodyVectors& x = form.solution.x;
  if (!(refinement.backward_error <= tolerance::kConverged)) {  // NaN where x is not finite
    report.reason = all_finite(form.solution.b) ? Reason::kLargeResidual : Reason::kNotFinite;
    return false;
  }
  d.factor = &form.factor;
  d.first_error = refinement.first;
  d.contradiction = d.was_dependent = false;
  each_velocity_block(scene, d.island,
                      [&](int to, int from, int n) { data.a.segment(to, n) = x.joints.segment(from, n); });
  each_force_block(scene, data.f_offset, d.island,
                   [&](int to, int from, int n) { data.f.segment(to, n) = -x.rows.segment(from, n); });
  const BodyResidual& left = form.solution.residual;
  report.backward_error = refinement.backward_error;
  report.residual_dynamics = left.dynamics == 0 ? 0 : left.dynamics / left.dynamics_scale;
  report.residual_contact = left.contact == 0 ? 0 : left.contact / std::max(left.contact_scale, scene.gravity.norm());
  return true;
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

void joint_space_terms(const Scene& scene, const SceneData& data, IslandWork& d, const char* function) {
  if (!by_bodies(d) || data.workspace->robots[d.island.robots.front()].known) return;
  if (joint_space_size(*d.shape) > kMostJointSpace)
    throw std::length_error(std::string(function) + ": the blocks of an island with " + std::to_string(d.island.nv) +
                            " velocities are too many, ask for products (jvp, vjp)");
  make_joint_space(scene, *data.workspace, d);
  evaluate(scene, data.workspace->q, data.v, *data.workspace, d.island);
}

}  // namespace internal

}  // namespace manycontact
