// Factorizes an island's whole K by the first sound method, from the chosen one to the dense reference solver.

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../internal.hpp"
#include "manycontact/rank/contradiction.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "row_terms.hpp"

namespace manycontact::internal {

namespace {

Factor& factor_of(MatrixSystem& m, FactorKind kind, Order order) {
  const auto made = [](std::unique_ptr<Factor>& factor, auto&& make) -> Factor& {
    if (!factor) factor = make();
    return *factor;
  };
  if (kind == FactorKind::kWaiting)
    return made(order == Order::kLeafToRoot ? m.waiting : m.waiting_in_order, make_waiting_ldl_factor);
  if (kind == FactorKind::kProximal) return made(m.proximal, make_proximal_factor);
  if (kind == FactorKind::kDense) return made(m.dense, make_dense_factor);
  return made(m.chosen, [&m] { return make_factor(m.owner.choice.method, m.owner.shape); });
}

bool may_ask_oracle(const MatrixSystem& m) {  // whether K is small enough for the dense reference solver
  return m.owner.choice.method == Method::kDense ||
         (m.owner.island.nc <= tolerance::kFewRows && m.owner.island.size() <= tolerance::kDenseSize);
}

// Computes the possible size of each row of the island's J, with which vanishing rows and pivots are compared.
void row_scales(const Scene& scene, const Workspace& w, const Island& island, std::vector<double>& size) {
  size.resize(island.nc);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    for (int i = 0; i < scene.contacts[c].rows(); ++i)
      size[island.row_offset[k] + i] = row_size(scene.contacts[c], w.contacts[c], i);
  }
}

// Whether a row of the island's J consists of rounding errors only, relative to `size`. Pivots do not reveal this.
bool has_vanishing_row(const Scene& scene, const MatrixSystem& m, const std::vector<double>& size) {
  for (std::size_t c = 0; c < m.J.size(); ++c) {
    const Eigen::Index rows = scene.contacts[m.owner.island.contacts[c]].rows();
    const Eigen::Map<const Eigen::MatrixXd> J(m.J[c].data(), rows, static_cast<Eigen::Index>(m.J[c].size()) / rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double largest = J.cols() > 0 ? J.row(i).cwiseAbs().maxCoeff() : 0;
      if (!(largest > tolerance::kRank * size[m.owner.island.row_offset[c] + i])) return true;
    }
  }
  return false;
}

// Returns the inconsistency of the contacts. It is zero if WithinTolerance's change of J can explain it.
rank::Contradiction<double> contradiction_of(const Scene& scene, const Workspace& w, MatrixSystem& m,
                                             const std::vector<double>& sizes) {
  const Island& island = m.owner.island;
  const KktVectors& v = m.v;
  std::vector<double>& terms = m.row_terms;
  terms.resize(island.nc);
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const RowTerms<double> drift = bias_acceleration_terms(scene, w, island.contacts[c]);
    for (int i = 0, row = island.row_offset[c]; i < scene.contacts[island.contacts[c]].rows(); ++i, ++row)
      terms[row] = drift.of_row(i) * unit_of(m, row);
  }
  const auto at = [&](int row) { return m.K.pattern->iperm[island.nv + row]; };
  rank::Contradiction<double> of;
  for (int row = 0; row < island.nc; ++row) {
    const double b = std::abs(v.b[at(row)]);
    of.add_products(v.scale[at(row)] - b, b);
  }
  of.add_rows([&](auto&& use) {
    for (int row = 0; row < island.nc; ++row) use({sizes[row], terms[row], v.null_component[at(row)]});
  });
  const double largest = island.nc > 0 ? *std::max_element(terms.begin(), terms.end()) : 0;
  if (of.left <= m.tolerated * (of.Ja + of.a0 + largest)) of.left = of.of_terms = 0;
  return of;
}

// Returns a backward error for states in which all terms of a row may be rounding errors, e.g. at rest or in free fall.
// Each row's residual is divided by the largest of three magnitudes: the row's terms (of all contact rows for a contact
// row); kPartOfData times the terms it would have if M_jk were sqrt(M_jj M_kk) and J_jk row_size_j; and eps /
// kConverged times its diagonal term at the largest acceleration that loads cause. forces: set to the sizes of J^T f.
double backward_error_of_data(const Scene& scene, const MatrixSystem& m, const std::vector<double>& row_size,
                              std::vector<double>& forces) {
  const KktPattern& p = *m.K.pattern;
  const KktVectors& v = m.v;
  constexpr double kRounding = std::numeric_limits<double>::epsilon() / tolerance::kConverged;
  const auto inertia = [&](int k) { return m.K.values[p.K.p[p.iperm[k] + 1] - 1]; };
  double error = 0, of_rows = 0, largest_a = 0;  // of_rows: largest terms of contact rows; largest_a: of terms / size
  for (int k = 0; k < p.size(); ++k) {
    const double terms = v.scale[p.iperm[k]];
    if (k >= p.nv) of_rows = std::max(of_rows, terms);
    const double size = k < p.nv ? inertia(k) : row_size[k - p.nv];
    if (size > 0) largest_a = std::max(largest_a, terms / size);
  }
  const auto judge = [&](int k, double size, double least) {
    const int at = p.iperm[k];
    const double left = std::abs(m.deficient() ? v.r[at] - v.null_component[at] : v.r[at]);
    if (left != 0)
      error = sparse::larger_or_nan(error, left / std::max({v.scale[at], tolerance::kPartOfData * size, least}));
  };
  const auto a = [&](int k) { return std::abs(v.x[p.iperm[k]]); };
  const auto root = [&](int k) { return std::sqrt(inertia(k)); };
  const Island& island = m.owner.island;
  const std::vector<std::vector<int>>& columns = m.owner.shape->support().columns;
  forces.assign(m.K.size(), 0.0);  // sizes of J^T f at each velocity coordinate
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    double sum = 0;
    for (int i = 0, row = island.row_offset[c]; i < scene.contacts[island.contacts[c]].rows(); ++i, ++row)
      sum += row_size[row] * a(island.nv + row);
    for (int k : columns[c]) forces[k] += sum;
  }
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const int first = island.dof_offset[r], end = first + scene.robots[island.robots[r]].model->nv;
    double sum = 0;
    for (int k = first; k < end; ++k) sum += root(k) * a(k);
    for (int k = first; k < end; ++k) judge(k, root(k) * sum + forces[k], kRounding * inertia(k) * largest_a);
  }
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    double sum = 0;
    for (int k : columns[c]) sum += a(k);
    for (int i = 0, row = island.row_offset[c]; i < scene.contacts[island.contacts[c]].rows(); ++i, ++row)
      judge(island.nv + row, row_size[row] * sum, std::max(of_rows, kRounding * row_size[row] * largest_a));
  }
  return error;
}

bool all_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y); });
}

Reason factorize_and_solve(const Scene& scene, const SceneData& data, FactorScratch& scratch, const Attempt& by,
                           MatrixSystem& m, IslandReport& report) {
  assemble(scene, data, by.order, by.damping, m);
  if (by.kind != FactorKind::kChosen) weigh_rows(scene, m);
  Factor& factor = factor_of(m, by.kind, by.order);
  report.method = factor.method();
  report.order = by.order;
  row_scales(scene, *data.workspace, m.owner.island, scratch.row_scale);
  if (by.kind == FactorKind::kChosen && by.damping == 0 && has_vanishing_row(scene, m, scratch.row_scale))
    return Reason::kSmallPivot;
  for (std::size_t k = 0; k < m.unit.size(); ++k) scratch.row_scale[k] *= m.unit[k];
  ++m.owner.factorizations;
  if (const Reason reason = factor.factorize(m.K, scratch); reason != Reason::kNone) return reason;
  const int own = factor.own_refinements();
  sparse::Refinement refinement = factor.solve_refined(m.K, m.v, own > 0 ? 0 : tolerance::kRefinementSteps);
  report.factor_nonzeros = factor.nonzeros();
  report.refinement_steps = refinement.steps + (by.kind == FactorKind::kProximal ? 0 : own);
  if (!all_finite(m.v.x))
    return all_finite(m.K.values) && all_finite(m.v.b) ? Reason::kLargeResidual : Reason::kNotFinite;
  // No limit for the dense reference solver: no other result is more accurate.
  const double most = by.kind == FactorKind::kDense ? std::numeric_limits<double>::max() : tolerance::kConverged;
  m.factor = &factor;
  if (m.rows) m.rows->known = false;
  if (!(refinement.backward_error <= most))
    refinement.backward_error = backward_error_of_data(scene, m, scratch.row_scale, scratch.scale);
  if (!(refinement.backward_error <= most)) return Reason::kLargeResidual;
  m.first_error = refinement.first;
  report.backward_error = refinement.backward_error;
  report.rank = factor.rank();
  report.status = Status::kOk;
  m.contradiction = false;
  if (m.deficient()) {
    const rank::Contradiction<double> of = contradiction_of(scene, *data.workspace, m, scratch.row_scale);
    if (by.kind != FactorKind::kDense && of.needs_dense() && may_ask_oracle(m)) return Reason::kSmallPivot;
    m.contradiction = of.exceeds_rounding();
    report.status = contradicts(scene, data, of, m.owner) ? Status::kInconsistent : Status::kRedundant;
    factor.dependent_rows(m.dependent);
    name_dependent_rows(data, m.owner.island, m.dependent, report);
  }
  return Reason::kNone;
}

// Factorizes K by this attempt and solves with refinement. Returns kNone if the solution is sound and the report is
// complete. If an allocation throws, neither K nor a factor is current.
Reason attempt(const Scene& scene, const SceneData& data, FactorScratch& scratch, const Attempt& by, MatrixSystem& m,
               IslandReport& report) {
  m.factor = nullptr, m.state = 0;
  const Reason reason = factorize_and_solve(scene, data, scratch, by, m, report);
  if (reason != Reason::kNone) m.factor = nullptr;
  m.state = data.workspace->state;
  return reason;
}

// Adds LDL with waiting rows, unless nc > kFewRows and more than kMostWaiting rows surely depend (nc - nv). If nc
// > kFewRows, also adds LDL of all rows, if sound pivots are expected (`plainly`), and then proximal steps.
void add_ldl(const MatrixSystem& m, Order order, bool plainly, Attempts& out) {
  const bool large = m.owner.island.nc > tolerance::kFewRows;
  const int depend = m.owner.island.nc - m.owner.island.nv;
  if (!large || depend <= tolerance::kMostWaiting) out.add({FactorKind::kWaiting, order, 0});
  if (!large) return;
  if (plainly && depend <= 0) out.add({FactorKind::kChosen, order, 0});
  out.add({FactorKind::kProximal, order, 0});
}

}  // namespace

Attempts attempts_of(const Scene& scene, const MatrixSystem& m) {
  Attempts out;
  const double damping = scene.damping;
  const auto [method, order] = m.owner.choice;
  const RobotsSystem* robots = m.owner.robots.get();
  const bool refused = robots && robots->refused && !is_inexact(scene, m.owner), dense = method == Method::kDense;
  const bool by_ldl = method == Method::kSparseLdl || method == Method::kSparseBodies;
  if (damping > 0 || !by_ldl) {
    if (!dense && !m.owner.deficient) out.add({FactorKind::kChosen, order, damping});
    if (method == Method::kDenseSchur) return out;  // dense-schur, a baseline for comparisons, has no fallback
    if (damping > 0 && order != Order::kLeafToRoot && has_order(method))
      out.add({FactorKind::kChosen, Order::kLeafToRoot, damping});
    if (damping == 0 && !dense) add_ldl(m, Order::kLeafToRoot, false, out);
  } else {
    add_ldl(m, order, !refused && !m.owner.deficient, out);
    if (order != Order::kLeafToRoot) add_ldl(m, Order::kLeafToRoot, false, out);
  }
  // Near a singular configuration possibly only the dense reference solver is sound.
  if (dense || m.owner.island.size() <= tolerance::kDenseSize) out.add({FactorKind::kDense, order, damping});
  return out;
}

bool solve_by_fallbacks(const Scene& scene, const SceneData& data, FactorScratch& scratch, MatrixSystem& m,
                        IslandReport& report) {
  const auto [method, order] = m.owner.choice;
  const Attempts attempts = attempts_of(scene, m);
  Reason first = Reason::kNone, last = Reason::kNone;
  m.factor = nullptr;
  for (int k = 0; k < attempts.count; ++k) {
    const Attempt& by = attempts.list[k];
    last = attempt(scene, data, scratch, by, m, report);
    if (k == 0) first = last;
    if (last != Reason::kNone) continue;
    report.reason = by.kind != FactorKind::kDense && m.deficient() ? Reason::kSmallPivot : first;
    report.changed_order = by.kind != FactorKind::kDense && by.order != order;
    return true;
  }
  report.reason = last;
  if (last != Reason::kSmallPivot || scene.damping == 0 || method == Method::kDenseSchur) return false;
  // Damping below the rounding errors of K is set to zero: the result solves a neighbouring problem.
  Attempts undamped;
  add_ldl(m, Order::kLeafToRoot, false, undamped);
  if (std::none_of(undamped.list.begin(), undamped.list.begin() + undamped.count,
                   [&](const Attempt& by) { return attempt(scene, data, scratch, by, m, report) == Reason::kNone; }))
    return false;
  report.status = Status::kRegularised;
  report.reason = Reason::kDampingLost;
  return true;
}

bool solve_by_oracle(const Scene& scene, const SceneData& data, ThreadWork& thread, MatrixSystem& m) {
  if (m.factor == m.dense.get() || !may_ask_oracle(m)) return false;
  const Attempt oracle{FactorKind::kDense, m.owner.choice.order, scene.damping};
  if (attempt(scene, data, thread.scratch, oracle, m, thread.spare_report) == Reason::kNone) return true;
  (void)solve_by_fallbacks(scene, data, thread.scratch, m, thread.spare_report);  // restores the factor for later calls
  return false;
}

}  // namespace manycontact::internal
