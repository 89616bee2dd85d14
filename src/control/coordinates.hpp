#pragma once
// The numbers of parts of a node among the node's.

#include <string>

#include "manycontact/control/parts.hpp"

namespace manycontact::internal {

/// part = whole(index), of parts of the right size. (Eigen's indexed views copy the index.)
template <class Whole, class Part>
void take(const Whole& whole, const std::vector<int>& index, Part&& part) {
  for (std::size_t i = 0; i < index.size(); ++i) part[static_cast<Eigen::Index>(i)] = whole[index[i]];
}

/// whole(index) = part
template <class Part, class Whole>
void put(const Part& part, const std::vector<int>& index, Whole&& whole) {
  for (std::size_t i = 0; i < index.size(); ++i) whole[index[i]] = part[static_cast<Eigen::Index>(i)];
}

/// whole(rows, cols) = part
inline void put(const Eigen::MatrixXd& part, const std::vector<int>& rows, const std::vector<int>& cols,
                Eigen::MatrixXd& whole) {
  for (std::size_t j = 0; j < cols.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i)
      whole(rows[i], cols[j]) = part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

/// Throws unless each of 0 ... size - 1 is in one of the parts' lists.
template <class Part>
void check_cover(const char* where, const char* what, std::size_t size, const std::vector<Part>& parts,
                 std::vector<int> ActionPart::*list) {
  std::vector<bool> taken(size);
  std::size_t count = 0;
  for (const ActionPart& part : parts)
    for (const int i : part.*list) {
      require(i >= 0 && static_cast<std::size_t>(i) < size && !taken[static_cast<std::size_t>(i)], where,
              std::string("a coordinate of ") + what + " that does not exist or is another's, one part's is expected");
      taken[static_cast<std::size_t>(i)] = true;
      ++count;
    }
  require(count == size, where, std::string("a coordinate of ") + what + " is no part's");
}

}  // namespace manycontact::internal
