// Bounds of the errors of derivatives Y = [da; -df], K Y = R, column by column in the maximum norm:
//
//     |Y - Y_true| <= |K^-1| (|R - K Y| + (c eps + e) (|R| + |K| |Y|)),
//
// e the relative error of a and f, which R is computed from: every entry of R is a sum of terms that are linear in
// them.

#include <limits>

#include "../../internal.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

namespace manycontact::internal {

bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m,
                       const IslandDerivatives& derivatives, DerivativeBounds& out) {
  const Island& island = m.owner.island;
  IslandDerivatives R;
  lay_out(scene, island, derivatives.request, R);
  {
    const AtSolution at(scene, data, island);
    if (!weighed_right_hand_sides(scene, data, m, R, thread.panel)) return false;
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
  const std::vector<double> none(island.size(), 0.0);
  std::vector<double> sizes(island.size()), rest(island.size()), w(island.size());  // in order of elimination
  const auto bound_block = [&](int first, int cols, double& of_a, double& of_f) {
    if (cols == 0) return;
    const auto largest = [&](const AlignedPanel& X, int row) {
      return X.row(row).segment(first, cols).cwiseAbs().maxCoeff();
    };
    const KktPattern& p = *m.K.pattern;
    for (int k = 0; k < island.size(); ++k) sizes[p.iperm[k]] = largest(Y, k);
    sparse::residual(p.K, m.K.values.data(), sizes.data(), none.data(), rest.data(), w.data());  // w = |K| sizes
    for (int k = 0; k < island.size(); ++k) {
      double& of_row = w[p.iperm[k]];
      of_row = largest(left, k) + relative * (largest(R.X, k) + of_row);
    }
    const double da = derivatives.X.block(0, first, island.nv, cols).cwiseAbs().maxCoeff();
    of_a = Known{da, bound_of_solution(m, w, 0, island.nv)}.relative();
    if (island.nc == 0 || !derivatives.request.forces) return;
    const double df = derivatives.X.block(island.nv, first, island.nc, cols).cwiseAbs().maxCoeff();
    of_f = Known{df, bound_of_solution(m, w, island.nv, island.nc) + projected * df}.relative();
  };
  const DerivativeRequest& request = derivatives.request;
  out = {};
  bound_block(derivatives.q_first, request.q ? island.nv : 0, out.da_dq, out.dforces_dq);
  bound_block(derivatives.v_first, request.v ? island.nv : 0, out.da_dv, out.dforces_dv);
  bound_block(derivatives.u_first, request.u ? derivatives.nu : 0, out.da_du, out.dforces_du);
  return true;
}

}  // namespace manycontact::internal
