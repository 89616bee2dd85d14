#pragma once
// Functions for the stacks of named contacts, impulses, costs and constraints.

#include <ostream>

#include "manycontact/detail/action/named_parts.hpp"

namespace manycontact::internal {

/// Throws std::invalid_argument unless `part` exists and has the state and the number of controls of the stack.
template <class Part, class State>
void check_part(const char* who, const std::string& name, const std::shared_ptr<Part>& part,
                const std::shared_ptr<State>& state, std::size_t nu) {
  require(part != nullptr, who, "\"" + name + "\" is a null pointer, a model is expected");
  require(same_space(*part->get_state(), *state), who,
          "\"" + name + "\" belongs to another state, the state of the stack is expected");
  require(
      part->get_nu() == nu, who,
      "\"" + name + "\" has nu = " + std::to_string(part->get_nu()) + ", nu = " + std::to_string(nu) + " is expected");
}

/// Calls f(item, data of the item) for each item with keep(item). Items and data must be sorted by name.
template <class Map, class Data, class Keep, class F>
void for_each_part(const Map& parts, Data& data, Keep&& keep, F&& f) {
  auto d = data.begin();
  for (const auto& [name, item] : parts) {
    const auto& part = (d++)->second;
    if (keep(*item)) f(*item, part);
  }
}

/// Prints a frame as "frame=left_sole, type=LOCAL". The name is "none" if no frame has this id.
inline void print_frame(std::ostream& os, const Multibody& model, FrameIndex id, ReferenceFrame type) {
  os << "frame=" << (id < model.frames.size() ? model.frames[id].name : "none") << ", type="
     << (type == LOCAL   ? "LOCAL"
         : type == WORLD ? "WORLD"
                         : "LOCAL_WORLD_ALIGNED");
}

}  // namespace manycontact::internal

namespace manycontact {

template <class State, class Item>
NamedParts<State, Item>::NamedParts(const char* name, const char* what, std::shared_ptr<State> state, std::size_t nu)
    : name_(name),
      what_(what),
      state_(internal::given(name, state, "a state")),
      nu_(nu == kDefaultNu ? state->get_nv() : nu) {}

template <class State, class Item>
Item& NamedParts<State, Item>::part(const std::string& name) const {
  const auto it = parts_.find(name);
  if (it != parts_.end()) return *it->second;
  std::string known;
  for (const auto& part : parts_) known += (known.empty() ? "" : ", ") + part.first;
  throw std::invalid_argument(std::string(name_) + ": no " + what_ + " is called \"" + name +
                              "\"; the known names are: " + (known.empty() ? "none" : known));
}

template <class State, class Item>
void NamedParts<State, Item>::add(const Item& item) {
  require(!parts_.contains(item.name), name_,
          std::string(what_[0] == 'i' ? "an " : "a ") + what_ + " called \"" + item.name +
              "\" exists already, a new name is expected");
  parts_[item.name] = std::make_shared<Item>(item);
  (item.active ? active_set_ : inactive_set_).insert(item.name);
  ++version_;
  count();
}

template <class State, class Item>
void NamedParts<State, Item>::remove(std::string name) {
  (void)part(name);
  for (auto* names : {&active_set_, &inactive_set_}) names->erase(name);
  parts_.erase(name);
  ++version_;
  count();
}

template <class State, class Item>
bool NamedParts<State, Item>::change_status(const std::string& name, bool active) {
  Item& item = part(name);
  if (item.active == active) return false;
  item.active = active;
  (active ? inactive_set_ : active_set_).erase(name);
  (active ? active_set_ : inactive_set_).insert(name);
  count();
  return true;
}

template <class State, class Item>
void NamedParts<State, Item>::print(std::ostream& os) const {
  os << name_ << ":\n";
  for (const bool active : {true, false}) {
    os << (active ? "  Active:\n" : "  Inactive:\n");
    for (const auto& [name, item] : parts_)
      if (item->active == active) os << "    " << name << ": " << *item << "\n";
  }
}

}  // namespace manycontact
