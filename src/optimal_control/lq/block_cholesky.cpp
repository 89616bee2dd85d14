#include "manycontact/lq/block_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "dense.hpp"

namespace manycontact::lq {

namespace {

// Returns for each column of L the blocks below the diagonal, including fill-in from earlier columns.
std::vector<std::set<int>> fill(int n, const std::vector<std::pair<int, int>>& edges) {
  std::vector<std::set<int>> below(n);
  for (const auto& [u, v] : edges)
    if (u != v) below[std::min(u, v)].insert(std::max(u, v));
  for (int v = 0; v < n; ++v)
    if (!below[v].empty()) {
      const int parent = *below[v].begin();
      below[parent].insert(std::next(below[v].begin()), below[v].end());
    }
  return below;
}

}  // namespace

double block_cholesky_flops(const std::vector<BlockCholesky::Vertex>& vertices,
                            const std::vector<std::pair<int, int>>& edges) {
  const auto below = fill(static_cast<int>(vertices.size()), edges);
  double flops = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const double p = vertices[v].size;
    double r = 0;
    for (int u : below[v]) r += vertices[u].size;
    flops += p * p * p / 3 + p * p * r + p * r * r;
  }
  return flops;
}

void BlockCholesky::analyse(std::vector<Vertex> vertices, const std::vector<std::pair<int, int>>& edges) {
  vertices_ = std::move(vertices);
  const auto below = fill(static_cast<int>(vertices_.size()), edges);
  start_.assign(1, 0);
  for (const Vertex& v : vertices_) start_.push_back(start_.back() + v.size);
  columns_.assign(vertices_.size(), {});
  largest_ = VectorXd::Zero(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    Column& column = columns_[v];
    int rows = 0;
    for (int u : below[v]) {
      column.below.push_back({u, rows});
      rows += vertices_[u].size;
    }
    column.diagonal = MatrixXd::Zero(vertices_[v].size, vertices_[v].size);
    column.panel = MatrixXd::Zero(rows, vertices_[v].size);
  }
}

void BlockCholesky::set_zero() {
  for (Column& column : columns_) {
    column.diagonal.setZero();
    column.panel.setZero();
  }
}

Eigen::Ref<MatrixXd> BlockCholesky::block(int u, int v) {
  Column& column = columns_[v];
  const auto at = std::lower_bound(column.below.begin(), column.below.end(), u,
                                   [](const Below& b, int vertex) { return b.vertex < vertex; });
  if (at == column.below.end() || at->vertex != u)
    throw std::logic_error("lq::BlockCholesky: the block does not exist");
  return column.panel.middleRows(at->row, vertices_[u].size);
}

void BlockCholesky::add(int u, int i, int v, int j, const Eigen::Ref<const MatrixXd>& M) {
  if (u == v) {
    if (i >= j)
      columns_[u].diagonal.block(i, j, M.rows(), M.cols()) += M;
    else
      columns_[u].diagonal.block(j, i, M.cols(), M.rows()) += M.transpose();
  } else if (u > v) {
    block(u, v).block(i, j, M.rows(), M.cols()) += M;
  } else {
    block(v, u).block(j, i, M.cols(), M.rows()) += M.transpose();
  }
}

void BlockCholesky::add_proximal_term(double relative) {
  largest_.setZero();
  const auto largest_in = [](const auto& M) { return M.size() > 0 ? M.cwiseAbs().maxCoeff() : 0; };
  for (int v = 0; v < vertices(); ++v) {
    const Column& column = columns_[v];
    largest_[v] = std::max(largest_[v], largest_in(column.diagonal));
    for (const Below& b : column.below) {
      const double of_block = largest_in(column.panel.middleRows(b.row, vertices_[b.vertex].size));
      largest_[v] = std::max(largest_[v], of_block);
      largest_[b.vertex] = std::max(largest_[b.vertex], of_block);
    }
  }
  for (int v = 0; v < vertices(); ++v) add_diagonal(v, vertices_[v].sign * relative * largest_[v]);
}

bool BlockCholesky::finite() const {
  return std::all_of(columns_.begin(), columns_.end(), [](const Column& column) {
    return std::isfinite(column.diagonal.sum()) && std::isfinite(column.panel.sum());
  });
}

int BlockCholesky::factorize(double least) {
  for (int v = 0; v < static_cast<int>(columns_.size()); ++v) {
    Column& column = columns_[v];
    const double sign = vertices_[v].sign;
    if (sign < 0) {
      column.diagonal = -column.diagonal;
      column.panel = -column.panel;
    }
    if (!cholesky(column.diagonal, least)) return v;
    solve_Lt_right(column.diagonal, column.panel);  // L_uv = sign S_uv L_vv^-T
    for (std::size_t b = 0; b < column.below.size(); ++b) {
      const auto rows = [&](const Below& below) {
        return column.panel.middleRows(below.row, vertices_[below.vertex].size);
      };
      const Below& to = column.below[b];
      add_lower_ABt(columns_[to.vertex].diagonal, -sign, rows(to), rows(to));  // S_uu -= sign L_uv L_uv^T
      for (std::size_t a = b + 1; a < column.below.size(); ++a)
        add_ABt(block(column.below[a].vertex, to.vertex), -sign, rows(column.below[a]), rows(to));
    }
  }
  return -1;
}

void BlockCholesky::solve(VectorXd& x) const {
  const int n = static_cast<int>(columns_.size());
  for (int v = 0; v < n; ++v) {  // x <- L^-1 x
    const Column& column = columns_[v];
    auto xv = x.segment(start_[v], vertices_[v].size);
    solve_L(column.diagonal, xv);
    for (const Below& b : column.below)
      add_Ax(x.segment(start_[b.vertex], vertices_[b.vertex].size), -1,
             column.panel.middleRows(b.row, vertices_[b.vertex].size), xv);
  }
  for (int v = n - 1; v >= 0; --v) {  // x <- L^-T D^-1 x
    const Column& column = columns_[v];
    auto xv = x.segment(start_[v], vertices_[v].size);
    xv *= vertices_[v].sign;
    for (const Below& b : column.below)
      add_Atx(xv, -1, column.panel.middleRows(b.row, vertices_[b.vertex].size),
              x.segment(start_[b.vertex], vertices_[b.vertex].size));
    solve_Lt(column.diagonal, xv);
  }
}

}  // namespace manycontact::lq
