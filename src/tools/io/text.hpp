#pragma once
// Functions that read files and numbers, independently of the locale.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/io/input_error.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::io {

struct Where {  // A position in a file, for error messages. The string `file` must outlive it.
  const std::string* file;
  int line;
  [[noreturn]] void fail(const std::string& message) const { throw InputError(*file, line, message); }
};

/// Returns the content of a file. On failure returns "" and sets `problem` to the reason.
std::string read_file(const std::string& path, std::string& problem);

/// Returns the content of a file. On failure throws InputError, whose message states that `what` was expected.
std::string read_file_of(const std::string& path, const std::string& what);

/// Returns why `path` cannot be read, or "". only_regular also refuses devices and pipes, which may be endless.
std::string file_problem(const std::string& path, bool only_regular = false);

/// Decodes the bytes of the file `path` by its byte order mark or declaration: UTF-8 (the default), UTF-16, US-ASCII,
/// ISO-8859-1, ISO-8859-15 or Windows-1252. Throws InputError, with the line, for other encodings, invalid bytes, and
/// references such as &#xD800; to characters that XML forbids. Keeps line breaks. Does not decode comments.
std::string decode_xml(const std::string& path, const std::string& bytes);

std::string show(double x);  // returns the shortest decimal number that reads back as x

std::vector<std::string_view> words(std::string_view text);  // splits `text` at white space

/// Parses one finite number. what: the number's name in error messages.
double parse_number(const Where& where, const std::string& what, std::string_view text);
/// Parses one number. "inf", "-Infinity" and numbers beyond 1.8e308 yield an infinity.
double parse_number_or_infinity(const Where& where, const std::string& what, std::string_view text);
/// Parses any count of finite numbers, separated by white space.
std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text);
/// Parses exactly `count` finite numbers.
std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text,
                                  std::size_t count);
/// Parses a whole number from 0 to 2^31 - 1, such as 100000 or 1e5. Returns -1 if `text` is not such a number.
int parse_count(std::string_view text);

}  // namespace manycontact::io
