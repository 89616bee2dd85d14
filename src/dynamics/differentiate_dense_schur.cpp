#include <limits>

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

// use(row of the scene, row of the island) for each of an island's rows.
template <class Use>
void each_row(const Scene& scene, const SceneData& data, const Island& island, Use&& use) {
  for (std::size_t k = 0; k < island.robots.size(); ++k)
    for (int r = 0; r < scene.robots[island.robots[k]].model->nv; ++r)
      use(scene.robots[island.robots[k]].idx_v + r, island.dof_offset[k] + r);
  for (std::size_t k = 0; k < island.contacts.size(); ++k)
    for (int r = 0; r < scene.contacts[island.contacts[k]].rows(); ++r)
      use(scene.nv + data.f_offset[island.contacts[k]] + r, island.nv + island.row_offset[k] + r);
}

// The islands' columns side by side, as the scene has the rows; and back.
template <class Panels>
void collect(const Scene& scene, const SceneData& data, const Panels& panels, Eigen::MatrixXd& all) {
  all.setZero();
  int first = 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const int cols = data.derivatives->islands[i].cols;
    each_row(scene, data, data.islands[i].island,
             [&](int to, int from) { all.row(to).segment(first, cols) = panels(i).row(from).head(cols); });
    first += cols;
  }
}
void add_to_panels(const Scene& scene, SceneData& data, const Eigen::MatrixXd& all) {
  int first = 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandDerivatives& out = data.derivatives->islands[i];
    each_row(scene, data, data.islands[i].island,
             [&](int from, int to) { out.X.row(to).head(out.cols) += all.row(from).segment(first, out.cols); });
    first += out.cols;
  }
}

// residuals[i] <- rhs[i] - K X of each island; the largest of a column beside |K| |X| + |rhs|.
double find_residuals(const SceneData& data, const std::vector<IslandDerivatives::Panel>& rhs,
                      std::vector<IslandDerivatives::Panel>& residuals) {
  double worst = 0;
  residuals = rhs;
  for (std::size_t i = 0; i < rhs.size(); ++i) {
    const KktSystem& s = data.islands[i].system;
    const IslandDerivatives& out = data.derivatives->islands[i];
    sparse::residual_panel(s.pattern->K, s.Kx.data(), s.pattern->perm.data(), out.X.data(), residuals[i].data(),
                           static_cast<int>(out.X.cols()), out.cols);
    std::vector<double> sums(s.b.size());
    const double K = sparse::norm_1(s.pattern->K, s.Kx.data(), sums.data());
    for (int c = 0; c < out.cols; ++c) {
      const double left = residuals[i].col(c).cwiseAbs().maxCoeff();
      const double size = K * out.X.col(c).cwiseAbs().maxCoeff() + rhs[i].col(c).cwiseAbs().maxCoeff();
      if (left != 0 && !(left <= worst * size)) worst = left / size;
    }
  }
  return worst;
}

}  // namespace

void differentiate_dense_schur(const Scene& scene, SceneData& data) {
  constexpr double kSmall = 1e-13, kNoAnswer = 1e-12;  // derivatives are allowed 1000 eps cond(K)
  DenseSchurData& d = data.dense_schur;
  DerivativeData& dd = *data.derivatives;
  invert(d);
  int cols = 0;
  std::vector<IslandDerivatives::Panel> rhs;  // -dr
  for (IslandDerivatives& i : dd.islands) {
    cols += i.cols;
    rhs.push_back(i.X);
    i.X.setZero();
  }
  Eigen::MatrixXd all(d.Kinv.rows(), cols);
  std::vector<IslandDerivatives::Panel> residuals;
  // K^-1 times all right-hand sides, as Crocoddyl does; and again on what that leaves, where it lost digits: entries of
  // K^-1 may be far larger than the answer's.
  double left = 1;
  for (int step = 0; step < 3 && left > kSmall; ++step) {
    collect(
        scene, data, [&](std::size_t i) -> const auto& { return step == 0 ? rhs[i] : residuals[i]; }, all);
    add_to_panels(scene, data, d.Kinv * all);
    left = find_residuals(data, rhs, residuals);
  }
  for (IslandDerivatives& out : dd.islands) {
    if (!(left <= kNoAnswer)) out.X.setConstant(std::numeric_limits<double>::quiet_NaN());
    out.X.bottomRows(out.nc) *= -1;  // [da; -df]
  }
}

}  // namespace manycontact::internal
