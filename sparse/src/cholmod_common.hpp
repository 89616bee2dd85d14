#pragma once
// For all calls of CHOLMOD. Names in cholmod.h collide with other names, so a unity build cannot have these sources.

#include <cholmod.h>

#include <new>
#include <stdexcept>
#include <string>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// CHOLMOD's parameters, workspace and status. Only one thread at a time may use an object.
struct CholmodCommon : cholmod_common {
  CholmodCommon() {
    cholmod_start(this);
    print = 0;
    error_handler = nullptr;
    final_asis = 1;
    final_ll = 0;
    supernodal = CHOLMOD_SIMPLICIAL;
    nmethods = 1;
    grow2 = 0;  // columns of L get exactly the memory that they need
  }
  CholmodCommon(const CholmodCommon&) = delete;
  ~CholmodCommon() { cholmod_finish(this); }

  /// Throws if the last call failed. A zero pivot is not a failure. ran: the call's result; call: its name in messages.
  void check(bool ran, const char* call) const {
    if (status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (!ran || status < CHOLMOD_OK) throw std::runtime_error(std::string("Cholmod: ") + call + " failed");
  }
};

/// Returns a view of a symmetric matrix for CHOLMOD's LDL', without a copy. Ax: values; nullptr for the pattern alone.
inline cholmod_sparse view_of(const UpperCsc& A, const double* Ax) {
  cholmod_sparse out{};
  out.nrow = out.ncol = A.n;
  out.nzmax = A.nonzeros();
  out.p = const_cast<int*>(A.p.data());
  out.i = const_cast<int*>(A.i.data());
  out.x = const_cast<double*>(Ax);
  out.stype = 1;
  out.itype = CHOLMOD_INT;
  out.xtype = Ax ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  out.dtype = CHOLMOD_DOUBLE;
  out.sorted = out.packed = 1;
  return out;
}

}  // namespace manycontact::sparse
