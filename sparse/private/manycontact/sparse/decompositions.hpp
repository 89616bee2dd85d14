#pragma once
// Eigen's dense decompositions of matrices of double are compiled once, in decompositions.cpp: elsewhere they would take
// half a minute of each build.

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
