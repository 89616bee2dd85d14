#pragma once
// NumPy's .npy files of float64 numbers: little endian, C order. Read a few rows at a time, and written so.

#include <cstdint>
#include <string>
#include <vector>

namespace manycontact::cli {

/// The header of a .npy file, version 1.0, for numbers of that shape.
std::string npy_header(const std::vector<std::int64_t>& shape);

/// An open file.
class NpyInput {
 public:
  /// Versions 1.0 and 2.0, two or three dimensions, exactly as long as its header says. Throws InputError.
  explicit NpyInput(const std::string& path);
  ~NpyInput();
  NpyInput(const NpyInput&) = delete;
  NpyInput& operator=(const NpyInput&) = delete;

  const std::vector<std::int64_t>& shape() const { return shape_; }
  /// `count` numbers from number `first` on, in the file's order. Throws InputError.
  void read(std::int64_t first, std::int64_t count, double* out) const;

 private:
  void read_header();
  void parse_header(const std::string& text);
  [[noreturn]] void refuse(const std::string& what) const;

  std::string path_;
  int file_ = -1;
  std::int64_t data_ = 0;  // where the numbers begin
  std::vector<std::int64_t> shape_;
};

/// A file that is called PATH.part until it is whole. Several processes may write it.
class NpyOutput {
 public:
  NpyOutput(std::string path, std::vector<std::int64_t> shape);
  /// Removes what was not published.
  ~NpyOutput();
  NpyOutput(NpyOutput&&) noexcept;
  NpyOutput(const NpyOutput&) = delete;

  /// Creates PATH.part with its header. Throws InputError where PATH could not be written or is no regular file.
  void create();
  /// In another process, once it was created.
  void join();
  /// `count` numbers from number `first` on. Throws InputError when the disk is full.
  void write(std::int64_t first, std::int64_t count, const double* numbers);
  /// All that this process wrote is with the file system.
  void close();
  /// PATH.part becomes PATH: by one process, once all have closed it. The others leave it to that one.
  void publish();
  void leave();

 private:
  void open(int flags);
  void write_at(std::int64_t at, std::size_t size, const char* bytes);
  [[noreturn]] void refuse() const;

  std::string path_, target_, part_;
  std::string header_;
  std::int64_t bytes_;
  int file_ = -1;
  bool unfinished_ = false;
};

}  // namespace manycontact::cli
