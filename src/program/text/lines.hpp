#pragma once
// Tables in which neighbouring copies with equal text share one line, such as "foot0 .. foot63".

#include "table.hpp"

namespace manycontact::cli {

struct Line {     // a line of a table; lines with the largest `size` are printed
  int group = 0;  // number of the group of copies that the line belongs to
  std::string first, last;
  std::vector<std::string> cells;
  double size = 0;
  std::size_t count = 1;
};
using Lines = std::vector<Line>;

/// Appends a line. If group and cells equal those of the last line, extends the last line by this copy instead.
void add_line(Lines& lines, int group, const std::string& name, std::vector<std::string> cells, double size = 0);

/// Prints the `most` largest lines in their order, the number of the others, and, if `none_larger`, "none larger".
void print_lines(std::ostream& out, Table table, const Lines& lines, std::size_t most, bool none_larger = true);

}  // namespace manycontact::cli
