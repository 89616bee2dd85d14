#pragma once

#include <stdexcept>
#include <string>

namespace manycontact {

/// An error in an input file, and what was expected. what() is "FILE:LINE: message", on one line for any input.
struct InputError : std::runtime_error {
  InputError(std::string file_, int line_, const std::string& message_);  // line breaks become blanks

  std::string file;
  int line;  // 1 if unknown
  std::string message;
};

}  // namespace manycontact
