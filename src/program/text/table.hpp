#pragma once
// Readable output: numbers, aligned columns and wrapped text, in lines of at most kLineWidth where possible.

#include <ostream>
#include <string>
#include <vector>

#include "manycontact/analysis/text.hpp"

namespace manycontact::cli {

inline constexpr int kLineWidth = 100;

using text::number;
std::string scientific(double x);  // formats `x` with an exponent, such as "3.5e+05"
/// Formats `x` with `decimals` decimals, never as "-0.00". Numbers that would be too long are formatted by number().
std::string decimal(double x, int decimals = 2);
using text::count;
using text::join;
std::string printable(std::string text);  // replaces control characters, so that no name can disturb the terminal

/// Shortens texts to `widest` characters, or a little more to keep them distinct, by leaving out their middles.
std::vector<std::string> shortened(const std::vector<std::string>& texts, int widest);

/// Prints `text` in lines of at most kLineWidth. The first line has `indent` blanks and `bullet`; other lines are
/// aligned with its text.
void wrap(std::ostream& out, const std::string& text, int indent, const std::string& bullet = "");

/// Prints a line such as "  ... and 3 more groups" if `shown` is less than `all`.
void print_more(std::ostream& out, std::size_t all, std::size_t shown, const std::string& what = "");

class Table {
 public:
  /// Takes the titles of the columns, such as "robot<24|mass [kg]|joints<". `<` aligns cells on the left, and a number
  /// is the width to which cells are shortened. Only `most` rows are printed, and then the number of other rows, as
  /// `what`.
  explicit Table(const std::string& columns, std::size_t most = std::string::npos, const std::string& what = "");
  void add(std::vector<std::string> cells);  // adds a row; missing cells are empty
  bool empty() const { return rows_.empty(); }
  /// Prints the titles, unless all are empty, and the rows. Leaves out columns whose cells are all empty.
  void print(std::ostream& out, int indent = 2) const;

 private:
  struct Column {
    std::string title;
    bool left = false;
    int widest = 0;  // 0 means any width
  };
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::size_t given_ = 0, most_;  // numbers of rows: added, and printed at most
  std::string what_;
};

}  // namespace manycontact::cli
