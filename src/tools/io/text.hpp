#pragma once
// Reading files and numbers, independent of the locale.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/io/input_error.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::io {

/// A place in a file, to blame. `file` outlives it.
struct Where {
  const std::string* file;
  int line;
  [[noreturn]] void fail(const std::string& message) const { throw InputError(*file, line, message); }
};

/// The whole file; on failure fills `problem` with the reason and returns an empty string.
std::string read_file(const std::string& path, std::string& problem);

/// The same. On failure it throws InputError, which says that `what` was expected.
std::string read_file_of(const std::string& path, const std::string& what);

/// Returns why `path` cannot be opened for reading, or nothing if it can. With only_regular, devices and pipes are
/// refused, because paths in files must not name something that may not end.
std::string file_problem(const std::string& path, bool only_regular = false);

/// Decodes the bytes of the file `path` as its byte order mark or declaration specifies: UTF-8 (the default), UTF-16,
/// US-ASCII, ISO-8859-1, ISO-8859-15 or Windows-1252. Line breaks remain where they were. Throws InputError, with the
/// line, for other encodings, invalid bytes, and references such as &#0; or &#xD800; that name no character of XML.
/// Comments may contain any bytes and are not decoded.
std::string decode_xml(const std::string& path, const std::string& bytes);

/// The shortest decimal that reads back as x.
std::string show(double x);

/// Splits at white space.
std::vector<std::string_view> words(std::string_view text);

/// One finite number. `what` names it in messages.
double parse_number(const Where& where, const std::string& what, std::string_view text);
/// One number, or an infinity as "inf", "-Infinity" or a number beyond 1.8e308.
double parse_number_or_infinity(const Where& where, const std::string& what, std::string_view text);
/// Any count of finite numbers, separated by white space.
std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text);
/// Exactly `count` of them.
std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text,
                                  std::size_t count);
/// A whole number from 0 to 2^31 - 1, as 100000 or 1e5; -1 when `text` is none.
int parse_count(std::string_view text);

}  // namespace manycontact::io
