// ContactModel5D has the rows of a scene's 5D contact, values and derivatives.

#include "action/walker.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

TEST(Hinge, IsTheScenes) {
  const SceneFile file = load_text(
      "<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\"/>"
      "<contact name=\"c\" type=\"5d\" frame=\"h/left_sole\" axis=\"1 2 2\" gains=\"30 7\" xyz=\"0.1 0 0.2\" "
      "quat_xyzw=\"0 0 0.6 0.8\"/></scene>");
  Problem hinge = make_problem(file), of_scene = make_problem(file);
  const std::size_t nu = hinge.actuation->get_nu();
  const FrameIndex sole = hinge.state->get_model()->getFrameId("left_sole");
  const Contact& contact = file.scene.contacts[0];
  const auto model5d = std::make_shared<ContactModel5D>(hinge.state, sole, contact.B.placement,
                                                        Eigen::Vector3d(1, 2, 2), nu, Eigen::Vector2d(30, 7));
  EXPECT_EQ(model5d->get_nc(), 5u);
  EXPECT_LE(difference_of(model5d->get_axis(), contact.axis), 1e-15);
  hinge.contacts = std::make_shared<ContactModelMultiple>(hinge.state, nu);
  hinge.contacts->addContact("c", model5d);
  std::mt19937 rng(13);
  hinge.x.tail(hinge.state->get_nv()) = random_vector(static_cast<int>(hinge.state->get_nv()), rng, 0.5);
  const auto model = hinge.model();
  const DataPtr data = evaluated(*model, hinge.x, hinge.u);
  EXPECT_LE(difference_of(*data, *evaluated(*of_scene.model(), hinge.x, hinge.u)), 1e-12);

  // and those of differences
  DifferentialActionModelNumDiff differences(model, true);
  const DataPtr truth = differences.createData();
  differences.calc(truth, hinge.x, hinge.u);
  differences.calcDiff(truth, hinge.x, hinge.u);
  EXPECT_LE(error_of(data->Fx, truth->Fx), 1e-5);
  EXPECT_LE(error_of(data->Fu, truth->Fu), 1e-5);
  EXPECT_THROW(ContactModel5D(hinge.state, sole, contact.B.placement, Eigen::Vector3d::Zero(), nu),
               std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
