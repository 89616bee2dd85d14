// Bodies, robots and contacts have names.

#include "manycontact/analysis/names.hpp"

#include <gtest/gtest.h>

#include "manycontact/analysis/text.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

std::string place(const Scene& scene, const std::vector<Attachment>& on_body) {
  std::vector<const Attachment*> list;
  for (const Attachment& a : on_body) list.push_back(&a);
  return place_name(scene, list);
}

TEST(PlaceName, IsTheFrameThatAttachedIt) {
  const SceneFile file = load_text(R"(<scene><robot name="b" urdf="box.urdf" base="floating"/></scene>)");
  const Scene& scene = file.scene;
  const SE3<double> to_corner(Mat3<double>::Identity(), {0.2, 0.2, 0.2});  // top_1 is there
  EXPECT_EQ(place(scene, {attach(scene, "b", "crate", to_corner)}), "b/crate");
  EXPECT_EQ(place(scene, {attach(scene, "b", "top_1"), attach(scene, "b", "top_1", to_corner)}), "b/top_1");
}

TEST(PlaceName, IsTheNearestFrameWhereSeveralOrNoneDid) {
  const SceneFile file = load_text(R"(<scene><robot name="b" urdf="box.urdf" base="floating"/></scene>)");
  const Scene& scene = file.scene;
  std::vector<Attachment> corners;
  for (int k = 1; k <= 4; ++k) corners.push_back(attach(scene, "b", "top_" + std::to_string(k)));
  EXPECT_EQ(place(scene, corners), "b/face_top");
  Attachment nameless = corners[1];
  nameless.frame.clear();
  EXPECT_EQ(place(scene, {nameless}), "b/top_2");
  EXPECT_EQ(place(scene, {nameless, corners[1]}), "b/top_2");
  EXPECT_EQ(place(scene, {Attachment{}}), "world");
  EXPECT_THROW((void)place(scene, {}), std::invalid_argument);
}

TEST(PlaceName, OfAFixedBaseIsItsFrameOrTheWorld) {
  const SceneFile file = load_text(R"(<scene><robot name="a" urdf="arm.urdf" base="fixed"/></scene>)");
  const Model& model = *file.scene.robots[0].model;
  for (const Frame& frame : model.frames) {
    const Attachment at = attach(file.scene, "a", frame.name);
    EXPECT_EQ(place(file.scene, {at}), "a/" + frame.name);
    EXPECT_EQ(place(file.scene, {world_if_immovable(file.scene, at)}), "a/" + frame.name);
    EXPECT_EQ(body_of(at) == Body{}, frame.joint < 0);
    if (frame.joint < 0) {
      EXPECT_EQ(place(file.scene, {at, Attachment{}}), "world");
    }
  }
}

TEST(Names, NeighboursOfOneModelAreARun) {
  const SceneFile file = load_text(R"(<scene><robot name="h" urdf="box.urdf" base="floating" copies="5"/>
    <robot name="x" urdf="arm.urdf" base="fixed"/> <robot name="y" urdf="beam.urdf" base="floating"/>
    <contact name="c" type="3d" frame="h/top_1"/> <contact name="d" type="3d" frame="y/end_a"/></scene>)");
  EXPECT_EQ(robot_names(file.scene, {0, 1, 2, 3, 4}), "h0 .. h4");
  EXPECT_EQ(robot_names(file.scene, {0, 1, 2, 3, 4, 5, 6}), "h0 .. h4, x, y");
  EXPECT_EQ(robot_names(file.scene, {0, 1, 2}), "h0, h1, h2");
  EXPECT_EQ(robot_names(file.scene, {0, 2, 4, 6}), "h0, h2, h4, y");
  EXPECT_EQ(robot_names(file.scene, {}), "");
  EXPECT_EQ(contact_names(file.scene, {1, 2, 3, 4, 5}), "c1 .. d");
  EXPECT_EQ(contact_names(file.scene, {0, 2}), "c0, c2");
  EXPECT_EQ(row_name(file.scene.contacts[1], 2), "c1[2]");
}

TEST(Text, CountsAndLists) {
  EXPECT_EQ(text::count(1, "velocity"), "1 velocity");
  EXPECT_EQ(text::count(0, "velocity"), "0 velocities");
  EXPECT_EQ(text::count(12, "row"), "12 rows");
  EXPECT_EQ(text::join({"a", "b", "c"}, 2), "a, b, c");
  EXPECT_EQ(text::join({"a", "b", "c", "d"}, 2), "a, b and 2 more");
  EXPECT_EQ(text::join({}), "");
}

}  // namespace
}  // namespace manycontact::test
