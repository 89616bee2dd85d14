#include <ostream>

#include "manycontact/action/contact.hpp"
#include "named.hpp"

namespace manycontact {

namespace {
constexpr const char* kWho = "ContactModelMultiple";
}

ContactModelMultiple::ContactModelMultiple(std::shared_ptr<StateMultibody> state, std::size_t nu)
    : state_(std::move(state)), nu_(nu) {
  require(state_ != nullptr, kWho, "a state is expected, not a null pointer");
}

ContactModelMultiple::ContactModelMultiple(std::shared_ptr<StateMultibody> state)
    : ContactModelMultiple(state, state ? state->get_nv() : 0) {}

void ContactModelMultiple::addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact,
                                      bool active) {
  internal::check_part(kWho, name, contact, state_, nu_);
  internal::check_new(kWho, "contact", contacts_, name);
  contacts_[name] = std::make_shared<ContactItem>(ContactItem{name, contact, active});
  nc_total_ += contact->get_nc();
  if (active) nc_ += contact->get_nc();
  (active ? active_set_ : inactive_set_).insert(name);
  ++version_;
}

void ContactModelMultiple::removeContact(const std::string& name) {
  const auto it = internal::find_named(kWho, "contact", contacts_, name);
  nc_total_ -= it->second->contact->get_nc();
  if (it->second->active) nc_ -= it->second->contact->get_nc();
  contacts_.erase(it);
  active_set_.erase(name);
  inactive_set_.erase(name);
  ++version_;
}

void ContactModelMultiple::changeContactStatus(const std::string& name, bool active) {
  ContactItem& item = *internal::find_named(kWho, "contact", contacts_, name)->second;
  if (item.active == active) return;
  item.active = active;
  nc_ = active ? nc_ + item.contact->get_nc() : nc_ - item.contact->get_nc();
  (active ? inactive_set_ : active_set_).erase(name);
  (active ? active_set_ : inactive_set_).insert(name);
}

bool ContactModelMultiple::getContactStatus(const std::string& name) const {
  return internal::find_named(kWho, "contact", contacts_, name)->second->active;
}

void ContactModelMultiple::print(std::ostream& os) const {
  os << "ContactModelMultiple:\n  Active:\n";
  for (const std::string& name : active_set_) os << "    " << name << ": " << *contacts_.at(name)->contact << "\n";
  os << "  Inactive:\n";
  for (const std::string& name : inactive_set_) os << "    " << name << ": " << *contacts_.at(name)->contact << "\n";
}

std::ostream& operator<<(std::ostream& os, const ContactModelMultiple& model) {
  model.print(os);
  return os;
}

std::shared_ptr<ContactModelMultiple> contacts_of_scene(std::shared_ptr<StateMultibody> state, const Scene& scene,
                                                        std::size_t nu) {
  auto out = std::make_shared<ContactModelMultiple>(state, nu);
  for (const Contact& contact : scene.contacts)
    out->addContact(contact.name, std::make_shared<ContactModelOfScene>(state, contact, nu), contact.active);
  return out;
}

}  // namespace manycontact
