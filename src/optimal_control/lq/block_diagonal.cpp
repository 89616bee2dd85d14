#include "manycontact/lq/block_diagonal.hpp"

#include <type_traits>

namespace manycontact::lq {
namespace {

// Calls use(first row, size, block) for each diagonal block of D. Sizes 6 and 3 are compile-time constants.
template <class Use>
void each_part(const BlockDiagonal& D, Use&& use) {
  for (const BlockDiagonal::Part& part : D.parts) {
    const auto as = [&](auto size) {
      constexpr int k = size.value;
      use(part.first, size,
          Eigen::Map<const Eigen::Matrix<double, k, k>>(part.block.data(), part.block.rows(), part.block.cols()));
    };
    if (part.block.rows() == 6)
      as(std::integral_constant<int, 6>());
    else if (part.block.rows() == 3)
      as(std::integral_constant<int, 3>());
    else
      as(std::integral_constant<int, Eigen::Dynamic>());
  }
}

// Calls use(first row, size) for each interval of the n rows that no block of D covers, where D is D.scale times I.
template <class Use>
void each_gap(const BlockDiagonal& D, Index n, Use&& use) {
  Index at = 0;
  for (const BlockDiagonal::Part& part : D.parts) {
    if (part.first > at) use(at, part.first - at);
    at = part.first + part.block.rows();
  }
  if (n > at) use(at, n - at);
}

template <class Target, class Value>
void put(Target&& target, double beta, const Value& value) {
  if (beta == 0)
    target = value;
  else
    target += value;
}

template <bool kTransposed, class Matrix>
auto turned(const Matrix& block) {
  if constexpr (kTransposed)
    return block.transpose();
  else
    return block;
}

template <bool kTransposed>
void from_left(Block C, double beta, const BlockDiagonal& D, ConstBlock X) {
  each_gap(D, C.rows(), [&](Index at, Index n) { put(C.middleRows(at, n), beta, D.scale * X.middleRows(at, n)); });
  each_part(D, [&](Index at, auto size, const auto& block) {
    constexpr int k = size.value;
    put(C.middleRows<k>(at, block.rows()), beta,
        turned<kTransposed>(block).lazyProduct(X.middleRows<k>(at, block.rows())));
  });
}

template <bool kTransposed>
void from_right(Block C, double beta, ConstBlock X, const BlockDiagonal& D) {
  each_gap(D, C.cols(), [&](Index at, Index n) { put(C.middleCols(at, n), beta, D.scale * X.middleCols(at, n)); });
  each_part(D, [&](Index at, auto size, const auto& block) {
    constexpr int k = size.value;
    put(C.middleCols<k>(at, block.rows()), beta,
        X.middleCols<k>(at, block.rows()).lazyProduct(turned<kTransposed>(block)));
  });
}

}  // namespace

void add_DX(Block C, double beta, const BlockDiagonal& D, ConstBlock X) { from_left<false>(C, beta, D, X); }
void add_DtX(Block C, double beta, const BlockDiagonal& D, ConstBlock X) { from_left<true>(C, beta, D, X); }
void add_XD(Block C, double beta, ConstBlock X, const BlockDiagonal& D) { from_right<false>(C, beta, X, D); }
void add_XDt(Block C, double beta, ConstBlock X, const BlockDiagonal& D) { from_right<true>(C, beta, X, D); }

void multiply_Dt(const BlockDiagonal& D, Block X) {
  if (D.scale != 1) each_gap(D, X.rows(), [&](Index at, Index n) { X.middleRows(at, n) *= D.scale; });
  each_part(D, [&](Index at, auto size, const auto& block) {
    constexpr int k = size.value, kMostRows = k == Eigen::Dynamic ? BlockDiagonal::kLargestPart : k;
    for (Index j = 0; j < X.cols(); ++j) {
      auto x = X.col(j).segment<k>(at, block.rows());
      const Eigen::Matrix<double, k, 1, 0, kMostRows, 1> Dx = block.transpose().lazyProduct(x);
      x = Dx;
    }
  });
}

}  // namespace manycontact::lq
