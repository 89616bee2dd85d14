// What URDFs draw: shapes, colours, and the meshes they name.

#include "manycontact/io/visuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "manycontact/io/mesh.hpp"
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
  ASSERT_EQ(visuals.size(), 4u);  // neither the capsule, which URDF has not, nor the empty one
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

TEST_F(Visuals, Stl) {
  const Mesh text = load_mesh(write("t.STL",
                                    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                    "vertex 0 2 0\nendloop\nendfacet\nendsolid\n"));
  ASSERT_EQ(text.triangles.size(), 1u);
  EXPECT_EQ(text.vertices[2], (std::array<float, 3>{0, 2, 0}));

  std::string bytes("solid, though binary");
  bytes.resize(80);
  const auto append = [&](auto x) {
    char raw[sizeof x];
    std::memcpy(raw, &x, sizeof x);
    bytes.append(raw, sizeof x);
  };
  append(std::uint32_t{2});
  for (int facet = 0; facet < 2; ++facet) {
    for (int k = 0; k < 12; ++k) append(static_cast<float>(k + 100 * facet));
    append(std::uint16_t{0});
  }
  const Mesh binary = load_mesh(write("b.stl", bytes));
  ASSERT_EQ(binary.triangles.size(), 2u);
  EXPECT_EQ(binary.vertices[0], (std::array<float, 3>{3, 4, 5}));
  EXPECT_EQ(binary.vertices[5], (std::array<float, 3>{109, 110, 111}));

  const auto refused = [&](const std::string& text_of_file) {
    return error_of([&] { load_mesh(write("bad.stl", text_of_file)); });
  };
  EXPECT_TRUE(refused(bytes.substr(0, 150)).starts_with("1: has no triangles"));  // cut short
  EXPECT_TRUE(refused("").starts_with("1: has no triangles"));
  EXPECT_TRUE(refused("solid\nvertex 0 0\n").starts_with("2: a vertex has fewer"));
  EXPECT_TRUE(refused("solid\nvertex 0 0 0\nendloop\n").starts_with("3: a facet has not three"));
  EXPECT_TRUE(refused("solid\nvertex 0 0 x\n").starts_with("2: "));
}

TEST_F(Visuals, Obj) {
  const Mesh mesh = load_mesh(write("m.obj",
                                    "# a square\no s\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nvn 0 0 1\nvt 0 0\n"
                                    "v 0 1 0\nf 1//1 2/1 3/1/1 -1\n"));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  const auto refused = [&](const std::string& text) { return error_of([&] { load_mesh(write("bad.obj", text)); }); };
  EXPECT_TRUE(refused("v 0 0 0\nf 1 1 2\n").starts_with("2: a face's corner '2' is no vertex"));
  EXPECT_TRUE(refused("v 0 0 0\nf 1 1 0\n").starts_with("2: a face's corner '0'"));
  EXPECT_TRUE(refused("v 0 0 0\nf 1 1 -2\n").starts_with("2: a face's corner '-2'"));
  EXPECT_TRUE(refused("v 0 0 0\nf 1 1 1x\n").starts_with("2: a face's corner '1x'"));
  EXPECT_TRUE(refused("v 0 0 0\n").starts_with("1: has no triangles"));
  EXPECT_TRUE(error_of([&] { load_mesh(write("m.dae", "")); }).starts_with("1: is no mesh that can be read"));
}

}  // namespace
}  // namespace manycontact
