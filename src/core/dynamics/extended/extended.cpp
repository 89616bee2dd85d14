#include "extended.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../internal.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/rank/row_units.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "simd/levels.hpp"

namespace manycontact {

ExtendedWork::ExtendedWork(const Scene& scene) : equations(simd::levels().front().equations.make(scene)) {
  for (Eigen::VectorXd* x : {&a, &r_a}) x->setZero(scene.nv);
  Eigen::Index rows = 0;
  for (const Contact& contact : scene.contacts) rows += contact.rows();
  for (Eigen::VectorXd* x : {&f, &r, &weights, &rest}) x->setZero(rows);
  damping.resize(scene.contacts.size());
}

namespace internal {

namespace {

using tolerance::kExtendedConverged, tolerance::kExtendedVanishing, tolerance::kExtendedSlow;

using OfIsland = ExtendedWork::OfIsland;

// Whether the double solution may be refined, i.e. solves with J unchanged and, if damped, without dropped rows.
bool may_refine(const Scene& scene, const IslandWork& d, const IslandReport& report) {
  if (!d.answered || (d.matrix.tolerated > 0 && !d.matrix.within.changes().empty())) return false;
  if (scene.damping > 0 && report.rank < report.nc && report.reason != Reason::kDampingLost) return false;
  if (report.status == Status::kRegularised)
    return report.reason == Reason::kUncertain || report.reason == Reason::kDampingLost;
  return report.status <= Status::kInconsistent;
}

void take_part(const SceneData& data, ExtendedWork& e) {
  e.robots.clear();
  e.contacts.clear();
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    if (!e.islands[i].open) continue;
    const Island& island = solved_island(data, i);
    e.robots.insert(e.robots.end(), island.robots.begin(), island.robots.end());
    e.contacts.insert(e.contacts.end(), island.contacts.begin(), island.contacts.end());
  }
}
extended::Part part_of(const ExtendedWork& e) { return {e.robots, e.contacts}; }

// Calls use(contact, row of the contact, row of f) for all contact rows of the open islands (OfIsland::open).
template <class Use>
void each_row(const Scene& scene, const SceneData& data, const ExtendedWork& e, const Use& use) {
  for (int c : e.contacts)
    for (int i = 0, k = data.f_offset[c]; i < scene.contacts[c].rows(); ++i, ++k)
      use(static_cast<std::size_t>(c), i, k);
}

double largest(const Scene& scene, const Island& island, const Eigen::VectorXd& a) {
  double out = 0;
  each_velocity_block(scene, island, [&](int first, int, int n) {
    for (int i = 0; i < n; ++i) out = sparse::larger_or_nan(out, std::abs(a[first + i]));
  });
  return out;
}
// Overwrites [a; y] of Workspace::products with K^+ [a; y] in the open islands; NaN if an island's system fails.
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

// Overwrites the residuals e.r_a (dynamics), e.r (contact rows) of the open islands with the correction [da; df].
void invert(const Scene& scene, SceneData& data, ExtendedWork& e) {
  SceneData& solved = data.workspace->reduction ? *data.workspace->reduction->data : data;
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
    const bool damped = scene.damping > 0;  // contacts of a pair then also have forces in J^T's null space
    if (damped) {
      expand_forces(data, x.y.data(), e.rest.data());
      each_row(scene, data, e, [&](std::size_t c, int, int k) {
        e.rest[k] = e.damping[c] > 0 ? (e.r[k] - e.rest[k]) / e.damping[c] : 0;
      });
    }
    invert_islands(of, solved, e);
    expand_forces(data, x.y.data(), e.r.data());
    e.r.head(rows) *= -1;
    if (damped) e.r.head(rows) += e.rest.head(rows);
  }
  e.r_a = x.a;
}

double relative(double change, double size, double vanishing) {
  return change <= vanishing ? 0 : size > 0 ? change / size : 1;
}

// Returns the largest relative change, by the current correction, of a robot's accelerations or a contact's forces.
double change_of_parts(const Scene& scene, const SceneData& data, const ExtendedWork& e, const Island& island,
                       const OfIsland& of) {
  double out = 0;
  each_velocity_block(scene, island, [&](int at, int, int n) {
    if (n > 0)
      out = std::max(out, relative(e.r_a.segment(at, n).cwiseAbs().maxCoeff(), e.a.segment(at, n).cwiseAbs().maxCoeff(),
                                   kExtendedVanishing * of.at_rest_a));
  });
  each_force_block(scene, data.f_offset, island, [&](int at, int, int n) {
    out = std::max(out, relative(e.r.segment(at, n).cwiseAbs().maxCoeff(), e.f.segment(at, n).cwiseAbs().maxCoeff(),
                                 kExtendedVanishing * of.at_rest_f));
  });
  return out;
}

enum class Progress { kGoesOn, kConverged, kFailed };  // state of a refinement, judged before a correction is added
Progress judge(const Scene& scene, const SceneData& data, const ExtendedWork& e, std::size_t i, OfIsland& of) {
  const Island& island = solved_island(data, i);
  const double da = largest(scene, island, e.r_a), df = largest_force(scene, data.f_offset, island, e.r);
  const double a = largest(scene, island, e.a), f = largest_force(scene, data.f_offset, island, e.f);
  if (!std::isfinite(da) || !std::isfinite(df)) return Progress::kFailed;
  of.last_a = da, of.last_f = df;
  const double now =
      std::max(relative(da, a, kExtendedVanishing * of.at_rest_a), relative(df, f, kExtendedVanishing * of.at_rest_f));
  const bool slow = of.steps > 1 && now > kExtendedSlow * of.before;
  if (change_of_parts(scene, data, e, island, of) <= kExtendedConverged) return Progress::kConverged;
  if (slow)
    return relative(da, a, tolerance::kExtendedStoppedVanishing * of.at_rest_a) <= tolerance::kExtendedStopped &&
                   relative(df, f, tolerance::kExtendedStoppedVanishing * of.at_rest_f) <= tolerance::kExtendedStopped
               ? Progress::kConverged
               : Progress::kFailed;
  of.before = now;
  return ++of.steps < tolerance::kExtendedSteps ? Progress::kGoesOn : Progress::kFailed;
}

void refuse(OfIsland& of) { of.open = of.refined = false; }

bool any_open(const ExtendedWork& e) {
  return std::ranges::any_of(e.islands, [](const OfIsland& of) { return of.open; });
}

void open_all(const SceneData& data, ExtendedWork& e) {
  for (OfIsland& of : e.islands) of.open = of.refined;
  take_part(data, e);
}

// Adds corrections to x until x converges or fails to, in each island that may be refined.
void correct(const Scene& scene, SceneData& data, ExtendedWork& e) {
  extended::Equations& equations = *e.equations;
  for (open_all(data, e); any_open(e); take_part(data, e)) {
    equations.residual(part_of(e), e.r_a.data(), e.r.data());
    equations.round(part_of(e), e.a.data(), e.f.data());
    invert(scene, data, e);
    for (std::size_t i = 0; i < e.islands.size(); ++i) {
      OfIsland& of = e.islands[i];
      if (!of.open) continue;
      const Progress progress = judge(scene, data, e, i, of);
      of.converged = progress == Progress::kConverged;
      if (progress == Progress::kFailed) refuse(of);
    }
    take_part(data, e);
    const bool goes_on = std::ranges::any_of(e.islands, [](const OfIsland& of) { return of.open && !of.converged; });
    equations.add(part_of(e), e.r_a.data(), e.r.data(), goes_on);
    for (OfIsland& of : e.islands) of.open = of.open && !of.converged;
  }
}

void take_weights(const Scene& scene, const SceneData& data, ExtendedWork& e) {
  each_row(scene, data, e, [&](std::size_t c, int i, int k) { e.weights[k] = row_unit(scene, scene.contacts[c], i); });
}

void take_any_forces(Eigen::VectorXd& f) {  // pseudo-random numbers in [-1, 1) (Knuth's linear congruential generator)
  std::uint64_t state = 1;
  for (double& x : f) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    x = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
}

// Repeats `step` while islands are open. judge(island, its data, number of steps) finds those that converge or fail.
template <class Judge, class Step>
void repeat(const SceneData& data, ExtendedWork& e, const Judge& judge, const Step& step) {
  for (int k = 0; any_open(e); ++k) {
    for (std::size_t i = 0; i < e.islands.size(); ++i) {
      OfIsland& of = e.islands[i];
      if (!of.open) continue;
      const Progress progress = k < tolerance::kExtendedSteps ? judge(i, of, k) : Progress::kFailed;
      if (progress == Progress::kConverged) of.open = false;
      if (progress == Progress::kFailed) refuse(of);
    }
    take_part(data, e);
    if (any_open(e)) step();
  }
}

// Excludes from refinement the open islands whose J has another rank in double-double. In the other islands,
// corrections by K^+ make J^T n vanish for a vector n of row forces that starts random.
void refuse_unless_dependent(const Scene& scene, SceneData& data, ExtendedWork& e) {
  take_any_forces(e.rest);
  e.equations->set_rest(part_of(e), e.rest.data());
  repeat(
      data, e,
      [&](std::size_t i, OfIsland& of, int step) {
        const Island& island = solved_island(data, i);
        const double left = e.equations->torque_of_rest({island.robots, island.contacts}, e.r_a.data());
        if (left <= tolerance::kExtendedDependent) return Progress::kConverged;
        if (!std::isfinite(left) || (step > 1 && left >= kExtendedSlow * of.before)) return Progress::kFailed;
        of.before = left;
        return Progress::kGoesOn;
      },
      [&] {
        e.r.setZero();
        invert(scene, data, e);
        e.equations->add_to_rest(part_of(e), e.r.data());
      });
}

// Computes in e.r_a the step dy of a projection, J^T S^2 J dy = g, where the gradient g is computed in double-double.
// Solves J^T z = g for forces z, then S^2 J dy = z. A step from `rest` itself would be accurate to double only.
void step_of_projection(const Scene& scene, SceneData& data, ExtendedWork& e) {
  e.equations->gradient_of_rest(part_of(e), e.r_a.data());
  e.r.setZero();
  invert(scene, data, e);
  each_row(scene, data, e, [&](std::size_t, int, int k) { e.r[k] /= -e.weights[k] * e.weights[k]; });
  e.r_a.setZero();
  invert(scene, data, e);
}

// Projects `rest` of the open islands by steps dy until a step changes no significant digit. These are digits of double
// for forces, and of double-double for least-squares residuals, as x may be small relative to the residuals.
void project(const Scene& scene, SceneData& data, extended::Equations::Projected what, ExtendedWork& e) {
  const bool forces = what == extended::Equations::Projected::kForces;
  e.equations->begin_projection(part_of(e), what, e.weights.data());
  if (!forces) e.equations->residual(part_of(e), e.r_a.data(), e.rest.data());
  repeat(
      data, e,
      [&](std::size_t i, OfIsland& of, int step) {
        const Island& island = solved_island(data, i);
        if (step == 0) of.rest = largest_force(scene, data.f_offset, island, forces ? e.f : e.rest);
        const double change = step == 0 ? of.rest : largest_force(scene, data.f_offset, island, e.rest);
        const double digits =
            forces ? std::max(kExtendedConverged * of.rest, kExtendedVanishing * of.at_rest_f)
                   : std::max(tolerance::kExtendedDigits * of.rest, tolerance::kExtendedDigitsVanishing * of.at_rest_a);
        if (change <= digits && (step > 0 || change == 0)) {
          if (forces) of.last_f = std::max(of.last_f, change);
          return Progress::kConverged;
        }
        if (!std::isfinite(change)) return Progress::kFailed;
        if (step > 2 && change > kExtendedSlow * of.before)
          return !forces && change <= tolerance::kExtendedDigitsStopped * of.rest ? Progress::kConverged
                                                                                  : Progress::kFailed;
        of.before = change;
        return Progress::kGoesOn;
      },
      [&] {
        step_of_projection(scene, data, e);
        e.equations->project(part_of(e), e.r_a.data(), e.rest.data());
      });
}

bool open_dependent(const SceneData& data, ExtendedWork& e) {  // opens islands with redundant rows; false if none
  for (OfIsland& of : e.islands) of.open = of.refined && of.projects;
  take_part(data, e);
  return any_open(e);
}

void take_projection(const Scene& scene, SceneData& data, extended::Equations::Projected what, ExtendedWork& e) {
  if (!open_dependent(data, e)) return;
  project(scene, data, what, e);
  if (open_dependent(data, e)) e.equations->take_rest(part_of(e));
}

// Excludes from refinement islands whose rows depend only up to rounding: in double-double J has another rank.
void take_dependence(const Scene& scene, SceneData& data, ExtendedWork& e) {
  if (!open_dependent(data, e)) return;
  take_weights(scene, data, e);
  refuse_unless_dependent(scene, data, e);
}

void begin(const Scene& scene, const SceneData& data, ExtendedWork& e) {
  const Reduction* reduction = data.workspace->reduction;
  e.islands.assign(island_count(data), {});
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    const IslandReport& report = data.report.islands[i];
    OfIsland& of = e.islands[i];
    of.refined = may_refine(scene, *data_solved(data).workspace->islands[i], report);
    if (!of.refined) continue;
    of.status = report.status, of.reason = report.reason;
    if (report.reason == Reason::kUncertain) {  // set by error bounds of an earlier call
      of.status = report.rank < report.nc ? Status::kRedundant : Status::kOk;
      of.reason = Reason::kNone;
    }
    const Island& island = solved_island(data, i);
    const double damping = report.reason == Reason::kDampingLost ? 0 : scene.damping;
    for (int c : island.contacts) e.damping[c] = damping;
    of.projects = damping == 0 && (report.rank < report.nc || (reduction && has_pairs(*reduction, i)));
    of.size_a = largest(scene, island, data.a);
    of.size_f = largest_force(scene, data.f_offset, island, data.f);
    of.at_rest_a = std::max(scene.gravity.norm(), report.contact_terms);
    each_velocity_block(scene, island, [&](int first, int, int n) {
      for (int k = 0; k < n; ++k) of.at_rest_f = std::max(of.at_rest_f, std::abs(data.tau[first + k]));
    });
    for (int r : island.robots)
      for (const Joint& joint : scene.robots[r].model->joints)
        of.at_rest_f = std::max(of.at_rest_f, scene.gravity.norm() * joint.inertia.m);
  }
}

// Computes in `e` the refined x of the current solution. The solution itself does not change.
void refine(const Scene& scene, SceneData& data, ExtendedWork& e) {
  const Workspace& w = *data.workspace;
  e.state = 0;
  begin(scene, data, e);
  open_all(data, e);
  const extended::Job job{scene,
                          w.q.data(),
                          data.v.data(),
                          w.given.data(),
                          data.wrenches,
                          forces_are_applied(*data_solved(data).workspace),
                          w.prescribed.empty() ? nullptr : w.prescribed.data(),
                          e.damping.data(),
                          data.f_offset};
  e.equations->begin(job, part_of(e), data.a.data(), data.f.data());
  take_dependence(scene, data, e);
  take_projection(scene, data, extended::Equations::Projected::kResidual, e);  // the least-squares residual
  correct(scene, data, e);
  take_projection(scene, data, extended::Equations::Projected::kForces, e);  // least-norm forces
  open_all(data, e);
  e.equations->round(part_of(e), e.a.data(), e.f.data());
  e.state = w.current;
}

ExtendedWork& work_of(const Scene& scene, Workspace& w) {
  if (!w.extended) w.extended = std::make_unique<ExtendedWork>(scene);
  return *w.extended;
}

void take_answers(const Scene& scene, SceneData& data, ExtendedWork& e) {
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    const OfIsland& of = e.islands[i];
    IslandReport& report = data.report.islands[i];
    report.precision = of.refined ? Precision::kExtended : Precision::kDouble;
    if (!of.refined) {
      if (report.status < Status::kRegularised) report.reason = Reason::kLowPrecision;
      continue;
    }
    const Island& island = solved_island(data, i);
    each_velocity_block(scene, island, [&](int at, int, int n) { data.a.segment(at, n) = e.a.segment(at, n); });
    each_force_block(scene, data.f_offset, island,
                     [&](int at, int, int n) { data.f.segment(at, n) = e.f.segment(at, n); });
    report.refinement_steps += of.steps;
    report.status = of.status, report.reason = of.reason;
  }
}

constexpr double kJustAbove = 1 + 0x1p-20;  // factor of bounds: covers a distance's rounding, makes 1 exceed 1

// Sizes from which the error bound of an island's a or f is computed. size: largest entry of the reported solution;
// size_before: that of the solution in double; by_inverse: relative bound by |K^-1|; distance: from the solution to its
// refined copy; last: the copy's last correction; at_rest: size that the loads may cause.
struct Distance {
  double size, size_before, by_inverse;
  double distance, last, at_rest;
  bool extended;  // whether the solution has the precision `extended`
  // Bounds the error by the distance to the refined copy plus the copy's error: a multiple of the last correction, and
  // a share of the bound by |K^-1|. min() covers values that underflow, whose second double is zero.
  double error() const {
    const double share = extended ? tolerance::kExtendedShare : tolerance::kReadShare;
    return kJustAbove * distance + 64 * last +
           (tolerance::kReadRounding + share * by_inverse) * std::max(size, size_before) +
           std::numeric_limits<double>::min();
  }
  bool is_known(double error) const { return error < std::max(size, at_rest); }
  // Whether all digits of the double solution are rounding errors, but it is small relative to what loads may cause.
  bool vanishes() const { return by_inverse >= 1 && is_known(by_inverse * size); }
};

double relative_bound(const Distance& of) {
  if (of.by_inverse == 0) return 0;
  const double bound = of.error() / of.size;
  if (!std::isfinite(bound)) return of.by_inverse;
  return !of.extended && of.vanishes() ? std::max(bound, kJustAbove) : bound;
}

}  // namespace

void refine_extended(const Scene& scene, SceneData& data) {
  ExtendedWork& e = work_of(scene, *data.workspace);
  refine(scene, data, e);
  take_answers(scene, data, e);
}

void refine_for_bounds(const Scene& scene, SceneData& data) {
  ExtendedWork& e = work_of(scene, *data.workspace);
  if (e.state != data.workspace->current) refine(scene, data, e);
}

void take_extended_bounds(const Scene& scene, SceneData& data) {
  ExtendedWork& e = *data.workspace->extended;
  open_all(data, e);
  e.equations->difference(part_of(e), data.a.data(), data.f.data(), e.r_a.data(), e.r.data());
  for (std::size_t i = 0; i < e.islands.size(); ++i) {
    const OfIsland& of = e.islands[i];
    if (!of.refined) continue;
    IslandReport& report = data.report.islands[i];
    const Island& island = solved_island(data, i);
    const bool extended = report.precision == Precision::kExtended;
    const auto of_a = [&](const Eigen::VectorXd& x) { return largest(scene, island, x); };
    const auto of_f = [&](const Eigen::VectorXd& x) { return largest_force(scene, data.f_offset, island, x); };
    const Distance a{of_a(data.a), of.size_a, report.error_acceleration, of_a(e.r_a), of.last_a,
                     of.at_rest_a, extended};
    const Distance f{of_f(data.f), of.size_f, report.error_forces, of_f(e.r), of.last_f, of.at_rest_f, extended};
    report.error_acceleration = relative_bound(a), report.error_forces = relative_bound(f);
    if (a.is_known(a.error()) && f.is_known(f.error())) report.status = of.status, report.reason = of.reason;
  }
}

}  // namespace internal

}  // namespace manycontact
