#include "solve.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>

#include "command.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::cli {

namespace {

// Median time of `repeat` calls, us.
template <class Call>
double median_time(int repeat, Call&& call) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  for (int k = 0; k < repeat; ++k) {
    const Clock::time_point start = Clock::now();
    call();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  return 0.5 * (times[(times.size() - 1) / 2] + times[times.size() / 2]);
}

int run_solve(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  const Options options = solver_options(arguments);
  const int repeat = arguments.integer("--repeat", 1, 1000000, 1);

  const SceneFile file = load_scene(path);
  Solution solution = solve_scene(file, options, repeat, arguments.has("--derivatives"));
  if (arguments.has("--quasi-static")) solution.quasi_static_u = quasi_static(file.scene, file.q);
  if (const auto json = arguments.value("--json"))
    write_json(solution, *json);
  else
    print_summary(std::cout, solution);
  return solution.data.report.status <= Status::kInconsistent ? kExitOk : kExitUnsound;
}

}  // namespace

Solution solve_scene(const SceneFile& file, const Options& options, int repeat, bool derivatives) {
  Solution solution{file, SceneData(file.scene, options), {}, repeat, {}, derivatives};
  solution.time.symbolic = median_time(repeat, [&] { const SceneData data(file.scene, options); });
  const auto once = [&] { (void)solve(file.scene, file.q, file.v, file.u, solution.data); };
  once();
  solution.time.solve = median_time(repeat, once);
  if (derivatives) {
    const auto again = [&] { (void)differentiate(file.scene, solution.data); };
    again();
    solution.time.derivatives = median_time(repeat, again);
  }
  estimate_condition(file.scene, solution.data);
  estimate_errors(file.scene, solution.data);
  return solution;
}

const Command& solve_command() {
  static const Command command{
      "solve",
      "SCENE",
      "Accelerations and contact forces of the scene, and what they are worth.",
      {method_option(),
       order_option(),
       {"--derivatives", "", "also those of accelerations and forces with respect to q, v and u"},
       {"--quasi-static", "", "also the torques that hold the scene still"},
       {"--repeat", "N", "times are medians over N solves, after one to warm up"},
       {"--json", "FILE", "write JSON instead of the summary; - is standard output"}},
      "Exit status: 0 ok, redundant, inconsistent; 1 regularised, failed; 2 bad usage or bad input.\n",
      run_solve};
  return command;
}

}  // namespace manycontact::cli
