// Solves every case of the table again far from the world's origin: nothing may depend on a scene's place. Distances
// are powers of two and coordinates short, so a move rounds nothing and the solution is exactly the same.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "stability/cases.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

constexpr double kShort = 1 << 29;  // placements are rounded to multiples of 1 / kShort

double shortened(double x) { return std::isfinite(x) && std::abs(x) < 1e3 ? std::round(x * kShort) / kShort : x; }
void shorten(Vec3<double>& p) {
  for (double& x : p) x = shortened(x);
}

// Rounds the places of robots and of contacts with the world.
void shorten_places(Problem& p) {
  for (Robot& robot : p.scene.robots) {
    shorten(robot.base.p);
    if (robot.model->floating_base)
      for (int k = 0; k < 3; ++k) p.q[robot.idx_q + k] = shortened(p.q[robot.idx_q + k]);
  }
  for (Contact& c : p.scene.contacts)
    if (c.B.robot < 0) shorten(c.B.placement.p);
}

// Moves the scene: floating bases by their q, fixed ones by their placement.
void move_away(const Vec3<double>& by, Problem& p) {
  for (Robot& robot : p.scene.robots) {
    robot.base.p += by;
    if (robot.model->floating_base) p.q.segment<3>(robot.idx_q) += by;
  }
  for (Contact& c : p.scene.contacts)
    if (c.B.robot < 0) c.B.placement.p += by;
}

// Returns the model with a floating joint on a fixed base instead of a floating base; a file may contain both.
std::shared_ptr<Model> floating_by_joint(const Model& model) {
  auto out = std::make_shared<Model>(model);
  out->floating_base = false;
  out->joints.front().actuated = false;
  finalize(*out);
  return out;
}

Joint slide(const char* name, int parent, const Vec3<double>& axis) {
  Joint joint;
  joint.name = name;
  joint.type = JointType::kPrismatic;
  joint.parent = parent;
  joint.axis = axis;
  return joint;
}

// Returns a fixed robot on wheels: it slides along x and y and rotates.
std::shared_ptr<Model> on_wheels(const Model& model) {
  auto out = std::make_shared<Model>(model);
  const Vec3<double> x = Vec3<double>::UnitX(), y = Vec3<double>::UnitY();
  out->joints = {slide("slide_x", -1, x), slide("slide_y", 0, y), slide("turn", 1, Vec3<double>::UnitZ())};
  out->joints[2].type = JointType::kRevolute;
  out->joints[0].inertia = Inertia<double>::from_com(3, Vec3<double>(0.1, 0, 0.2), Mat3<double>::Identity());
  out->joints[2].inertia = Inertia<double>::from_com(5, Vec3<double>(0, 0.1, 0.3), Mat3<double>::Identity());
  for (Joint joint : model.joints) {
    joint.parent += 3;
    out->joints.push_back(std::move(joint));
  }
  for (Frame& frame : out->frames) frame.joint += 3;
  const auto longer = [](Eigen::VectorXd& values) {
    if (values.size() == 0) return;
    Eigen::VectorXd more(values.size() + 3);
    more << Eigen::Vector3d::Zero(), values;
    values = more;
  };
  longer(out->armature), longer(out->damping), longer(out->friction);
  finalize(*out);
  return out;
}

// Returns the same problem with bases made of joints, at q = 0 for robots on wheels.
Problem on_joints(const Problem& p) {
  Problem out = p;
  out.scene.robots.clear();
  out.scene.contacts.clear();
  out.scene.nq = out.scene.nv = out.scene.nu = 0;
  out.scene.robot_index.clear();
  out.scene.contact_index.clear();
  for (const Robot& robot : p.scene.robots) {
    const bool floating = robot.model->floating_base;
    add_robot(out.scene, robot.name, floating ? floating_by_joint(*robot.model) : on_wheels(*robot.model),
              floating ? SE3<double>{} : robot.base);
  }
  out.q = out.v = out.u = Eigen::VectorXd();
  const auto append = [](Eigen::VectorXd& x, const Eigen::VectorXd& more) {
    Eigen::VectorXd all(x.size() + more.size());
    all << x, more;
    x = all;
  };
  for (const Robot& robot : p.scene.robots) {
    if (!robot.model->floating_base) {
      append(out.q, Eigen::Vector3d(0, 0, 0.3));
      append(out.v, p.v.isZero(0) ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0.5, -0.3, 0.7));
      append(out.u, Eigen::Vector3d(3, -2, 0.5));
    }
    append(out.q, p.q.segment(robot.idx_q, robot.model->nq));
    append(out.v, p.v.segment(robot.idx_v, robot.model->nv));
    append(out.u, p.u.segment(robot.idx_u, robot.model->nu()));
  }
  for (Contact c : p.scene.contacts) {
    for (Attachment* at : {&c.A, &c.B})
      if (at->robot >= 0 && !p.scene.robots[at->robot].model->floating_base) at->joint += 3;
    out.scene.contacts.push_back(c);
  }
  return out;
}

// Moves the robots along the ground by their joints.
void move_joints_away(const Vec3<double>& to, Problem& p) {
  const Vec3<double> by(to[0], to[1], 0);
  for (const Robot& robot : p.scene.robots) {
    if (robot.model->joints.front().type == JointType::kFloating)
      p.q.segment<3>(robot.idx_q) += by;
    else
      p.q.segment<2>(robot.idx_q) += by.head<2>();
  }
  for (Contact& c : p.scene.contacts)
    if (c.B.robot < 0) c.B.placement.p += by;
}

struct Answer {
  Eigen::VectorXd a, f, da, df;
  Report report;
};

Answer answer(const Problem& p, const Options& options) {
  SceneData data(p.scene, options);
  (void)solve(p.scene, p.q, p.v, p.u, data);
  Answer out{data.a, data.f, {}, {}, {}};
  if (data.report.status != Status::kFailed) {
    estimate_condition(p.scene, data);
    estimate_errors(p.scene, data);
    const Eigen::VectorXd along = Eigen::VectorXd::LinSpaced(p.scene.nv, -1, 1), du = Eigen::VectorXd::Ones(p.scene.nu);
    out.da.resize(p.scene.nv), out.df.resize(data.f.size());
    jvp(p.scene, data, along, along, du, out.da, out.df);
  }
  out.report = data.report;
  return out;
}

// Returns |x - y| / |y|; entries that are NaN in both are ignored.
double difference(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  if (x.size() == 0 || !y.allFinite()) return 0;
  const double size = y.cwiseAbs().maxCoeff();
  const double off = (x - y).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  return off == 0 ? 0 : off / size;
}

struct FarWay {
  const char* name;
  Options options;
  bool small_only;
};

class Far : public testing::TestWithParam<int> {};

// The tolerance is twice the table's: both solutions have errors.
void expect_same_answer(const Answer& near, const Answer& far, const std::string& what) {
  EXPECT_EQ(to_string(near.report.status), to_string(far.report.status)) << what;
  if (near.report.status == Status::kFailed || near.report.status != far.report.status) return;
  const double allowed = 2 * std::max(1e-12, 100 * std::numeric_limits<double>::epsilon() * near.report.condition);
  if (!(allowed < 1e-2)) return;
  EXPECT_LE(difference(far.a, near.a), allowed) << what << ", accelerations";
  EXPECT_LE(difference(far.f, near.f), allowed) << what << ", forces";
  EXPECT_LE(difference(far.da, near.da), 10 * allowed) << what << ", derivatives of accelerations";
  EXPECT_LE(difference(far.df, near.df), 10 * allowed) << what << ", derivatives of forces";
  // sparse-bodies treats the distance along a slide as a moment arm: its bound grows with it, its error does not
  if (near.report.islands[0].method != Method::kSparseBodies) {
    EXPECT_LE(far.report.error_acceleration, 2 * near.report.error_acceleration + 1e-14) << what << ", claimed bound";
  }
}

void compare(const Case& c, const Problem& near, void (*move)(const Vec3<double>&, Problem&), const char* how) {
  const FarWay ways[] = {{"auto", {}, false},
                         {"dense", {Method::kDense, {}}, true},
                         {"sparse-ldl off", {Method::kSparseLdl, {}, SimdLevel::kOff}, true},
                         {"sparse-bodies", {Method::kSparseBodies, {}}, false}};
  for (const FarWay& way : ways) {
    if (way.small_only && !c.small) continue;
    const Answer here = answer(near, way.options);
    for (double distance : {0x1p10, 0x1p17, 0x1p23}) {  // 1, 131 and 8,389 km
      if (distance < 0x1p23 && way.options.method != Method::kAuto) continue;
      Problem far = near;
      move(distance * Vec3<double>(1, -0.25, 0.125), far);
      expect_same_answer(here, answer(far, way.options),
                         c.name + " by " + way.name + ", " + how + ", " + std::to_string(distance) + " m");
    }
  }
}

TEST_P(Far, NothingDependsOnWhereItStands) {
  for (const Case& c : all_causes()[GetParam()].list) {
    if (c.bad_input) continue;
    Problem p = c.make();
    if (!p.answerable || !p.q.allFinite()) continue;
    shorten_places(p);
    compare(c, p, move_away, "bases");
    compare(c, on_joints(p), move_joints_away, "joints");
  }
}

// The truth is that of the rounded placements. Contacts are with the world, and between two far robots, bases rotated.
TEST(FarTruth, AnyPlace) {
  using enum ContactType;
  for (const bool by_joints : {false, true})
    for (const ContactType type : {k1D, k3D, k6D})
      for (const double distance : {1e3, 1e5, 1e7}) {
        Problem p = two_robots("arm", false, "box");
        hold(p, type, "tool", {0, 0, 0.1}, ReferenceFrame::kLocal, "a").alpha = 25;
        tie(p, k3D, "a", "tool", "b", "face_back").alpha = 10;
        for (Contact& c : p.scene.contacts) c.beta = 5, c.B.placement.p[0] += 0.01;
        move(p);
        if (by_joints) p = on_joints(p);
        const Vec3<double> by = distance / 3 * Vec3<double>(1, -1 / 7., 1 / 9.);
        by_joints ? move_joints_away(by, p) : move_away(by, p);
        const Truth<Quad> truth =
            solve_truth<Quad>(p.scene, {1, 1}, p.q.cast<Quad>(), p.v.cast<Quad>(), p.u.cast<Quad>());
        for (const Method method : {Method::kAuto, Method::kDense, Method::kSparseBodies}) {
          const Answer x = answer(p, {method, {}});
          const std::string what = to_string(type) + " by " + to_string(method) + ", " + std::to_string(distance) +
                                   " m" + (by_joints ? ", by joints" : "");
          ASSERT_EQ(x.report.status, Status::kOk) << what;
          const double allowed = std::max(1e-12, 100 * std::numeric_limits<double>::epsilon() * x.report.condition);
          const auto off = [](const Eigen::VectorXd& x, const VecX<Quad>& truth) {
            return static_cast<double>((x.cast<Quad>() - truth).cwiseAbs().maxCoeff()) / x.cwiseAbs().maxCoeff();
          };
          const double off_a = off(x.a, truth.a), off_f = off(x.f, truth.f);
          EXPECT_LE(off_a, allowed) << what;
          EXPECT_LE(off_f, allowed) << what;
          EXPECT_LE(off_a, x.report.error_acceleration) << what;
          EXPECT_LE(off_f, x.report.error_forces) << what;
        }
      }
}

std::vector<int> far_numbers() {
  std::vector<int> out(all_causes().size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<int>(k);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Causes, Far, testing::ValuesIn(far_numbers()));

}  // namespace
}  // namespace manycontact::test
