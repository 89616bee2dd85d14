// Impacts agree with hand calculations, with quadruple precision, and with numerical differentiation.

#include "contact/scene_rows.hpp"
#include "control/nodes.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/kkt/dense.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

using ImpulseData = ActionDataImpulseFwdDynamics;

ImpulseData& as_impulse(const NodeDataPtr& data) { return dynamic_cast<ImpulseData&>(*data); }

/// Contains an impact with the rows of any contact.
struct ImpactProblem {
  RandomScene s;
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ImpulseModelMultiple> impulses;
  std::shared_ptr<CostModelSum> costs;
  std::shared_ptr<ConstraintModelManager> constraints;
  Eigen::VectorXd x, none = Eigen::VectorXd(0);

  explicit ImpactProblem(const RandomScene& of) : s(of), state(std::make_shared<StateMultibody>(of.scene)) {
    impulses = std::make_shared<ImpulseModelMultiple>(state);
    for (const Contact& contact : s.scene.contacts)
      impulses->addImpulse(contact.name, std::make_shared<ImpulseModelOfScene>(state, contact));
    costs = std::make_shared<CostModelSum>(state, 0);
    constraints = std::make_shared<ConstraintModelManager>(state, 0);
    x.resize(s.q.size() + s.v.size());
    x << s.q, s.v;
  }
  explicit ImpactProblem(int seed) : ImpactProblem(scene_of(seed)) {}

  static RandomScene scene_of(int seed) {
    std::mt19937 rng(seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.models = {ModelOptions{.floating_base = true, .armature = 0.1}, ModelOptions{}};
    options.same_link = 0;
    return random_scene(rng, options);
  }
  std::shared_ptr<ActionModelImpulseFwdDynamics> model(double e = 0, double damping = 0) const {
    return std::make_shared<ActionModelImpulseFwdDynamics>(state, impulses, costs, constraints, e, damping);
  }
  void add(const std::string& name, std::shared_ptr<ResidualModelAbstract> residual, double weight) {
    costs->addCost(name, std::make_shared<CostModelResidual>(state, residual), weight);
  }
  // Adds every residual of an impact as a cost, some as constraints.
  void add_residuals() {
    std::mt19937 rng(5);
    const auto nothing = std::make_shared<ActuationModelFull>(state);
    factory::Builder builder{state, nothing, 0, std::mt19937(6), {}};
    builder.add<ResidualModelState>("State", state->rand(), 0);
    builder.add<ResidualModelImpulseCoM>("ImpulseCoM");
    builder.frames();
    builder.centroidal();
    builder.contact_stack(*impulses->get_contacts());
    int k = 0;
    for (const NamedResidual& r : builder.all) {
      add(r.name, r.residual, uniform(rng, 0.1, 2));
      if (k++ % 4) continue;
      const Eigen::VectorXd lower = random_vector(static_cast<int>(r.residual->get_nr()), rng);
      Eigen::VectorXd upper = lower;
      upper[0] += 1;
      constraints->addConstraint(r.name, std::make_shared<ConstraintModelResidual>(state, r.residual, lower, upper));
    }
  }
};

// ---- the equations in quadruple precision -------------------------------------------------------------------------

struct ImpactTerms {
  MatX<Quad> M, J;
};

ImpactTerms terms_of(const Scene& scene, const VecX<Quad>& q) {
  ImpactTerms t{MatX<Quad>::Zero(scene.nv, scene.nv), {}};
  const VecX<Quad> rest = VecX<Quad>::Zero(scene.nv);
  const SceneRows<Quad> rows(scene, q, rest);
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Model& model = *scene.robots[r].model;
    std::vector<Inertia<Quad>> Yc;
    std::vector<Quad> M(packed_size(model));
    crba<Quad>(model, rows.kin[r], Yc, M.data());
    const int o = scene.robots[r].idx_v;
    unpack_inertia<Quad>(model, M.data(), t.M.block(o, o, model.nv, model.nv));
  }
  std::vector<int> order(scene.contacts.size());  // by name, as impulses stack
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return scene.contacts[a].name < scene.contacts[b].name; });
  for (int k : order) {
    const MatX<Quad> J = rows.J(k);
    t.J.conservativeResize(t.J.rows() + J.rows(), scene.nv);
    t.J.bottomRows(J.rows()) = J;
  }
  return t;
}

// Returns [v+; -Lambda], as defined in the header.
VecX<Quad> impact(const Scene& scene, const VecX<Quad>& q, const VecX<Quad>& v, double e, double delta) {
  const ImpactTerms t = terms_of(scene, q);
  DenseKkt<Quad> kkt;
  kkt.M = t.M;
  kkt.J = t.J;
  kkt.delta = delta;
  factor(kkt);
  MatX<Quad> vnext, Lambda;
  solve<Quad>(kkt, MatX<Quad>(t.M * v), MatX<Quad>(-Quad(e) * (t.J * v)), vnext, Lambda);
  VecX<Quad> out(scene.nv + Lambda.rows());
  out << vnext, -Lambda;
  return out;
}

struct Impulse_ {
  int seed;
  double e, delta;
};
class Impacts : public testing::TestWithParam<Impulse_> {};

TEST_P(Impacts, ValuesAndDerivativesAreTrue) {
  const auto [seed, e, delta] = GetParam();
  const ImpactProblem p(seed);
  const Scene& scene = p.s.scene;
  const auto model = p.model(e, delta);
  const NodeDataPtr data = model->createData();
  model->calc(data, p.x, p.none);
  model->calcDiff(data, p.x, p.none);
  const ImpulseData& d = as_impulse(data);
  const Eigen::Index nv = scene.nv, nc = static_cast<Eigen::Index>(p.impulses->get_nc());
  const VecX<Quad> q = p.s.q.cast<Quad>(), v = p.s.v.cast<Quad>(), truth = impact(scene, q, v, e, delta);
  EXPECT_TRUE(data->xnext.head(scene.nq) == p.s.q);
  EXPECT_LT(difference_of(data->xnext.tail(nv).eval(), truth.head(nv)), 1e-10 * size_of(truth.head(nv)));
  const auto impulses = [&](const auto& part) {  // those of all contacts, by name
    Eigen::VectorXd all(nc);
    Eigen::Index at = 0;
    for (const auto& [name, contact] : d.multibody->contacts->contacts) {
      const Eigen::VectorXd one = part(*contact);
      all.segment(at, one.size()) = one;
      at += one.size();
    }
    return all;
  };
  const VecX<Quad> Lambda = -truth.tail(nc);
  EXPECT_LT(difference_of(impulses([](const auto& c) { return c.f; }), Lambda), 1e-9 * size_of(Lambda));
  EXPECT_TRUE(data->Fx.topRows(nv).isIdentity(0));
  std::mt19937 rng(seed);
  const Quad h = Quad(1) / Quad(10000000000LL);
  for (int k = 0; k < 6; ++k) {
    Eigen::VectorXd dx = random_vector(static_cast<int>(2 * nv), rng);
    (k < 3 ? dx.tail(nv) : dx.head(nv)).setZero();
    const auto moved_by = [&](const Quad& s) {
      const VecX<Quad> dq = s * dx.head(nv).cast<Quad>();
      return impact(scene, moved<Quad>(scene, q, dq), v + s * dx.tail(nv).cast<Quad>(), e, delta);
    };
    const VecX<Quad> slope = (moved_by(h) - moved_by(-h)) / (2 * h);
    const Eigen::VectorXd mine = data->Fx.bottomRows(nv) * dx;
    EXPECT_LT(difference_of(mine, slope.head(nv)), 1e-9 * size_of(slope.head(nv)));
    const VecX<Quad> dLambda = -slope.tail(nc);
    EXPECT_LT(difference_of(impulses([&](const auto& c) { return Eigen::VectorXd(c.df_dx * dx); }), dLambda),
              1e-9 * size_of(dLambda));
    EXPECT_GT(size_of(dLambda), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Impacts,
                         testing::Values(Impulse_{40, 0, 0}, Impulse_{41, 0.4, 0}, Impulse_{42, 0, 0},
                                         Impulse_{43, 0.7, 1e-3}, Impulse_{44, 0, 0.1}, Impulse_{45, 1, 0}));

// ---- numerical twins ----------------------------------------------------------------------------------------------

// Deep robots, which a scene's own solve leaves to sparse-bodies, are included.
TEST(Impact, IsLikeItsTwin) {
  constexpr double kTolerance = 1e-6;  // of central differences
  for (const int seed : {40, 41, 42, 43, -10, -13}) {
    ImpactProblem p = seed > 0 ? ImpactProblem(seed) : ImpactProblem(deep_scene(-seed, false));
    p.add_residuals();
    const auto model = p.model(0.3);
    ActionModelNumDiff twin(model, true);
    for (const bool terminal : {false, true}) {
      SCOPED_TRACE(testing::Message() << seed << (terminal ? " terminal" : " running"));
      const NodeDataPtr data = model->createData(), numbers = twin.createData();
      EXPECT_TRUE(model->checkData(data));
      if (terminal) {
        model->calc(data, p.x), model->calcDiff(data, p.x);
        twin.calc(numbers, p.x), twin.calcDiff(numbers, p.x);
      } else {
        model->calc(data, p.x, p.none), model->calcDiff(data, p.x, p.none);
        twin.calc(numbers, p.x, p.none), twin.calcDiff(numbers, p.x, p.none);
        EXPECT_LT(twin_error(data->Fx, numbers->Fx, size_of(data->xnext)), kTolerance);
      }
      EXPECT_EQ(data->cost, numbers->cost);
      EXPECT_GT(data->cost, 0);
      EXPECT_LT(twin_error(data->Lx, numbers->Lx, std::abs(data->cost)), kTolerance);
      Eigen::MatrixXd Lxx = Eigen::MatrixXd::Zero(data->Lxx.rows(), data->Lxx.cols());
      for (const auto& [name, cost] : as_impulse(data).costs->costs)
        Lxx += p.costs->get_costs().at(name)->weight * cost->whole_derivatives().Lxx;
      EXPECT_LT(error_of(data->Lxx, Lxx), 1e-12);
      EXPECT_LT(twin_error(data->Gx, numbers->Gx, size_of(data->g)), kTolerance);
      EXPECT_LT(twin_error(data->Hx, numbers->Hx, size_of(data->h)), kTolerance);
      EXPECT_EQ(data->r.size(), static_cast<Eigen::Index>(model->get_nr()));
      EXPECT_GT(size_of(data->Lx), 0);
      EXPECT_GT(size_of(data->Hx), 0);
      EXPECT_EQ(data->Fu.cols() + data->Lu.size() + data->Gu.cols() + data->Hu.cols(), 0);
    }
  }
}

// ---- by hand ------------------------------------------------------------------------------------------------------

// A box fixed at a 6D frame returns with e times its velocity; if it is fixed at its centre, Lambda = -(1 + e) M v.
TEST(Impact, OfABoxByHand) {
  const SceneFile file = load_text(
      R"(<scene name="box" gravity="0 0 -9.81"> <robot name="b" urdf="box.urdf" base="floating" xyz="0 0 1"/> </scene>)");
  const auto state = std::make_shared<StateMultibody>(file.scene);
  const auto impulses = std::make_shared<ImpulseModelMultiple>(state);
  const FrameIndex top = state->get_model()->getFrameId("top_1");
  impulses->addImpulse("all", std::make_shared<ImpulseModel6D>(state, top));
  impulses->addImpulse("point", std::make_shared<ImpulseModel3D>(state, top, LOCAL_WORLD_ALIGNED), false);
  ActionModelImpulseFwdDynamics model(state, impulses, std::make_shared<CostModelSum>(state, 0), 0.25);
  EXPECT_EQ(model.get_restitution_coefficient(), 0.25);
  std::mt19937 rng(2);
  Eigen::VectorXd x = state->rand(), none(0);
  const Eigen::VectorXd v = random_vector(6, rng);
  x.tail(6) = v;
  const NodeDataPtr data = model.createData();
  model.calc(data, x, none);
  model.calcDiff(data, x, none);
  EXPECT_LT(difference_of(data->xnext.tail(6).eval(), (-0.25 * v).eval()), 1e-13);
  EXPECT_LT(difference_of(data->Fx.bottomLeftCorner(6, 6).eval(), Eigen::MatrixXd::Zero(6, 6)), 1e-12);
  EXPECT_LT(difference_of(data->Fx.bottomRightCorner(6, 6).eval(), (-0.25 * Eigen::MatrixXd::Identity(6, 6)).eval()),
            1e-12);
  // Nothing is in contact: the velocity stays.
  impulses->changeImpulseStatus("all", false);
  EXPECT_EQ(impulses->get_nc(), 0u);
  model.calc(data, x, none);
  model.calcDiff(data, x, none);
  EXPECT_LT(difference_of(data->xnext, x), 1e-14);
  EXPECT_LT(difference_of(data->Fx, Eigen::MatrixXd::Identity(12, 12)), 1e-12);
  // At a corner the velocity is reversed, and the momentum about it stays.
  impulses->changeImpulseStatus("point", true);
  model.calc(data, x, none);
  const ContactDataAbstract& point = *as_impulse(data).multibody->contacts->contacts.at("point");
  EXPECT_LT(size_of((point.Jc * (data->xnext.tail(6) + 0.25 * v)).eval()), 1e-13);
  EXPECT_GT(size_of(point.f), 0.1);
  EXPECT_EQ(size_of(as_impulse(data).multibody->contacts->contacts.at("all")->f), 0);
}

// Four corners of each sole are redundant; the soles stop nevertheless, with or without damping.
TEST(Impact, OfRedundantCorners) {
  const SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml");
  const auto state = std::make_shared<StateMultibody>(file.scene);
  const auto impulses = std::make_shared<ImpulseModelMultiple>(state);
  for (const Contact& contact : file.scene.contacts)
    impulses->addImpulse(contact.name, std::make_shared<ImpulseModelOfScene>(state, contact));
  ActionModelImpulseFwdDynamics model(state, impulses, std::make_shared<CostModelSum>(state, 0));
  std::mt19937 rng(3);
  Eigen::VectorXd x(state->get_nx()), none(0);
  x << file.q, random_vector(static_cast<int>(state->get_nv()), rng);
  const NodeDataPtr data = model.createData();
  model.calc(data, x, none);
  model.calcDiff(data, x, none);
  EXPECT_EQ(as_impulse(data).report().islands.at(0).rank, 12);
  const DataCollector& m = *as_impulse(data).multibody;
  for (const auto& [name, contact] : m.contacts->contacts)
    EXPECT_LT(size_of((contact->Jc * m.impact->vnext(contact->v_columns)).eval()), 1e-10);
  EXPECT_TRUE(data->Fx.allFinite());
  EXPECT_LT(
      difference_of((data->Fx.bottomRightCorner(state->get_nv(), state->get_nv()) * x.tail(state->get_nv())).eval(),
                    m.impact->vnext),
      1e-9);  // v+ is linear in v
}

// ---- interface ----------------------------------------------------------------------------------------------------

TEST(Impact, NeedsNoMemory) {
  ImpactProblem p(41);
  p.add_residuals();
  const auto model = p.model(0.2);
  const NodeDataPtr data = model->createData();
  const auto evaluate = [&] {
    model->calc(data, p.x, p.none);
    model->calcDiff(data, p.x, p.none);
  };
  evaluate();
  EXPECT_EQ(allocations(evaluate), 0u);
}

TEST(Impact, FollowsItsParts) {
  ImpactProblem p(42);
  p.add_residuals();
  const auto model = p.model();
  const NodeDataPtr data = model->createData();
  const auto like_new = [&] {
    model->calc(data, p.x, p.none), model->calcDiff(data, p.x, p.none);
    const NodeDataPtr fresh = model->createData();
    model->calc(fresh, p.x, p.none), model->calcDiff(fresh, p.x, p.none);
    EXPECT_EQ(data->cost, fresh->cost);
    EXPECT_LT(error_of(data->xnext, fresh->xnext), 1e-12);
    EXPECT_LT(error_of(data->Fx, fresh->Fx), 1e-11);
    EXPECT_LT(error_of(data->Lx, fresh->Lx), 1e-11);
    EXPECT_LT(error_of(data->Lxx, fresh->Lxx), 1e-11);
    EXPECT_LT(error_of(data->Hx, fresh->Hx), 1e-11);
    return fresh->xnext;
  };
  const Eigen::VectorXd first = like_new();
  const std::string name = p.impulses->get_impulses().begin()->first;
  p.impulses->changeImpulseStatus(name, false);
  EXPECT_FALSE(p.impulses->getImpulseStatus(name));
  const Eigen::VectorXd without = like_new();
  EXPECT_GT(difference_of(first, without), 1e-3);
  p.impulses->changeImpulseStatus(name, true);
  EXPECT_LT(difference_of(like_new(), first), 1e-10);
  model->set_armature(Eigen::VectorXd::Constant(p.state->get_nv(), 0.5));
  EXPECT_GT(difference_of(like_new(), first), 1e-3);
  model->set_armature(p.state->get_model()->armature);
  model->set_restitution_coefficient(0.5);
  EXPECT_GT(difference_of(like_new(), first), 1e-3);
  p.costs->changeCostStatus("State", false);
  EXPECT_THROW(model->calcDiff(data, p.x, p.none), std::logic_error);
  like_new();
  model->calc(data, p.x);
  EXPECT_THROW(model->calcDiff(data, p.x, p.none), std::logic_error);
  EXPECT_EQ(model->quasiStatic_x(data, p.x).size(), 0);
  std::ostringstream os;
  os << *model << *p.impulses;
  EXPECT_NE(os.str().find("ActionModelImpulseFwdDynamics {nx="), std::string::npos);
  EXPECT_NE(os.str().find("ImpulseModelOfScene {frame="), std::string::npos);
}

// A status that is written into an item, without changeConstraintStatus or changeImpulseStatus, is refused.
TEST(Impact, RefusesAStatusWrittenIntoAnItem) {
  ImpactProblem p(42);
  p.add_residuals();
  const auto model = p.model();
  const NodeDataPtr data = model->createData();
  model->calc(data, p.x, p.none);
  bool& constraint = p.constraints->get_constraints().begin()->second->active;
  bool& impulse = p.impulses->get_impulses().begin()->second->active;
  for (bool* status : {&constraint, &impulse}) {
    *status = false;
    EXPECT_THROW(model->calc(data, p.x, p.none), std::invalid_argument);
    EXPECT_THROW(model->calc(data, p.x), std::invalid_argument);
    *status = true;
    model->calc(data, p.x, p.none);
  }
}

TEST(Impact, OfABodyWithoutFramesIsPrinted) {
  RandomScene s = ImpactProblem::scene_of(42);
  for (Robot& robot : s.scene.robots) {
    Model bare = *robot.model;
    bare.frames.clear();
    robot.model = std::make_shared<const Model>(bare);
  }
  std::ostringstream os;
  os << *ImpactProblem(s).impulses;
  EXPECT_NE(os.str().find("ImpulseModelOfScene {frame=none, type="), std::string::npos) << os.str();
}

TEST(Impact, RefusesMisuse) {
  ImpactProblem p(40);
  EXPECT_THROW(p.model(-0.1), std::invalid_argument);
  EXPECT_THROW(p.model(0, -1e-3), std::invalid_argument);
  EXPECT_THROW(p.model(NAN), std::invalid_argument);
  using Model = ActionModelImpulseFwdDynamics;
  EXPECT_THROW(Model(nullptr, p.impulses, p.costs), std::invalid_argument);
  EXPECT_THROW(Model(p.state, nullptr, p.costs), std::invalid_argument);
  EXPECT_THROW(Model(p.state, p.impulses, nullptr), std::invalid_argument);
  EXPECT_THROW(Model(p.state, p.impulses, std::make_shared<CostModelSum>(p.state)), std::invalid_argument);
  const ImpactProblem other(40);
  EXPECT_THROW(Model(other.state, p.impulses, other.costs), std::invalid_argument);
  EXPECT_THROW(p.impulses->addImpulse("null", nullptr), std::invalid_argument);
  EXPECT_THROW(p.impulses->changeImpulseStatus("none", true), std::invalid_argument);
  const auto model = p.model();
  const NodeDataPtr data = model->createData();
  EXPECT_THROW(model->calc(data, p.x.head(3), p.none), std::invalid_argument);
  EXPECT_THROW(model->calc(data, p.x, Eigen::VectorXd::Zero(1)), std::invalid_argument);
  EXPECT_THROW(model->calc(nullptr, p.x, p.none), std::invalid_argument);
  EXPECT_THROW(model->calcDiff(data, p.x, p.none), std::logic_error);
  EXPECT_FALSE(p.model()->checkData(data));
  p.add("acceleration", std::make_shared<ResidualModelJointAcceleration>(p.state, 0), 1);
  EXPECT_THROW(model->createData(), std::invalid_argument);
  EXPECT_THROW(model->calc(data, p.x, p.none), std::invalid_argument);  // a cost was added
  Walker w;
  w.costs = std::make_shared<CostModelSum>(w.state, 0);
  DataCollector collector(w.file.scene, {}, nullptr);
  EXPECT_THROW(ResidualModelImpulseCoM(w.state).createData(&collector), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
