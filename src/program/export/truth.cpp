#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "export.hpp"

namespace manycontact::cli {

namespace {

constexpr int kMostSteps = 40;        // most refinement steps; each gains digits if eps |K| |K^-1| is below 1
constexpr double kConverged = 1e-20;  // a solution is accepted if its last correction, relative to x, is below this
constexpr double kMostDigits = 32;    // the residual of many terms loses about two of 34 digits

VecX<Quad> residual(const Eigen::SparseMatrix<double>& K, const Eigen::VectorXd& b, const VecX<Quad>& x) {
  VecX<Quad> r = b.cast<Quad>();
  for (int j = 0; j < K.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, j); it; ++it) r[it.row()] -= Quad(it.value()) * x[j];
  return r;
}

double largest(const auto& x) {
  double most = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) most = std::max(most, std::abs(static_cast<double>(x[i])));
  return most;
}

double ratio(double part, double whole) { return whole > 0 ? part / whole : part > 0 ? INFINITY : 0; }

// Return the size of a correction dx of x = [a; -f]. relative_size is relative to x and shows convergence.
// relative_size_of_parts is the larger of dx relative to a and to f, which may be far smaller than x.
double relative_size(const Eigen::VectorXd& dx, const VecX<Quad>& x) { return ratio(largest(dx), largest(x)); }
double relative_size_of_parts(const Eigen::VectorXd& dx, const VecX<Quad>& x, int nv) {
  return std::max(ratio(largest(dx.head(nv)), largest(x.head(nv))),
                  ratio(largest(dx.tail(dx.size() - nv)), largest(x.tail(x.size() - nv))));
}

struct Correction {
  double whole = INFINITY, parts = INFINITY;
};

// Repeats x <- x + (LU)^-1 (b - K x) in quadruple precision while corrections shrink. Returns the smallest correction.
Correction refine(const Eigen::SparseLU<Eigen::SparseMatrix<double>>& lu, const ExportedSystem& s,
                  const Eigen::VectorXd& b, VecX<Quad>& x) {
  x.setZero(s.size());
  Correction least;
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::VectorXd r = residual(s.K, b, x).cast<double>();
    const Eigen::VectorXd dx = lu.solve(r);
    if (!dx.allFinite()) return {};
    x += dx.cast<Quad>();
    const Correction now{relative_size(dx, x), relative_size_of_parts(dx, x, s.island.nv)};
    if (step > 1 && now.whole > 0.5 * least.whole) break;
    least = now;
  }
  return least;
}

double digits_of(double error) { return std::clamp(-std::log10(std::max(error, 1e-99)), 0.0, kMostDigits); }

MatX<Quad> join(MatX<Quad> a, MatX<Quad> f) {
  MatX<Quad> x(a.rows() + f.rows(), a.cols());
  x << a, -f;
  return x;
}

// Solves with the dense reference solver. The error is estimated by the correction of one more refinement step.
ExactSolution solve_densely(const ExportedSystem& s, const Eigen::MatrixXd& b) {
  const int nv = s.island.nv, nc = s.island.nc;
  const MatX<Quad> K = Eigen::MatrixXd(s.K).cast<Quad>();
  DenseKkt<Quad> kkt;
  kkt.M = K.topLeftCorner(nv, nv);
  kkt.J = K.bottomLeftCorner(nc, nv);
  kkt.delta = nc > 0 ? Quad(-K(nv, nv)) : Quad(0);
  factor(kkt);
  if (!kkt.regular || (kkt.rank < nc && kkt.delta == 0)) return {};
  const MatX<Quad> b1 = b.topRows(nv).cast<Quad>(), b2 = b.bottomRows(nc).cast<Quad>();
  MatX<Quad> a, f, da, df;
  solve(kkt, b1, b2, a, f);
  ExactSolution out{join(a, f), kMostDigits};
  const MatX<Quad> r = b.cast<Quad>() - K * out.x;
  solve<Quad>(kkt, r.topRows(nv), r.bottomRows(nc), da, df);
  const Eigen::MatrixXd dx = join(da, df).cast<double>();
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    out.digits = std::min(out.digits, digits_of(relative_size_of_parts(dx.col(j), out.x.col(j), nv)));
  return out;
}

}  // namespace

ExactSolution solve_exactly(const ExportedSystem& s, const Eigen::MatrixXd& b) {
  if (s.size() == 0) return {MatX<Quad>(0, b.cols()), kMostDigits};  // Eigen's LU would divide by the size
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
  lu.compute(s.K);
  ExactSolution out{MatX<Quad>(s.size(), b.cols()), kMostDigits};
  Correction worst;
  if (lu.info() == Eigen::Success) worst = {0, 0};
  VecX<Quad> x;
  for (Eigen::Index j = 0; j < b.cols() && worst.whole < kConverged; ++j) {
    const Correction last = refine(lu, s, b.col(j), x);
    worst = {std::max(worst.whole, last.whole), std::max(worst.parts, last.parts)};
    out.x.col(j) = x;
  }
  out.digits = digits_of(worst.parts);
  if (worst.whole < kConverged) return out;
  return s.size() <= kDenseUnknowns ? solve_densely(s, b) : ExactSolution{};
}

Truth<Quad> solve_scene(const SceneFile& file, SceneData& data) {
  return refine_truth<Quad>(file.scene, data, file.q.cast<Quad>(), file.v.cast<Quad>(), file.u.cast<Quad>(),
                            kDenseUnknowns);
}

ExactSolution of_island(const Truth<Quad>& truth, const Scene& scene, const SceneData& data, const Island& island,
                        std::size_t i) {
  if (!truth.regular[i]) return {};
  ExactSolution out{MatX<Quad>(island.size(), 1), kMostDigits};
  each_velocity_block(scene, island,
                      [&](int from, int to, int n) { out.x.col(0).segment(to, n) = truth.a.segment(from, n); });
  each_force_block(scene, data.f_offset, island, [&](int from, int to, int n) {
    out.x.col(0).segment(island.nv + to, n) = -truth.f.segment(from, n);
  });
  return out;
}

}  // namespace manycontact::cli
