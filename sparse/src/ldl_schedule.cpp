#include "manycontact/sparse/ldl_schedule.hpp"

#include <algorithm>

namespace manycontact::sparse {

namespace {

// Divides the columns into blocks, none of which has columns both before and after column `border`.
void find_blocks(const LdlSymbolic& s, int border, std::vector<int>& block) {
  block.assign(1, 0);
  for (int k = 0; k < s.n; ++k)
    if (k + 1 == border || k + 1 - block.back() == LdlSchedule::kWidest || !s.nests(k))
      block.push_back(k + 1);
}

void place_entries(const UpperCsc& A, const LdlSymbolic& s, LdlSchedule& out) {
  for (int j = 0; j < A.n; ++j) {
    for (int k = A.p[j]; k < A.p[j + 1] - 1; ++k) {
      const auto column = s.Li.begin() + s.Lp[A.i[k]], end = s.Li.begin() + s.Lp[A.i[k] + 1];
      out.from.push_back(k);
      out.to.push_back(static_cast<int>(std::lower_bound(column, end, j) - s.Li.begin()));
    }
    out.diagonal.push_back(A.p[j + 1] - 1);
  }
  std::vector<char> set(s.nonzeros(), 0);
  for (int slot : out.to) set[slot] = 1;
  for (int slot = 0; slot < s.nonzeros(); ++slot)
    if (!set[slot]) out.fill.push_back(slot);
}

// Adds the group of rows first+c ... first+c+high-1 of x, in a block of `width` columns.
void add_group(const LdlSymbolic& s, int first, int width, int c, int high, LdlSchedule& out) {
  LdlSchedule::Group group{first + c, high, static_cast<int>(out.segments.size()), 0,
                           static_cast<int>(out.packed.size())};
  const int below = s.Lp[first + width] - s.Lp[first + width - 1];
  const int* rows = s.Li.data() + s.Lp[first + width - 1];
  const auto add_row = [&](int of_block) {  // of_block: row number within the block
    for (int i = c; i < c + high; ++i) out.packed.push_back(of_block > i ? s.Lp[first + i] + of_block - i - 1 : -1);
  };
  const auto add_segment = [&](int row) {
    const bool next = static_cast<int>(out.segments.size()) > group.segment &&
                      out.segments.back().row - out.segments.back().count == row;
    if (next)
      ++out.segments.back().count;
    else
      out.segments.push_back({row, 1});
  };
  for (int b = below - 1; b >= 0; --b) add_segment(rows[b]), add_row(width + b);
  for (int a = width - 1; a >= c + high; --a) add_segment(first + a), add_row(a);
  for (int a = c + 1; a < c + high; ++a) add_row(a);
  group.segment_end = static_cast<int>(out.segments.size());
  out.groups.push_back(group);
}

void find_groups(const LdlSymbolic& s, LdlSchedule& out) {
  for (int k = out.blocks() - 1; k >= 0; --k) {
    const int width = out.block[k + 1] - out.block[k];
    for (int c = width, high = LdlSchedule::kHigh; c > 0; high /= 2)
      for (; c >= high; c -= high) add_group(s, out.block[k], width, c - high, high, out);
  }
}

// Finds the targets in block T of rows begin, begin + 1, ... below another block: T's columns, or rows below T.
void find_targets(const int* rows, int begin, int count, const int* T_rows, int T_first, int T_width,
                  std::vector<LdlSchedule::Target>& targets) {
  const std::size_t before = targets.size();
  int next = 0;  // index of a row among the rows below T
  for (int b = begin; b < count; ++b) {
    int local = rows[b] - T_first;
    if (local >= T_width) {
      while (T_rows[next] != rows[b]) ++next;
      local = T_width + next;
    }
    if (targets.size() > before && targets.back().shift == local - b)
      targets.back().end = b + 1;
    else
      targets.push_back({b, b + 1, local - b});
  }
}

}  // namespace

std::size_t LdlSchedule::bytes() const {
  return sizeof(int) * (diagonal.size() + from.size() + to.size() + fill.size() + Lp.size() + block.size() +
                        run.size() + packed.size()) +
         sizeof(Run) * runs.size() + sizeof(Target) * targets.size() + sizeof(Group) * groups.size() +
         sizeof(Segment) * segments.size();
}

LdlSchedule compile_ldl(const UpperCsc& A, const LdlSymbolic& s, int columns) {
  LdlSchedule out;
  out.n = s.n;
  columns = std::min(columns, s.n);
  find_blocks(s, columns, out.block);
  out.eliminated = static_cast<int>(std::lower_bound(out.block.begin(), out.block.end(), columns) - out.block.begin());
  std::vector<int> block_of(s.n);
  for (int k = 0; k < out.blocks(); ++k)
    std::fill(block_of.begin() + out.block[k], block_of.begin() + out.block[k + 1], k);
  const std::size_t limit = 4 * (sizeof(int) + sizeof(double)) * s.nonzeros() / sizeof(LdlSchedule::Target);
  const auto rows_below = [&](int k) { return s.Li.data() + s.Lp[out.block[k + 1] - 1]; };  // rows of k's last column
  out.run.assign(1, 0);
  for (int k = 0; k < out.blocks(); ++k) {
    const int* rows = rows_below(k);
    const int count = s.Lp[out.block[k + 1]] - s.Lp[out.block[k + 1] - 1];
    for (int begin = 0, end = 0; begin < count; begin = end) {
      const int T = block_of[rows[begin]];
      for (end = begin + 1; end < count && rows[end] == rows[end - 1] + 1 && block_of[rows[end]] == T;) ++end;
      LdlSchedule::Run run{begin, end, rows[begin], out.block[T], static_cast<int>(out.targets.size()), 0};
      const bool again = static_cast<int>(out.runs.size()) > out.run.back() && out.runs.back().first == run.first;
      if (again)
        run.target = out.runs.back().target;
      else
        find_targets(rows, begin, count, rows_below(T), run.first, out.block[T + 1] - run.first, out.targets);
      run.target_end = static_cast<int>(out.targets.size());
      out.runs.push_back(run);
      if (out.targets.size() > limit) return out;
    }
    out.run.push_back(static_cast<int>(out.runs.size()));
  }
  place_entries(A, s, out);
  find_groups(s, out);
  out.Lp = s.Lp;
  return out;
}

}  // namespace manycontact::sparse
