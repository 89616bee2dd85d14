#pragma once
// Judges each method on each case, by the reported outcome and the true error in quadruple precision.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"
#include "stability/cases.hpp"
#include "stability/truths.hpp"
#include "support/methods.hpp"

namespace manycontact::test {

// Up to this condition, the quadruple-precision truth, with an error of eps_quad times the condition, is more accurate
// than double's eps. Beyond, extended solutions agree better with each other than with the truth.
inline constexpr double kTrueCondition = 1e15;

enum class Outcome {
  kExact,         // ok, with the requested method and order, at most one step of refinement
  kRefined,       // ok, with the requested method and order and more steps
  kReordered,     // ok, in leaf-to-root order, because the requested one was unsound
  kFallback,      // ok, with another method than requested
  kRedundant,     // dependent, consistent contacts
  kInconsistent,  // inconsistent contacts
  kRegularised,   // the damping is lost in rounding errors: the solution without damping
  kInDouble,      // solved in double, since the requested precision was refused
  kRefused,       // status failed and NaN, or an exception when the scene is built
  kWrong,         // a wrong number or a wrong derivative, or an exception out of solve
  kMislabelled,   // right numbers, wrong status: ok, redundant and inconsistent are mixed up, or no damping was lost
  kNotTried,      // too large for the method
};
inline constexpr char kLetters[] = "erofDIGd-WM.";
inline char letter(Outcome outcome) { return kLetters[static_cast<int>(outcome)]; }

/// Returns the letters with 'a' for e, r, o, f: rounding errors may change how, but not whether, a solution is found.
std::string classes(const std::string& letters);
/// Whether two rows of classes agree. 'd' agrees with any solution, since rounding errors decide refusals, too.
bool agree(const std::string& classes, const std::string& others);

struct Cell {
  Outcome outcome = Outcome::kNotTried;
  double error_a = 0, error_f = 0;  // relative, in the maximum norm, for the worst robot
  double error_d = 0;               // error of derivatives
  double condition = 0;             // the worst island's, as computed here
  double allowed = 0;               // max(1e-12, 100 eps cond), cond as computed here; of derivatives ten times that
  double beyond_bound = 0;          // the true error over the bound of estimate_errors, of a or f, the worst island
  bool answered = false;            // there are numbers for all islands
  std::string note;
};

struct Row {
  const Case* which = nullptr;
  bool truth = false;        // whether the truth exists
  bool derivatives = false;  // derivatives are known too
  std::vector<Cell> cells;   // as in judged_ways()

  std::string letters() const;
};

/// Returns the columns of the page.
const std::vector<Way>& table_ways();
/// Returns these, and sparse-ldl at each instruction level of this machine, which is judged but not on the page. The
/// last columns of the page are auto in the precisions other than double.
const std::vector<Way>& judged_ways();

Row judge(const Case& which);

/// Compares a solution with the truths that it claims and returns the outcome. Public for tests with wrong solutions.
Cell judge_answer(const Problem& p, const Truths& truths, SceneData& data, const Way& way);

}  // namespace manycontact::test
