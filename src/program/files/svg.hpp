#pragma once
// Matrix patterns as SVG: a grid of cells in a few colours, one path per colour.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace manycontact::cli {

/// A square pattern seen through at most kMostCells x kMostCells cells; a cell has the colour of most of its entries.
class PatternGrid {
 public:
  static constexpr int kMostCells = 400;
  PatternGrid(int n, int colours);

  void add(int row, int col, int colour) { ++counts_[index(row, col, colour)]; }
  /// A path per colour in a square with the corner (x, y); fills[k] is colour k's fill.
  void draw(std::ostream& svg, double x, double y, double side, const std::vector<std::string>& fills) const;
  int n() const { return n_; }
  int cells() const { return cells_; }

 private:
  int n_, cells_, colours_;
  std::vector<std::uint32_t> counts_;
  std::size_t index(int row, int col, int colour) const {
    const auto cell = [this](int i) { return static_cast<std::size_t>(static_cast<long>(i) * cells_ / n_); };
    return (cell(row) * static_cast<std::size_t>(cells_) + cell(col)) * static_cast<std::size_t>(colours_) +
           static_cast<std::size_t>(colour);
  }
  int colour_at(int row, int col) const;  // -1: empty
};

std::string escaped(const std::string& text);
/// anchor: start, middle or end.
void draw_text(std::ostream& svg, double x, double y, const std::string& text, const std::string& anchor,
               int size = 12);
void draw_line(std::ostream& svg, double x1, double y1, double x2, double y2);
void draw_box(std::ostream& svg, double x, double y, double width, double height, const std::string& fill);

}  // namespace manycontact::cli
