// Functions refuse a q that is no configuration, and a v that is no velocity, in C++, without a binding's checks.

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "manycontact/manycontact.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

struct State {
  VectorXd q, v;
};

class UnusableStates : public testing::Test {
 protected:
  UnusableStates() : file_(load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml")), data_(scene()) {
    EXPECT_EQ(solve(scene(), file_.q, file_.v, file_.u, data_).status, Status::kOk);
    const std::vector<char> active(scene().contacts.size(), 1);
    const VectorXd a = VectorXd::Ones(scene().nv);
    of_q_ = {
        {"integrate", [this](const State& s) { (void)integrate(scene(), s.q, s.v); }},
        {"difference", [this](const State& s) { (void)difference(scene(), file_.q, s.q); }},
        {"forward_kinematics", [this](const State& s) { forward_kinematics(scene(), s.q, s.v, body_); }},
        {"rnea", [this, a](const State& s) { (void)rnea(scene(), s.q, s.v, a, body_); }},
        {"aba", [this, a](const State& s) { (void)aba(scene(), s.q, s.v, a, body_); }},
        {"crba", [this](const State& s) { (void)crba(scene(), s.q, body_); }},
        {"coriolis_matrix", [this](const State& s) { (void)coriolis_matrix(scene(), s.q, s.v, body_); }},
        {"contact_jacobian", [this](const State& s) { (void)contact_jacobian(scene(), s.q); }},
        {"contact_bias_acceleration", [this](const State& s) { (void)contact_bias_acceleration(scene(), s.q, s.v); }},
        {"resolve_references", [this](const State& s) { resolve_references(file_.scene, s.q); }},
        {"resolver", [this](const State& s) { ReferenceResolver(scene(), s.q); }},
        {"place", [this](const State& s) { (void)place(scene(), s.q, {}); }},
        {"make_consistent", [this](const State& s) { (void)make_consistent(scene(), s.q, s.v); }},
        {"update_kinematics", [this](const State& s) { update_kinematics(scene(), s.q, s.v, data_); }},
        {"placement_errors", [=, this](const State& s) { (void)placement_errors(scene(), s.q, active); }},
        {"velocity_errors", [=, this](const State& s) { (void)velocity_errors(scene(), s.q, s.v, active); }},
        {"quasi_static", [this](const State& s) { (void)quasi_static(scene(), s.q); }},
    };
  }
  const Scene& scene() const { return file_.scene; }
  State usable() const { return {file_.q, file_.v}; }

  SceneFile file_;
  SceneData data_;
  RigidBodyData body_{file_.scene};
  std::map<std::string, std::function<void(const State&)>> of_q_;
};

TEST_F(UnusableStates, AreRefused) {
  for (const auto& [name, call] : of_q_) {
    EXPECT_NO_THROW(call(usable())) << name;
    for (const double wrong : {kNaN, HUGE_VAL, -HUGE_VAL}) {
      State s = usable();
      s.q[s.q.size() - 1] = wrong;
      EXPECT_THROW(call(s), std::invalid_argument) << name << " " << wrong;
    }
    for (const double length : {0., 1e-200, 0.5, 1 - 2e-6, 1 + 2e-6, 2.}) {
      State s = usable();
      s.q.segment<4>(3) *= length;
      EXPECT_THROW(call(s), std::invalid_argument) << name << " " << length;
    }
    State nearly = usable();
    nearly.q.segment<4>(3) *= 1 + 4e-7;
    EXPECT_NO_THROW(call(nearly)) << name;
  }
}

TEST_F(UnusableStates, OfVelocitiesToo) {
  for (const char* name : {"integrate", "forward_kinematics", "rnea", "aba", "coriolis_matrix",
                           "contact_bias_acceleration", "make_consistent", "update_kinematics", "velocity_errors"}) {
    State s = usable();
    s.v[0] = kNaN;
    EXPECT_THROW(of_q_.at(name)(s), std::invalid_argument) << name;
  }
}

}  // namespace
}  // namespace manycontact::test
