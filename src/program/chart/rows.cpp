#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "chart.hpp"
#include "manycontact/dynamics/views.hpp"
#include "truth.hpp"

namespace manycontact::cli {

namespace {

std::optional<double> known(double error) {
  return std::isfinite(error) ? std::optional(as_written(error)) : std::nullopt;
}

std::string title_of(const Scene& scene, const SceneData& data) {
  return count(scene.nrobots(), "robot") + ", " + count(scene.nv, "velocity coordinate") + ", " +
         count(data.f.size(), "contact row") + ", " + count(island_count(data), "island");
}

void note_truth(const ChartTruth& truth, Chart& chart) {
  const long at_rest = std::ranges::count(truth.at_rest, 1);
  if (at_rest > 0)
    chart.notes.push_back("Accelerations of " + count(at_rest, "robot") +
                          " vanish: they are below 1e-4 of the accelerations without contacts. Errors are relative to "
                          "the latter.");
  if (truth.sampled > 0)
    chart.notes.push_back("Derivatives of " + count(truth.sampled, "island") +
                          " are compared along four random directions each in q, v and u.");
  if (truth.unknown > 0)
    chart.notes.push_back("The exact solution of " + count(truth.unknown, "island") +
                          " is not known: K is singular and too large for dense quadruple precision.");
  else if (truth.unknown_derivatives > 0)
    chart.notes.push_back("The exact derivatives of " + count(truth.unknown_derivatives, "island") +
                          " are not known: at neighbouring states there is no solution, or the rank differs.");
}

// Sets `front` in those rows that no other row dominates in both time and acceleration error.
void mark_front(std::vector<ChartRow>& rows) {
  const auto key = [](const ChartRow& row) { return std::pair(*row.time, *row.error_acceleration); };
  std::vector<ChartRow*> results;
  for (ChartRow& row : rows)
    if (row.outcome == Outcome::kAnswered && row.time && row.error_acceleration) results.push_back(&row);
  std::ranges::sort(results, {}, [&](const ChartRow* row) { return key(*row); });
  const ChartRow* last = nullptr;
  for (ChartRow* row : results) {
    row->front = !last || row->error_acceleration < last->error_acceleration || key(*row) == key(*last);
    if (row->front) last = row;
  }
}

}  // namespace

std::string ChartRow::regularisation() const {
  if (damping == 0) return "none";
  char text[32];
  const int power = static_cast<int>(std::floor(std::log10(damping) + 1e-9));
  std::snprintf(text, sizeof text, "%.6ge%d", damping / std::pow(10.0, power), power);
  return text;
}

double as_written(double x) { return std::strtod(number(x, kDigits).c_str(), nullptr); }

std::vector<ChartRow> list_rows(const Scene& scene) {
  std::vector<double> dampings{scene.damping};
  for (double guess : kGuessedDampings)
    if (guess != scene.damping) dampings.push_back(guess);
  std::vector<ChartRow> rows;
  for (std::size_t k = 0; k < dampings.size(); ++k)
    for (Method method : kMethods) {
      std::vector<std::optional<Order>> orders{std::nullopt};
      if (has_order(method)) orders.assign(std::begin(kOrders), std::end(kOrders));
      for (const auto& order : orders) {
        ChartRow& row = rows.emplace_back();
        row.method = method;
        row.order = order;
        row.damping = dampings[k];
        row.guessed = k > 0;
      }
    }
  return rows;
}

void progress(const std::string& text) {
  static const bool terminal = isatty(STDERR_FILENO);
  if (terminal) std::cerr << "\r\033[K" << text << std::flush;
}

Chart make_chart(const SceneFile& file, const ChartLimits& limits) {
  const Scene& scene = file.scene;
  Chart chart;
  chart.scene = scene.name;
  chart.rows = list_rows(scene);

  SceneData reference(scene, {Method::kSparseLdl, Order::kLeafToRoot});
  (void)solve(scene, file.q, file.v, file.u, reference);
  const ChartTruth truth = find_truth(file, reference);
  estimate_condition(scene, reference);
  chart.condition = reference.report.condition;
  chart.allowed = std::max(1e-12, 100 * std::numeric_limits<double>::epsilon() * chart.condition);
  chart.title = title_of(scene, reference);
  note_truth(truth, chart);

  std::vector<Candidate> candidates;
  for (ChartRow& row : chart.rows) {
    Candidate& c = candidates.emplace_back(Candidate{&row, scene, nullptr});
    c.scene.damping = row.damping;
    c.data = std::make_unique<SceneData>(c.scene, Options{row.method, row.order});
  }
  measure_solve(file, candidates, limits);
  for (Candidate& c : candidates) {
    if (c.row->outcome != Outcome::kAnswered) continue;
    c.row->error_acceleration = known(acceleration_error(scene, *c.data, truth));
    if (c.data->f.size() > 0) c.row->error_forces = known(force_error(scene, *c.data, truth));
  }
  measure_derivatives(candidates, limits,
                      [&](Candidate& c) { c.row->error_derivatives = known(derivative_error(scene, *c.data, truth)); });
  progress("");
  mark_front(chart.rows);
  return chart;
}

}  // namespace manycontact::cli
