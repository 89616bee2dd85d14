// Derivatives robot by robot: the numbers.

#include <algorithm>
#include <cmath>
#include <limits>

#include "by_robots.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"
#include "threads.hpp"

namespace manycontact::internal {

namespace {

using OfRobot = ByRobots::OfRobot;
using Panel = IslandDerivatives::Panel;

// use(row, first column, count) wherever right-hand sides may stand in X.
template <class Use>
void each_rhs(const ByRobots& by, Use&& use) {
  for (const OfRobot& r : by.robots)
    for (const ByRobots::Columns& c : r.columns) {
      for (int row : r.row) use(row, c.in_X, c.count);
      for (int k : r.joining) use(by.joining->row[k], c.in_X, c.count);
    }
}

void sample_rhs(const IslandWork& d, const Panel& X, ByRobots& by) {
  const int* iperm = d.K.pattern->iperm.data();
  std::fill(by.sample.b.begin(), by.sample.b.end(), 0.0);
  each_rhs(by, [&](int row, int first, int count) {
    for (std::size_t s = 0; s < by.sample.column.size(); ++s)
      if (const int c = by.sample.column[s]; c >= first && c < first + count)
        by.sample.b[s * d.island.size() + iperm[row]] = X(row, c);
  });
}

// Columns first ... first+cols-1 of the answer [da; df] among the sample.
void sample_answer(const IslandWork& d, const Panel& X, int first, int cols, ByRobots& by) {
  const int* iperm = d.K.pattern->iperm.data();
  for (std::size_t s = 0; s < by.sample.column.size(); ++s) {
    const int c = by.sample.column[s];
    if (c < first || c >= first + cols) continue;
    double* x = by.sample.x.data() + s * d.island.size();
    for (int row = 0; row < d.island.size(); ++row) x[iperm[row]] = row < d.island.nv ? X(row, c) : -X(row, c);
  }
}

// K_r's factor; false where its pivots are not sound.
bool factorize_robot(const IslandWork& d, std::size_t k, OfRobot& r, FactorScratch& scratch) {
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

// P = K_r^-1 [G_r^T, B_r], refined once, H = G_r P and T. B stands in X.
void solve_robot(const Panel& X, OfRobot& r) {
  const int nv = r.K.nv(), joining = static_cast<int>(r.joining.size());
  for (int i = 0; i < r.size(); ++i) {
    double* p = r.P.data() + static_cast<std::ptrdiff_t>(i) * r.ld;
    std::fill_n(p, r.ld, 0.0);
    if (i < nv) std::copy_n(r.G.data() + static_cast<std::ptrdiff_t>(i) * r.padded(), joining, p);
    for (const ByRobots::Columns& c : r.columns) std::copy_n(&X(r.row[i], c.in_X), c.count, p + c.in_P);
  }
  std::fill(r.nonzero.begin(), r.nonzero.end(), 1);
  r.factor->solve_panel_refined(r.K, r.P.data(), r.ld, 0, r.ld, r.nonzero.data());
  sparse::panel_kernels().product(r.G.data(), r.padded(), r.P.data(), nv, r.padded(), r.ld, r.ld, r.H.data());
  const int ldT = sparse::padded(r.size());
  for (int i = 0; i < r.size(); ++i)
    for (int j = 0; j < joining; ++j)
      r.T[static_cast<std::ptrdiff_t>(j) * ldT + i] =
          (i < nv ? -1 : 1) * r.P[static_cast<std::ptrdiff_t>(i) * r.ld + j];
}

// S = sum_r G_r T_r + delta I and its factor; false where its pivots are not sound.
bool factorize_joining(const IslandWork& d, ByRobots& by) {
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

// Y <- sum_r G_r K_r^-1 B_r - B_joining.
void joining_rhs(const Panel& X, ByRobots& by) {
  const std::ptrdiff_t ld = X.cols();
  std::fill(by.Y.begin(), by.Y.end(), 0.0);
  for (const OfRobot& r : by.robots)
    for (const ByRobots::Columns& c : r.columns)
      for (int k : r.joining)
        for (int j = c.in_X; j < c.in_X + c.count; ++j) by.Y[k * ld + j] = -X(by.joining->row[k], j);
  for (const OfRobot& r : by.robots)
    for (std::size_t i = 0; i < r.joining.size(); ++i) {
      const double* h = r.H.data() + i * r.ld;
      double* to = by.Y.data() + r.joining[i] * ld;
      for (const ByRobots::Columns& c : r.columns)
        for (int j = 0; j < c.count; ++j) to[c.in_X + j] += h[c.in_P + j];
    }
}

void solve_joining(ByRobots& by, ByRobots::Buffers& buffers, int ld, int first, int cols) {
  std::fill(buffers.nonzero.begin(), buffers.nonzero.end(), 1);
  sparse::panel_kernels().solve(by.joining->schedule, by.L.data(), by.D.data(), by.joining->perm.data(), by.Y.data(),
                                ld, first, cols, buffers.nonzero.data(), buffers.work.data());
}

// Adds K_r^-1 B_r, times `sign`, to columns first ... first+cols-1 of row i: x.
void add_own(const OfRobot& r, int i, double sign, int first, int cols, double* x) {
  const double* p = r.P.data() + static_cast<std::ptrdiff_t>(i) * r.ld;
  for (const ByRobots::Columns& c : r.columns) {
    const int begin = std::max(c.in_X, first), end = std::min(c.in_X + c.count, first + cols);
    for (int j = begin; j < end; ++j) x[j - first] += sign * p[c.in_P + j - c.in_X];
  }
}

// A chunk of columns of a robot's rows of [da; df]. Accelerations stand together in X, forces contact by contact.
void write_robot(const OfRobot& r, const ByRobots& by, ByRobots::Buffers& buffers, int first, int cols, Panel& X) {
  const int ld = static_cast<int>(X.cols()), ldT = sparse::padded(r.size());
  const int joining = static_cast<int>(r.joining.size()), nv = r.K.nv();
  const auto at = [&](std::vector<double>& x, int i) { return x.data() + static_cast<std::ptrdiff_t>(i) * ld + first; };
  for (int j = 0; j < joining; ++j)
    std::copy_n(by.Y.data() + static_cast<std::ptrdiff_t>(r.joining[j]) * ld + first, cols, at(buffers.Yr, j));
  const auto product = sparse::panel_kernels().product;
  product(r.T.data(), ldT, at(buffers.Yr, 0), joining, nv, cols, ld, &X(r.row[0], first));
  for (int i = 0; i < nv; ++i) add_own(r, i, 1, first, cols, &X(r.row[i], first));
  if (r.size() == nv) return;
  product(r.T.data() + nv, ldT, at(buffers.Yr, 0), joining, r.size() - nv, cols, ld, at(buffers.forces, 0));
  for (int i = nv; i < r.size(); ++i) {
    add_own(r, i, -1, first, cols, at(buffers.forces, i - nv));
    std::copy_n(at(buffers.forces, i - nv), cols, &X(r.row[i], first));
  }
}

void write_joining(const ByRobots& by, int first, int cols, Panel& X) {
  for (int k = 0; k < by.joining->rows(); ++k)
    for (int j = first; j < first + cols; ++j) X(by.joining->row[k], j) = -by.Y[k * X.cols() + j];
}

// Whether every column of the sample has a componentwise backward error, with the island's K, of no more than half of
// what derivatives are allowed.
bool sample_is_good(const IslandWork& d, Workspace& w, ByRobots& by) {
  const sparse::UpperCsc& pattern = d.K.pattern->K;
  const std::size_t n = pattern.n;
  each_item(w, by.sample.column.size(), [&](std::size_t s, ThreadWork& thread) {
    ByRobots::Buffers& buffers = by.buffers[thread.number];
    sparse::panel_kernels().residual_vector(pattern, d.K.values.data(), by.sample.x.data() + s * n,
                                            by.sample.b.data() + s * n, buffers.r.data(), buffers.scale.data());
    by.sample.error[s] = sparse::componentwise_backward_error(buffers.r, buffers.scale);
  });
  return std::all_of(by.sample.error.begin(), by.sample.error.end(),
                     [](double error) { return error <= tolerance::kPanelRefined; });
}

}  // namespace

bool differentiate_by_robots(const Scene& scene, SceneData& data, IslandWork& d, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  if (!goes_by_robots(d)) return false;
  ByRobots& by = *d.by_robots;

  each_rhs(by, [&](int row, int first, int count) { std::fill_n(&out.X(row, first), count, 0.0); });
  derivative_rhs(scene, *w.linearisation, data.v, d, out);
  sample_rhs(d, out.X, by);
  each_item(w, by.robots.size(), [&](std::size_t k, ThreadWork& thread) {
    OfRobot& r = by.robots[k];
    r.sound = factorize_robot(d, k, r, thread.scratch);
    if (!r.sound) return;
    gather_joining(d, k, r);
    solve_robot(out.X, r);
  });
  if (!std::all_of(by.robots.begin(), by.robots.end(), [](const OfRobot& r) { return r.sound; })) return false;
  if (!factorize_joining(d, by)) return false;
  if (!(growth(d, by) * std::numeric_limits<double>::epsilon() <= tolerance::kConverged)) return false;
  joining_rhs(out.X, by);

  const int ld = static_cast<int>(out.X.cols());
  each_item(w, (ld + ByRobots::kChunk - 1) / ByRobots::kChunk, [&](std::size_t chunk, ThreadWork& thread) {
    const int first = static_cast<int>(chunk) * ByRobots::kChunk, cols = std::min(ByRobots::kChunk, ld - first);
    ByRobots::Buffers& buffers = by.buffers[thread.number];
    solve_joining(by, buffers, ld, first, cols);
    for (const OfRobot& r : by.robots) write_robot(r, by, buffers, first, cols, out.X);
    write_joining(by, first, cols, out.X);
    sample_answer(d, out.X, first, cols, by);
  });
  return sample_is_good(d, w, by);
}

}  // namespace manycontact::internal
