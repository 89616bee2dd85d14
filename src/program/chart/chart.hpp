#pragma once
// `manycontact chart`: times and errors of every method, order and regularisation on a scene.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// Dampings that the chart tries in addition to the scene's own damping.
inline constexpr double kGuessedDampings[] = {1e-12, 1e-9, 1e-6, 1e-3};

struct ChartLimits {
  double seconds = 16;  // s: total time of repeated measurements of a scene
  double longest = 20;  // seconds: a call that would take roughly longer is skipped
};

enum class Outcome { kAnswered, kFailed, kSkipped };

/// Significant digits of times and errors in a chart. Rounding makes results equal that differ by rounding errors, and
/// the Pareto front is computed from the rounded numbers.
inline constexpr int kDigits = 6;
double as_written(double x);

/// One mark on the chart. Errors are relative to a solution of the scene in quadruple precision, in the maximum norm,
/// the worst over robots (and blocks of derivatives). They are missing if there is no such solution.
struct ChartRow {
  Method method = Method::kAuto;
  std::optional<Order> order;
  double damping = 0;
  bool guessed = false;  // the damping is not the scene's

  Outcome outcome = Outcome::kAnswered;
  Status status = Status::kOk;             // last solve's status; kRegularised if it succeeded with a guessed damping
  std::string answered_by;                 // methods and orders that solved islands, joined: "sparse-ldl leaf-to-root"
  std::string fallback;                    // why the first island with another method than `method` used it
  std::optional<double> time;              // time of a solve, us
  std::optional<double> time_derivatives;  // us
  std::optional<double> error_acceleration, error_forces, error_derivatives;
  bool front = false;  // whether the row is on the Pareto front of time and acceleration error

  /// Returns the damping as text, "1e-6", or "none" for 0.
  std::string regularisation() const;
};

struct Chart {
  std::string scene, title;  // name, with the path if several scenes share it; "82 velocities, 48
                             // contact rows, 1 island"
  std::string picture;       // file name, without ending
  std::vector<ChartRow> rows;
  double allowed = 0;  // allowed error of a and f: max(1e-12, 100 eps condition); derivatives: ten times `allowed`
  double condition = 0;
  std::vector<std::string> notes;  // explanations of large or missing errors
};

/// Measures all rows, with a progress line on standard error.
Chart make_chart(const SceneFile& file, const ChartLimits& limits);

// ---- steps of make_chart ------------------------------------------------------------------------------------------

/// A row of the chart, with the scene and data that compute it.
struct Candidate {
  ChartRow* row = nullptr;
  Scene scene;  // the scene with the row's damping
  std::unique_ptr<SceneData> data;
};

/// Returns a row for every method, order, and damping: the scene's and the guessed dampings.
std::vector<ChartRow> list_rows(const Scene& scene);

/// Sets the rows' times: medians over rounds. Each round measures every candidate once, so that changes of the
/// machine's speed affect all candidates. Slow candidates are left out of later rounds.
void measure_solve(const SceneFile& file, std::vector<Candidate>& candidates, const ChartLimits& limits);
/// Measures derivatives after measure_solve. Calls `first` once per candidate while its derivatives are available.
void measure_derivatives(std::vector<Candidate>& candidates, const ChartLimits& limits,
                         const std::function<void(Candidate&)>& first);

/// If standard error is a terminal, overwrites its current line; "" clears the line.
void progress(const std::string& text);

// ---- output files -------------------------------------------------------------------------------------------------

/// Writes chart.csv. Throws InputError if it cannot be written, as write_json.
void write_csv(const std::vector<Chart>& charts, const std::string& path);
/// Writes chart.json, for src/program/charts/chart.py. scenes: number of scenes, including scenes without a chart.
void write_json(const std::vector<Chart>& charts, std::size_t scenes, const std::string& path);

}  // namespace manycontact::cli
