#include "manycontact/lq/problem.hpp"

#include <stdexcept>
#include <string>

namespace manycontact::lq {
namespace {

struct Sizes {
  int nx = 0, nu = 0, nw = 0, rows = 0;
};

Sizes sizes(const Problem& problem, const Knot& knot, const Group& group) {
  const bool terminal = &knot == &problem.knots.back();
  Sizes s;
  for (int i : group.blocks) {
    s.nx += problem.nx[i];
    if (!terminal) s.nu += problem.nu[i];
  }
  for (int b : group.couplings) {
    s.nw += knot.couplings[b].size;
    s.rows += knot.couplings[b].rows;
  }
  return s;
}

void refuse(int knot, int group, const std::string& what) {
  throw std::invalid_argument("lq::Problem: knot " + std::to_string(knot) + ", group " + std::to_string(group) + ": " +
                              what);
}

void check_partition(const Problem& problem, int k) {
  const Knot& knot = problem.knots[k];
  std::vector<bool> seen(problem.blocks()), touched(knot.couplings.size());
  for (int g = 0; g < static_cast<int>(knot.groups.size()); ++g) {
    if (knot.groups[g].blocks.empty()) refuse(k, g, "the group has no blocks");
    for (int i : knot.groups[g].blocks) {
      if (i < 0 || i >= problem.blocks()) refuse(k, g, "block " + std::to_string(i) + " does not exist");
      if (seen[i]) refuse(k, g, "block " + std::to_string(i) + " occurs twice in the knot");
      seen[i] = true;
    }
    std::vector<bool> mine(knot.couplings.size());
    for (int b : knot.groups[g].couplings) {
      if (b < 0 || b >= static_cast<int>(knot.couplings.size()))
        refuse(k, g, "coupling " + std::to_string(b) + " does not exist");
      if (mine[b]) refuse(k, g, "coupling " + std::to_string(b) + " occurs twice in the group");
      mine[b] = touched[b] = true;
    }
  }
  for (int i = 0; i < problem.blocks(); ++i)
    if (!seen[i]) refuse(k, -1, "block " + std::to_string(i) + " is in no group");
  for (std::size_t b = 0; b < touched.size(); ++b)
    if (!touched[b]) refuse(k, -1, "coupling " + std::to_string(b) + " is in no group");
}

// Calls use(matrix or vector, rows, columns, name) for each member of a group, where a vector has one column.
template <class G, class Use>
void each_matrix(const Sizes& s, bool terminal, G& g, Use&& use) {
  const int nv = s.nu + s.nw;
  use(g.Q, s.nx, s.nx, "Q"), use(g.S, s.nx, nv, "S"), use(g.R, nv, nv, "R");
  use(g.q, s.nx, 1, "q"), use(g.r, nv, 1, "r");
  use(g.C, s.rows, s.nx, "C"), use(g.D, s.rows, nv, "D"), use(g.d, s.rows, 1, "d");
  if (terminal) return;
  use(g.A, s.nx, s.nx, "A"), use(g.B, s.nx, nv, "B"), use(g.f, s.nx, 1, "f");
}

void check_sizes(const Problem& problem, int k, int g) {
  const Knot& knot = problem.knots[k];
  const Group& group = knot.groups[g];
  const Sizes s = sizes(problem, knot, group);
  each_matrix(s, k == problem.horizon(), group, [&](const auto& M, int rows, int cols, const char* name) {
    if (M.rows() == rows && M.cols() == cols) return;
    const std::string size = std::to_string(rows);
    refuse(k, g,
           M.ColsAtCompileTime == 1 ? std::string(name) + " does not have " + size + " entries"
                                    : std::string(name) + " is not " + size + " x " + std::to_string(cols));
  });
  if (k == problem.horizon()) return;
  if (!group.steps) return;
  if (group.blocks.size() != 1 || s.nx % 2 != 0)
    refuse(k, g, "the group has steps, but is not one block of two halves");
  for (const BlockDiagonal* D : {&group.steps->J, &group.steps->G}) {
    Eigen::Index end = 0;
    for (const BlockDiagonal::Part& part : D->parts) {
      if (part.first < end || part.block.rows() != part.block.cols() || part.block.rows() > BlockDiagonal::kLargestPart)
        refuse(k, g, "a part of J or G is out of order, not square or too large");
      end = part.first + part.block.rows();
    }
    if (end > s.nx / 2) refuse(k, g, "J or G is larger than half the state");
  }
}

std::vector<int> starts(const std::vector<int>& sizes) {
  std::vector<int> out{0};
  for (int n : sizes) out.push_back(out.back() + n);
  return out;
}

}  // namespace

void set_zero(Problem& problem) {
  for (Knot& knot : problem.knots)
    for (Group& g : knot.groups)
      each_matrix(sizes(problem, knot, g), false, g,
                  [](auto& M, int rows, int cols, const char*) { M.setZero(rows, cols); });
  problem.x0.setZero(starts(problem.nx).back());
}

void check(const Problem& problem) {
  if (problem.knots.empty()) throw std::invalid_argument("lq::Problem: there is no knot");
  if (problem.nu.size() != problem.nx.size()) throw std::invalid_argument("lq::Problem: nx and nu differ in size");
  for (int i = 0; i < problem.blocks(); ++i)
    if (problem.nx[i] < 0 || problem.nu[i] < 0)
      throw std::invalid_argument("lq::Problem: nx or nu has a negative size");
  if (problem.x0.size() != starts(problem.nx).back())
    throw std::invalid_argument("lq::Problem: x0 does not have the size of the states of all blocks");
  for (int k = 0; k <= problem.horizon(); ++k) {
    check_partition(problem, k);
    for (int g = 0; g < static_cast<int>(problem.knots[k].groups.size()); ++g) check_sizes(problem, k, g);
  }
}

Layout::Layout(const Problem& problem) : x(starts(problem.nx)), u(starts(problem.nu)) {
  for (const Knot& knot : problem.knots) {
    std::vector<int> size, row;
    for (const Coupling& b : knot.couplings) {
      size.push_back(b.size);
      row.push_back(b.rows);
    }
    w.push_back(starts(size));
    rows.push_back(starts(row));
  }
}

Point::Point(const Problem& problem, const Layout& layout) {
  for (int k = 0; k <= problem.horizon(); ++k) {
    x.push_back(Eigen::VectorXd::Zero(layout.x.back()));
    lambda.push_back(x.back());
    u.push_back(Eigen::VectorXd::Zero(k < problem.horizon() ? layout.u.back() : 0));
    w.push_back(Eigen::VectorXd::Zero(layout.w[k].back()));
    mu.push_back(Eigen::VectorXd::Zero(layout.rows[k].back()));
  }
}

}  // namespace manycontact::lq
