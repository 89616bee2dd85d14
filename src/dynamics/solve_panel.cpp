#include <algorithm>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

using Panel = IslandDerivatives::Panel;
using PanelRef = Eigen::Ref<Panel>;

// Above this backward error of an unrefined solve, derivatives are refined once too: below it they stay within a
// quarter of the 1000 eps cond(K) they are allowed.
constexpr double kRefineAbove = 5e-14;

// Rows (in elimination order) of a robot, and of everything its coordinates act on.
struct Reach {
  const Scene& scene;
  const IslandData& d;
  std::vector<char>& nonzero;

  void none() { std::fill_n(nonzero.begin(), d.island.size(), 0); }
  void all() { std::fill_n(nonzero.begin(), d.island.size(), 1); }
  void mark(int first, int count) {
    for (int i = first; i < first + count; ++i) nonzero[d.system.pattern->iperm[i]] = 1;
  }
  void robot(std::size_t k) { mark(d.island.dof_offset[k], scene.robots[d.island.robots[k]].model->nv); }
  // The contacts on robot k; with `bodies`, also the robots at their other ends.
  void contacts(std::size_t k, bool bodies) {
    for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
      const Contact& contact = scene.contacts[d.island.contacts[c]];
      const int r = d.island.robots[k];
      if (contact.A.robot != r && contact.B.robot != r) continue;
      mark(d.island.nv + d.island.row_offset[c], contact.rows());
      if (!bodies || contact.B.robot < 0) continue;
      robot(local_robot(d.island, contact.A.robot));
      robot(local_robot(d.island, contact.B.robot));
    }
  }
};

// By LDL: robot by robot, so that a column block meets only the rows its robot reaches.
void solve_ldl(const Scene& scene, SceneData& data, const IslandData& d, const IslandDerivatives& out, PanelRef X) {
  const KktPattern& p = *d.system.pattern;
  std::vector<char>& nonzero = data.derivatives->nonzero;
  const int ld = static_cast<int>(X.cols());
  const auto solve = [&](int first, int cols) {
    sparse::ldl_solve_panel(p.ldl, d.Lx.data(), d.D.data(), p.perm.data(), X.data(), ld, first, cols, nonzero.data());
  };
  Reach reach{scene, d, nonzero};
  if (d.island.robots.size() == 1) {
    reach.all();
    solve(0, ld);
    return;
  }
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Model& model = *scene.robots[d.island.robots[k]].model;
    const auto block = [&](bool wanted, int first, int cols, bool contacts, bool bodies) {
      if (!wanted || cols == 0) return;
      reach.none();
      reach.robot(k);
      if (contacts) reach.contacts(k, bodies);
      solve(first, cols);
    };
    block(out.request.q, out.q_first + d.island.dof_offset[k], model.nv, true, true);
    block(out.request.v, out.v_first + d.island.dof_offset[k], model.nv, true, false);
    block(out.request.u, out.u_first + out.u_offset[k], out.u_offset[k + 1] - out.u_offset[k], false, false);
  }
}

// By a factor that takes columns in elimination order.
void solve_columns(const Scene& scene, IslandData& d, int cols, PanelRef X) {
  const std::vector<int>& perm = d.system.pattern->perm;
  const int n = d.island.size();
  Eigen::MatrixXd B(n, cols);
  for (int k = 0; k < n; ++k) B.row(k) = X.row(perm[k]).head(cols);
  if (d.factor == Factor::kCholmod)
    d.cholmod->solve(B.data(), cols);
  else
    for (int c = 0; c < cols; ++c) solve_with_factor(scene, d, B.col(c).data());
  for (int k = 0; k < n; ++k) X.row(perm[k]).head(cols) = B.row(k);
}

void solve_dense(const IslandData& d, int cols, PanelRef X) {
  const int nv = d.island.nv, nc = d.island.nc;
  const Eigen::MatrixXd b1 = X.topLeftCorner(nv, cols), b2 = X.block(nv, 0, nc, cols);
  Eigen::MatrixXd a, f;
  solve<double>(*d.dense, b1, b2, a, f);
  X.topLeftCorner(nv, cols) = a;
  X.block(nv, 0, nc, cols) = -f;
}

// By LDL without the dependent rows, between two projections.
void solve_dependent(SceneData& data, IslandData& d, PanelRef X) {
  const KktPattern& p = *d.system.pattern;
  const int ld = static_cast<int>(X.cols());
  sparse::project_out_panel(d.rows, p.perm.data(), X.data(), ld, 0, ld);
  std::fill_n(data.derivatives->nonzero.begin(), d.island.size(), 1);
  sparse::ldl_solve_panel(p.ldl, d.Lx.data(), d.D.data(), p.perm.data(), X.data(), ld, 0, ld,
                          data.derivatives->nonzero.data());
  sparse::project_out_panel(d.rows, p.perm.data(), X.data(), ld, 0, ld);
}

void solve_once(const Scene& scene, SceneData& data, IslandData& d, const IslandDerivatives& out, PanelRef X) {
  switch (d.factor) {
    case Factor::kLdl:
      return solve_ldl(scene, data, d, out, X);
    case Factor::kDependent:
      return solve_dependent(data, d, X);
    case Factor::kDense:
      return solve_dense(d, out.cols, X);
    default:
      return solve_columns(scene, d, out.cols, X);
  }
}

}  // namespace

void solve_panel(const Scene& scene, SceneData& data, IslandData& d, IslandDerivatives& out) {
  if (out.cols == 0 || d.island.size() == 0) return;
  data.derivatives->nonzero.resize(std::max<std::size_t>(data.derivatives->nonzero.size(), d.island.size()));
  const bool refine = d.factor != Factor::kDense && d.first_error > kRefineAbove;
  // Memory for refinement is taken before any is needed: a later state may need it, and must not allocate.
  Eigen::VectorXd& memory = data.derivatives->rhs;
  if (d.factor != Factor::kDense && memory.size() < out.X.size()) memory.resize(out.X.size());
  Eigen::Map<Panel> R(memory.data(), refine ? out.X.rows() : 0, out.X.cols());
  if (refine) R = out.X;
  solve_once(scene, data, d, out, out.X);
  if (!refine) return;
  const KktPattern& p = *d.system.pattern;
  sparse::residual_panel(p.K, d.system.Kx.data(), p.perm.data(), out.X.data(), R.data(), static_cast<int>(out.X.cols()),
                         out.cols);
  const bool one_robot = d.island.robots.size() == 1 || d.factor != Factor::kLdl;
  if (one_robot) {
    solve_once(scene, data, d, out, R);
  } else {  // a residual has no zero rows
    std::fill_n(data.derivatives->nonzero.begin(), d.island.size(), 1);
    sparse::ldl_solve_panel(p.ldl, d.Lx.data(), d.D.data(), p.perm.data(), R.data(), static_cast<int>(R.cols()), 0,
                            static_cast<int>(R.cols()), data.derivatives->nonzero.data());
  }
  out.X += R;
}

}  // namespace manycontact::internal
