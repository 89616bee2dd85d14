#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <utility>

#include "text.hpp"

namespace manycontact::io {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF", kUtf16LittleMark = "\xFF\xFE", kUtf16BigMark = "\xFE\xFF";
constexpr const char* kKnown = "UTF-8, UTF-16, US-ASCII, ISO-8859-1, ISO-8859-15 or Windows-1252";

void append_utf8(std::uint32_t c, std::string& out) {
  const auto tail = [&](int shift) { out += static_cast<char>(0x80 | ((c >> shift) & 0x3F)); };
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | (c >> 6)), tail(0);
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0 | (c >> 12)), tail(6), tail(0);
  } else {
    out += static_cast<char>(0xF0 | (c >> 18)), tail(12), tail(6), tail(0);
  }
}

// Returns the name of an encoding in normal form, in which "ISO-8859-1" and "iso8859_1" are equal.
std::string plain_name(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != '-' && c != '_' && c != '.') out += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return out;
}

// Returns the encoding that <?xml ... encoding="..."?> declares, or "".
std::string_view declared_encoding(std::string_view text) {
  if (!text.starts_with("<?xml")) return {};
  const std::string_view declaration = text.substr(0, text.find("?>"));
  std::size_t at = declaration.find("encoding");
  if (at == std::string_view::npos) return {};
  at = declaration.find_first_of("\"'", at);
  if (at == std::string_view::npos) return {};
  const std::size_t end = declaration.find(declaration[at], at + 1);
  return end == std::string_view::npos ? std::string_view() : declaration.substr(at + 1, end - at - 1);
}

// The characters of Windows-1252 from 0x80 to 0x9F; 0 means no character.
constexpr std::array<std::uint16_t, 32> kWindows1252 = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                        0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                        0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                        0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

std::uint32_t latin1(unsigned char byte) { return byte; }

std::uint32_t windows1252(unsigned char byte) {
  return byte >= 0x80 && byte < 0xA0 && kWindows1252[byte - 0x80] ? kWindows1252[byte - 0x80] : byte;
}

std::uint32_t latin9(unsigned char byte) {  // ISO-8859-15: Latin-1 except for eight characters
  constexpr std::pair<unsigned char, std::uint32_t> kOthers[] = {{0xA4, 0x20AC}, {0xA6, 0x160}, {0xA8, 0x161},
                                                                 {0xB4, 0x17D},  {0xB8, 0x17E}, {0xBC, 0x152},
                                                                 {0xBD, 0x153},  {0xBE, 0x178}};
  for (const auto& [from, to] : kOthers)
    if (byte == from) return to;
  return byte;
}

std::string decode_bytes(std::string_view bytes, std::uint32_t (*character)(unsigned char)) {
  std::string out;
  out.reserve(bytes.size());
  for (const char b : bytes) append_utf8(character(static_cast<unsigned char>(b)), out);
  return out;
}

// Converts UTF-16 to UTF-8. Unpaired surrogates are kept; the later check of characters reports their line.
std::string decode_utf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? first << 8 | second : second << 8 | first);
  };
  std::string out;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xDC00 && i + 3 < bytes.size()) {
      const std::uint32_t low = unit(i + 2);
      if (low >= 0xDC00 && low < 0xE000) c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00), i += 2;
    }
    append_utf8(c, out);
  }
  return out;
}

// Returns whether XML 1.0 allows the character (production 2).
bool is_xml_character(std::uint32_t c) {
  return c == 0x9 || c == 0xA || c == 0xD || (c >= 0x20 && c < 0xD800) || (c >= 0xE000 && c < 0xFFFE) ||
         (c >= 0x10000 && c < 0x110000);
}

struct Decoded {  // A UTF-8 character and its length in bytes. The length is 0 if the bytes are not a valid character.
  std::uint32_t character = 0;
  std::size_t length = 0;
};

Decoded utf8_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 && first < 0xF8 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 0;
  if (length == 0 || first >= 0xF8 || at + length > text.size()) return {};
  std::uint32_t c = first & (0xFF >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return {};
    c = c << 6 | (byte(k) & 0x3F);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // least code point of a UTF-8 sequence, by length
  return c < kLeast[length] ? Decoded() : Decoded{c, length};
}

// Scans the text once. Throws InputError for characters that XML forbids, and for references to them.
class Characters {
 public:
  Characters(const std::string& path, std::string_view text, bool declared)
      : path_(path), text_(text), declared_(declared) {}

  void check() {
    while (at_ < text_.size()) {
      if (section("<!--", "-->", false) || section("<![CDATA[", "]]>", true)) continue;
      if (text_.compare(at_, 2, "&#") == 0) check_reference();
      check_character();
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(path_, line_, message); }

  void check_character() {
    const Decoded c = utf8_at(text_, at_);
    if (c.length == 0)
      fail("contains the byte " + hexadecimal(static_cast<unsigned char>(text_[at_])) +
           ", which is not UTF-8, expected " +
           (declared_ ? "text in the encoding that the file declares"
                      : "UTF-8, or another encoding declared as in <?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>"));
    if (c.character == 0) fail("contains a zero byte, expected UTF-8 text");
    if (!is_xml_character(c.character))
      fail("contains the character " + hexadecimal(c.character) +
           ", which XML does not allow, expected only characters of XML");
    advance(c.length);
  }

  void check_reference() const {
    const std::size_t end = text_.find_first_of("; \t\r\n<>\"'&", at_ + 2);
    if (end == std::string_view::npos || text_[end] != ';') return;  // not a reference: & remains as it is
    std::string_view digits = text_.substr(at_ + 2, end - at_ - 2);
    const bool hex = digits.starts_with('x');
    if (hex) digits.remove_prefix(1);
    std::uint32_t c = 0;
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), c, hex ? 16 : 10);
    if (error != std::errc() || last != digits.data() + digits.size() || !is_xml_character(c))
      fail("refers to " + quote(text_.substr(at_, end + 1 - at_)) +
           ", which is no character of XML, expected a character like &#228;");
  }

  static std::string hexadecimal(std::uint32_t c) {
    char digits[16];
    return "0x" + std::string(digits, std::to_chars(digits, digits + sizeof digits, c, 16).ptr);
  }

  void advance(std::size_t count) {
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         text_.begin() + static_cast<std::ptrdiff_t>(at_ + count), '\n'));
    at_ += count;
  }

  // Skips a section at the current position, such as a comment, from `begin` to `end`. Checks its characters if
  // `checks`, but not its references. Returns false if no section begins here.
  bool section(std::string_view begin, std::string_view end, bool checks) {
    if (text_.compare(at_, begin.size(), begin) != 0) return false;
    const std::size_t found = text_.find(end, at_ + begin.size());
    const std::size_t to = found == std::string_view::npos ? text_.size() : found + end.size();
    while (checks && at_ < to) check_character();
    if (!checks) advance(to - at_);
    return true;
  }

  const std::string& path_;
  std::string_view text_;
  bool declared_;
  std::size_t at_ = 0;
  int line_ = 1;
};

std::string as_utf8(const std::string& path, std::string_view bytes) {
  if (bytes.starts_with(kUtf8Mark)) return std::string(bytes.substr(kUtf8Mark.size()));
  if (bytes.starts_with(kUtf16LittleMark) || bytes.starts_with(kUtf16BigMark))
    return decode_utf16(bytes.substr(2), bytes.starts_with(kUtf16BigMark));
  const std::string_view declared = declared_encoding(bytes);
  const std::string name = plain_name(declared);
  if (name.empty() || name == "utf8" || name == "usascii" || name == "ascii") return std::string(bytes);
  if (name == "iso88591" || name == "latin1") return decode_bytes(bytes, latin1);
  if (name == "iso885915" || name == "latin9") return decode_bytes(bytes, latin9);
  if (name == "windows1252" || name == "cp1252") return decode_bytes(bytes, windows1252);
  throw InputError(path, 1,
                   name.starts_with("utf16") ? "declares the encoding " + quote(declared) +
                                                   " without a byte order mark, expected a byte order mark"
                                             : "declares the encoding " + quote(declared) + ", expected " + kKnown);
}

}  // namespace

std::string decode_xml(const std::string& path, const std::string& bytes) {
  std::string text = as_utf8(path, bytes);
  Characters(path, text, !declared_encoding(text).empty()).check();
  return text;
}

}  // namespace manycontact::io
