#pragma once
#include <fstream>
#include <string>

namespace manycontact::cli {

/// The file of an option --out, written row by row, "-" is standard output. Throws InputError when it cannot be.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path);
  CsvFile& operator<<(double x);              // shortest that reads back to the same bits
  CsvFile& operator<<(const std::string& x);  // quoted where it must be, as RFC 4180 has it
  void end_row();
  void close();

 private:
  std::string path_, row_;
  bool first_ = true;  // cell of the row
  std::ofstream file_;
  std::ostream* out_;
  void next_cell();
  void check();
};

}  // namespace manycontact::cli
