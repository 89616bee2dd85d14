#pragma once

#include <stdexcept>
#include <string>

namespace manycontact {

/// An error in an input file, with the expected content. what() is "FILE:LINE: message", always on one line.
struct InputError : std::runtime_error {
  InputError(std::string file_, int line_, const std::string& message_);  // line breaks become blanks

  std::string file;
  int line;  // 1 if unknown
  std::string message;
};

}  // namespace manycontact
