#include <algorithm>
#include <cmath>

#include "../command/rough_time.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/errors.hpp"
#include "solve.hpp"

namespace manycontact::cli {

namespace {

constexpr double kPatience = 2.5e5;  // dense solves with a longer predicted time are left out [us]

// Returns the worst deviation over the robots for which both methods have a solution.
Deviation worst_known(std::vector<Deviation> deviations) {
  std::erase_if(deviations, [](const Deviation& d) { return std::isnan(d.absolute); });
  return worst(deviations);
}

bool dense_answered(const Report& report) {
  return std::ranges::all_of(
      report.islands, [](const IslandReport& r) { return r.method == Method::kDense || r.status == Status::kFailed; });
}

}  // namespace

void print_against_dense(std::ostream& out, const SolvedScene& s) {
  if (dense_answered(s.data.report)) return;
  const Scene& scene = s.file.scene;
  const double rough = rough_time_of_dense(scene, s.data);
  out << "\nComparison with the dense rank-revealing method\n";
  if (rough > kPatience && !s.compare) {
    wrap(out,
         "not compared, because one dense solve would take about " + number(1e-6 * rough, 1) +
             " s; --compare compares in any case",
         2);
    return;
  }
  const int repeat = static_cast<int>(std::clamp(kPatience / rough, 1.0, double(s.repeat)));
  const SolvedScene dense = solve_scene(s.file, {Method::kDense, {}}, repeat);
  // Gravity is the smallest scale of accelerations, because accelerations of a scene at rest are rounding errors.
  const Eigen::VectorXd gravity = Eigen::VectorXd::Constant(scene.nv, scene.gravity.norm());
  const Deviation a = worst_known(acceleration_deviations(scene, s.data.a, dense.data.a, gravity));
  const Deviation f = worst_known(force_deviations(scene, s.data.f_offset, s.data.f, dense.data.f));
  Table table("largest difference<|absolute|relative|<");
  table.add(
      {"accelerations", scientific(a.absolute), scientific(a.relative), "relative to the robot's largest, or gravity"});
  if (s.data.f.size() > 0)
    table.add({"forces", scientific(f.absolute), scientific(f.relative), "relative to the largest on the robot"});
  table.print(out);
  wrap(out,
       "one solve takes " + number(s.time.solve) + " us, one dense solve " + number(dense.time.solve) + " us, " +
           number(dense.time.solve / s.time.solve, 2) + " times as long",
       2);
}

}  // namespace manycontact::cli
