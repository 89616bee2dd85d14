#pragma once

#include <string>
#include <vector>

#include "case.hpp"
#include "manycontact/dynamics/solve.hpp"

namespace manycontact::attack {

/// Properties that are judged.
enum class Fault {
  kLoad,         // a file that should be read was refused
  kException,    // an exception that is not documented
  kNoAnswer,     // `failed` although K's condition is moderate
  kSingular,     // a solution although K is singular
  kValue,        // an error of a or f beyond rounding errors and beyond the stated bound
  kRank,         // not a possible rank of J
  kStatus,
  kCondition,    // condition estimate wrong by more than a factor of 10
  kBound,        // an error beyond its stated bound
  kSilent,       // `ok` or `redundant` with a bound of 1 or more, and wrong by that much
  kDerivative,
  kProduct,      // jvp or vjp disagree with the derivatives
  kNotFinite,    // derivatives that are not finite
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
  bool judged = false;                   // whether anything in the case could be judged
  std::vector<double> bound_over_error;  // ratios for a and f of each island, if the bound is below 1
};

/// Judges all properties of a case but impacts. Its files are written into `folder`.
Judgement judge(const Case& c, const std::string& folder, const std::vector<Method>& methods);
/// Judges the library's solutions of another case, which must have the same sizes: for testing the judge.
Judgement judge_as(const Case& truth, const Case& given, const std::string& folder, const std::vector<Method>& methods);
/// Judges velocities and impulses when all contacts close at once.
Judgement judge_impact(const Case& c, const std::string& folder, const std::vector<Method>& methods);

/// Returns a smaller case that still satisfies `bad`: contacts, links, offsets and digits are left out while it does.
template <class Bad>
Case shrunk(Case c, Bad&& bad, int tries = 300);

}  // namespace manycontact::attack

#include "shrink.hpp"
