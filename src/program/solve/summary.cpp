#include <algorithm>
#include <cmath>
#include <map>

#include "../text/choice.hpp"
#include "../text/describe.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/remedy.hpp"
#include "manycontact/analysis/rounding.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/sparse/largest.hpp"
#include "solve.hpp"

namespace manycontact::cli {

namespace {

std::string status_in_words(const Report& report, double damping) {
  switch (report.status) {
    case Status::kOk:
      return damping > 0 ? "the damped system is solved with small residuals"
                         : "the contacts are independent, and the system is solved with small residuals";
    case Status::kRedundant:
      return "contacts are redundant and consistent; accelerations are exact, and forces that are not unique (*) have "
             "least "
             "norm";
    case Status::kInconsistent:
      return "contacts contradict each other; the accelerations are the least-squares solution";
    case Status::kRegularised:
      return std::ranges::any_of(report.islands,
                                 [](const IslandReport& island) { return island.reason == Reason::kUncertain; })
                 ? "this is the solution of a neighbouring problem: rounding errors may be larger than the solution"
                 : "this is the solution of a neighbouring problem, not of the given problem";
    case Status::kFailed:
      return "at least one island has no solution; accelerations and forces of such islands are NaN";
  }
  return "";
}

struct Alike {  // islands with equal results, which share a line of the summary
  std::vector<const Island*> islands;
  std::size_t number;   // number of the first island
  IslandReport report;  // report of the first island, with the largest residuals, condition and errors of all
};

std::vector<Alike> alike_islands(const SceneData& data) {
  std::map<std::vector<int>, std::size_t> seen;
  std::vector<Alike> out;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& r = data.report.islands[i];
    const Rounding rounding = find_rounding(r);
    const std::vector<int> key{int(r.status),         int(r.method),  int(r.order), int(r.reason), r.changed_order,
                               int(r.precision),      r.nv,           r.nc,         r.rank,        r.factor_nonzeros,
                               rounding.acceleration, rounding.forces};
    const auto [at, fresh] = seen.emplace(key, out.size());
    if (fresh) out.push_back({{}, i, r});
    Alike& alike = out[at->second];
    alike.islands.push_back(&solved_island(data, i));
    const auto keep_larger = [&r, &alike](double IslandReport::*x) {
      alike.report.*x = sparse::larger_or_nan(alike.report.*x, r.*x);
    };
    keep_larger(&IslandReport::residual_dynamics);
    keep_larger(&IslandReport::residual_contact);
    keep_larger(&IslandReport::condition);
    keep_larger(&IslandReport::error_acceleration);
    keep_larger(&IslandReport::error_forces);
    alike.report.refinement_steps = std::max(alike.report.refinement_steps, r.refinement_steps);
  }
  return out;
}

std::string why(const SolvedScene& s, const Alike& kind) {
  const Choice choice = chosen_method(s.data, kind.number);
  std::string text;
  if (s.data.options.method == Method::kAuto)
    text = "auto chose " + why_chosen(choice, predict_costs(*shape_of(s.data, kind.number)), s.data.options);
  const std::string changed = why_changed(choice, kind.report);
  return text + (text.empty() || changed.empty() ? "" : "; ") + changed;
}

// Returns the redundant rows, such as "left_b[0], left_b[1], ... and 4 more", or "" if all rows are independent.
std::string dependent_rows(const SolvedScene& s, const IslandReport& r) {
  constexpr std::size_t kShown = 6;
  if (r.dependent_rows.empty()) return "";
  const std::vector<std::string> names = force_names(s.file.scene, s.data);
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, r.dependent_rows.size()); ++k)
    text += (k ? ", " : "") + names[r.dependent_rows[k]];
  if (r.dependent_rows.size() > kShown) text += ", and " + std::to_string(r.dependent_rows.size() - kShown) + " more";
  return text + (r.dependent_rows.size() == 1 ? " follows" : " follow") + " from the other rows";
}

// Returns the error bounds as text, such as "at most 1.2e-13 of the largest acceleration", or "" if there is none.
std::string errors_in_words(const IslandReport& r) {
  const Rounding rounding = find_rounding(r);
  const auto words = [](bool is_rounding, double error, const std::string& one, const std::string& many) {
    if (is_rounding) return many + " are rounding errors";
    return std::isfinite(error) ? "at most " + scientific(error) + " of the largest " + one : "";
  };
  const std::string a = words(rounding.acceleration, r.error_acceleration, "acceleration", "accelerations");
  const std::string f = r.nc == 0 ? "" : words(rounding.forces, r.error_forces, "force", "forces");
  return a + (a.empty() || f.empty() ? "" : ", ") + f;
}

// Returns the precision that the solve reached, or "" if only double precision was requested.
std::string precision_in_words(const SolvedScene& s, const IslandReport& r) {
  const Precision asked = s.data.options.precision;
  if (asked == Precision::kDouble) return "";
  return to_string(r.precision) + (r.precision == asked ? "" : ", since " + to_string(Reason::kLowPrecision));
}

std::string times(const SolvedScene& s) {
  return "analysis " + number(s.time.symbolic) + " us, set-up " + number(s.time.setup) + " us, one solve " +
         number(s.time.solve) + " us" + (s.repeat > 1 ? " (medians of " + std::to_string(s.repeat) + ")" : "");
}

// Prints one result per line, for all islands together. It is used if all islands have equal results.
void print_one_kind(std::ostream& out, const SolvedScene& s, const Alike& kind) {
  const IslandReport& r = kind.report;
  const auto line = [&out](std::string title, const std::string& text) {
    title.resize(11, ' ');
    if (!text.empty()) wrap(out, text, 2, title);
  };
  const std::string each = kind.islands.size() > 1 ? ", each" : "";
  line("islands", count(kind.islands.size(), "island") + " of " + count(r.nv, "velocity") + " and " +
                      count(r.nc, "contact row") + " (" + islands_name(s.file, kind.islands) + ")");
  if (r.status == Status::kFailed) return line("why", why(s, kind));
  const bool examined = s.file.scene.damping == 0 || r.rank < r.nc;
  line("rank", examined ? std::to_string(r.rank) + " of " + std::to_string(r.nc) + each
                        : "not computed, because damping permits any rank; `inspect` computes the rank");
  line("dependent", dependent_rows(s, r));
  line("method", to_string(r.method) + (has_order(r.method) ? ", " + to_string(r.order) + " order" : ""));
  line("why", why(s, kind));
  line("precision", precision_in_words(s, r));
  line("factor",
       count(r.factor_nonzeros, "non-zero") + each + "; " + count(r.refinement_steps, "step") + " of refinement");
  line("residuals",
       "dynamics " + scientific(r.residual_dynamics) + ", contacts " + scientific(r.residual_contact) + " (relative)");
  line("condition", std::isfinite(r.condition) ? scientific(r.condition) + " (of K, 1-norm)" : "not estimated");
  line("errors", errors_in_words(r));
  line("time", times(s));
}

void print_kinds(std::ostream& out, const SolvedScene& s, const std::vector<Alike>& kinds, std::size_t shown) {
  Table table("islands|robots<22|nv|rows|rank|method<|order<|status<");
  Table worth("islands|robots<22|factor|refined|residual: dynamics|contacts|condition");
  for (std::size_t k = 0; k < shown; ++k) {
    const IslandReport& r = kinds[k].report;
    const std::string n = std::to_string(kinds[k].islands.size()), name = islands_name(s.file, kinds[k].islands);
    table.add({n, name, std::to_string(r.nv), std::to_string(r.nc), std::to_string(r.rank), to_string(r.method),
               has_order(r.method) ? to_string(r.order) : "", to_string(r.status)});
    worth.add({n, name, std::to_string(r.factor_nonzeros), std::to_string(r.refinement_steps),
               scientific(r.residual_dynamics), scientific(r.residual_contact), scientific(r.condition)});
  }
  table.print(out);
  out << "\n";
  worth.print(out);
  print_more(out, kinds.size(), shown, "kinds of island");
  out << "  factor: non-zeros; refined: steps; residuals are relative; condition: of K, 1-norm\n\n";
}

void print_several_kinds(std::ostream& out, const SolvedScene& s, const std::vector<Alike>& kinds) {
  const Report& r = s.data.report;
  const std::size_t shown = kinds.size() <= 9 ? kinds.size() : 8;
  print_kinds(out, s, kinds, shown);
  for (std::size_t k = 0; k < shown; ++k) {
    const std::string text = why(s, kinds[k]), errors = errors_in_words(kinds[k].report);
    std::string both = text + (text.empty() || errors.empty() ? "" : "; errors: ") + errors;
    if (const std::string precision = precision_in_words(s, kinds[k].report); !precision.empty())
      both += (both.empty() ? "precision: " : "; precision: ") + precision;
    if (!both.empty()) wrap(out, both, 2, islands_name(s.file, kinds[k].islands) + ": ");
  }
  wrap(out,
       std::to_string(r.nv) + " velocities, " + std::to_string(r.nc) + " rows of rank " + std::to_string(r.rank) +
           ", " + std::to_string(r.factor_nonzeros) + " non-zeros, residuals " + scientific(r.residual_dynamics) +
           " and " + scientific(r.residual_contact) + ", condition " + scientific(r.condition),
       2, "together: ");
  wrap(out, times(s), 2);
}

// Prints the accuracy of the solution of K x = b, and the condition of K.
void print_quality(std::ostream& out, const SolvedScene& s, const std::vector<Alike>& kinds) {
  constexpr std::size_t kShown = 10;
  Table table("islands|robots<22|backward error: entries|norms|growth|condition|scaled|signature", kShown,
              "kinds of island");
  for (const Alike& kind : kinds) {
    const SystemQuality& of = s.quality[kind.number];
    table.add(
        {std::to_string(kind.islands.size()), islands_name(s.file, kind.islands),
         scientific(of.componentwise_backward_error), scientific(of.normwise_backward_error), scientific(of.growth),
         scientific(of.condition), scientific(of.scaled_condition),
         std::to_string(of.positive) + "+ " + std::to_string(of.negative) + "- " + std::to_string(of.zero) + "x0"});
  }
  out << "\nEquations K x = b\n";
  table.print(out);
  out << "  scaled: the condition with a largest entry of 1 in each row and column; signature: signs of K's "
         "eigenvalues\n";
}

}  // namespace

void print_report(std::ostream& out, const SolvedScene& s) {
  wrap(out, status_in_words(s.data.report, s.file.scene.damping), 0,
       "Status " + to_string(s.data.report.status) + ": ");
  if (const std::string advice = remedy(s.data.report); !advice.empty()) wrap(out, advice, 0, "What to do: ");
  const std::vector<Alike> kinds = alike_islands(s.data);
  out << "\n";
  if (kinds.size() == 1)
    print_one_kind(out, s, kinds[0]);
  else if (!kinds.empty())
    print_several_kinds(out, s, kinds);
  if (!s.quality.empty()) print_quality(out, s, kinds);
}

void print_summary(std::ostream& out, const SolvedScene& s) {
  print_heading(out, s.file, s.data);
  out << "\n";
  print_report(out, s);
  print_findings(out, s.file.scene, s.findings);
  const auto& islands = s.data.report.islands;
  const auto failed = [](const IslandReport& r) { return r.status == Status::kFailed; };
  if (!std::ranges::all_of(islands, failed)) {
    print_accelerations(out, s);
    print_forces(out, s);
  }
  if (s.derivatives) print_derivatives(out, s);
  if (s.quasi_static_u) print_quasi_static(out, s);
  print_against_dense(out, s);
}

}  // namespace manycontact::cli
