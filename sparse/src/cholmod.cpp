#include "manycontact/sparse/cholmod.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace manycontact::sparse {

bool supernodal_available() { return MANYCONTACT_GPL != 0; }

struct Cholmod::Impl {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  // CHOLMOD's workspace of solve2, kept between calls
  UpperCsc pattern;
  CholmodKind kind;

  Impl(const UpperCsc& A, CholmodKind k) : pattern(A), kind(k) { cholmod_start(&common); }
  Impl(const Impl&) = delete;
  ~Impl() {
    cholmod_free_dense(&X, &common);
    cholmod_free_dense(&Y, &common);
    cholmod_free_dense(&E, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  // A view of the pattern with the values Ax; copies nothing.
  cholmod_sparse view(const double* Ax) {
    cholmod_sparse A{};
    A.nrow = A.ncol = pattern.n;
    A.nzmax = pattern.nonzeros();
    A.p = pattern.p.data();
    A.i = pattern.i.data();
    A.x = const_cast<double*>(Ax);
    A.stype = 1;
    A.itype = CHOLMOD_INT;
    A.xtype = Ax ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    return A;
  }
};

Cholmod::Cholmod(const UpperCsc& pattern, CholmodKind kind, bool order_rows)
    : impl_(std::make_unique<Impl>(pattern, kind)) {
  if (kind == CholmodKind::kSupernodalLlt && !supernodal_available())
    throw std::invalid_argument("Cholmod: this build leaves out CHOLMOD's supernodal part (MANYCONTACT_GPL=OFF)");
  cholmod_common& c = impl_->common;
  c.print = 0;
  c.error_handler = nullptr;
  c.final_asis = 1;
  c.final_ll = kind == CholmodKind::kSupernodalLlt;
  c.supernodal = kind == CholmodKind::kSupernodalLlt ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
  c.nmethods = 1;
  c.method[0].ordering = order_rows ? CHOLMOD_AMD : CHOLMOD_NATURAL;
  c.postorder = order_rows;
  cholmod_sparse A = impl_->view(nullptr);
  impl_->factor = cholmod_analyze(&A, &c);
  if (!impl_->factor) throw std::runtime_error("Cholmod: symbolic analysis failed");
}

Cholmod::~Cholmod() = default;
Cholmod::Cholmod(Cholmod&&) noexcept = default;
Cholmod& Cholmod::operator=(Cholmod&&) noexcept = default;

bool Cholmod::factorize(const double* Ax) {
  cholmod_sparse A = impl_->view(Ax);
  const bool ran = cholmod_factorize(&A, impl_->factor, &impl_->common);
  return ran && impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

void Cholmod::solve(double* B, int cols) {
  cholmod_dense b{};
  b.nrow = b.d = impl_->pattern.n;
  b.ncol = cols;
  b.nzmax = b.nrow * b.ncol;
  b.x = B;
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, impl_->factor, &b, nullptr, &impl_->X, nullptr, &impl_->Y, &impl_->E, &impl_->common);
  if (!impl_->X) throw std::runtime_error("Cholmod: solve failed");
  std::copy_n(static_cast<const double*>(impl_->X->x), b.nzmax, B);
}

void Cholmod::pivots(double* D) const {
  const cholmod_factor& L = *impl_->factor;
  const int* p = static_cast<const int*>(L.p);
  for (std::size_t j = 0; j < L.n; ++j) D[j] = static_cast<const double*>(L.x)[p[j]];
}

double Cholmod::smallest_pivot_ratio(const double* Ax, double* scale) const {
  const UpperCsc& A = impl_->pattern;
  const cholmod_factor& L = *impl_->factor;
  const int *p = static_cast<const int*>(L.p), *rows = static_cast<const int*>(L.i),
            *count = static_cast<const int*>(L.nz);
  const double* x = static_cast<const double*>(L.x);
  for (int k = 0; k < A.n; ++k) scale[k] = std::abs(Ax[A.p[k + 1] - 1]);
  double ratio = 1;
  for (int j = 0; j < A.n; ++j) {  // column j is final once columns before it were added
    const double d = std::abs(x[p[j]]);
    if (!(d >= ratio * scale[j])) ratio = d > 0 && std::isfinite(scale[j]) ? d / scale[j] : 0;
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) scale[rows[k]] += x[k] * x[k] * d;
  }
  return ratio;
}

double Cholmod::rcond() const { return cholmod_rcond(impl_->factor, &impl_->common); }
int Cholmod::factor_nonzeros() const { return static_cast<int>(impl_->common.lnz); }
double Cholmod::flops() const { return impl_->common.fl; }

}  // namespace manycontact::sparse
