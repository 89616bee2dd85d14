#include <algorithm>
#include <limits>

#include "../../internal.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

namespace manycontact::internal {

namespace {

// Flags the rows of K, in elimination order, in which right-hand sides may be nonzero: rows of a robot, of its
// contacts, and of the robots at the contacts' other ends.
struct Reach {
  const Scene& scene;
  const Island& island;
  const int* iperm;
  std::vector<char>& nonzero;

  void none() { std::fill_n(nonzero.begin(), island.size(), 0); }
  void mark(int first, int count) {
    for (int i = first; i < first + count; ++i) nonzero[iperm[i]] = 1;
  }
  void robot(std::size_t k) { mark(island.dof_offset[k], scene.robots[island.robots[k]].model->nv); }
  // Marks the contacts on robot k and, if `bodies`, the robots at the other ends of these contacts.
  void contacts(std::size_t k, bool bodies) {
    for (std::size_t c = 0; c < island.contacts.size(); ++c) {
      const Contact& contact = scene.contacts[island.contacts[c]];
      const int r = island.robots[k];
      if (contact.A.robot != r && contact.B.robot != r) continue;
      mark(island.nv + island.row_offset[c], contact.rows());
      if (!bodies || !joins_robots(contact)) continue;
      robot(local_robot(island, contact.A.robot));
      robot(local_robot(island, contact.B.robot));
    }
  }
};

constexpr int kChunk = 64;  // largest number of columns that any factor processes at a time

void solve_chunk(MatrixSystem& m, double* X, int ld, int first, int cols, bool refined, PanelWork& work) {
  if (refined)
    m.factor->solve_panel_refined(m.K, X, ld, first, cols, work);
  else
    m.factor->solve_panel(X, ld, first, cols, work.nonzero.data());
}

// Solves for the panel out.X in chunks of columns. Each chunk visits only rows with nonzero right-hand sides and those
// that they fill in.
void solve_blocks(const Scene& scene, MatrixSystem& m, IslandDerivatives& out, bool refined, PanelWork& work) {
  const Island& island = m.owner.island;
  const int ld = static_cast<int>(out.X.cols());
  const auto solve = [&](int first, int cols) { solve_chunk(m, out.X.data(), ld, first, cols, refined, work); };
  if (island.robots.size() == 1) {
    std::fill_n(work.nonzero.begin(), island.size(), 1);
    return solve(0, ld);
  }
  Reach reach{scene, island, m.K.pattern->iperm.data(), work.nonzero};
  for (int begin = 0; begin < out.cols; begin += kChunk) {
    const int end = std::min(begin + kChunk, ld);
    reach.none();
    for (std::size_t k = 0; k < island.robots.size(); ++k) {
      const int nv = scene.robots[island.robots[k]].model->nv;
      const auto block = [&](bool wanted, int first, int cols, bool contacts, bool bodies) {
        if (!wanted || first >= end || first + cols <= begin) return;
        reach.robot(k);
        if (contacts) reach.contacts(k, bodies);
      };
      block(out.request.q, out.q_first + island.dof_offset[k], nv, true, true);
      block(out.request.v, out.v_first + island.dof_offset[k], nv, true, false);
      block(out.request.u, out.u_first + out.u_offset[k], out.u_offset[k + 1] - out.u_offset[k], false, false);
    }
    solve(begin, end - begin);
  }
}

bool grows_too_much(const Factor& factor) {  // whether each solution needs a check by its own residual
  return factor.growth() * std::numeric_limits<double>::epsilon() > tolerance::kConverged;
}

// Returns |r| / (|K|_1 |x| + |b|), r = b - K x, as refine_panel does for each column. Overwrites v.scale.
double normwise_error(const MatrixSystem& m, KktVectors& v) {
  const double norm = sparse::norm_1(m.K.pattern->K, m.K.values.data(), v.scale.data());
  const bool dependent = m.deficient();  // r then contains the least-squares residual, here subtracted
  double r = 0, x = 0, b = 0;
  for (std::size_t k = 0; k < v.x.size(); ++k) {
    r = sparse::larger_or_nan(r, std::abs(dependent ? v.r[k] - v.null_component[k] : v.r[k]));
    x = std::max(x, std::abs(v.x[k]));
    b = std::max(b, std::abs(v.b[k]));
  }
  return r <= tolerance::kVanishing ? 0 : r / (norm * x + b);
}

template <class T>
void reserve(std::vector<T>& memory, std::size_t size) {
  if (memory.size() < size) memory.resize(size);
}

// Whether a panel is accurate unrefined, by the error of the solve before refinement or a bound for all columns. With
// redundant rows neither suffices: projecting large entries leaves rounding errors above small entries.
bool needs_no_refinement(MatrixSystem& m) {
  if (m.factor->own_refinements() > 0) return true;
  if (m.deficient()) return false;
  return m.first_error <= tolerance::kRefinePanel || m.factor->panel_error(m.K) <= tolerance::kRefinePanel;
}

// Solves and refines the panel's columns one by one, by componentwise errors; normwise_error then judges each column.
// With dependent rows and a factor with large growth, norms of a whole panel would hide errors of small entries.
// Returns false if a column is inaccurate.
bool solve_one_by_one(MatrixSystem& m, double* X, int ld, KktVectors& v) {
  const KktPattern& p = *m.K.pattern;
  v.resize(p.size());
  for (int c = 0; c < ld; ++c) {
    for (int k = 0; k < p.size(); ++k) v.b[k] = X[static_cast<std::ptrdiff_t>(p.perm[k]) * ld + c];
    if (std::all_of(v.b.begin(), v.b.end(), [](double b) { return b == 0; })) continue;
    (void)m.factor->solve_refined(m.K, v, tolerance::kRefinementSteps);
    if (!(normwise_error(m, v) <= tolerance::kConverged)) return false;
    for (int k = 0; k < p.size(); ++k) X[static_cast<std::ptrdiff_t>(p.perm[k]) * ld + c] = v.x[k];
  }
  return true;
}

// Overwrites a panel X by K^+ X, row stride ld. solve(refined): solves, refined or not. Returns whether X is accurate.
template <class Solve>
bool solve_as_needed(MatrixSystem& m, double* X, int ld, PanelWork& work, Solve&& solve) {
  const std::size_t size = static_cast<std::size_t>(m.owner.island.size()) * ld;
  // Memory for refinement is allocated at the first call, as later calls must not allocate.
  reserve(work.nonzero, m.owner.island.size());
  reserve(work.B, size);
  reserve(work.R, size);
  const bool few = m.owner.island.size() < tolerance::kOneByOne, grows = grows_too_much(*m.factor);
  if (few) work.column.resize(m.owner.island.size());
  if (few && grows && m.deficient() && m.factor->own_refinements() == 0) return solve_one_by_one(m, X, ld, work.column);
  const bool once_is_enough = !grows || (!m.deficient() && m.factor->growth() <= tolerance::kMostGrowth);
  if (m.factor->panel_is_like_solve() && once_is_enough) {
    solve(grows || !needs_no_refinement(m));
    return true;
  }
  std::copy_n(X, size, work.B.data());
  solve(false);
  return m.factor->own_refinements() > 0 || refine_panel(*m.factor, m.K, X, ld, work) <= tolerance::kConverged;
}

}  // namespace

void solve_panel(const Scene& scene, MatrixSystem& m, IslandDerivatives& out, PanelWork& work) {
  if (out.cols == 0 || m.owner.island.size() == 0) return;
  const bool believed = solve_as_needed(m, out.X.data(), static_cast<int>(out.X.cols()), work,
                                        [&](bool refined) { solve_blocks(scene, m, out, refined, work); });
  if (!believed) out.X.setConstant(std::numeric_limits<double>::quiet_NaN());
}

bool solve_columns(MatrixSystem& m, double* X, int ld, PanelWork& work) {
  return solve_as_needed(m, X, ld, work, [&](bool refined) {
    std::fill_n(work.nonzero.begin(), m.owner.island.size(), 1);
    solve_chunk(m, X, ld, 0, ld, refined, work);
  });
}

bool solve_vector(MatrixSystem& m, KktVectors& v) {
  const bool judged = m.factor->own_refinements() == 0 && grows_too_much(*m.factor);
  const int steps = !judged ? 1 : m.deficient() ? tolerance::kRefinementSteps : tolerance::kPanelSteps - 1;
  (void)m.factor->solve_refined(m.K, v, steps);
  if (!judged || normwise_error(m, v) <= tolerance::kConverged) return true;
  std::fill(v.x.begin(), v.x.end(), std::numeric_limits<double>::quiet_NaN());
  return false;
}

}  // namespace manycontact::internal
