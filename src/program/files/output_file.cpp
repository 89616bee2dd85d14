#include "output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <utility>

#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace fs = std::filesystem;

bool is_standard_output(const std::string& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

bool is_written_straight(const std::string& path) {
  std::error_code error;
  return is_standard_output(path) || (fs::exists(path, error) && !fs::is_regular_file(path, error));
}

OutputFile::OutputFile(std::string path, std::string option) : path_(std::move(path)), option_(std::move(option)) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  stream_.exceptions(std::ios::badbit);  // lets exceptions of write() pass through the stream's operators
  if (is_standard_output(path_)) {
    std::cout.flush();  // earlier output of std::cout must precede that of this file
    file_ = dup(STDOUT_FILENO);
  } else if (is_written_straight(path_)) {
    file_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    begin();
  }
  if (file_ < 0) refuse(errno);
}

OutputFile::OutputFile(std::string path, std::string option, std::string temporary)
    : path_(std::move(path)), option_(std::move(option)), temporary_(std::move(temporary)), joined_(true) {
  file_ = open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) refuse(errno);
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
  until_whole_.reset();
  if (file_ >= 0) ::close(file_);
}

// Opens a temporary file in the folder of the target (links resolved), with the permissions of an existing target.
void OutputFile::begin() {
  std::error_code error;
  const fs::path there = fs::canonical(path_, error);
  target_ = error ? path_ : there.string();
  struct stat old {};
  const bool replaces = stat(target_.c_str(), &old) == 0;
  if (!replaces && errno != ENOENT) return;
  // A read-only target must be refused here, because rename would replace it.
  if (replaces && access(target_.c_str(), W_OK) != 0) return;
  constexpr std::string_view kEnd = ".part";
  std::string name = (fs::path(target_).parent_path() / "manycontact-XXXXXX").string().append(kEnd);
  file_ = mkostemps(name.data(), static_cast<int>(kEnd.size()), O_CLOEXEC);
  if (file_ < 0) return;
  temporary_ = std::move(name);
  until_whole_ = std::make_unique<RemovedBySignals>(temporary_);
  const mode_t mask = umask(0);
  umask(mask);
  (void)fchmod(file_, replaces ? old.st_mode & 0777 : 0666 & ~mask);  // fails on file systems without modes
}

void OutputFile::refuse(int error) const {
  throw InputError(path_, 1,
                   std::string("cannot be written: ") + std::strerror(error) + ", expected a file that " +
                       (option_.empty() ? "may be created" : option_ + " may create"));
}

void OutputFile::write(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t done = ::write(file_, bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) refuse(errno);
    bytes += done, size -= static_cast<std::size_t>(done);
  }
}

void OutputFile::write_at(std::int64_t at, const char* bytes, std::size_t size) {
  if (lseek(file_, static_cast<off_t>(at), SEEK_SET) < 0) refuse(errno);
  write(bytes, size);
}

void OutputFile::resize(std::int64_t bytes) {
  if (ftruncate(file_, static_cast<off_t>(bytes)) != 0) refuse(errno);
}

OutputFile::int_type OutputFile::overflow(int_type c) {
  (void)sync();
  return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                         : sputc(traits_type::to_char_type(c));
}

int OutputFile::sync() {
  write(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return 0;
}

void OutputFile::finish() {
  stream_.flush();
  if (!temporary_.empty() && fsync(file_) != 0 && errno != EINVAL) refuse(errno);
  if (::close(std::exchange(file_, -1)) != 0) refuse(errno);
  if (joined_) temporary_.clear();
}

void OutputFile::publish() {
  until_whole_.reset();
  const std::string from = std::exchange(temporary_, "");
  if (from.empty() || rename(from.c_str(), target_.c_str()) == 0) return;
  throw InputError(path_, 1,
                   std::string("cannot be replaced: ") + std::strerror(errno) +
                       ", expected a file that may be replaced; the new content is in " + from);
}

}  // namespace manycontact::cli
