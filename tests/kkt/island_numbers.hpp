#pragma once
// M and J of one island, packed as the KKT code reads them, and dense.

#include <algorithm>
#include <deque>
#include <span>
#include <vector>

#include "contact/scene_rows.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/kkt/shape.hpp"

namespace manycontact::test {

inline std::vector<char> active_flags(const Scene& scene) {
  std::vector<char> active;
  for (const Contact& c : scene.contacts) active.push_back(c.active);
  return active;
}

struct IslandNumbers {
  Island island;
  mutable IslandShape shape;  // analyses are made on request
  IslandSupport support;
  std::vector<std::vector<double>> packed, rows;  // per robot M, per contact J by columns
  std::vector<std::span<const double>> M_spans, J_spans;
  Eigen::MatrixXd M, J;  // dense
  Eigen::VectorXd a0;

  IslandNumbers(const RandomScene& s, Island of)
      : island(std::move(of)), shape(s.scene, island), support(island_support(s.scene, island)) {
    const SceneRows<double> all(s.scene, s.q, s.v);
    M = Eigen::MatrixXd::Zero(island.nv, island.nv);
    J = Eigen::MatrixXd::Zero(island.nc, island.nv);
    a0.resize(island.nc);
    for (std::size_t r = 0; r < island.robots.size(); ++r) {
      const Model& model = *s.scene.robots[island.robots[r]].model;
      std::vector<Inertia<double>> Yc;
      crba<double>(model, all.kin[island.robots[r]], Yc, packed.emplace_back(model.M_begin[model.nv]).data());
      const int o = island.dof_offset[r];
      unpack_inertia<double>(model, packed.back().data(), M.block(o, o, model.nv, model.nv));
    }
    for (std::size_t k = 0; k < island.contacts.size(); ++k) {
      const ContactData<double>& data = all.data[island.contacts[k]];
      rows.emplace_back(data.J.data(), data.J.data() + data.J.size());
      a0.segment(island.row_offset[k], data.J.rows()) = data.a0;
      const Eigen::MatrixXd wide = all.J(island.contacts[k]);
      for (std::size_t r = 0; r < island.robots.size(); ++r) {
        const Robot& robot = s.scene.robots[island.robots[r]];
        J.block(island.row_offset[k], island.dof_offset[r], wide.rows(), robot.model->nv) =
            wide.middleCols(robot.idx_v, robot.model->nv);
      }
    }
    M_spans.assign(packed.begin(), packed.end());
    J_spans.assign(rows.begin(), rows.end());
  }
  IslandNumbers(const IslandNumbers&) = delete;  // spans point into it

  /// [M J^T; J -delta I]
  Eigen::MatrixXd K(double delta) const {
    const int nv = island.nv, nc = island.nc;
    Eigen::MatrixXd K(nv + nc, nv + nc);
    K << M, J.transpose(), J, -delta * Eigen::MatrixXd::Identity(nc, nc);
    return K;
  }
};

inline std::deque<IslandNumbers> islands_of(const RandomScene& s) {
  std::deque<IslandNumbers> out;
  for (Island& island : find_islands(s.scene, active_flags(s.scene))) out.emplace_back(s, std::move(island));
  return out;
}

/// Returns a scene determined by its seed.
inline RandomScene kkt_scene(unsigned seed, int redundant = 0, int contradicting = 0) {
  std::mt19937 rng(seed);
  const int nrobots = 2 + static_cast<int>(seed % 4);
  return random_scene(rng, {.nrobots = nrobots,
                            .ncontacts = 4 * nrobots,
                            .between_bodies = 0.3,
                            .redundant = redundant,
                            .contradicting = contradicting});
}

}  // namespace manycontact::test
