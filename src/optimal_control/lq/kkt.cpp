#include "manycontact/lq/kkt.hpp"

#include <cmath>

#include "dense.hpp"
#include "manycontact/sparse/largest.hpp"
#include "pieces.hpp"

namespace manycontact::lq {
namespace {

struct Rows {  // residuals of equations, and for each equation the sum of the magnitudes of its terms
  VectorXd& sum;
  VectorXd& scale;
};

using Part = Eigen::Ref<const MatrixXd>;

// Adds M z[from ...] to rows.sum[to ...], and |M| |z[from ...]| to rows.scale[to ...].
void multiply(const Part& M, const VectorXd& z, Index from, Rows rows, Index to) {
  add_Az(M, z.data() + from, rows.sum.data() + to, rows.scale.data() + to);
}

// Adds M z[from ...] to rows[to ...], and M^T w[to ...] to columns[from ...], with magnitudes as in multiply.
void multiply_both(const Part& M, const VectorXd& z, Index from, Rows columns, const VectorXd& w, Index to, Rows rows) {
  add_Az_Atw(M, z.data() + from, rows.sum.data() + to, rows.scale.data() + to, w.data() + to, columns.sum.data() + from,
             columns.scale.data() + from);
}

void add_segment(const VectorXd& terms, Index from, Index size, Rows rows, Index to) {
  rows.sum.segment(to, size) += terms.segment(from, size);
  rows.scale.segment(to, size) += terms.segment(from, size).cwiseAbs();
}

// Adds the terms of group g to `residual` and `scale`: those with Q, S, R, q, r, C, D, d and, for k < T, with A, B, f.
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
      multiply_both(g.A.block(j, i, nj, ni), z.x[k], xi, rx, z.lambda[k + 1], xj, next);
    });
    for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) {
      multiply_both(g.C.block(j, i, nj, ni), z.x[k], xi, rx, z.mu[k], rj, rmu);
    });
  });
  for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) { add_segment(g.d, j, nj, rmu, rj); });

  for_each_v(problem, layout, k, g, [&](Index i, bool i_is_u, Index vi, Index ni) {
    const Rows rv = rows_of(i_is_u ? &Point::u : &Point::w, k);
    const VectorXd& v = (i_is_u ? z.u : z.w)[k];
    add_segment(g.r, i, ni, rv, vi);
    for_each_x(problem, layout, g, [&](Index j, Index xj, Index nj) {
      multiply_both(g.S.block(j, i, nj, ni), v, vi, rv, z.x[k], xj, rx);
      if (last) return;
      multiply_both(g.B.block(j, i, nj, ni), v, vi, rv, z.lambda[k + 1], xj, next);
    });
    for_each_row(problem, layout, k, g, [&](Index j, Index rj, Index nj) {
      multiply_both(g.D.block(j, i, nj, ni), v, vi, rv, z.mu[k], rj, rmu);
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

// Raises the largest relative error `worst` to max |r| / max scale of each block of equations, if this is larger.
void judge(const VectorXd& r, const VectorXd& scale, const std::vector<int>& start, double& worst) {
  for (std::size_t b = 0; b + 1 < start.size() && start[b + 1] <= r.size(); ++b) {
    const int n = start[b + 1] - start[b];
    if (n == 0) continue;
    const double size = scale.segment(start[b], n).maxCoeff<Eigen::PropagateNaN>();
    const double error = r.segment(start[b], n).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    const double relative = error == 0 ? 0 : error / size;
    worst = sparse::larger_or_nan(worst, relative);
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

// The identity z^T (H z + h) = 0, a sum of terms of the cost and of terms of the constraints, gives
//     linear + quadratic = sum lambda^T (x0, f) + mu^T d - reg.x |x|^2 - reg.u |u|^2 - reg.rows |mu|^2
Change cost_change(const Problem& problem, const Layout& layout, const Regularisation& reg, const Point& z) {
  Change change;
  double sum = z.lambda[0].dot(problem.x0);
  for (int k = 0; k <= problem.horizon(); ++k) {
    for (const Group& g : problem.knots[k].groups) {
      for_each_x(problem, layout, g, [&](Index i, Index xi, Index n) {
        change.linear += g.q.segment(i, n).dot(z.x[k].segment(xi, n));
        if (k < problem.horizon()) sum += g.f.segment(i, n).dot(z.lambda[k + 1].segment(xi, n));
      });
      for_each_v(problem, layout, k, g, [&](Index i, bool is_u, Index vi, Index n) {
        change.linear += g.r.segment(i, n).dot((is_u ? z.u : z.w)[k].segment(vi, n));
      });
      for_each_row(problem, layout, k, g,
                   [&](Index i, Index ri, Index n) { sum += g.d.segment(i, n).dot(z.mu[k].segment(ri, n)); });
    }
    sum -= reg.x * z.x[k].squaredNorm() + reg.u * z.u[k].squaredNorm() + reg.rows * z.mu[k].squaredNorm();
  }
  change.quadratic = sum - change.linear;
  return change;
}

}  // namespace manycontact::lq
