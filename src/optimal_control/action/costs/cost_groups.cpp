#include "manycontact/detail/action/cost_groups.hpp"

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

bool is_square(const CostGroup& g) { return g.xcols.size() + g.ucols.size() == 1; }

struct Scratch {             // workspace for one group of costs
  std::vector<double> L, R;  // row-major: L = [Rx Ru], R = [w Arr Rx, w Arr Ru, w Ar]
  std::vector<double> H;     // L^T R: the Hessian, with the gradient in its last column
};

const ResidualBlock& block_of(const CostGroup::Member& member) { return member.cost->residual->blocks[member.block]; }

// Throws std::invalid_argument if a user-defined calcDiff has resized the cost's derivatives.
void check_sizes(const CostDataAbstract& d, const CostDerivatives& out, bool terminal) {
  const Eigen::Index nx = out.Lx.size(), nu = out.Lu.size();
  const auto is = [](const Eigen::MatrixXd& M, Eigen::Index rows, Eigen::Index cols) {
    return M.rows() == rows && M.cols() == cols;
  };
  const bool of_x = d.Lx.size() == nx && is(d.Lxx, nx, nx);
  require(of_x && (terminal || (d.Lu.size() == nu && is(d.Lxu, nx, nu) && is(d.Luu, nu, nu))), "CostModelSum::calcDiff",
          "the calcDiff of a cost changed the size of Lx, Lu, Lxx, Lxu or Luu, unchanged sizes are expected");
}

// Copies the upper triangle of a symmetric row-major matrix to the lower triangle. ld: its row length, a multiple of 8.
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

// Copies the rows of a group into L and R, except for rows of zero weight (inactive barriers). Returns their number.
int gather(const CostGroup& g, const std::vector<double>& weights, int nx, int nu, int ld, Scratch& work) {
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
      double *l = work.L.data() + depth * ld, *r = work.R.data() + depth * ld;
      std::copy_n(b.Rx.data() + i * b.Rx.cols(), nx, l);
      std::copy_n(b.Ru.data() + i * b.Ru.cols(), nu, l + nx);
      for (int j = 0; j < nx + nu; ++j) r[j] = second * l[j];
      r[nx + nu] = first;
      ++depth;
    }
  }
  return depth;
}

}  // namespace

void CostGroups::lay_out(const std::vector<const CostDataAbstract*>& costs, int ndx, int nu, CostDerivatives& out) {
  groups.clear();
  squares.clear();
  own.clear();
  std::map<std::pair<std::vector<int>, std::vector<int>>, std::size_t> known;
  for (std::size_t c = 0; c < costs.size(); ++c) {
    if (costs[c]->own) {
      own.push_back({costs[c], c});
      continue;
    }
    for (std::size_t k = 0; k < costs[c]->residual->blocks.size(); ++k) {
      const ResidualBlock& b = costs[c]->residual->blocks[k];
      const auto [group, is_new] = known.try_emplace({b.xcols, b.ucols}, groups.size());
      if (is_new) groups.push_back({b.xcols, b.ucols, {}, runs_of(b.xcols), runs_of(b.ucols)});
      groups[group->second].members.push_back({costs[c], c, k});
    }
  }
  for (BlockSparse* m : {&out.Lxx_blocks, &out.Lxu_blocks, &out.Luu_blocks}) m->clear();
  most_ = widest_ = 0;
  lay_out_own(ndx, nu, out);
  for (CostGroup& g : groups) {
    if (has_blocks(out.storage)) {
      g.xx = out.Lxx_blocks.plan(g.xcols, g.xcols);
      g.xu = out.Lxu_blocks.plan(g.xcols, g.ucols);
      g.uu = out.Luu_blocks.plan(g.ucols, g.ucols);
    }
    if (is_square(g)) {
      take_squares(g);
      continue;
    }
    std::size_t rows = 0;
    for (const CostGroup::Member& member : g.members) rows += block_of(member).rows.size();
    const std::size_t ld = sparse::padded(g.xcols.size() + g.ucols.size() + 1);
    most_ = std::max(most_, rows * ld);
    widest_ = std::max(widest_, ld);
  }
  std::erase_if(groups, is_square);
  out.Lxx_blocks.finish(ndx, ndx);
  out.Lxu_blocks.finish(ndx, nu);
  out.Luu_blocks.finish(nu, nu);
  if (has_blocks(out.storage))
    for (CostSquare& s : squares) s.entry = (s.by_x ? out.Lxx_blocks : out.Luu_blocks).entry(s.entry);
}

void CostGroups::lay_out_own(int ndx, int nu, CostDerivatives& out) {
  if (own.empty() || !has_blocks(out.storage)) return;
  const std::vector<int> x = internal::range(0, ndx), u = internal::range(0, nu);
  for (OwnCost& o : own) {
    o.xx = out.Lxx_blocks.plan(x, x);
    o.xu = out.Lxu_blocks.plan(x, u);
    o.uu = out.Luu_blocks.plan(u, u);
  }
}

void CostGroups::take_squares(const CostGroup& g) {
  const bool by_x = !g.xcols.empty();
  for (const CostGroup::Member& member : g.members) {
    const ResidualBlock& b = block_of(member);
    const RowMajorMatrix& J = by_x ? b.Rx : b.Ru;
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      squares.push_back({member.cost, b.constant ? nullptr : &J, J.data()[i], static_cast<int>(i),
                         static_cast<int>(member.index), b.rows[i], by_x ? g.xcols[0] : g.ucols[0], by_x,
                         by_x ? g.xx : g.uu});
  }
}

void CostGroups::add_squares(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const {
  const bool dense = has_dense(out.storage), blocks = has_blocks(out.storage);
  double *xx = out.Lxx_blocks.matrix.valuePtr(), *uu = out.Luu_blocks.matrix.valuePtr();
  for (const CostSquare& s : squares) {
    const double w = weights[s.index];
    if (w == 0 || (terminal && !s.by_x)) continue;
    const ActivationDataAbstract& a = *s.cost->activation;
    const double J = s.J ? s.J->data()[s.at] : s.constant, square = w * a.Arr.diagonal()[s.row] * J * J;
    (s.by_x ? out.Lx : out.Lu)[s.column] += w * a.Ar[s.row] * J;
    if (dense) (s.by_x ? out.Lxx : out.Luu)(s.column, s.column) += square;
    if (blocks) (s.by_x ? xx : uu)[s.entry] += square;
  }
}

void CostGroups::add_own(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const {
  const bool dense = has_dense(out.storage), blocks = has_blocks(out.storage);
  for (const OwnCost& o : own) {
    const double w = weights[o.index];
    if (w == 0) continue;
    const CostDataAbstract& d = *o.cost;
    check_sizes(d, out, terminal);
    out.Lx += w * d.Lx;
    if (dense) out.Lxx += w * d.Lxx;
    if (blocks) out.Lxx_blocks.add(o.xx, w, d.Lxx);
    if (terminal) continue;
    out.Lu += w * d.Lu;
    if (dense) out.Lxu += w * d.Lxu, out.Luu += w * d.Luu;
    if (blocks) out.Lxu_blocks.add(o.xu, w, d.Lxu), out.Luu_blocks.add(o.uu, w, d.Luu);
  }
}

void CostGroups::add(const std::vector<double>& weights, bool terminal, CostDerivatives& out) {
  add_squares(weights, terminal, out);
  add_own(weights, terminal, out);
  thread_local Scratch work;  // all nodes that a thread evaluates share one workspace, so that it remains in the cache
  for (auto* rows : {&work.L, &work.R})
    if (rows->size() < most_) rows->resize(most_);
  if (work.H.size() < widest_ * widest_) work.H.resize(widest_ * widest_);
  double* H = work.H.data();
  for (const CostGroup& g : groups) {
    const int nx = static_cast<int>(g.xcols.size()), nu = terminal ? 0 : static_cast<int>(g.ucols.size());
    const int n = nx + nu, ld = sparse::padded(n + 1);
    if (n == 0) continue;
    const int depth = gather(g, weights, nx, nu, ld, work);
    if (depth == 0) continue;
    sparse::panel_kernels().upper_product(work.L.data(), work.R.data(), depth, n + 1, ld, H);
    mirror(H, n, ld);
    add_gradient(H + n, ld, g.xcols, out.Lx);
    const Columns xx(H, nx, nx, Eigen::OuterStride<>(ld)), xu(H + nx * ld, nx, nu, Eigen::OuterStride<>(ld)),
        uu(H + nx * ld + nx, nu, nu, Eigen::OuterStride<>(ld));
    if (has_dense(out.storage)) add_dense(xx, g.xruns, g.xcols, out.Lxx);
    if (has_blocks(out.storage)) out.Lxx_blocks.add(g.xx, 1, xx);
    if (nu == 0) continue;
    add_gradient(H + nx * ld + n, ld, g.ucols, out.Lu);
    if (has_dense(out.storage)) {
      add_dense(xu, g.xruns, g.ucols, out.Lxu);
      add_dense(uu, g.uruns, g.ucols, out.Luu);
    }
    if (has_blocks(out.storage)) {
      out.Lxu_blocks.add(g.xu, 1, xu);
      out.Luu_blocks.add(g.uu, 1, uu);
    }
  }
}

}  // namespace manycontact
