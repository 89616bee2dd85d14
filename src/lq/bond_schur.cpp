#include "manycontact/lq/bond_schur.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pieces.hpp"

namespace manycontact::lq {

using Eigen::Index;
using Eigen::VectorXd;

// ---- analyse --------------------------------------------------------------------------------------------------

// By cluster of knot 0, which the plan keeps: its index and its bonds in each knot.
void BondSchur::make_nodes(const Problem& problem) {
  const Plan& plan = riccati_.plan();
  nodes_.assign(plan[0].size(), std::vector<Node>(plan.size()));
  for (std::size_t c = 0; c < plan[0].size(); ++c) {
    int index = static_cast<int>(c);
    for (std::size_t k = 0; k < plan.size(); ++k) {
      Node& node = nodes_[c][k];
      node.cluster = index;
      std::set<int> bonds;
      for (const Member& m : plan[k][index].members) {
        const Group& g = problem.knots[k].groups[m.group];
        bonds.insert(g.bonds.begin(), g.bonds.end());
      }
      for (const bool is_w : {true, false})
        for (int b : bonds) {
          const Bond& bond = problem.knots[k].bonds[b];
          const int size = is_w ? bond.size : bond.rows;
          if (size == 0) continue;
          node.parts.push_back({b, is_w, node.size, size, -1, 0});
          node.size += size;
        }
      if (k + 1 < plan.size()) index = plan[k][index].next[0];
    }
  }
}

// Bonds of all knots that touch the same clusters are one track, of two vertices in S: all their mu, then all their w.
void BondSchur::make_vertices(const Problem& problem) {
  const int T = problem.horizon();
  std::vector<std::vector<std::vector<int>>> touched(T + 1);  // by knot, by bond: clusters
  for (int k = 0; k <= T; ++k) {
    touched[k].resize(problem.knots[k].bonds.size());
    for (std::size_t c = 0; c < nodes_.size(); ++c)
      for (const Part& part : nodes_[c][k].parts) {
        std::vector<int>& of_bond = touched[k][part.bond];
        if (of_bond.empty() || of_bond.back() != static_cast<int>(c)) of_bond.push_back(static_cast<int>(c));
      }
  }
  std::map<std::vector<int>, int> tracks;
  for (const auto& knot : touched)
    for (const auto& clusters : knot) tracks.emplace(clusters, static_cast<int>(tracks.size()));

  std::vector<std::pair<int, int>> edges;  // tracks that share a cluster
  for (std::size_t c = 0; c < nodes_.size(); ++c) {
    std::vector<int> mine;
    for (const auto& [clusters, track] : tracks)
      if (std::find(clusters.begin(), clusters.end(), static_cast<int>(c)) != clusters.end()) mine.push_back(track);
    for (int a : mine)
      for (int b : mine) edges.push_back({a, b});
  }
  const int count = static_cast<int>(tracks.size());
  const std::vector<int> order = sparse::camd_order(sparse::make_pattern(count, edges), {});
  const std::vector<int> position = sparse::inverse(order);

  std::vector<BlockCholesky::Vertex> vertices;
  for (int t = 0; t < count; ++t) vertices.insert(vertices.end(), {{0, -1.}, {0, 1.}});
  places_.assign(T + 1, {});
  for (int k = 0; k <= T; ++k)
    for (std::size_t b = 0; b < touched[k].size(); ++b) {
      const int v = 2 * position[tracks.at(touched[k][b])];
      const Bond& bond = problem.knots[k].bonds[b];
      places_[k].push_back({v + 1, vertices[v + 1].size, v, vertices[v].size});
      vertices[v].size += bond.rows;
      vertices[v + 1].size += bond.size;
    }
  for (auto& cluster : nodes_)
    for (int k = 0; k <= T; ++k)
      for (Part& part : cluster[k].parts) {
        const Place& place = places_[k][part.bond];
        part.vertex = part.is_w ? place.w : place.mu;
        part.offset = part.is_w ? place.w_offset : place.mu_offset;
      }
  std::vector<std::pair<int, int>> blocks;
  for (const auto& [a, b] : edges)
    for (int i : {0, 1})
      for (int j : {0, 1}) blocks.push_back({2 * position[a] + i, 2 * position[b] + j});
  for (int t = 0; t < count; ++t) blocks.push_back({2 * t, 2 * t + 1});
  schur_.analyse(std::move(vertices), blocks);
}

void BondSchur::do_analyse(const Problem& problem) {
  riccati_.analyse(problem);
  make_nodes(problem);
  make_vertices(problem);

  const Plan& plan = riccati_.plan();
  const std::size_t knots = plan.size();
  F_.assign(knots, {});
  pi_.assign(knots, {});
  theta_.assign(knots, {});
  std::size_t n_max = 0, nu_max = 0, y_max = 0, all_y = 0, parts = 0;
  flops_ = riccati_.flops() + schur_.flops();
  for (const auto& cluster : nodes_) {
    double y_total = 0, part_total = 0, n = 0;
    for (std::size_t k = 0; k < knots; ++k) {
      const Cluster& c = plan[k][cluster[k].cluster];
      n = c.nx;
      const double y = cluster[k].size;
      F_[k].resize(std::max<std::size_t>(F_[k].size(), c.nx * c.nx));
      pi_[k].resize(std::max<std::size_t>(pi_[k].size(), c.nx * cluster[k].size));
      theta_[k].resize(pi_[k].size());
      n_max = std::max<std::size_t>(n_max, c.nx);
      nu_max = std::max<std::size_t>(nu_max, c.nu);
      y_max = std::max<std::size_t>(y_max, cluster[k].size);
      y_total += y;
      part_total += static_cast<double>(cluster[k].parts.size());
      flops_ += 3 * n * n * n + 2 * n * n * c.nu + n * c.nu * (n + c.nu)  // F, W
                + 10 * n * n * y + 6 * n * c.nu * y + 4 * n * y * y;      // pi, theta, S_ll
    }
    double later = 0;
    for (std::size_t k = knots; k-- > 0;) {
      flops_ += 2 * n * later * (n + cluster[k].size);
      later += cluster[k].size;
    }
    all_y = std::max(all_y, static_cast<std::size_t>(y_total));
    parts = std::max(parts, static_cast<std::size_t>(part_total));
  }
  for (std::vector<double>* nn : {&W_, &FW_}) nn->resize(n_max * n_max);
  for (std::vector<double>* ny : {&Gx_, &E_, &PE_}) ny->resize(n_max * y_max);
  for (std::vector<double>* uy : {&Gu_, &Y_}) uy->resize(nu_max * y_max);
  U_.resize(n_max * nu_max);
  S_.resize(y_max * std::max(y_max, all_y));
  V_.resize(n_max * all_y);
  V_next_.resize(n_max * all_y);
  columns_.reserve(parts);
  terms_ = Point(problem, layout_);
  y_.resize(schur_.size());
}

double BondSchur::flops() const { return flops_; }

// ---- factorize ------------------------------------------------------------------------------------------------

Outcome BondSchur::do_factorize(const Problem& problem, const Regularisation& reg) {
  const Outcome outcome = riccati_.factorize(problem, reg);
  if (outcome.status != Status::kOk) return outcome;
  schur_.set_zero();
  if (reg.rows > 0)
    for (int v = 0; v < schur_.vertices(); v += 2) schur_.add_diagonal(v, -reg.rows);
  for (int c = 0; c < static_cast<int>(nodes_.size()); ++c) respond(problem, c);
  if (!schur_.finite()) return {Status::kNotFinite};
  return {schur_.factorize(tolerance::kPivotLeft) < 0 ? Status::kOk : Status::kSingular};
}

// ---- solve ----------------------------------------------------------------------------------------------------

namespace {

// The equations of w and mu at (x, u, lambda) of z and w = mu = 0, by knot: into w and mu of `out`.
void equations_of_y(const Problem& problem, const Layout& layout, const Point& h, const Point& z, Point& out) {
  for (int k = 0; k <= problem.horizon(); ++k) {
    out.w[k] = h.w[k];
    out.mu[k] = h.mu[k];
    for (const Group& g : problem.knots[k].groups) {
      const auto add_from = [&](Index to_w, Index w, Index nw) {  // S_w^T x + R_wu u + B_w^T lambda+
        auto sum = out.w[k].segment(w, nw);
        for_each_x(problem, layout, g, [&](Index i, Index x, Index n) {
          sum.noalias() += g.S.block(i, to_w, n, nw).transpose() * z.x[k].segment(x, n);
          if (k < problem.horizon())
            sum.noalias() += g.B.block(i, to_w, n, nw).transpose() * z.lambda[k + 1].segment(x, n);
        });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) sum.noalias() += g.R.block(to_w, i, nw, n) * z.u[k].segment(u, n);
        });
      };
      for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index w, Index n) {
        if (!is_u) add_from(i, w, n);
      });
      for_each_row(problem, layout, k, g, [&](Index i, Index row, Index rows) {  // C x + D_u u
        auto sum = out.mu[k].segment(row, rows);
        for_each_x(problem, layout, g, [&](Index j, Index x, Index n) {
          sum.noalias() += g.C.block(i, j, rows, n) * z.x[k].segment(x, n);
        });
        for_each_v(problem, layout, k, g, [&](Index j, bool is_u, Index u, Index n) {
          if (is_u) sum.noalias() += g.D.block(i, j, rows, n) * z.u[k].segment(u, n);
        });
      });
    }
  }
}

// h with what y = (w, mu) of z adds to the equations of x, u and lambda.
void terms_with_y(const Problem& problem, const Layout& layout, const Point& h, const Point& z, Point& out) {
  out.lambda[0] = h.lambda[0];
  for (int k = 0; k <= problem.horizon(); ++k) {
    out.x[k] = h.x[k];
    out.u[k] = h.u[k];
    if (k < problem.horizon()) out.lambda[k + 1] = h.lambda[k + 1];
    for (const Group& g : problem.knots[k].groups) {
      for_each_v(problem, layout, k, g, [&](Index j, bool j_is_u, Index w, Index nw) {
        if (j_is_u) return;
        const auto y = z.w[k].segment(w, nw);
        for_each_x(problem, layout, g, [&](Index i, Index x, Index n) {
          out.x[k].segment(x, n).noalias() += g.S.block(i, j, n, nw) * y;
          if (k < problem.horizon()) out.lambda[k + 1].segment(x, n).noalias() += g.B.block(i, j, n, nw) * y;
        });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) out.u[k].segment(u, n).noalias() += g.R.block(i, j, n, nw) * y;
        });
      });
      for_each_row(problem, layout, k, g, [&](Index j, Index row, Index rows) {
        const auto y = z.mu[k].segment(row, rows);
        for_each_x(problem, layout, g, [&](Index i, Index x, Index n) {
          out.x[k].segment(x, n).noalias() += g.C.block(j, i, rows, n).transpose() * y;
        });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) out.u[k].segment(u, n).noalias() += g.D.block(j, i, rows, n).transpose() * y;
        });
      });
    }
  }
}

}  // namespace

void BondSchur::do_solve(const Problem& problem, const Point& h, Point& z, bool first) {
  riccati_.pass(problem, h, z);
  equations_of_y(problem, layout_, h, z, terms_);
  const auto each = [&](auto&& f) {  // f(part of z, part of terms_, place in y)
    for (std::size_t k = 0; k < places_.size(); ++k)
      for (std::size_t b = 0; b < places_[k].size(); ++b) {
        const Place& place = places_[k][b];
        const Bond& bond = problem.knots[k].bonds[b];
        f(z.w[k], terms_.w[k], layout_.w[k][b], bond.size, schur_.start(place.w) + place.w_offset);
        f(z.mu[k], terms_.mu[k], layout_.rows[k][b], bond.rows, schur_.start(place.mu) + place.mu_offset);
      }
  };
  each([&](VectorXd&, const VectorXd& s, Index at, Index n, Index y) { y_.segment(y, n) = -s.segment(at, n); });
  schur_.solve(y_);  // S y = -s
  each([&](VectorXd& part, const VectorXd&, Index at, Index n, Index y) { part.segment(at, n) = y_.segment(y, n); });
  terms_with_y(problem, layout_, h, z, terms_);
  riccati_.do_solve(problem, terms_, z, first);
}

}  // namespace manycontact::lq
