// manycontact-mesh returns the triangles of files, or why there are none. view_test.cpp tests their use in a page.

#include "cli/mesh.hpp"

#include <cstring>

#include "support/sanitized.hpp"

namespace manycontact::cli {
namespace {

using Vertices = std::vector<std::array<float, 3>>;

class MeshReader : public Program {
 protected:
  void SetUp() override {
    if (!reads_meshes()) GTEST_SKIP() << "built without assimp";
    if (test::kSanitized) setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // assimp's, where it throws
  }
  Outcome read(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return run({path(name)}, mesh_reader());
  }
  Vertices vertices(const std::string& name, const std::string& text) const {
    const Outcome outcome = read(name, text);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    Vertices out(outcome.status == 0 ? outcome.out.size() / 12 : 0);
    std::memcpy(out.data(), outcome.out.data(), 12 * out.size());
    return out;
  }
  std::string refusal(const std::string& name, const std::string& text) const {
    const Outcome outcome = read(name, text);
    EXPECT_EQ(outcome.status, 3) << name;
    return outcome.out;
  }
};

// Values are metres, from single precision and rotations in degrees.
void expect_near(const Vertices& vertices, const Vertices& expected) {
  ASSERT_EQ(vertices.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(vertices[k][i], expected[k][i], 1e-6) << k << " " << i;
}

TEST_F(MeshReader, Stl) {
  const std::string text =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\n"
      "endsolid\n";
  EXPECT_EQ(vertices("t.STL", text), (Vertices{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));

  std::string bytes("solid, though binary");
  bytes.resize(80);
  const auto append = [&](auto x) {
    char raw[sizeof x];
    std::memcpy(raw, &x, sizeof x);
    bytes.append(raw, sizeof x);
  };
  append(std::uint32_t{2});
  for (int facet = 0; facet < 2; ++facet) {
    for (int k = 0; k < 12; ++k) append(static_cast<float>(k + 100 * facet));  // the normal first
    append(std::uint16_t{0});
  }
  EXPECT_EQ(vertices("b.stl", bytes),
            (Vertices{{3, 4, 5}, {6, 7, 8}, {9, 10, 11}, {103, 104, 105}, {106, 107, 108}, {109, 110, 111}}));
  expect_contains(refusal("cut.stl", bytes.substr(0, 150)), "has no triangles, expected at least one triangle");
  expect_contains(refusal("bad.stl", text.substr(0, 70)), "cannot be read, expected a mesh; assimp: STL: ");
  expect_contains(refusal("empty.stl", ""), "cannot be read, expected a mesh; assimp: ");
}

TEST_F(MeshReader, Obj) {
  EXPECT_EQ(vertices("m.obj",
                     "mtllib none.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvt 0 0\nv 0 1 0\n"
                     "f 1//1 2/1 3/1/1 -1\n"),
            (Vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  for (const std::string corner : {"2", "0", "-2", "1x", "99999999999999999999"})
    expect_contains(refusal("bad.obj", "# one vertex\nv 0 0 0\nf 1 1 " + corner + "\n"), "cannot be read");
  expect_contains(refusal("none.obj", "# one vertex\nv 0 0 0\n"), "has no triangles, expected at least one triangle");
}

// Vertices are in metres, placed by the nodes. Axes stay, whatever axis is up: viewers of robots expect this.
TEST_F(MeshReader, Collada) {
  const std::string plain = R"(<node><instance_geometry url="#g"/></node>)";
  for (const std::string up : {"", "<up_axis>Z_UP</up_axis>", "<up_axis>Y_UP</up_axis>", "<up_axis>X_UP</up_axis>"}) {
    expect_near(vertices("m.dae", collada(up, plain)), {{0, 0, 0}, {4, 0, 0}, {0, 5, 0}});
    expect_near(vertices("m.DAE", collada("<unit name=\"inch\" meter=\"0.0254\"/>" + up, plain)),
                {{0, 0, 0}, {0.1016F, 0, 0}, {0, 0.127F, 0}});
  }
  const std::string nodes = R"(<node><translate>100 200 300</translate><rotate>0 0 1 90</rotate>
    <node><scale>1 2 1</scale><instance_geometry url="#g"/></node></node>)" +
                            plain;
  expect_near(vertices("n.dae", collada(R"(<unit meter="0.01"/><up_axis>Z_UP</up_axis>)", nodes)),
              {{1, 2, 3}, {1, 2.04F, 3}, {0.9F, 2, 3}, {0, 0, 0}, {0.04F, 0, 0}, {0, 0.05F, 0}});

  expect_contains(refusal("bad.dae", collada("", plain, "0 1 7")), "cannot be read, expected a mesh; assimp: Invalid");
  expect_contains(refusal("cut.dae", collada("", plain).substr(0, 700)), "cannot be read, expected a mesh; assimp: ");
  expect_contains(refusal("none.dae", "<html/>"), "cannot be read, expected a mesh; assimp: ");
}

TEST_F(MeshReader, OtherFiles) {
  expect_contains(refusal("m.ply", "ply"), "is no mesh that can be read, expected a file .dae, .obj or .stl");
  expect_contains(run({path("none.stl")}, mesh_reader()).out,
                  "cannot be read, expected a mesh; assimp: Unable to open");
  expect_contains(run({}, mesh_reader()).out, "usage: manycontact-mesh FILE");
}

}  // namespace
}  // namespace manycontact::cli
