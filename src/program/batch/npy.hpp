#pragma once
// NumPy's .npy files of float64 numbers: little endian, C order. Read a few rows at a time, and written so.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../files/output_file.hpp"

namespace manycontact::cli {

/// The header of a .npy file, version 1.0, for numbers of that shape.
std::string npy_header(const std::vector<std::int64_t>& shape);

/// An open file.
class NpyInput {
 public:
  /// Reads versions 1.0 and 2.0 with two or three dimensions and exactly the length of the header. Throws InputError.
  explicit NpyInput(const std::string& path);
  ~NpyInput();
  NpyInput(const NpyInput&) = delete;
  NpyInput& operator=(const NpyInput&) = delete;

  const std::vector<std::int64_t>& shape() const { return shape_; }
  /// `count` numbers from number `first` on, in the file's order. Throws InputError.
  void read(std::int64_t first, std::int64_t count, double* out) const;

 private:
  void read_header();
  [[noreturn]] void refuse(const std::string& what) const;

  std::string path_;
  int file_ = -1;
  std::int64_t data_ = 0;  // position of the numbers in the file
  std::vector<std::int64_t> shape_;
};

/// The file of --out, or another one in its folder. Several processes may write it: one creates it, the others open it.
class NpyOutput {
 public:
  NpyOutput(const std::string& path, const std::vector<std::int64_t>& shape);

  /// Creates the file and writes its header. Throws InputError, also if it exists and is not a regular file.
  void create();
  void join(const std::string& temporary);
  const std::string& temporary() const { return file_->temporary(); }
  /// `count` numbers from number `first` on.
  void write(std::int64_t first, std::int64_t count, const double* numbers);
  void finish() { file_->finish(); }
  void publish() { file_->publish(); }

 private:
  std::string path_, header_;
  std::unique_ptr<OutputFile> file_;
  std::int64_t bytes_;
};

}  // namespace manycontact::cli
