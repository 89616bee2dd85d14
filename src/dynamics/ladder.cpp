// Ways of solving an island, from the one chosen down to the oracle.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "manycontact/contact/row_size.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "row_terms.hpp"
#include "steps.hpp"

namespace manycontact::internal {

namespace {

enum class Way { kChosen, kDependentRows, kDense };

struct Rung {
  Way way;
  Order order;
  double damping;
};

Factor& factor_of(IslandWork& d, Way way) {
  const auto made = [](std::unique_ptr<Factor>& factor, auto&& make) -> Factor& {
    if (!factor) factor = make();
    return *factor;
  };
  if (way == Way::kDependentRows) return made(d.safe, make_dependent_rows_factor);
  if (way == Way::kDense) return made(d.dense, make_dense_factor);
  return made(d.chosen, [&d] { return make_factor(d.choice.method, d.shape); });
}

// What the rows of the island's J are judged beside.
void row_sizes(const Scene& scene, const Workspace& w, const Island& island, std::vector<double>& size) {
  size.resize(island.nc);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    for (int i = 0; i < scene.contacts[c].rows(); ++i)
      size[island.row_offset[k] + i] = row_size(scene.contacts[c], w.contacts[c], i);
  }
}

// Whether a row of the island's J is nothing but rounding beside the contacts' motions: no pivot shows that.
bool has_vanishing_row(const Scene& scene, const IslandWork& d, const std::vector<double>& size) {
  for (std::size_t c = 0; c < d.J.size(); ++c) {
    const Eigen::Index rows = scene.contacts[d.island.contacts[c]].rows();
    const Eigen::Map<const Eigen::MatrixXd> J(d.J[c].data(), rows, static_cast<Eigen::Index>(d.J[c].size()) / rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double largest = J.cols() > 0 ? J.row(i).cwiseAbs().maxCoeff() : 0;
      if (!(largest > tolerance::kRank * size[d.island.row_offset[c] + i])) return true;
    }
  }
  return false;
}

// The largest term that the contacts' a0 are computed from. Of the bodies' velocities and accelerations as the tree has
// them, about its base: at the contact they may cancel.
double drift_size(const Scene& scene, const Workspace& w, const Island& island) {
  double largest = 0;
  const auto moving = [&](const Attachment& at) {
    if (at.robot < 0 || at.joint < 0) return;
    const Kinematics<double>& kin = w.robots[at.robot].kin;
    const double v = kin.v[at.joint].cwiseAbs().maxCoeff();
    largest = std::max({largest, kin.a[at.joint].cwiseAbs().maxCoeff(), v * v});
  };
  for (int c : island.contacts) {
    moving(scene.contacts[c].A), moving(scene.contacts[c].B);
    // A place in the world that was left out, or computed, is as good as its own digits, however far away it is.
    const Contact& contact = scene.contacts[c];
    const double far = contact.B.robot < 0 ? contact.B.placement.p.cwiseAbs().maxCoeff() : 0;
    largest = std::max({largest, row_terms(scene, w, c), std::abs(contact.alpha) * far});
  }
  return largest;
}

// |P b1| > 1e-8 (| |J| |a| + |a0|), maximum norms, P the projector on the null space of J^T: what dependent rows cannot
// agree on, which is all that exact arithmetic leaves of J a + a0. (What rounding leaves there beside it was judged as
// a residual.) It may still be rounding of the terms of drift_size: that is no contradiction.
// Derivatives take note of what is left above rounding alone (of_rows: kDriftRounding, too).
bool contradictory(const KktPattern& p, const KktVectors& v, double drift, double of_rows) {
  double left = 0, Ja = 0, a0 = 0;
  for (int k = p.nv; k < p.size(); ++k) {
    const int at = p.iperm[k];
    left = sparse::larger_or_nan(left, std::abs(v.null_part[at]));
    Ja = std::max(Ja, v.scale[at] - std::abs(v.b[at]));
    a0 = std::max(a0, std::abs(v.b[at]));
  }
  return !(left <= of_rows * (Ja + a0)) && !(left <= tolerance::kDriftRounding * drift);
}

// report.dependent_rows, numbered as data.f has them.
void name_dependent_rows(const SceneData& data, IslandWork& d, IslandReport& report) {
  d.factor->dependent_rows(d.dependent);
  report.dependent_rows.clear();
  for (int row : d.dependent) {
    const auto c =
        std::upper_bound(d.island.row_offset.begin(), d.island.row_offset.end(), row) - d.island.row_offset.begin() - 1;
    report.dependent_rows.push_back(data.f_offset[d.island.contacts[c]] + row - d.island.row_offset[c]);
  }
  std::sort(report.dependent_rows.begin(), report.dependent_rows.end());
}

bool all_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y); });
}

// One rung: factorizes the system in its order and solves it with refinement. kNone: the answer is sound, and the
// report is whole.
Reason attempt(const Scene& scene, const SceneData& data, FactorScratch& scratch, const Rung& rung, IslandWork& d,
               IslandReport& report) {
  assemble_island(scene, data, rung.order, rung.damping, d);
  Factor& factor = factor_of(d, rung.way);
  report.method = factor.method();
  report.order = rung.order;
  row_sizes(scene, *data.workspace, d.island, scratch.row_size);
  if (rung.way == Way::kChosen && rung.damping == 0 && has_vanishing_row(scene, d, scratch.row_size))
    return Reason::kSmallPivot;
  ++d.factorizations;
  if (const Reason reason = factor.factorize(d.K, scratch); reason != Reason::kNone) return reason;
  const int own = factor.own_refinements();
  const sparse::Refinement refinement = solve_refined(factor, d.K, d.v, own > 0 ? 0 : tolerance::kRefinementSteps);
  report.factor_nonzeros = factor.nonzeros();
  report.refinement_steps = own + refinement.steps;
  if (!all_finite(d.v.x))
    return all_finite(d.K.values) && all_finite(d.v.b) ? Reason::kLargeResidual : Reason::kNotFinite;
  // the oracle's answer is the best there is
  const double most = rung.way == Way::kDense ? std::numeric_limits<double>::max() : tolerance::kConverged;
  if (!(refinement.backward_error <= most)) return Reason::kLargeResidual;

  d.factor = &factor;
  d.first_error = refinement.first;
  d.last_error = refinement.backward_error;
  report.rank = factor.rank();
  report.status = Status::kOk;
  d.contradiction = false;
  if (rank_deficient(d)) {
    const double drift = drift_size(scene, *data.workspace, d.island);
    d.contradiction = contradictory(*d.K.pattern, d.v, drift, tolerance::kDriftRounding);
    const bool told = contradictory(*d.K.pattern, d.v, drift, tolerance::kContradiction);
    report.status = told ? Status::kInconsistent : Status::kRedundant;
    name_dependent_rows(data, d, report);
  }
  return Reason::kNone;
}

// From the chosen way down: leaf-to-root, dropping rows that depend on others, or where damping makes K regular in
// every order by the same method; the oracle.
struct Rungs {
  std::array<Rung, 3> list;
  int count = 0;
  void add(const Rung& rung) { list[count++] = rung; }
};
Rungs rungs_of(const IslandWork& d, double damping) {
  Rungs rungs;
  const auto [method, order] = d.choice;
  if (method != Method::kDense) rungs.add({Way::kChosen, order, damping});
  if (method == Method::kDenseSchur) return rungs;  // the baseline stands alone
  if (method != Method::kDense && damping == 0) rungs.add({Way::kDependentRows, Order::kLeafToRoot, 0});
  if (has_order(method) && damping > 0 && order != Order::kLeafToRoot)
    rungs.add({Way::kChosen, Order::kLeafToRoot, damping});
  rungs.add({Way::kDense, order, damping});
  return rungs;
}

}  // namespace

void forget_states(SceneData& data) {
  for (const auto& island : data.workspace->islands) island->was_dependent = false;
}

bool still_dependent(const Scene& scene, const SceneData& data, FactorScratch& scratch, IslandWork& d,
                     IslandReport& report) {
  const Rung safe{Way::kDependentRows, Order::kLeafToRoot, 0};
  d.was_dependent =
      scene.damping == 0 && attempt(scene, data, scratch, safe, d, report) == Reason::kNone && rank_deficient(d);
  if (!d.was_dependent) {
    d.factor = nullptr;
    report.status = Status::kOk;
    return false;
  }
  report.changed_order = d.choice.order != safe.order;
  report.reason = Reason::kSmallPivot;
  return true;
}

bool climb_ladder(const Scene& scene, const SceneData& data, FactorScratch& scratch, IslandWork& d,
                  IslandReport& report) {
  const auto [method, order] = d.choice;
  const Rungs rungs = rungs_of(d, scene.damping);
  Reason first = Reason::kNone, last = Reason::kNone;
  for (int k = 0; k < rungs.count; ++k) {
    const Rung& rung = rungs.list[k];
    last = attempt(scene, data, scratch, rung, d, report);
    if (last != Reason::kNone) {
      if (k == 0) first = last;
      continue;
    }
    report.reason = first;
    report.changed_order = rung.way != Way::kDense && rung.order != order;
    d.was_dependent = rung.way == Way::kDependentRows && rank_deficient(d);
    if (d.was_dependent) report.reason = Reason::kSmallPivot;
    return true;
  }
  report.reason = last;
  if (last != Reason::kSmallPivot || scene.damping == 0 || method == Method::kDenseSchur) return false;
  // A damping below the rounding of K: the answer without it, as a neighbouring problem's.
  if (attempt(scene, data, scratch, {Way::kDependentRows, Order::kLeafToRoot, 0}, d, report) != Reason::kNone)
    return false;
  report.status = Status::kRegularised;
  report.reason = Reason::kDampingLost;
  return true;
}

bool climb_again(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  const bool was_dependent = d.was_dependent;
  const bool answered = climb_ladder(scene, data, thread.scratch, d, thread.spare_report);
  d.was_dependent = was_dependent;
  return answered;
}

bool climb_to_oracle(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  constexpr int kLargest = 3000;  // rows of K: seconds of a decomposition
  if (d.factor == d.dense.get() || d.choice.method == Method::kDenseSchur || d.island.size() > kLargest) return false;
  const Rung oracle{Way::kDense, d.choice.order, scene.damping};
  if (attempt(scene, data, thread.scratch, oracle, d, thread.spare_report) == Reason::kNone) return true;
  factorize_again(scene, data, d, thread);
  return false;
}

void factorize_again(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread) {
  if (!climb_again(scene, data, d, thread)) d.factor = nullptr;
}

}  // namespace manycontact::internal
