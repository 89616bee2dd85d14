#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>
#include <utility>

#include "manycontact/io/input_error.hpp"
#include "npy.hpp"

namespace manycontact::cli {

std::string npy_header(const std::vector<std::int64_t>& shape) {
  std::string text = "{'descr': '<f8', 'fortran_order': False, 'shape': (";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k > 0 ? ", " : "") + std::to_string(shape[k]);
  text += shape.size() == 1 ? ",), }" : "), }";
  constexpr std::size_t kBefore = 10, kAligned = 64;  // as NumPy does
  text.append(kAligned - (kBefore + text.size()) % kAligned, ' ');
  text.back() = '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(text.size() & 0xff);
  out += static_cast<char>(text.size() >> 8);
  return out + text;
}

namespace {

// What a link to a file means, so that the link stays one.
std::string behind_links(const std::string& path) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  return error ? path : target.string();
}

}  // namespace

NpyOutput::NpyOutput(std::string path, std::vector<std::int64_t> shape)
    : path_(std::move(path)),
      target_(behind_links(path_)),
      part_(target_ + ".part"),
      header_(npy_header(shape)),
      bytes_(std::accumulate(shape.begin(), shape.end(), std::int64_t{8}, std::multiplies<>())) {}

NpyOutput::NpyOutput(NpyOutput&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      part_(std::move(other.part_)),
      header_(std::move(other.header_)),
      bytes_(other.bytes_),
      file_(std::exchange(other.file_, -1)),
      unfinished_(std::exchange(other.unfinished_, false)) {}

NpyOutput::~NpyOutput() {
  if (file_ >= 0) ::close(file_);
  if (unfinished_) unlink(part_.c_str());
}

void NpyOutput::refuse() const {
  throw InputError(
      path_, 1, std::string("cannot be written: ") + std::strerror(errno) + ", expected a file that --out may create");
}

void NpyOutput::open(int flags) {
  file_ = ::open(part_.c_str(), flags | O_WRONLY | O_CLOEXEC, 0666);
  if (file_ < 0) refuse();
  unfinished_ = true;
}

void NpyOutput::create() {
  struct stat status {};
  if (stat(path_.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    throw InputError(path_, 1, "is not a regular file, expected one that --out may create");
  open(O_CREAT | O_TRUNC);
  write_at(0, header_.size(), header_.data());
  if (ftruncate(file_, static_cast<off_t>(header_.size()) + bytes_) != 0) refuse();
}

void NpyOutput::join() { open(0); }

void NpyOutput::write(std::int64_t first, std::int64_t count, const double* numbers) {
  write_at(static_cast<std::int64_t>(header_.size()) + 8 * first, 8 * static_cast<std::size_t>(count),
           reinterpret_cast<const char*>(numbers));
}

void NpyOutput::write_at(std::int64_t at, std::size_t size, const char* bytes) {
  while (size > 0) {
    const ssize_t done = pwrite(file_, bytes, size, at);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) refuse();
    bytes += done, at += done, size -= done;
  }
}

void NpyOutput::close() {
  if (fsync(file_) != 0 && errno != EINVAL) refuse();
  const int file = std::exchange(file_, -1);
  if (::close(file) != 0) refuse();
}

void NpyOutput::publish() {
  if (rename(part_.c_str(), target_.c_str()) != 0) refuse();
  unfinished_ = false;
}

void NpyOutput::leave() { unfinished_ = false; }

}  // namespace manycontact::cli
