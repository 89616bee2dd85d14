// URDFs contain visuals: shapes, colours, and names of meshes.

#include "manycontact/io/visuals.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/folder.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

class Visuals : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }
  test::TemporaryFolder folder_;
};

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return std::to_string(error.line) + ": " + error.message;
  }
  return "";
}

TEST_F(Visuals, ShapesPlacesColours) {
  const auto visuals = load_visuals(write("r.urdf", R"(<robot name="r">
    <material name="red"><color rgba="1 0 0 1"/></material>
    <link name="a">
      <visual><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><geometry><box size="1 2 3"/></geometry>
        <material name="red"/></visual>
      <visual><geometry><cylinder radius="0.5" length="2"/></geometry>
        <material name=""><color rgba="0 0.5 1 0.25"/></material></visual>
      <visual><geometry><capsule radius="1" length="2"/></geometry></visual>
      <visual/>
    </link>
    <link name="b">
      <visual><geometry><sphere radius="0.25"/></geometry><material name="unknown"/></visual>
      <visual><geometry><mesh filename="m.stl" scale="1 1 -1"/></geometry></visual>
    </link></robot>)"));
  ASSERT_EQ(visuals.size(), 4u);  // neither the capsule, which URDF does not have, nor the empty one
  EXPECT_EQ(visuals[0].link, "a");
  EXPECT_EQ(visuals[0].size, Vec3<double>(1, 2, 3));
  EXPECT_EQ(visuals[0].placement.p, Vec3<double>(1, 2, 3));
  EXPECT_LT((visuals[0].placement.R * Vec3<double>::UnitX() - Vec3<double>::UnitY()).norm(), 1e-15);
  EXPECT_EQ(visuals[0].colour, (std::array<double, 4>{1, 0, 0, 1}));
  EXPECT_EQ(visuals[1].shape, VisualShape::kCylinder);
  EXPECT_EQ(visuals[1].size, Vec3<double>(0.5, 2, 0));
  EXPECT_EQ(visuals[1].colour, (std::array<double, 4>{0, 0.5, 1, 0.25}));
  EXPECT_EQ(visuals[2].shape, VisualShape::kSphere);
  EXPECT_FALSE(visuals[2].colour.has_value());
  EXPECT_EQ(visuals[3].link, "b");
  EXPECT_EQ(visuals[3].mesh, "m.stl");
  EXPECT_EQ(visuals[3].size, Vec3<double>(1, 1, -1));
}

TEST_F(Visuals, MistakesNameTheLine) {
  const auto visual = [&](const std::string& geometry) {
    return error_of([&] {
      load_visuals(write("r.urdf", "<robot name=\"r\"><link name=\"a\">\n<visual><geometry>\n" + geometry +
                                       "</geometry></visual></link></robot>"));
    });
  };
  EXPECT_EQ(visual("<box size=\"1 2 3\"/>"), "");
  EXPECT_TRUE(visual("<box size=\"1 2\"/>").starts_with("3: "));
  EXPECT_TRUE(visual("<box/>").starts_with("3: "));
  EXPECT_TRUE(visual("<sphere radius=\"nan\"/>").starts_with("3: "));
  EXPECT_TRUE(visual("<mesh/>").starts_with("3: "));
}

TEST_F(Visuals, MeshesAreFound) {
  const std::string urdf = write("share/pkg/urdf/r.urdf", "");
  const std::string mesh = write("share/pkg/meshes/m.stl", ""), beside = write("share/pkg/urdf/n.obj", "");
  EXPECT_EQ(find_mesh(urdf, "package://pkg/meshes/m.stl"), mesh);
  EXPECT_EQ(find_mesh(urdf, "package:///pkg/meshes/m.stl"), mesh);
  EXPECT_EQ(find_mesh(urdf, "package://pkg/meshes/none.stl"), "");
  EXPECT_EQ(find_mesh(urdf, "package://other/meshes/m.stl"), "");
  EXPECT_EQ(find_mesh(urdf, "n.obj"), beside);
  EXPECT_EQ(fs::canonical(find_mesh(urdf, "../meshes/m.stl")), fs::canonical(mesh));
  EXPECT_EQ(find_mesh(urdf, "file://" + mesh), mesh);
  EXPECT_EQ(find_mesh(urdf, "package://"), "");

  const std::string elsewhere = write("ros/other/meshes/m.stl", "");
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + (folder_ / "ros").string()).c_str(), 1);
  EXPECT_EQ(find_mesh(urdf, "package://other/meshes/m.stl"), elsewhere);
  setenv("ROS_PACKAGE_PATH", (folder_ / "ros/other").c_str(), 1);
  EXPECT_EQ(find_mesh(urdf, "package://other/meshes/m.stl"), elsewhere);
  unsetenv("ROS_PACKAGE_PATH");
}

}  // namespace
}  // namespace manycontact
