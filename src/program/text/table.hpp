#pragma once
// Readable output: numbers, aligned columns, wrapped text, nothing wider than kLineWidth if it can be helped.

#include <ostream>
#include <string>
#include <vector>

#include "manycontact/analysis/text.hpp"

namespace manycontact::cli {

inline constexpr int kLineWidth = 100;

using text::number;
/// "3.5e+05"
std::string scientific(double x);
/// `x` with `decimals` decimals, never "-0.00"; numbers too long for that as number() writes them.
std::string decimal(double x, int decimals = 2);
using text::count;
using text::join;
/// Control characters replaced, so that no name disturbs the terminal.
std::string printable(std::string text);

/// Shortens texts to `widest` characters by leaving out their middles. They are a little longer if two different ones
/// would become the same.
std::vector<std::string> shortened(const std::vector<std::string>& texts, int widest);

/// Words of `text` in lines no wider than kLineWidth: the first after `indent` blanks and `bullet`, the others below
/// it.
void wrap(std::ostream& out, const std::string& text, int indent, const std::string& bullet = "");

/// "  ... and 3 more groups" where not all are shown.
void print_more(std::ostream& out, std::size_t all, std::size_t shown, const std::string& what = "");

class Table {
 public:
  /// Titles of the columns, "robot<24|mass [kg]|joints<": with `<` cells are aligned on the left, and with a number
  /// longer ones lose their middle (shortened). Rows beyond `most` are left out: `print` tells how many of `what`.
  explicit Table(const std::string& columns, std::size_t most = std::string::npos, const std::string& what = "");
  /// A row; a missing cell is empty.
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
  std::size_t given_ = 0, most_;  // rows
  std::string what_;
};

}  // namespace manycontact::cli
