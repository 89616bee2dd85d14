#pragma once
#include "manycontact/detail/action/block_sparse.hpp"

namespace manycontact {

/// Selects the matrices that are computed: dense ones as in Crocoddyl, sparse ones, or both. With kPanel, Hessians are
/// sparse, and derivatives of the dynamics are not copied (DifferentialActionDataAbstract::panel). kPanel takes the
/// least memory and time for an IntegratedActionModelEuler of one robot.
enum class MatrixStorage { kBoth, kDense, kSparse, kPanel };
/// Returns whether a storage includes dense matrices.
constexpr bool has_dense(MatrixStorage s) { return s == MatrixStorage::kBoth || s == MatrixStorage::kDense; }
/// Returns whether a storage includes sparse Hessians.
constexpr bool has_blocks(MatrixStorage s) { return s != MatrixStorage::kDense; }

/// Derivatives of a cost. Unless enabled by the storage, dense matrices are empty and sparse ones have no blocks.
struct CostDerivatives {
  /// Allocates the matrices for ndx and nu coordinates.
  void resize(std::size_t ndx, std::size_t nu, MatrixStorage storage);
  MatrixStorage storage = MatrixStorage::kBoth;
  Eigen::VectorXd Lx, Lu;         // gradients: ndx, nu
  Eigen::MatrixXd Lxx, Lxu, Luu;  // Gauss-Newton Hessians
  BlockSparse Lxx_blocks, Lxu_blocks, Luu_blocks;
};

}  // namespace manycontact
