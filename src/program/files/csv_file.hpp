#pragma once
#include <string>

#include "output_file.hpp"

namespace manycontact::cli {

/// The CSV file of an option, written row by row. "-" is standard output. Throws InputError if it cannot be written.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path, const std::string& option = "--out");
  CsvFile& operator<<(double x);              // writes the shortest text that restores x
  CsvFile& operator<<(const std::string& x);  // quotes x if RFC 4180 requires it
  void end_row();
  void header(std::initializer_list<const char*> names);
  void close();  // renames the complete file to its final name

 private:
  OutputFile file_;
  std::string row_;
  bool first_ = true;  // whether the next cell is the first of its row
  void next_cell();
};

}  // namespace manycontact::cli
