#include "held_velocities.hpp"

#include "manycontact/contact/turning_rows.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"
#include "manycontact/simulation/free_joints.hpp"

namespace manycontact::internal {

namespace {

constexpr double kSlow = 0x1p-30;  // factor s: the dynamics are solved at the velocities s v (held_velocities.hpp)

void copy_what_may_change(const Scene& from, Scene& to) {
  to.damping = from.damping;
  to.tolerance = from.tolerance;
  to.moment_length = from.moment_length;
  for (std::size_t r = 0; r < from.robots.size(); ++r) to.robots[r].base = from.robots[r].base;
  for (std::size_t c = 0; c < from.contacts.size(); ++c) {
    const Contact& contact = from.contacts[c];
    to.contacts[c].B.placement = contact.B.placement;
    to.contacts[c].reference_frame = contact.reference_frame;
    to.contacts[c].alpha = contact.alpha;
    to.contacts[c].beta = contact.beta / kSlow;
  }
}

Scene without_gravity(const Scene& from, double h, ResistingJoints& joints) {
  joints.vary = true;
  joints.find(from, {}, h);
  Scene out = joints.with_inertias(from);
  out.gravity.setZero();
  drop_applied_forces(out);
  copy_what_may_change(from, out);
  return out;
}

}  // namespace

HeldVelocities::RobotWork::RobotWork(const Model& model)
    : f(model.njoints(), Vec6<double>(Vec6<double>::Zero())),
      Yc(model.njoints()),
      M(packed_size(model)),
      rnea(model),
      by_q(model.nv, model.nv),
      by_v(model.nv, model.nv),
      inertia(model.nv, model.nv) {}

HeldVelocities::HeldVelocities(const DataCollector& of, std::size_t nw, double h)
    : joints(of.scene),
      scene(without_gravity(of.scene, h, joints)),
      solution(scene, of.solution.options),
      q(scene.nq),
      v(scene.nv),
      slow(scene.nv),
      tau(scene.nv),
      groups(scene),
      of_groups(scene, groups, 2 * scene.nv + static_cast<Eigen::Index>(nw)),
      q_next(scene.nq),
      v_next(scene.nv),
      h_(h),
      dtau_(scene.nv, 2 * scene.nv + static_cast<Eigen::Index>(nw)) {
  for (const Robot& robot : of.scene.robots) models_.push_back(robot.model);
  for (const Contact& contact : scene.contacts) contacts.emplace_back(contact, ContactSupport());
  for (const Robot& robot : scene.robots) {
    kin.emplace_back(*robot.model);
    robots_.emplace_back(*robot.model);
  }
  keep_dependent_as(of.solution, scene, solution);
  if (!has_applied_forces(of.scene)) return;
  applied_ = std::make_unique<AppliedForces<double>>(of.scene);
  scratch_ = std::make_unique<AppliedScratch>(*applied_);
  for (int r = 0; r < scene.nrobots(); ++r) all_robots_.push_back(r);
  for (Eigen::VectorXd* x : {&unit_, &by_q_, &by_v_}) x->setZero(scene.nv);
  dtau_dx_ = Eigen::MatrixXd::Ones(scene.nv, 2 * scene.nv).sparseView();
}

void HeldVelocities::take_torques(const DataCollector& of) {
  torques_ = of.actuation->tau;
  if (applied_)
    add_applied_forces<double>(of.scene, q.data(), v.data(), of.solution.wrenches, *applied_, torques_.data());
}

// Computes dtau_dx_ by reverse differentiation of the applied forces, which gives one row per torque.
void HeldVelocities::differentiate_torques(const DataCollector& of) {
  if (!applied_) return;
  take_torques(of);
  for (int i = 0; i < scene.nv; ++i) {
    unit_[i] = 1;
    by_q_.setZero();
    by_v_.setZero();
    add_applied_adjoint(of.scene, v.data(), *applied_, all_robots_, unit_.data(), *scratch_, by_q_.data(), by_v_.data(),
                        nullptr);
    unit_[i] = 0;
    for (int j = 0; j < scene.nv; ++j) {
      dtau_dx_.coeffRef(i, j) = by_q_[j];
      dtau_dx_.coeffRef(i, scene.nv + j) = by_v_[j];
    }
  }
  for (Eigen::Index c = 0; c < of.actuation->dtau_dx.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator it(of.actuation->dtau_dx, c); it; ++it)
      dtau_dx_.coeffRef(it.row(), it.col()) += it.value();
}

void HeldVelocities::kinematics_at_start(const DataCollector& of) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), kin[r]);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), turn_.data() + robot.idx_v, of.scene.gravity,
                                  kin[r]);
  }
}

// Sets alpha = 0 for contacts with rotating rows, whose placement errors are not corrected (simulation/internal.hpp).
void HeldVelocities::leave_out_alpha_of_turning_rows() {
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    Contact& contact = scene.contacts[c];
    if (!solution.active[c] || !leaves_directions(contact)) continue;
    contact_rows<double>(scene, contact, {}, kin[contact.A.robot],
                         contact.B.robot < 0 ? nullptr : &kin[contact.B.robot], contacts[c]);
    if (!turning_of_rows(contact, contacts[c]).isZero(0)) contact.alpha = 0;
  }
}

void HeldVelocities::solve_at(const ConstVectorRef& state, double h, const DataCollector& of) {
  q = state.head(scene.nq);
  v = state.tail(scene.nv);
  slow = kSlow * v;
  stop_in_a_step(scene, v, h, turn_);
  turn_ += v / h;
  copy_what_may_change(of.scene, scene);
  solution.active = of.solution.active;
  kinematics_at_start(of);
  leave_out_alpha_of_turning_rows();
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    // This is the robot of of.scene, because the joint inertias of `scene` change below.
    const Robot& robot = of.scene.robots[r];
    const Model& model = *robot.model;
    inverse_dynamics<double>(model, kin[r], turn_.data() + robot.idx_v, {}, robots_[r].f,
                             tau.segment(robot.idx_v, model.nv));
  }
  take_torques(of);
  torques_of_motion_ = torques_ - tau;
  begin_free_motion(of.scene, solution.active, torques_, h, kin, groups);
  for (const int i : joints.rubbing) joints.slip[i] = 0;  // so that the result depends only on the state
  joints.begun = false;
  for (int k = 0; k < kMostSolves; ++k) {
    joints.set_inertias(of.scene, h);
    tau = torques_of_motion_;
    for (int i = 0; i < scene.nv; ++i) tau[i] -= joints.drag(i, h) / h * v[i];
    joints.add_sliding(1, tau);
    (void)solve_tau(scene, q, slow, tau, solution);
    if (joints.rubbing.empty()) return;
    x = v + h * solution.a;
    if (joints.settles(of.scene, solution, h, x)) return;
  }
}

bool HeldVelocities::serve(const DataCollector& of, double h) {
  if (h != h_) return false;
  for (std::size_t r = 0; r < models_.size(); ++r)
    if (models_[r] != of.scene.robots[r].model) return false;
  joints.find(of.scene, {}, h);
  if (!joints.fits(of.scene)) return false;
  joints.added = joints.to_add;
  return true;
}

void HeldVelocities::finish_step(const DataCollector& of, double h, Eigen::VectorXd& xnext) {
  x = v + h * solution.a;
  end_free_joints(scene, q, x, h, scratch_of_end_, q_next, v_next);
  end_free_motion(of.scene, q_next, v_next, kin, groups);
  xnext << q_next, v_next;
}

// Computes the derivatives F of the accelerations, with the inverse dynamics b = ID(q, v, -w x v):
//     F = [a_q, s a_v, 0] + a_tau G        G = [dtau/dx dtau/dw] - [b_q b_v 0] - (damping of joints)
void HeldVelocities::differentiate_at(const DataCollector& of, Eigen::Ref<Eigen::MatrixXd> F) {
  const int nv = scene.nv;
  dtau_.setZero();
  const auto add = [&](const Eigen::SparseMatrix<double>& B, Eigen::Index first) {
    for (Eigen::Index c = 0; c < B.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator it(B, c); it; ++it) dtau_(it.row(), first + c) += it.value();
  };
  differentiate_torques(of);
  add(dtau_dx(of), 0);
  add(of.actuation->dtau_du, 2 * nv);
  kinematics_at_start(of);
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    RobotWork& w = robots_[r];
    crba<double>(model, kin[r], w.Yc, w.M.data());
    rnea_derivatives<double>(model, kin[r], w.Yc, {}, w.rnea);
    unpack_tree(model, w.rnea.dq_lower, w.rnea.dq_upper, w.by_q);
    unpack_tree(model, w.rnea.dv_lower, w.rnea.dv_upper, w.by_v);
    const int o = robot.idx_v;
    dtau_.block(o, o, model.nv, model.nv) -= w.by_q;
    dtau_.block(o, nv + o, model.nv, model.nv) -= w.by_v;
    unpack_inertia<double>(model, w.M.data(), w.inertia);
    for (int i = o; i < o + model.nv; ++i) {
      dtau_(i, nv + i) -= joints.drag(i, h_) / h_;
      w.inertia(i - o, i - o) -= joints.inertia(i, h_);
    }
    for (const Joint& joint : model.joints)
      if (const int at = joint.idx_v, n = joint.nv(); n > 1)
        dtau_.block(o, nv + o + at, model.nv, n) +=
            w.inertia.middleCols(at, n).lazyProduct(derivative_of_turn(joint, v.segment(o + at, n)));
  }
  const DerivativeData& all = differentiate(scene, solution, {true, true, true, false, true});
  for (std::size_t i = 0; i < all.islands.size(); ++i) {
    const IslandDerivatives& d = all.islands[i];
    // calls use(first row in the island, first row in the scene, number of rows) for each robot
    const auto each = [&](auto&& use) {
      int row = 0;
      for (int r : solved_island(solution, i).robots) {
        const Robot& robot = scene.robots[r];
        use(row, robot.idx_v, robot.model->nv);
        row += robot.model->nv;
      }
    };
    of_island_.resize(d.nv, dtau_.cols());
    done_.resize(d.nv, dtau_.cols());
    each([&](int row, int at, int n) { of_island_.middleRows(row, n) = dtau_.middleRows(at, n); });
    done_.noalias() = d.da_du() * of_island_;
    each([&](int row, int at, int n) {
      done_.middleCols(at, n) += d.da_dq().middleCols(row, n);
      done_.middleCols(nv + at, n) += kSlow * d.da_dv().middleCols(row, n);
    });
    each([&](int row, int at, int n) { F.middleRows(at, n) = done_.middleRows(row, n); });
  }
}

void HeldVelocities::differentiate_finish(const DataCollector& of, double h, Eigen::MatrixXd& F) {
  kinematics_at_start(of);
  differentiate_free_joints(scene, x, h, F);
  differentiate_begin(of.scene, dtau_dx(of), of.actuation->dtau_du, torques_, h, kin, groups, of_groups);
  differentiate_end(of.scene, q_next, v_next, kin, groups, of_groups, F);
}

}  // namespace manycontact::internal
