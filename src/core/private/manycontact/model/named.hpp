#pragma once
// Tables of enumerators and their names.

#include <cstddef>
#include <optional>
#include <string>

namespace manycontact {

template <class T>
struct Named {
  T value;
  const char* name;
};

template <class T, std::size_t N>
std::string name_of(const Named<T> (&all)[N], T value) {
  for (const auto& [each, name] : all)
    if (each == value) return name;
  return "?";
}

template <class T, std::size_t N>
std::optional<T> called(const Named<T> (&all)[N], const std::string& wanted) {
  for (const auto& [each, name] : all)
    if (name == wanted) return each;
  return std::nullopt;
}

}  // namespace manycontact
