#pragma once
// A square matrix that is `scale` on its diagonal but for a few blocks.

#include <Eigen/Core>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::lq {

struct BlockDiagonal {
  static constexpr int kLargestPart = 6;  // rows
  struct Part {
    int first;
    Eigen::MatrixXd block;  // occupies rows and columns first, first + 1, ...
  };
  double scale = 0;
  std::vector<Part> parts;  // ascending
};

// C <- beta C + ..., beta 0 or 1; C is none of the others.
void add_DX(Eigen::Ref<Eigen::MatrixXd> C, double beta, const BlockDiagonal& D,
            const Eigen::Ref<const Eigen::MatrixXd>& X);  // D X
void add_DtX(Eigen::Ref<Eigen::MatrixXd> C, double beta, const BlockDiagonal& D,
             const Eigen::Ref<const Eigen::MatrixXd>& X);  // D^T X
void add_XD(Eigen::Ref<Eigen::MatrixXd> C, double beta, const Eigen::Ref<const Eigen::MatrixXd>& X,
            const BlockDiagonal& D);  // X D
void add_XDt(Eigen::Ref<Eigen::MatrixXd> C, double beta, const Eigen::Ref<const Eigen::MatrixXd>& X,
             const BlockDiagonal& D);  // X D^T

/// X <- D^T X
void multiply_Dt(const BlockDiagonal& D, Eigen::Ref<Eigen::MatrixXd> X);

}  // namespace manycontact::lq
