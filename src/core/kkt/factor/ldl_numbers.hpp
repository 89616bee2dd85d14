#pragma once

#include <memory>
#include <numeric>
#include <vector>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/kkt/pattern.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact::internal {

/// The factors L and D of K, and solves, by the compiled schedule for kSparseLdl if it is not too large.
struct LdlNumbers {
  std::shared_ptr<const KktPattern> pattern;
  const sparse::LdlSchedule* schedule = nullptr;  // nullptr: functions of sparse/ldl.hpp are used
  std::vector<double> L, D;
  std::vector<char> nonzero;  // scratch: flags of rows
  std::vector<int> same;  // the identity permutation 0, 1, 2 ...

  /// Prepares for a pattern. method: kSparseLdl uses the schedule, kSuiteSparseLdl uses SuiteSparse's LDL.
  void take(const std::shared_ptr<const KktPattern>& p, Method method) {
    pattern = nullptr;  // remains nullptr if an allocation throws
    schedule = method == Method::kSparseLdl && p->schedule().compiled() ? &p->schedule() : nullptr;
    L.resize(p->ldl.nonzeros());
    D.resize(p->size());
    nonzero.resize(p->size());
    same.resize(p->size());
    std::iota(same.begin(), same.end(), 0);
    pattern = p;
  }

  /// Computes L, D of the matrix with values Ax, and pivots' terms in scratch.scale; least, most: see
  /// PanelKernels::factor. False: SuiteSparse's LDL ended at a zero pivot. Otherwise the caller must check the pivots.
  bool factor(const double* Ax, const double* least, int most, FactorScratch& scratch) {
    if (scratch.scale.size() < D.size()) scratch.scale.resize(D.size());
    if (schedule) {
      sparse::panel_kernels().factor(*schedule, Ax, least, most, L.data(), D.data(), scratch.scale.data());
      return true;
    }
    if (least) {
      sparse::ldl_factor_by_rows(pattern->K, pattern->ldl, Ax, least, scratch.ldl, L.data(), D.data(),
                                 scratch.scale.data());
      return true;
    }
    const bool complete =
        sparse::ldl_factor(pattern->K, pattern->ldl, Ax, scratch.ldl, L.data(), D.data()) == pattern->size();
    sparse::pivot_terms(pattern->K, pattern->ldl, Ax, L.data(), D.data(), scratch.scale.data());
    return complete;
  }

  void solve(double* x) const {
    if (schedule)
      sparse::panel_kernels().solve_vector(*schedule, L.data(), D.data(), x);
    else
      sparse::ldl_solve(pattern->ldl, L.data(), D.data(), x);
  }
  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) const {
    const int* perm = pattern->perm.data();
    if (schedule)
      sparse::panel_kernels().solve(*schedule, L.data(), D.data(), perm, X, ld, first, cols, nonzero, work());
    else
      sparse::ldl_solve_panel(pattern->ldl, L.data(), D.data(), perm, X, ld, first, cols, nonzero);
  }

  /// Solves for the first `cols` columns of a row-major panel with row stride ld, whose rows are in K's order.
  void solve_in_order(double* X, int ld, int cols) {
    if (cols == 1 && ld == 1) return solve(X);
    if (!schedule) return sparse::ldl_solve_panel(pattern->ldl, L.data(), D.data(), nullptr, X, ld, 0, cols, nullptr);
    std::fill(nonzero.begin(), nonzero.end(), 1);
    sparse::panel_kernels().solve(*schedule, L.data(), D.data(), same.data(), X, ld, 0, cols, nonzero.data(), work());
  }

  /// Returns scratch memory for panels, shared by a thread's factors so that it stays in the cache.
  double* work() const {
    thread_local std::vector<double> memory;
    const std::size_t size = schedule ? sparse::panel_kernels().work_size(*schedule) : 2 * D.size();
    if (memory.size() < size) memory.resize(size);
    return memory.data();
  }
  int nonzeros() const { return pattern->ldl.nonzeros() + pattern->size(); }
};

}  // namespace manycontact::internal
