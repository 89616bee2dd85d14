#include "csv_read.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "manycontact/io/input_error.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::cli {

namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

}  // namespace

CsvReader::CsvReader(const std::string& path) : path_(path), stream_(path), t_(-INFINITY) {
  std::string line;
  if (!read_line(line)) fail("cannot be read or is empty, expected a CSV with a header");
  if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF"))
    fail("is UTF-16 by its byte order mark, expected a CSV in UTF-8");
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  names_ = cells_of(line);
  for (std::size_t k = 0; k < names_.size(); ++k)
    if (!column_.emplace(names_[k], k).second && !names_[k].empty())
      fail("column " + quote(names_[k]) + " occurs twice, expected each column once");
  (void)column("t");
}

// Reads a line. The length is limited, because a device or a binary file may have no line breaks.
bool CsvReader::read_line(std::string& line) {
  constexpr std::size_t kMost = std::size_t(1) << 26;
  line.clear();
  std::streambuf& in = *stream_.rdbuf();
  for (int c = in.sbumpc();; c = in.sbumpc()) {
    if (c == std::char_traits<char>::eof()) return !line.empty();
    if (c == '\n') return true;
    line += static_cast<char>(c);
    if (line.size() > kMost) fail("the line is longer than 64 MB, expected a line of a CSV");
  }
}

bool CsvReader::next() {
  std::string line;
  do {
    ++line_;
    if (!read_line(line)) return --line_, false;
  } while (line.empty() || line == "\r");
  cells_ = cells_of(line);
  if (cells_.size() != names_.size())
    fail("the row has " + std::to_string(cells_.size()) + " cells, expected " + std::to_string(names_.size()) +
         " as in the header");
  const double t = number(column("t"));
  if (!(t > t_)) fail("the time does not increase, expected rows in the order of increasing times");
  t_ = t;
  return true;
}

double CsvReader::number(std::size_t column) const {
  std::string_view text = trimmed(cells_[column]);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
    fail("column " + quote(names_[column]) + " has " + quote(cells_[column]) + ", expected a finite number");
  return x;
}

std::size_t CsvReader::column(const std::string& name) const {
  const auto found = column_.find(name);
  if (found == column_.end()) fail("there is no column " + quote(name) + ", expected the columns of this scene");
  return found->second;
}

void CsvReader::fail(const std::string& message) const { throw InputError(path_, line_, message); }

std::vector<std::string> CsvReader::cells_of(std::string_view line) const {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string> cells;
  for (std::size_t at = 0;; ++at) {  // a cell begins at position `at`
    std::string cell;
    if (line.substr(at, 1) == "\"") {
      std::size_t i = at + 1;
      for (; i < line.size() && (line[i] != '"' || line.substr(i, 2) == "\"\""); ++i) {
        cell += line[i];
        if (line[i] == '"') ++i;
      }
      if (i >= line.size())
        fail("cell " + std::to_string(cells.size() + 1) +
             " has a quote that is not closed, expected the closing quote on the same line");
      at = i + 1;
      if (at < line.size() && line[at] != ',')
        fail("cell " + std::to_string(cells.size() + 1) + " continues after its closing quote, expected a comma");
    } else {
      const std::size_t end = std::min(line.find(',', at), line.size());
      cell = line.substr(at, end - at);
      if (cell.find('"') != std::string::npos)
        fail("cell " + std::to_string(cells.size() + 1) + " has a quote inside, expected the whole cell in quotes");
      at = end;
    }
    cells.push_back(std::move(cell));
    if (at >= line.size()) return cells;
  }
}

}  // namespace manycontact::cli
