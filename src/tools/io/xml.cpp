#include "xml.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>
#include <utility>

namespace manycontact::io {

Where Element::where(const char* attribute) const {
  const tinyxml2::XMLAttribute* a = element_->FindAttribute(attribute);
  return {file_, a ? a->GetLineNum() : line()};
}

std::string Element::label(const char* attribute) const { return std::string(attribute) + " of <" + name() + ">"; }

namespace {

bool among(const char* name, std::initializer_list<const char*> known) {
  return std::ranges::any_of(known, [&](const char* k) { return std::strcmp(k, name) == 0; });
}

// Attributes of scene and task files, and names of the same attributes in other formats, for hints in error messages.
constexpr std::pair<const char*, const char*> kTheirs[] = {{"mu", " friction friction_coefficient "},
                                                           {"frame", " link body frame1 parent "},
                                                           {"to", " frame2 body2 child target "},
                                                           {"xyz", " pos position translation origin "},
                                                           {"quat_xyzw", " rotation orientation quaternion "},
                                                           {"rpy", " rotation euler "},
                                                           {"urdf", " file model filename "},
                                                           {"copies", " count number "},
                                                           {"q", " position "},
                                                           {"v", " velocity "},
                                                           {"u", " torque effort tau "},
                                                           {"armature", " rotor_inertia "},
                                                           {"gains", " kp kd stabilization "},
                                                           {"box", " size "},
                                                           {"active", " enabled "},
                                                           {"step", " dt timestep "},
                                                           {"nodes", " knots "},
                                                           {"reference", " ref target goal "},
                                                           {"lower", " min "},
                                                           {"upper", " max "},
                                                           {"iterations", " maxiter "},
                                                           {"tolerance", " tol "}};

// Returns the known attribute that `name` means, or null. `name` is its name in another format, or its beginning.
const char* meant(const std::string& name, std::initializer_list<const char*> known) {
  for (const auto& [ours, theirs] : kTheirs)
    if (std::string_view(theirs).find(" " + name + " ") != std::string_view::npos && among(ours, known)) return ours;
  constexpr std::size_t kLeast = 3;  // fewest letters of `name` that count as a beginning
  for (const char* k : known)
    if (name.size() >= kLeast && std::string_view(k).starts_with(name)) return k;
  return nullptr;
}

std::string expected(const char* name, std::initializer_list<const char*> known) {
  if (known.size() == 0) return "expected none";
  if (const char* ours = meant(name, known)) return "did you mean " + quote(ours) + "?";
  return suggestion(name, {known.begin(), known.end()});
}

// Returns "mismatched element" for "XML_ERROR_MISMATCHED_ELEMENT".
std::string plain_words(std::string error) {
  if (error == "XML_ERROR_PARSING_ATTRIBUTE") return "an attribute that is malformed or given twice";
  if (error.rfind("XML_", 0) == 0) error.erase(0, 4);
  if (error.rfind("ERROR_", 0) == 0) error.erase(0, 6);
  for (char& c : error) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return error;
}

}  // namespace

void Element::allow_attributes(std::initializer_list<const char*> known) const {
  for (const auto* a = element_->FirstAttribute(); a; a = a->Next())
    if (!among(a->Name(), known))
      Where{file_, a->GetLineNum()}.fail("<" + name() + "> has an unknown attribute " + quote(a->Name()) + ", " +
                                         expected(a->Name(), known));
}

void Element::allow_children(std::initializer_list<const char*> known) const {
  for (const auto* node = element_->FirstChild(); node; node = node->NextSibling()) {
    const Where here{file_, node->GetLineNum()};
    if (const auto* e = node->ToElement()) {
      if (!among(e->Name(), known))
        here.fail("<" + name() + "> contains an unknown element <" + e->Name() + ">, " + expected(e->Name(), known));
    } else if (node->ToText() && !words(node->Value()).empty()) {
      here.fail("<" + name() + "> contains the text " + quote(node->Value()) + ", expected elements only");
    }
  }
}

std::vector<std::string> Element::attributes() const {
  std::vector<std::string> names;
  for (const auto* a = element_->FirstAttribute(); a; a = a->Next()) names.emplace_back(a->Name());
  return names;
}

std::string Element::required(const char* attribute) const {
  const char* text = element_->Attribute(attribute);
  if (!text) fail("<" + name() + "> has no attribute '" + attribute + "', expected one");
  return text;
}

std::string Element::not_empty(const char* attribute, const char* what) const {
  std::string text = required(attribute);
  if (text.empty()) refuse(attribute, std::string(" is empty, expected ") + what);
  return text;
}

std::string Element::optional(const char* attribute, const std::string& otherwise) const {
  const char* text = element_->Attribute(attribute);
  return text ? text : otherwise;
}

int Element::choice(const char* attribute, std::initializer_list<const char*> choices, int otherwise) const {
  if (!has(attribute) && otherwise >= 0) return otherwise;
  const std::string text = required(attribute);
  int i = 0;
  for (const char* c : choices) {
    if (text == c) return i;
    ++i;
  }
  where(attribute).fail(label(attribute) + " is " + quote(text) + ", " + expected(text.c_str(), choices));
}

double Element::number(const char* attribute, double otherwise) const {
  return has(attribute) ? required_number(attribute) : otherwise;
}

double Element::required_number(const char* attribute) const {
  const std::string text = required(attribute);
  return parse_number(where(attribute), label(attribute), text);
}

double Element::number_from_0(const char* attribute, double otherwise) const {
  const double x = number(attribute, otherwise);
  if (x < 0) refuse(attribute, " is " + show(x) + ", expected 0 or more");
  return x;
}

double Element::positive(const char* attribute, std::optional<double> otherwise, const char* what) const {
  const double x = otherwise ? number(attribute, *otherwise) : required_number(attribute);
  if (!(x > 0)) refuse(attribute, " is " + show(x) + ", expected " + what + " above 0");
  return x;
}

int Element::count(const char* attribute, int least, int most) const {
  const std::string text = required(attribute);
  const int n = parse_count(text);
  if (n < least || n > most)
    refuse(attribute, " is " + quote(text) + ", expected a whole number from " + std::to_string(least) + " to " +
                          std::to_string(most));
  return n;
}

double Element::number_or_infinity(const char* attribute, double otherwise) const {
  return has(attribute) ? parse_number_or_infinity(where(attribute), label(attribute), required(attribute)) : otherwise;
}

std::string Element::text() const {
  std::string all;
  for (const auto* node = element_->FirstChild(); node; node = node->NextSibling()) {
    if (node->ToElement())
      Where{file_, node->GetLineNum()}.fail("<" + name() + "> contains an element <" + node->Value() +
                                            ">, expected numbers");
    if (node->ToText()) all += std::string(all.empty() ? "" : " ") + node->Value();
  }
  return all;
}

std::optional<Element> Element::child(const char* name) const {
  const auto* e = element_->FirstChildElement(name);
  return e ? std::optional<Element>(Element(*file_, *e)) : std::nullopt;
}

std::vector<Element> Element::children(const char* name) const {
  std::vector<Element> out;
  for (const auto* e = element_->FirstChildElement(name); e; e = e->NextSiblingElement(name))
    out.emplace_back(*file_, *e);
  return out;
}

XmlFile::XmlFile(std::string path, const std::string& bytes, const char* root_name) : path_(std::move(path)) {
  const std::string text = decode_xml(path_, bytes);
  const std::string wanted = std::string("expected XML with one root element <") + root_name + ">";
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    throw InputError(path_, static_cast<int>(line), "contains a zero byte, expected UTF-8 text");
  }
  if (words(text).empty()) throw InputError(path_, 1, "is empty, " + wanted);
  document_.Parse(text.data(), text.size());
  if (document_.Error())
    throw InputError(path_, document_.ErrorLineNum(),
                     "is not XML: " + plain_words(document_.ErrorName()) + ", " + wanted);
  const tinyxml2::XMLElement* root = document_.RootElement();
  if (!root) throw InputError(path_, 1, "has no element, " + wanted);
  if (std::strcmp(root->Name(), root_name) != 0)
    throw InputError(path_, root->GetLineNum(), "has the root element <" + std::string(root->Name()) + ">, " + wanted);
  for (const auto* node = document_.FirstChild(); node; node = node->NextSibling())
    if (node->ToElement() && node != root)
      throw InputError(path_, node->GetLineNum(), "continues outside <" + std::string(root_name) + ">, " + wanted);
}

}  // namespace manycontact::io
