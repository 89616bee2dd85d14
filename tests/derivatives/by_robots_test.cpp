// Islands of many robots coupled by few rows are differentiated robot by robot. If an order is requested, the island's
// factor is used instead; both are exact up to rounding error.

#include "derivatives/judge.hpp"
#include "support/random.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

SceneFile ring() {
  SceneFile file = load_small(MANYCONTACT_SOURCE_DIR "/models/ring_of_humanoids.xml");
  std::mt19937 rng(17);
  disturb(file, rng);
  return file;
}

// Returns robots of different sizes, fixed and floating, in a row; the last is coupled to the first twice, by few rows.
SceneFile row_of_arms(int robots) {
  std::mt19937 rng(5);
  SceneOptions options;
  const std::vector<JointType> types = {JointType::kRevolute};
  options.models = {{.njoints = 25, .floating_base = true, .types = types},
                    {.njoints = 22, .types = types},
                    {.njoints = 20, .floating_base = true, .types = types}};
  options.nrobots = robots;
  options.ncontacts = 0;
  const RandomScene s = random_scene(rng, options);
  SceneFile file;
  file.scene = s.scene;
  file.q = s.q, file.v = s.v, file.u = s.u;
  const auto add = [&](ContactType type, Attachment A, Attachment B) {
    Contact contact;
    contact.name = "c" + std::to_string(file.scene.contacts.size());
    contact.type = type;
    contact.reference_frame = ReferenceFrame::kWorld;
    contact.A = A;
    contact.B = B;
    contact.alpha = 10, contact.beta = 5;
    add_contact(file.scene, contact);
  };
  const auto at = [&](int robot, int joint) { return Attachment{robot, joint, random_placement(rng, 0.2)}; };
  for (int r = 0; r < robots; ++r) {
    if (r % 3 != 1) add(ContactType::k3D, at(r, 4), Attachment{-1, -1, random_placement(rng, 1)});
    if (r > 0) add(r % 2 ? ContactType::k3D : ContactType::k6D, at(r - 1, 19), at(r, 14));
  }
  add(ContactType::k1D, at(robots - 1, 17), at(0, 12));
  add(ContactType::k2D, at(0, 10), at(robots - 1, 12));
  return file;
}

MatX<Quad> derivatives_of(const SceneFile& file, const Options& options, const std::vector<char>& active,
                          const DerivativeRequest& request, double* condition = nullptr) {
  SceneData data(file.scene, options);
  data.active = active;
  EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kOk);
  const DerivativeData& dd = differentiate_afresh(file.scene, data, request);
  EXPECT_EQ(dd.islands.size(), 1u);
  if (condition) {
    estimate_condition(file.scene, data);
    *condition = data.report.condition;
  }
  const IslandDerivatives& d = dd.islands.front();
  EXPECT_TRUE(d.X.rightCols(d.X.cols() - d.cols).isZero(0));
  return d.X.leftCols(d.cols).cast<Quad>();
}

// Both methods agree up to rounding error, but not in their bits: there are two.
void expect_both_ways_agree(const SceneFile& file, const std::vector<char>& active,
                            const DerivativeRequest& request = {}) {
  double condition = 0;
  const Island island = whole_scene(file.scene, active);
  const MatX<Quad> by_factor =
      derivatives_of(file, {Method::kSparseLdl, Order::kLeafToRoot}, active, request, &condition);
  const MatX<Quad> by_robots = derivatives_of(file, {Method::kSparseLdl, {}}, active, request);
  ASSERT_EQ(by_factor.cols(), by_robots.cols());
  const int v = request.q ? island.nv : 0, u = v + (request.v ? island.nv : 0);
  const DerivativeErrors e = derivative_errors(file.scene, island, by_robots.cast<double>(), by_factor,
                                               {0, v, u, static_cast<int>(by_factor.cols())}, 2 * condition);
  EXPECT_LE(e.excess, 1) << "condition " << condition;
  for (double error : e.quantity) EXPECT_LE(error, kExpected);
  if (!kSanitized) {  // with other rounding a column may be left to the factor
    EXPECT_FALSE(by_factor == by_robots);
  }
}

std::vector<char> all_of(const Scene& scene) { return std::vector<char>(scene.contacts.size(), 1); }

TEST(ByRobots, AgreesWithTheFactor) {
  for (SceneFile file : {ring(), row_of_arms(12)})
    for (double damping : {0.0, 1e-6, 1e-2}) {
      SCOPED_TRACE(std::to_string(file.scene.nrobots()) + " robots, damping " + std::to_string(damping));
      file.scene.damping = damping;
      expect_both_ways_agree(file, all_of(file.scene));
    }
}

// So many are written past the caches (kCacheBytes).
TEST(ByRobots, MoreDerivativesThanCachesHold) {
  SceneFile file =
      load_edited(MANYCONTACT_SOURCE_DIR "/models/ring_of_humanoids.xml", {{"copies=\"16\"", "copies=\"11\""}});
  std::mt19937 rng(18);
  disturb(file, rng);
  const double rows = whole_scene(file.scene, all_of(file.scene)).size(), columns = 2 * file.scene.nv + file.scene.nu;
  ASSERT_GT(8 * rows * columns, 5 << 20);
  expect_both_ways_agree(file, all_of(file.scene));
}

TEST(ByRobots, PartsOfTheDerivatives) {
  const SceneFile file = ring();
  for (const DerivativeRequest& request :
       {DerivativeRequest{true, false, false, true}, DerivativeRequest{false, true, true, true},
        DerivativeRequest{true, true, true, true, true}}) {
    SCOPED_TRACE(std::to_string(request.q) + std::to_string(request.v) + std::to_string(request.tau));
    expect_both_ways_agree(file, all_of(file.scene), request);
  }
}

// A coupling is repeated a little apart: this method is sound, or the factor is used.
TEST(ByRobots, RowsThatNearlyDependOnEachOther) {
  for (const double apart : {1e-2, 1e-3, 1e-4, 3e-5}) {
    SCOPED_TRACE(apart);
    SceneFile file = row_of_arms(12);
    Contact again = file.scene.contacts[file.scene.contacts.size() - 2];
    again.name = "again";
    for (Attachment* end : {&again.A, &again.B}) end->placement.p += end->placement.R.col(0) * apart;
    add_contact(file.scene, again);
    const std::vector<char> active = all_of(file.scene);
    double condition = 0;
    const MatX<Quad> by_factor = derivatives_of(file, {Method::kSparseLdl, Order::kLeafToRoot}, active, {}, &condition);
    const MatX<Quad> either = derivatives_of(file, {Method::kSparseLdl, {}}, active, {});
    const Island island = whole_scene(file.scene, active);
    EXPECT_LE(derivative_errors(file.scene, island, either.cast<double>(), by_factor,
                                {0, island.nv, 2 * island.nv, static_cast<int>(either.cols())}, 2 * condition)
                  .excess,
              1)
        << "condition " << condition;
  }
}

// Memory of another contact set, and of another state with dependent rows, has no effect.
TEST(ByRobots, AfterOtherContactsAndStates) {
  SceneFile file = row_of_arms(12);
  const Scene& scene = file.scene;
  SceneData data(scene, {Method::kSparseLdl, {}});
  std::vector<char> active = all_of(scene);
  for (const int off : {-1, 0, static_cast<int>(active.size()) - 1, -1}) {
    active = all_of(scene);
    if (off >= 0) active[off] = 0;
    data.active = active;
    (void)solve(scene, file.q, file.v, file.u, data);
    const IslandDerivatives& d = differentiate(scene, data).islands.front();
    EXPECT_TRUE(d.X.leftCols(d.cols).cast<Quad>() == derivatives_of(file, {Method::kSparseLdl, {}}, active, {}));
    expect_both_ways_agree(file, active);
  }
}

}  // namespace
}  // namespace manycontact::test
