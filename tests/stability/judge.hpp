#pragma once
// What each method does with a case: the outcome by its report, the true error against quadruple precision.

#include <string>
#include <vector>

#include "manycontact/dynamics/truth.hpp"
#include "stability/cases.hpp"
#include "support/methods.hpp"

namespace manycontact::test {

enum class Outcome {
  kExact,         // ok, by the method and order asked for, at most one step of refinement
  kRefined,       // the same with more steps
  kReordered,     // ok, in leaf-to-root order, the one asked for was unsound
  kFallback,      // ok, by another method than the one asked for
  kRedundant,     // dependent contacts that agree
  kInconsistent,  // contacts that contradict each other
  kRegularised,   // a neighbouring problem's answer
  kRefused,       // status failed and NaN, or an exception when the scene is built
  kWrong,         // a good status and a wrong number, or an exception out of solve
  kMislabelled,   // right numbers, but ok, redundant and inconsistent are mixed up
  kNotTried,      // too large for it
};
inline constexpr char kLetters[] = "erofDIG-WM.";
inline char letter(Outcome outcome) { return kLetters[static_cast<int>(outcome)]; }

/// How an answer came about may depend on the machine's rounding, whether there is one does not.
std::string classes(const std::string& letters);

struct Cell {
  Outcome outcome = Outcome::kNotTried;
  double error_a = 0, error_f = 0;  // relative, as the contract measures them
  double allowed = 0;               // max(1e-12, 100 eps cond)
  double beyond_bound = 0;          // the true error over the bound of estimate_errors, of a or f, the worst island
  bool answered = false;
  std::string note;  // of the report
};

struct Row {
  const Case* which = nullptr;
  bool truth = false;       // there is one
  std::vector<Cell> cells;  // as table_ways()

  std::string letters() const;
};

/// The columns.
const std::vector<Way>& table_ways();

Row judge(const Case& which);

/// The outcome of an answer. Public so that the suite's own eye can be tested with wrong answers.
struct Truths;
Cell judge_answer(const Problem& p, const Truths& truths, SceneData& data, const Way& way);

/// The right answers of a problem, in quadruple precision.
struct Truths {
  explicit Truths(const Problem& p);
  bool exists = false;  // all islands regular, all numbers finite
  VecX<Quad> a, f;
  int rank = 0, rows = 0;  // of J, over all islands
  // of J a + a0 that no acceleration can avoid: relative to its terms, and to gravity or its terms; -1: too large to
  // see
  double contradiction = -1, contradiction_over_gravity = -1;
  Eigen::VectorXd a_free;  // where a or v vanishes: accelerations without contacts, the scale of errors; else empty
  Eigen::VectorXd tau_b;   // S^T u - h
};

}  // namespace manycontact::test
