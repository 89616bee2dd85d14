#include "output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <utility>

#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;   // that Linux follows
constexpr int kMostTries = 100;  // at a FILE.part that others remove

bool is_open_file(const std::string& path) { return path.starts_with("/proc/"); }

// N of what this process has open as N; -1: it is something else.
int descriptor_of(const std::string& target) {
  if (target == "-") return STDOUT_FILENO;
  if (!is_open_file(target)) return -1;
  const fs::path path(target);
  std::error_code error;
  bool own = false;
  for (const char* folder : {"/proc/self/fd", "/proc/thread-self/fd"})
    own = own || path.parent_path() == fs::canonical(folder, error);
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), number);
  return own && wrong == std::errc() && end == name.data() + name.size() ? number : -1;
}

bool takes_bytes_straight(const std::string& path) {
  struct stat status {};
  if (descriptor_of(path) >= 0) return true;
  if (stat(path.c_str(), &status) != 0 || S_ISDIR(status.st_mode)) return false;
  return !S_ISREG(status.st_mode) || is_open_file(path);
}

}  // namespace

std::string behind_links(const std::string& path) {
  std::error_code error;
  fs::path at = path;
  for (int k = 0; k < kMostLinks; ++k) {
    const fs::path folder = fs::canonical(at.has_parent_path() ? at.parent_path() : ".", error);
    if (error) return at.string();
    at = folder / at.filename();
    if (is_open_file(at.string()) || !fs::is_symlink(at, error)) break;
    at = folder / fs::read_symlink(at, error);
  }
  return at.string();
}

bool is_standard_output(const std::string& path) {
  return path == "-" || descriptor_of(behind_links(path)) == STDOUT_FILENO;
}

PartFile::PartFile(std::string path, std::string option)
    : path_(std::move(path)),
      option_(std::move(option)),
      target_(path_ == "-" ? path_ : behind_links(path_)),
      part_(takes_bytes_straight(target_) ? target_ : target_ + ".part") {}

PartFile::PartFile(PartFile&& other) noexcept
    : path_(std::move(other.path_)),
      option_(std::move(other.option_)),
      target_(std::move(other.target_)),
      part_(std::move(other.part_)),
      file_(std::exchange(other.file_, -1)),
      lock_(std::exchange(other.lock_, -1)),
      unfinished_(std::exchange(other.unfinished_, false)) {}

PartFile::~PartFile() {
  if (unfinished_) unlink(part_.c_str());  // before another run may take it
  if (file_ >= 0) ::close(file_);
  if (lock_ >= 0) ::close(lock_);
}

void PartFile::refuse(const std::string& reason) const {
  throw InputError(path_, 1,
                   "cannot be written: " + reason + ", expected a file that " +
                       (option_.empty() ? "may be created" : option_ + " may create"));
}

void PartFile::refuse(int error) const { refuse(std::string(std::strerror(error))); }

void PartFile::open(int flags) {
  // FILE.part is no link, FILE would become one; nothing waits at a pipe of that name
  const int careful = is_straight() ? 0 : O_NOFOLLOW | O_NONBLOCK;
  file_ = ::open(part_.c_str(), flags | careful | O_WRONLY | O_CLOEXEC, 0666);
  if (file_ < 0) refuse(errno);
}

void PartFile::open_again() {
  std::cout.flush();  // what was said before
  file_ = fcntl(descriptor_of(target_), F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (file_ < 0) refuse(errno);
}

bool PartFile::take() {
  open(O_CREAT);
  struct stat own {};
  struct stat named {};
  if (fstat(file_, &own) != 0) refuse(errno);
  if (!S_ISREG(own.st_mode) || own.st_nlink > 1) refuse(part_ + " is there and is no file of its own");
  if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) refuse("another run writes it");
  if (lstat(part_.c_str(), &named) == 0 && named.st_dev == own.st_dev && named.st_ino == own.st_ino) return true;
  ::close(std::exchange(file_, -1));
  return false;
}

void PartFile::create() {
  if (descriptor_of(target_) >= 0) return open_again();
  if (is_straight()) return open(O_TRUNC);
  struct stat old {};
  const bool replaces = stat(target_.c_str(), &old) == 0;
  if (!replaces && errno != ENOENT) refuse(errno);
  if (replaces && S_ISDIR(old.st_mode)) refuse(EISDIR);
  if (replaces && access(target_.c_str(), W_OK) != 0) refuse(errno);
  for (int k = 0; !take(); ++k)
    if (k == kMostTries) refuse("other runs write it");
  unfinished_ = true;
  lock_ = fcntl(file_, F_DUPFD_CLOEXEC, 0);
  resize(0);
  if (replaces) (void)fchmod(file_, old.st_mode & 0777);  // not every file system has modes
}

void PartFile::join() {
  open(0);
  unfinished_ = !is_straight();
}

void PartFile::resize(std::int64_t bytes) {
  if (ftruncate(file_, static_cast<off_t>(bytes)) != 0) refuse(errno);
}

template <class Put>
void PartFile::put(const char* bytes, std::size_t size, Put&& put_some) {
  while (size > 0) {
    const ssize_t done = put_some(bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) refuse(errno);
    bytes += done, size -= static_cast<std::size_t>(done);
  }
}

void PartFile::write(const char* bytes, std::size_t size) {
  put(bytes, size, [this](const char* from, std::size_t n) { return ::write(file_, from, n); });
}

void PartFile::write_at(std::int64_t at, const char* bytes, std::size_t size) {
  put(bytes, size, [this, bytes, at](const char* from, std::size_t n) {
    return pwrite(file_, from, n, static_cast<off_t>(at + (from - bytes)));
  });
}

void PartFile::close() {
  if (!is_straight() && fsync(file_) != 0 && errno != EINVAL) refuse(errno);
  if (::close(std::exchange(file_, -1)) != 0) refuse(errno);
}

void PartFile::publish() {
  unfinished_ = false;  // it is whole, and stays where it cannot have its name
  const bool named = is_straight() || rename(part_.c_str(), target_.c_str()) == 0;
  const int error = errno;
  if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  if (named) return;
  throw InputError(path_, 1,
                   std::string("cannot be replaced: ") + std::strerror(error) + ", what was written is " + part_);
}

OutputFile::OutputFile(const std::string& path, const std::string& option)
    : file_(path, option), buffer_(file_), stream_(&buffer_) {
  stream_.exceptions(std::ios::badbit);  // the stream lets out what the buffer throws
  file_.create();
}

void OutputFile::close() {
  stream_.flush();
  file_.close();
  file_.publish();
}

OutputFile::Buffer::int_type OutputFile::Buffer::overflow(int_type c) {
  (void)sync();
  return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                         : sputc(traits_type::to_char_type(c));
}

int OutputFile::Buffer::sync() {
  file_.write(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  return 0;
}

}  // namespace manycontact::cli
