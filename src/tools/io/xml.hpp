#pragma once
// Classes for XML files and their elements with line numbers. No other header uses the types of tinyxml2.

#include <tinyxml2.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "text.hpp"

namespace manycontact::io {

class Element {  // A view of one XML element. Its XmlFile must outlive it.
 public:
  Element(const std::string& file, const tinyxml2::XMLElement& element) : file_(&file), element_(&element) {}

  std::string name() const { return element_->Name(); }
  int line() const { return element_->GetLineNum(); }
  Where where() const { return {file_, line()}; }
  /// Returns the line of an attribute (an element may span several lines), or the element's line if it is missing.
  Where where(const char* attribute) const;
  [[noreturn]] void fail(const std::string& message) const { where().fail(message); }

  /// Throws InputError for the value of an attribute, at its line, with the message label(attribute) + what.
  [[noreturn]] void refuse(const char* attribute, const std::string& what) const {
    where(attribute).fail(label(attribute) + what);
  }

  /// Throws InputError for attributes that are not in `known`. (tinyxml2 refuses duplicates.)
  void allow_attributes(std::initializer_list<const char*> known) const;
  /// Throws InputError for text inside the element, and for children whose names are not in `known`.
  void allow_children(std::initializer_list<const char*> known) const;

  void allow(std::initializer_list<const char*> attributes, std::initializer_list<const char*> children = {}) const {
    allow_attributes(attributes);
    allow_children(children);
  }

  bool has(const char* attribute) const { return element_->Attribute(attribute) != nullptr; }
  std::vector<std::string> attributes() const;
  std::string required(const char* attribute) const;  // throws InputError if it is missing
  /// Returns the text of an attribute. Throws InputError if it is missing or empty. what: expected content.
  std::string not_empty(const char* attribute, const char* what = "a name") const;
  std::string optional(const char* attribute, const std::string& otherwise) const;
  /// Returns the index of an attribute's text among `choices`, or `otherwise` if it is missing (-1: throws InputError).
  int choice(const char* attribute, std::initializer_list<const char*> choices, int otherwise) const;
  bool flag(const char* attribute, bool otherwise) const {
    return choice(attribute, {"false", "true"}, otherwise) == 1;
  }
  double number(const char* attribute, double otherwise) const;
  double number_from_0(const char* attribute, double otherwise) const;
  /// Returns a number above 0. The attribute is required unless `otherwise` is given. what: expected content.
  double positive(const char* attribute, std::optional<double> otherwise = {}, const char* what = "a number") const;
  int count(const char* attribute, int least, int most) const;  // a required whole number from `least` to `most`
  double required_number(const char* attribute) const;
  /// Returns a number or an infinity ("-Inf", "1e999"), as limits may have, or `otherwise` if the attribute is missing.
  double number_or_infinity(const char* attribute, double otherwise) const;
  /// Returns exactly n numbers, or nullopt if the attribute is missing.
  template <std::size_t n>
  std::optional<std::array<double, n>> numbers(const char* attribute) const {
    if (!has(attribute)) return {};
    const auto list = parse_numbers(where(attribute), label(attribute), required(attribute), n);
    std::array<double, n> out{};
    std::copy(list.begin(), list.end(), out.begin());
    return out;
  }
  /// Reads the numbers of an attribute into `out`. Returns false and leaves `out` as it is if the attribute is missing.
  template <int n>
  bool read(const char* attribute, Eigen::Matrix<double, n, 1>& out) const {
    const auto list = numbers<static_cast<std::size_t>(n)>(attribute);
    if (list) out = Eigen::Matrix<double, n, 1>(list->data());
    return list.has_value();
  }
  template <int n>
  void read(const char* attribute, std::optional<Eigen::Matrix<double, n, 1>>& out) const {
    if (has(attribute)) (void)read(attribute, out.emplace(Eigen::Matrix<double, n, 1>::Zero()));
  }
  std::string text() const;  // text inside the element without comments; throws InputError if there are elements inside

  /// child returns the first child element called `name`, and children all of them. nullptr means any name.
  std::optional<Element> child(const char* name = nullptr) const;
  std::vector<Element> children(const char* name = nullptr) const;

  std::string label(const char* attribute) const;  // returns "attribute of <name>" for messages

 private:
  const std::string* file_;
  const tinyxml2::XMLElement* element_;
};

class XmlFile {
 public:
  /// Parses bytes in an encoding of decode_xml. Throws InputError for a syntax error or another root than root_name.
  XmlFile(std::string path, const std::string& bytes, const char* root_name);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  const std::string& path() const { return path_; }
  Element root() const { return {path_, *document_.RootElement()}; }
  tinyxml2::XMLDocument& document() { return document_; }

 private:
  std::string path_;
  tinyxml2::XMLDocument document_;
};

}  // namespace manycontact::io
