#include "svg.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "../text/table.hpp"

namespace manycontact::cli {

PatternGrid::PatternGrid(int n, int colours) : n_(n), cells_(std::min(n, kMostCells)), colours_(colours) {
  counts_.assign(
      static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_) * static_cast<std::size_t>(colours), 0);
}

int PatternGrid::colour_at(int row, int col) const {
  const auto begin = counts_.begin() + (static_cast<std::ptrdiff_t>(row) * cells_ + col) * colours_;
  const auto most = std::max_element(begin, begin + colours_);
  return *most == 0 ? -1 : static_cast<int>(most - begin);
}

void PatternGrid::draw(std::ostream& svg, double x, double y, double side,
                       const std::vector<std::string>& fills) const {
  if (cells_ == 0) return;
  svg << "<g transform=\"translate(" << number(x, 6) << " " << number(y, 6) << ") scale(" << number(side / cells_, 6)
      << ")\" shape-rendering=\"crispEdges\">\n";
  for (int colour = 0; colour < colours_; ++colour) {
    svg << "<path fill=\"" << fills[static_cast<std::size_t>(colour)] << "\" d=\"";
    for (int row = 0; row < cells_; ++row)
      for (int col = 0; col < cells_; ++col) {
        if (colour_at(row, col) != colour) continue;
        const int first = col;
        while (col + 1 < cells_ && colour_at(row, col + 1) == colour) ++col;
        svg << "M" << first << " " << row << "h" << col + 1 - first << "v1H" << first << "z";
      }
    svg << "\"/>\n";
  }
  svg << "</g>\n";
}

namespace {

// Bytes that are not UTF-8 replaced.
std::string utf8(const std::string& text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : utf8(printable(text))) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

void draw_text(std::ostream& svg, double x, double y, const std::string& text, const std::string& anchor, int size) {
  svg << "<text x=\"" << number(x, 6) << "\" y=\"" << number(y, 6) << "\" text-anchor=\"" << anchor << "\" font-size=\""
      << size << "\">" << escaped(text) << "</text>\n";
}

void draw_line(std::ostream& svg, double x1, double y1, double x2, double y2) {
  svg << "<path d=\"M" << number(x1, 6) << " " << number(y1, 6) << "L" << number(x2, 6) << " " << number(y2, 6)
      << "\" stroke=\"#b8bec6\" stroke-width=\"0.6\" fill=\"none\"/>\n";
}

void draw_box(std::ostream& svg, double x, double y, double width, double height, const std::string& fill) {
  svg << "<rect x=\"" << number(x, 6) << "\" y=\"" << number(y, 6) << "\" width=\"" << number(width, 6)
      << "\" height=\"" << number(height, 6) << "\" fill=\"" << fill
      << "\" stroke=\"#4a5560\" stroke-width=\"0.8\"/>\n";
}

}  // namespace manycontact::cli
