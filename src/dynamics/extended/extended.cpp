#include "extended.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../internal.hpp"
#include "manycontact/rank/row_units.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

ExtendedWork::ExtendedWork(const Scene& scene) : equations(extended::level_here().make(scene)) {
  for (Eigen::VectorXd* x : {&tau, &a, &r_a}) x->setZero(scene.nv);
  Eigen::Index rows = 0;
  for (const Contact& contact : scene.contacts) rows += contact.rows();
  for (Eigen::VectorXd* x : {&f, &r, &weights, &rest}) x->setZero(rows);
}

namespace internal {

namespace {

constexpr int kMostSteps = 60;          // up to a condition where a step gains half a digit
constexpr double kConverged = 0x1p-56;  // the last correction, relative to a and f: an eighth of rounding
constexpr double kConvergedAtLast =
    0x1p-52;                            // and where rounding in double-double stops it: at the edge of what it can
constexpr double kSlow = 0.8;           // a correction of more than so much of the one before ends refinement
constexpr double kVanishing = 0x1p-80;  // beside what acts: changes of a and f below are none
constexpr double kVanishingAtLast = 0x1p-60;  // and where rounding in double-double stops refinement
constexpr double kDependent = 0x1p-75;        // |J^T n| of null vectors of rows that depend exactly

using OfIsland = ExtendedWork::OfIsland;

// The islands of the answer, with contacts of the scene, and what solved them.
const Island& island_at(const SceneData& data, std::size_t i) {
  const Workspace& w = *data.workspace;
  return w.reduction ? w.reduction->islands[i] : w.islands[i]->island;
}
std::size_t island_count_of(const SceneData& data) {
  const Workspace& w = *data.workspace;
  return w.reduction ? w.reduction->islands.size() : w.islands.size();
}
SceneData& solved_data(SceneData& data) { return data.workspace->reduction ? *data.workspace->reduction->data : data; }

bool has_pairs(const SceneData& data, std::size_t i) {
  const Reduction* r = data.workspace->reduction;
  return r && r->islands[i].contacts.size() != r->data->workspace->islands[i]->island.contacts.size();
}

// Whether the double answer is one of this scene's equations.
bool may_refine(const IslandWork& d, const IslandReport& report) {
  if (!d.answered || d.matrix.tolerated > 0) return false;
  if (report.status == Status::kRegularised) return report.reason == Reason::kUncertain;
  return report.status == Status::kOk || report.status == Status::kRedundant;
}

void take_part(const SceneData& data, ExtendedWork& e) {
  e.robots.clear();
  e.contacts.clear();
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    if (!e.islands[i].open) continue;
    const Island& island = island_at(data, i);
    e.robots.insert(e.robots.end(), island.robots.begin(), island.robots.end());
    e.contacts.insert(e.contacts.end(), island.contacts.begin(), island.contacts.end());
  }
}
extended::Part part_of(const ExtendedWork& e) { return {e.robots, e.contacts}; }

double largest(const Scene& scene, const Island& island, const Eigen::VectorXd& a) {
  double out = 0;
  each_velocity_block(scene, island, [&](int first, int, int n) {
    for (int i = 0; i < n; ++i) out = sparse::larger_or_nan(out, std::abs(a[first + i]));
  });
  return out;
}
// [a; y] <- K^+ [a; y] of the scratch of products, of the open islands. NaN where an island's system cannot tell.
void invert_islands(const Scene& scene, SceneData& data, const ExtendedWork& e) {
  Workspace& w = *data.workspace;
  ProductWork& x = *w.products;
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    if (!e.islands[i].open) continue;
    IslandWork& d = *w.islands[i];
    if (!ask(scene, data, d, w.threads.front(),
             [&](IslandSystem& system) { return system.invert(scene, data, w.threads.front(), x); }))
      each_velocity_block(scene, d.island, [&](int at, int, int n) {
        x.a.segment(at, n).setConstant(std::numeric_limits<double>::quiet_NaN());
      });
  }
}

// The step [da; df] of the open islands for residuals e.r_a, e.r, which it overwrites.
void invert(const Scene& scene, SceneData& data, ExtendedWork& e) {
  SceneData& solved = solved_data(data);
  const Scene& of = &solved == &data ? scene : data.workspace->reduction->scene;
  ProductWork& x = products_of(of, *solved.workspace);
  const Eigen::Index rows = data.f.size();
  x.a = e.r_a;
  if (&solved == &data) {
    x.y.head(rows) = e.r.head(rows);
    invert_islands(of, solved, e);
    e.r.head(rows) = -x.y.head(rows);
  } else {
    reduce_forces(data, e.r.data(), x.y.data());
    if (scene.damping > 0) {  // the damping alone bears what the pairs' contacts contradict each other by
      expand_forces(data, x.y.data(), e.rest.data());
      e.rest.head(rows) = (e.r.head(rows) - e.rest.head(rows)) / scene.damping;
    }
    invert_islands(of, solved, e);
    expand_forces(data, x.y.data(), e.r.data());
    e.r.head(rows) *= -1;
    if (scene.damping > 0) e.r.head(rows) += e.rest.head(rows);
  }
  e.r_a = x.a;
}

double relative(double change, double size, double vanishing) {
  return change <= vanishing ? 0 : size > 0 ? change / size : 1;
}

// The largest change of a robot's accelerations, or of a contact's forces, relative to these.
double change_of_parts(const Scene& scene, const SceneData& data, const ExtendedWork& e, const Island& island,
                       const OfIsland& of) {
  double out = 0;
  each_velocity_block(scene, island, [&](int at, int, int n) {
    if (n > 0)
      out = std::max(out, relative(e.r_a.segment(at, n).cwiseAbs().maxCoeff(), e.a.segment(at, n).cwiseAbs().maxCoeff(),
                                   kVanishing * of.at_rest_a));
  });
  each_force_block(scene, data.f_offset, island, [&](int at, int, int n) {
    out = std::max(out, relative(e.r.segment(at, n).cwiseAbs().maxCoeff(), e.f.segment(at, n).cwiseAbs().maxCoeff(),
                                 kVanishing * of.at_rest_f));
  });
  return out;
}

// Whether an island has converged or cannot, by the correction at hand, which is yet to be added.
enum class Progress { kGoesOn, kConverged, kFailed };
Progress judge(const Scene& scene, const SceneData& data, const ExtendedWork& e, std::size_t i, OfIsland& of) {
  const Island& island = island_at(data, i);
  const double da = largest(scene, island, e.r_a), df = largest_force(scene, data.f_offset, island, e.r);
  const double a = largest(scene, island, e.a), f = largest_force(scene, data.f_offset, island, e.f);
  if (!std::isfinite(da) || !std::isfinite(df)) return Progress::kFailed;
  of.last_a = da == 0 ? 0 : da / std::max(a, std::numeric_limits<double>::min());
  of.last_f = df == 0 ? 0 : df / std::max(f, std::numeric_limits<double>::min());
  of.now = std::max(relative(da, a, kVanishing * of.at_rest_a), relative(df, f, kVanishing * of.at_rest_f));
  const bool slow = of.steps > 1 && of.now > kSlow * of.before;
  if (change_of_parts(scene, data, e, island, of) <= kConverged) return Progress::kConverged;
  if (slow)
    return relative(da, a, kVanishingAtLast * of.at_rest_a) <= kConvergedAtLast &&
                   relative(df, f, kVanishingAtLast * of.at_rest_f) <= kConvergedAtLast
               ? Progress::kConverged
               : Progress::kFailed;
  of.before = of.now;
  return ++of.steps < kMostSteps ? Progress::kGoesOn : Progress::kFailed;
}

void refuse(OfIsland& of, IslandReport& report) {
  of.open = of.refined = false;
  if (report.status != Status::kRegularised) report.reason = Reason::kLowPrecision;  // that has a reason to keep
}

bool any_open(const ExtendedWork& e) {
  return std::ranges::any_of(e.islands, [](const OfIsland& of) { return of.open; });
}

// x of the open islands, until it does not change: those stay in e.islands as `refined`.
void correct(const Scene& scene, SceneData& data, ExtendedWork& e) {
  extended::Equations& equations = *e.equations;
  while (any_open(e)) {
    take_part(data, e);
    equations.residual(part_of(e), e.r_a.data(), e.r.data());
    equations.round(part_of(e), e.a.data(), e.f.data());
    invert(scene, data, e);
    bool closed = false;
    for (std::size_t i = 0; i < e.islands.size(); ++i) {
      OfIsland& of = e.islands[i];
      if (!of.open) continue;
      const Progress progress = judge(scene, data, e, i, of);
      of.refined = progress == Progress::kConverged;
      if (progress == Progress::kFailed) refuse(of, data.report.islands[i]);
      closed = closed || of.refined;
    }
    take_part(data, e);
    const bool residual = std::ranges::any_of(e.islands, [](const OfIsland& of) {
      return of.open && (of.projects || !of.refined);  // what contradicting rows leave is asked for later
    });
    equations.add(part_of(e), e.r_a.data(), e.r.data(), residual);
    if (!closed) continue;
    for (OfIsland& of : e.islands) of.open = of.open && !of.refined;
  }
}

// The part n of x's forces f = n + S^2 J y that is none of the least norm: y by steps, until what is left of f does not
// change beside f. False: it does.
bool project(const Scene& scene, SceneData& data, const OfIsland& of, ExtendedWork& e) {
  const Eigen::Index rows = data.f.size();
  e.equations->begin_projection(part_of(e), e.weights.data(), nullptr);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    e.equations->rest(part_of(e), e.r.data());
    double change = 0, size = 0;
    for (int c : e.contacts)
      for (int k = data.f_offset[c]; k < data.f_offset[c] + scene.contacts[c].rows(); ++k) {
        size = std::max(size, std::abs(e.f[k]) / (e.weights[k] * e.weights[k]));
        change = sparse::larger_or_nan(change, step == 0 ? 0.0 : std::abs(e.r[k] - e.rest[k]));
      }
    if (step > 1 && change <= std::max(kConverged * size, kVanishing * of.at_rest_f)) return true;
    if (!std::isfinite(change) || (step > 2 && change > kSlow * before)) return false;
    before = step == 0 ? before : change;
    e.rest.head(rows) = e.r.head(rows);
    e.r_a.setZero();
    invert(scene, data, e);
    e.equations->project(part_of(e), e.r_a.data());
  }
  return false;
}

void take_weights(const Scene& scene, const SceneData& data, ExtendedWork& e) {
  for (int c : e.contacts)
    for (int i = 0; i < scene.contacts[static_cast<std::size_t>(c)].rows(); ++i)
      e.weights[data.f_offset[static_cast<std::size_t>(c)] + i] =
          row_unit(scene, scene.contacts[static_cast<std::size_t>(c)], i);
}

// Forces whose numbers have nothing to do with the contacts' (Knuth's linear congruential generator).
void take_any_forces(Eigen::VectorXd& f) {
  std::uint64_t state = 1;
  for (double& x : f) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    x = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
}

// Whether J^T n = 0 in double-double for forces n that double takes for one of J^T's null space: what is left of J^T n
// is taken from n by K^+ until nothing is, or what no forces of double's rank can take.
bool depend_exactly(const Scene& scene, SceneData& data, ExtendedWork& e) {
  take_any_forces(e.rest);
  e.equations->begin_projection(part_of(e), e.weights.data(), e.rest.data());
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    const double left = e.equations->torque_of_rest(part_of(e), e.r_a.data());
    if (left <= kDependent) return true;
    if (!(left < (step > 1 ? kSlow * before : std::numeric_limits<double>::infinity()))) return false;
    before = left;
    e.r.setZero();
    invert(scene, data, e);
    e.equations->add_to_rest(part_of(e), e.r.data());
  }
  return false;
}

// Forces of least norm where rows depend on each other. Those that do by rounding of the state alone have other forces,
// if any, than those of double's rank.
void take_least_norm(const Scene& scene, SceneData& data, ExtendedWork& e) {
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    OfIsland& of = e.islands[i];
    if (!of.projects || !of.refined) continue;
    for (OfIsland& other : e.islands) other.open = false;
    of.open = true;
    take_part(data, e);
    take_weights(scene, data, e);
    if (depend_exactly(scene, data, e) && project(scene, data, of, e))
      e.equations->take_rest(part_of(e));
    else
      refuse(of, data.report.islands[i]);
  }
}

void begin(const Scene& scene, SceneData& data, ExtendedWork& e) {
  const Workspace& solver = *solved_data(data).workspace;
  e.islands.assign(island_count_of(data), {});
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    IslandReport& report = data.report.islands[i];
    OfIsland& of = e.islands[i];
    report.precision = Precision::kDouble;
    if (report.status == Status::kFailed) continue;
    of.open = may_refine(*solver.islands[i], report);
    if (!of.open) {
      refuse(of, report);
      continue;
    }
    const Island& island = island_at(data, i);
    of.projects = scene.damping == 0 && (report.rank < report.nc || has_pairs(data, i));
    of.size_a = largest(scene, island, data.a);
    of.size_f = largest_force(scene, data.f_offset, island, data.f);
    of.at_rest_a = std::max(scene.gravity.norm(), report.contact_terms);
    each_velocity_block(scene, island, [&](int first, int, int n) {
      for (int k = 0; k < n; ++k) of.at_rest_f = std::max(of.at_rest_f, std::abs(data.tau[first + k]));
    });
    for (int r : island.robots)
      of.at_rest_f =
          std::max(of.at_rest_f,
                   scene.gravity.norm() * scene.robots[static_cast<std::size_t>(r)].model->joints.front().inertia.m);
  }
}

// What rows that depend on each other contradict each other by: all that x leaves of them.
void take_contradictions(const Scene& scene, SceneData& data, ExtendedWork& e) {
  for (OfIsland& of : e.islands) of.open = of.refined && of.projects;
  take_part(data, e);
  e.equations->residual(part_of(e), e.r_a.data(), e.r.data());
  for (std::size_t i = 0; i < e.islands.size(); ++i)
    if (const double terms = data.report.islands[i].contact_terms; e.islands[i].open && terms > 0)
      e.islands[i].contradiction = largest_force(scene, data.f_offset, island_at(data, i), e.r) / terms;
}

void take_answers(const Scene& scene, SceneData& data, ExtendedWork& e) {
  e.equations->round(part_of(e), e.a.data(), e.f.data());
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    if (!e.islands[i].refined) continue;
    const Island& island = island_at(data, i);
    each_velocity_block(scene, island, [&](int at, int, int n) { data.a.segment(at, n) = e.a.segment(at, n); });
    each_force_block(scene, data.f_offset, island,
                     [&](int at, int, int n) { data.f.segment(at, n) = e.f.segment(at, n); });
    IslandReport& report = data.report.islands[i];
    report.precision = Precision::kExtended;
    report.refinement_steps += e.islands[i].steps;
    if (report.status == Status::kRegularised) {
      report.status = report.rank < report.nc ? Status::kRedundant : Status::kOk;
      report.reason = Reason::kNone;
    }
    e.islands[i].status = report.status, e.islands[i].reason = report.reason;
  }
}

// A bound of a refined answer, relative to its largest entry `size`: its own rounding, the last correction, of which a
// part is left or which shows what double-double rounds, and the share of double-double in the bound of double's
// answer, relative to `size_before`.
double bound_of(double of_double, double size_before, double size, double last, double contradiction) {
  constexpr double kShare = 0x1p-46;  // 2^-104 / 2^-53, and 32 for the constants of sums and products
  if (of_double == 0) return 0;
  return 0x1p-53 + 64 * last + of_double * (size_before / size) * (kShare + contradiction);
}

}  // namespace

void keep_torques(const Scene& scene, SceneData& data, const double* tau) {
  Workspace& w = *data.workspace;
  if (!w.extended) w.extended = std::make_unique<ExtendedWork>(scene);
  std::copy_n(tau, scene.nv, w.extended->tau.data());
}

void take_extended_bounds(const Scene& scene, SceneData& data) {
  const ExtendedWork& e = *data.workspace->extended;
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    const OfIsland& of = e.islands[i];
    if (!of.refined) continue;
    IslandReport& report = data.report.islands[i];
    const Island& island = island_at(data, i);
    const double a =
        bound_of(report.error_acceleration, of.size_a, largest(scene, island, data.a), of.last_a, of.contradiction);
    const double f = bound_of(report.error_forces, of.size_f, largest_force(scene, data.f_offset, island, data.f),
                              of.last_f, of.contradiction);
    if (!std::isfinite(a) || !std::isfinite(f)) continue;
    report.error_acceleration = a, report.error_forces = f;
    report.status = of.status, report.reason = of.reason;
  }
}

void refine_extended(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  ExtendedWork& e = *w.extended;
  begin(scene, data, e);
  take_part(data, e);
  const extended::Job job{scene,
                          w.q.data(),
                          data.v.data(),
                          e.tau.data(),
                          data.pushes,
                          forces_are_applied(*solved_data(data).workspace),
                          w.prescribed.empty() ? nullptr : w.prescribed.data(),
                          data.f_offset};
  e.equations->begin(job, part_of(e), data.a.data(), data.f.data());
  correct(scene, data, e);
  take_least_norm(scene, data, e);
  take_contradictions(scene, data, e);
  take_answers(scene, data, e);
}

}  // namespace internal

}  // namespace manycontact
