#include "manycontact/lq/kkt.hpp"

#include <algorithm>
#include <cmath>

#include "pieces.hpp"

namespace manycontact::lq {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A vector of equations, and of the sums of their |terms|.
struct Rows {
  VectorXd& sum;
  VectorXd& scale;

  void add(Index row, double term) {
    sum[row] += term;
    scale[row] += std::abs(term);
  }
};

using Part = Eigen::Ref<const MatrixXd>;

// rows[to ...] += M z[from ...]
void multiply(const Part& M, const VectorXd& z, Index from, Rows rows, Index to) {
  for (Index j = 0; j < M.cols(); ++j) {
    rows.sum.segment(to, M.rows()) += M.col(j) * z[from + j];
    rows.scale.segment(to, M.rows()) += M.col(j).cwiseAbs() * std::abs(z[from + j]);
  }
}

// rows[to ...] += M^T z[from ...]
void multiply_transposed(const Part& M, const VectorXd& z, Index from, Rows rows, Index to) {
  for (Index j = 0; j < M.cols(); ++j) {
    rows.sum[to + j] += M.col(j).dot(z.segment(from, M.rows()));
    rows.scale[to + j] += M.col(j).cwiseAbs().dot(z.segment(from, M.rows()).cwiseAbs());
  }
}

void add_segment(const VectorXd& terms, Index from, Index size, Rows rows, Index to) {
  rows.sum.segment(to, size) += terms.segment(from, size);
  rows.scale.segment(to, size) += terms.segment(from, size).cwiseAbs();
}

// The terms of one group's Q S R q r A B f C D d. k < T: the knot has dynamics.
void add_group(const Problem& problem, const Layout& layout, int k, const Group& g, const Point& z, Point& residual,
               Point& scale) {
  const bool last = k == problem.horizon();
  const auto rows_of = [&](std::vector<VectorXd> Point::*part, int knot) {
    return Rows{(residual.*part)[knot], (scale.*part)[knot]};
  };
  const Rows rx = rows_of(&Point::x, k), rmu = rows_of(&Point::mu, k);
  const Rows next = rows_of(&Point::lambda, last ? k : k + 1);

  for_each_x(problem, layout, g, [&](Index i, Index xi, Index ni) {
    add_segment(g.q, i, ni, rx, xi);
    if (!last) add_segment(g.f, i, ni, next, xi);
    for_each_x(problem, layout, g, [&](Index j, Index xj, Index nj) {
      multiply(g.Q.block(j, i, nj, ni), z.x[k], xi, rx, xj);
      if (last) return;
      multiply(g.A.block(j, i, nj, ni), z.x[k], xi, next, xj);
      multiply_transposed(g.A.block(j, i, nj, ni), z.lambda[k + 1], xj, rx, xi);
    });
    for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) {
      multiply(g.C.block(j, i, nj, ni), z.x[k], xi, rmu, rj);
      multiply_transposed(g.C.block(j, i, nj, ni), z.mu[k], rj, rx, xi);
    });
  });
  for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) { add_segment(g.d, j, nj, rmu, rj); });

  for_each_v(problem, layout, k, g, [&](Index i, bool i_is_u, Index vi, Index ni) {
    const Rows rv = rows_of(i_is_u ? &Point::u : &Point::w, k);
    const VectorXd& v = (i_is_u ? z.u : z.w)[k];
    add_segment(g.r, i, ni, rv, vi);
    for_each_x(problem, layout, g, [&](Index j, Index xj, Index nj) {
      multiply(g.S.block(j, i, nj, ni), v, vi, rx, xj);
      multiply_transposed(g.S.block(j, i, nj, ni), z.x[k], xj, rv, vi);
      if (last) return;
      multiply(g.B.block(j, i, nj, ni), v, vi, next, xj);
      multiply_transposed(g.B.block(j, i, nj, ni), z.lambda[k + 1], xj, rv, vi);
    });
    for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) {
      multiply(g.D.block(j, i, nj, ni), v, vi, rmu, rj);
      multiply_transposed(g.D.block(j, i, nj, ni), z.mu[k], rj, rv, vi);
    });
    for_each_v(problem, layout, k, g, [&](Index j, bool j_is_u, Index vj, Index nj) {
      multiply(g.R.block(j, i, nj, ni), v, vi, rows_of(j_is_u ? &Point::u : &Point::w, k), vj);
    });
  });
}

void add_scaled(const VectorXd& z, double a, Rows rows) {
  rows.sum += a * z;
  rows.scale += std::abs(a) * z.cwiseAbs();
}

void set_zero(Point& z) {
  for (auto part : {&Point::x, &Point::u, &Point::w, &Point::lambda, &Point::mu})
    for (VectorXd& v : z.*part) v.setZero();
}

// The largest of |r| over the largest of `scale`, in one block of equations.
void judge(const VectorXd& r, const VectorXd& scale, const std::vector<int>& start, double& worst) {
  for (std::size_t b = 0; b + 1 < start.size() && start[b + 1] <= r.size(); ++b) {
    const int n = start[b + 1] - start[b];
    if (n == 0) continue;
    const double size = scale.segment(start[b], n).maxCoeff<Eigen::PropagateNaN>();
    const double error = r.segment(start[b], n).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    const double relative = error == 0 ? 0 : error / size;
    if (!(relative <= worst)) worst = relative;
    if (std::isnan(worst)) return;
  }
}

}  // namespace

void linear_terms(const Problem& problem, const Layout& layout, Point& h) {
  set_zero(h);
  h.lambda[0] = problem.x0;
  for (int k = 0; k <= problem.horizon(); ++k)
    for (const Group& g : problem.knots[k].groups) {
      for_each_x(problem, layout, g, [&](Index i, Index xi, Index n) {
        h.x[k].segment(xi, n) = g.q.segment(i, n);
        if (k < problem.horizon()) h.lambda[k + 1].segment(xi, n) = g.f.segment(i, n);
      });
      for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index vi, Index n) {
        (is_u ? h.u : h.w)[k].segment(vi, n) += g.r.segment(i, n);
      });
      for_each_row(problem, layout, k, g,
                   [&](Index i, Index ri, Index n) { h.mu[k].segment(ri, n) += g.d.segment(i, n); });
    }
}

double kkt_residual(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z,
                    Point& residual, Point& scale) {
  set_zero(residual);
  set_zero(scale);
  const int T = problem.horizon();
  residual.lambda[0] += problem.x0;
  scale.lambda[0] += problem.x0.cwiseAbs();
  for (int k = 0; k <= T; ++k) {
    for (const Group& g : problem.knots[k].groups) add_group(problem, layout, k, g, z, residual, scale);
    add_scaled(z.x[k], -1, {residual.lambda[k], scale.lambda[k]});
    add_scaled(z.lambda[k], -1, {residual.x[k], scale.x[k]});
    add_scaled(z.x[k], reg.x, {residual.x[k], scale.x[k]});
    add_scaled(z.u[k], reg.u, {residual.u[k], scale.u[k]});
    add_scaled(z.mu[k], -reg.rows, {residual.mu[k], scale.mu[k]});
  }
  double worst = 0;
  for (int k = 0; k <= T; ++k) {
    judge(residual.x[k], scale.x[k], layout.x, worst);
    judge(residual.lambda[k], scale.lambda[k], layout.x, worst);
    judge(residual.u[k], scale.u[k], layout.u, worst);
    judge(residual.w[k], scale.w[k], layout.w[k], worst);
    judge(residual.mu[k], scale.mu[k], layout.rows[k], worst);
  }
  return worst;
}

double kkt_error(const Problem& problem, const Point& z, const Regularisation& reg) {
  const Layout layout(problem);
  Point residual(problem, layout), scale(problem, layout);
  return kkt_residual(problem, layout, reg, z, residual, scale);
}

Change cost_change(const Problem& problem, const Layout& layout, const Point& z) {
  Change change;
  for (int k = 0; k <= problem.horizon(); ++k)
    for (const Group& g : problem.knots[k].groups) {
      for_each_x(problem, layout, g, [&](Index i, Index xi, Index ni) {
        const auto x = z.x[k].segment(xi, ni);
        change.linear += g.q.segment(i, ni).dot(x);
        for_each_x(problem, layout, g, [&](Index j, Index xj, Index nj) {
          change.quadratic += z.x[k].segment(xj, nj).dot(g.Q.block(j, i, nj, ni).lazyProduct(x));
        });
      });
      for_each_v(problem, layout, k, g, [&](Index i, bool i_is_u, Index vi, Index ni) {
        const auto v = (i_is_u ? z.u : z.w)[k].segment(vi, ni);
        change.linear += g.r.segment(i, ni).dot(v);
        for_each_x(problem, layout, g, [&](Index j, Index xj, Index nj) {
          change.quadratic += 2 * z.x[k].segment(xj, nj).dot(g.S.block(j, i, nj, ni).lazyProduct(v));
        });
        for_each_v(problem, layout, k, g, [&](Index j, bool j_is_u, Index vj, Index nj) {
          const auto other = (j_is_u ? z.u : z.w)[k].segment(vj, nj);
          change.quadratic += other.dot(g.R.block(j, i, nj, ni).lazyProduct(v));
        });
      });
    }
  return change;
}

}  // namespace manycontact::lq
