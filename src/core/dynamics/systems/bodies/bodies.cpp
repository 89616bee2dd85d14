#include "bodies.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "../../internal.hpp"
#include "manycontact/contact/body_rows.hpp"
#include "manycontact/rank/contradiction.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/rank/row_units.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

BodiesSystem::BodiesSystem(IslandWork& island, const simd::Level* level)
    : owner(island), subtrees(&island.shape->body_subtrees()), factor(island.shape->bodies()) {
  for (const Robot& robot : island.shape->scene().robots) kin.emplace_back(*robot.model);
  if (subtrees->cuts.empty()) return;
  held.resize(subtrees->cuts.size());
  reaction.resize(subtrees->cuts.size());
  for (const BodySubtree& subtree : subtrees->subtrees)
    if (subtree.shape == static_cast<int>(shapes.size())) shapes.emplace_back(subtree.pattern, level);
}

BodiesSystem::Shape::Shape(std::shared_ptr<const BodyPattern> of, const simd::Level* level) : pattern(std::move(of)) {
  ldl.resize(*pattern);
  if (level && lanes::SubtreePlan::fits(*pattern)) {
    auto plan = std::make_shared<const lanes::SubtreePlan>(pattern);
    if (plan->schedule.compiled()) lanes = level->robots.make_subtrees(plan);
  }
  slots.resize(lanes ? static_cast<std::size_t>(level->robots.width) : 1);
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

void evaluate_node(const Scene& scene, const SceneData& data, BodiesSystem& bodies, std::size_t k, int joint, int at,
                   int dof, BodySystem& s, BodyVectors& b) {
  const Robot& robot = scene.robots[bodies.owner.island.robots[k]];
  const Model& model = *robot.model;
  const Joint& of = model.joints[joint];
  body_kinematics<double>(model, robot.base, joint, data.workspace->q.segment(robot.idx_q, model.nq),
                          data.v.segment(robot.idx_v, model.nv), bodies.kin[k],
                          {&s.r[at], s.S.col(dof).data(), &s.Y[at], &b.motion[at], &b.force[at]});
  for (int i = 0; i < of.nv(); ++i) {
    s.armature[dof + i] = model.armature[of.idx_v + i];
    b.joints[dof + i] = data.tau[robot.idx_v + of.idx_v + i];
  }
  if (of.parent < 0) b.motion[at].head<3>() -= scene.gravity;  // gravity as an acceleration of the bases
}

// Evaluates the unit forces of the rows on both bodies, and the right-hand side: prescribed acceleration minus a0.
void evaluate_rows(const Scene& scene, const SceneData& data, const BodiesSystem& bodies, std::size_t k, int first,
                   BodySystem& s, BodyVectors& b) {
  const V6 none = V6::Zero();
  const int c = bodies.owner.island.contacts[k];
  const Contact& contact = scene.contacts[c];
  ContactData<double>& rows = data.workspace->contacts[c];
  body_rows(scene, contact, kinematics_at(bodies, contact.A), kinematics_at(bodies, contact.B), none, none, rows);
  data.workspace->rows_state[c] = data.workspace->state;
  keep_left(*data.workspace, c, rows);
  rows.Jl.setConstant(std::numeric_limits<double>::quiet_NaN());  // not computed by this system
  rows.J.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < contact.rows(); ++i) {
    const V6 unit = rows.W.row(i).transpose();
    if (s.pattern->A[first + i] >= 0) s.GA.col(first + i) = rows.aMA.act_force(unit);
    if (s.pattern->B[first + i] >= 0) s.GB.col(first + i) = -rows.bMA.act_force(unit);
    b.rows[first + i] = prescribed_in(data, c, i) - rows.a0[i];
  }
}

namespace {

void evaluate_bodies(const Scene& scene, const SceneData& data, BodiesSystem& bodies) {
  const Island& island = bodies.owner.island;
  bodies.factor.make_room();
  bodies.solution.resize(*bodies.factor.system.pattern);
  BodySystem& s = bodies.factor.system;
  s.delta = scene.damping;
  begin_evaluation(scene, data, bodies);
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const int o = s.pattern->node_offset[k];
    for (int i = 0; i < scene.robots[island.robots[k]].model->njoints(); ++i)
      evaluate_node(scene, data, bodies, k, i, o + i, s.pattern->first_dof[o + i], s, bodies.solution.b);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k)
    evaluate_rows(scene, data, bodies, k, island.row_offset[k], s, bodies.solution.b);
}

bool all_finite(const BodyVectors& x) {
  const auto finite = [](const V6& y) { return y.allFinite(); };
  return x.joints.allFinite() && x.rows.allFinite() && std::all_of(x.motion.begin(), x.motion.end(), finite) &&
         std::all_of(x.force.begin(), x.force.end(), finite);
}

// Returns the largest terms of the bodies' accelerations. lever: set to the largest moment arm.
RowTerms<double> terms_of_bodies(const Workspace& work, const BodiesSystem& bodies, double& lever) {
  RowTerms<double> out;
  for (const V6& c : bodies.solution.b.motion) {
    out.linear = std::max(out.linear, c.head<3>().cwiseAbs().maxCoeff());
    out.angular = std::max(out.angular, c.tail<3>().cwiseAbs().maxCoeff());
  }
  lever = 0;
  for (const BodyKinematics<double>& kin : bodies.kin)
    for (std::size_t i = 0; i < kin.v.size(); ++i) {
      const double w = kin.v[i].tail<3>().cwiseAbs().maxCoeff();
      out.linear = std::max(out.linear, w * kin.v[i].head<3>().cwiseAbs().maxCoeff());
      out.angular = std::max(out.angular, w * w);
      lever = std::max(lever, kin.p[i].cwiseAbs().maxCoeff());
    }
  for (int c : bodies.owner.island.contacts)
    lever =
        std::max({lever, work.contacts[c].aMA.p.cwiseAbs().maxCoeff(), work.contacts[c].bMA.p.cwiseAbs().maxCoeff()});
  out.linear = std::max(out.linear, out.angular * lever);
  return out;
}

// Returns the inconsistency of contacts. Moment arms replace the sizes of rows of J, which are not computed here.
rank::Contradiction<double> contradiction_of(const Scene& scene, const Workspace& work, BodiesSystem& bodies) {
  rank::Contradiction<double> of;
  std::tie(of.Ja, of.a0) = row_terms_of_joints(bodies.factor.system, bodies.solution);
  double lever;
  const RowTerms<double> of_bodies = terms_of_bodies(work, bodies, lever);
  const Island& island = bodies.owner.island;
  of.add_rows([&](auto&& use) {
    for (std::size_t k = 0; k < island.contacts.size(); ++k) {
      const int c = island.contacts[k];
      const Contact& contact = scene.contacts[c];
      double origin = 0;
      for (const Attachment* at : {&contact.A, &contact.B})
        if (const BodyKinematics<double>* kin = kinematics_at(bodies, *at))
          origin += kin->p[at->joint].cwiseAbs().maxCoeff();
      if (contact.B.robot < 0) origin += contact.B.placement.p.cwiseAbs().maxCoeff();
      const RowTerms<double> terms = row_terms<double>(contact, work.contacts[c], origin);
      for (int i = 0; i < contact.rows(); ++i) {
        const auto [linear, angular] = row_weights(work.contacts[c], i);
        use({linear * lever + angular,
             std::max(terms.of_row(i), linear * of_bodies.linear + angular * of_bodies.angular),
             bodies.dependence.null_component[island.row_offset[k] + i]});
      }
    }
  });
  return of;
}

// Solves without the redundant rows, whose inconsistency is removed from b, but is part of the reported residual.
Reason solve_without_dependent(BodiesSystem& bodies, sparse::Refinement& refinement) {
  BodySolve& v = bodies.solution;
  const BodySystem& s = bodies.factor.system;
  const Reason reason = factorize_dependent(s, bodies.factor.ldl, bodies.dependence);
  if (reason != Reason::kNone) return reason;
  refinement = solve_dependent(s, bodies.factor.ldl, v, tolerance::kRefinementSteps, bodies.dependence);
  if (!(refinement.backward_error <= tolerance::kConverged)) return Reason::kLargeResidual;
  v.b.rows += bodies.dependence.null_component;
  refinement.backward_error = backward_error(s, v.b, v.x, v.residual);
  return Reason::kNone;
}

// Whether sparse-bodies drops redundant rows. With few coordinates MatrixSystem is as fast, and has derivatives, too.
bool drops_rows_here(const Scene& scene, const SceneData& data, const Island& island) {
  return may_drop_rows(scene, island.contacts) &&
         (data.options.method == Method::kSparseBodies || island.nv >= tolerance::kFewCoordinates);
}

// Solves the whole island. Returns kNone if factor and solution are sound.
Reason solve_whole(const Scene& scene, const SceneData& data, BodiesSystem& bodies, sparse::Refinement& refinement) {
  evaluate_bodies(scene, data, bodies);
  Reason reason =
      factorize_and_solve(bodies.factor.system, bodies.factor.ldl, bodies.dependence, bodies.solution, refinement);
  if (reason == Reason::kSmallPivot && drops_rows_here(scene, data, bodies.owner.island))
    reason = solve_without_dependent(bodies, refinement);
  bodies.state = data.workspace->state;
  bodies.sound = reason == Reason::kNone;
  return reason;
}

}  // namespace

void begin_evaluation(const Scene& scene, const SceneData& data, BodiesSystem& bodies) {
  const Island& island = bodies.owner.island;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    if (OnDemand<RobotData>& robots = data.workspace->robots; robots.has(island.robots[k]))
      robots[island.robots[k]].state = 0;
    place_trees<double>(*robot.model, robot.base, data.workspace->q.segment(robot.idx_q, robot.model->nq),
                        bodies.kin[k]);
  }
}

Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodyDependence& work, BodySolve& solve,
                           sparse::Refinement& refinement) {
  forget_dropped(ldl);
  if (has_vanishing_row(system, work)) return Reason::kSmallPivot;
  const Reason reason = factorize_bodies(system, ldl, &solve.b);
  if (reason != Reason::kNone) return reason;
  refinement = solve_lifted(system, ldl, solve, tolerance::kRefinementSteps);
  if (refinement.backward_error <= tolerance::kConverged) return Reason::kNone;  // false if x is NaN
  return all_finite(solve.b) ? Reason::kLargeResidual : Reason::kNotFinite;
}

void BodyAnswer::add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& refined) {
  const auto take = [](auto& largest, auto x) { largest = std::max(largest, x); };
  nonzeros += factor_nonzeros;
  take(refinement.steps, refined.steps);
  take(refinement.backward_error, refined.backward_error), take(refinement.first, refined.first);
  take(r[0], left.dynamics), take(scale[0], left.dynamics_scale);
  take(r[1], left.contact), take(scale[1], left.contact_scale);
}

namespace {

void report_answer(const Scene& scene, const BodyAnswer& x, IslandReport& report) {
  report.method = Method::kSparseBodies;
  report.reason = Reason::kNone;
  report.factor_nonzeros = x.nonzeros;
  report.refinement_steps = x.refinement.steps;
  report.backward_error = x.refinement.backward_error;
  report_residuals(scene, x.r, x.scale, report);
}

}  // namespace

const BodyKinematics<double>* kinematics_at(const BodiesSystem& bodies, const Attachment& at) {
  return moves(at) ? &bodies.kin[local_robot(bodies.owner.island, at.robot)] : nullptr;
}

}  // namespace internal

bool BodiesSystem::solve(const Scene& scene, SceneData& data, ThreadWork&, IslandReport& report) {
  internal::BodyAnswer by_subtrees, whole;
  if (internal::solve_by_subtrees(scene, data, *this, by_subtrees)) {
    internal::report_answer(scene, by_subtrees, report);
    return true;
  }
  report.method = Method::kSparseBodies;
  sparse::Refinement refinement;
  report.reason = internal::solve_whole(scene, data, *this, refinement);
  if (!sound) return false;
  whole.add(nonzeros(*factor.system.pattern, factor.ldl), solution.residual, refinement);
  internal::report_answer(scene, whole, report);
  if (std::ranges::any_of(owner.island.contacts, [&](int c) { return scene.contacts[c].pair != nullptr; })) {
    const auto [Ja, a0] = row_terms_of_joints(factor.system, solution);  // terms of rows without gravity
    report.contact_terms = Ja + a0;
  }
  if (!factor.ldl.found.empty()) {
    internal::report_dependent_rows(scene, data, owner, dependence.rows.dropped,
                                    internal::contradiction_of(scene, *data.workspace, *this), report);
    report.order = Order::kLeafToRoot;
  }
  const BodyVectors& x = solution.x;
  each_velocity_block(scene, owner.island,
                      [&](int to, int from, int n) { data.a.segment(to, n) = x.joints.segment(from, n); });
  each_force_block(scene, data.f_offset, owner.island,
                   [&](int to, int from, int n) { data.f.segment(to, n) = -x.rows.segment(from, n); });
  return true;
}

bool BodiesSystem::make_current(const Scene& scene, const SceneData& data) {
  sparse::Refinement refinement;
  if (state != data.workspace->state) (void)internal::solve_whole(scene, data, *this, refinement);
  return sound && factor.ldl.found.empty();
}

bool BodiesSystem::differentiate(const Scene& scene, SceneData& data, ThreadWork&, IslandDerivatives& out) {
  if (!make_current(scene, data)) return false;
  internal::evaluate_at_state(scene, data, owner);
  const AtSolution at(scene, data, owner.island);
  internal::right_hand_sides(scene, data, owner, out);
  if (out.cols > 0) factor.solve_panel(out.X.data(), static_cast<int>(out.X.cols()));
  out.X.bottomRows(out.nc) *= -1;
  return !out.X.hasNaN();
}

}  // namespace manycontact
