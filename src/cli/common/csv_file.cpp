#include "csv_file.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <iostream>

#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

CsvFile::CsvFile(const std::string& path) : path_(path), out_(&std::cout) {
  if (path == "-") return;
  errno = 0;
  file_.open(path);
  out_ = &file_;
  check();
}

void CsvFile::check() {
  if (*out_) return;
  throw InputError(path_, 1,
                   std::string("cannot be written") + (errno ? std::string(": ") + std::strerror(errno) : "") +
                       ", expected a file that --out may create");
}

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
  *out_ << row_;
  row_.clear();
  first_ = true;
  check();
}

void CsvFile::close() {
  if (out_ == &file_) file_.close();
  check();
}

}  // namespace manycontact::cli
