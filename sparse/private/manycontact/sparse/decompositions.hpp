#pragma once
// Eigen's dense decompositions of doubles. Only decompositions.cpp compiles them, which saves half a minute of a build.

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

namespace Eigen {

extern template class LLT<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class CompleteOrthogonalDecomposition<MatrixXd>;

}  // namespace Eigen
