#include "../named.hpp"
#include "manycontact/action/contact.hpp"

namespace manycontact {

namespace {
constexpr const char* kContactModelMultiple = "ContactModelMultiple";
}

ContactModelMultiple::ContactModelMultiple(std::shared_ptr<StateMultibody> state, std::size_t nu)
    : state_(std::move(state)), nu_(nu) {
  require(state_ != nullptr, kContactModelMultiple, "a state is expected, not a null pointer");
}

ContactModelMultiple::ContactModelMultiple(std::shared_ptr<StateMultibody> state)
    : ContactModelMultiple(state, state ? state->get_nv() : 0) {}

void ContactModelMultiple::addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact,
                                      bool active) {
  internal::check_part(kContactModelMultiple, name, contact, state_, nu_);
  internal::check_new(kContactModelMultiple, "contact", contacts_, name);
  contacts_[name] = std::make_shared<ContactItem>(ContactItem{name, contact, active});
  ++version_;
  internal::sort_name(name, active, active_set_, inactive_set_);
  count();
}

void ContactModelMultiple::removeContact(const std::string& name) {
  contacts_.erase(internal::find_named(kContactModelMultiple, "contact", contacts_, name));
  ++version_;
  for (auto* names : {&active_set_, &inactive_set_}) names->erase(name);
  count();
}

void ContactModelMultiple::changeContactStatus(const std::string& name, bool active) {
  ContactItem& item = *internal::find_named(kContactModelMultiple, "contact", contacts_, name)->second;
  if (item.active == active) return;
  item.active = active;
  internal::sort_name(name, active, active_set_, inactive_set_);
  count();
}

void ContactModelMultiple::count() {
  nc_ = nc_total_ = 0;
  for (const auto& [name, item] : contacts_) {
    nc_total_ += item->contact->get_nc();
    if (item->active) nc_ += item->contact->get_nc();
  }
}

bool ContactModelMultiple::getContactStatus(const std::string& name) const {
  return internal::find_named(kContactModelMultiple, "contact", contacts_, name)->second->active;
}

void ContactModelMultiple::print(std::ostream& os) const {
  internal::print_parts(os, kContactModelMultiple, contacts_,
                        [](std::ostream& out, const ContactItem& item) { out << *item.contact; });
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
