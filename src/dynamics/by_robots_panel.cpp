// Derivatives robot by robot: the numbers.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "by_robots.hpp"
#include "cut.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"
#include "threads.hpp"

namespace manycontact::internal {

namespace {

using OfRobot = ByRobots::OfRobot;
using Columns = std::vector<ByRobots::Columns>;

bool has_own(const Columns& columns, int first, int cols) {
  return std::any_of(columns.begin(), columns.end(),
                     [&](const ByRobots::Columns& c) { return c.in_X < first + cols && first < c.in_X + c.count; });
}

// Flags the joining rows, in the order of S, that right-hand sides in these columns reach. columns_of(r): in the panel.
template <class ColumnsOf>
void find_reach(const ByRobots& by, ColumnsOf&& columns_of, int first, int cols, std::vector<char>& nonzero) {
  std::fill(nonzero.begin(), nonzero.end(), 0);
  for (const OfRobot& r : by.robots)
    if (has_own(columns_of(r), first, cols))
      for (int k : r.joining) nonzero[by.joining->place[k]] = 1;
  sparse::ldl_scheduled_reach(by.joining->schedule, nonzero.data());
}

const Columns& columns_in_X(const OfRobot& r) { return r.columns; }
const Columns& columns_in_sample(const OfRobot& r) { return r.sampled; }

// Zeros wherever right-hand sides may stand, and in the joining rows wherever they reach.
void clear_rhs(const ByRobots& by, std::vector<char>& nonzero, AlignedPanel& X) {
  const int ld = static_cast<int>(X.cols());
  for (const OfRobot& r : by.robots)
    for (const ByRobots::Columns& c : r.columns)
      for (int row : r.row) std::fill_n(&X(row, c.in_X), c.count, 0.0);
  for (int first = 0; first < ld; first += ByRobots::kChunk) {
    const int cols = std::min(ByRobots::kChunk, ld - first);
    find_reach(by, columns_in_X, first, cols, nonzero);
    for (std::size_t k = 0; k < nonzero.size(); ++k)
      if (nonzero[k]) std::fill_n(&X(by.eliminated[k], first), cols, 0.0);
  }
}

// The sample of B in K's order, column after column.
void sample_rhs(const IslandWork& d, const AlignedPanel& X, ByRobots& by) {
  const int* iperm = d.K.pattern->iperm.data();
  ByRobots::Sample& sample = by.sample;
  std::fill(sample.b.begin(), sample.b.end(), 0.0);
  for (const OfRobot& r : by.robots)
    for (const ByRobots::Columns& c : r.sampled) {
      const int s = c.in_X;
      const auto take = [&](int row) {
        sample.b[static_cast<std::size_t>(s) * d.island.size() + iperm[row]] = X(row, sample.column[s]);
      };
      std::for_each(r.row.begin(), r.row.end(), take);
      std::for_each(r.join.begin(), r.join.end(), take);
    }
}

// Whether the factors that the island was solved by, robot by robot, are there.
bool has_factors(const IslandWork& d) { return d.in_lanes && d.cut; }

// K_r's factor; false where its pivots are not sound.
bool factorize_robot(const IslandWork& d, std::size_t k, OfRobot& r, FactorScratch& scratch) {
  r.K.damping = d.K.damping;
  if (has_factors(d)) {
    take_factor_of_robot(*d.cut, k, r.K, *r.factor);
    return true;
  }
  for (std::size_t c = 0; c < r.contacts.size(); ++c) r.J[c] = d.J[r.contacts[c]];
  assemble({&d.M[k], 1}, r.J, d.K.damping, r.K);
  r.K.row_size = d.K.row_size;
  return r.factor->factorize(r.K, scratch) == Reason::kNone;
}

// G_r^T, from the columns that the joining contacts' J have on the robot.
void gather_joining(const IslandWork& d, std::size_t k, OfRobot& r) {
  const int first = d.island.dof_offset[k], nv = r.K.nv(), ld = r.padded();
  std::fill(r.G.begin(), r.G.end(), 0.0);
  std::size_t at = 0;
  for (int c : r.joins) {
    const std::vector<int>& columns = d.shape->support().columns[c];
    const std::size_t rows = d.J[c].size() / columns.size();
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const int i = columns[j] - first;
      if (i >= 0 && i < nv) std::copy_n(d.J[c].data() + j * rows, rows, r.G.data() + i * ld + at);
    }
    at += rows;
  }
}

// P = K_r^-1 [G_r^T, B_r], refined once or not at all, H = G_r P and T. B stands in X.
void solve_robot(const AlignedPanel& X, bool refined, OfRobot& r) {
  const int nv = r.K.nv(), joining = static_cast<int>(r.joining.size());
  for (int i = 0; i < r.size(); ++i) {
    double* p = r.P.data() + static_cast<std::ptrdiff_t>(i) * r.ld;
    std::fill_n(p, r.ld, 0.0);
    if (i < nv) std::copy_n(r.G.data() + static_cast<std::ptrdiff_t>(i) * r.padded(), joining, p);
    for (const ByRobots::Columns& c : r.columns) std::copy_n(&X(r.row[i], c.in_X), c.count, p + c.in_P);
  }
  std::fill(r.nonzero.begin(), r.nonzero.end(), 1);
  if (refined)
    r.factor->solve_panel_refined(r.K, r.P.data(), r.ld, 0, r.ld, r.nonzero.data());
  else
    r.factor->solve_panel(r.P.data(), r.ld, 0, r.ld, r.nonzero.data());
  sparse::panel_kernels().product(r.G.data(), r.padded(), r.P.data(), nv, r.padded(), r.ld, r.ld, r.H.data());
  const int ldT = sparse::padded(r.size());
  for (int i = 0; i < r.size(); ++i)
    for (int j = 0; j < joining; ++j)
      r.T[static_cast<std::ptrdiff_t>(j) * ldT + i] =
          (i < nv ? 1 : -1) * r.P[static_cast<std::ptrdiff_t>(i) * r.ld + j];
}

// S = sum_r G_r T_r + delta I and its factor; false where its pivots are not sound.
bool factorize_joining(const IslandWork& d, ByRobots& by) {
  if (has_factors(d)) {  // of -S
    by.L = d.cut->L;
    by.scale = d.cut->terms;
    std::transform(d.cut->D.begin(), d.cut->D.end(), by.D.begin(), std::negate<>());
    return true;
  }
  std::fill(by.Sx.begin(), by.Sx.end(), 0.0);
  for (int k = 0; k < by.joining->rows(); ++k) by.Sx[by.joining->S.p[k + 1] - 1] = d.K.damping;
  for (const OfRobot& r : by.robots) {
    const int* slot = r.slot.data();
    for (std::size_t j = 0; j < r.joining.size(); ++j)
      for (std::size_t i = 0; i <= j; ++i) by.Sx[*slot++] += r.H[i * r.ld + j];
  }
  sparse::panel_kernels().factor(by.joining->schedule, by.Sx.data(), by.L.data(), by.D.data(), by.scale.data());
  for (double pivot : by.D)
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
  return sparse::smallest_pivot_ratio(by.joining->rows(), by.D.data(), by.scale.data()) >= tolerance::kPivotLeft;
}

// Growth of K's entries, as Factor has it.
double growth(const IslandWork& d, const ByRobots& by) {
  double terms = 0, diagonal = 0, most = 1;
  for (double s : by.scale) terms = std::max(terms, s);
  for (int k = 0; k < d.K.size(); ++k) diagonal = std::max(diagonal, std::abs(d.K.values[d.K.pattern->K.p[k + 1] - 1]));
  for (const OfRobot& r : by.robots) most = std::max(most, r.factor->growth());
  return std::max(most, terms / diagonal);
}

// -S Y into the joining rows, which hold B: B_joining - sum_r G_r K_r^-1 B_r.
void joining_rhs(const ByRobots& by, AlignedPanel& X) {
  for (const OfRobot& r : by.robots)
    for (std::size_t i = 0; i < r.joining.size(); ++i) {
      const double* h = r.H.data() + i * r.ld;
      double* x = &X(r.join[i], 0);
      for (const ByRobots::Columns& c : r.columns)
        for (int j = 0; j < c.count; ++j) x[c.in_X + j] -= h[c.in_P + j];
    }
}

// Adds K_r^-1 B_r to columns first ... first+cols-1 of a robot's rows of [da; df].
void add_own(const OfRobot& r, const Columns& columns, int first, int cols, double* X, std::ptrdiff_t ld) {
  for (const ByRobots::Columns& c : columns) {
    const int begin = std::max(c.in_X, first), end = std::min(c.in_X + c.count, first + cols);
    for (int i = 0; begin < end && i < r.size(); ++i) {
      const double *p = r.P.data() + static_cast<std::ptrdiff_t>(i) * r.ld + c.in_P - c.in_X,
                   sign = i < r.K.nv() ? 1 : -1;
      double* x = X + r.row[i] * ld;
      for (int j = begin; j < end; ++j) x[j] += sign * p[j];
    }
  }
}

// Columns first ... first+cols-1 of [da; df] from what joining_rhs left in the joining rows: -Y there, and
// K_r^-1 B_r - T_r Y in each robot's, K_r^-1 B_r where columns_of(r) says.
template <class ColumnsOf>
void answer(const ByRobots& by, ColumnsOf&& columns_of, int first, int cols, double* X, int ld, bool past_caches,
            ByRobots::Buffers& buffers) {
  const sparse::PanelKernels& kernels = sparse::panel_kernels();
  find_reach(by, columns_of, first, cols, buffers.nonzero);
  kernels.solve(by.joining->schedule, by.L.data(), by.D.data(), by.eliminated.data(), X, ld, first, cols,
                buffers.nonzero.data(), buffers.work.data());
  for (const OfRobot& r : by.robots) {
    const Columns& columns = columns_of(r);
    const bool own = has_own(columns, first, cols);
    kernels.product_of_rows(r.T.data(), sparse::padded(r.size()), X + first, r.join.data(),
                            static_cast<int>(r.join.size()), X + first, r.row.data(), r.size(), cols, ld,
                            past_caches && !own);
    if (own) add_own(r, columns, first, cols, X, ld);
  }
}

// Whether every column of the sample has a componentwise backward error, with the island's K, of no more than half of
// what derivatives are allowed.
bool sample_is_good(const IslandWork& d, const AlignedPanel& X, Workspace& w, ByRobots& by) {
  ByRobots::Sample& sample = by.sample;
  const int count = static_cast<int>(sample.column.size());
  for (int row : by.joining->row) std::fill_n(&sample.X(row, 0), sample.X.cols(), 0.0);
  for (const OfRobot& r : by.robots)
    for (const ByRobots::Columns& c : r.sampled)
      for (int row : r.join) sample.X(row, c.in_X) = X(row, sample.column[c.in_X]);
  const int ld = static_cast<int>(sample.X.cols());
  answer(by, columns_in_sample, 0, ld, sample.X.data(), ld, false, by.buffers.front());
  const sparse::UpperCsc& pattern = d.K.pattern->K;
  const int* iperm = d.K.pattern->iperm.data();
  each_item(w, count, [&](std::size_t s, ThreadWork& thread) {
    ByRobots::Buffers& buffers = by.buffers[thread.number];
    for (int row = 0; row < d.island.size(); ++row)
      buffers.x[iperm[row]] = row < d.island.nv ? sample.X(row, s) : -sample.X(row, s);
    sparse::panel_kernels().residual_vector(pattern, d.K.values.data(), buffers.x.data(),
                                            sample.b.data() + s * pattern.n, buffers.r.data(), buffers.scale.data());
    sample.error[s] = sparse::componentwise_backward_error(buffers.r, buffers.scale);
  });
  return std::all_of(sample.error.begin(), sample.error.end(),
                     [](double error) { return error <= tolerance::kPanelRefined; });
}

// What answers need of each robot and of the joining rows, from right-hand sides in X; whether that is sound.
bool solve_robots(const Scene& scene, SceneData& data, IslandWork& d, bool refined, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  ByRobots& by = *d.by_robots;
  AlignedPanel& X = out.X;
  clear_rhs(by, by.buffers.front().nonzero, X);
  derivative_rhs(scene, *w.linearisation, data.v, d, out);
  sample_rhs(d, X, by);
  if (!has_factors(d)) ++d.factorizations;
  each_item(w, by.robots.size(), [&](std::size_t k, ThreadWork& thread) {
    OfRobot& r = by.robots[k];
    r.sound = factorize_robot(d, k, r, thread.scratch);
    if (!r.sound) return;
    gather_joining(d, k, r);
    solve_robot(X, refined, r);
  });
  if (!std::all_of(by.robots.begin(), by.robots.end(), [](const OfRobot& r) { return r.sound; })) return false;
  if (!factorize_joining(d, by)) return false;
  if (!(growth(d, by) * std::numeric_limits<double>::epsilon() <= tolerance::kConverged)) return false;
  joining_rhs(by, X);
  return sample_is_good(d, X, w, by);
}

}  // namespace

bool differentiate_by_robots(const Scene& scene, SceneData& data, IslandWork& d, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  if (!goes_by_robots(d)) return false;
  ByRobots& by = *d.by_robots;
  AlignedPanel& X = out.X;
  const bool refined = d.first_error > tolerance::kRefinePanel;
  if (!solve_robots(scene, data, d, refined, out) && (refined || !solve_robots(scene, data, d, true, out)))
    return false;

  const int ld = static_cast<int>(X.cols());
  const bool past_caches = sizeof(double) * X.size() > kCached;
  each_item(w, (ld + ByRobots::kChunk - 1) / ByRobots::kChunk, [&](std::size_t chunk, ThreadWork& thread) {
    const int first = static_cast<int>(chunk) * ByRobots::kChunk, cols = std::min(ByRobots::kChunk, ld - first);
    answer(by, columns_in_X, first, cols, X.data(), ld, past_caches, by.buffers[thread.number]);
  });
  return true;
}

}  // namespace manycontact::internal
