#include <functional>
#include <numeric>

#include "manycontact/io/input_error.hpp"
#include "npy.hpp"

namespace manycontact::cli {

std::string npy_header(const std::vector<std::int64_t>& shape) {
  std::string text = "{'descr': '<f8', 'fortran_order': False, 'shape': (";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k > 0 ? ", " : "") + std::to_string(shape[k]);
  text += shape.size() == 1 ? ",), }" : "), }";
  constexpr std::size_t kBefore = 10, kAligned = 64;  // bytes before the header's dictionary; alignment of the data
  text.append(kAligned - (kBefore + text.size()) % kAligned, ' ');
  text.back() = '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(text.size() & 0xff);
  out += static_cast<char>(text.size() >> 8);
  return out + text;
}

NpyOutput::NpyOutput(const std::string& path, const std::vector<std::int64_t>& shape)
    : path_(path),
      header_(npy_header(shape)),
      bytes_(std::accumulate(shape.begin(), shape.end(), std::int64_t{8}, std::multiplies<>())) {}

void NpyOutput::create() {
  if (is_written_straight(path_))
    throw InputError(path_, 1, "is not a regular file, expected a file that --out may create");
  file_ = std::make_unique<OutputFile>(path_, "--out");
  file_->write(header_.data(), header_.size());
  file_->resize(static_cast<std::int64_t>(header_.size()) + bytes_);
}

void NpyOutput::join(const std::string& temporary) { file_ = std::make_unique<OutputFile>(path_, "--out", temporary); }

void NpyOutput::write(std::int64_t first, std::int64_t count, const double* numbers) {
  file_->write_at(static_cast<std::int64_t>(header_.size()) + 8 * first, reinterpret_cast<const char*>(numbers),
                  8 * static_cast<std::size_t>(count));
}

}  // namespace manycontact::cli
