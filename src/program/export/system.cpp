#include "export.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

void add_block(const Eigen::MatrixXd& block, int row, int column, Triplets& out) {
  for (Eigen::Index j = 0; j < block.cols(); ++j)
    for (Eigen::Index i = 0; i < block.rows(); ++i)
      if (block(i, j) != 0) out.emplace_back(row + static_cast<int>(i), column + static_cast<int>(j), block(i, j));
}

void add_inertia(const Scene& scene, const SceneData& data, int robot, int offset, Triplets& out) {
  const Model& model = *scene.robots[robot].model;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(model.nv, model.nv);
  unpack_inertia<double>(model, joint_space_inertia(scene, data, robot).data(), M);
  add_block(M, offset, offset, out);
}

// Adds a contact's rows of J, and their transpose, to K. The contact's J has columns for A, then for B.
void add_rows(const Scene& scene, const SceneData& data, const Island& island, int contact, int row, Triplets& out) {
  const Contact& c = scene.contacts[contact];
  const MatX<double>& J = contact_data(scene, data, contact).J;
  const ContactSupport& support = contact_support(scene, data, contact);
  int j = 0;
  const auto add = [&](const std::vector<int>& columns, int first) {
    for (int i : columns) {
      add_block(J.col(j), row, first + i, out);
      add_block(J.col(j++).transpose(), first + i, row, out);
    }
  };
  add(support.a, first_dof(island, c.A));
  add(support.b, first_dof(island, c.B));
}

Eigen::SparseMatrix<double> matrix(const Scene& scene, const SceneData& data, const Island& island) {
  Triplets entries;
  for (std::size_t k = 0; k < island.robots.size(); ++k)
    add_inertia(scene, data, island.robots[k], island.dof_offset[k], entries);
  for (std::size_t k = 0; k < island.contacts.size(); ++k)
    add_rows(scene, data, island, island.contacts[k], island.nv + island.row_offset[k], entries);
  for (int i = island.nv; scene.damping != 0 && i < island.size(); ++i) entries.emplace_back(i, i, -scene.damping);
  Eigen::SparseMatrix<double> K(island.size(), island.size());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

Eigen::VectorXd right_hand_side(const Scene& scene, const SceneData& data, const Island& island) {
  Eigen::VectorXd b(island.size());
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    b.segment(island.dof_offset[k], robot.model->nv) =
        data.tau.segment(robot.idx_v, robot.model->nv) - bias_torques(scene, data, island.robots[k]);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const auto& a0 = contact_data(scene, data, island.contacts[k]).a0;
    b.segment(island.nv + island.row_offset[k], a0.size()) = -a0;
  }
  return b;
}

// Returns K dx. Entries that are only rounding errors of the terms |K| |dx| of the sum become zero.
Eigen::MatrixXd product(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& dx) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::SparseMatrix<long double> K_long = K.cast<long double>();
  const Long x = dx.cast<long double>();
  const Eigen::MatrixXd db = (K_long * x).eval().cast<double>();
  const Eigen::MatrixXd terms = K.cwiseAbs() * dx.cwiseAbs();
  const double small = 100 * std::numeric_limits<double>::epsilon();
  return (db.cwiseAbs().array() > small * terms.array()).select(db, 0.0);
}

Eigen::MatrixXd derivative_right_hand_sides(const Eigen::SparseMatrix<double>& K, const IslandDerivatives& d) {
  d.check();
  Eigen::MatrixXd dx = d.X.leftCols(d.cols);
  if (!dx.allFinite()) return {};
  dx.bottomRows(d.nc) *= -1;  // the unknowns of the exported system are x = [a; -f]
  return product(K, dx);
}

}  // namespace

Options export_options() {
  Options options;
  options.simd_level = SimdLevel::kOff;
  options.method = Method::kSparseLdl;
  options.reduce_pairs = false;
  return options;
}

ExportedSystem system_of(const Scene& scene, const SceneData& data, std::size_t i, bool with_derivatives) {
  ExportedSystem out;
  out.island = solved_island(data, i);
  out.K = matrix(scene, data, out.island);
  out.b = right_hand_side(scene, data, out.island);
  if (with_derivatives) out.db = derivative_right_hand_sides(out.K, derivatives(data).islands[i]);
  return out;
}

}  // namespace manycontact::cli
