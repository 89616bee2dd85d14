#include "manycontact/lq/coupling_schur.hpp"

#include <algorithm>

#include "dense.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pieces.hpp"

namespace manycontact::lq {

namespace {

// Size of the proximal term, relative to S, if S is semidefinite. As it is about sqrt(eps), each refinement reduces
// errors by about sqrt(eps).
constexpr double kProximal = 1e-8;
constexpr int kProximalRefinements = 9;

// Computes in out.w and out.mu the residuals of the equations of w and mu, with x, u, lambda of z and with w = mu = 0.
void equations_of_y(const Problem& problem, const Layout& layout, const Point& h, const Point& z, Point& out) {
  for (int k = 0; k <= problem.horizon(); ++k) {
    out.w[k] = h.w[k];
    out.mu[k] = h.mu[k];
    for (const Group& g : problem.knots[k].groups) {
      const auto add_from = [&](Index to_w, Index w, Index nw) {  // S_w^T x + R_wu u + B_w^T lambda+
        auto sum = out.w[k].segment(w, nw);
        for_each_x(problem, layout, g, [&](Index i, Index x, Index n) {
          add_Atx(sum, 1, g.S.block(i, to_w, n, nw), z.x[k].segment(x, n));
          if (k < problem.horizon()) add_Atx(sum, 1, g.B.block(i, to_w, n, nw), z.lambda[k + 1].segment(x, n));
        });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) add_Ax(sum, 1, g.R.block(to_w, i, nw, n), z.u[k].segment(u, n));
        });
      };
      for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index w, Index n) {
        if (!is_u) add_from(i, w, n);
      });
      for_each_row(problem, layout, k, g, [&](Index i, Index row, Index rows) {  // C x + D_u u
        auto sum = out.mu[k].segment(row, rows);
        for_each_x(problem, layout, g,
                   [&](Index j, Index x, Index n) { add_Ax(sum, 1, g.C.block(i, j, rows, n), z.x[k].segment(x, n)); });
        for_each_v(problem, layout, k, g, [&](Index j, bool is_u, Index u, Index n) {
          if (is_u) add_Ax(sum, 1, g.D.block(i, j, rows, n), z.u[k].segment(u, n));
        });
      });
    }
  }
}

// Computes `out` as h plus the terms of z's w and mu in the equations of x, u and lambda.
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
          add_Ax(out.x[k].segment(x, n), 1, g.S.block(i, j, n, nw), y);
          if (k < problem.horizon()) add_Ax(out.lambda[k + 1].segment(x, n), 1, g.B.block(i, j, n, nw), y);
        });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) add_Ax(out.u[k].segment(u, n), 1, g.R.block(i, j, n, nw), y);
        });
      });
      for_each_row(problem, layout, k, g, [&](Index j, Index row, Index rows) {
        const auto y = z.mu[k].segment(row, rows);
        for_each_x(problem, layout, g,
                   [&](Index i, Index x, Index n) { add_Atx(out.x[k].segment(x, n), 1, g.C.block(j, i, rows, n), y); });
        for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index u, Index n) {
          if (is_u) add_Atx(out.u[k].segment(u, n), 1, g.D.block(j, i, rows, n), y);
        });
      });
    }
  }
}

}  // namespace

void CouplingSchur::do_analyse(const Problem& problem) {
  riccati_.analyse(problem);
  const Plan& plan = riccati_.plan();
  graph_ = make_coupling_graph(problem, plan);
  flops_ = coupling_schur_flops(problem, plan, graph_);
  schur_.analyse(graph_.vertices, graph_.edges);

  const std::size_t knots = plan.size();
  F_.assign(knots, {});
  pi_.assign(knots, {});
  theta_.assign(knots, {});
  std::size_t n = 0, nu = 0, y = 0, of_vertex = 0;  // largest sizes of x, u, y of a cluster, and of a vertex of S
  for (const auto& cluster : graph_.nodes) {
    for (std::size_t k = 0; k < knots; ++k) {
      const Cluster& c = plan[k][cluster[k].cluster];
      const std::size_t size = cluster[k].size, nx = c.nx;
      F_[k].resize(std::max(F_[k].size(), nx * nx));
      pi_[k].resize(std::max(pi_[k].size(), nx * size));
      theta_[k].resize(pi_[k].size());
      n = std::max(n, nx);
      nu = std::max<std::size_t>(nu, c.nu);
      y = std::max(y, size);
    }
  }
  for (std::vector<double>* nn : {&W_, &FW_}) nn->resize(n * n);
  for (std::vector<double>* ny : {&Gx_, &E_, &PE_}) ny->resize(n * y);
  for (std::vector<double>* uy : {&Gu_, &Y_}) uy->resize(nu * y);
  U_.resize(n * nu);
  for (const BlockCholesky::Vertex& v : graph_.vertices) of_vertex = std::max<std::size_t>(of_vertex, v.size);
  S_.resize(y * std::max(y, of_vertex));
  for (std::vector<double>* nv : {&V_, &Z_, &Z_next_}) nv->resize(n * std::max({n, y, of_vertex}));
  terms_ = Point(problem, layout_);
  y_.resize(schur_.size());
}

Outcome CouplingSchur::do_factorize(const Problem& problem, const Regularisation& reg) {
  const Outcome outcome = riccati_.factorize(problem, reg);
  if (outcome.status != Status::kOk) return outcome;
  extra_refinements_ = 0;
  make_schur(problem, reg);
  if (!schur_.finite()) return {Status::kNotFinite};
  if (schur_.factorize(tolerance::kPivotLeft) < 0) return {};

  extra_refinements_ = kProximalRefinements;
  make_schur(problem, reg);
  schur_.add_proximal_term(kProximal);
  const int failed = schur_.factorize(0);
  if (failed < 0) return {};
  return {failed % 2 == 0 ? Status::kSingular : Status::kNotConvex};  // even vertices: mu, odd: w
}

void CouplingSchur::make_schur(const Problem& problem, const Regularisation& reg) {
  schur_.set_zero();
  if (reg.rows > 0)
    for (int v = 0; v < schur_.vertices(); v += 2) schur_.add_diagonal(v, -reg.rows);
  for (int c = 0; c < static_cast<int>(graph_.nodes.size()); ++c) respond(problem, c);
}

void CouplingSchur::do_solve(const Problem& problem, const Point& h, Point& z, bool first) {
  riccati_.pass(problem, h, z);
  equations_of_y(problem, layout_, h, z, terms_);
  // calls f(part of z, same part of terms_, first index in both, size, first index in y_) for each w and mu
  const auto each = [&](auto&& f) {
    for (std::size_t k = 0; k < graph_.places.size(); ++k)
      for (std::size_t b = 0; b < graph_.places[k].size(); ++b) {
        const CouplingPlace& place = graph_.places[k][b];
        const Coupling& coupling = problem.knots[k].couplings[b];
        f(z.w[k], terms_.w[k], layout_.w[k][b], coupling.size, schur_.start(place.w) + place.w_offset);
        f(z.mu[k], terms_.mu[k], layout_.rows[k][b], coupling.rows, schur_.start(place.mu) + place.mu_offset);
      }
  };
  each([&](VectorXd&, const VectorXd& s, Index at, Index n, Index y) { y_.segment(y, n) = -s.segment(at, n); });
  schur_.solve(y_);  // S y = -s
  each([&](VectorXd& part, const VectorXd&, Index at, Index n, Index y) { part.segment(at, n) = y_.segment(y, n); });
  terms_with_y(problem, layout_, h, z, terms_);
  riccati_.do_solve(problem, terms_, z, first);
}

}  // namespace manycontact::lq
