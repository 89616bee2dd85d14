#pragma once
// The HTML page of a view is split into its parts.

#include <cstring>

#include "cli/program.hpp"

namespace manycontact::cli {

template <class T>
std::vector<T> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    EXPECT_NE(digits.find(c), std::string::npos) << c;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  EXPECT_EQ(bytes.size() % sizeof(T), 0u);
  std::vector<T> out(bytes.size() / sizeof(T));
  std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
  return out;
}

struct ViewPage {
  std::string html;      // all of it
  std::string own;       // without three.js
  nlohmann::json scene;  // its data

  explicit ViewPage(const std::string& path) : html(read_text(path)) {
    const std::string three = "<!-- three.js", data = "<script type=\"application/json\" id=\"scene\">";
    const std::size_t a = html.find(three), b = html.find(data);
    EXPECT_TRUE(a < b && b < html.size()) << path;
    if (b >= html.size()) return;
    own = html.substr(0, a) + html.substr(b);
    const std::size_t begin = b + data.size();
    scene = nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin), nullptr, false);
  }
  std::size_t frames() const { return scene["frames"]["count"]; }
  template <class T>
  std::vector<T> list(const char* name) const {
    return from_base64<T>(scene["frames"][name]);
  }
  std::size_t bodies() const {
    std::size_t n = 0;
    for (const auto& robot : scene["robots"]) n += scene["models"][robot["model"].get<std::size_t>()]["bodies"].size();
    return n;
  }
};

}  // namespace manycontact::cli
