#include "manycontact/sparse/cholmod.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>

#include "manycontact/sparse/ordering.hpp"

namespace manycontact::sparse {

namespace {

// CHOLMOD's parameters, workspace and status: one per thread at a time.
struct Common : cholmod_common {
  Common() {
    cholmod_start(this);
    print = 0;
    error_handler = nullptr;
    final_asis = 1;
    nmethods = 1;
    grow2 = 0;  // columns of L get the memory they need, no more
  }
  Common(const Common&) = delete;
  ~Common() { cholmod_finish(this); }

  // Throws when the last call failed; a matrix that is not positive definite is no failure.
  void check(bool ran, const char* call) const {
    if (status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (!ran || status < CHOLMOD_OK) throw std::runtime_error(std::string("Cholmod: ") + call + " failed");
  }
};

// A view of a triangle of a symmetric matrix; copies nothing.
cholmod_sparse view(const UpperCsc& A, const double* Ax, bool lower) {
  cholmod_sparse out{};
  out.nrow = out.ncol = A.n;
  out.nzmax = A.nonzeros();
  out.p = const_cast<int*>(A.p.data());
  out.i = const_cast<int*>(A.i.data());
  out.x = const_cast<double*>(Ax);
  out.stype = lower ? -1 : 1;
  out.itype = CHOLMOD_INT;
  out.xtype = Ax ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  out.dtype = CHOLMOD_DOUBLE;
  out.sorted = out.packed = 1;
  return out;
}

// Positions in A of the values of P = A permuted by iperm.
std::vector<int> permuted_slots(const UpperCsc& A, const std::vector<int>& iperm, const UpperCsc& P) {
  std::vector<int> from(P.nonzeros());
  for (int j = 0; j < A.n; ++j)
    for (int k = A.p[j]; k < A.p[j + 1]; ++k) {
      const auto [row, col] = std::minmax(iperm[A.i[k]], iperm[j]);
      from[P.slot(row, col)] = k;
    }
  return from;
}

// The lower triangle by columns, i.e. the upper one by rows, and the places of its values in the upper one.
UpperCsc transposed(const UpperCsc& A, std::vector<int>& from) {
  UpperCsc T;
  T.n = A.n;
  T.p.assign(A.n + 1, 0);
  T.i.resize(A.nonzeros());
  from.resize(A.nonzeros());
  for (int row : A.i) ++T.p[row + 1];
  for (int j = 0; j < A.n; ++j) T.p[j + 1] += T.p[j];
  std::vector<int> next(T.p.begin(), T.p.end() - 1);
  for (int j = 0; j < A.n; ++j)
    for (int k = A.p[j]; k < A.p[j + 1]; ++k) {
      const int to = next[A.i[k]]++;
      T.i[to] = j;
      from[to] = k;
    }
  return T;
}

}  // namespace

bool supernodal_available() { return MANYCONTACT_GPL != 0; }

// CHOLMOD copies a matrix before it factorizes it, each time, unless it gets the triangle it works on in the order of
// elimination: the upper one for LDL', the lower one for LL'. So the order is CHOLMOD's, but permuting is done here.
struct CholmodSymbolic::Impl {
  CholmodKind kind;
  Common common;
  cholmod_factor* factor = nullptr;  // symbolic, in the natural order
  std::vector<int> perm;             // row eliminated k-th; empty: k
  UpperCsc triangle;                 // pattern of the permuted matrix, as CHOLMOD works on it (for LL' a lower one)
  std::vector<int> from;             // positions of its values in the pattern's slots; empty: the same
  double nonzeros = 0;

  explicit Impl(CholmodKind k) : kind(k) {}
  Impl(const Impl&) = delete;
  ~Impl() { cholmod_free_factor(&factor, &common); }

  bool supernodal() const { return kind == CholmodKind::kSupernodalLlt; }

  void analyze(const UpperCsc& A, bool order, bool supernodal) {
    cholmod_free_factor(&factor, &common);
    common.final_ll = this->supernodal();
    common.supernodal = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common.method[0].ordering = order ? CHOLMOD_AMD : CHOLMOD_NATURAL;
    common.postorder = order;
    cholmod_sparse pattern = view(A, nullptr, false);
    factor = cholmod_analyze(&pattern, &common);
    common.check(factor != nullptr, "symbolic analysis");
  }
};

CholmodSymbolic::CholmodSymbolic(const UpperCsc& pattern, CholmodKind kind, bool order_rows)
    : impl_(std::make_unique<Impl>(kind)) {
  Impl& s = *impl_;
  if (s.supernodal() && !supernodal_available())
    throw std::invalid_argument("Cholmod: this build leaves out CHOLMOD's supernodal part (MANYCONTACT_GPL=OFF)");
  s.triangle = pattern;
  if (order_rows) {
    s.analyze(pattern, true, false);
    const int* perm = static_cast<const int*>(s.factor->Perm);
    s.perm.assign(perm, perm + pattern.n);
    const std::vector<int> iperm = inverse(s.perm);
    s.triangle = permute(pattern, iperm);
    s.from = permuted_slots(pattern, iperm, s.triangle);
  }
  s.analyze(s.triangle, false, s.supernodal());
  s.nonzeros = s.common.lnz;
  if (!s.supernodal()) return;
  std::vector<int> upper;
  s.triangle = transposed(s.triangle, upper);
  if (order_rows)
    for (int& k : upper) k = s.from[k];
  s.from = std::move(upper);
}

CholmodSymbolic::~CholmodSymbolic() = default;
int CholmodSymbolic::size() const { return impl_->triangle.n; }
int CholmodSymbolic::factor_nonzeros() const { return static_cast<int>(impl_->nonzeros); }

struct Cholmod::Impl {
  std::shared_ptr<const CholmodSymbolic> shared;
  const CholmodSymbolic::Impl& symbolic;
  Common common;
  cholmod_factor* factor = nullptr;
  std::vector<double> values;  // numbers of `triangle`, where they are not the caller's unchanged
  int most_cols;               // columns solved for at once: as LDL' does in any case, or enough for the BLAS
  std::vector<double> b;       // right-hand sides, permuted
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  // solve2's result and workspace

  explicit Impl(std::shared_ptr<const CholmodSymbolic> s)
      : shared(std::move(s)), symbolic(*shared->impl_), most_cols(symbolic.supernodal() ? 64 : 4) {}
  Impl(const Impl&) = delete;
  ~Impl() {
    for (cholmod_dense** matrix : {&X, &Y, &E}) cholmod_free_dense(matrix, &common);
    cholmod_free_factor(&factor, &common);
  }

  void allocate() {
    const bool super = symbolic.supernodal();
    const std::size_t n = symbolic.triangle.n, cols = most_cols;
    common.final_ll = super;
    common.supernodal = super ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    values.resize(symbolic.from.size());
    factor = cholmod_copy_factor(symbolic.factor, &common);  // reads
    common.check(factor != nullptr, "copy of a symbolic factor");
    common.check(cholmod_change_factor(CHOLMOD_REAL, super, super, super, true, factor, &common), "numeric factor");
    const std::size_t supernodes = super ? factor->nsuper : 0;
    common.check(cholmod_allocate_work(n, 2 * n + 5 * supernodes, super ? 0 : n, &common), "workspace");
    const auto make = [&](cholmod_dense*& matrix, std::size_t rows) {
      matrix = cholmod_allocate_dense(rows, cols, rows, CHOLMOD_REAL, &common);
      common.check(matrix != nullptr, "workspace");
    };
    b.resize(symbolic.perm.empty() ? 0 : n * cols);
    make(X, n), make(Y, n);
    if (super) make(E, factor->maxesize);
  }

  // solve2 keeps a matrix of exactly the shape it wants, and replaces others.
  static void shape(cholmod_dense* matrix, std::size_t rows, std::size_t cols) {
    if (!matrix || rows * cols > matrix->nzmax) return;
    matrix->nrow = matrix->d = rows;
    matrix->ncol = cols;
  }

  // cols <= most_cols
  void solve_some(double* columns, std::size_t cols) {
    const std::size_t n = symbolic.triangle.n;
    shape(X, n, cols);
    if (symbolic.supernodal())
      shape(Y, n, cols), shape(E, cols, factor->maxesize);
    else
      shape(Y, most_cols, n);
    const std::vector<int>& perm = symbolic.perm;
    for (std::size_t c = 0; c < cols && !perm.empty(); ++c)
      for (std::size_t k = 0; k < n; ++k) b[c * n + k] = columns[c * n + perm[k]];
    cholmod_dense B{};
    B.nrow = B.d = n;
    B.ncol = cols;
    B.nzmax = n * cols;
    B.x = perm.empty() ? columns : b.data();
    B.xtype = CHOLMOD_REAL;
    B.dtype = CHOLMOD_DOUBLE;
    const bool ran = cholmod_solve2(CHOLMOD_A, factor, &B, nullptr, &X, nullptr, &Y, &E, &common);
    common.check(ran && X, "solve");
    const double* x = static_cast<const double*>(X->x);
    for (std::size_t c = 0; c < cols; ++c)
      for (std::size_t k = 0; k < n; ++k) columns[c * n + (perm.empty() ? k : perm[k])] = x[c * n + k];
  }
};

Cholmod::Cholmod(std::shared_ptr<const CholmodSymbolic> symbolic) : impl_(std::make_unique<Impl>(std::move(symbolic))) {
  impl_->allocate();
}
Cholmod::Cholmod(const UpperCsc& pattern, CholmodKind kind, bool order_rows)
    : Cholmod(std::make_shared<const CholmodSymbolic>(pattern, kind, order_rows)) {}
Cholmod::~Cholmod() = default;
Cholmod::Cholmod(Cholmod&&) noexcept = default;
Cholmod& Cholmod::operator=(Cholmod&&) noexcept = default;

bool Cholmod::factorize(const double* Ax) {
  const CholmodSymbolic::Impl& s = impl_->symbolic;
  if (s.triangle.n == 0) return true;  // CHOLMOD calls that invalid
  for (std::size_t k = 0; k < s.from.size(); ++k) impl_->values[k] = Ax[s.from[k]];
  cholmod_sparse A = view(s.triangle, s.from.empty() ? Ax : impl_->values.data(), s.supernodal());
  const bool ran = cholmod_factorize(&A, impl_->factor, &impl_->common);
  impl_->common.check(ran, "factorization");
  return impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

void Cholmod::solve(double* X, int cols) {
  if (symbolic().size() == 0) return;
  for (int first = 0; first < cols; first += impl_->most_cols)
    impl_->solve_some(X + static_cast<std::ptrdiff_t>(first) * symbolic().size(),
                      std::min(cols - first, impl_->most_cols));
}

void Cholmod::pivots(double* D) const {
  const cholmod_factor& L = *impl_->factor;
  const int* p = static_cast<const int*>(L.p);
  for (std::size_t j = 0; j < L.n; ++j) D[j] = static_cast<const double*>(L.x)[p[j]];
}

void Cholmod::pivot_terms(const double* Ax, double* terms) const {
  const CholmodSymbolic::Impl& s = impl_->symbolic;
  const UpperCsc& A = s.triangle;
  const cholmod_factor& L = *impl_->factor;
  const int *p = static_cast<const int*>(L.p), *rows = static_cast<const int*>(L.i),
            *count = static_cast<const int*>(L.nz);
  const double* x = static_cast<const double*>(L.x);
  for (int k = 0; k < A.n; ++k) {
    const int diagonal = A.p[k + 1] - 1;
    terms[k] = std::abs(Ax[s.from.empty() ? diagonal : s.from[diagonal]]);
  }
  for (int j = 0; j < A.n; ++j) {
    const double d = std::abs(x[p[j]]);
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) terms[rows[k]] += x[k] * x[k] * d;
  }
}

void Cholmod::parts_left(double* left) const {
  const CholmodSymbolic::Impl& s = impl_->symbolic;
  const cholmod_factor& L = *impl_->factor;
  const int *first = static_cast<const int*>(L.super), *row = static_cast<const int*>(L.pi),
            *at = static_cast<const int*>(L.px);
  const double* x = static_cast<const double*>(L.x);
  for (std::size_t super = 0; super < L.nsuper; ++super) {
    const int rows = row[super + 1] - row[super];  // length of a column of the block, which is triangular at its head
    for (int j = first[super]; j < first[super + 1]; ++j) {
      const double l = x[at[super] + (j - first[super]) * (rows + 1)];
      left[j] = l * l / impl_->values[s.triangle.p[j]];
    }
  }
}
const CholmodSymbolic& Cholmod::symbolic() const { return *impl_->shared; }
int Cholmod::factor_nonzeros() const { return symbolic().factor_nonzeros(); }

}  // namespace manycontact::sparse
