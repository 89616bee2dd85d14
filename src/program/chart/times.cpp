#include <algorithm>
#include <exception>
#include <numeric>
#include <optional>
#include <random>

#include "../command/rough_time.hpp"
#include "../text/choice.hpp"
#include "chart.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/dynamics/differentiate.hpp"

namespace manycontact::cli {

namespace {

constexpr int kRounds = 201;
constexpr double kTurn = 200;        // calls of a candidate are repeated in each round until they took this time [us]
constexpr double kNoWarmUp = 300e3;  // if the first call takes longer, its time counts, and there is no warm-up [us]
constexpr double kLarge = 4e6;       // matrices of derivatives above this size are released between rounds [bytes]

// Measures a call in one round: calls it once to warm up, and returns the median time of repeated calls.
template <class Call>
double take_turn(Call&& call) {
  const double first = time_of(call);
  if (first > kNoWarmUp) return first;
  std::vector<double> times;
  double sum = 0;
  do {
    times.push_back(time_of(call));
    sum += times.back();
  } while (sum < kTurn);
  return median(std::move(times));
}

// Returns the median time of each of `n` candidates over several rounds. In a round turn(i) measures each candidate
// once, in random order, within its share of `seconds`. A candidate that throws (CHOLMOD out of memory) gets no time.
template <class Turn>
std::vector<std::optional<double>> median_times(std::size_t n, double seconds, const std::string& what, Turn&& turn) {
  std::vector<std::vector<double>> times(n);
  std::vector<double> used(n, 0), last(n, 0);
  std::vector<char> gave_up(n, 0);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937 rng(1);
  const double share = 1e6 * seconds / std::max<double>(1, static_cast<double>(n));
  bool more = true;
  for (int round = 1; more && round <= kRounds; ++round) {
    more = false;
    for (std::size_t k = n; k > 1; --k) std::swap(order[k - 1], order[rng() % k]);
    for (std::size_t i : order) {
      if (gave_up[i] || (round > 1 && used[i] + last[i] > share)) continue;
      progress(what + ", round " + std::to_string(round));
      try {
        last[i] = time_of([&] { times[i].push_back(turn(i)); });
      } catch (const std::exception&) {
        gave_up[i] = 1;
      }
      used[i] += last[i];
      more = true;
    }
  }
  std::vector<std::optional<double>> medians;
  for (std::size_t i = 0; i < n; ++i)
    medians.push_back(gave_up[i] ? std::nullopt : std::optional(as_written(median(std::move(times[i])))));
  return medians;
}

std::string answered_by(const SceneData& data) {
  std::vector<std::string> ways;
  for (const IslandReport& island : data.report.islands) {
    if (island.status == Status::kFailed) continue;
    std::string way = to_string(island.method);
    if (has_order(island.method)) way += " " + to_string(island.order);
    if (std::ranges::find(ways, way) == ways.end()) ways.push_back(way);
  }
  return text::join(ways, ways.size());
}

void note_status(const Candidate& c) {
  ChartRow& row = *c.row;
  if (!row.time) {
    row.outcome = Outcome::kFailed;
    row.status = Status::kFailed;
    return;
  }
  row.status = c.data->report.status;
  row.outcome = row.status == Status::kFailed ? Outcome::kFailed : Outcome::kAnswered;
  if (row.guessed && row.outcome == Outcome::kAnswered) row.status = Status::kRegularised;
  row.answered_by = answered_by(*c.data);
  row.fallback.clear();
  const std::vector<IslandReport>& reports = c.data->report.islands;
  for (std::size_t i = 0; i < reports.size() && row.fallback.empty(); ++i)
    if (reports[i].status != Status::kFailed) row.fallback = why_changed(chosen_method(*c.data, i), reports[i]);
}

// Releases large derivatives, because the derivatives of fifty candidates together would not fit into memory.
void release_large(SceneData& data) {
  double bytes = 0;
  for (const IslandDerivatives& d : derivatives(data).islands) bytes += 8.0 * static_cast<double>(d.X.size());
  if (bytes >= kLarge) release_derivatives(data);
}

}  // namespace

void measure_solve(const SceneFile& file, std::vector<Candidate>& candidates, const ChartLimits& limits) {
  std::vector<Candidate*> run;
  for (Candidate& c : candidates) {
    if (rough_time_of_solve(c.scene, *c.data) > 1e6 * limits.longest)
      c.row->outcome = Outcome::kSkipped;
    else
      run.push_back(&c);
  }
  const auto turn = [&](std::size_t i) {
    Candidate& c = *run[i];
    try {
      return take_turn([&] { (void)solve(c.scene, file.q, file.v, file.u, *c.data); });
    } catch (...) {
      c.data.reset();
      throw;
    }
  };
  const auto times = median_times(run.size(), 0.5 * limits.seconds, "solve", turn);
  for (std::size_t i = 0; i < run.size(); ++i) {
    run[i]->row->time = times[i];
    note_status(*run[i]);
  }
}

void measure_derivatives(std::vector<Candidate>& candidates, const ChartLimits& limits,
                         const std::function<void(Candidate&)>& first) {
  std::vector<Candidate*> run;
  for (Candidate& c : candidates)
    if (c.row->outcome == Outcome::kAnswered && rough_time_of_derivatives(c.scene, *c.data) <= 1e6 * limits.longest)
      run.push_back(&c);
    else
      c.data.reset();  // frees the dense factors of large scenes
  std::vector<char> seen(run.size(), 0);
  const auto turn = [&](std::size_t i) {
    Candidate& c = *run[i];
    try {
      const double time = take_turn([&] { (void)differentiate(c.scene, *c.data); });
      if (!seen[i]) first(c);
      seen[i] = 1;
      release_large(*c.data);
      return time;
    } catch (...) {
      c.data.reset();
      throw;
    }
  };
  const auto times = median_times(run.size(), 0.5 * limits.seconds, "derivatives", turn);
  for (std::size_t i = 0; i < run.size(); ++i) run[i]->row->time_derivatives = times[i];
}

}  // namespace manycontact::cli
