#include <unordered_map>

#include "manycontact/detail/contact/reference.hpp"
#include "scene_parts.hpp"

namespace manycontact::io {
namespace {

struct ContactElement {  // The content of a <contact> element. Copies of the contact share the data in `contact`.
  Contact contact;
  SE3<double> A_offset, B_offset;  // B_offset is in world axes if there is no `to`
  EndPair ends;
  bool position_given = false, orientation_given = false;
};

class ContactReader {
 public:
  explicit ContactReader(SceneFile& out) : out_(out), references_(out.scene, out.q), ends_(out) {}

  void add(const Element& e) {
    const ContactElement c = read(e);
    ContactGroup group{c.contact.name, c.ends.A.copied, static_cast<int>(out_.scene.contacts.size()), 0, e.line()};
    add_name(e, "a contact", group.name, names_);
    for (int i = 0; i < c.ends.A.count; ++i)
      if (const std::optional<int> target = c.ends.target(i)) add_one(e, c, i, *target);
    group.count = static_cast<int>(out_.scene.contacts.size()) - group.first;
    out_.contact_groups.push_back(group);
  }

 private:
  // ---- reading a <contact> element

  ContactElement read(const Element& e) {
    e.allow({"name", "type", "frame", "reference_frame", "offset", "offset_quat_xyzw", "to", "to_offset",
             "to_offset_quat_xyzw", "xyz", "quat_xyzw", "axis", "gains", "active", "wrap", "mu", "normal", "box"});
    ContactElement c;
    c.contact.name = e.not_empty("name");
    c.contact.type = static_cast<ContactType>(e.choice("type", {"1d", "2d", "3d", "5d", "6d"}, -1));
    c.contact.reference_frame = read_reference_frame(e);
    c.contact.active = e.flag("active", true);
    if (const auto gains = e.numbers<2>("gains")) c.contact.alpha = (*gains)[0], c.contact.beta = (*gains)[1];
    read_axis(e, c.contact);
    if (e.has("mu")) c.contact.mu = e.required_number("mu");
    e.read("normal", c.contact.normal);
    (void)e.read("box", c.contact.box);
    c.ends = ends_.read_pair(e);
    (void)e.read("offset", c.A_offset.p);
    (void)read_quaternion(e, "offset_quat_xyzw", c.A_offset.R);
    read_target(e, c);
    return c;
  }

  static void read_axis(const Element& e, Contact& contact) {
    if (e.read("axis", contact.axis) && !has_axis(contact.type))
      e.where("axis").fail("a " + e.required("type") +
                           " contact has an axis, expected an axis with type 1d or 5d only");
  }

  void read_target(const Element& e, ContactElement& c) {
    const bool to_robot = c.ends.to_robot;
    for (const char* a : {"to_offset", "to_offset_quat_xyzw", "wrap"})
      if (!to_robot && e.has(a)) e.refuse(a, " needs a target, expected also a 'to' attribute");
    for (const char* a : {"xyz", "quat_xyzw"})
      if (to_robot && e.has(a)) e.refuse(a, " places a contact in the world, expected no attribute 'to', or to_offset");
    c.position_given = e.read(to_robot ? "to_offset" : "xyz", c.B_offset.p);
    c.orientation_given = read_quaternion(e, to_robot ? "to_offset_quat_xyzw" : "quat_xyzw", c.B_offset.R);
  }

  // ---- adding copy i of the contact

  // Returns the rotation in the world from the base of a robot's first copy to that of copy i.
  Mat3<double> turn_of_copy(const End& end, int i) const {
    const auto base = [&](int robot) -> const Mat3<double>& { return out_.scene.robots[robot].base.R; };
    return base(end.first + i) * base(end.first).transpose();
  }

  void add_one(const Element& e, const ContactElement& c, int i, int target) {
    Contact contact = c.contact;
    if (c.ends.A.copied) contact.name += std::to_string(i);
    contact.A = c.ends.A.on(c.ends.A.first + i, c.A_offset);
    contact.B.placement = c.B_offset;
    if (c.ends.to_robot)
      contact.B = c.ends.B.on(target, c.B_offset);
    else if (c.contact.normal)  // the normal is in world axes, and rotates with the copy's base
      contact.normal = turn_of_copy(c.ends.A, i) * *c.contact.normal;
    if (!c.position_given || !c.orientation_given)
      references_.resolve(!c.position_given, !c.orientation_given, contact);
    add_or_fail(e, [&] {
      const int number = add_contact(out_.scene, std::move(contact));
      if (!c.position_given || !c.orientation_given)
        out_.open_references.push_back({number, !c.position_given, !c.orientation_given});
    });
  }

  SceneFile& out_;
  ReferenceResolver references_;
  EndReader ends_;
  std::unordered_map<std::string, Where> names_;  // key: name of <contact>
};

}  // namespace

void add_contacts(const std::vector<Element>& elements, SceneFile& out) {
  ContactReader reader(out);
  for (const Element& e : elements) reader.add(e);
}

}  // namespace manycontact::io
