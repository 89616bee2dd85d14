#include "csv_file.hpp"

#include <charconv>

namespace manycontact::cli {

CsvFile::CsvFile(const std::string& path, const std::string& option) : file_(path, option) {}

void CsvFile::next_cell() {
  if (!first_) row_ += ',';
  first_ = false;
}

CsvFile& CsvFile::operator<<(double x) {
  next_cell();
  char text[32];
  row_.append(text, std::to_chars(text, text + sizeof text, x).ptr);
  return *this;
}

CsvFile& CsvFile::operator<<(const std::string& x) {
  next_cell();
  if (x.find_first_of(",\"\n\r") == std::string::npos) {
    row_ += x;
    return *this;
  }
  row_ += '"';
  for (char c : x) row_ += c == '"' ? std::string("\"\"") : std::string(1, c);
  row_ += '"';
  return *this;
}

void CsvFile::end_row() {
  row_ += '\n';
  file_.stream() << row_;
  row_.clear();
  first_ = true;
}

void CsvFile::header(std::initializer_list<const char*> names) {
  for (const char* name : names) *this << name;
  end_row();
}

void CsvFile::close() { file_.close(); }

}  // namespace manycontact::cli
