#include <limits>

#include "expand.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

// Returns the smallest ratio of a Cholesky pivot to its diagonal entry; zero if a pivot is denormal (without digits).
double smallest_pivot(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::VectorXd& diagonal) {
  double ratio = 1;
  for (int k = 0; k < diagonal.size(); ++k) {
    const double pivot = llt.matrixLLT()(k, k) * llt.matrixLLT()(k, k);
    ratio = std::min(ratio, pivot < std::numeric_limits<double>::min() ? 0 : pivot / diagonal[k]);
  }
  return ratio;
}

class DenseSchurFactor final : public Factor {
 public:
  Method method() const override { return Method::kDenseSchur; }

  Reason factorize(const KktMatrix& K, FactorScratch&) override {
    pattern_ = K.pattern;
    inverted_ = false;
    internal::expand(K, M_, J_);
    if (!M_.allFinite() || !J_.allFinite()) return Reason::kNotFinite;
    // Not resized: if memory runs out, Eigen's resize is not safe, and for an empty matrix info() is undefined.
    if (llt_M_.rows() != K.nv()) llt_M_ = Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd::Identity(K.nv(), K.nv()));
    llt_M_.compute(M_);
    if (llt_M_.info() != Eigen::Success) return Reason::kSingularInertia;
    if (smallest_pivot(llt_M_, M_.diagonal()) < tolerance::kPivotLeft) return Reason::kSingularInertia;
    Z_ = J_.transpose();
    if (Z_.cols() == 0) return Reason::kNone;
    llt_M_.matrixL().solveInPlace(Z_);  // Z = L^-1 J^T
    S_.setZero(K.nc(), K.nc());
    S_.selfadjointView<Eigen::Lower>().rankUpdate(Z_.transpose());  // S = Z^T Z + delta I
    S_.diagonal().array() += K.damping;
    if (llt_S_.rows() != K.nc()) llt_S_ = Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd::Identity(K.nc(), K.nc()));
    llt_S_.compute(S_);
    if (llt_S_.info() != Eigen::Success) return Reason::kSmallPivot;
    if (K.damping == 0 && (K.nc() > K.nv() || pivots_pass_on())) return Reason::kSmallPivot;
    return smallest_pivot(llt_S_, S_.diagonal()) < tolerance::kPivotLeft ? Reason::kSmallPivot : Reason::kNone;
  }

  // Computes [a; y] from [b1; b2] with the Cholesky factor L of M: w = L^-1 b1, S y = Z^T w - b2, a = L^-T (w - Z y).
  void solve(double* x) override {
    a_.resize(pattern_->nv);
    y_.resize(pattern_->nc);
    internal::split(*pattern_, x, a_, y_);
    llt_M_.matrixL().solveInPlace(a_);
    if (y_.size() > 0) {
      y_ = Z_.transpose() * a_ - y_;
      llt_S_.solveInPlace(y_);
      a_.noalias() -= Z_ * y_;
    }
    llt_M_.matrixU().solveInPlace(a_);
    internal::join(*pattern_, a_, y_, x);
  }

  void solve_panel(double* X, int ld, int first, int cols, char*) override {  // an explicit K^-1, as in Crocoddyl
    invert();
    auto panel = Eigen::Map<RowMajor>(X, pattern_->size(), ld).middleCols(first, cols);
    const RowMajor product = inverse_ * panel;
    panel = product;
  }
  bool panel_is_like_solve() const override { return false; }

  void release_panels() override {
    inverted_ = false;
    inverse_ = Eigen::MatrixXd();
  }

  int rank() const override { return pattern_->nc; }
  int nonzeros() const override { return numbers_of_triangle(pattern_->size()); }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // Whether a pivot of S may consist only of rounding errors that an earlier small pivot of S enlarged.
  bool pivots_pass_on() const {
    rank::PassedOn<double> passed_on;
    for (int k = 0; k < S_.rows(); ++k) {
      const double l = llt_S_.matrixLLT()(k, k);
      if (!passed_on.accepts(false, l * l / S_(k, k))) return true;
    }
    return false;
  }

  // Computes K^-1 = [Mi - Y Si Y^T, Y Si; Si Y^T, -Si] with Mi = M^-1, Y = Mi J^T, Si = S^-1, as a full matrix.
  void invert() {
    if (inverted_) return;
    const Eigen::Index nv = M_.rows(), nc = J_.rows();
    inverse_.resize(nv + nc, nv + nc);
    auto Mi = inverse_.topLeftCorner(nv, nv);
    Mi = llt_M_.solve(Eigen::MatrixXd::Identity(nv, nv));
    inverted_ = nc == 0;
    if (inverted_) return;
    const Eigen::MatrixXd Y = Mi * J_.transpose();
    const Eigen::MatrixXd Si = llt_S_.solve(Eigen::MatrixXd::Identity(nc, nc));
    inverse_.topRightCorner(nv, nc).noalias() = Y * Si;
    Mi.noalias() -= inverse_.topRightCorner(nv, nc) * Y.transpose();
    inverse_.bottomLeftCorner(nc, nv) = inverse_.topRightCorner(nv, nc).transpose();
    inverse_.bottomRightCorner(nc, nc) = -Si;
    inverted_ = true;
  }

  std::shared_ptr<const KktPattern> pattern_;
  Eigen::MatrixXd M_, J_, Z_, S_, inverse_;  // nv x nv, nc x nv, L^-1 J^T, J M^-1 J^T + delta I, K^-1
  // members of a default LLT are uninitialised, and copying them is undefined
  Eigen::LLT<Eigen::MatrixXd> llt_M_{Eigen::MatrixXd::Identity(1, 1)}, llt_S_ = llt_M_;
  bool inverted_ = false;
  Eigen::VectorXd a_, y_;
};

}  // namespace

std::unique_ptr<Factor> make_dense_schur_factor() { return std::make_unique<DenseSchurFactor>(); }

std::unique_ptr<Factor> make_factor(Method method, std::shared_ptr<IslandShape> shape) {
  switch (method) {
    case Method::kDense:
      return make_dense_factor();
    case Method::kDenseSchur:
      return make_dense_schur_factor();
    case Method::kSparseCholmod:
      return make_cholmod_factor(std::move(shape));
    case Method::kSparseBodies:  // a factor of K as a fallback; the factor of the body-space system is BodyFactor
      return make_ldl_factor(Method::kSparseLdl);
    default:
      return make_ldl_factor(method);
  }
}

}  // namespace manycontact
