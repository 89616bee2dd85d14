#include "answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "support/islands.hpp"
#include "support/methods.hpp"
#include "targets.hpp"

namespace manycontact::fuzz {

namespace {

using Eigen::VectorXd;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNoDigits = 1e-2;  // an allowed error that is meaningless
constexpr double kHidden = 1e8;     // a condition above which one matrix may have two ranks

double size_of(const VectorXd& x) { return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0; }

/// Coordinates of an island in a, and in f.
struct Places {
  std::vector<int> v, f;
};

Places places(const Scene& scene, const SceneData& data, const Island& island) {
  Places out;
  for (const int r : island.robots) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(r)];
    for (int i = 0; i < robot.model->nv; ++i) out.v.push_back(robot.idx_v + i);
  }
  for (const int c : island.contacts)
    for (int i = 0; i < scene.contacts[static_cast<std::size_t>(c)].rows(); ++i)
      out.f.push_back(data.f_offset[static_cast<std::size_t>(c)] + i);
  return out;
}

/// A solve, its condition and bounds, and the derivatives along a direction.
struct Answer {
  Answer(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u, const Options& options)
      : data(scene, options) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    data.a.setConstant(nan);
    data.f.setConstant(nan);
    (void)solve(scene, q, v, u, data);
    estimate_condition(scene, data);
    estimate_errors(scene, data);
    const auto direction = [](Eigen::Index n, double phase) {
      return VectorXd::NullaryExpr(n, [=](Eigen::Index i) { return std::sin(1.7 * static_cast<double>(i) + phase); })
          .eval();
    };
    dq = direction(scene.nv, 0), dv = direction(scene.nv, 1), du = direction(scene.nu, 2);
    da = VectorXd::Constant(scene.nv, nan);
    df = VectorXd::Constant(data.f.size(), nan);
    jvp(scene, data, dq, dv, du, da, df);
  }

  /// Returns the report of the i-th of the scene's islands; dense-schur has a single one.
  const IslandReport& report(std::size_t island) const {
    return data.report.islands[data.report.islands.size() == 1 ? 0 : island];
  }

  SceneData data;
  VectorXd dq, dv, du, da, df;
};

class Judge {
 public:
  Judge(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u)
      : scene_(scene), q_(q), v_(v), u_(u), oracle_(scene, q, v, u, {Method::kDense, {}}) {
    SceneData free(scene, {Method::kDense, {}});
    free.active.assign(scene.contacts.size(), 0);
    (void)solve(scene, q, v, u, free);
    a_free_ = free.a;
    islands_ = test::islands_at(scene, oracle_.data);
    way_ = "dense";
    for (std::size_t i = 0; i < islands_.size(); ++i) check_numbers(oracle_, i);
  }

  void judge(const test::Way& way) {
    way_ = way.name;
    const Answer mine(scene_, q_, v_, u_, way.options);
    for (std::size_t i = 0; i < islands_.size(); ++i) {
      check_numbers(mine, i);
      if (answered(mine.report(i)) && answered(oracle_.report(i))) compare(mine, i);
    }
  }

  // The bits are the same again after another contact set in between. Products agree with the matrices.
  void judge_memory(const test::Way& way) {
    way_ = way.name;
    Answer mine(scene_, q_, v_, u_, way.options);
    check_products(mine);
    const VectorXd a = mine.data.a, f = mine.data.f;
    if (mine.data.active.empty()) return;
    mine.data.active[0] = !mine.data.active[0];
    (void)solve(scene_, q_, v_, u_, mine.data);
    mine.data.active[0] = !mine.data.active[0];
    (void)solve(scene_, q_, v_, u_, mine.data);
    if (mine.data.report.status == Status::kFailed) return;
    if (mine.data.a != a || mine.data.f != f) fail("other bits after a contact was switched off and on", 0);
  }

 private:
  static bool answered(const IslandReport& report) {
    return report.status == Status::kOk || report.status == Status::kRedundant ||
           report.status == Status::kInconsistent;
  }

  [[noreturn]] void fail(const std::string& what, std::size_t island, double is = 0, double allowed = 0) const {
    std::ostringstream out;
    out.precision(3);
    out << way_ << ", island " << island << ": " << what;
    if (allowed > 0) out << ", " << is << ", allowed " << allowed;
    throw Finding(out.str());
  }

  void check_numbers(const Answer& answer, std::size_t i) const {
    const IslandReport& report = answer.report(i);
    const Places at = places(scene_, answer.data, islands_[i]);
    const VectorXd a = answer.data.a(at.v), f = answer.data.f(at.f);
    if (report.status == Status::kFailed) {
      if (!a.array().isNaN().all() || !f.array().isNaN().all()) fail("failed, with numbers", i);
      if (!answer.da(at.v).array().isNaN().all()) fail("failed, with derivatives", i);
      return;
    }
    if (!a.allFinite() || !f.allFinite()) fail(to_string(report.status) + ", without numbers", i);
    if (report.rank > report.nc || report.dependent_rows.size() > static_cast<std::size_t>(report.nc))
      fail("more rank or dependent rows than rows", i);
    if (std::isnan(report.condition) || std::isnan(report.error_acceleration) || std::isnan(report.error_forces))
      fail("a condition or a bound that is NaN", i);
  }

  void compare(const Answer& mine, std::size_t i) const {
    const IslandReport &r = mine.report(i), &o = oracle_.report(i);
    const double condition = std::max(r.condition, o.condition);
    const bool schur = mine.data.options.method == Method::kDenseSchur;
    if (!schur && r.rank != o.rank) {
      if (condition < kHidden) fail("rank " + std::to_string(r.rank) + ", the oracle's " + std::to_string(o.rank), i);
      return;
    }
    const Places at = places(scene_, mine.data, islands_[i]);
    const VectorXd a = oracle_.data.a(at.v), f = oracle_.data.f(at.f), da = oracle_.da(at.v), df = oracle_.df(at.f);
    // |K^-1| in bounds and conditions is an estimate, up to three times too small.
    const double bound_a = 3 * (r.error_acceleration + o.error_acceleration);
    const double bound_f = 3 * (r.error_forces + o.error_forces);
    if (!schur) {
      check_bound("accelerations", mine.data.a(at.v), a, bound_a, i);
      check_bound("forces", mine.data.f(at.f), f, bound_f, i);
    }
    // Each is within max(1e-12, 100 eps cond) of the truth; estimates of cond are up to three times too small. If the
    // inputs of K and b are larger than K and b, the bounds include this. The condition is that of K x = b, x = [a; -f]
    // together; if contacts remove all motion, the remaining a is rounding of the motion without them.
    const double allowed = std::max({2 * std::max(1e-12, 300 * kEps * condition), bound_a, bound_f});
    if (!(allowed < kNoDigits)) return;
    double size = std::max({size_of(a), size_of(f), free_size(at)});
    check(mine.data.a(at.v), a, size, allowed, "accelerations", i);
    check(mine.data.f(at.f), f, size, allowed, "forces", i);
    if (schur) return;  // it does not refine
    if (!da.allFinite() || !df.allFinite()) return;
    // Their terms are as large as products of a, f and v.
    size = std::max({size, size_of(da), size_of(df), size_of(v_(at.v)) * size_of(v_(at.v))});
    check(mine.da(at.v), da, size, 10 * allowed, "derivatives of accelerations", i);
    // If rows depend on others at this configuration alone (an axis of the world and one of the body) forces have none.
    if (r.status == Status::kOk) check(mine.df(at.f), df, size, 10 * allowed, "derivatives of forces", i);
  }

  double free_size(const Places& at) const {
    const double size = size_of(a_free_(at.v));
    return std::isfinite(size) ? size : 0;
  }

  // Bounds are relative to the solutions, which differ by less than a hundredth of themselves.
  void check_bound(const std::string& what, const VectorXd& mine, const VectorXd& truth, double bound,
                   std::size_t i) const {
    const double size = std::max(size_of(mine), size_of(truth)), error = size_of(mine - truth);
    if (bound < kNoDigits && !(error <= bound * size))
      fail(what + " further apart than their error bounds", i, error / size, bound);
  }

  void check(const VectorXd& mine, const VectorXd& truth, double size, double allowed, const char* what,
             std::size_t i) const {
    const double error = size_of(mine - truth);
    if (!(error <= allowed * size)) fail(std::string("wrong ") + what, i, error / size, allowed);
  }

  // jvp is J d and vjp J^T w, with J from differentiate, up to the rounding of the solves in each.
  void check_products(Answer& mine) const {
    const Report &report = mine.data.report, &truth = oracle_.data.report;
    if (std::max(report.status, truth.status) > Status::kRedundant || !mine.da.allFinite() || !mine.df.allFinite())
      return;
    // Matrices are computed in joint space by every method: the reference's condition and bounds apply to them.
    const double allowed =
        20 * std::max({1e-12, 300 * kEps * std::max(report.condition, truth.condition), truth.error_acceleration,
                       truth.error_forces, report.error_acceleration, report.error_forces});
    if (!(allowed < kNoDigits)) return;
    VectorXd wq(scene_.nv), wv(scene_.nv), wu(scene_.nu);
    const VectorXd wa = VectorXd::Ones(scene_.nv), wf = VectorXd::Ones(mine.data.f.size());
    vjp(scene_, mine.data, wa, wf, wq, wv, wu);
    (void)differentiate(scene_, mine.data);
    const Eigen::MatrixXd J = sparse_derivatives(scene_, mine.data).toDense();
    const double size =
        std::max({J.cwiseAbs().sum(), size_of(mine.data.a), size_of(mine.data.f), size_of(v_) * size_of(v_)});
    if (!std::isfinite(size)) return;
    VectorXd d(J.cols()), w(J.rows()), Jd(J.rows()), JTw(J.cols());
    d << mine.dq, mine.dv, mine.du;
    w << wa, wf;
    Jd << mine.da, mine.df;
    JTw << wq, wv, wu;
    check(Jd, J * d, size, allowed, "jvp", 0);
    check(JTw, J.transpose() * w, size, allowed, "vjp", 0);
  }

  const Scene& scene_;
  const VectorXd &q_, &v_, &u_;
  Answer oracle_;
  VectorXd a_free_;
  std::vector<Island> islands_;
  std::string way_;
};

}  // namespace

void check_answers(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u) {
  Judge judge(scene, q, v, u);
  for (const test::Way& way : test::ways_here()) judge.judge(way);
  judge.judge_memory({"auto", {}});
  judge.judge_memory({"sparse-bodies", {Method::kSparseBodies, {}}});
}

}  // namespace manycontact::fuzz
