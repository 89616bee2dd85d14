// Functions of algorithm/rigid_body.hpp in joint space: rnea, aba, crba, the Coriolis matrix, and derivatives.

#include <limits>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/inertia_factor.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "rigid_body_memory.hpp"

namespace manycontact {

using internal::ConstRef;
using internal::each_robot;
using internal::memory_of;
using internal::RigidBodyMemory;
using internal::RobotMemory;

RigidBodyData::RigidBodyData(const RigidBodies& bodies) : memory(std::make_unique<RigidBodyMemory>()) {
  RigidBodyMemory& m = *memory;
  for (const Robot& robot : bodies.robots()) m.robots.emplace_back(*robot.model);
  m.zero = m.v = m.a = m.tau = m.h = m.g = m.qdd = m.driving = Eigen::VectorXd::Zero(bodies.nv());
  m.q = neutral(bodies);
  each_robot(bodies, m, [&m](const Robot& robot, RobotMemory& of, int iq, int) {
    forward_kinematics<double>(*robot.model, robot.base, m.q.segment(iq, robot.model->nq), of.kin);
  });
}
RigidBodyData::~RigidBodyData() = default;
RigidBodyData::RigidBodyData(RigidBodyData&&) noexcept = default;
RigidBodyData& RigidBodyData::operator=(RigidBodyData&&) noexcept = default;

namespace internal {

void move(const RigidBodies& bodies, RigidBodyMemory& m) {
  if (m.moving) return;
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    forward_accelerations<double>(*robot.model, m.zero.segment(iv, robot.model->nv), nullptr, bodies.gravity(), of.kin);
  });
  m.moving = true;
}

void compose(const RigidBodies& bodies, RigidBodyMemory& m) {
  if (m.composed) return;
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int) {
    of.M.resize(packed_size(*robot.model));
    crba<double>(*robot.model, of.kin, of.Yc, of.M.data());
  });
  m.composed = true;
}

namespace {

// Computes the kinematics at q and, if v is given, for v and a (nullptr: zero).
void take(const RigidBodies& bodies, const ConstRef& q, const ConstRef* v, const double* a, RigidBodyMemory& m) {
  m.composed = m.carries = false;
  m.moving = v != nullptr;
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int iq, int iv) {
    const Model& model = *robot.model;
    forward_kinematics<double>(model, robot.base, q.segment(iq, model.nq), of.kin);
    if (v)
      forward_accelerations<double>(model, v->segment(iv, model.nv), a ? a + iv : nullptr, bodies.gravity(), of.kin);
  });
  m.q = q;
  m.v = v ? *v : ConstRef(m.zero);
  m.a = Eigen::Map<const Eigen::VectorXd>(a ? a : m.zero.data(), m.zero.size());
}

void check_state(const char* function, const RigidBodies& bodies, const ConstRef& q, const ConstRef* v,
                 const ConstRef* third = nullptr, const char* what = "a") {
  expect_configuration(function, "q", q, bodies);
  if (v) expect_numbers(function, "v", *v, bodies.nv());
  if (third) expect_numbers(function, what, *third, bodies.nv());
}

// Checks q, v and a, and computes the kinematics of the data at this state.
RigidBodyMemory& at_state(const char* function, const RigidBodies& bodies, const ConstRef& q, const ConstRef* v,
                          const ConstRef* a, RigidBodyData& data) {
  check_state(function, bodies, q, v, a);
  RigidBodyMemory& m = memory_of(function, bodies, data);
  take(bodies, q, v, a ? a->data() : nullptr, m);
  return m;
}

void check_forces(const char* function, const RigidBodies& bodies, ForcesOnBodies fext) {
  if (!fext.empty() && fext.size() != static_cast<std::size_t>(bodies.njoints()))
    throw std::invalid_argument(std::string(function) + ": fext has " + std::to_string(fext.size()) +
                                " forces, expected none or one for each of " + std::to_string(bodies.njoints()) +
                                " joints");
}

// Transforms the forces fext on a robot's bodies from child frames to the tree frame, as of.fext.
void take_forces(ForcesOnBodies& fext, RobotMemory& of) {
  of.fext.clear();
  if (fext.empty()) return;
  for (std::size_t i = 0; i < of.f.size(); ++i) of.fext.push_back(of.kin.oMi[i].act_force(fext[i]));
  fext = fext.subspan(of.f.size());
}

// Computes torques tau for accelerations a (nullptr: 0): inverse dynamics minus joint friction and joint springs.
void torques(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, const double* a, ForcesOnBodies fext,
             RigidBodyMemory& m, Eigen::VectorXd& tau) {
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    take_forces(fext, of);
    inverse_dynamics<double>(*robot.model, of.kin, a ? a + iv : nullptr, of.fext, of.f,
                             tau.segment(iv, robot.model->nv));
    add_friction(*robot.model, v.data() + iv, tau.data() + iv, -1);
  });
  each_joint_spring(bodies, [&](const JointSpring& s, int iq, int iv) { tau[iv] += s.stiffness * (q[iq] - s.rest); });
  m.carries = true;
}

}  // namespace
}  // namespace internal

// ---- kinematics at a state -----------------------------------------------------------------------------------------

void forward_kinematics(const RigidBodies& bodies, const ConstRef& q, RigidBodyData& data) {
  internal::at_state("forward_kinematics", bodies, q, nullptr, nullptr, data);
}

void forward_kinematics(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, RigidBodyData& data) {
  internal::at_state("forward_kinematics", bodies, q, &v, nullptr, data);
}

void forward_kinematics(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, const ConstRef& a,
                        RigidBodyData& data) {
  internal::at_state("forward_kinematics", bodies, q, &v, &a, data);
}

// ---- torques and accelerations -------------------------------------------------------------------------------------

const Eigen::VectorXd& rnea(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, const ConstRef& a,
                            RigidBodyData& data, ForcesOnBodies fext) {
  internal::check_forces("rnea", bodies, fext);
  RigidBodyMemory& m = internal::at_state("rnea", bodies, q, &v, &a, data);
  internal::torques(bodies, q, v, a.data(), fext, m, m.tau);
  return m.tau;
}

const Eigen::VectorXd& nonlinear_effects(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v,
                                         RigidBodyData& data) {
  RigidBodyMemory& m = internal::at_state("nonlinear_effects", bodies, q, &v, nullptr, data);
  internal::torques(bodies, q, v, nullptr, {}, m, m.h);
  return m.h;
}

const Eigen::VectorXd& gravity_torques(const RigidBodies& bodies, const ConstRef& q, RigidBodyData& data) {
  internal::check_state("gravity_torques", bodies, q, nullptr);
  RigidBodyMemory& m = memory_of("gravity_torques", bodies, data);
  const ConstRef at_rest = m.zero;
  internal::take(bodies, q, &at_rest, nullptr, m);
  internal::torques(bodies, q, at_rest, nullptr, {}, m, m.g);
  return m.g;
}

const Eigen::VectorXd& aba(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, const ConstRef& tau,
                           RigidBodyData& data, ForcesOnBodies fext) {
  internal::check_state("aba", bodies, q, &v, &tau, "tau");
  internal::check_forces("aba", bodies, fext);
  RigidBodyMemory& m = memory_of("aba", bodies, data);
  m.driving = tau;
  internal::each_joint_spring(
      bodies, [&](const JointSpring& s, int iq, int iv) { m.driving[iv] -= s.stiffness * (q[iq] - s.rest); });
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int iq, int iv) {
    const Model& model = *robot.model;
    if (!of.aba) of.aba.emplace(model);
    add_friction(model, v.data() + iv, m.driving.data() + iv);
    const ForcesOnBodies own = fext.subspan(0, fext.empty() ? 0 : of.f.size());
    fext = fext.subspan(own.size());
    (void)aba<double>(model, robot.base, q.segment(iq, model.nq), v.segment(iv, model.nv),
                      m.driving.segment(iv, model.nv), bodies.gravity(), own, of.kin, *of.aba,
                      m.qdd.segment(iv, model.nv));  // NaN if aba returns false
  });
  m.composed = m.carries = false;
  m.moving = true;  // kin.a now has the bias accelerations (a = 0)
  m.q = q;
  m.v = v;
  m.a.setZero();
  return m.qdd;
}

// ---- inertia matrix M and its inverse ------------------------------------------------------------------------------

const Eigen::MatrixXd& crba(const RigidBodies& bodies, const ConstRef& q, RigidBodyData& data) {
  RigidBodyMemory& m = internal::at_state("crba", bodies, q, nullptr, nullptr, data);
  internal::compose(bodies, m);
  const Eigen::Index nv = m.zero.size();
  if (m.M.rows() != nv) m.M.setZero(nv, nv);
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    const Model& model = *robot.model;
    unpack_inertia<double>(model, of.M.data(), m.M.block(iv, iv, model.nv, model.nv));
  });
  return m.M;
}

namespace {

// Overwrites of.panel with M^-1 of.panel, or with NaN if M is singular. Overwrites the packed M with its factors L, D.
void solve_panel(RigidBodyMemory& m, RobotMemory& of) {
  m.composed = false;
  if (factorize_inertia(*of.model, of.M.data(), of.diagonal.data()).empty())
    solve_inertia(*of.model, of.M.data(), static_cast<int>(of.panel.cols()), of.panel.data());
  else
    of.panel.setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

Eigen::MatrixXd inverse_inertia_times(const RigidBodies& bodies, const ConstRef& q,
                                      const Eigen::Ref<const Eigen::MatrixXd>& X, RigidBodyData& data) {
  internal::check_state("inverse_inertia_times", bodies, q, nullptr);
  expect_size("inverse_inertia_times", "a column of X", X.rows(), bodies.nv());
  RigidBodyMemory& m = memory_of("inverse_inertia_times", bodies, data);
  internal::take(bodies, q, nullptr, nullptr, m);
  internal::compose(bodies, m);
  Eigen::MatrixXd out(X.rows(), X.cols());
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    of.panel = X.middleRows(iv, robot.model->nv);
    solve_panel(m, of);
    out.middleRows(iv, robot.model->nv) = of.panel;
  });
  return out;
}

// ---- derivatives of inverse and forward dynamics -------------------------------------------------------------------

namespace {

// Computes each robot's packed derivatives of RNEA at the state of kin, and its packed M.
void differentiate(const RigidBodies& bodies, ForcesOnBodies fext, RigidBodyMemory& m) {
  internal::compose(bodies, m);
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int) {
    if (!of.derivatives) of.derivatives.emplace(*robot.model);
    internal::take_forces(fext, of);
    rnea_derivatives<double>(*robot.model, of.kin, of.Yc, of.fext, *of.derivatives);
  });
}

void dense_torques(const RigidBodies& bodies, const ConstRef& v, RigidBodyMemory& m) {
  const Eigen::Index nv = m.zero.size();
  TorqueDerivatives& out = m.torque;
  for (Eigen::MatrixXd* D : {&out.dq, &out.dv, &out.da})
    if (D->rows() != nv) D->setZero(nv, nv);
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    const Model& model = *robot.model;
    const RneaDerivatives& d = *of.derivatives;
    unpack_tree(model, d.dq_lower, d.dq_upper, out.dq.block(iv, iv, model.nv, model.nv));
    unpack_tree(model, d.dv_lower, d.dv_upper, out.dv.block(iv, iv, model.nv, model.nv));
    unpack_inertia<double>(model, of.M.data(), out.da.block(iv, iv, model.nv, model.nv));
    for (int i = 0; i < model.nv; ++i) out.dv(iv + i, iv + i) += friction_slope(model, i, v[iv + i]);
  });
  internal::each_joint_spring(bodies, [&](const JointSpring& s, int, int iv) { out.dq(iv, iv) += s.stiffness; });
}

}  // namespace

const TorqueDerivatives& rnea_derivatives(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v,
                                          const ConstRef& a, RigidBodyData& data, ForcesOnBodies fext) {
  internal::check_forces("rnea_derivatives", bodies, fext);
  RigidBodyMemory& m = internal::at_state("rnea_derivatives", bodies, q, &v, &a, data);
  differentiate(bodies, fext, m);
  dense_torques(bodies, v, m);
  return m.torque;
}

// The derivatives da solve M da = dtau - dID(q, v, a), with ID = rnea.
const AccelerationDerivatives& aba_derivatives(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v,
                                               const ConstRef& tau, RigidBodyData& data, ForcesOnBodies fext) {
  RigidBodyMemory& m = memory_of("aba_derivatives", bodies, data);
  const Eigen::VectorXd& a = aba(bodies, q, v, tau, data, fext);
  internal::take(bodies, q, &v, a.data(), m);
  differentiate(bodies, fext, m);
  dense_torques(bodies, v, m);
  AccelerationDerivatives& out = m.acceleration;
  const Eigen::Index all = m.zero.size();
  for (Eigen::MatrixXd* D : {&out.dq, &out.dv, &out.dtau})
    if (D->rows() != all) D->setZero(all, all);
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    const int nv = robot.model->nv;
    of.panel.resize(nv, 3 * nv);
    of.panel.leftCols(nv) = -m.torque.dq.block(iv, iv, nv, nv);
    of.panel.middleCols(nv, nv) = -m.torque.dv.block(iv, iv, nv, nv);
    of.panel.rightCols(nv).setIdentity();
    solve_panel(m, of);
    out.dq.block(iv, iv, nv, nv) = of.panel.leftCols(nv);
    out.dv.block(iv, iv, nv, nv) = of.panel.middleCols(nv, nv);
    out.dtau.block(iv, iv, nv, nv) = of.panel.rightCols(nv);
  });
  return out;
}

// For an ancestor j of i, C_ij = S_i^T (B S_j + Yc Sd_j) and C_ji = S_j^T (B S_i + Yc Sd_i), with Sd_j = v_j x S_j.
// Yc and 2B are the sums of Y and of (v x*) Y - Y (v x) + (Y v) xbar* over the subtree of i
// (detail/algorithm/rnea_derivatives.hpp).
Eigen::MatrixXd coriolis_matrix(const RigidBodies& bodies, const ConstRef& q, const ConstRef& v, RigidBodyData& data) {
  RigidBodyMemory& m = internal::at_state("coriolis_matrix", bodies, q, &v, nullptr, data);
  differentiate(bodies, {}, m);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(m.zero.size(), m.zero.size());
  each_robot(bodies, m, [&](const Robot& robot, RobotMemory& of, int, int iv) {
    const Model& model = *robot.model;
    const RneaDerivatives& d = *of.derivatives;
    const auto Sd = [&](int j) -> Vec6<double> { return d.Sv.col(j) - d.Psid.col(j); };
    for (int i = 0; i < model.nv; ++i) {
      const int joint = model.dof_joint[i];
      const Vec3<double>& l = d.l[joint];
      const Inertia<double>& Yc = of.Yc[joint];
      const auto rate = [&](const Vec6<double>& s, const Vec6<double>& sd) -> Vec6<double> {  // B s + Yc sd
        Vec6<double> out = Yc * sd;
        const Vec3<double> w = s.tail<3>();
        out.head<3>() -= l.cross(w);
        out.tail<3>() += 0.5 * (d.C[joint] * w);
        return out;
      };
      const Vec6<double> s = of.kin.J.col(i), own = rate(s, Sd(i));
      for (int j = i; j >= 0; j = model.dof_parent[j]) {
        C(iv + j, iv + i) = of.kin.J.col(j).dot(own);
        C(iv + i, iv + j) = s.dot(rate(of.kin.J.col(j), Sd(j)));
      }
    }
  });
  return C;
}

}  // namespace manycontact
