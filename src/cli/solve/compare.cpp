// The sparse answer against the dense oracle's.

#include <algorithm>
#include <cmath>

#include "../common/choice.hpp"
#include "../common/describe.hpp"
#include "solve.hpp"
#include "../common/table.hpp"

namespace manycontact::cli {

namespace {

constexpr double kPatience = 5e6;  // us of predicted dense time

// Largest difference, and the same relative to the robot's or island's own scale.
struct Difference {
  double absolute = 0, relative = 0;
  void add(double difference, double scale) {
    absolute = std::max(absolute, difference);
    if (difference > 0) relative = std::max(relative, difference / scale);
  }
};

double largest(const Eigen::Ref<const Eigen::VectorXd>& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(); }

// Accelerations of a scene at rest are rounding: gravity's is their scale then.
Difference compare_accelerations(const Scene& scene, const SceneData& x, const SceneData& y) {
  Difference d;
  for (const Robot& robot : scene.robots) {
    const auto a = x.a.segment(robot.idx_v, robot.model->nv), b = y.a.segment(robot.idx_v, robot.model->nv);
    if (a.allFinite() && b.allFinite()) d.add(largest(a - b), std::max(largest(b), scene.gravity.norm()));
  }
  return d;
}

Difference compare_forces(const Scene& scene, const SceneData& x, const SceneData& y) {
  Difference d;
  for (const IslandData& island : x.islands) {
    double difference = 0, scale = 0;
    for (int c : island.island.contacts) {
      const auto f = x.f.segment(x.f_offset[c], scene.contacts[c].rows());
      const auto g = y.f.segment(y.f_offset[c], scene.contacts[c].rows());
      if (!f.allFinite() || !g.allFinite()) continue;
      difference = std::max(difference, largest(f - g));
      scale = std::max(scale, largest(g));
    }
    d.add(difference, scale);
  }
  return d;
}

// Predicted, us; 0 when dense answered everything already.
double cost_of_dense(const Solution& s) {
  double cost = 0;
  bool all = true;
  for (std::size_t i = 0; i < s.data.islands.size(); ++i) {
    const IslandReport& r = s.data.report.islands[i];
    cost += predicted_dense(s.data.islands[i]);
    all = all && (r.method == Method::kDense || r.status == Status::kFailed);
  }
  return all ? 0 : cost;
}

}  // namespace

void print_against_dense(std::ostream& out, const Solution& s) {
  const double cost = cost_of_dense(s);
  if (cost == 0) return;
  out << "\nAgainst the dense rank-revealing method\n";
  if (cost > kPatience) {
    wrap(out, "left out: one solve would take about " + number(1e-6 * cost, 2) + " s", 2);
    return;
  }
  const int repeat = static_cast<int>(std::clamp(kPatience / cost, 1.0, double(s.repeat)));
  const Solution dense = solve_scene(s.file, {Method::kDense, {}}, repeat);
  const Difference a = compare_accelerations(s.file.scene, s.data, dense.data);
  const Difference f = compare_forces(s.file.scene, s.data, dense.data);
  Table table({{"largest difference", Table::kLeft}, {"absolute"}, {"relative"}, {"", Table::kLeft}});
  table.add({"accelerations", scientific(a.absolute), scientific(a.relative), "to the robot's largest, or gravity"});
  if (s.data.f.size() > 0)
    table.add({"forces", scientific(f.absolute), scientific(f.relative), "to the island's largest"});
  table.print(out);
  wrap(out,
       "one solve " + number(s.time.solve) + " us, dense " + number(dense.time.solve) +
           " us: " + number(dense.time.solve / s.time.solve, 2) + " times as long",
       2);
}

}  // namespace manycontact::cli
