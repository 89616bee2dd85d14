// Computes derivatives and error bounds of the scene from derivatives and error bounds of the reduced scene.

#include <algorithm>
#include <cmath>

#include "../internal.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "reduction.hpp"

namespace manycontact::internal {

namespace {

bool alike_gains(const PairRows& pair) {
  return std::all_of(pair.members.begin(), pair.members.end(), [&](const Contact& c) {
    return c.alpha == pair.members.front().alpha && c.beta == pair.members.front().beta;
  });
}

// Whether a pair's contacts have equal gains and its bodies move as one, up to rounding: their relative velocity is
// zero and so is, where alpha is not 0, their relative displacement. Consistent contacts then remain consistent.
bool moves_as_one(const Reduction& r, int c, const PairRows& pair) {
  const double* left = left_of(*r.data->workspace, c);
  return alike_gains(pair) && left[pair.unit.size() + 1] <= tolerance::kMovesAsOne;
}

int row_of(const Island& island, int contact) {
  const auto at = std::lower_bound(island.contacts.begin(), island.contacts.end(), contact) - island.contacts.begin();
  return island.row_offset[at];
}

// Computes the derivatives of f in an island's panel from those of the reduced scene's forces in its panel.
template <class From, class To>
void expand_rows(const Reduction& r, std::size_t i, const From& from, To&& to) {
  const Island &solved = solved_island(*r.data, i), &own = r.islands[i];
  for (std::size_t k = 0; k < solved.contacts.size(); ++k) {
    const int c = solved.contacts[k], first = solved.row_offset[k];
    const int rows = r.scene.contacts[c].rows();
    const PairRows* pair = r.pair_of(c);
    if (!pair) {
      to.middleRows(row_of(own, c), rows) = from.middleRows(first, rows);
      continue;
    }
    int row = 0;
    for (std::size_t m = 0; m < pair->contacts.size(); ++m) {
      const int at = row_of(own, pair->contacts[m]);
      for (int i = 0; i < pair->members[m].rows(); ++i, ++row)
        to.row(at + i).noalias() = (pair->unit[row] * pair->numbers->Q.row(row)) * from.middleRows(first, rows);
    }
  }
}

void expand_panel(const Scene& scene, const Reduction& r, std::size_t i, const IslandDerivatives& from,
                  IslandDerivatives& out) {
  const Island& island = r.islands[i];
  if (out.request != from.request || out.X.rows() != island.size() || out.cols != from.cols ||
      out.u_offset != from.u_offset || out.wrenches != from.wrenches)
    lay_out(scene, island, from.request, out);
  const Eigen::Index nv = island.nv, cols = out.cols, w = std::min(out.W.cols(), from.W.cols());
  out.X.topLeftCorner(nv, cols) = from.X.topLeftCorner(nv, cols);
  out.W.topLeftCorner(nv, w) = from.W.topLeftCorner(nv, w);
  expand_rows(r, i, from.X.block(nv, 0, from.nc, cols), out.X.block(nv, 0, island.nc, cols));
  expand_rows(r, i, from.W.block(nv, 0, from.nc, w), out.W.block(nv, 0, island.nc, w));
}

// Returns the largest row sum of |S Q|, at least 1: f = S Q y has errors at most this times those of pairs' forces y.
double largest_share(const Reduction& r, std::size_t i) {
  double largest = 1;
  for (int c : solved_island(*r.data, i).contacts) {
    const PairRows* pair = r.pair_of(c);
    if (!pair) continue;
    for (std::size_t row = 0; row < pair->unit.size(); ++row)
      largest = std::max(largest, pair->unit[row] * pair->numbers->Q.row(static_cast<Eigen::Index>(row)).lpNorm<1>());
  }
  return largest;
}

// Converts a bound relative to y, the largest of the reduced scene's forces or of their derivatives, into one relative
// to the scene's largest, f. share: largest_share.
double relative_to_forces(double bound, double share, double y, double f) {
  if (bound == 0 || !std::isfinite(bound)) return bound;
  return y == 0 ? 0 : bound * share * y / f;
}

void take_bounds(const Scene& scene, SceneData& data, const Reduction& r) {
  for (std::size_t i = 0; i < r.islands.size(); ++i) {
    const IslandReport& from = r.data->report.islands[i];
    IslandReport& to = data.report.islands[i];
    to.error_acceleration = from.error_acceleration;
    to.condition = from.condition;
    to.error_forces = relative_to_forces(from.error_forces, largest_share(r, i),
                                         largest_force(r.scene, r.data->f_offset, solved_island(*r.data, i), r.data->f),
                                         largest_force(scene, data.f_offset, r.islands[i], data.f));
    if (from.status == Status::kRegularised) to.status = from.status, to.reason = from.reason;
  }
  summarise(data.report);
}

template <class Block>
double largest_in(const Block& block) {
  return block.size() == 0 ? 0 : block.cwiseAbs().maxCoeff();
}

}  // namespace

SceneData& differentiated(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  Reduction& r = *w.reduction;
  bool as_one = true;
  if (scene.damping > 0) r.each_pair([&](int c, const PairRows& pair) { as_one = as_one && moves_as_one(r, c, pair); });
  if (as_one) return *r.data;
  if (r.plain && r.plain->serial != 0) return *r.plain;
  Options options = data.options;
  options.reduce_pairs = false;
  if (!r.plain) r.plain = std::make_unique<SceneData>(scene, options);
  r.plain->options = options;
  r.plain->active = data.active;
  r.plain->wrenches = data.wrenches;
  (void)solve_tau(scene, w.q, data.v, w.given, *r.plain);
  return *r.plain;
}

const DerivativeData& differentiate_reduced(const Scene& scene, SceneData& data, const DerivativeRequest& request) {
  Workspace& w = *data.workspace;
  const Reduction& r = *w.reduction;
  SceneData& solved = differentiated(scene, data);
  const bool plain = &solved == r.plain.get();
  const DerivativeData& from = differentiate(plain ? scene : r.scene, solved, request);
  w.derivatives.islands.resize(r.islands.size());
  for (std::size_t i = 0; i < r.islands.size(); ++i) {
    IslandDerivatives& out = w.derivatives.islands[i];
    out.stamp = {};
    if (plain)
      out = from.islands[i];
    else
      expand_panel(scene, r, i, from.islands[i], out);
    out.stamp = {&w.current, data.serial};
  }
  return w.derivatives;
}

std::vector<DerivativeBounds> derivative_errors_reduced(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  const Reduction& r = *w.reduction;
  SceneData& solved = differentiated(scene, data);
  const bool plain = &solved == r.plain.get();
  std::vector<DerivativeBounds> out = estimate_derivative_errors(plain ? scene : r.scene, solved);
  for (std::size_t i = 0; i < out.size() && !plain; ++i) {
    const IslandDerivatives &of_y = derivatives(*r.data).islands[i], &of_f = w.derivatives.islands[i];
    const double share = largest_share(r, i);
    DerivativeBounds& b = out[i];
    const auto take = [share](double& bound, const auto& y, const auto& f) {
      bound = relative_to_forces(bound, share, largest_in(y), largest_in(f));
    };
    take(b.dforces_dq, of_y.dforces_dq(), of_f.dforces_dq());
    take(b.dforces_dv, of_y.dforces_dv(), of_f.dforces_dv());
    take(b.dforces_dw, of_y.dforces_dw(), of_f.dforces_dw());
    take(b.dforces_du, of_y.dforces_du(), of_f.dforces_du());
  }
  return out;
}

void bound_errors_reduced(const Scene& scene, SceneData& data) {
  const Reduction& r = *data.workspace->reduction;
  bound_errors(r.scene, *r.data);
  take_bounds(scene, data, r);
}

// With damping, the full scene's K also has the eigenvalue -damping (forces in the null space of a pair's J^T).
void estimate_condition_reduced(const Scene& scene, SceneData& data) {
  const Reduction& r = *data.workspace->reduction;
  estimate_condition(r.scene, *r.data);
  Workspace& solved = *r.data->workspace;
  for (std::size_t i = 0; i < r.islands.size() && scene.damping > 0; ++i) {
    IslandWork& d = *solved.islands[i];
    if (!has_pairs(r, i) || !d.matrix.make_current(r.scene, *r.data, solved.threads.front())) continue;
    double& condition = r.data->report.islands[i].condition;
    condition = std::max(condition, norm_of(d.matrix) / scene.damping);
  }
  take_bounds(scene, data, r);
}

}  // namespace manycontact::internal
