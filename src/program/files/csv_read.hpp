#pragma once
#include <cstddef>
#include <fstream>
#include <string>
#include <unordered_map>
#include <vector>

namespace manycontact::cli {

/// Reads a CSV file row by row. The file has a header and a column t of increasing times. Cells may be quoted as in RFC
/// 4180, but without line breaks. Blanks around numbers, empty lines and a byte order mark are ignored.
class CsvReader {
 public:
  /// Reads the header. Throws InputError if the file cannot be read or is not UTF-8, a name occurs twice, a quote is
  /// not closed, or there is no column t.
  explicit CsvReader(const std::string& path);

  /// Reads the next row; false at the end. Throws InputError for a wrong number of cells, or if t does not increase.
  bool next();
  double t() const { return t_; }  // time of the current row [s]; -infinity before the first row
  /// Returns a cell of the current row. Throws InputError if it is not a finite number.
  double number(std::size_t column) const;

  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const { return column_.contains(name); }
  std::size_t column(const std::string& name) const;         // throws InputError if there is no column `name`
  [[noreturn]] void fail(const std::string& message) const;  // adds the number of the last line that was read

 private:
  std::string path_;
  std::ifstream stream_;
  int line_ = 1;
  std::vector<std::string> names_, cells_;
  std::unordered_map<std::string, std::size_t> column_;
  double t_;

  bool read_line(std::string& line);
  std::vector<std::string> cells_of(std::string_view line) const;
};

}  // namespace manycontact::cli
