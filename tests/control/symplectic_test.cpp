// The node is simulate's step: values agree with `step`. Derivatives agree with quadruple-precision differences where
// no momentum is corrected and for one tree where it is, and with fourth-order differences elsewhere.

#include "control/nodes.hpp"
#include "derivatives/differences.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/spatial/explog.hpp"
#include "simulation/scenes.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

constexpr double kStep = 1e-2;

NodePtr node_of(const Problem& p, double h = kStep) {
  return std::make_shared<IntegratedActionModelSymplectic>(p.model(), h);
}

RandomScene random_one(int seed, bool damped = false) {
  std::mt19937 rng(static_cast<unsigned>(seed));
  SceneOptions options;
  options.nrobots = 1 + seed % 3;
  options.models = {ModelOptions{.floating_base = true, .armature = 0.1},
                    ModelOptions{.armature = 0.1, .passive = 0.2, .friction = 0.5}};
  options.redundant = seed % 2;
  options.gains = 0.7;
  if (damped) options.damping = 1e-3;
  return random_scene(rng, options);
}

// Returns robots without contacts to the world, or to a plane of it only, with free joints inside.
std::vector<RandomScene> free_scenes() {
  std::vector<RandomScene> out = {free_scene(3), free_scene(5), free_scene(8, false)};
  out.push_back(tied_scene(41));
  out.back().scene.contacts[1].active = false;  // two robots attached to each other alone
  out.push_back(tied_scene(42));                // and the world
  out.back().scene.contacts[0].alpha = 30, out.back().scene.contacts[0].beta = 40;
  RandomScene slides = of_file(load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>1 0.5 0.1 0.2 0 10</v></robot>"
      "<robot name=\"h\" urdf=\"quadruped.urdf\" base=\"floating\" xyz=\"3 0 1\"/>"
      "<contact type=\"1d\" frame=\"b/crate\" axis=\"0 0 1\" reference_frame=\"world\" name=\"x\" offset=\"0.3 0 0\"/>"
      "</scene>"));
  std::mt19937 rng(7);
  slides.v.tail(slides.scene.nv - 6) = random_vector(slides.scene.nv - 6, rng);
  slides.u = random_vector(slides.scene.nu, rng);
  out.push_back(slides);
  return out;
}

// An inner floating joint without motors hangs free on a tree with a floating or a fixed base.
RandomScene nested_scene(bool floating_base) {
  Joint body;
  body.type = JointType::kFloating;
  body.inertia = Inertia<double>::from_com(1, {0.1, 0, 0.2}, Vec3<double>(3, 5, 7).asDiagonal());
  body.lower = body.upper = body.velocity_limit = body.effort_limit = Eigen::VectorXd::Zero(6);
  body.actuated = false;
  Joint turning = body, inner = body;
  turning.type = JointType::kRevolute;
  turning.actuated = true;
  turning.lower = turning.upper = turning.velocity_limit = turning.effort_limit = Eigen::VectorXd::Zero(1);
  body.name = "root", turning.name = "arm", inner.name = "inner";
  turning.placement.p = {0.5, 0, 0};
  inner.placement.p = {0, 0.3, 0.1};
  Model tree;
  if (floating_base) {
    turning.parent = 0, inner.parent = 1;
    tree.joints = {body, turning, inner};
  } else {
    turning.parent = -1, inner.parent = 0;
    tree.joints = {turning, inner};
  }
  tree.floating_base = floating_base;
  finalize(tree);
  RandomScene s;
  add_robot(s.scene, "r", std::make_shared<const Model>(tree));
  std::mt19937 rng(4);
  s.q = random_configuration(tree, rng);
  s.v = 2 * random_vector(tree.nv, rng);
  s.u = random_vector(s.scene.nu, rng);
  return s;
}

// ---- values

// Uses the scene's own torques, with passive joints of fixed bases too.
Problem problem_of(const RandomScene& s) {
  Problem p = make_problem(s);
  const std::size_t nu = static_cast<std::size_t>(s.scene.nu);
  if (p.actuation->get_nu() == nu) return p;
  p.actuation = std::make_shared<ActuationModelFloatingBase>(p.state);
  p.contacts = contacts_of_scene(p.state, s.scene, nu);
  p.costs = std::make_shared<CostModelSum>(p.state, nu);
  p.constraints = std::make_shared<ConstraintModelManager>(p.state, nu);
  p.u = s.u;
  return p;
}

void expect_step(const RandomScene& s) {
  const Problem p = problem_of(s);
  ASSERT_EQ(p.u, s.u);
  const NodePtr model = node_of(p);
  const NodeDataPtr data = model->createData();
  model->calc(data, p.x, p.u);
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, kStep);
  for (std::size_t c = 0; c < s.scene.contacts.size(); ++c) sim.dynamics.active[c] = s.scene.contacts[c].active;
  ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  Eigen::VectorXd end(p.x.size());
  end << sim.q, sim.v;
  EXPECT_LT(difference_of(data->xnext, end), 1e-12 * (1 + size_of(end)));
}

TEST(Symplectic, IsTheStep) {
  for (int seed = 100; seed < 130; ++seed)
    for (const bool damped : {false, true}) {
      SCOPED_TRACE(seed);
      expect_step(random_one(seed, damped));
    }
  for (const RandomScene& s : free_scenes()) expect_step(s);
  for (const bool floating_base : {false, true}) expect_step(nested_scene(floating_base));
}

// Bodies without contacts keep their momentum, which Euler's node does not.
TEST(Symplectic, KeepsMomentum) {
  RandomScene s = free_scene(3);
  s.scene.gravity.setZero();
  const Problem p = make_problem(s);
  const auto left = [&](const NodePtr& model) {
    const NodeDataPtr data = model->createData();
    Eigen::VectorXd x = p.x;
    for (int k = 0; k < 100; ++k) {
      model->calc(data, x, p.u);
      x = data->xnext;
    }
    const Vec6<double> end = invariants_of(s, x.head(s.scene.nq), x.tail(s.scene.nv)).momentum;
    return error_of(end, start_of(s).momentum);
  };
  EXPECT_LT(left(node_of(p, 1e-3)), 1e-11);
  EXPECT_GT(left(std::make_shared<IntegratedActionModelEuler>(p.model(), 1e-3)), 1e-4);
}

// ---- derivatives

void expect_derivatives(const Problem& p, double tolerance) {
  const NodePtr model = node_of(p);
  const NodeDataPtr data = model->createData(), other = model->createData();
  model->calc(data, p.x, p.u);
  model->calcDiff(data, p.x, p.u);
  const Eigen::Index n = data->Fx.cols(), m = data->Fu.cols();
  for (Eigen::Index c = 0; c < n + m; ++c) {
    SCOPED_TRACE("column " + std::to_string(c));
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(n), du = Eigen::VectorXd::Zero(m);
    (c < n ? dx[c] : du[c - n]) = 1;
    const Eigen::VectorXd mine = c < n ? data->Fx.col(c) : data->Fu.col(c - n);
    const Eigen::VectorXd twin = fourth_order(p, model, other, dx, du, 1e-4);
    EXPECT_LT(difference_of(mine, twin), tolerance * (1e-2 + size_of(twin)));
  }
  EXPECT_GT(size_of(data->Fx), 0);
}

TEST(Symplectic, DerivativesOfFreeGroups) {
  int k = 0;
  for (const RandomScene& s : free_scenes()) {
    SCOPED_TRACE(k++);
    expect_derivatives(make_problem(s), 1e-8);
  }
  for (const bool floating_base : {false, true})
    for (const Actuated how : {Actuated::kFloatingBase, Actuated::kFull, Actuated::kSquashed}) {
      SCOPED_TRACE(static_cast<int>(how));
      expect_derivatives(make_problem(nested_scene(floating_base), how), 1e-8);
    }
}

TEST(Symplectic, DerivativesOfRandomScenes) {
  for (int seed = 100; seed < 112; ++seed) {
    SCOPED_TRACE(seed);
    expect_derivatives(make_problem(random_one(seed, seed % 4 == 0), static_cast<Actuated>(seed % 3)), 1e-7);
  }
}

// ---- quadruple precision

QuadState moved(const Scene& scene, const QuadState& x, const VecX<Quad>& dq, const VecX<Quad>& dv) {
  QuadState out{VecX<Quad>(scene.nq), x.v + dv};
  for (const Robot& robot : scene.robots) {
    const Model& m = *robot.model;
    VecX<Quad> q(m.nq);
    integrate<Quad>(m, x.q.segment(robot.idx_q, m.nq), dq.segment(robot.idx_v, m.nv), q);
    out.q.segment(robot.idx_q, m.nq) = q;
  }
  return out;
}

// Dense M and h - S^T u, and J of the active contacts with r = beta J v + alpha e.
struct HeldTerms {
  MatX<Quad> M, J;
  VecX<Quad> tau, r;
};
HeldTerms terms_at(const Scene& scene, const QuadState& x, const VecX<Quad>& u) {
  HeldTerms t;
  t.M.setZero(scene.nv, scene.nv);
  t.tau.setZero(scene.nv);
  std::vector<Kinematics<Quad>> kin;
  Scene at_rest = scene;
  at_rest.gravity.setZero();
  const auto move = [&](const Vec3<double>& gravity, const VecX<Quad>& v) {
    for (std::size_t k = 0; k < scene.robots.size(); ++k) {
      const Robot& robot = scene.robots[k];
      if (kin.size() == k) kin.emplace_back(*robot.model);
      forward_kinematics<Quad>(*robot.model, robot.base, x.q.segment(robot.idx_q, robot.model->nq), kin[k]);
      forward_accelerations<Quad>(*robot.model, v.segment(robot.idx_v, robot.model->nv), nullptr, gravity, kin[k]);
    }
  };
  move(scene.gravity, x.v);
  for (std::size_t k = 0; k < scene.robots.size(); ++k) {
    const Robot& robot = scene.robots[k];
    const Model& model = *robot.model;
    std::vector<Vec6<Quad>> f(model.njoints(), Vec6<Quad>(Vec6<Quad>::Zero()));
    VecX<Quad> h(model.nv);
    inverse_dynamics<Quad>(model, kin[k], nullptr, {}, f, h);
    t.tau.segment(robot.idx_v, model.nv) = -h;
    for (int i = 0; i < model.nu(); ++i) t.tau[robot.idx_v + model.actuated[i]] += u[robot.idx_u + i];
    std::vector<Inertia<Quad>> Yc = kin[k].Y;
    std::vector<Quad> M(packed_size(model));
    crba<Quad>(model, kin[k], Yc, M.data());
    MatX<Quad> dense(model.nv, model.nv);
    unpack_inertia<Quad>(model, M.data(), dense);
    t.M.block(robot.idx_v, robot.idx_v, model.nv, model.nv) = dense;
  }
  int rows = 0;
  for (const Contact& c : scene.contacts) rows += c.active ? c.rows() : 0;
  t.J.setZero(rows, scene.nv);
  t.r.setZero(rows);
  int row = 0;
  for (const Contact& contact : scene.contacts) {
    if (!contact.active) continue;
    const ContactSupport support = contact_support(scene, contact);
    ContactData<Quad> d(contact, support);
    Contact still = contact;  // alpha e alone: its velocity has no effect
    still.beta = 0;
    const auto rows_of = [&](const Scene& of, const Contact& c) {
      contact_rows<Quad>(of, c, support, kin[c.A.robot], c.B.robot < 0 ? nullptr : &kin[c.B.robot], d);
    };
    rows_of(scene, contact);
    int k = 0;
    for (int i : support.a)
      t.J.col(scene.robots[contact.A.robot].idx_v + i).segment(row, contact.rows()) = d.J.col(k++);
    for (int i : support.b)
      t.J.col(scene.robots[contact.B.robot].idx_v + i).segment(row, contact.rows()) = d.J.col(k++);
    const VecX<Quad> beta_Jv = Quad(contact.beta) * (d.W * d.nu);
    move(Vec3<double>::Zero(), VecX<Quad>::Zero(scene.nv));
    rows_of(at_rest, still);
    t.r.segment(row, contact.rows()) = d.a0 + beta_Jv;
    move(scene.gravity, x.v);
    row += contact.rows();
  }
  return t;
}

// Calls use(joint, index of its configuration, of its velocity, how many of its coordinates displace it).
template <class Use>
void each_free_joint(const Scene& scene, Use&& use) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() > 1)
        use(joint, robot.idx_q + joint.idx_q, robot.idx_v + joint.idx_v, joint.type == JointType::kPlanar ? 2 : 3);
}

// A free joint's linear and angular velocity.
std::pair<Vec3<Quad>, Vec3<Quad>> parts_of(const Joint& joint, const VecX<Quad>& v, int i) {
  if (joint.type == JointType::kPlanar) return {{v[i], v[i + 1], 0}, {0, 0, v[i + 2]}};
  return {v.segment<3>(i), v.segment<3>(i + 3)};
}

// Computes v+ and q+ with one dense system, without correcting momentum. v is expressed in axes that turn with a free
// joint: at its start, (x - v) / h - w x v -> dv/dt; and from x, p+ = p + h R x, v+ = R+^T R x.
QuadState held_step(const Scene& scene, const QuadState& state, const VecX<Quad>& u, const Quad& h) {
  const HeldTerms t = terms_at(scene, state, u);
  const Eigen::Index nv = t.M.rows(), nc = t.J.rows();
  MatX<Quad> K = MatX<Quad>::Zero(nv + nc, nv + nc);
  K.topLeftCorner(nv, nv) = t.M;
  K.topRightCorner(nv, nc) = t.J.transpose();
  K.bottomLeftCorner(nc, nv) = t.J;
  K.bottomRightCorner(nc, nc).diagonal().setConstant(-Quad(scene.damping));
  VecX<Quad> turn = VecX<Quad>::Zero(nv);
  each_free_joint(scene, [&](const Joint& joint, int, int i, int n) {
    const auto [linear, angular] = parts_of(joint, state.v, i);
    turn.segment(i, n) = angular.cross(linear).head(n);
  });
  VecX<Quad> b(nv + nc);
  b << t.tau + t.M * turn, -t.r;
  const VecX<Quad> a = K.partialPivLu().solve(b).head(nv), x = state.v + h * a;
  VecX<Quad> turned = h * x;
  each_free_joint(scene, [&](const Joint&, int, int i, int n) { turned.segment(i, n).setZero(); });
  QuadState next = moved(scene, state, turned, h * a);
  each_free_joint(scene, [&](const Joint& joint, int at, int i, int n) {
    const auto [linear, angular] = parts_of(joint, x, i);
    const VecX<Quad> pose = state.q.segment(at, joint.nq());
    const Mat3<Quad> R = joint.type == JointType::kPlanar ? exp3<Quad>(Vec3<Quad>(0, 0, pose[2]))
                                                          : placement_of_pose(Eigen::Matrix<Quad, 7, 1>(pose)).R;
    next.q.segment(at, n) += (h * (R * linear)).head(n);
    next.v.segment(i, n) = (exp3<Quad>(Vec3<Quad>(-h * angular)) * linear).head(n);
  });
  return next;
}

// Centre of mass, momentum, angular momentum and inertia about it of one robot, in the world.
struct Body {
  Quad m = 0;
  Vec3<Quad> C = Vec3<Quad>::Zero(), P = C, L = C;
  Mat3<Quad> I = Mat3<Quad>::Zero();
};
Body body_of(const Scene& scene, const QuadState& x) {
  const Model& model = *scene.robots[0].model;
  Kinematics<Quad> kin(model);
  forward_kinematics<Quad>(model, scene.robots[0].base, x.q, kin);
  forward_accelerations<Quad>(model, x.v, nullptr, scene.gravity, kin);
  Inertia<Quad> Y;
  Body out;
  for (int i = 0; i < model.njoints(); ++i) {
    const Vec6<Quad> h = kin.Y[i] * kin.v[i];
    out.P += h.head<3>();
    out.L += h.tail<3>();
    Y += kin.Y[i];
  }
  const Vec3<Quad> c = Y.h / Y.m;
  out.m = Y.m;
  out.C = kin.origin(0) + c;
  out.L -= Vec3<Quad>(c.cross(out.P));
  out.I = Y.seen_at(Vec3<Quad>(-c)).I;
  return out;
}

// Computes the whole step for one floating robot without contacts.
QuadState free_step(const Scene& scene, const QuadState& x, const VecX<Quad>& u, const Quad& h) {
  const Body start = body_of(scene, x);
  QuadState next = held_step(scene, x, u, h);
  const Vec3<Quad> P = start.P + h * start.m * scene.gravity.cast<Quad>();
  next.q.head<3>() += start.C + h / start.m * P - body_of(scene, next).C;
  const Body end = body_of(scene, next);
  const Vec3<Quad> w = end.I.inverse() * (start.L - end.L), u_of_C = (P - end.P) / end.m;
  Kinematics<Quad> kin(*scene.robots[0].model);
  forward_kinematics<Quad>(*scene.robots[0].model, scene.robots[0].base, next.q, kin);
  const Vec3<Quad> lever = kin.origin(0) + kin.oMi[0].p - end.C;
  const Mat3<Quad> R = kin.oMi[0].R.transpose();
  next.v.head<3>() += R * (u_of_C + w.cross(lever));
  next.v.segment<3>(3) += R * w;
  return next;
}

void expect_true(const RandomScene& s, bool is_free) {
  const Problem p = problem_of(s);
  const Scene& scene = s.scene;
  const NodePtr model = node_of(p);
  const NodeDataPtr data = model->createData();
  model->calc(data, p.x, p.u);
  model->calcDiff(data, p.x, p.u);
  const Quad h = kStep, e = Quad(1) / Quad(10000000000LL);
  const QuadState x = {s.q.cast<Quad>(), s.v.cast<Quad>()};
  const auto step_from = [&](const QuadState& from, const VecX<Quad>& u) {
    return is_free ? free_step(scene, from, u, h) : held_step(scene, from, u, h);
  };
  const QuadState next = step_from(x, p.u.cast<Quad>());
  EXPECT_LT(difference_of(data->xnext.head(scene.nq).eval(), next.q), 1e-12 * (1 + size_of(data->xnext)));
  EXPECT_LT(difference_of(data->xnext.tail(scene.nv).eval(), next.v), 1e-12 * (1 + size_of(data->xnext)));
  std::mt19937 rng(6);
  for (int k = 0; k < 8; ++k) {
    Eigen::VectorXd dx = random_vector(2 * scene.nv, rng), du = random_vector(scene.nu, rng);
    (k < 4 ? du : dx).setZero();
    const auto at = [&](const Quad& t) {
      return step_from(moved(scene, x, t * dx.head(scene.nv).cast<Quad>(), t * dx.tail(scene.nv).cast<Quad>()),
                       p.u.cast<Quad>() + t * du.cast<Quad>());
    };
    const QuadState plus = at(e), minus = at(-e);
    VecX<Quad> truth(2 * scene.nv);
    for (const Robot& robot : scene.robots) {
      const Model& m = *robot.model;
      VecX<Quad> up(m.nv), down(m.nv);
      const VecX<Quad> from = next.q.segment(robot.idx_q, m.nq);
      difference<Quad>(m, from, plus.q.segment(robot.idx_q, m.nq), up);
      difference<Quad>(m, from, minus.q.segment(robot.idx_q, m.nq), down);
      truth.segment(robot.idx_v, m.nv) = (up - down) / (2 * e);
    }
    truth.tail(scene.nv) = (plus.v - minus.v) / (2 * e);
    const Eigen::VectorXd mine = data->Fx * dx + data->Fu * du;
    EXPECT_LT(difference_of(mine, truth), 1e-11 * (1 + size_of(truth)));
    EXPECT_GT(size_of(truth), 0);
  }
}

TEST(Symplectic, IsTrueWhereContactsHold) {
  for (int seed = 60; seed < 66; ++seed) {
    SCOPED_TRACE(seed);
    RandomScene s = tied_scene(seed);
    std::mt19937 rng(static_cast<unsigned>(seed));
    s.v += random_vector(s.scene.nv, rng);  // J v is not zero
    s.scene.damping = seed % 2 ? 1e-3 : 0;
    s.scene.contacts[0].alpha = 40, s.scene.contacts[0].beta = 30;
    s.scene.contacts[1].beta = 60;  // gains differ
    expect_true(s, false);
  }
}

TEST(Symplectic, IsTrueWhereMomentumIsKept) {
  for (int seed = 70; seed < 76; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 rng(static_cast<unsigned>(seed));
    ModelOptions model;
    model.njoints = 6;
    model.floating_base = true;
    model.types = {JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar};
    model.armature = 0.1;
    SceneOptions options;
    options.nrobots = 1;
    options.models = {model};
    options.ncontacts = 0;
    RandomScene s = random_scene(rng, options);
    s.v *= 3;
    expect_true(s, true);
  }
}

// ---- use

TEST(Symplectic, AllocatesNothing) {
  for (const RandomScene& s : {free_scene(3), tied_scene(42)}) {
    const Problem p = make_problem(s);
    const auto model = p.model();
    model->set_options({Method::kSparseLdl, {}});
    const NodePtr node = std::make_shared<IntegratedActionModelSymplectic>(model, kStep);
    const NodeDataPtr data = node->createData();
    const auto evaluate = [&] { node->calc(data, p.x, p.u), node->calcDiff(data, p.x, p.u); };
    evaluate();
    EXPECT_EQ(allocations(evaluate), 0u);
  }
}

TEST(Symplectic, FollowsWhatChanges) {
  const RandomScene s = tied_scene(42);
  const Problem p = make_problem(s);
  const auto model = p.model();
  const NodePtr node = std::make_shared<IntegratedActionModelSymplectic>(model, kStep);
  const NodeDataPtr data = node->createData();
  node->calc(data, p.x, p.u);
  model->set_armature(Eigen::VectorXd::Constant(s.scene.nv, 0.5));
  p.contacts->changeContactStatus("grounded", false);
  node->calc(data, p.x, p.u), node->calcDiff(data, p.x, p.u);
  const NodeDataPtr fresh = node->createData();
  node->calc(fresh, p.x, p.u), node->calcDiff(fresh, p.x, p.u);
  EXPECT_EQ(data->xnext, fresh->xnext);
  EXPECT_EQ(data->Fx, fresh->Fx);
}

TEST(Symplectic, RefusesMisuse) {
  const auto lqr = std::make_shared<DifferentialActionModelLQR>(DifferentialActionModelLQR::Random(3, 2));
  EXPECT_THROW(IntegratedActionModelSymplectic(lqr, 0.1), std::invalid_argument);
  EXPECT_THROW(IntegratedActionModelSymplectic(nullptr, 0.1), std::invalid_argument);
  Walker w;
  const auto model = w.model();
  model->set_storage(MatrixStorage::kSparse);
  EXPECT_THROW((void)IntegratedActionModelSymplectic(model, 0.1).createData(), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
