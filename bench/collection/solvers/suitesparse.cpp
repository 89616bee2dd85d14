// CHOLMOD's simplicial LDL^T and SuiteSparse's LDL, in AMD's order and without pivoting: fast, for definite systems.

#include <amd.h>
#include <cholmod.h>
extern "C" {
#include <ldl.h>
}

#include <stdexcept>

#include "solver.hpp"

namespace manycontact::collection {

namespace {

struct Cholmod : Solver {
  explicit Cholmod(const System& s) : lower(s.lower), b(s.b) {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = false;
    common.print = 0;
    A.nrow = A.ncol = static_cast<std::size_t>(s.size());
    A.nzmax = static_cast<std::size_t>(lower.nonZeros());
    A.p = lower.outerIndexPtr();
    A.i = lower.innerIndexPtr();
    A.x = lower.valuePtr();
    A.stype = -1;
    A.itype = CHOLMOD_INT;
    A.xtype = CHOLMOD_REAL;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    L = cholmod_analyze(&A, &common);
    if (!L) throw std::runtime_error("CHOLMOD has no factor");
  }
  ~Cholmod() override {
    cholmod_free_factor(&L, &common);
    cholmod_finish(&common);
  }
  Eigen::VectorXd solve() override {
    cholmod_factorize(&A, L, &common);
    if (common.status != CHOLMOD_OK) throw std::runtime_error("a pivot is zero");
    cholmod_dense* rhs = cholmod_allocate_dense(A.nrow, 1, A.nrow, CHOLMOD_REAL, &common);
    std::copy(b.data(), b.data() + b.size(), static_cast<double*>(rhs->x));
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, L, rhs, &common);
    const Eigen::VectorXd out = Eigen::Map<Eigen::VectorXd>(static_cast<double*>(x->x), b.size());
    cholmod_free_dense(&rhs, &common);
    cholmod_free_dense(&x, &common);
    return out;
  }

  Eigen::SparseMatrix<double> lower;
  Eigen::VectorXd b;
  cholmod_common common{};
  cholmod_sparse A{};
  cholmod_factor* L = nullptr;
};

struct Ldl : Solver {
  explicit Ldl(const System& s)
      : n(s.size()),
        full(s.lower.selfadjointView<Eigen::Lower>()),
        b(s.b),
        P(n),
        inverse(n),
        parent(n),
        count(n),
        pattern(n),
        flag(n),
        Lp(n + 1),
        D(n),
        Y(n) {
    if (amd_order(n, full.outerIndexPtr(), full.innerIndexPtr(), P.data(), nullptr, nullptr) != AMD_OK)
      throw std::runtime_error("AMD has no order");
    ldl_symbolic(n, full.outerIndexPtr(), full.innerIndexPtr(), Lp.data(), parent.data(), count.data(), flag.data(),
                 P.data(), inverse.data());
    Li.resize(Lp[n]);
    Lx.resize(Lp[n]);
  }
  Eigen::VectorXd solve() override {
    const int done = ldl_numeric(n, full.outerIndexPtr(), full.innerIndexPtr(), full.valuePtr(), Lp.data(),
                                 parent.data(), count.data(), Li.data(), Lx.data(), D.data(), Y.data(), pattern.data(),
                                 flag.data(), P.data(), inverse.data());
    if (done != n) throw std::runtime_error("a pivot is zero");
    Eigen::VectorXd y(n), x(n), in = b;
    ldl_perm(n, y.data(), in.data(), P.data());
    ldl_lsolve(n, y.data(), Lp.data(), Li.data(), Lx.data());
    ldl_dsolve(n, y.data(), D.data());
    ldl_ltsolve(n, y.data(), Lp.data(), Li.data(), Lx.data());
    ldl_permt(n, x.data(), y.data(), P.data());
    return x;
  }

  int n;
  Eigen::SparseMatrix<double> full;
  Eigen::VectorXd b;
  std::vector<int> P, inverse, parent, count, pattern, flag, Lp, Li;
  std::vector<double> D, Y, Lx;
};

template <class S>
std::unique_ptr<Solver> make(const System& s) {
  return std::make_unique<S>(s);
}

std::string version(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

std::vector<Kind> suitesparse_kinds() {
  return {{"cholmod", "CHOLMOD " + version(CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION), 0,
           make<Cholmod>},
          {"ldl", "LDL " + version(LDL_MAIN_VERSION, LDL_SUB_VERSION, LDL_SUBSUB_VERSION), 0, make<Ldl>}};
}

}  // namespace manycontact::collection
