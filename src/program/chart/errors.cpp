// Computes errors relative to the quadruple-precision solution, in the maximum norm, per quantity and robot.

#include "manycontact/analysis/errors.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/dynamics/views.hpp"
#include "truth.hpp"

namespace manycontact::cli {

namespace {

// Returns the rows of an island's [a; f] that belong to a robot: its accelerations, or the forces of its contacts.
std::vector<int> rows_of(const Scene& scene, const Island& island, int robot, bool forces) {
  std::vector<int> rows;
  if (!forces) {
    const int first = island.dof_offset[local_robot(island, robot)];
    for (int i = 0; i < scene.robots[robot].model->nv; ++i) rows.push_back(first + i);
    return rows;
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    if (contact.A.robot != robot && contact.B.robot != robot) continue;
    for (int i = 0; i < contact.rows(); ++i) rows.push_back(island.nv + island.row_offset[k] + i);
  }
  return rows;
}

// Magnitudes relative to which derivatives that are all zero have errors. They are the robot's largest acceleration
// without contacts, and the largest contact force on it.
struct Scales {
  std::vector<double> a, f;  // one entry per robot
};
Scales scales_of(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  Scales out{{}, largest_forces(scene, data.f_offset, truth.f)};
  for (const Robot& r : scene.robots) out.a.push_back(largest_entry(truth.a_free.segment(r.idx_v, r.model->nv)));
  return out;
}

// Returns the largest error of an island's derivatives. If a block is exactly zero, its finite differences are noise
// below 1e-20 of the robot's other derivatives and scales. The error of such a block is relative to these.
double island_error(const Scene& scene, const ChartTruth::OfIsland& truth, const Scales& scales,
                    const Eigen::MatrixXd& answer) {
  double error = 0;
  for (int robot : truth.island.robots)
    for (const bool forces : {false, true}) {
      const std::vector<int> rows = rows_of(scene, truth.island, robot, forces);
      if (rows.empty()) continue;
      const MatX<Quad> all = truth.derivatives(rows, Eigen::all);
      const double largest = std::max(largest_entry(all), (forces ? scales.f : scales.a)[robot]);
      const double noise = 1e-20 * largest;
      for (int by = 0; by < 3; ++by) {
        const auto columns = Eigen::seq(truth.first[by], truth.first[by + 1] - 1);
        const MatX<Quad> part = all(Eigen::all, columns);
        const Eigen::MatrixXd mine = answer(rows, columns);
        const double difference = largest_entry(mine.cast<Quad>() - part);
        const double own = largest_entry(part), size = own > noise ? own : largest;
        error = sparse::larger_or_nan(error, difference <= noise ? 0 : difference / size);
      }
    }
  return error;
}

// Indices of an island's rows [a; f] and columns [q | v | u] in the matrix of derivatives, which is that of this
// island, or of the whole scene if the method does not split it.
struct PanelPlaces {
  std::vector<int> rows, columns;
};
PanelPlaces places_in(const Scene& scene, const Island& whole, const IslandDerivatives& d, const Island& island) {
  std::vector<int> v, u, f;
  const auto add = [](std::vector<int>& to, int first, int count) {
    for (int i = 0; i < count; ++i) to.push_back(first + i);
  };
  for (int r : island.robots) {
    const int k = local_robot(whole, r);
    add(v, whole.dof_offset[k], scene.robots[r].model->nv);
    add(u, d.u_offset[k], scene.robots[r].model->nu());
  }
  for (int c : island.contacts) {
    const auto k = std::ranges::lower_bound(whole.contacts, c) - whole.contacts.begin();
    add(f, whole.nv + whole.row_offset[k], scene.contacts[c].rows());
  }
  PanelPlaces out{v, {}};
  out.rows.insert(out.rows.end(), f.begin(), f.end());
  for (int i : v) out.columns.push_back(d.q_first + i);
  for (int i : v) out.columns.push_back(d.v_first + i);
  for (int i : u) out.columns.push_back(d.u_first + i);
  return out;
}

}  // namespace

double acceleration_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  Eigen::VectorXd at_least = truth.a_free;
  for (int r = 0; r < scene.nrobots(); ++r)
    if (!truth.at_rest[r]) at_least.segment(scene.robots[r].idx_v, scene.robots[r].model->nv).setZero();
  return worst(acceleration_deviations(scene, data.a, truth.a, at_least)).relative;
}

double force_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  return worst(force_deviations(scene, data.f_offset, data.f, truth.f)).relative;
}

double derivative_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  const Scales scales = scales_of(scene, data, truth);
  double error = 0;
  for (const ChartTruth::OfIsland& of_truth : truth.islands) {
    if (!of_truth.derivatives_known) return NAN;
    const auto i = static_cast<std::size_t>(island_with_robot(data, of_truth.island.robots.front()));
    const IslandDerivatives& d = derivatives(data).islands[i];
    const PanelPlaces places = places_in(scene, solved_island(data, i), d, of_truth.island);
    Eigen::MatrixXd answer = d.X(places.rows, places.columns);
    if (of_truth.along.rows() != of_truth.along.cols()) answer = Eigen::MatrixXd(answer * of_truth.along);
    error = sparse::larger_or_nan(error, island_error(scene, of_truth, scales, answer));
  }
  return error;
}

}  // namespace manycontact::cli
