// The text about a chart's rows, and the page that shows all charts.

#include <algorithm>
#include <cmath>
#include <map>

#include "../files/output_file.hpp"
#include "../text/table.hpp"
#include "chart.hpp"

namespace manycontact::cli {

namespace {

std::string name_of(const ChartRow& row) {
  return to_string(row.method) + (row.order ? " " + to_string(*row.order) : "");
}

std::string error_text(const std::optional<double>& e) { return e ? scientific(*e) : "unknown"; }

bool accurate(const Chart& chart, const ChartRow& row) {
  return row.outcome == Outcome::kAnswered && row.time && row.error_acceleration &&
         *row.error_acceleration <= chart.allowed;
}

// The fastest of the scene's own damping that is as accurate as allowed; `with`: also of derivatives.
const ChartRow* winner(const Chart& chart, int panel, bool with_auto) {
  const ChartRow* best = nullptr;
  for (const ChartRow& row : chart.rows) {
    if (row.guessed || !accurate(chart, row) || !panel_time(row, panel)) continue;
    if (!with_auto && row.method == Method::kAuto) continue;
    if (!best || *panel_time(row, panel) < *panel_time(*best, panel)) best = &row;
  }
  return best;
}

const ChartRow* auto_row(const Chart& chart) {
  for (const ChartRow& row : chart.rows)
    if (row.method == Method::kAuto && !row.guessed) return &row;
  return nullptr;
}

// "sparse-ldl camd (12 us, error 1e-15) wins; dense-schur takes 5 times as long."
std::string who_wins(const Chart& chart) {
  const ChartRow* best = winner(chart, 0, false);
  if (!best) return "No method is as accurate as allowed (" + scientific(chart.allowed) + ").";
  std::string text = "Fastest of the accurate ones is " + name_of(*best) + ": " + number(*best->time) +
                     " us, error of accelerations " + error_text(best->error_acceleration);
  if (const ChartRow* d = winner(chart, 2, false))
    text += "; with derivatives " + name_of(*d) + ": " + number(*panel_time(*d, 2)) + " us";
  for (const ChartRow& row : chart.rows)
    if (row.method == Method::kDenseSchur && !row.guessed && row.outcome == Outcome::kAnswered && row.time)
      text += "; dense-schur, the baseline, takes " + number(*row.time / *best->time, 2) + " times as long";
  return text + ".";
}

std::string where_auto_lies(const Chart& chart) {
  const ChartRow* mine = auto_row(chart);
  const ChartRow* best = winner(chart, 0, false);
  if (!mine || mine->outcome != Outcome::kAnswered || !best) return "auto has no solution to compare.";
  std::string text = "auto (" + mine->answered_by + ") takes " + number(*mine->time) + " us, " +
                     number(*mine->time / *best->time) + " times the time of the fastest accurate one, and is " +
                     (mine->front ? "" : "not ") + "on the front";
  if (const ChartRow* d = winner(chart, 2, false); d && mine->time_derivatives)
    text += "; with derivatives " + number(*panel_time(*mine, 2) / *panel_time(*d, 2)) + " times";
  return text + ".";
}

// Medians over methods of the errors a guessed damping brings.
std::string what_damping_costs(const Chart& chart) {
  std::map<double, std::vector<double>> a, d;
  std::map<double, std::string> name;
  for (const ChartRow& row : chart.rows) {
    if (!row.guessed || row.outcome != Outcome::kAnswered) continue;
    name[row.damping] = row.regularisation();
    if (row.error_acceleration) a[row.damping].push_back(*row.error_acceleration);
    if (row.error_derivatives) d[row.damping].push_back(*row.error_derivatives);
  }
  const auto median = [](std::vector<double> x) {
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
  };
  std::vector<std::string> parts;
  for (const auto& [damping, errors] : a)
    parts.push_back(name[damping] + " gives " + scientific(median(errors)) +
                    (d.count(damping) ? " (derivatives " + scientific(median(d[damping])) + ")" : ""));
  return parts.empty() ? "" : "A guessed damping costs accuracy, median error of accelerations: " + join(parts) + ".";
}

std::string what_fails(const Chart& chart) {
  std::vector<std::string> failed, skipped, inaccurate;
  std::map<std::string, std::vector<std::string>> fallbacks;  // by what happened
  for (const ChartRow& row : chart.rows) {
    const std::string name = name_of(row) + (row.guessed ? " with damping " + row.regularisation() : "");
    if (row.outcome == Outcome::kFailed) failed.push_back(name);
    if (row.outcome == Outcome::kSkipped || (row.outcome == Outcome::kAnswered && !row.time_derivatives))
      skipped.push_back(name);
    if (row.guessed || row.outcome != Outcome::kAnswered) continue;
    if (row.error_acceleration && !accurate(chart, row)) inaccurate.push_back(name);
    if (!row.fallback.empty()) fallbacks[row.fallback].push_back(name);
  }
  std::string text;
  const auto say = [&](const std::string& what, const std::vector<std::string>& names) {
    if (!names.empty()) text += (text.empty() ? "" : " ") + what + ": " + join(names, 6) + ".";
  };
  say("Failed", failed);
  say("Skipped, or its derivatives, as too slow or too large", skipped);
  say("Less accurate than allowed", inaccurate);
  for (const auto& [what, names] : fallbacks) say("Tried twice, as " + what, names);
  return text.empty() ? "Nothing fails." : text;
}

}  // namespace

std::vector<std::string> describe(const Chart& chart) {
  std::vector<std::string> out{who_wins(chart), where_auto_lies(chart), what_damping_costs(chart), what_fails(chart)};
  out.insert(out.end(), chart.notes.begin(), chart.notes.end());
  std::erase(out, "");
  return out;
}

void write_page(const std::vector<Chart>& charts, const std::vector<std::string>& images, const std::string& path) {
  OutputFile page(path);
  std::ostream& out = page.stream();
  out << "# Accuracy against speed\n\n"
         "Written by `manycontact chart`; the numbers are in [chart.csv](chart.csv). A point is one method, order and\n"
         "damping. Right is slower than the fastest one, up is a larger error, relative to a solution of the scene in\n"
         "quadruple precision. A point is on the front if no other one is at least as fast and as accurate, and\n"
         "better in one of the two; `chart.csv` marks the front of solve time and accelerations.\n"
         "Times depend on the machine and its load: compare those of this page with each other alone. `./run chart` "
         "also\n"
         "draws `overview.png` here. Its open marks only factor and solve a given K, without kinematics and assembly, "
         "and\n"
         "Pinocchio's `constraintDynamics` does one proximal iteration in it.\n\n"
         "| Scene | fastest accurate | us | auto | us | auto / fastest | auto on the front |\n"
         "|---|---|--:|---|--:|--:|---|\n";
  for (const Chart& chart : charts) {
    const ChartRow* best = winner(chart, 0, false);
    const ChartRow* mine = auto_row(chart);
    const bool both = best && mine && mine->time;
    out << "| " << printable(chart.scene) << " | " << (best ? name_of(*best) : "") << " | "
        << (best ? number(*best->time) : "") << " | " << (mine ? mine->answered_by : "") << " | "
        << (both ? number(*mine->time) : "") << " | " << (both ? number(*mine->time / *best->time) : "") << " | "
        << (mine && mine->front ? "yes" : "no") << " |\n";
  }
  for (std::size_t k = 0; k < charts.size(); ++k) {
    out << "\n## " << printable(charts[k].scene) << "\n\n" << charts[k].title << ".\n\n";
    for (const std::string& sentence : describe(charts[k])) out << sentence << "\n";
    if (!images[k].empty()) out << "\n![" << printable(charts[k].scene) << "](" << images[k] << ".svg)\n";
  }
  page.close();
}

}  // namespace manycontact::cli
