#include "manycontact/action/contact.hpp"

#include <ostream>

#include "../named.hpp"
#include "../residuals/residual_parts.hpp"
#include "manycontact/action/impulse.hpp"

namespace manycontact {

namespace {

Attachment attachment(const StateMultibody& state, FrameIndex id, const SE3<double>& offset = {}) {
  const Multibody::BodyFrame& frame = internal::body_frame("ContactModel", state, id);
  return {frame.robot, frame.joint, frame.placement * offset};
}

const char* class_name(ContactType type) {
  constexpr const char* names[] = {"ContactModel1D", "ContactModel2D", "ContactModel3D", "ContactModel5D",
                                   "ContactModel6D"};
  return names[static_cast<int>(type)];
}

// Returns the number of the first frame on the attachment's body, or frames.size() if the body has no frame.
FrameIndex frame_on(const StateMultibody& state, const Attachment& at) {
  const auto& frames = state.get_model()->frames;
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (frames[k].robot == at.robot && frames[k].joint == at.joint) return k;
  return frames.size();
}

}  // namespace

ContactModelAbstract::ContactModelAbstract(std::shared_ptr<StateMultibody> state, ContactType type, FrameIndex id,
                                           ReferenceFrame frame, std::size_t nu, const Eigen::Vector2d& gains)
    : state_(internal::given(class_name(type), state, "a state")),
      id_(id),
      nu_(nu == kDefaultNu ? state_->get_nv() : nu) {
  contact_.type = type;
  contact_.reference_frame = frame;
  contact_.A = attachment(*state_, id);
  set_gains(gains);
}

ContactModelAbstract::ContactModelAbstract(std::shared_ptr<StateMultibody> state, const Contact& contact,
                                           std::size_t nu)
    : state_(internal::given(class_name(contact.type), state, "a state")),
      contact_(contact),
      gains_(contact.alpha, contact.beta),
      id_(0),
      nu_(nu == kDefaultNu ? state_->get_nv() : nu) {}

void ContactModelAbstract::set_gains(const Eigen::Vector2d& gains) {
  require(gains.allFinite(), "ContactModel::set_gains",
          "alpha = " + std::to_string(gains[0]) + " and beta = " + std::to_string(gains[1]) +
              " were given, finite numbers are expected");
  gains_ = gains;
  contact_.alpha = gains[0];
  contact_.beta = gains[1];
}

void ContactModelAbstract::keep_axis(const char* where, const Eigen::Vector3d& axis) {
  require(axis.allFinite() && axis.stableNorm() >= kZeroDirection, where,
          "an axis that is finite and not zero is expected");
  contact_.axis = axis.stableNormalized();
}

void ContactModelAbstract::set_id(FrameIndex id) {
  contact_.A = attachment(*state_, id);
  id_ = id;
}

void ContactModelAbstract::print(std::ostream& os) const {
  os << class_name(contact_.type) << " {";
  internal::print_frame(os, *state_->get_model(), id_, contact_.reference_frame);
  os << ", gains=[" << gains_[0] << ", " << gains_[1] << "]}";
}

ContactModel1D::ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, ReferenceFrame type,
                               const Eigen::Matrix3d& rotation, std::size_t nu, const Eigen::Vector2d& gains)
    : ContactModelAbstract(std::move(state), ContactType::k1D, id, type, nu, gains) {
  set_axis(rotation.row(2).transpose());
  set_reference(xref);
}

ContactModel1D::ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                               std::size_t nu, const Eigen::Vector2d& gains, Vector3MaskType mask, ReferenceFrame ref)
    : ContactModelAbstract(std::move(state), ContactType::k1D, id, ref, nu, gains) {
  set_axis(Eigen::Vector3d::Unit(static_cast<int>(mask)));
  set_reference(xref);
}

ContactModel2D::ContactModel2D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector2d& xref,
                               std::size_t nu, const Eigen::Vector2d& gains, ReferenceFrame type)
    : ContactModelAbstract(std::move(state), ContactType::k2D, id, type, nu, gains) {
  set_reference(xref);
}

ContactModel3D::ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                               ReferenceFrame type, std::size_t nu, const Eigen::Vector2d& gains)
    : ContactModelAbstract(std::move(state), ContactType::k3D, id, type, nu, gains) {
  set_reference(xref);
}

ContactModel6D::ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                               ReferenceFrame type, std::size_t nu, const Eigen::Vector2d& gains)
    : ContactModelAbstract(std::move(state), ContactType::k6D, id, type, nu, gains) {
  set_reference(pref);
}

ContactModel5D::ContactModel5D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                               const Eigen::Vector3d& axis, std::size_t nu, const Eigen::Vector2d& gains)
    : ContactModelAbstract(std::move(state), ContactType::k5D, id, LOCAL, nu, gains) {
  keep_axis("ContactModel5D", axis);
  set_reference(pref);
}

ContactModelBetweenBodies::ContactModelBetweenBodies(std::shared_ptr<StateMultibody> state, ContactType contact_type,
                                                     FrameIndex id, FrameIndex to, const SE3<double>& offset,
                                                     ReferenceFrame type, std::size_t nu, const Eigen::Vector2d& gains,
                                                     const Eigen::Vector3d& axis)
    : ContactModelAbstract(std::move(state), contact_type, id, type, nu, gains), to_(to) {
  set_offset(offset);
  require(contact_.A.robot != contact_.B.robot || contact_.A.joint != contact_.B.joint, "ContactModelBetweenBodies",
          "both frames are on the same body, two different bodies are expected");
  require(contact_type != ContactType::k5D || type == LOCAL, "ContactModelBetweenBodies",
          "the axis of a 5D contact is fixed in both bodies, LOCAL is expected");
  keep_axis("ContactModelBetweenBodies", axis);
}

void ContactModelBetweenBodies::set_offset(const SE3<double>& offset) {
  contact_.B = world_if_immovable(state_->get_model()->scene(), attachment(*state_, to_, offset));
  offset_ = offset;
}

ContactModelOfScene::ContactModelOfScene(std::shared_ptr<StateMultibody> state, const Contact& contact, std::size_t nu)
    : ContactModelAbstract(std::move(state), contact, nu) {
  const Scene& scene = state_->get_model()->scene();
  for (const Attachment* at : {&contact.A, &contact.B})
    require(at->robot < scene.nrobots() && (at->robot < 0 || at->joint < scene.robots[at->robot].model->njoints()),
            "ContactModelOfScene",
            "\"" + contact.name +
                "\" is on a body that the state does not have; the state of the contact's scene is "
                "expected");
  contact_.B = world_if_immovable(scene, contact.B);
  id_ = frame_on(*state_, contact.A);
}

// ---- stack of contacts

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

// ---- impulses, and stack of impulses

ImpulseModelAbstract::ImpulseModelAbstract(const char* name, std::shared_ptr<ContactModelAbstract> contact)
    : name_(name), contact_(std::move(contact)) {
  contact_->set_gains(Eigen::Vector2d::Zero());  // an impact has no error to correct
}

void ImpulseModelAbstract::print(std::ostream& os) const {
  os << name_ << " {";
  internal::print_frame(os, *get_state()->get_model(), get_id(), get_type());
  os << "}";
}

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
