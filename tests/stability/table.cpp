#include "stability/table.hpp"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace manycontact::test {

namespace {

const char* const kNames[] = {"exact",       "refined",   "reordered", "fallback", "redundant",   "inconsistent",
                              "regularised", "in double", "refused",   "WRONG",    "MISLABELLED", "not tried"};

const char kIntroduction[] = R"(# Stability: every case by every method

Results of the library for difficult systems with contacts. Errors are differences from quadruple precision. A number is
right if its error is at most `max(1e-12, 100 eps cond)` and at most 1e-2, and a derivative if its error is at most ten
times the former. `cond` is the 1-norm condition of K, computed here: from the whole (generalised) inverse in long double
or quadruple precision, or from an LU in double if K is large. Derivatives are compared along a direction in q, one in v
and one in u, if K is small and the rank of J does not change nearby.
`test_stability` writes this page with `MANYCONTACT_WRITE_PAGE=1`. It fails if an outcome differs from the one below, or
if a number or a derivative is wrong, whatever the status.

| Letter | Outcome |
|---|---|
| `a` | solved: status `ok` |
| `D` | redundant: contacts are dependent and consistent; unique accelerations, forces of least norm |
| `I` | inconsistent: contacts contradict each other; least squares |
| `G` | regularised: the damping is below rounding errors; the solution without it |
| `d` | solved in double precision, because the requested precision is refused; otherwise as above |
| `-` | refused: status `failed` and NaN, or an exception when the scene is built |
| `W` | **wrong**: a wrong number or derivative, or an exception when solving |
| `M` | **mislabelled**: right numbers, but `ok`, `redundant` and `inconsistent` are mixed up, or no damping was lost |
| `.` | not tried: too large |

The way to a solution is counted, but not compared: it may differ from machine to machine. Whether there is a solution
may not differ. *exact* is the requested method and order with at most one step of refinement, *refined* the same with
more steps. *reordered* is leaf-to-root order because the requested order was not accurate, *fallback* another method.

The last columns are `auto` in single and extended precision. In single precision a number is right if its error is at
most 1e-2 of the largest one, where single precision is refused, and at most the bound that the report states.
[errors.csv](errors.csv) contains the numbers of both charts, which `bench/collection/stability.py` draws. It leaves out four
cases that the library solves, because the reference in quadruple precision does not solve them.

![Error over condition, a chart for each precision](error_over_condition.png)

![Error over its bound](error_over_bound.png)
)";

// Returns how often each way reached each outcome, as columns of a table.
std::string counts_by_way(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "| column | method |";
  for (const char* name : kNames) out << " " << name << " |";
  out << "\n|--:|---|";
  for (std::size_t j = 0; j < std::size(kNames); ++j) out << "--:|";
  out << "\n";
  for (std::size_t k = 0; k < table_ways().size(); ++k) {
    int n[std::size(kNames)] = {};
    for (const Row& row : rows) ++n[static_cast<int>(row.cells[k].outcome)];
    out << "| " << k + 1 << " | " << table_ways()[k].name << " |";
    for (const int count : n) out << " " << count << " |";
    out << "\n";
  }
  return out.str();
}

std::string number(double x) {
  std::ostringstream out;
  out << std::setprecision(1) << std::scientific << x;
  return out.str();
}

}  // namespace

std::string counts(const std::vector<Row>& rows) {
  int n[std::size(kNames)] = {};
  for (const Row& row : rows)
    for (const Cell& cell : row.cells) ++n[static_cast<int>(cell.outcome)];
  std::ostringstream out;
  const char* separator = "";
  for (std::size_t k = 0; k < std::size(kNames); ++k)
    if (n[k] > 0) out << separator << kNames[k] << " " << n[k], separator = ", ";
  return out.str();
}

std::string text_table(const std::string& cause, const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "\n== " << cause << ": " << rows.size() << " cases\n";
  for (const Row& row : rows) {
    double a = 0, f = 0, d = 0, allowed = 0;
    for (const Cell& cell : row.cells) {
      a = worse(a, cell.error_a), f = worse(f, cell.error_f), d = worse(d, cell.error_d);
      allowed = worse(allowed, cell.allowed);
    }
    out << "  " << std::left << std::setw(64) << row.which->name << " " << row.letters() << "  a " << number(a)
        << "  f " << number(f) << "  derivatives " << (row.derivatives ? number(d) : "not known") << "  allowed "
        << number(allowed) << (row.truth ? "" : "  no truth") << "\n";
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const Cell& cell = row.cells[k];
      if (cell.outcome == Outcome::kWrong || cell.outcome == Outcome::kMislabelled)
        out << "      " << kNames[static_cast<int>(cell.outcome)] << " " << judged_ways()[k].name << ": a "
            << number(cell.error_a) << ", f " << number(cell.error_f) << ", derivatives " << number(cell.error_d)
            << ", allowed " << number(cell.allowed) << "; " << cell.note << "\n";
      if (cell.outcome == Outcome::kRefused && row.truth && judged_ways()[k].options.method != Method::kDenseSchur)
        out << "      refused, yet there is an answer: " << judged_ways()[k].name << ": " << cell.note << "\n";
    }
  }
  out << "  " << counts(rows) << "\n";
  return out.str();
}

std::string errors_path() { return MANYCONTACT_SOURCE_DIR "/tests/stability/errors.csv"; }

std::string errors_by_precision(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "asked,solved,condition,error_a,error_f,error_over_bound\n";
  for (std::size_t k = 0; k < table_ways().size(); ++k) {
    const Options& options = table_ways()[k].options;
    if (options.method != Method::kAuto) continue;
    for (const Row& row : rows) {
      const Cell& cell = row.cells[k];
      if (!row.truth || !cell.answered) continue;
      const bool refused = cell.outcome == Outcome::kInDouble;
      out << to_string(options.precision) << "," << to_string(refused ? Precision::kDouble : options.precision) << ","
          << number(cell.condition) << "," << number(cell.error_a) << "," << number(cell.error_f) << ","
          << number(cell.beyond_bound) << "\n";
    }
  }
  return out.str();
}

std::string page_path() { return MANYCONTACT_SOURCE_DIR "/tests/stability/README.md"; }

std::string page(const std::vector<std::pair<std::string, std::vector<Row>>>& causes) {
  std::ostringstream out;
  std::vector<Row> all;
  for (const auto& [cause, rows] : causes) all.insert(all.end(), rows.begin(), rows.end());
  out << kIntroduction << "\n" << all.size() << " cases, by the columns of the tables below:\n\n" << counts_by_way(all);
  for (const auto& [cause, rows] : causes) {
    out << "\n## " << cause << "\n\n| case |";
    for (std::size_t k = 0; k < table_ways().size(); ++k) out << " " << k + 1 << " |";
    out << "\n|---|";
    for (std::size_t k = 0; k < table_ways().size(); ++k) out << "---|";
    out << "\n";
    for (const Row& row : rows) {
      out << "| " << row.which->name << " |";
      for (char c : classes(row.letters())) out << " " << c << " |";
      out << "\n";
    }
  }
  return out.str();
}

std::map<std::string, std::map<std::string, std::string>> read_page() {
  std::map<std::string, std::map<std::string, std::string>> out;
  std::ifstream in(page_path());
  std::string line, cause;
  while (std::getline(in, line)) {
    if (line.starts_with("## ")) cause = line.substr(3);
    if (cause.empty() || !line.starts_with("| ") || line.starts_with("| case |")) continue;
    const std::size_t end = line.find(" |", 2);
    std::string letters;
    for (char c : line.substr(end))
      if (c != ' ' && c != '|') letters += c;
    out[cause][line.substr(2, end - 2)] = letters;
  }
  return out;
}

}  // namespace manycontact::test
