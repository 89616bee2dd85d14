#pragma once
// Every method of the library on a case, judged by the reference.

#include <string>
#include <vector>

#include "case.hpp"
#include "manycontact/dynamics/solve.hpp"

namespace manycontact::attack {

/// What is judged, and may be wrong.
enum class Fault {
  kLoad,       // a file that should be read was refused
  kException,  // of a kind that is not documented
  kNoAnswer,   // `failed` though K's condition is moderate
  kSingular,   // answered though K is singular
  kValue,      // a or f, beyond what rounding explains and beyond the bound that is stated
  kRank,       // none that J may be said to have
  kStatus,
  kCondition,  // not within a factor 10
  kBound,      // an error beyond the bound that is stated for it
  kSilent,     // `ok` or `redundant` with a bound of 1 or more, and wrong by that much
  kDerivative,
  kProduct,    // jvp or vjp, not the derivatives' own
  kNotFinite,  // derivatives
  kQuasiStatic,
  kImpact,
};
std::string to_string(Fault fault);

struct Finding {
  Fault fault;
  std::string method, text;
};

struct Judgement {
  std::vector<Finding> findings;
  bool judged = false;                   // the case had something to be judged
  std::vector<double> bound_over_error;  // of a and f of each island, if the bound is below 1
};

/// Values, status, rank, condition, bounds, derivatives, products and quasi-static torques of a case. Its files are
/// written into `folder`.
Judgement judge(const Case& c, const std::string& folder, const std::vector<Method>& methods);
/// The same of the library's answers to another case, which must have the same sizes: for testing the judge.
Judgement judge_as(const Case& truth, const Case& given, const std::string& folder, const std::vector<Method>& methods);
/// The velocities and impulses when all contacts close at once.
Judgement judge_impact(const Case& c, const std::string& folder, const std::vector<Method>& methods);

/// A smaller case of which `bad` still holds: contacts, links, offsets and digits left out while it does.
template <class Bad>
Case shrunk(Case c, Bad&& bad, int tries = 300);

}  // namespace manycontact::attack

#include "shrink.hpp"
