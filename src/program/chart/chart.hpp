#pragma once
// The command `manycontact chart`, which measures times and errors of every method, order and damping on a scene.

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
  double seconds = 16;  // total time of repeated measurements of a scene [s]
  double longest = 20;  // calls that are predicted to take longer are skipped [s]
};

enum class Outcome { kAnswered, kFailed, kSkipped };

/// The number of significant digits of times and errors in a chart. Results that differ only by rounding errors become
/// equal, and the Pareto front is computed from the rounded numbers.
inline constexpr int kDigits = 6;
double as_written(double x);

/// One mark on the chart. Errors are relative to a solution of the scene in quadruple precision, in the maximum norm.
/// They are the largest of all robots and blocks of derivatives, and missing if there is no such solution.
struct ChartRow {
  Method method = Method::kAuto;
  std::optional<Order> order;
  double damping = 0;
  bool guessed = false;  // whether the damping differs from the scene's

  Outcome outcome = Outcome::kAnswered;
  Status status = Status::kOk;             // status of the last solve; kRegularised if it used a guessed damping
  std::string answered_by;                 // methods and orders that solved the islands: "sparse-ldl leaf-to-root"
  std::string fallback;                    // why an island was solved by another method than `method`
  std::optional<double> time;              // time of a solve [us]
  std::optional<double> time_derivatives;  // time of derivatives [us]
  std::optional<double> error_acceleration, error_forces, error_derivatives;
  bool front = false;  // whether the row is on the Pareto front of time and acceleration error

  std::string regularisation() const;  // returns the damping as text, such as "1e-6", or "none" for 0
};

struct Chart {
  std::string scene, title;  // name, with the path if several scenes share it; "82 velocities, 48
                             // contact rows, 1 island"
  std::string picture;       // file name without extension
  std::vector<ChartRow> rows;
  double allowed = 0;  // allowed error of a and f, max(1e-12, 100 eps condition); of derivatives ten times that
  double condition = 0;
  std::vector<std::string> notes;  // explanations of large or missing errors
};

/// Measures all rows. Shows progress on standard error.
Chart make_chart(const SceneFile& file, const ChartLimits& limits);

// ---- steps of make_chart ------------------------------------------------------------------------------------------

struct Candidate {  // a row of the chart, with the scene and the data with which it is computed
  ChartRow* row = nullptr;
  Scene scene;  // the scene, but with the row's damping
  std::unique_ptr<SceneData> data;
};

/// Returns a row for every method, order and damping. The dampings are those guessed and the scene's.
std::vector<ChartRow> list_rows(const Scene& scene);

/// Sets the times of the rows to medians over rounds. Each round measures every candidate once, so that changes of the
/// machine's speed affect all candidates. Slow candidates are left out of later rounds.
void measure_solve(const SceneFile& file, std::vector<Candidate>& candidates, const ChartLimits& limits);
/// Sets the times of derivatives in the rows; requires measure_solve. Calls first(candidate) once while its
/// derivatives are available.
void measure_derivatives(std::vector<Candidate>& candidates, const ChartLimits& limits,
                         const std::function<void(Candidate&)>& first);

/// Overwrites the current line of standard error by `text` if that is a terminal. An empty text clears the line.
void progress(const std::string& text);

// ---- output files -------------------------------------------------------------------------------------------------

void write_csv(const std::vector<Chart>& charts, const std::string& path);  // throws InputError on failure
/// Writes chart.json for src/program/charts/chart.py, as write_csv. scenes: number of scenes, even without a chart.
void write_json(const std::vector<Chart>& charts, std::size_t scenes, const std::string& path);

}  // namespace manycontact::cli
