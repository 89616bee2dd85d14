#pragma once
// A square matrix that equals `scale` times the identity, except in a few diagonal blocks.

#include <Eigen/Core>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::lq {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Block = Eigen::Ref<MatrixXd>;
using ConstBlock = const Eigen::Ref<const MatrixXd>&;

struct BlockDiagonal {
  static constexpr int kLargestPart = 6;  // largest number of rows of a part
  struct Part {
    int first;
    Eigen::MatrixXd block;  // occupies rows and columns first, first + 1, ...
  };
  double scale = 0;
  std::vector<Part> parts;  // the diagonal blocks, by ascending `first`
};

// Each function computes C <- beta C + (the product in its comment), beta 0 or 1. C must not alias other arguments.
void add_DX(Block C, double beta, const BlockDiagonal& D, ConstBlock X);   // D X
void add_DtX(Block C, double beta, const BlockDiagonal& D, ConstBlock X);  // D^T X
void add_XD(Block C, double beta, ConstBlock X, const BlockDiagonal& D);   // X D
void add_XDt(Block C, double beta, ConstBlock X, const BlockDiagonal& D);  // X D^T

void multiply_Dt(const BlockDiagonal& D, Block X);  // replaces X by D^T X

}  // namespace manycontact::lq
