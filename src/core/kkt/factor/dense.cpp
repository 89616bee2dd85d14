#include "manycontact/kkt/dense.hpp"

#include <cmath>
#include <limits>

#include "expand.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class DenseFactor final : public Factor {
 public:
  Method method() const override { return Method::kDense; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    pattern_ = K.pattern;
    internal::expand(K, kkt_.M, kkt_.J);
    kkt_.delta = K.damping;
    kkt_.row_scale.resize(K.nc());
    for (int k = 0; k < K.nc(); ++k) kkt_.row_scale[k] = internal::size_of_row(K, scratch, k);
    factor<double>(kkt_);
    if (kkt_.regular) return Reason::kNone;
    if (!kkt_.M.allFinite() || !kkt_.J.allFinite()) return Reason::kNotFinite;
    return kkt_.holds ? Reason::kSmallPivot : Reason::kSingularInertia;
  }

  void solve(double* x) override {
    Eigen::MatrixXd b1(kkt_.nv(), 1), b2(kkt_.nc(), 1), a, f;
    internal::split(*pattern_, x, b1.col(0), b2.col(0));
    manycontact::solve<double>(kkt_, b1, b2, a, f);
    internal::join(*pattern_, a.col(0), (-f).eval().col(0), x);
  }

  void solve_panel(double* X, int ld, int first, int cols, char*) override {
    auto panel = view(X, ld).middleCols(first, cols);
    const Eigen::MatrixXd b1 = panel.topRows(kkt_.nv()), b2 = panel.bottomRows(kkt_.nc());
    Eigen::MatrixXd a, f;
    manycontact::solve<double>(kkt_, b1, b2, a, f);
    panel.topRows(kkt_.nv()) = a;
    panel.bottomRows(kkt_.nc()) = -f;
  }

  // Replaces the coordinates' rows of x by J^+ f, where f are the contact rows of x.
  void particular_solution(double* x) override {
    if (rank() == kkt_.nc()) return solve(x);
    Eigen::VectorXd a(kkt_.nv()), f(kkt_.nc());
    internal::split(*pattern_, x, a, f);
    const Eigen::MatrixXd motion = kkt_.motion(f);
    internal::join(*pattern_, motion.col(0), f, x);
  }
  int own_refinements() const override { return 1; }

  int rank() const override { return kkt_.delta > 0 ? kkt_.nc() : kkt_.rank; }
  // Lists the rows that depend on rows before them, as other factors do, by two passes of Gram-Schmidt. If this gives
  // fewer independent rows than the rank, lists the rows that the pivoted QR rejected.
  void dependent_rows(std::vector<int>& rows) const override {
    rows.clear();
    Eigen::MatrixXd Q(kkt_.nv(), rank());
    int found = 0;
    for (int k = 0; k < kkt_.nc(); ++k) {
      Eigen::VectorXd left = kkt_.J.row(k).transpose();
      const double size = std::max(left.lpNorm<Eigen::Infinity>(), kkt_.row_scale.size() > 0 ? kkt_.row_scale[k] : 0);
      for (int pass = 0; pass < 2; ++pass) left -= Q.leftCols(found) * (Q.leftCols(found).transpose() * left).eval();
      if (found < rank() && left.norm() > tolerance::kRank * size)
        Q.col(found++) = left.normalized();
      else
        rows.push_back(k);
    }
    const auto& order = kkt_.choice.colsPermutation().indices();
    if (found < rank()) rows.assign(order.begin() + rank(), order.end());
  }

  double left_of_dropped_rows() const override {
    if (rank() == kkt_.nc() || rank() == kkt_.nv()) return 0;
    return std::abs(kkt_.choice.matrixQR()(rank(), rank()));
  }

  // Subtracts P y, with the projector P = I - J J^+ on the contact rows.
  void project_out(double* y, double* null_component) override {
    if (rank() == kkt_.nc()) return;
    Eigen::VectorXd a(kkt_.nv()), b(kkt_.nc());
    internal::split(*pattern_, y, a, b);
    const Eigen::VectorXd kept = kkt_.J * kkt_.motion(b);
    internal::join(*pattern_, a, kept, y);
    for (int k = 0; null_component && k < kkt_.nc(); ++k)
      null_component[pattern_->iperm[kkt_.nv() + k]] += b[k] - kept[k];
  }
  void project_out_panel(double* X, int ld, int cols) override {
    if (rank() == kkt_.nc()) return;
    auto rows = view(X, ld).leftCols(cols).bottomRows(kkt_.nc());
    const Eigen::MatrixXd a = kkt_.motion(Eigen::MatrixXd(rows));
    rows = kkt_.J * a;
  }

  double projector_error() const override {
    if (rank() == kkt_.nc()) return 0;
    return tolerance::kBoundRounding * std::numeric_limits<double>::epsilon() * std::sqrt(kkt_.nc());
  }

  int nonzeros() const override { return numbers_of_triangle(pattern_->size()); }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> view(double* X, int ld) const { return {X, pattern_->size(), ld}; }

  std::shared_ptr<const KktPattern> pattern_;
  DenseKkt<double> kkt_;
};

}  // namespace

std::unique_ptr<Factor> make_dense_factor() { return std::make_unique<DenseFactor>(); }

}  // namespace manycontact
