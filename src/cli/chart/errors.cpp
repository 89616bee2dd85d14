// Errors against the truth: relative, in the maximum norm, per quantity and robot (design.md, section 4).

#include <algorithm>
#include <cmath>

#include "truth.hpp"

namespace manycontact::cli {

namespace {

// The larger; NaN when either is.
double worse(double a, double b) { return b <= a ? a : a != a ? a : b; }

template <class X, class T>
double difference_of(const X& x, const T& truth) {
  double out = 0;
  for (Eigen::Index j = 0; j < truth.cols(); ++j)
    for (Eigen::Index i = 0; i < truth.rows(); ++i) {
      using std::abs;
      out = worse(out, static_cast<double>(abs(Quad(x(i, j)) - truth(i, j))));
    }
  return out;
}

template <class T>
double size_of(const T& truth) {
  return difference_of(Eigen::MatrixXd::Zero(truth.rows(), truth.cols()), truth);
}

double relative(double difference, double size) { return difference == 0 ? 0 : difference / size; }

// A robot's rows of an island's [a; f]: its accelerations, or the forces of the contacts it is part of.
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

// What a robot's derivatives are compared with when all of them are zero: its accelerations without contacts, the
// forces on it.
double scale_of(const Scene& scene, const SceneData& data, const ChartTruth& truth, int robot, bool forces) {
  const Robot& r = scene.robots[robot];
  if (!forces) return truth.a_free.segment(r.idx_v, r.model->nv).cwiseAbs().maxCoeff();
  double size = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (data.f_offset[c] < 0 || (contact.A.robot != robot && contact.B.robot != robot)) continue;
    size = worse(size, size_of(truth.f.segment(data.f_offset[c], contact.rows())));
  }
  return size;
}

// Where a block of derivatives is zero in truth, differences leave noise, below 1e-20 of the robot's other derivatives:
// errors are relative to those then.
double island_error(const Scene& scene, const SceneData& data, const ChartTruth& all_truth, std::size_t i,
                    const Eigen::MatrixXd& answer) {
  const Island& island = data.islands[i].island;
  const ChartTruth::OfIsland& truth = all_truth.islands[i];
  double error = 0;
  for (int robot : island.robots)
    for (const bool forces : {false, true}) {
      const std::vector<int> rows = rows_of(scene, island, robot, forces);
      if (rows.empty()) continue;
      const MatX<Quad> all = truth.derivatives(rows, Eigen::all);
      const double largest = std::max(size_of(all), scale_of(scene, data, all_truth, robot, forces));
      const double noise = 1e-20 * largest;
      for (int by = 0; by < 3; ++by) {
        const auto columns = Eigen::seq(truth.first[by], truth.first[by + 1] - 1);
        const MatX<Quad> part = all(Eigen::all, columns);
        const Eigen::MatrixXd mine = answer(rows, columns);
        const double difference = difference_of(mine, part);
        const double size = size_of(part) > noise ? size_of(part) : largest;
        error = worse(error, difference <= noise ? 0 : relative(difference, size));
      }
    }
  return error;
}

}  // namespace

double acceleration_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  double error = 0;
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int o = scene.robots[r].idx_v, nv = scene.robots[r].model->nv;
    const VecX<Quad> a = truth.a.segment(o, nv);
    double size = size_of(a);
    if (truth.at_rest[r]) size = worse(size, truth.a_free.segment(o, nv).cwiseAbs().maxCoeff());
    error = worse(error, relative(difference_of(data.a.segment(o, nv), a), size));
  }
  return error;
}

double force_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  double error = 0;
  for (int r = 0; r < scene.nrobots(); ++r) {
    double difference = 0;
    for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
      const Contact& contact = scene.contacts[c];
      if (data.f_offset[c] < 0 || (contact.A.robot != r && contact.B.robot != r)) continue;
      const VecX<Quad> f = truth.f.segment(data.f_offset[c], contact.rows());
      difference = worse(difference, difference_of(data.f.segment(data.f_offset[c], contact.rows()), f));
    }
    error = worse(error, relative(difference, scale_of(scene, data, truth, r, true)));
  }
  return error;
}

double derivative_error(const Scene& scene, const SceneData& data, const ChartTruth& truth) {
  double error = 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const IslandDerivatives& d = data.derivatives->islands[i];
    const auto X = d.X.leftCols(d.cols);
    const Eigen::MatrixXd& along = truth.islands[i].along;
    if (!truth.islands[i].derivatives_known) return NAN;
    const Eigen::MatrixXd answer = along.rows() == along.cols() ? Eigen::MatrixXd(X) : Eigen::MatrixXd(X * along);
    error = worse(error, island_error(scene, data, truth, i, answer));
  }
  return error;
}

}  // namespace manycontact::cli
