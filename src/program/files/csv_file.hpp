#pragma once
#include <string>

#include "output_file.hpp"

namespace manycontact::cli {

/// The file of an option, written row by row, "-" is standard output. Throws InputError when it cannot be.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path, const std::string& option = "--out");
  CsvFile& operator<<(double x);              // shortest that reads back to the same bits
  CsvFile& operator<<(const std::string& x);  // quoted where it must be, as RFC 4180 has it
  void end_row();
  void header(std::initializer_list<const char*> names);  // a whole row
  void close();  // it is whole: it has its name

 private:
  OutputFile file_;
  std::string row_;
  bool first_ = true;  // cell of the row
  void next_cell();
};

}  // namespace manycontact::cli
