#include "table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>

namespace manycontact::cli {

namespace {

// Returns whether c continues a UTF-8 character.
bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

int width(const std::string& text) {
  return static_cast<int>(std::ranges::count_if(text, [](char c) { return !continues(c); }));
}

// head returns the first `n` characters of a text, and tail the last `n`.
std::string head(const std::string& text, int n) {
  std::size_t end = 0;
  for (; end < text.size(); ++end)
    if (!continues(text[end]) && n-- == 0) break;
  return text.substr(0, end);
}
std::string tail(const std::string& text, int n) {
  const std::string front = head(text, width(text) - n);
  return text.substr(front.size());
}

std::string without_middle(const std::string& text, int widest) {
  if (width(text) <= widest) return text;
  const int back = (widest - 2) / 2;
  return head(text, widest - 2 - back) + ".." + tail(text, back);
}

std::string padded(const std::string& text, int to, bool left) {
  const std::string blanks(static_cast<std::size_t>(std::max(0, to - width(text))), ' ');
  return left ? text + blanks : blanks + text;
}

std::string print_as(const char* format, int digits, double x) {
  char text[400];
  std::snprintf(text, sizeof text, format, digits, x);
  return text;
}

}  // namespace

std::vector<std::string> shortened(const std::vector<std::string>& texts, int widest) {
  const std::size_t different = std::set<std::string>(texts.begin(), texts.end()).size();
  int longest = 0;
  for (const std::string& text : texts) longest = std::max(longest, width(text));
  for (; widest < longest; ++widest) {
    std::vector<std::string> out;
    for (const std::string& text : texts) out.push_back(without_middle(text, widest));
    if (std::set<std::string>(out.begin(), out.end()).size() == different) return out;
  }
  return texts;
}

std::string scientific(double x) { return std::isfinite(x) && x != 0 ? print_as("%.*e", 1, x) : number(x); }

std::string decimal(double x, int decimals) {
  if (!(std::abs(x) < 1e7)) return number(x, 4);
  const std::string text = print_as("%.*f", decimals, x);
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) return text.substr(1);
  return text;
}

std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

void wrap(std::ostream& out, const std::string& text, int indent, const std::string& bullet) {
  const std::string blanks(static_cast<std::size_t>(indent), ' ');
  const std::string below = blanks + std::string(bullet.size(), ' ');
  std::string line = blanks + bullet, word;
  bool empty = true;
  for (std::istringstream words(printable(text)); words >> word;) {
    if (!empty && width(line) + 1 + width(word) > kLineWidth) {
      out << line << "\n";
      line = below;
      empty = true;
    }
    line += (empty ? "" : " ") + word;
    empty = false;
  }
  out << line << "\n";
}

void print_more(std::ostream& out, std::size_t all, std::size_t shown, const std::string& what) {
  if (shown < all) out << "  ... and " << all - shown << " more" << (what.empty() ? "" : " ") << what << "\n";
}

Table::Table(const std::string& columns, std::size_t most, const std::string& what) : most_(most), what_(what) {
  std::istringstream titles(columns + "|");
  for (std::string title; std::getline(titles, title, '|');) {
    const std::size_t mark = title.find('<');
    const bool left = mark != std::string::npos;
    columns_.push_back({title.substr(0, mark), left, left ? std::atoi(title.c_str() + mark + 1) : 0});
  }
}

void Table::add(std::vector<std::string> cells) {
  if (++given_ > most_) return;
  cells.resize(columns_.size());
  for (std::string& cell : cells) cell = printable(std::move(cell));
  rows_.push_back(std::move(cells));
}

void Table::print(std::ostream& out, int indent) const {
  if (rows_.empty()) return;
  std::vector<std::vector<std::string>> rows = rows_;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    if (columns_[k].widest == 0) continue;
    std::vector<std::string> cells;
    for (const auto& row : rows_) cells.push_back(row[k]);
    cells = shortened(cells, columns_[k].widest);
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r][k] = std::move(cells[r]);
  }
  std::vector<int> widths(columns_.size(), 0);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], width(row[k]));
  bool titled = false;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    if (widths[k] > 0) widths[k] = std::max(widths[k], width(columns_[k].title));
    titled = titled || !columns_[k].title.empty();
  }
  const auto line = [&](const auto& cell) {
    std::string text(static_cast<std::size_t>(indent), ' ');
    bool first = true;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (widths[k] == 0) continue;
      text += (first ? "" : "  ") + padded(cell(k), widths[k], columns_[k].left);
      first = false;
    }
    out << text.substr(0, text.find_last_not_of(' ') + 1) << "\n";
  };
  if (titled) line([&](std::size_t k) { return columns_[k].title; });
  for (const auto& row : rows) line([&](std::size_t k) { return row[k]; });
  print_more(out, given_, rows_.size(), what_);
}

}  // namespace manycontact::cli
