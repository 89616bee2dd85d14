// MUMPS, sequential: a multifrontal LDL^T with pivoting, with its defaults and with two steps of refinement.

#include "solver.hpp"

#ifdef MANYCONTACT_MUMPS
#include <dmumps_c.h>

#include <stdexcept>
#endif

namespace manycontact::collection {

#ifdef MANYCONTACT_MUMPS

namespace {

struct Mumps : Solver {
  Mumps(const System& s, int refinement) : b(s.b) {
    for (int j = 0; j < s.lower.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(s.lower, j); it; ++it) {
        rows.push_back(static_cast<int>(it.row()) + 1);
        columns.push_back(j + 1);
        values.push_back(it.value());
      }
    m.comm_fortran = -987654;  // the default communicator
    m.par = 1;
    m.sym = 2;  // symmetric, indefinite
    call(-1);
    for (int k : {0, 1, 2, 3}) m.icntl[k] = k == 3 ? 0 : -1;  // silent
    m.icntl[9] = refinement;
    m.icntl[13] = 200;  // percent of additional memory, for delayed pivots
    m.n = s.size();
    m.nnz = static_cast<MUMPS_INT8>(values.size());
    m.irn = rows.data();
    m.jcn = columns.data();
    m.a = values.data();
    call(1);
  }
  ~Mumps() override {
    m.job = -2;
    dmumps_c(&m);
  }
  Eigen::VectorXd solve() override {
    Eigen::VectorXd x = b;
    m.rhs = x.data();
    call(2);
    call(3);
    return x;
  }
  void call(int job) {
    m.job = job;
    dmumps_c(&m);
    if (m.infog[0] < 0) throw std::runtime_error("MUMPS answers " + std::to_string(m.infog[0]));
  }

  Eigen::VectorXd b;
  std::vector<int> rows, columns;
  std::vector<double> values;
  DMUMPS_STRUC_C m{};
};

template <int refinement>
std::unique_ptr<Solver> make(const System& s) {
  return std::make_unique<Mumps>(s, refinement);
}

}  // namespace

std::vector<Kind> mumps_kinds() {
  const std::string version = std::string("MUMPS ") + MUMPS_VERSION;
  return {{"mumps", version, 0, make<0>}, {"mumps_refined", version, 0, make<2>}};
}

#else

std::vector<Kind> mumps_kinds() { return {}; }

#endif

}  // namespace manycontact::collection
