#pragma once
// What each method does with a case: the outcome by its report, the true error against quadruple precision.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"
#include "stability/cases.hpp"
#include "stability/truths.hpp"
#include "support/methods.hpp"

namespace manycontact::test {

// Up to here the truth in quadruple precision, whose own error is its rounding times the condition, is better than eps.
// Beyond, extended answers by different factors agree to more digits than any has in common with the truth.
inline constexpr double kTrueCondition = 1e15;

enum class Outcome {
  kExact,         // ok, by the method and order asked for, at most one step of refinement
  kRefined,       // the same with more steps
  kReordered,     // ok, in leaf-to-root order, the one asked for was unsound
  kFallback,      // ok, by another method than the one asked for
  kRedundant,     // dependent contacts that agree
  kInconsistent,  // contacts that contradict each other
  kRegularised,   // the damping is lost in rounding: the answer without it
  kInDouble,      // solved, in double: refused in the precision asked for
  kRefused,       // status failed and NaN, or an exception when the scene is built
  kWrong,         // a wrong number or a wrong derivative, or an exception out of solve
  kMislabelled,   // right numbers, but ok, redundant and inconsistent are mixed up, or no damping was lost
  kNotTried,      // too large for it
};
inline constexpr char kLetters[] = "erofDIGd-WM.";
inline char letter(Outcome outcome) { return kLetters[static_cast<int>(outcome)]; }

/// The same with 'a' for e, r, o and f: how an answer came about may depend on the machine's rounding, whether there is
/// one does not.
std::string classes(const std::string& letters);
/// Whether two rows of classes agree. Whether an answer in another precision than double is refused at the edge depends on
/// rounding, too: 'd' is as good as any answer.
bool agree(const std::string& classes, const std::string& others);

struct Cell {
  Outcome outcome = Outcome::kNotTried;
  double error_a = 0, error_f = 0;  // relative, as the contract measures them
  double error_d = 0;               // of derivatives
  double condition = 0;             // the worst island's, as computed here
  double allowed = 0;               // max(1e-12, 100 eps cond), cond as computed here; of derivatives ten times that
  double beyond_bound = 0;          // the true error over the bound of estimate_errors, of a or f, the worst island
  bool answered = false;            // by numbers for all islands
  std::string note;                 // of the report
};

struct Row {
  const Case* which = nullptr;
  bool truth = false;        // there is one
  bool derivatives = false;  // they are known too
  std::vector<Cell> cells;   // as judged_ways()

  std::string letters() const;
};

/// The columns of the page.
const std::vector<Way>& table_ways();
/// These, and sparse-ldl at each level of instructions that runs here: judged alike, but not on the page. The last columns
/// of the page are auto in the other precisions than double.
const std::vector<Way>& judged_ways();

Row judge(const Case& which);

/// The outcome of an answer against the truths that it claims to be (claimed). Public so that the suite's own eye can
/// be tested with wrong answers.
Cell judge_answer(const Problem& p, const Truths& truths, SceneData& data, const Way& way);

}  // namespace manycontact::test
