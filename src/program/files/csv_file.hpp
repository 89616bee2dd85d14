#pragma once
#include <string>

#include "output_file.hpp"

namespace manycontact::cli {

/// The CSV file of an option, written row by row; "-" is standard output. Throws InputError if it cannot be written.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path, const std::string& option = "--out");
  CsvFile& operator<<(double x);              // the shortest text that restores the same bits
  CsvFile& operator<<(const std::string& x);  // quoted if RFC 4180 requires it
  void end_row();
  void header(std::initializer_list<const char*> names);
  void close();  // gives the complete file its final name

 private:
  OutputFile file_;
  std::string row_;
  bool first_ = true;  // whether the next cell is the first of its row
  void next_cell();
};

}  // namespace manycontact::cli
