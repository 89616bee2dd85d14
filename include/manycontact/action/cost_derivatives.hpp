#pragma once
#include "manycontact/action/block_sparse.hpp"

namespace manycontact {

/// Which of the large matrices are filled: dense ones as in Crocoddyl, their sparse twins, or both. kPanel: Hessians as
/// with kSparse, and of the dynamics none, which are read where they were computed (DifferentialActionDataAbstract's
/// panel): the least memory and time, for what IntegratedActionModelEuler makes of one robot.
enum class MatrixStorage { kBoth, kDense, kSparse, kPanel };
constexpr bool has_dense(MatrixStorage s) { return s == MatrixStorage::kBoth || s == MatrixStorage::kDense; }
constexpr bool has_blocks(MatrixStorage s) { return s != MatrixStorage::kDense; }

/// Derivatives of a cost. Dense matrices that are switched off have no size, sparse ones no blocks.
struct CostDerivatives {
  void resize(std::size_t ndx, std::size_t nu, MatrixStorage storage);
  MatrixStorage storage = MatrixStorage::kBoth;
  Eigen::VectorXd Lx, Lu;         // ndx, nu
  Eigen::MatrixXd Lxx, Lxu, Luu;  // Gauss-Newton Hessians
  BlockSparse Lxx_blocks, Lxu_blocks, Luu_blocks;
};

}  // namespace manycontact
