// These laws are valid for every method: separate robots do not affect each other, numbering does not matter, energy
// and momentum are conserved, and without contacts forward dynamics is ABA's.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "dynamics/simulation.hpp"
#include "manycontact/algorithm/aba.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "support/measure.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

void append(Eigen::VectorXd& x, const Eigen::VectorXd& more) {
  x.conservativeResize(x.size() + more.size());
  x.tail(more.size()) = more;
}

// Appends the robots of `from` and their contacts to `to`, with new names.
void append(RandomScene& to, const RandomScene& from, const std::string& prefix) {
  const int first = to.scene.nrobots();
  for (const Robot& r : from.scene.robots) add_robot(to.scene, prefix + r.name, r.model, r.base);
  for (Contact c : from.scene.contacts) {
    c.name = prefix + c.name;
    c.A.robot += first;
    if (c.B.robot >= 0) c.B.robot += first;
    add_contact(to.scene, c);
  }
  append(to.q, from.q);
  append(to.v, from.v);
  append(to.u, from.u);
}

TEST(Laws, SeparateRobotsAreSeparateScenes) {
  std::mt19937 rng(31);
  std::vector<RandomScene> parts(5);
  RandomScene whole;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    SceneOptions options;
    options.nrobots = 1 + static_cast<int>(k % 2);
    parts[k] = random_scene(rng, options);
    append(whole, parts[k], "part" + std::to_string(k));
  }
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData together(whole.scene, way.options);
    (void)solve(whole.scene, whole.q, whole.v, whole.u, together);
    VecX<double> a, f;
    std::vector<double> condition;
    for (const RandomScene& part : parts) {
      SceneData alone(part.scene, way.options);
      EXPECT_EQ(solve(part.scene, part.q, part.v, part.u, alone).status, Status::kOk);
      append(a, alone.a);
      append(f, alone.f);
    }
    SceneData oracle(whole.scene, {Method::kDense, {}});
    (void)solve(whole.scene, whole.q, whole.v, whole.u, oracle);
    const Errors e = errors<double>(whole.scene, together, a, f, conditions(whole.scene, oracle));
    EXPECT_LE(e.excess, 1) << e;
    if (way.options.method != Method::kDenseSchur) {  // islands: not a bit changes
      EXPECT_TRUE(together.a == a);
      EXPECT_TRUE(together.f == f);
    }
  }
}

// Returns the scene with its robots and contacts in these orders.
RandomScene permuted(const RandomScene& s, const std::vector<int>& robots, const std::vector<int>& contacts) {
  RandomScene out;
  out.scene.damping = s.scene.damping;
  std::vector<int> place(robots.size());
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const Robot& r = s.scene.robots[robots[k]];
    place[robots[k]] = add_robot(out.scene, r.name, r.model, r.base);
    append(out.q, s.q.segment(r.idx_q, r.model->nq));
    append(out.v, s.v.segment(r.idx_v, r.model->nv));
    append(out.u, s.u.segment(r.idx_u, r.model->nu()));
  }
  for (int k : contacts) {
    Contact c = s.scene.contacts[k];
    c.A.robot = place[c.A.robot];
    if (c.B.robot >= 0) c.B.robot = place[c.B.robot];
    add_contact(out.scene, c);
  }
  return out;
}

TEST(Laws, NumberingDoesNotMatter) {
  for (int seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(40 + seed);
    SceneOptions options;
    options.nrobots = 4;
    options.damping = seed % 3 == 0 ? 1e-3 : 0;
    options.redundant = seed % 4 == 0 ? 1 : 0;
    const RandomScene s = random_scene(rng, options);
    std::vector<int> robots(s.scene.robots.size()), contacts(s.scene.contacts.size());
    std::iota(robots.begin(), robots.end(), 0);
    std::iota(contacts.begin(), contacts.end(), 0);
    std::shuffle(robots.begin(), robots.end(), rng);
    std::shuffle(contacts.begin(), contacts.end(), rng);
    const RandomScene p = permuted(s, robots, contacts);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData before(s.scene, way.options), after(p.scene, way.options);
      const Status status = solve(s.scene, s.q, s.v, s.u, before).status;
      EXPECT_EQ(solve(p.scene, p.q, p.v, p.u, after).status, status);
      if (status == Status::kFailed) continue;
      VecX<double> a, f;  // those of `before`, in the new order
      for (int r : robots) append(a, before.a.segment(s.scene.robots[r].idx_v, s.scene.robots[r].model->nv));
      for (int c : contacts) append(f, before.f.segment(before.f_offset[c], s.scene.contacts[c].rows()));
      SceneData oracle(p.scene, {Method::kDense, {}});
      (void)solve(p.scene, p.q, p.v, p.u, oracle);
      const Errors e = errors<double>(p.scene, after, a, f, conditions(p.scene, oracle));
      EXPECT_LE(e.excess, 1) << e;
    }
  }
}

// Two robots of mixed joints are tied to each other, on the ground also to the world, and move for a second.
RandomScene moving_scene(int seed, bool in_the_air) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.nrobots = 2;
  ModelOptions model;
  model.njoints = 6;
  model.floating_base = in_the_air;
  model.armature = 0.1;
  if (in_the_air) model.armature = 0;  // rotors carry angular momentum that M's diagonal leaves out
  options.models = {model, model};
  options.same_model = 0;
  options.gains = 0;
  options.errors = false;
  options.ncontacts = 0;
  RandomScene s = random_scene(rng, options);
  hold(s, "joined", ContactType::k3D, {0, 4, random_placement(rng, 0.2)}, {1, 3, {}});
  if (!in_the_air) hold(s, "grounded", ContactType::k3D, {1, 5, random_placement(rng, 0.2)}, {});
  s.v = consistent(s.scene, s.q, 0.5 * s.v);
  s.u *= 0.2;
  return s;
}

// A law returns its relative errors after a second of simulation in `steps` steps.
using Broken = std::function<Eigen::VectorXd(const RandomScene&, const Simulation&)>;

Eigen::VectorXd broken(const RandomScene& s, Method method, int steps, const Broken& law) {
  Simulation sim(s.scene, s.q, s.v, s.u, {method, {}});
  for (int k = 0; k < steps; ++k) sim.step(1.0 / steps);
  EXPECT_EQ(sim.worst, Status::kOk);
  EXPECT_GT(size_of(sim.data.f), 0.01);  // the contacts transmit forces
  return law(s, sim);
}

// Only the integrator violates a law of the equations: by an error of fourth order, which vanishes with the step. How
// small the step must be depends on the scene; the law is that the error then vanishes.
void expect_law(const RandomScene& s, Method method, const Broken& law) {
  SCOPED_TRACE(to_string(method));
  double coarse = 0, fine = size_of(broken(s, method, 500, law));
  int steps = 500;
  while (fine > 1e-9 && steps < 16000) {
    coarse = fine;
    fine = size_of(broken(s, method, steps *= 2, law));
  }
  EXPECT_LE(fine, 1e-9) << steps << " steps";
  if (coarse > 0) {
    EXPECT_LE(fine, coarse / 8) << steps << " steps";
  }
}

// Contacts do no work: the energy changes by the work of the torques.
Eigen::VectorXd energy_error(const RandomScene& s, const Simulation& sim) {
  const Mechanics start = mechanics(s.scene, s.q, s.v), end = mechanics(s.scene, sim.q, sim.v);
  return Eigen::VectorXd::Constant(1, (end.energy() - start.energy() - sim.work) / end.kinetic);
}

TEST(Laws, ContactsDoNoWork) {
  for (int seed : {51, 52, 53, 54}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomScene s = moving_scene(seed, seed % 2 == 1);
    expect_law(s, Method::kSparseLdl, energy_error);
  }
}

// The law is tested on robots of models/: arms tied at their tools, a humanoid that falls while its soles are fixed.
TEST(Laws, ContactsDoNoWorkOnRobots) {
  const std::string arms =
      "<scene><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"><q>0.1 0.9 0.2 1.2 0.1 -0.5 0.3</q></robot>"
      "<robot name=\"b\" urdf=\"arm.urdf\" base=\"fixed\" xyz=\"1 0.2 0\"><q>-0.2 0.7 0.1 1.5 0.3 0.4 0</q></robot>"
      "<contact name=\"tie\" type=\"3d\" frame=\"a/tool\" to=\"b/tool\"/></scene>";
  const SceneFile files[] = {load_text(arms), load_edited(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml",
                                                          {{"u=\"gravity\"", "armature=\"0.05\""}})};
  for (const SceneFile& file : files) {
    SCOPED_TRACE(file.scene.robots[0].name);
    RandomScene s{file.scene, file.q, file.v, file.u};
    std::mt19937 rng(1);
    s.v = consistent(s.scene, s.q, random_vector(s.scene.nv, rng, 0.2));
    s.u = random_vector(s.scene.nu, rng, 1);
    if (s.scene.nv < 20) expect_law(s, Method::kDense, energy_error);
    expect_law(s, Method::kSparseLdl, energy_error);
  }
}

// Forces between two robots in free fall change neither the path of their centre of mass nor their spin.
Eigen::VectorXd momentum_error(const RandomScene& s, const Simulation& sim) {
  const Mechanics start = mechanics(s.scene, s.q, s.v), end = mechanics(s.scene, sim.q, sim.v);
  const Vec3<double> weight = start.mass * s.scene.gravity;
  Eigen::VectorXd error(9);
  error << (end.linear - start.linear - weight) / size_of(end.linear),
      (end.spin() - start.spin()) / size_of(start.spin()),
      (end.first_moment - start.first_moment - start.linear - 0.5 * weight) / size_of(end.first_moment);
  return error;
}

TEST(Laws, InnerContactsKeepMomentum) {
  for (int seed : {61, 62, 63}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_law(moving_scene(seed, true), Method::kSparseLdl, momentum_error);
  }
}

TEST(Laws, WithoutContactsItIsAba) {
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(70 + seed);
    SceneOptions options;
    options.ncontacts = 0;
    const RandomScene s = random_scene(rng, options);
    VecX<double> a(s.scene.nv);
    for (const Robot& r : s.scene.robots) {
      const Model& model = *r.model;
      Kinematics<double> kin(model);
      AbaData<double> data(model);
      Eigen::VectorXd tau = Eigen::VectorXd::Zero(model.nv), qdd(model.nv);
      tau.tail(model.nu()) = s.u.segment(r.idx_u, model.nu());
      EXPECT_TRUE(aba<double>(model, r.base, s.q.segment(r.idx_q, model.nq), s.v.segment(r.idx_v, model.nv), tau,
                              s.scene.gravity, {}, kin, data, qdd));
      a.segment(r.idx_v, model.nv) = qdd;
    }
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(s.scene, way.options);
      EXPECT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
      SceneData oracle(s.scene, {Method::kDense, {}});
      (void)solve(s.scene, s.q, s.v, s.u, oracle);
      const Errors e = errors<double>(s.scene, data, a, VecX<double>(), conditions(s.scene, oracle));
      EXPECT_LE(e.excess, 1) << e;
    }
  }
}

}  // namespace
}  // namespace manycontact::test
