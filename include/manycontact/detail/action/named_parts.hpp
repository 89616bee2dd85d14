#pragma once
// Stacks of parts with names.

#include <map>
#include <set>

#include "manycontact/action/state.hpp"

namespace manycontact {

/// The common base of stacks of costs, constraints, contacts and impulses, which can be switched off. Changes throw
/// std::invalid_argument for a name that exists already (or does not exist).
template <class State, class Item>
class NamedParts : public Printable {
 public:
  const std::shared_ptr<State>& get_state() const { return state_; }               // the state that it was made for
  std::size_t get_nu() const { return nu_; }                                       // number of controls
  const std::set<std::string>& get_active_set() const { return active_set_; }      // names of the active ones
  const std::set<std::string>& get_inactive_set() const { return inactive_set_; }  // names of the inactive ones
  std::size_t get_version() const { return version_; }  // changes with the set of parts, not with their status
  void print(std::ostream& os) const override;          // prints the parts

 protected:
  using Container = std::map<std::string, std::shared_ptr<Item>>;
  /// name: that of the class. what: that of a part. nu: number of controls, or kDefaultNu. Throws
  /// std::invalid_argument for a null pointer.
  NamedParts(const char* name, const char* what, std::shared_ptr<State> state, std::size_t nu);
  Item& part(const std::string& name) const;  // the part with this name
  /// Called after each change of the parts or their status.
  virtual void count() {}
  void add(const Item& item);                                // adds a part
  void remove(std::string name);                             // a copy, since the name may be that of the part itself
  bool change_status(const std::string& name, bool active);  // whether the status has changed
  const char *name_, *what_;
  std::shared_ptr<State> state_;
  std::size_t nu_, version_ = 0;
  Container parts_;
  std::set<std::string> active_set_, inactive_set_;
};

}  // namespace manycontact
