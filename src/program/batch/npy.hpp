#pragma once
// Reads and writes NumPy's .npy files of float64 numbers (little endian, C order), a few rows at a time.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../files/output_file.hpp"

namespace manycontact::cli {

/// Returns the header of a .npy file, version 1.0, for an array of this shape.
std::string npy_header(const std::vector<std::int64_t>& shape);

class NpyInput {
 public:
  /// Opens a file of version 1.0 or 2.0 with two or three dimensions. Throws InputError, also for a wrong size.
  explicit NpyInput(const std::string& path);
  ~NpyInput();
  NpyInput(const NpyInput&) = delete;
  NpyInput& operator=(const NpyInput&) = delete;

  const std::vector<std::int64_t>& shape() const { return shape_; }
  /// Reads `count` numbers from index `first` on, in the order of the file. Throws InputError.
  void read(std::int64_t first, std::int64_t count, double* out) const;

 private:
  void read_header();
  [[noreturn]] void refuse(const std::string& what) const;

  std::string path_;
  int file_ = -1;
  std::int64_t data_ = 0;  // position of the first number in the file
  std::vector<std::int64_t> shape_;
};

/// An output file that several processes may write. One calls create(), the others join() with the temporary name.
class NpyOutput {
 public:
  NpyOutput(const std::string& path, const std::vector<std::int64_t>& shape);

  /// Creates the file and writes its header. Throws InputError, also if a file that is not regular has this name.
  void create();
  void join(const std::string& temporary);
  const std::string& temporary() const { return file_->temporary(); }
  void write(std::int64_t first, std::int64_t count, const double* numbers);
  void finish() { file_->finish(); }
  void publish() { file_->publish(); }

 private:
  std::string path_, header_;
  std::unique_ptr<OutputFile> file_;
  std::int64_t bytes_;
};

}  // namespace manycontact::cli
