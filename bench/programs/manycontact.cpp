// Our tasks: solve, all derivatives after it, w^T [da; df], set-up, a robot's algorithms, and an iteration of FDDP.

#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/control.hpp"
namespace api = manycontact;
#include "fddp.hpp"

namespace manycontact::bench {

namespace {

struct Solve : Loaded {
  explicit Solve(const Posed& scene) : s(scene), data(scene.scene) { Solve::run(); }
  void run() override { (void)solve(s.scene, s.q, s.v, s.u, data); }
  const Posed& s;
  SceneData data;
};

// The derived tasks run after a solve and include the work that the solve left to them.
struct Derivatives : Solve {
  using Solve::Solve;
  void begin() override { Solve::run(); }
  void run() override { (void)differentiate(s.scene, data); }
};

struct Products : Solve {
  explicit Products(const Posed& scene)
      : Solve(scene), wa(scene.v), wf(data.f), wq(scene.v), wv(scene.v), wu(scene.u) {}
  void begin() override { Solve::run(); }
  void run() override { vjp(s.scene, data, wa, wf, wq, wv, wu); }
  Eigen::VectorXd wa, wf, wq, wv, wu;
};

struct SetUp : Loaded {
  explicit SetUp(const Posed& scene) : s(scene) {}
  void run() override {
    SceneData data(s.scene);
    prepare(s.scene, data);
  }
  const Posed& s;
};

struct Bodies : Loaded {
  Bodies(const Posed& scene, std::string algorithm) : s(scene), task(std::move(algorithm)), data(scene.scene) {}
  void run() override {
    if (task == "rnea") (void)rnea(s.scene, s.q, s.v, a, data);
    if (task == "aba") (void)aba(s.scene, s.q, s.v, a, data);
    if (task == "crba") (void)crba(s.scene, s.q, data);
    if (task == "frame_jacobian") {
      forward_kinematics(s.scene, s.q, data);
      J = frame_jacobian(s.scene, data, s.scene.contacts.front().A);
    }
  }
  const Posed& s;
  std::string task;
  RigidBodyData data;
  Eigen::VectorXd a = 2 * s.v;  // accelerations or torques
  Mat6X<double> J;
};

std::string refuses(const Posed& s, const std::string& task) {
  const bool one_deep_tree = s.scene.nrobots() == 1 && s.scene.nv > 200;
  if (task == "derivatives" && one_deep_tree) return "as large as the square of the links";
  if (task == "derivatives" && s.scene.nrobots() > 64 && s.scene.contacts.size() > 2u * s.scene.nrobots())
    return "as large as the square of the robots in the ring";
  return {};
}

std::unique_ptr<Loaded> load(const Posed& s, const std::string& task) {
  if (task == "derivatives") return std::make_unique<Derivatives>(s);
  if (task == "vjp") return std::make_unique<Products>(s);
  if (task == "set-up") return std::make_unique<SetUp>(s);
  if (task == "solve") return std::make_unique<Solve>(s);
  if (task != "FDDP") return std::make_unique<Bodies>(s, task);
  const auto state = std::make_shared<StateMultibody>(s.scene);
  return std::make_unique<Fddp>(s, state, contacts_of_scene(state, s.scene, s.u.size()));
}

}  // namespace

const Program& program() {
  static const Program p{"manycontact",
                         MANYCONTACT_VERSION,
                         {"solve", "derivatives", "vjp", "set-up"},
                         {"rnea", "aba", "crba", "frame_jacobian", "FDDP"},
                         refuses,
                         load};
  return p;
}

}  // namespace manycontact::bench
