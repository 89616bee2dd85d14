#include "text.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace manycontact::io {

namespace {

constexpr std::size_t kLargestFile = std::size_t(1) << 28;
constexpr bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Parses one number. Returns infinity if the word is "inf" or exceeds the largest double.
double parse_any_word(const Where& where, const std::string& what, std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
  const bool whole = end == digits.data() + digits.size() && !digits.empty();
  if (!whole || error == std::errc::invalid_argument)
    where.fail(what + ": " + quote(word) + " is not a number, expected a number like 0.5 or 1e-3");
  if (std::isnan(x)) where.fail(what + ": " + quote(word) + " is not finite, expected a finite number");
  if (error != std::errc::result_out_of_range) return x;
  const bool tiny = digits.find_first_of("eE") == std::string_view::npos
                        ? digits.find_first_of("123456789") > digits.find('.')
                        : digits.find("e-") != std::string_view::npos || digits.find("E-") != std::string_view::npos;
  const double beyond = tiny ? 0 : std::numeric_limits<double>::infinity();
  return digits[0] == '-' ? -beyond : beyond;
}

double parse_word(const Where& where, const std::string& what, std::string_view word) {
  const double x = parse_any_word(where, what, word);
  if (std::isfinite(x)) return x;
  if (word.find_first_of("iI") != std::string_view::npos)
    where.fail(what + ": " + quote(word) + " is not finite, expected a finite number");
  where.fail(what + ": " + quote(word) + " is too large, expected a number below 1.8e308");
}

std::string_view only_word(const Where& where, const std::string& what, std::string_view text) {
  const auto parts = words(text);
  if (parts.empty()) where.fail(what + " is empty, expected a number");
  if (parts.size() > 1) where.fail(what + ": " + quote(text) + " is not one number, expected a single number");
  return parts[0];
}

}  // namespace

std::string file_problem(const std::string& path, bool only_regular) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) return "is a directory";
  if (only_regular && std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return "is not a file but a device or a pipe";
  errno = 0;
  if (std::ifstream(path, std::ios::binary)) return {};
  return std::string("cannot be opened") + (errno ? std::string(": ") + std::strerror(errno) : "");
}

std::string read_file(const std::string& path, std::string& problem) {
  problem = file_problem(path);
  if (!problem.empty()) return {};
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestFile) {
      problem = "is larger than 256 MB";
      return {};
    }
  }
  if (in.bad()) {
    problem = "cannot be read";
    return {};
  }
  return text;
}

std::string read_file_of(const std::string& path, const std::string& what) {
  std::string problem, text = read_file(path, problem);
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected " + what);
  return text;
}

std::string show(double x) {
  char digits[40];
  const auto end = std::to_chars(digits, digits + sizeof digits, x).ptr;
  return std::string(digits, end);
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> out;
  std::size_t i = 0;
  while (true) {
    while (i < text.size() && is_space(text[i])) ++i;
    if (i == text.size()) return out;
    const std::size_t begin = i;
    while (i < text.size() && !is_space(text[i])) ++i;
    out.push_back(text.substr(begin, i - begin));
  }
}

double parse_number(const Where& where, const std::string& what, std::string_view text) {
  return parse_word(where, what, only_word(where, what, text));
}

double parse_number_or_infinity(const Where& where, const std::string& what, std::string_view text) {
  return parse_any_word(where, what, only_word(where, what, text));
}

std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text) {
  std::vector<double> out;
  for (const std::string_view word : words(text)) out.push_back(parse_word(where, what, word));
  return out;
}

std::vector<double> parse_numbers(const Where& where, const std::string& what, std::string_view text,
                                  std::size_t count) {
  std::vector<double> out = parse_numbers(where, what, text);
  if (out.size() != count)
    where.fail(what + " has " + std::to_string(out.size()) + " number" + (out.size() == 1 ? "" : "s") + ", expected " +
               std::to_string(count));
  return out;
}

int parse_count(std::string_view text) {
  const auto parts = words(text);
  if (parts.size() != 1) return -1;
  double x = 0;
  const auto [end, error] = std::from_chars(parts[0].data(), parts[0].data() + parts[0].size(), x);
  if (error != std::errc() || end != parts[0].data() + parts[0].size()) return -1;
  return x >= 0 && x <= std::numeric_limits<int>::max() && x == std::floor(x) ? static_cast<int>(x) : -1;
}

}  // namespace manycontact::io
