#include "solve.hpp"

#include <algorithm>
#include <iostream>

#include "../command/command.hpp"
#include "../command/rough_time.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/analysis/unique_forces.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/kkt/choose.hpp"

namespace manycontact::cli {

namespace {

// Returns the median time [us] of `repeat` calls of call(). before() runs before each call and is not timed.
template <class Before, class Call>
double median_time(int repeat, Before&& before, Call&& call) {
  std::vector<double> times;
  for (int k = 0; k < repeat; ++k) {
    before();
    times.push_back(time_of(call));
  }
  return median(std::move(times));
}
template <class Call>
double median_time(int repeat, Call&& call) {
  return median_time(
      repeat, [] {}, call);
}

// Repeats the symbolic analyses of set-up and first solve: the patterns that the choice of a method compares, and
// CHOLMOD's factorization if CHOLMOD is chosen. An island whose shape is already in `shapes` only costs a look-up.
void analyse(const Scene& scene, const std::vector<Island>& islands, const Options& options, ShapeCache& shapes) {
  for (const Island& island : islands) {
    const std::size_t known = shapes.size();
    IslandShape& shape = *shapes.find(scene, island);
    if (shapes.size() == known) continue;
    const Choice choice = choose(shape, options);
    if (choice.method == Method::kSparseBodies)
      (void)shape.bodies();
    else
      (void)shape.pattern(choice.order);
    if (choice.method == Method::kSparseCholmod) (void)shape.cholmod(choice.order);
  }
}

double time_of_analysis(const Scene& scene, const SceneData& data, int repeat) {
  const Scene& solved = scene_solved(scene, data);
  std::vector<Island> islands;
  for (std::size_t i = 0; i < island_count(data); ++i) islands.push_back(solved_island(data_solved(data), i));
  std::optional<ShapeCache> shapes;
  return median_time(
      repeat, [&] { shapes.emplace(); }, [&] { analyse(solved, islands, data.options, *shapes); });
}

// Makes a SceneData `repeat` times, and sets `time` to the median time.
SceneData set_up(const Scene& scene, const Options& options, int repeat, double& time) {
  std::optional<SceneData> data;
  time = median_time(
      repeat, [&] { data.reset(); }, [&] { data.emplace(scene, options); });
  return std::move(*data);
}

/// Throws UsageError if the JSON document, whose matrices are dense, would fill memory and disk.
void check_size_of_json(const Scene& scene) {
  constexpr double kMost = 1e8;
  double rows = scene.nv;
  for (const Contact& contact : scene.contacts) rows += contact.active ? contact.rows() : 0;
  const double numbers = rows * (2.0 * scene.nv + scene.nu);
  if (numbers > kMost)
    throw UsageError("--derivatives with --json would write dense matrices of " + number(numbers) +
                     " numbers, expected at most " + number(kMost) +
                     ": omit one of them; in the library differentiate() gives the derivatives by islands");
}

}  // namespace

SolvedScene solve_scene(const SceneFile& file, const Options& options, int repeat, bool derivatives) {
  const Scene& scene = file.scene;
  Times time;
  SolvedScene s{file, set_up(scene, options, repeat, time.setup), {}, repeat, {}, derivatives};
  time.symbolic = time_of_analysis(scene, s.data, repeat);
  const auto once = [&] { (void)solve(scene, file.q, file.v, file.u, s.data); };
  once();
  time.solve = median_time(repeat, once);
  if (derivatives) {
    DerivativeRequest request;
    request.wrenches = !scene.wrenches.empty();
    const auto again = [&] { (void)differentiate(scene, s.data, request); };
    again();
    time.derivatives = median_time(repeat, again);
    s.derivative_errors = estimate_derivative_errors(scene, s.data);
  }
  s.time = time;
  estimate_condition(scene, s.data);
  estimate_errors(scene, s.data);
  return s;
}

int run_solve(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  Options options = solver_options(arguments);
  options.threads = arguments.integer("--threads", 1, kMostThreads, 1);
  const int repeat = arguments.integer("--repeat", 1, 1000000, 1);

  check_files(arguments, {path}, {"--json"});
  const SceneFile file = load_scene(path);
  check_files(arguments, file.files, {"--json"});
  if (arguments.has("--derivatives") && arguments.value("--json")) check_size_of_json(file.scene);
  SolvedScene solved = solve_scene(file, options, repeat, arguments.has("--derivatives"));
  solved.findings = find(file, solved.data);
  solved.unique = unique_forces(file.scene, file.q, solved.data);
  if (arguments.has("--quality")) solved.quality = system_quality(file.scene, solved.data);
  solved.compare = arguments.has("--compare");
  if (arguments.has("--quasi-static")) {
    solved.quasi_static_u = quasi_static(file.scene, file.q, &solved.unbalanced);
    // For robots with u="gravity", the findings of the file already report that they do not remain at rest.
    for (const Unbalanced& x : solved.unbalanced)
      if (!std::ranges::binary_search(file.gravity_robots, x.robot)) solved.findings.unbalanced.push_back(x);
  }
  if (const auto json = arguments.value("--json"))
    write_json(solved, *json);
  else
    print_summary(std::cout, solved);
  return solved.data.report.ok() ? kExitOk : kExitUnsound;
}

}  // namespace manycontact::cli
