#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>

#include "manycontact/io/input_error.hpp"
#include "npy.hpp"

namespace manycontact::cli {

static_assert(std::endian::native == std::endian::little, "numbers are read and written as they are in memory");

namespace {

constexpr char kExpected[] = ", expected a .npy file of little-endian float64 numbers in C order ('<f8')";

/// A Python dictionary of strings, True, False and tuples of whole numbers, as headers are.
class Literal {
 public:
  explicit Literal(const std::string& text) : text_(text) {}

  bool take(char c) {
    skip();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::optional<std::string> string() {
    skip();
    if (at_ == text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) return std::nullopt;
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string::npos) return std::nullopt;
    const std::string out = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return out;
  }
  std::optional<std::string> word() {
    skip();
    const std::size_t start = at_;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (start == at_) return std::nullopt;
    return text_.substr(start, at_ - start);
  }
  std::optional<std::int64_t> number() {
    skip();
    std::int64_t out = 0;
    const std::size_t start = at_;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_]))) {
      if (out > (std::numeric_limits<std::int64_t>::max() - 9) / 10) return std::nullopt;
      out = 10 * out + (text_[at_++] - '0');
    }
    if (start == at_) return std::nullopt;
    return out;
  }
  bool at_end() {
    skip();
    return at_ == text_.size();
  }

 private:
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  const std::string& text_;
  std::size_t at_ = 0;
};

struct Header {
  std::optional<std::string> descr, order;
  std::optional<std::vector<std::int64_t>> shape;
};

std::optional<std::vector<std::int64_t>> tuple(Literal& text) {
  std::vector<std::int64_t> out;
  if (!text.take('(')) return std::nullopt;
  while (!text.take(')')) {
    if (!out.empty() && !text.take(',')) return std::nullopt;
    if (!out.empty() && text.take(')')) break;
    const auto number = text.number();
    if (!number) return std::nullopt;
    out.push_back(*number);
  }
  return out;
}

// Whether `text` is a header: the three keys, each once, in any order.
bool parse(const std::string& header, Header& out) {
  Literal text(header);
  if (!text.take('{')) return false;
  for (int k = 0; k < 3; ++k) {
    const auto key = text.string();
    if (!key || !text.take(':')) return false;
    if (*key == "descr" && !out.descr)
      out.descr = text.string();
    else if (*key == "fortran_order" && !out.order)
      out.order = text.word();
    else if (*key == "shape" && !out.shape)
      out.shape = tuple(text);
    else
      return false;
    if (!text.take(',') && k < 2) return false;
  }
  return text.take('}') && text.at_end() && out.descr && out.shape && (out.order == "True" || out.order == "False");
}

// Numbers of that shape, -1 when too many for a file.
std::int64_t numbers_of(const std::vector<std::int64_t>& shape) {
  std::int64_t out = 1;
  for (std::int64_t n : shape)
    if (n > 0 && out > std::numeric_limits<std::int64_t>::max() / 16 / n)
      return -1;
    else
      out *= n;
  return out;
}

}  // namespace

NpyInput::NpyInput(const std::string& path) : path_(path) {
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file_ < 0 || fstat(file_, &status) != 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
  try {
    if (!S_ISREG(status.st_mode)) refuse("is not a regular file");
    read_header();
    const std::int64_t numbers = numbers_of(shape_), bytes = status.st_size - data_;
    if (numbers < 0 || bytes != 8 * numbers)
      refuse("has " + std::to_string(bytes) + " bytes of numbers where its shape requires " +
             (numbers < 0 ? "more than any file has" : std::to_string(8 * numbers)));
  } catch (...) {
    ::close(file_);
    throw;
  }
}

NpyInput::~NpyInput() { ::close(file_); }

void NpyInput::refuse(const std::string& what) const { throw InputError(path_, 1, what + kExpected); }

void NpyInput::read_header() {
  unsigned char start[12];
  const ssize_t got = pread(file_, start, sizeof start, 0);
  if (got < 10 || std::memcmp(start, "\x93NUMPY", 6) != 0) refuse("is no .npy file");
  const int major = start[6], minor = start[7];
  if ((major != 1 && major != 2) || minor != 0)
    refuse("is a .npy file of version " + std::to_string(major) + "." + std::to_string(minor) +
           ", of which only 1.0 and 2.0 are read");
  const int length_bytes = major == 1 ? 2 : 4;
  std::uint32_t length = 0;
  for (int k = length_bytes - 1; k >= 0; --k) length = length << 8 | start[8 + k];
  data_ = 8 + length_bytes + static_cast<std::int64_t>(length);
  constexpr std::uint32_t kLongest = 1 << 20;
  std::string text(std::min(length, kLongest), ' ');
  if (got < 8 + length_bytes || length > kLongest ||
      pread(file_, text.data(), length, 8 + length_bytes) != static_cast<ssize_t>(length))
    refuse("ends within its header");
  parse_header(text);
}

void NpyInput::parse_header(const std::string& text) {
  Header header;
  if (!parse(text, header)) refuse("has a header that is none of NumPy's");
  if (*header.descr != "<f8") refuse("has numbers of type '" + *header.descr + "'");
  if (*header.order == "True") refuse("is in Fortran's order");
  shape_ = *header.shape;
  if (shape_.size() != 2 && shape_.size() != 3)
    refuse("has " + std::to_string(shape_.size()) + " dimensions, not two or three");
}

void NpyInput::read(std::int64_t first, std::int64_t count, double* out) const {
  char* to = reinterpret_cast<char*>(out);
  std::int64_t at = data_ + 8 * first;
  for (std::int64_t left = 8 * count; left > 0;) {
    const ssize_t got = pread(file_, to, left, at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) refuse(got == 0 ? "became shorter" : std::string("cannot be read: ") + std::strerror(errno));
    to += got, at += got, left -= got;
  }
}

}  // namespace manycontact::cli
