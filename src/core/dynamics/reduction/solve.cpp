// Solves the reduced scene, and computes the forces of all contacts from its solution.

#include <algorithm>
#include <cmath>

#include "../internal.hpp"
#include "../workspace/changes.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/rank/contradiction.hpp"
#include "reduction.hpp"

namespace manycontact::internal {

namespace {

void refresh(const Scene& scene, const SceneData& data, Reduction& r) {
  take_changes(scene, r.scene);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (r.data->active[c]) take_changes(scene.contacts[c], r.scene.contacts[c]);
  for (std::size_t k = 0; k < r.pairs.size(); ++k)
    refresh_pair(scene, *r.pairs[k], r.scene.contacts[static_cast<std::size_t>(r.first_pair()) + k]);
  r.data->wrenches = data.wrenches;
}

// Calls use(first row of the scene's f, first row of the pair, number of rows) for each contact of a pair.
template <class Use>
void each_member(const std::vector<int>& f_offset, const PairRows& pair, Use&& use) {
  int first = 0;
  for (std::size_t m = 0; m < pair.contacts.size(); ++m) {
    const int rows = pair.members[m].rows();
    use(f_offset[static_cast<std::size_t>(pair.contacts[m])], first, rows);
    first += rows;
  }
}

using PairVector = Eigen::Map<const Eigen::VectorXd>;

PairVector unit_of(const PairRows& pair) { return {pair.unit.data(), static_cast<Eigen::Index>(pair.unit.size())}; }

// Calls use(first row in the scene's f, first row in the reduced scene's f, number of rows) for contacts in no pair.
template <class Use>
void each_single(const SceneData& data, const Reduction& r, Use&& use) {
  for (std::size_t c = 0; c < data.f_offset.size(); ++c)
    if (const int from = r.data->f_offset[c]; from >= 0) use(data.f_offset[c], from, r.scene.contacts[c].rows());
}

const double* left_of_pair(const Reduction& r, int c) { return left_of(*r.data->workspace, c); }

// Adds forces in the null space of damped pairs' J^T, f += (prescribed - left) / delta, since only damping limits
// these. left: inconsistency of a pair's contacts (ContactData::left). Of the prescribed accelerations `wanted`, only
// the part counts that is outside the span of the pair's rows.
void add_damped_contradictions(const SceneData& data, double damping, const Reduction& r,
                               std::span<const double> wanted, Eigen::VectorXd& f) {
  r.each_pair([&](int c, const PairRows& pair) {
    const double* left = left_of_pair(r, c);
    const auto& Q = pair.numbers->Q;
    each_member(data.f_offset, pair, [&](int to, int first, int rows) {
      for (int i = 0; i < rows; ++i) {
        f[to + i] -= left[first + i] / damping;
        if (!wanted.empty())
          f[to + i] +=
              (wanted[to + i] - Q.row(first + i).dot(r.prescribed.segment(r.data->f_offset[c], Q.cols()))) / damping;
      }
    });
  });
}

// Returns the inconsistency among the contacts that an island's pairs replace.
rank::Contradiction<double> contradiction_of(const SceneData& data, const Reduction& r, std::size_t island,
                                             std::span<const double> wanted) {
  rank::Contradiction<double> out;
  out.Ja = r.data->report.islands[island].contact_terms;
  for (int c : solved_island(*r.data, island).contacts) {
    const PairRows* pair = r.pair_of(c);
    if (!pair) continue;
    const double* left = left_of_pair(r, c);
    const auto& Q = pair->numbers->Q;
    const auto y = wanted.empty() ? Eigen::Map<const Eigen::VectorXd>(nullptr, 0)
                                  : Eigen::Map<const Eigen::VectorXd>(&r.prescribed[r.data->f_offset[c]], Q.cols());
    const double terms = left[pair->unit.size()] + y.lpNorm<1>();
    each_member(data.f_offset, *pair, [&](int from, int first, int rows) {
      for (int i = first; i < first + rows; ++i) {
        double size = left[i];
        if (!wanted.empty()) size -= wanted[from + i - first] * pair->unit[i] - Q.row(i).dot(y);
        out.left = rank::larger_or_nan(std::abs(size), out.left);
        out.of_terms = rank::larger_or_nan(size == 0 ? 0 : std::abs(size) / terms, out.of_terms);
      }
    });
  }
  return out;
}

// Lists an island's dependent rows in its report. Of the rows that a pair replaces, these are the rows outside the
// pair's basis, and those whose row of the pair is dependent in the reduced scene.
void name_dependent_rows(const SceneData& data, const Reduction& r, std::size_t island, IslandReport& report) {
  const std::vector<int>& solved = r.data->report.islands[island].dependent_rows;
  const auto depends = [&](int row) { return std::binary_search(solved.begin(), solved.end(), row); };
  report.dependent_rows.clear();
  for (int c : solved_island(*r.data, island).contacts) {
    int at = r.data->f_offset[c];
    const PairRows* pair = r.pair_of(c);
    for (int i = 0; !pair && i < r.scene.contacts[c].rows(); ++i)
      if (depends(at + i)) report.dependent_rows.push_back(data.f_offset[c] + i);
    if (!pair) continue;
    each_member(data.f_offset, *pair, [&](int first, int own, int of_member) {
      for (int i = 0; i < of_member; ++i)
        if (!pair->spans[own + i] || depends(at++)) report.dependent_rows.push_back(first + i);
    });
  }
  std::sort(report.dependent_rows.begin(), report.dependent_rows.end());
}

// Sets the reduced scene's solution to the refined (a, f), with pairs' forces y = Q^T S^-1 f, for derivatives.
void take_refined(const SceneData& data, Reduction& r) {
  r.data->a = data.a;
  each_single(data, r, [&](int from, int to, int rows) { r.data->f.segment(to, rows) = data.f.segment(from, rows); });
  r.each_pair([&](int c, const PairRows& pair) {
    const auto& Q = pair.numbers->Q;
    auto all = r.rows_of_pair.head(Q.rows());
    each_member(data.f_offset, pair,
                [&](int from, int first, int rows) { all.segment(first, rows) = data.f.segment(from, rows); });
    all.array() /= unit_of(pair).array();
    r.data->f.segment(r.data->f_offset[c], Q.cols()) = Q.transpose().lazyProduct(all);
  });
}

void take_report(const Scene& scene, SceneData& data, const Reduction& r, std::span<const double> wanted) {
  for (std::size_t i = 0; i < r.islands.size(); ++i) {
    IslandReport& report = data.report.islands[i];
    IslandReport& solved = r.data->report.islands[i];
    std::vector<int> own = std::move(report.dependent_rows), others = std::move(solved.dependent_rows);
    own.clear();
    report = solved;  // except dependent_rows
    report.dependent_rows = std::move(own), solved.dependent_rows = std::move(others);
    report.nc = r.islands[i].nc;
    if (solved.status == Status::kFailed) continue;
    if (scene.damping > 0) {
      if (report.status != Status::kRegularised) report.rank = report.nc;
      continue;
    }
    if (has_pairs(r, i) && report.status == Status::kOk) report.status = Status::kRedundant;
    if (report.status == Status::kRedundant &&
        contradicts(r.scene, *r.data, contradiction_of(data, r, i, wanted), *r.data->workspace->islands[i]))
      report.status = Status::kInconsistent;
    if (report.rank < report.nc) name_dependent_rows(data, r, i, report);
  }
  data.report.method = data.options.method;
  summarise(data.report);
}

}  // namespace

void expand_forces(const SceneData& data, const double* y, double* f) {
  Reduction& r = *data.workspace->reduction;
  each_single(data, r, [&](int to, int from, int rows) { std::copy_n(y + from, rows, f + to); });
  r.each_pair([&](int c, const PairRows& pair) {
    const auto& Q = pair.numbers->Q;
    const PairVector of(y + r.data->f_offset[c], Q.cols());
    auto all = r.rows_of_pair.head(Q.rows());
    all = unit_of(pair).cwiseProduct(Q.lazyProduct(of));
    each_member(data.f_offset, pair, [&](int to, int first, int rows) { std::copy_n(&all[first], rows, f + to); });
  });
}

void reduce_forces(const SceneData& data, const double* f, double* y) {
  Reduction& r = *data.workspace->reduction;
  each_single(data, r, [&](int from, int to, int rows) { std::copy_n(f + from, rows, y + to); });
  r.each_pair([&](int c, const PairRows& pair) {
    const auto& Q = pair.numbers->Q;
    auto all = r.rows_of_pair.head(Q.rows());
    each_member(data.f_offset, pair, [&](int from, int first, int rows) { std::copy_n(f + from, rows, &all[first]); });
    all.array() *= unit_of(pair).array();
    Eigen::Map<Eigen::VectorXd>(y + r.data->f_offset[c], Q.cols()) = Q.transpose().lazyProduct(all);
  });
}

const Report& solve_reduced(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                            SceneData& data, std::span<const double> prescribed) {
  Workspace& w = *data.workspace;
  Reduction& r = *w.reduction;
  w.prescribed.assign(prescribed.begin(), prescribed.end());
  refresh(scene, data, r);
  if (r.plain) give_up_solution(*r.plain);
  w.given = tau;
  std::span<const double> of_solved;
  if (!prescribed.empty()) {
    r.prescribed.resize(r.data->f.size());
    reduce_forces(data, prescribed.data(), r.prescribed.data());
    of_solved = {r.prescribed.data(), static_cast<std::size_t>(r.prescribed.size())};
  }
  give_up_solution(*r.data);
  (void)solve_prepared(r.scene, q, v, tau, *r.data, of_solved);
  data.a = r.data->a;
  data.v = r.data->v;
  data.tau = r.data->tau;
  w.q = q;
  expand_forces(data, r.data->f.data(), data.f.data());
  if (scene.damping > 0) add_damped_contradictions(data, scene.damping, r, prescribed, data.f);
  take_report(scene, data, r, prescribed);
  data.serial = w.current = ++w.state;
  if (data.options.precision != Precision::kExtended) return data.report;
  refine_extended(scene, data);
  take_refined(data, r);
  summarise(data.report);
  return data.report;
}

}  // namespace manycontact::internal
