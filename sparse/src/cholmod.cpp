#include "manycontact/sparse/cholmod.hpp"

#include <algorithm>
#include <cmath>

#include "cholmod_common.hpp"

namespace manycontact::sparse {

namespace {
constexpr int kColumns = 4;  // number of columns that CHOLMOD's LDL' solves for at a time
}

struct CholmodSymbolic::Impl {
  CholmodCommon common;
  cholmod_factor* factor = nullptr;  // symbolic factor, in the given order
  UpperCsc pattern;
  double nonzeros = 0;

  Impl() = default;
  Impl(const Impl&) = delete;
  ~Impl() { cholmod_free_factor(&factor, &common); }
};

CholmodSymbolic::CholmodSymbolic(const UpperCsc& pattern) : impl_(std::make_unique<Impl>()) {
  CholmodCommon& common = impl_->common;
  impl_->pattern = pattern;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = false;
  cholmod_sparse A = view_of(pattern, nullptr);
  impl_->factor = cholmod_analyze(&A, &common);
  common.check(impl_->factor != nullptr, "symbolic analysis");
  impl_->nonzeros = common.lnz;
}

CholmodSymbolic::~CholmodSymbolic() = default;
int CholmodSymbolic::size() const { return impl_->pattern.n; }
int CholmodSymbolic::factor_nonzeros() const { return static_cast<int>(impl_->nonzeros); }

struct Cholmod::Impl {
  std::shared_ptr<const CholmodSymbolic> shared;
  const CholmodSymbolic::Impl& symbolic;
  CholmodCommon common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  // result and workspace of cholmod_solve2

  explicit Impl(std::shared_ptr<const CholmodSymbolic> s) : shared(std::move(s)), symbolic(*shared->impl_) {}
  Impl(const Impl&) = delete;
  ~Impl() {
    for (cholmod_dense** matrix : {&X, &Y, &E}) cholmod_free_dense(matrix, &common);
    cholmod_free_factor(&factor, &common);
  }

  void allocate() {
    const std::size_t n = symbolic.pattern.n;
    factor = cholmod_copy_factor(symbolic.factor, &common);  // CHOLMOD only reads the shared symbolic factor
    common.check(factor != nullptr, "copy of a symbolic factor");
    common.check(cholmod_change_factor(CHOLMOD_REAL, false, false, false, true, factor, &common), "numeric factor");
    common.check(cholmod_allocate_work(n, 2 * n, n, &common), "workspace");
    for (cholmod_dense** matrix : {&X, &Y}) {
      *matrix = cholmod_allocate_dense(n, kColumns, n, CHOLMOD_REAL, &common);
      common.check(*matrix != nullptr, "workspace");
    }
  }

  // Gives a matrix the required shape: cholmod_solve2 reuses only matrices of this shape, and reallocates others.
  static void shape(cholmod_dense* matrix, std::size_t rows, std::size_t cols) {
    if (!matrix || rows * cols > matrix->nzmax) return;
    matrix->nrow = matrix->d = rows;
    matrix->ncol = cols;
  }

  void solve_some(double* columns, std::size_t cols) {  // solves for at most kColumns columns
    const std::size_t n = symbolic.pattern.n;
    shape(X, n, cols);
    shape(Y, kColumns, n);
    cholmod_dense B{};
    B.nrow = B.d = n;
    B.ncol = cols;
    B.nzmax = n * cols;
    B.x = columns;
    B.xtype = CHOLMOD_REAL;
    B.dtype = CHOLMOD_DOUBLE;
    const bool ran = cholmod_solve2(CHOLMOD_A, factor, &B, nullptr, &X, nullptr, &Y, &E, &common);
    common.check(ran && X, "solve");
    std::copy_n(static_cast<const double*>(X->x), n * cols, columns);
  }
};

Cholmod::Cholmod(std::shared_ptr<const CholmodSymbolic> symbolic) : impl_(std::make_unique<Impl>(std::move(symbolic))) {
  impl_->allocate();
}
Cholmod::~Cholmod() = default;
Cholmod::Cholmod(Cholmod&&) noexcept = default;
Cholmod& Cholmod::operator=(Cholmod&&) noexcept = default;

bool Cholmod::factorize(const double* Ax) {
  if (symbolic().size() == 0) return true;  // CHOLMOD refuses empty matrices
  cholmod_sparse A = view_of(impl_->symbolic.pattern, Ax);
  const bool ran = cholmod_factorize(&A, impl_->factor, &impl_->common);
  impl_->common.check(ran, "factorization");
  return impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

void Cholmod::solve(double* X, int cols) {
  if (symbolic().size() == 0) return;
  for (int first = 0; first < cols; first += kColumns)
    impl_->solve_some(X + static_cast<std::ptrdiff_t>(first) * symbolic().size(), std::min(cols - first, kColumns));
}

void Cholmod::pivots(double* D) const {
  const cholmod_factor& L = *impl_->factor;
  const int* p = static_cast<const int*>(L.p);
  for (std::size_t j = 0; j < L.n; ++j) D[j] = static_cast<const double*>(L.x)[p[j]];
}

void Cholmod::pivot_terms(const double* Ax, double* terms) const {
  const UpperCsc& A = impl_->symbolic.pattern;
  const cholmod_factor& L = *impl_->factor;
  const int *p = static_cast<const int*>(L.p), *rows = static_cast<const int*>(L.i),
            *count = static_cast<const int*>(L.nz);
  const double* x = static_cast<const double*>(L.x);
  for (int k = 0; k < A.n; ++k) terms[k] = std::abs(Ax[A.p[k + 1] - 1]);
  for (int j = 0; j < A.n; ++j) {
    const double d = std::abs(x[p[j]]);
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) terms[rows[k]] += x[k] * x[k] * d;
  }
}

const CholmodSymbolic& Cholmod::symbolic() const { return *impl_->shared; }

}  // namespace manycontact::sparse
