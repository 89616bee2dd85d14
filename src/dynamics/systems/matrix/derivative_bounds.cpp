// Bounds of the errors of derivatives Y = [da; -df], K Y = R, column by column in the maximum norm:
//
//     |Y - Y_true| <= |K^-1| (|R - K Y| + (c eps + e) (|R| + |K| |Y|)),
//
// e the relative error of a and f, which R is computed from: every entry of R is a sum of terms that are linear in
// them.

#include <array>
#include <cmath>
#include <limits>

#include "../../internal.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

namespace manycontact::internal {

namespace {

using Rows = Eigen::VectorXd;  // of K, in the island's order

// |K| x
Rows times_sizes(const KktMatrix& K, const Rows& x) {
  const KktPattern& p = *K.pattern;
  Rows out = Rows::Zero(x.size());
  for (int j = 0; j < p.K.n; ++j)
    for (int k = p.K.p[j]; k < p.K.p[j + 1]; ++k) {
      const int row = p.perm[p.K.i[k]], column = p.perm[j];
      const double size = std::abs(K.values[k]);
      out[row] += size * x[column];
      if (row != column) out[column] += size * x[row];
    }
  return out;
}

}  // namespace

bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m,
                       const IslandDerivatives& derivatives, DerivativeBounds& out) {
  const Island& island = m.owner.island;
  IslandDerivatives R;
  lay_out(scene, island, derivatives.request, R);
  {
    const AtSolution at(scene, data, island);
    right_hand_sides(scene, data, m.owner, R);
    scale_rows(m, R);
    if (m.deficient() && m.contradiction && R.request.q && !add_contradiction(scene, data, m, R, thread.panel))
      return false;
  }
  const int ld = static_cast<int>(R.X.cols());
  if (ld == 0) return true;
  AlignedPanel Y = derivatives.X, left = R.X;  // [da; -df over S], R - K Y
  for (int k = 0; k < island.nc; ++k) Y.row(island.nv + k) *= -1 / unit_of(m, k);
  sparse::residual_panel(m.K.pattern->K, m.K.values.data(), m.K.pattern->perm.data(), Y.data(), left.data(), ld, ld);
  if (m.deficient()) m.factor->project_out_panel(left.data(), ld, ld);  // what is left of least squares

  const auto [a, f] = known_answer(scene, data, m);
  const double relative =
      tolerance::kBoundRounding * std::numeric_limits<double>::epsilon() + std::max(a.felt(), f.felt());
  const double projected = m.deficient() ? m.factor->projector_error() + f.felt() : 0;
  const auto bound_block = [&](int first, int cols, double& of_a, double& of_f) {
    if (cols == 0) return;
    const auto largest = [&](const AlignedPanel& X) -> Rows {
      return X.middleCols(first, cols).cwiseAbs().rowwise().maxCoeff();
    };
    const Rows sizes = largest(Y);
    const Rows w = largest(left) + relative * (largest(R.X) + times_sizes(m.K, sizes));
    std::vector<double> in_order(w.size());
    for (Eigen::Index k = 0; k < w.size(); ++k) in_order[m.K.pattern->iperm[k]] = w[k];
    const auto over = [](double error, double size) { return error == 0 ? 0 : error / size; };
    of_a = over(bound_of_solution(m, in_order, 0, island.nv), sizes.head(island.nv).maxCoeff());
    if (island.nc == 0 || !derivatives.request.forces) return;
    const double df = derivatives.X.block(island.nv, first, island.nc, cols).cwiseAbs().maxCoeff();
    of_f = over(bound_of_solution(m, in_order, island.nv, island.nc) + projected * df, df);
  };
  const DerivativeRequest& request = derivatives.request;
  out = {};
  bound_block(derivatives.q_first, request.q ? island.nv : 0, out.da_dq, out.dforces_dq);
  bound_block(derivatives.v_first, request.v ? island.nv : 0, out.da_dv, out.dforces_dv);
  bound_block(derivatives.u_first, request.u ? derivatives.nu : 0, out.da_du, out.dforces_du);
  return true;
}

}  // namespace manycontact::internal
