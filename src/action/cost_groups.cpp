#include "manycontact/action/cost_groups.hpp"

#include <algorithm>
#include <map>

#include "manycontact/action/cost.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact {

namespace {

std::vector<CostGroup::Run> runs_of(const std::vector<int>& columns) {
  std::vector<CostGroup::Run> runs;
  for (int k = 0; k < static_cast<int>(columns.size()); ++k)
    if (k > 0 && columns[k] == columns[k - 1] + 1)
      ++runs.back().count;
    else
      runs.push_back({columns[k], k, 1});
  return runs;
}

const ResidualBlock& block_of(const CostGroup::Member& member) { return member.cost->residual->blocks[member.block]; }

}  // namespace

void CostGroups::lay_out(const std::vector<const CostDataResidual*>& costs, CostDerivatives& out) {
  groups.clear();
  std::map<std::pair<std::vector<int>, std::vector<int>>, std::size_t> known;
  for (std::size_t c = 0; c < costs.size(); ++c)
    for (std::size_t k = 0; k < costs[c]->residual->blocks.size(); ++k) {
      const ResidualBlock& b = costs[c]->residual->blocks[k];
      const auto [group, is_new] = known.try_emplace({b.xcols, b.ucols}, groups.size());
      if (is_new) groups.push_back({b.xcols, b.ucols, {}, runs_of(b.xcols), runs_of(b.ucols)});
      groups[group->second].members.push_back({costs[c], c, k});
    }
  for (BlockSparse* m : {&out.Lxx_blocks, &out.Lxu_blocks, &out.Luu_blocks}) m->clear();
  std::size_t most = 0, widest = 0;
  for (CostGroup& g : groups) {
    if (out.storage != MatrixStorage::kDense) {
      g.xx = out.Lxx_blocks.plan(g.xcols, g.xcols);
      g.xu = out.Lxu_blocks.plan(g.xcols, g.ucols);
      g.uu = out.Luu_blocks.plan(g.ucols, g.ucols);
    }
    std::size_t rows = 0;
    for (const CostGroup::Member& member : g.members) rows += block_of(member).rows.size();
    const std::size_t ld = sparse::padded(g.xcols.size() + g.ucols.size() + 1);
    most = std::max(most, rows * ld);
    widest = std::max(widest, ld);
  }
  L.assign(most, 0);
  R.assign(most, 0);
  H.assign(widest * widest, 0);
}

namespace {

// The group has one column, and its blocks one row: a sum of squares.
void add_squares(const CostGroup& g, const std::vector<double>& weights, bool terminal, CostDerivatives& out) {
  const bool by_x = !g.xcols.empty();
  if (terminal && !by_x) return;
  double gradient = 0, square = 0;
  for (const CostGroup::Member& member : g.members) {
    const double w = weights[member.index];
    const ResidualBlock& b = block_of(member);
    const ActivationDataAbstract& a = *member.cost->activation;
    const RowMajorMatrix& J = by_x ? b.Rx : b.Ru;
    for (std::size_t i = 0; i < b.rows.size() && w != 0; ++i) {
      gradient += w * a.Ar[b.rows[i]] * J(i, 0);
      square += w * a.Arr.diagonal()[b.rows[i]] * J(i, 0) * J(i, 0);
    }
  }
  const int c = by_x ? g.xcols[0] : g.ucols[0];
  (by_x ? out.Lx : out.Lu)[c] += gradient;
  if (out.storage != MatrixStorage::kSparse) (by_x ? out.Lxx : out.Luu)(c, c) += square;
  if (out.storage != MatrixStorage::kDense)
    (by_x ? out.Lxx_blocks : out.Luu_blocks).add(by_x ? g.xx : g.uu, 1, Eigen::Matrix<double, 1, 1>(square));
}

// The lower triangle of a symmetric matrix of which the upper one is known; ld: a multiple of eight.
void mirror(double* H, int n, int ld) {
  using Tile = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;
  using Place = Eigen::Map<Tile, 0, Eigen::OuterStride<>>;
  for (int i = 0; i < n; i += 8) {
    Place(H + i * ld + i, Eigen::OuterStride<>(ld)).triangularView<Eigen::StrictlyLower>() =
        Tile(Place(H + i * ld + i, Eigen::OuterStride<>(ld))).transpose();
    for (int j = i + 8; j < n; j += 8)
      Place(H + j * ld + i, Eigen::OuterStride<>(ld)) = Place(H + i * ld + j, Eigen::OuterStride<>(ld)).transpose();
  }
}

using Columns = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

void add_dense(const Columns& values, const std::vector<CostGroup::Run>& rows, const std::vector<int>& cols,
               Eigen::MatrixXd& out) {
  for (std::size_t j = 0; j < cols.size(); ++j)
    for (const CostGroup::Run& run : rows)
      out.col(cols[j]).segment(run.first, run.count) += values.col(j).segment(run.at, run.count);
}

void add_gradient(const double* gradient, int ld, const std::vector<int>& cols, Eigen::VectorXd& out) {
  for (std::size_t j = 0; j < cols.size(); ++j) out[cols[j]] += gradient[j * ld];
}

}  // namespace

// Rows that weigh nothing, of barriers say, are left out. Returns the number of the others.
int CostGroups::gather(const CostGroup& g, const std::vector<double>& weights, int nx, int nu, int ld) {
  int depth = 0;
  for (const CostGroup::Member& member : g.members) {
    const double w = weights[member.index];
    if (w == 0) continue;
    const ResidualBlock& b = block_of(member);
    const auto& Ar = member.cost->activation->Ar;
    const auto& Arr = member.cost->activation->Arr.diagonal();
    for (std::size_t i = 0; i < b.rows.size(); ++i) {
      const double first = w * Ar[b.rows[i]], second = w * Arr[b.rows[i]];
      if (first == 0 && second == 0) continue;
      double *l = L.data() + depth * ld, *r = R.data() + depth * ld;
      std::copy_n(b.Rx.data() + i * b.Rx.cols(), nx, l);
      std::copy_n(b.Ru.data() + i * b.Ru.cols(), nu, l + nx);
      for (int j = 0; j < nx + nu; ++j) r[j] = second * l[j];
      r[nx + nu] = first;
      ++depth;
    }
  }
  return depth;
}

void CostGroups::add(const std::vector<double>& weights, bool terminal, CostDerivatives& out) {
  for (const CostGroup& g : groups) {
    if (g.xcols.size() + g.ucols.size() == 1) {
      add_squares(g, weights, terminal, out);
      continue;
    }
    const int nx = static_cast<int>(g.xcols.size()), nu = terminal ? 0 : static_cast<int>(g.ucols.size());
    const int n = nx + nu, ld = sparse::padded(n + 1);
    if (n == 0) continue;
    const int depth = gather(g, weights, nx, nu, ld);
    if (depth == 0) continue;
    sparse::panel_kernels().upper_product(L.data(), R.data(), depth, n + 1, ld, H.data());
    mirror(H.data(), n, ld);
    add_gradient(H.data() + n, ld, g.xcols, out.Lx);
    const Columns xx(H.data(), nx, nx, Eigen::OuterStride<>(ld)),
        xu(H.data() + nx * ld, nx, nu, Eigen::OuterStride<>(ld)),
        uu(H.data() + nx * ld + nx, nu, nu, Eigen::OuterStride<>(ld));
    if (out.storage != MatrixStorage::kSparse) add_dense(xx, g.xruns, g.xcols, out.Lxx);
    if (out.storage != MatrixStorage::kDense) out.Lxx_blocks.add(g.xx, 1, xx);
    if (nu == 0) continue;
    add_gradient(H.data() + nx * ld + n, ld, g.ucols, out.Lu);
    if (out.storage != MatrixStorage::kSparse) {
      add_dense(xu, g.xruns, g.ucols, out.Lxu);
      add_dense(uu, g.uruns, g.ucols, out.Luu);
    }
    if (out.storage != MatrixStorage::kDense) {
      out.Lxu_blocks.add(g.xu, 1, xu);
      out.Luu_blocks.add(g.uu, 1, uu);
    }
  }
}

}  // namespace manycontact
