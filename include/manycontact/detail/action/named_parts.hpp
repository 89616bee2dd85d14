#pragma once
// Stacks of parts with names: costs, constraints, contacts and impulses.

#include <map>
#include <set>

#include "manycontact/action/state.hpp"

namespace manycontact {

/// The common base of stacks of parts; each part can be switched off. Changes throw std::invalid_argument for a new
/// name that exists already, or for an unknown name.
template <class State, class Item>
class NamedParts : public Printable {
 public:
  const std::shared_ptr<State>& get_state() const { return state_; }               // the state of the parts
  std::size_t get_nu() const { return nu_; }                                       // number of controls
  const std::set<std::string>& get_active_set() const { return active_set_; }      // names of the active parts
  const std::set<std::string>& get_inactive_set() const { return inactive_set_; }  // names of the inactive parts
  std::size_t get_version() const { return version_; }  // changes if parts are added or removed
  void print(std::ostream& os) const override;          // prints the parts

 protected:
  using Container = std::map<std::string, std::shared_ptr<Item>>;
  /// name: the name of the class. what: the word for a part in messages. nu: number of controls, or kDefaultNu. Throws
  /// std::invalid_argument for a null pointer.
  NamedParts(const char* name, const char* what, std::shared_ptr<State> state, std::size_t nu);
  Item& part(const std::string& name) const;  // the part with this name
  /// Called after each change of the parts or their status.
  virtual void count() {}
  void add(const Item& item);                                // adds a part
  void remove(std::string name);                             // a copy of the name, which may be that of the part itself
  bool change_status(const std::string& name, bool active);  // returns whether the status has changed
  const char *name_, *what_;
  std::shared_ptr<State> state_;
  std::size_t nu_, version_ = 0;
  Container parts_;
  std::set<std::string> active_set_, inactive_set_;
};

}  // namespace manycontact
