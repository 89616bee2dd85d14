#include "lines.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace manycontact::cli {

void add_line(Lines& lines, int group, const std::string& name, std::vector<std::string> cells, double size) {
  if (std::isnan(size)) size = INFINITY;
  if (lines.empty() || lines.back().group != group || lines.back().cells != cells)
    return lines.push_back({group, name, "", std::move(cells), size});
  Line& line = lines.back();
  line.last = name;
  line.size = std::max(line.size, size);
  ++line.count;
}

void print_lines(std::ostream& out, Table table, const Lines& lines, std::size_t most, bool none_larger) {
  std::vector<std::size_t> at(lines.size());
  std::iota(at.begin(), at.end(), 0);
  std::size_t more = 0;
  if (at.size() > most) {
    std::ranges::stable_sort(at, std::ranges::greater(), [&](std::size_t i) { return lines[i].size; });
    for (std::size_t k = most; k < at.size(); ++k) more += lines[at[k]].count;
    at.resize(most);
    std::ranges::sort(at);
  }
  for (std::size_t i : at) {
    std::vector<std::string> cells{lines[i].first + (lines[i].last.empty() ? "" : " .. " + lines[i].last)};
    cells.insert(cells.end(), lines[i].cells.begin(), lines[i].cells.end());
    table.add(cells);
  }
  table.print(out);
  if (more > 0) out << "  ... and " << more << " more" << (none_larger ? ", none larger" : "") << "\n";
}

}  // namespace manycontact::cli
