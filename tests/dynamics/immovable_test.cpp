// Contacts whose frame A is on the base of a fixed robot constrain B as the world would, and couple nothing.

#include <gtest/gtest.h>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

// Two crates are attached to the base of an arm, the first one before it, so that its island is solved before the
// arm's. A second arm wrenches one crate, and contacts are in every reference frame.
class OnABase : public testing::Test {
 protected:
  void SetUp() override {
    file = load_text(R"(<scene><robot name="box" urdf="box.urdf" base="floating" xyz="1 0 0.3" rpy="0.2 0.1 0.3"/>
      <robot name="arm" urdf="arm.urdf" base="fixed" xyz="0.3 -0.2 0.1" rpy="0.1 0.2 0.3"/>
      <robot name="other" urdf="box.urdf" base="floating" xyz="-1 0 0.3"/>
      <robot name="pushing" urdf="arm.urdf" base="fixed" xyz="-2 0 0"/></scene>)");
    std::mt19937 rng(4);
    disturb(file, rng, 0.2);
    for (const char* box : {"box", "other"}) {
      hold(ContactType::k6D, ReferenceFrame::kLocal, attach(file.scene, "arm", base_frame()),
           attach(file.scene, box, "top_1"));
    }
    hold(ContactType::k3D, ReferenceFrame::kLocalWorldAligned, attach(file.scene, "pushing", "tool"),
         attach(file.scene, "other", "face_back"));
  }
  std::string base_frame() const {
    for (const Frame& frame : file.scene.robots[1].model->frames)
      if (frame.joint < 0) return frame.name;
    return "";
  }
  void hold(ContactType type, ReferenceFrame axes, const Attachment& A, const Attachment& B) {
    Contact c;
    c.name = "c" + std::to_string(file.scene.contacts.size());
    c.type = type;
    c.reference_frame = axes;
    c.A = A;
    c.B = B;
    c.alpha = 30;
    c.beta = 5;
    add_contact(file.scene, c);
  }

  SceneFile file;
  const Scene& scene = file.scene;
};

void expect_same(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, const char* what) {
  ASSERT_EQ(x.rows(), y.rows());
  ASSERT_EQ(x.cols(), y.cols());
  EXPECT_GT(y.norm(), 0) << what;
  EXPECT_LE((x - y).norm(), 1e-10 * y.norm()) << what;  // both are allowed 1e-12 cond(K), of at most 1e3 here
}

TEST_F(OnABase, IslandsAreSeparateAndTheAnswerIsThatOfTheWholeScene) {
  SceneData whole(scene, {Method::kDenseSchur, {}});
  for (const Way& way : ways(true)) {
    if (way.options.method == Method::kDenseSchur) continue;
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    const auto compare = [&](std::size_t islands) {
      ASSERT_EQ(solve(scene, file.q, file.v, file.u, whole).status, Status::kOk);
      ASSERT_EQ(solve(scene, file.q, file.v, file.u, data).status, Status::kOk);
      EXPECT_EQ(island_count(data), islands);
      expect_same(data.a, whole.a, "a");
      expect_same(data.f, whole.f, "f");
      (void)differentiate(scene, data);
      (void)differentiate(scene, whole);
      const SceneDerivatives d = dense_derivatives(scene, data), e = dense_derivatives(scene, whole);
      expect_same(d.da_dq, e.da_dq, "da_dq");
      expect_same(d.da_dv, e.da_dv, "da_dv");
      expect_same(d.da_du, e.da_du, "da_du");
      expect_same(d.dforces_dq, e.dforces_dq, "dforces_dq");
      Eigen::VectorXd da(scene.nv), df(data.f.size()), wq(scene.nv), wv(scene.nv), wu(scene.nu);
      jvp(scene, data, file.v, file.v, file.u, da, df);
      expect_same(da, e.da_dq * file.v + e.da_dv * file.v + e.da_du * file.u, "jvp");
      vjp(scene, data, data.a, data.f, wq, wv, wu);
      expect_same(wq, e.da_dq.transpose() * data.a + e.dforces_dq.transpose() * data.f, "vjp");
      expect_same(quasi_static(scene, file.q, data), quasi_static(scene, file.q, whole), "quasi_static");
    };
    compare(3);
    EXPECT_EQ(island_with_robot(data, 2), island_with_robot(data, 3));
    EXPECT_NE(island_with_robot(data, 0), island_with_robot(data, 1));
    const SE3<double> before = file.scene.robots[1].base;
    file.scene.robots[1].base.p += Vec3<double>(0.1, 0.2, -0.1);  // a base may move under data, with effect at once
    compare(3);
    file.scene.robots[1].base = before;
    data.active[2] = whole.active[2] = 0;
    compare(4);
    data.active[0] = whole.active[0] = 0;
    compare(4);
    data.active[2] = whole.active[2] = data.active[0] = whole.active[0] = 1;
    compare(3);
  }
}

}  // namespace
}  // namespace manycontact::test
