// Times the action model, and redundant contacts compared with the same scene with damping.

#include <benchmark/benchmark.h>

#include <array>
#include <filesystem>
#include <sstream>

#include "manycontact/action.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

struct Action {
  std::shared_ptr<DifferentialActionModelContactFwdDynamics> model;
  std::shared_ptr<DifferentialActionDataAbstract> data;
  Eigen::VectorXd x, u;

  // Has no costs, as in the peers' figures; with `sparse` only the sparse counterparts are filled.
  Action(const Posed& s, bool sparse) {
    auto state = std::make_shared<StateMultibody>(s.scene);
    auto actuation = std::make_shared<ActuationModelFloatingBase>(state);
    const std::size_t nu = actuation->get_nu();
    model = std::make_shared<DifferentialActionModelContactFwdDynamics>(
        state, actuation, contacts_of_scene(state, s.scene, nu), std::make_shared<CostModelSum>(state, nu));
    if (sparse) model->set_storage(MatrixStorage::kSparse);
    data = model->createData();
    x.resize(s.q.size() + s.v.size());
    x << s.q, s.v;
    u = s.u;
    model->calc(data, x, u);
    model->calcDiff(data, x, u);
  }
};

// Twenty costs and three constraints of all kinds for one robot on both feet; frames: soles, hands.
struct ManyCosts {
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<CostModelSum> costs;
  std::shared_ptr<ConstraintModelManager> constraints;
  std::size_t nu;

  void cost(const std::string& name, std::shared_ptr<ResidualModelAbstract> residual, double weight = 1) {
    costs->addCost(name, std::make_shared<CostModelResidual>(state, residual), weight);
  }
  template <class Cone>
  void barrier(const std::string& name, std::shared_ptr<ResidualModelAbstract> residual, const Cone& cone) {
    const ActivationBounds bounds(cone.get_lb(), cone.get_ub());
    costs->addCost(
        name,
        std::make_shared<CostModelResidual>(state, std::make_shared<ActivationModelQuadraticBarrier>(bounds), residual),
        1);
  }
  void constraint(const std::string& name, std::shared_ptr<ResidualModelAbstract> residual) {
    constraints->addConstraint(name, std::make_shared<ConstraintModelResidual>(state, residual));
  }

  ManyCosts(std::shared_ptr<StateMultibody> s, const Eigen::VectorXd& x, std::size_t n,
            const std::array<std::string, 4>& frames)
      : state(std::move(s)),
        costs(std::make_shared<CostModelSum>(state, n)),
        constraints(std::make_shared<ConstraintModelManager>(state, n)),
        nu(n) {
    FrameIndex id[4];
    for (int k = 0; k < 4; ++k) id[k] = state->get_model()->getFrameId(frames[k]);
    const Eigen::Vector3d p(0.1, 0.2, 0.7);
    cost("state", std::make_shared<ResidualModelState>(state, x, nu), 0.5);
    cost("rest", std::make_shared<ResidualModelState>(state, nu), 1e-2);
    cost("control", std::make_shared<ResidualModelControl>(state, nu), 1e-3);
    cost("com", std::make_shared<ResidualModelCoMPosition>(state, p, nu), 10);
    cost("momentum", std::make_shared<ResidualModelCentroidalMomentum>(state, Vec6<double>::Zero(), nu));
    cost("acceleration", std::make_shared<ResidualModelJointAcceleration>(state, nu), 1e-4);
    cost("gravity", std::make_shared<ResidualModelContactControlGrav>(state, nu), 1e-4);
    cost("head", std::make_shared<ResidualModelFrameRotation>(state, id[3], Eigen::Matrix3d::Identity(), nu));
    for (int k = 0; k < 2; ++k) {
      const std::string side = k == 0 ? "left " : "right ";
      const FrameIndex sole = id[k], hand = id[2 + k];
      const FrictionCone friction(Eigen::Matrix3d::Identity(), 0.7);
      const WrenchCone wrench(Eigen::Matrix3d::Identity(), 0.7, Eigen::Vector2d(0.1, 0.05));
      cost(side + "hand", std::make_shared<ResidualModelFramePlacement>(state, hand, SE3<double>(), nu));
      cost(side + "reach", std::make_shared<ResidualModelFrameTranslation>(state, hand, p, nu));
      cost(side + "speed", std::make_shared<ResidualModelFrameVelocity>(state, hand, Vec6<double>::Zero(), LOCAL, nu));
      cost(side + "force", std::make_shared<ResidualModelContactForce>(state, sole, Vec6<double>::Zero(), 6, nu), 1e-3);
      barrier(side + "cone", std::make_shared<ResidualModelContactFrictionCone>(state, sole, friction, nu), friction);
      barrier(side + "wrench", std::make_shared<ResidualModelContactWrenchCone>(state, sole, wrench, nu), wrench);
    }
    constraint("com", std::make_shared<ResidualModelCoMPosition>(state, p, nu));
    constraint("hand", std::make_shared<ResidualModelFrameTranslation>(state, id[2], p, nu));
    constraint("force", std::make_shared<ResidualModelContactForce>(state, id[0], Vec6<double>::Zero(), 6, nu));
  }
};

void many_costs(benchmark::State& state, const Posed& s, const std::array<std::string, 4>& frames,
                MatrixStorage storage, bool diff) {
  auto multibody = std::make_shared<StateMultibody>(s.scene);
  auto actuation = std::make_shared<ActuationModelFloatingBase>(multibody);
  Eigen::VectorXd x(s.q.size() + s.v.size());
  x << s.q, s.v;
  const std::size_t nu = actuation->get_nu();
  const ManyCosts parts(multibody, x, nu, frames);
  auto contacts = std::make_shared<ContactModelMultiple>(multibody, nu);
  for (int k = 0; k < 2; ++k)
    contacts->addContact(frames[k], std::make_shared<ContactModel6D>(
                                        multibody, multibody->get_model()->getFrameId(frames[k]),
                                        s.scene.contacts[k].B.placement, LOCAL, nu, Eigen::Vector2d::Zero()));
  DifferentialActionModelContactFwdDynamics model(multibody, actuation, contacts, parts.costs, parts.constraints);
  model.set_storage(storage);
  const auto data = model.createData();
  model.calc(data, x, s.u);
  if (diff)
    for (auto _ : state) model.calcDiff(data, x, s.u);
  else
    for (auto _ : state) model.calc(data, x, s.u);
}

void action_calc(benchmark::State& state, const Posed& s) {
  Action a(s, false);
  for (auto _ : state) a.model->calc(a.data, a.x, a.u);
}

void action_calc_diff(benchmark::State& state, const Posed& s, bool sparse) {
  Action a(s, sparse);
  for (auto _ : state) a.model->calcDiff(a.data, a.x, a.u);
}

void solve_with_damping(benchmark::State& state, SceneFile s, double damping) {
  s.scene.damping = damping;
  SceneData data(s.scene);
  benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  for (auto _ : state) benchmark::DoNotOptimize(solve(s.scene, s.q, s.v, s.u, data));
  state.counters["status"] = static_cast<double>(data.report.status);
}

void redundant(const std::string& name, const std::string& path) {
  if (!std::filesystem::exists(path)) return;
  const SceneFile s = load_scene(path);
  benchmark::RegisterBenchmark(("redundant/" + name + "/undamped").c_str(), solve_with_damping, s, 0.0);
  benchmark::RegisterBenchmark(("redundant/" + name + "/damped").c_str(), solve_with_damping, s, 1e-6);
}

const Registration registered([] {
  const std::string source = MANYCONTACT_SOURCE_DIR;
  redundant("feet_on_corners", source + "/models/feet_on_corners.xml");
  redundant("anymal_loop", source + "/../shared/golden/anymal_loop_redundant.xml");
  const Posed one = bench::robots(1);
  std::array<std::string, 4> frames;
  std::string hands;
  std::istringstream(robot_frames()) >> frames[0] >> frames[1] >> hands >> frames[2] >> frames[3];
  frames[1].pop_back();  // the comma
  benchmark::RegisterBenchmark("action/costs/calc", [=](benchmark::State& state) {
    many_costs(state, one, frames, MatrixStorage::kBoth, false);
  });
  for (const auto& [name, storage] :
       {std::pair("both", MatrixStorage::kBoth), std::pair("dense", MatrixStorage::kDense),
        std::pair("sparse", MatrixStorage::kSparse)})
    benchmark::RegisterBenchmark(
        (std::string("action/costs/calcDiff_") + name).c_str(),
        [=, s = storage](benchmark::State& state) { many_costs(state, one, frames, s, true); });
  for (int robots : {1, 16, 64}) {
    const std::string n = std::to_string(robots);
    const Posed s = bench::robots(robots);
    benchmark::RegisterBenchmark(("action/calc/" + n).c_str(), action_calc, s);
    if (robots <= 16) benchmark::RegisterBenchmark(("action/calcDiff/" + n).c_str(), action_calc_diff, s, false);
    benchmark::RegisterBenchmark(("action/calcDiff_sparse/" + n).c_str(), action_calc_diff, s, true);
  }
});

}  // namespace
}  // namespace manycontact::bench
