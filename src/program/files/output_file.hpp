#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "../command/interrupt.hpp"

namespace manycontact::cli {

/// Returns whether a path is "-", /dev/stdout or another name of descriptor 1.
bool is_standard_output(const std::string& path);
/// Returns whether a path is written without a temporary file: standard output, a device, a pipe or a folder.
bool is_written_straight(const std::string& path);

/// The output file of an option. It is written under a temporary name in the same folder, and renamed when it is
/// complete. An older file of the final name remains until then, also if the run fails or is interrupted. All methods
/// throw InputError if the file cannot be written.
class OutputFile : private std::streambuf {
 public:
  explicit OutputFile(std::string path, std::string option = "");  // option: its name for errors, or ""
  /// Opens the temporary file that another process has created and will publish.
  OutputFile(std::string path, std::string option, std::string temporary);
  ~OutputFile() override;  // removes the temporary file unless it was published
  OutputFile(const OutputFile&) = delete;

  const std::string& path() const { return path_; }
  /// Returns the temporary name, which is used until the file is published. Empty if the file is written directly.
  const std::string& temporary() const { return temporary_; }

  /// stream and write append bytes; write_at writes them at a position. Operators of the stream throw on errors, too.
  std::ostream& stream() { return stream_; }
  void write(const char* bytes, std::size_t size);
  void write_at(std::int64_t at, const char* bytes, std::size_t size);
  void resize(std::int64_t bytes);

  void finish();  // writes all buffered bytes of this process to the file system, and closes the file
  /// Renames the file to its final name. Only the process that created it calls this, after all have finished.
  void publish();
  void close() { finish(), publish(); }

 private:
  int_type overflow(int_type c) override;
  int sync() override;
  void begin();
  [[noreturn]] void refuse(int error) const;

  std::string path_, option_, target_, temporary_;
  std::unique_ptr<RemovedBySignals> until_whole_;
  bool joined_ = false;
  int file_ = -1;
  std::vector<char> buffer_ = std::vector<char>(1 << 16);
  std::ostream stream_{this};
};

}  // namespace manycontact::cli
