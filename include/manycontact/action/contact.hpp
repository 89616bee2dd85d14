#pragma once
// Contacts by Crocoddyl's names and constructors, sobec's for 1D and 3D, and one between two bodies; and their stack.
// The equations are those of contact/rows.hpp, evaluated by the action model; here is only what a contact is.

#include <map>
#include <set>

#include "manycontact/action/state.hpp"
#include "manycontact/contact/rows.hpp"

namespace manycontact {

class MultibodyData;  // collector.hpp

/// [linear; angular], by Pinocchio's names.
struct SpatialForce : Vec6<double> {
  SpatialForce() : Vec6<double>(Vec6<double>::Zero()) {}
  using Vec6<double>::operator=;
  const Vec6<double>& toVector() const { return *this; }
  auto linear() const { return head<3>(); }
  auto angular() const { return tail<3>(); }
};

/// What a contact exerts on A at its origin, in the contact's reference frame: its nc numbers, and the whole wrench by
/// Pinocchio's names.
struct ContactForce : Eigen::VectorXd {
  using Eigen::VectorXd::VectorXd;
  using Eigen::VectorXd::operator=;
  Vec6<double> toVector() const;
  Vec3<double> linear() const { return toVector().head<3>(); }
  Vec3<double> angular() const { return toVector().tail<3>(); }
  ContactType type = ContactType::k6D;  // of the contact, as its axis
  Vec3<double> axis = Vec3<double>::UnitZ();
};

/// Numbers of one contact, filled by the action model, or by hand. The columns of Jc and da0_dx are those of the robots
/// of A and B' (all of x when there is one robot): `v_columns` says which of the nv each is; da0_dx has them twice, for
/// q and for v. Those of df_dx and df_du are the island's: `f_x_columns`, `f_u_columns`.
struct ContactDataAbstract {
  Eigen::MatrixXd Jc;      // nc x v_columns: by calc
  Eigen::VectorXd a0;      // nc: by calc
  Eigen::MatrixXd da0_dx;  // nc x 2 v_columns: by calcDiff; derivative of J a + a0 at the accelerations held constant
  ContactForce f;          // nc: by calc; zero when inactive. By hand: by updateForce
  // By calcDiff, when force derivatives are on: nc x f_x_columns, nc x f_u_columns.
  PanelView df_dx{nullptr, 0, 0, Eigen::OuterStride<>(0)};
  PanelView df_du{nullptr, 0, 0, Eigen::OuterStride<>(0)};
  std::vector<int> v_columns;
  const std::vector<int>* f_x_columns = nullptr;
  const std::vector<int>* f_u_columns = nullptr;
  FrameIndex frame = 0;
  int index = -1;  // in the scene of the action data
  bool active = true;
  const Contact* contact = nullptr;  // what it is; in that scene, or by hand here

  // By hand.
  MultibodyData* pinocchio = nullptr;
  SpatialForce fext;       // by updateForce: on A's body, in the frame of its joint
  Eigen::MatrixXd dv0_dq;  // nc x nv, of an impulse: by calcDiff, d(J v)/dq at v
  Contact own_contact;
  std::vector<int> own_x_columns, own_u_columns;
  RowMajorMatrix own_df_dx, own_df_du;  // by updateForceDiff

  ContactDataAbstract() = default;
  ContactDataAbstract(const ContactDataAbstract&) = delete;  // views into itself
};

/// What a contact is; the action model evaluates it, all contacts at once. There is nothing in it that a user's class
/// could put its own in the place of, so that classes below alone derive from it: another does not compile.
class ContactModelAbstract {
 public:
  virtual ~ContactModelAbstract() = default;

  /// By hand, at the motion of `data->pinocchio` (x is not read): Jc and a0, with J times its accelerations in a0; then
  /// da0_dx.
  void calc(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x) const;
  void calcDiff(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x) const;
  /// By hand: f = force (nc) and fext; df_dx (nc x ndx) and df_du (nc x nu). Throw std::invalid_argument on a wrong
  /// size.
  void updateForce(const std::shared_ptr<ContactDataAbstract>& data, const Eigen::VectorXd& force) const;
  void updateForceDiff(const std::shared_ptr<ContactDataAbstract>& data, const Eigen::MatrixXd& df_dx,
                       const Eigen::MatrixXd& df_du) const;
  void setZeroForce(const std::shared_ptr<ContactDataAbstract>& data) const;
  void setZeroForceDiff(const std::shared_ptr<ContactDataAbstract>& data) const;
  std::shared_ptr<ContactDataAbstract> createData(MultibodyData* data) const;

  const std::shared_ptr<StateMultibody>& get_state() const { return state_; }
  std::size_t get_nc() const { return static_cast<std::size_t>(contact_.rows()); }
  std::size_t get_nu() const { return nu_; }
  FrameIndex get_id() const { return id_; }
  ReferenceFrame get_type() const { return contact_.reference_frame; }
  const Eigen::Vector2d& get_gains() const { return gains_; }
  /// alpha [1/s^2], beta [1/s].
  void set_gains(const Eigen::Vector2d& gains);
  void set_id(FrameIndex id);
  void set_type(ReferenceFrame type) { contact_.reference_frame = type; }
  /// As the scene's equations need it.
  const Contact& get_contact() const { return contact_; }
  virtual void print(std::ostream& os) const;

 private:
  friend class ContactModel1D;
  friend class ContactModel2D;
  friend class ContactModel3D;
  friend class ContactModel6D;
  friend class ContactModel5D;
  friend class ContactModelBetweenBodies;
  friend class ContactModelOfScene;
  ContactModelAbstract(std::shared_ptr<StateMultibody> state, ContactType type, FrameIndex id, ReferenceFrame frame,
                       std::size_t nu, const Eigen::Vector2d& gains);
  ContactModelAbstract(std::shared_ptr<StateMultibody> state, const Contact& contact, std::size_t nu);
  void keep_axis(const char* where, const Eigen::Vector3d& axis);
  std::shared_ptr<StateMultibody> state_;
  Contact contact_;
  Eigen::Vector2d gains_;
  FrameIndex id_;
  std::size_t nu_;
};
std::ostream& operator<<(std::ostream& os, const ContactModelAbstract& model);

enum class Vector3MaskType { x = 0, y = 1, z = 2 };  // sobec's

/// One component of a point's position, along an axis of the reference frame.
class ContactModel1D final : public ContactModelAbstract {
 public:
  /// The component along rotation^T e_z, which stands at xref [m]. nu: of the action, default the state's nv.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, ReferenceFrame type,
                 const Eigen::Matrix3d& rotation, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  /// sobec's: a point xref [m, world], one axis of the reference frame.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), Vector3MaskType mask = Vector3MaskType::z,
                 ReferenceFrame ref = ReferenceFrame::kLocal);
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame ref = ReferenceFrame::kLocal);

  double get_reference() const { return contact_.axis.dot(contact_.B.placement.p); }
  void set_reference(double reference) { contact_.B.placement.p = reference * contact_.axis; }
  const Eigen::Vector3d& get_reference_point() const { return contact_.B.placement.p; }
  void set_reference(const Eigen::Vector3d& point) { contact_.B.placement.p = point; }
  const Eigen::Vector3d& get_axis() const { return contact_.axis; }
  void set_axis(const Eigen::Vector3d& axis);
};

/// The x and z components of a point's position. xref: (x, z) in the world; y = 0.
class ContactModel2D final : public ContactModelAbstract {
 public:
  ContactModel2D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector2d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal);
  ContactModel2D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector2d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  Eigen::Vector2d get_reference() const;
  void set_reference(const Eigen::Vector2d& reference);
};

/// A point's position. xref: world, m.
class ContactModel3D final : public ContactModelAbstract {
 public:
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, ReferenceFrame type,
                 std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  /// sobec's.
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal);
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal);
  const Eigen::Vector3d& get_reference() const { return contact_.B.placement.p; }
  void set_reference(const Eigen::Vector3d& reference) { contact_.B.placement.p = reference; }
};

/// A frame's placement. pref: in the world.
class ContactModel6D final : public ContactModelAbstract {
 public:
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, ReferenceFrame type,
                 std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  const SE3<double>& get_reference() const { return contact_.B.placement; }
  void set_reference(const SE3<double>& reference) { contact_.B.placement = reference; }
};

/// A frame that turns freely about one axis: a hinge, whose pin is fixed in A and in the world. Crocoddyl has none.
/// pref: in the world; axis: in both frames.
class ContactModel5D final : public ContactModelAbstract {
 public:
  ContactModel5D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                 const Eigen::Vector3d& axis, std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel5D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                 const Eigen::Vector3d& axis, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  const SE3<double>& get_reference() const { return contact_.B.placement; }
  void set_reference(const SE3<double>& reference) { contact_.B.placement = reference; }
  const Eigen::Vector3d& get_axis() const { return contact_.axis; }
};

/// A frame A held to a frame B' = `to` times `offset`, on another body of any robot.
class ContactModelBetweenBodies final : public ContactModelAbstract {
 public:
  ContactModelBetweenBodies(std::shared_ptr<StateMultibody> state, ContactType contact_type, FrameIndex id,
                            FrameIndex to, const SE3<double>& offset, ReferenceFrame type, std::size_t nu,
                            const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(),
                            const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ());
  FrameIndex get_to() const { return to_; }
  const SE3<double>& get_offset() const { return offset_; }
  void set_offset(const SE3<double>& offset);

 private:
  FrameIndex to_;
  SE3<double> offset_;
};

/// A contact as a scene file describes it: any attachment, offsets included.
class ContactModelOfScene final : public ContactModelAbstract {
 public:
  ContactModelOfScene(std::shared_ptr<StateMultibody> state, const Contact& contact, std::size_t nu);
};

struct ContactItem {  // a contact by its name, and whether it is active
  std::string name;
  std::shared_ptr<ContactModelAbstract> contact;
  bool active = true;
};

struct ContactDataMultiple {  // what the stack's contacts hold, by name
  std::map<std::string, std::shared_ptr<ContactDataAbstract>> contacts;

  // By hand: rows of the active contacts, in the order of names.
  Eigen::MatrixXd Jc, da0_dx;      // nc_total x nv, x ndx: by calc, calcDiff
  Eigen::VectorXd a0;              // nc_total: by calc
  Eigen::VectorXd dv;              // nv: by updateAcceleration
  Eigen::MatrixXd ddv_dx;          // nv x ndx: by updateAccelerationDiff
  std::vector<SpatialForce> fext;  // per joint, robot after robot: by updateForce; its contacts', in its frame
};

/// The contacts of an action model, by name; their rows stack in the order of names.
class ContactModelMultiple {
 public:
  using ContactModelContainer = std::map<std::string, std::shared_ptr<ContactItem>>;
  using ContactDataContainer = std::map<std::string, std::shared_ptr<ContactDataAbstract>>;

  ContactModelMultiple(std::shared_ptr<StateMultibody> state, std::size_t nu);
  explicit ContactModelMultiple(std::shared_ptr<StateMultibody> state);  // nu = nv

  /// Throw std::invalid_argument for a name that is taken (unknown), a contact of another state or nu.
  void addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact, bool active = true);
  void removeContact(const std::string& name);
  void changeContactStatus(const std::string& name, bool active);
  bool getContactStatus(const std::string& name) const;

  /// By hand, of the active contacts: as ContactModelAbstract's, and stacked.
  void calc(const std::shared_ptr<ContactDataMultiple>& data, const ConstVectorRef& x) const;
  void calcDiff(const std::shared_ptr<ContactDataMultiple>& data, const ConstVectorRef& x) const;
  /// force: nc; df_dx: nc x ndx; df_du: nc x nu. Inactive contacts get zero.
  void updateForce(const std::shared_ptr<ContactDataMultiple>& data, const Eigen::VectorXd& force) const;
  void updateForceDiff(const std::shared_ptr<ContactDataMultiple>& data, const Eigen::MatrixXd& df_dx,
                       const Eigen::MatrixXd& df_du) const;
  void updateAcceleration(const std::shared_ptr<ContactDataMultiple>& data, const Eigen::VectorXd& dv) const;
  void updateAccelerationDiff(const std::shared_ptr<ContactDataMultiple>& data, const Eigen::MatrixXd& ddv_dx) const;
  std::shared_ptr<ContactDataMultiple> createData(MultibodyData* data) const;

  const std::shared_ptr<StateMultibody>& get_state() const { return state_; }
  const ContactModelContainer& get_contacts() const { return contacts_; }
  std::size_t get_nc() const { return nc_; }              // rows of the active contacts
  std::size_t get_nc_total() const { return nc_total_; }  // rows of all
  std::size_t get_nu() const { return nu_; }
  const std::set<std::string>& get_active_set() const { return active_set_; }
  const std::set<std::string>& get_inactive_set() const { return inactive_set_; }
  std::size_t get_version() const { return version_; }  // of the set of contacts, not of their status
  void print(std::ostream& os) const;

 private:
  void count();
  std::shared_ptr<StateMultibody> state_;
  ContactModelContainer contacts_;
  std::size_t nc_ = 0, nc_total_ = 0, nu_, version_ = 0;
  std::set<std::string> active_set_, inactive_set_;
};
std::ostream& operator<<(std::ostream& os, const ContactModelMultiple& model);

/// All contacts of a scene (those of a scene file, say) by their names.
std::shared_ptr<ContactModelMultiple> contacts_of_scene(std::shared_ptr<StateMultibody> state, const Scene& scene,
                                                        std::size_t nu);

}  // namespace manycontact
