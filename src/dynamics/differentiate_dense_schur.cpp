#include "internal.hpp"

namespace manycontact::internal {

namespace {

// K^-1 = [Mi - Y Si Y^T, Y Si; Si Y^T, -Si] with Mi = M^-1, Y = Mi J^T, Si = S^-1, written out in full.
void invert(DenseSchurData& d) {
  const Eigen::Index nv = d.M.rows(), nc = d.J.rows();
  d.Kinv.resize(nv + nc, nv + nc);
  auto Mi = d.Kinv.topLeftCorner(nv, nv);
  Mi = d.llt_M.solve(Eigen::MatrixXd::Identity(nv, nv));
  if (nc == 0) return;
  const Eigen::MatrixXd Y = Mi * d.J.transpose();
  const Eigen::MatrixXd Si = d.llt_S.solve(Eigen::MatrixXd::Identity(nc, nc));
  d.Kinv.topRightCorner(nv, nc).noalias() = Y * Si;
  Mi.noalias() -= d.Kinv.topRightCorner(nv, nc) * Y.transpose();
  d.Kinv.bottomLeftCorner(nc, nv) = d.Kinv.topRightCorner(nv, nc).transpose();
  d.Kinv.bottomRightCorner(nc, nc) = -Si;
}

// Newton's step for the inverse: X <- X (2 I - K X).
void refine_inverse(double delta, DenseSchurData& d) {
  const Eigen::Index nv = d.M.rows(), nc = d.J.rows();
  Eigen::MatrixXd K(nv + nc, nv + nc);
  K << d.M, d.J.transpose(), d.J, -delta * Eigen::MatrixXd::Identity(nc, nc);
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(nv + nc, nv + nc) - K * d.Kinv;
  d.Kinv += (d.Kinv * left).eval();
}

}  // namespace

void differentiate_dense_schur(const Scene& scene, SceneData& data) {
  DenseSchurData& d = data.dense_schur;
  DerivativeData& dd = *data.derivatives;
  invert(d);
  if (d.refined) refine_inverse(scene.damping, d);
  // The whole scene's -dr: islands' panels hold theirs.
  int cols = 0;
  for (const IslandDerivatives& i : dd.islands) cols += i.cols;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(d.Kinv.rows(), cols);
  const auto each_row = [&](std::size_t i, auto&& use) {  // use(row of the scene, row of the island)
    const Island& island = data.islands[i].island;
    for (std::size_t k = 0; k < island.robots.size(); ++k)
      for (int r = 0; r < scene.robots[island.robots[k]].model->nv; ++r)
        use(scene.robots[island.robots[k]].idx_v + r, island.dof_offset[k] + r);
    for (std::size_t k = 0; k < island.contacts.size(); ++k)
      for (int r = 0; r < scene.contacts[island.contacts[k]].rows(); ++r)
        use(scene.nv + data.f_offset[island.contacts[k]] + r, island.nv + island.row_offset[k] + r);
  };
  int first = 0;
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    const IslandDerivatives& out = dd.islands[i];
    each_row(i, [&](int to, int from) { rhs.row(to).segment(first, out.cols) = out.X.row(from).head(out.cols); });
    first += out.cols;
  }
  const Eigen::MatrixXd x = d.Kinv * rhs;
  first = 0;
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    IslandDerivatives& out = dd.islands[i];
    each_row(i, [&](int from, int to) { out.X.row(to).head(out.cols) = x.row(from).segment(first, out.cols); });
    out.X.bottomRows(out.nc) *= -1;  // [da; -df]
    first += out.cols;
  }
}

}  // namespace manycontact::internal
