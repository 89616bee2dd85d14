#pragma once
// What the stacks of contacts, costs and constraints have in common: parts by name.

#include "manycontact/action/fwd.hpp"

namespace manycontact::internal {

/// The part called `name`; throws when there is none.
template <class Map>
auto find_named(const char* who, const char* what, Map& parts, const std::string& name) {
  const auto it = parts.find(name);
  if (it != parts.end()) return it;
  std::string known;
  for (const auto& part : parts) known += (known.empty() ? "" : ", ") + part.first;
  throw std::invalid_argument(std::string(who) + ": no " + what + " is called \"" + name + "\"; there are: " +
                              (known.empty() ? "none" : known));
}

template <class Map>
void check_new(const char* who, const char* what, const Map& parts, const std::string& name) {
  require(!parts.contains(name), who, std::string("a ") + what + " called \"" + name + "\" is there already, a new name is expected");
}

/// A part fits a stack: it exists, and has the same state and number of controls.
template <class Part, class State>
void check_part(const char* who, const std::string& name, const std::shared_ptr<Part>& part,
                const std::shared_ptr<State>& state, std::size_t nu) {
  require(part != nullptr, who, "\"" + name + "\" is a null pointer, a model is expected");
  require(part->get_state() == state, who, "\"" + name + "\" belongs to another state, this one's is expected");
  require(part->get_nu() == nu, who, "\"" + name + "\" has nu = " + std::to_string(part->get_nu()) + ", " +
                                         std::to_string(nu) + " is expected");
}

}  // namespace manycontact::internal
