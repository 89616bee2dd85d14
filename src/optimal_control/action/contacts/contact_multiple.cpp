#include "../named.hpp"
#include "manycontact/action/contact.hpp"

namespace manycontact {

static std::ostream& operator<<(std::ostream& os, const ContactItem& item) { return os << *item.contact; }

template class NamedParts<StateMultibody, ContactItem>;

ContactModelMultiple::ContactModelMultiple(std::shared_ptr<StateMultibody> state, std::size_t nu)
    : NamedParts("ContactModelMultiple", "contact", std::move(state), nu) {}

void ContactModelMultiple::addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact,
                                      bool active) {
  internal::check_part(name_, name, contact, state_, nu_);
  add({name, contact, active});
}

void ContactModelMultiple::count() {
  nc_ = nc_total_ = 0;
  for (const auto& [name, item] : parts_) {
    nc_total_ += item->contact->get_nc();
    if (item->active) nc_ += item->contact->get_nc();
  }
}

std::shared_ptr<ContactModelMultiple> contacts_of_scene(std::shared_ptr<StateMultibody> state, const Scene& scene,
                                                        std::size_t nu) {
  auto out = std::make_shared<ContactModelMultiple>(state, nu);
  for (const Contact& contact : scene.contacts)
    out->addContact(contact.name, std::make_shared<ContactModelOfScene>(state, contact, nu), contact.active);
  return out;
}

}  // namespace manycontact
