#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <limits>

#include "../files/json_file.hpp"
#include "manycontact/io/input_error.hpp"
#include "npy.hpp"

namespace manycontact::cli {

static_assert(std::endian::native == std::endian::little, "numbers are read and written as they are in memory");

namespace {

constexpr char kExpected[] = ", expected a .npy file of little-endian float64 numbers in C order ('<f8')";

struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::int64_t> shape;
};

// Converts the text of a Python dictionary to JSON. Tuples become lists, and strings get double quotes.
std::string as_json(const std::string& python) {
  std::string out;
  for (const char c : python) {
    const bool ends = c == ')' || c == '}';
    if (ends) out.resize(out.find_last_not_of(" \t\n") + 1);
    if (ends && out.ends_with(',')) out.pop_back();
    out += c == '\'' ? '"' : c == '(' ? '[' : c == ')' ? ']' : c;
  }
  for (const auto& [word, other] : {std::pair("True", "true"), std::pair("False", "false")})
    if (const std::size_t at = out.find(word); at != std::string::npos)
      out.replace(at, std::string_view(word).size(), other);
  return out;
}

// Parses the dictionary in a file's header. Returns false unless it has exactly the three keys of NumPy's format, in
// any order.
bool parse(const std::string& text, Header& out) {
  const Json json = Json::parse(as_json(text), nullptr, false);
  if (!json.is_object() || json.size() != 3) return false;
  for (const char* key : {"descr", "fortran_order", "shape"})
    if (!json.contains(key) || text.find(key) != text.rfind(key)) return false;
  const Json& shape = json["shape"];
  if (!json["descr"].is_string() || !json["fortran_order"].is_boolean() || !shape.is_array()) return false;
  for (const Json& n : shape)
    if (!n.is_number_unsigned() || n.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max()) return false;
  out = {json["descr"], json["fortran_order"], shape.get<std::vector<std::int64_t>>()};
  return true;
}

// Returns the number of elements of an array of this shape, or -1 if no file can contain so many.
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
           ", but only versions 1.0 and 2.0 can be read");
  const int length_bytes = major == 1 ? 2 : 4;
  std::uint32_t length = 0;
  for (int k = length_bytes - 1; k >= 0; --k) length = length << 8 | start[8 + k];
  data_ = 8 + length_bytes + static_cast<std::int64_t>(length);
  constexpr std::uint32_t kLongest = 1 << 20;
  std::string text(std::min(length, kLongest), ' ');
  if (got < 8 + length_bytes || length > kLongest ||
      pread(file_, text.data(), length, 8 + length_bytes) != static_cast<ssize_t>(length))
    refuse("ends within its header");
  Header header;
  if (!parse(text, header)) refuse("has a header that NumPy does not write");
  if (header.descr != "<f8") refuse("has numbers of type '" + header.descr + "'");
  if (header.fortran_order) refuse("has its numbers in Fortran order");
  shape_ = header.shape;
  if (shape_.size() != 2 && shape_.size() != 3)
    refuse("has an array of " + std::to_string(shape_.size()) + " dimensions, not of two or three");
}

void NpyInput::read(std::int64_t first, std::int64_t count, double* out) const {
  char* to = reinterpret_cast<char*>(out);
  std::int64_t at = data_ + 8 * first;
  for (std::int64_t left = 8 * count; left > 0;) {
    const ssize_t got = pread(file_, to, left, at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      refuse(got == 0 ? "became shorter during reading" : std::string("cannot be read: ") + std::strerror(errno));
    to += got, at += got, left -= got;
  }
}

}  // namespace manycontact::cli
