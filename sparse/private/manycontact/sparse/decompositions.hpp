#pragma once
// Eigen's dense decompositions of doubles are compiled once, in decompositions.cpp: half a minute less for each build.

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
