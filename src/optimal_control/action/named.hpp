#pragma once
// The common part of the stacks of contacts, costs and constraints: parts by name.

#include <ostream>
#include <set>

#include "manycontact/action/state.hpp"

namespace manycontact::internal {

/// The part called `name`; throws when there is none.
template <class Map>
auto find_named(const char* who, const char* what, Map& parts, const std::string& name) {
  const auto it = parts.find(name);
  if (it != parts.end()) return it;
  std::string known;
  for (const auto& part : parts) known += (known.empty() ? "" : ", ") + part.first;
  throw std::invalid_argument(std::string(who) + ": no " + what + " is called \"" + name +
                              "\"; there are: " + (known.empty() ? "none" : known));
}

template <class Map>
void check_new(const char* who, const char* what, const Map& parts, const std::string& name) {
  require(!parts.contains(name), who,
          std::string(what[0] == 'i' ? "an " : "a ") + what + " called \"" + name +
              "\" is there already, a new name is expected");
}

/// A part fits a stack: it exists, and has the same state and number of controls.
template <class Part, class State>
void check_part(const char* who, const std::string& name, const std::shared_ptr<Part>& part,
                const std::shared_ptr<State>& state, std::size_t nu) {
  require(part != nullptr, who, "\"" + name + "\" is a null pointer, a model is expected");
  require(same_space(*part->get_state(), *state), who,
          "\"" + name + "\" belongs to another state, this one's is expected");
  require(part->get_nu() == nu, who,
          "\"" + name + "\" has nu = " + std::to_string(part->get_nu()) + ", " + std::to_string(nu) + " is expected");
}

/// The names of the active parts, and of the others, after this part was added or switched.
inline void sort_name(const std::string& name, bool is_active, std::set<std::string>& active,
                      std::set<std::string>& inactive) {
  (is_active ? inactive : active).erase(name);
  (is_active ? active : inactive).insert(name);
}

/// f(item, data of the part) for each part that keep(item): data are by name too.
template <class Map, class Data, class Keep, class F>
void for_each_part(const Map& parts, Data& data, Keep&& keep, F&& f) {
  auto d = data.begin();
  for (const auto& [name, item] : parts) {
    const auto& part = (d++)->second;
    if (keep(*item)) f(*item, part);
  }
}

/// "frame=left_sole, type=LOCAL"; "none" for an id that is none's.
inline void print_frame(std::ostream& os, const Multibody& model, FrameIndex id, ReferenceFrame type) {
  os << "frame=" << (id < model.frames.size() ? model.frames[id].name : "none") << ", type="
     << (type == LOCAL   ? "LOCAL"
         : type == WORLD ? "WORLD"
                         : "LOCAL_WORLD_ALIGNED");
}

/// "who:", then the active and the inactive parts: their names, and what text(os, item) writes.
template <class Map, class Text>
void print_parts(std::ostream& os, const char* who, const Map& parts, Text&& text) {
  os << who << ":\n";
  for (const bool active : {true, false}) {
    os << (active ? "  Active:\n" : "  Inactive:\n");
    for (const auto& [name, item] : parts) {
      if (item->active != active) continue;
      os << "    " << name << ": ";
      text(os, *item);
      os << "\n";
    }
  }
}

}  // namespace manycontact::internal
