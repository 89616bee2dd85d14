#include "manycontact/sparse/ldl_schedule.hpp"

#include <algorithm>

namespace manycontact::sparse {

namespace {

// Column k's pattern is k + 1 and that of column k + 1.
bool nests(const LdlSymbolic& s, int k) {
  return s.parent[k] == k + 1 && s.Lp[k + 1] - s.Lp[k] == s.Lp[k + 2] - s.Lp[k + 1] + 1;
}

void find_blocks(const LdlSymbolic& s, std::vector<int>& block) {
  block.assign(1, 0);
  for (int k = 0; k < s.n; ++k)
    if (k + 1 == s.n || k + 1 - block.back() == LdlSchedule::kWidest || !nests(s, k)) block.push_back(k + 1);
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
}

void list_rows(const LdlSymbolic& s, LdlSchedule& out) {
  out.row.assign(s.n + 1, 0);
  for (int row : s.Li) ++out.row[row + 1];
  for (int k = 0; k < s.n; ++k) out.row[k + 1] += out.row[k];
  out.entries.resize(s.Li.size());
  std::vector<int> next(out.row.begin(), out.row.end() - 1);
  for (int j = 0; j < s.n; ++j)
    for (int slot = s.Lp[j]; slot < s.Lp[j + 1]; ++slot) out.entries[next[s.Li[slot]]++] = {j, slot};
}

// The rows below a block, all of them rows of block T (its own first, then those below it), from row `begin` on.
void find_targets(const int* rows, int begin, int count, const int* T_rows, int T_first, int T_width,
                  std::vector<LdlSchedule::Target>& targets) {
  const std::size_t before = targets.size();
  int next = 0;  // of T's rows below
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
  return sizeof(int) *
             (diagonal.size() + from.size() + to.size() + Lp.size() + block.size() + run.size() + row.size()) +
         sizeof(Run) * runs.size() + sizeof(Target) * targets.size() + sizeof(Entry) * entries.size();
}

LdlSchedule compile_ldl(const UpperCsc& A, const LdlSymbolic& s) {
  LdlSchedule out;
  out.n = s.n;
  find_blocks(s, out.block);
  std::vector<int> block_of(s.n);
  for (int k = 0; k < out.blocks(); ++k)
    std::fill(block_of.begin() + out.block[k], block_of.begin() + out.block[k + 1], k);
  const std::size_t limit = 4 * (sizeof(int) + sizeof(double)) * s.nonzeros() / sizeof(LdlSchedule::Target);
  const auto rows_below = [&](int k) { return s.Li.data() + s.Lp[out.block[k + 1] - 1]; };  // in its last column
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
  list_rows(s, out);
  out.Lp = s.Lp;
  out.compiled = true;
  return out;
}

}  // namespace manycontact::sparse
