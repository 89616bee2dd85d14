#include "manycontact/io/input_error.hpp"

#include <utility>

namespace manycontact {
namespace {

// Returns "FILE:LINE: message". Control characters, which names in the input may contain, become blanks.
std::string one_line(const std::string& file, int line, const std::string& message) {
  std::string text = file + ":" + std::to_string(line) + ": " + message;
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

}  // namespace

InputError::InputError(std::string file_, int line_, const std::string& message_)
    : std::runtime_error(one_line(file_, line_ < 1 ? 1 : line_, message_)),
      file(std::move(file_)),
      line(line_ < 1 ? 1 : line_),
      message(message_) {}

}  // namespace manycontact
