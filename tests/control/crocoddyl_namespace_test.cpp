// `using namespace crocoddyl`, as in programs written for Crocoddyl, makes no name ambiguous.

#include <gtest/gtest.h>

#include "manycontact/crocoddyl.hpp"

using namespace crocoddyl;

namespace {

TEST(CrocoddylNamespace, StacksAreThoseThatWarn) {
  const auto state = std::make_shared<StateMultibody>(std::make_shared<const Model>(
      load_urdf(MANYCONTACT_SOURCE_DIR "/models/humanoid.urdf", {.floating_base = true})));
  const auto actuation = std::make_shared<ActuationModelFloatingBase>(state);
  const auto costs = std::make_shared<CostModelSum>(state, actuation->get_nu());
  const auto contacts = std::make_shared<ContactModelMultiple>(state, actuation->get_nu());
  const auto constraints = std::make_shared<ConstraintModelManager>(state, actuation->get_nu());
  const ImpulseModelMultiple impulses(state);
  const CostModelSumTpl<double> same(state);
  static_assert(std::is_same_v<CostModelSum, crocoddyl::CostModelSum>);
  testing::internal::CaptureStderr();
  costs->removeCost("none");
  EXPECT_NE(testing::internal::GetCapturedStderr(), "");
  const DifferentialActionModelContactFwdDynamics model(state, actuation, contacts, costs, constraints);
  EXPECT_EQ(model.get_nu(), actuation->get_nu());
}

// The build collects the names from the headers: of classes, templates, aliases, functions, constants, enumerators.
TEST(CrocoddylNamespace, HasNamesOfEveryKind) {
  static_assert(std::is_same_v<Vec3<double>, manycontact::Vec3<double>>);
  static_assert(std::is_same_v<StateMultibodyTpl<double>, manycontact::StateMultibody>);
  static_assert(std::is_same_v<crocoddyl::SceneData, manycontact::SceneData>);
  static_assert(std::is_same_v<decltype(crocoddyl::WORLD), decltype(manycontact::WORLD)>);
  static_assert(crocoddyl::addto == manycontact::addto && crocoddyl::_4 == manycontact::_4);
  EXPECT_EQ(&crocoddyl::kMethods, &manycontact::kMethods);
  EXPECT_EQ(&crocoddyl::load_scene, &manycontact::load_scene);
  EXPECT_EQ(&crocoddyl::total_mass, &manycontact::total_mass);
}

}  // namespace
