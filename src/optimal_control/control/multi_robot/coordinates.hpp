#pragma once
// Copies between the coordinates of a node and the coordinates of its subproblems.

#include <string>

#include "manycontact/detail/control/parts.hpp"

namespace manycontact::internal {

/// Sets part = whole(index), where `part` has the size of `index`. Eigen's indexed views would copy `index`.
template <class Whole, class Part>
void take(const Whole& whole, const std::vector<int>& index, Part&& part) {
  for (std::size_t i = 0; i < index.size(); ++i) part[i] = whole[index[i]];
}

template <class Part, class Whole>
void put(const Part& part, const std::vector<int>& index, Whole&& whole) {
  for (std::size_t i = 0; i < index.size(); ++i) whole[index[i]] = part[i];
}

inline void put(const Eigen::MatrixXd& part, const std::vector<int>& rows, const std::vector<int>& cols,
                Eigen::MatrixXd& whole) {
  for (std::size_t j = 0; j < cols.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i)
      whole(rows[i], cols[j]) = part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

template <class Part, class Size>
std::size_t total(const char* where, const std::vector<Part>& parts, Size size) {
  std::size_t sum = 0;
  for (const Part& part : parts) {
    require(part.model != nullptr, where, "a part's model is a null pointer");
    sum += ((*part.model).*size)();
  }
  return sum;
}

template <class Get>
void stack(std::size_t count, Get get, Eigen::VectorXd& out) {
  Eigen::Index size = 0;
  for (std::size_t i = 0; i < count; ++i) size += get(i).size();
  out.resize(size);
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::VectorXd& part = get(i);
    out.segment(first, part.size()) = part;
    first += part.size();
  }
}

/// Stacks the bounds that a getter, such as get_g_lb, returns for each subproblem.
template <class Part>
void stack_bounds(const std::vector<Part>& parts, const Eigen::VectorXd& (ActionModelAbstract::*bound)() const,
                  Eigen::VectorXd& out) {
  const auto of_part = [&](std::size_t i) -> const Eigen::VectorXd& { return ((*parts[i].model).*bound)(); };
  stack(parts.size(), of_part, out);
}

/// Collects cost, xnext, g and h of a node from its subproblems' data.
template <class Part>
void collect_values(const std::vector<Part>& parts, const std::vector<std::shared_ptr<ActionDataAbstract>>& datas,
                    ActionDataAbstract& to) {
  to.cost = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    to.cost += datas[i]->cost;
    put(datas[i]->xnext, parts[i].x, to.xnext);
  }
  const auto g = [&](std::size_t i) -> const Eigen::VectorXd& { return datas[i]->g; };
  const auto h = [&](std::size_t i) -> const Eigen::VectorXd& { return datas[i]->h; };
  stack(datas.size(), g, to.g);
  stack(datas.size(), h, to.h);
}

/// Returns for each subproblem the indices of its rows in the node's [g; h]. terminal: whether the node is terminal.
template <class Part>
std::vector<std::vector<int>> constraint_rows(const std::vector<Part>& parts, bool terminal) {
  std::vector<std::vector<int>> out(parts.size());
  int next = 0;
  const auto append = [&](auto count) {
    for (std::size_t i = 0; i < out.size(); ++i)
      for (std::size_t k = count(*parts[i].model); k > 0; --k) out[i].push_back(next++);
  };
  append([=](const ActionModelAbstract& own) { return terminal ? own.get_ng_T() : own.get_ng(); });
  append([=](const ActionModelAbstract& own) { return terminal ? own.get_nh_T() : own.get_nh(); });
  return out;
}

/// Throws std::invalid_argument unless each of 0 ... size - 1 is in exactly one of the lists of the subproblems.
template <class Part>
void check_cover(const char* where, const char* what, std::size_t size, const std::vector<Part>& parts,
                 std::vector<int> ActionPart::*list) {
  std::vector<bool> taken(size);
  std::size_t count = 0;
  for (const ActionPart& part : parts)
    for (const int i : part.*list) {
      require(i >= 0 && static_cast<std::size_t>(i) < size && !taken[i], where,
              std::string("a part has a coordinate of ") + what +
                  " that does not exist or belongs to another part, each coordinate in one part is expected");
      taken[i] = true;
      ++count;
    }
  require(count == size, where,
          std::string("a coordinate of ") + what + " belongs to no part, each coordinate in one part is expected");
}

}  // namespace manycontact::internal
