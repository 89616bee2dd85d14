// Contacts with a body that cannot move are contacts with the world, as in add_contact.

#include "action/walker.hpp"

namespace manycontact::test {
namespace {

TEST(Immovable, ABaseLinkIsAPlaceInTheWorld) {
  const SceneFile file = load_text(
      "<scene><robot name=\"arm\" urdf=\"arm.urdf\" base=\"fixed\" xyz=\"0.3 -0.2 0.1\" rpy=\"0.1 0.2 0.3\"/>"
      "<robot name=\"box\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0.75 0 0.2\"/></scene>");
  std::mt19937 rng(12);
  const SE3<double> offset = random_placement(rng);
  Problem between = make_problem(file), world = make_problem(file);
  const std::size_t nu = between.actuation->get_nu();
  const Multibody& m = *between.state->get_model();
  const FrameIndex face = m.getFrameId("box/face_back"), base = m.getFrameId("arm/base");
  const Eigen::Vector2d gains(30, 7);
  const auto held = std::make_shared<ContactModelBetweenBodies>(between.state, ContactType::k6D, face, base, offset,
                                                                LOCAL, nu, gains);
  between.contacts->addContact("held", held);
  const SE3<double> at = file.scene.robots[0].base * (m.frames[base].placement * offset);
  world.contacts->addContact("held", std::make_shared<ContactModel6D>(world.state, face, at, LOCAL, nu, gains));

  const auto model = between.model(), truth = world.model();
  const DataPtr data = evaluated(*model, between.x, between.u), expected = evaluated(*truth, between.x, between.u);
  EXPECT_LE(difference_of(*data, *expected), 1e-12);
  EXPECT_EQ(as_fwddyn(data).multibody->islands.size(), 2u);  // the arm, the box
  evaluated(*model, between.x, between.u, data);             // the shape is that of the creation of the data
  EXPECT_LE(difference_of(*data, *expected), 1e-12);

  held->set_offset(offset * random_placement(rng, 0.1));
  evaluated(*model, between.x, between.u, data);
  EXPECT_GT(difference_of(*data, *expected), 1e-3);
  held->set_offset(offset);
  evaluated(*model, between.x, between.u, data);
  EXPECT_LE(difference_of(*data, *expected), 1e-12);
}

}  // namespace
}  // namespace manycontact::test
