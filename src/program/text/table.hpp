#pragma once
// Readable output: numbers, aligned columns, wrapped text, lines up to kLineWidth where possible.

#include <ostream>
#include <string>
#include <vector>

#include "manycontact/analysis/text.hpp"

namespace manycontact::cli {

inline constexpr int kLineWidth = 100;

using text::number;
/// Formats `x` as "3.5e+05".
std::string scientific(double x);
/// Formats `x` with `decimals` decimals, never "-0.00". Numbers that would be too long are formatted by number().
std::string decimal(double x, int decimals = 2);
using text::count;
using text::join;
/// Replaces control characters, so that no name disturbs the terminal.
std::string printable(std::string text);

/// Shortens texts to `widest` characters, or a little more to keep them distinct, by leaving out their middles.
std::vector<std::string> shortened(const std::vector<std::string>& texts, int widest);

/// Prints `text` in lines up to kLineWidth wide. The first line has `indent` blanks and `bullet`; others are aligned.
void wrap(std::ostream& out, const std::string& text, int indent, const std::string& bullet = "");

/// Prints "  ... and 3 more groups" if `shown` is less than `all`.
void print_more(std::ostream& out, std::size_t all, std::size_t shown, const std::string& what = "");

class Table {
 public:
  /// Titles of the columns, "robot<24|mass [kg]|joints<": `<` aligns cells on the left, and a number is the width to
  /// which they are shortened. Rows beyond `most` are left out; `print` reports how many of `what`.
  explicit Table(const std::string& columns, std::size_t most = std::string::npos, const std::string& what = "");
  /// Adds a row; missing cells are empty.
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  /// Prints the titles, unless all are empty, and the rows. A column whose cells are all empty is left out.
  void print(std::ostream& out, int indent = 2) const;

 private:
  struct Column {
    std::string title;
    bool left = false;
    int widest = 0;  // 0: any width
  };
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::size_t given_ = 0, most_;  // numbers of rows: added, and printed at most
  std::string what_;
};

}  // namespace manycontact::cli
