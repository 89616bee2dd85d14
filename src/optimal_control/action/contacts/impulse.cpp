#include "manycontact/action/impulse.hpp"

#include "../named.hpp"

namespace manycontact {

ImpulseModelAbstract::ImpulseModelAbstract(const char* name, std::shared_ptr<ContactModelAbstract> contact)
    : name_(name), contact_(std::move(contact)) {
  contact_->set_gains(Eigen::Vector2d::Zero());  // an impact has no error to correct
}

void ImpulseModelAbstract::print(std::ostream& os) const {
  os << name_ << " {";
  internal::print_frame(os, *get_state()->get_model(), get_id(), get_type());
  os << "}";
}

ImpulseModel3D::ImpulseModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, ReferenceFrame type)
    : ImpulseModelAbstract(
          "ImpulseModel3D",
          std::make_shared<ContactModel3D>(std::move(state), id, Eigen::Vector3d(Eigen::Vector3d::Zero()), type)) {}

ImpulseModel6D::ImpulseModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, ReferenceFrame type)
    : ImpulseModelAbstract("ImpulseModel6D",
                           std::make_shared<ContactModel6D>(std::move(state), id, SE3<double>{}, type)) {}

ImpulseModelBetweenBodies::ImpulseModelBetweenBodies(std::shared_ptr<StateMultibody> state, ContactType contact_type,
                                                     FrameIndex id, FrameIndex to, const SE3<double>& offset,
                                                     ReferenceFrame type, const Eigen::Vector3d& axis)
    : ImpulseModelAbstract(
          "ImpulseModelBetweenBodies",
          std::make_shared<ContactModelBetweenBodies>(std::move(state), contact_type, id, to, offset, type, kDefaultNu,
                                                      Eigen::Vector2d(Eigen::Vector2d::Zero()), axis)) {}

ImpulseModelOfScene::ImpulseModelOfScene(std::shared_ptr<StateMultibody> state, const Contact& contact)
    : ImpulseModelAbstract("ImpulseModelOfScene",
                           std::make_shared<ContactModelOfScene>(std::move(state), contact, kDefaultNu)) {}

static std::ostream& operator<<(std::ostream& os, const ImpulseItem& item) { return os << *item.impulse; }

template class NamedParts<StateMultibody, ImpulseItem>;

ImpulseModelMultiple::ImpulseModelMultiple(std::shared_ptr<StateMultibody> state)
    : NamedParts("ImpulseModelMultiple", "impulse", state, 0),
      contacts_(std::make_shared<ContactModelMultiple>(state)) {}

void ImpulseModelMultiple::addImpulse(const std::string& name, std::shared_ptr<ImpulseModelAbstract> impulse,
                                      bool active) {
  internal::check_part(name_, name, impulse, state_, nu_);
  add({name, impulse, active});
  contacts_->addContact(name, impulse->get_contact(), active);
}

void ImpulseModelMultiple::removeImpulse(const std::string& name) {
  remove(name);
  contacts_->removeContact(name);
}

void ImpulseModelMultiple::changeImpulseStatus(const std::string& name, bool active) {
  change_status(name, active);
  contacts_->changeContactStatus(name, active);
}

}  // namespace manycontact
