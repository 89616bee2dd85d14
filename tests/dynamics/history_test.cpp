// Data that were used in any way give the bits of new data: contacts move, gains, frames and sets of contacts change,
// and states that cannot be solved come between. Several contacts join the same two bodies.

#include <gtest/gtest.h>

#include <cstdlib>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/several_contacts.hpp"

namespace manycontact::test::history {
namespace {

using Eigen::VectorXd;

RandomScene random_trees(std::mt19937& rng) {
  SceneOptions options;
  options.nrobots = integer(rng, 1, 4);
  options.models.resize(1);
  options.models[0].njoints = integer(rng, 2, 8);
  options.models[0].floating_base = chance(rng, 0.5);
  options.ncontacts = integer(rng, 2, 8);
  options.same_link = 0.6;
  options.redundant = integer(rng, 0, 4), options.contradicting = integer(rng, 0, 1);
  if (chance(rng, 0.7)) options.frames = {ReferenceFrame::kLocal};
  if (chance(rng, 0.2)) options.damping = 1e-3;
  return random_scene(rng, options);
}

Options random_options(std::mt19937& rng) {
  const Method methods[] = {Method::kAuto,          Method::kAuto,           Method::kAuto,
                            Method::kAuto,          Method::kSparseLdl,      Method::kSparseBodies,
                            Method::kSparseCholmod, Method::kSuiteSparseLdl, Method::kDense};
  Options out;
  out.method = methods[integer(rng, 0, 8)];
  if (chance(rng, 0.2)) out.simd_level = SimdLevel::kOff;
  if (chance(rng, 0.15)) out.precision = kPrecisions[integer(rng, 0, 2)];
  return out;
}

// Changes what may change under data in use (data.hpp), and the sets of contacts.
void change(std::mt19937& rng, RandomScene& s, SceneData& data) {
  for (Contact& c : s.scene.contacts) {
    if (chance(rng, 0.3)) c.B.placement.p += Vec3<double>(random_vector(3, rng, 0.05));
    if (chance(rng, 0.1)) c.B.placement.R *= random_rotation(rng);
    if (chance(rng, 0.2)) c.alpha = uniform(rng, 0, 100), c.beta = uniform(rng, 0, 20);
    if (chance(rng, 0.03)) c.reference_frame = static_cast<ReferenceFrame>(integer(rng, 0, 2));
  }
  if (chance(rng, 0.1)) s.scene.gravity = random_vector(3, rng, 5);
  if (chance(rng, 0.05)) s.scene.damping = chance(rng, 0.5) ? 0 : 1e-4;
  if (chance(rng, 0.05)) s.scene.moment_length = uniform(rng, 0.1, 2);
  for (Robot& robot : s.scene.robots)
    if (chance(rng, 0.05)) robot.base = random_placement(rng);
  if (chance(rng, 0.5)) s.v = random_vector(s.scene.nv, rng, 0.3);
  if (chance(rng, 0.5)) s.u = random_vector(s.scene.nu, rng, 5);
  if (chance(rng, 0.1)) data.options = random_options(rng);
  if (chance(rng, 0.6))
    for (char& active : data.active)
      if (chance(rng, 0.4)) active = !active;
}

bool same_bits(const Eigen::Ref<const Eigen::MatrixXd>& x, const Eigen::Ref<const Eigen::MatrixXd>& y) {
  const auto same = [](double a, double b) { return a == b || (a != a && b != b); };
  return x.rows() == y.rows() && x.cols() == y.cols() && x.binaryExpr(y, same).all();
}

// What differs between the answers of both, and their derivatives and products; empty if nothing does.
std::string difference(const RandomScene& s, SceneData& x, SceneData& y) {
  if (x.report.status != y.report.status) return "status";
  if (x.report.rank != y.report.rank) return "rank";
  for (std::size_t i = 0; i < x.report.islands.size(); ++i)
    if (x.report.islands[i].dependent_rows != y.report.islands[i].dependent_rows) return "dependent rows";
  if (!same_bits(x.a, y.a)) return "a";
  if (!same_bits(x.f, y.f)) return "f";
  if (x.report.status == Status::kFailed) return "";
  const DerivativeData &dx = differentiate(s.scene, x), &dy = differentiate(s.scene, y);
  for (std::size_t i = 0; i < dx.islands.size(); ++i) {
    const IslandDerivatives &of_x = dx.islands[i], &of_y = dy.islands[i];
    // X has further columns, as many as the way to it needed.
    if (of_x.cols != of_y.cols || !same_bits(of_x.X.leftCols(of_x.cols), of_y.X.leftCols(of_y.cols)))
      return "derivatives";
  }
  std::mt19937 rng(1);
  const VectorXd dq = random_vector(s.scene.nv, rng), du = random_vector(s.scene.nu, rng),
                 wf = random_vector(static_cast<int>(x.f.size()), rng);
  VectorXd da[2], df[2], wq[2], wv[2], wu[2];
  SceneData* const both[] = {&x, &y};
  for (int k = 0; k < 2; ++k) {
    for (VectorXd* of : {&da[k], &wq[k], &wv[k]}) of->resize(s.scene.nv);
    df[k].resize(x.f.size()), wu[k].resize(s.scene.nu);
    jvp(s.scene, *both[k], dq, dq, du, da[k], df[k]);
    vjp(s.scene, *both[k], dq, wf, wq[k], wv[k], wu[k]);
  }
  if (!same_bits(da[0], da[1]) || !same_bits(df[0], df[1])) return "jvp";
  return same_bits(wq[0], wq[1]) && same_bits(wv[0], wv[1]) && same_bits(wu[0], wu[1]) ? "" : "vjp";
}

// What differs at any step of a sequence; empty if nothing does.
std::string difference_of_sequence(int seed) {
  std::mt19937 rng(seed);
  RandomScene s = chance(rng, 0.6) ? random_boxes(rng) : random_trees(rng);
  SceneData used(s.scene, random_options(rng));
  for (int step = 0; step < 6; ++step) {
    if (step > 0) change(rng, s, used);
    if (chance(rng, 0.1)) {
      VectorXd v = s.v;
      v[integer(rng, 0, s.scene.nv - 1)] = kNaN;
      (void)solve(s.scene, s.q, v, s.u, used);
    }
    RandomScene at = s;
    if (chance(rng, 0.1)) at.scene.wrenches.clear(), at.scene.springs.clear();
    SceneData fresh(at.scene, used.options);
    fresh.active = used.active;
    for (SceneData* data : {&used, &fresh}) (void)solve(at.scene, s.q, s.v, s.u, *data);
    const std::string what = difference(at, used, fresh);
    if (!what.empty()) return what + " at step " + std::to_string(step) + " by " + to_string(used.options.method);
  }
  return "";
}

// MANYCONTACT_SEQUENCES: how many sequences, in place of these.
TEST(History, LeavesNoTrace) {
  const char* const asked = std::getenv("MANYCONTACT_SEQUENCES");
  const int count = asked ? std::atoi(asked) : 300;
  int found = 0;
  for (int seed = 0; seed < count; ++seed) {
    const std::string what = difference_of_sequence(seed);
    if (what.empty()) continue;
    if (++found <= 20) ADD_FAILURE() << "seed " << seed << ": " << what;
  }
  EXPECT_EQ(found, 0) << "of " << count << " sequences";
}

}  // namespace
}  // namespace manycontact::test::history
