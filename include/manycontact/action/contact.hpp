#pragma once
// Contacts with Crocoddyl's names and constructors (also sobec's for 1D and 3D), contacts between two bodies, and
// stacks of contacts. A contact constrains a frame A (number `id`) to a frame B' of the world or of another body
// (detail/contact/rows.hpp). The number of controls nu is by default nv. Constructors throw std::invalid_argument for
// wrong arguments.

#include "manycontact/detail/action/named_parts.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

class MultibodyData;  // defined in detail/action/collector.hpp

/// A force [linear; angular] with Pinocchio's member names.
struct SpatialForce : Vec6<double> {
  SpatialForce() : Vec6<double>(Vec6<double>::Zero()) {}
  using Vec6<double>::operator=;
  const Vec6<double>& toVector() const { return *this; }  // [linear; angular]
  auto linear() const { return head<3>(); }               // the force
  auto angular() const { return tail<3>(); }              // the moment
};

/// The force on A at A's origin, in the contact's reference frame. The vector has the nc constrained components; the
/// functions with Pinocchio's names return the whole wrench.
struct ContactForce : Eigen::VectorXd {
  using Eigen::VectorXd::VectorXd;
  using Eigen::VectorXd::operator=;
  Vec6<double> toVector() const;                                 // the whole wrench [linear; angular]
  Vec3<double> linear() const { return toVector().head<3>(); }   // the force
  Vec3<double> angular() const { return toVector().tail<3>(); }  // the moment
  ContactType type = ContactType::k6D;
  Vec3<double> axis = Vec3<double>::UnitZ();
};

/// The values of one contact: Jacobian Jc, bias a0, force f, derivatives. `v_columns` are the indices in v of Jc's
/// columns: the velocities of the robots of A and B'. The matrix da0_dx has these columns twice, for q and for v. The
/// columns of df_dx and df_du are coordinates of the contact's island: `f_x_columns`, `f_u_columns`.
struct ContactDataAbstract {
  Eigen::MatrixXd Jc;      // nc x v_columns: set by calc
  Eigen::VectorXd a0;      // nc: set by calc
  Eigen::MatrixXd da0_dx;  // nc x 2 v_columns: set by calcDiff; derivative of J a + a0 at constant accelerations
  ContactForce f;          // nc: set by the action's calc, or standalone by updateForce; zero if inactive
  // Set by calcDiff if derivatives of forces are enabled: nc x f_x_columns, nc x f_u_columns.
  PanelView df_dx{nullptr, 0, 0, Eigen::OuterStride<>(0)};
  PanelView df_du{nullptr, 0, 0, Eigen::OuterStride<>(0)};
  std::vector<int> v_columns;
  const std::vector<int>* f_x_columns = nullptr;
  const std::vector<int>* f_u_columns = nullptr;
  FrameIndex frame = 0;
  int index = -1;  // number of the contact in the scene of the action's data
  bool active = true;
  const Contact* contact = nullptr;  // entry of the action's scene; own_contact in standalone evaluation

  // Members for standalone evaluation.
  MultibodyData* pinocchio = nullptr;
  SpatialForce fext;       // set by updateForce: force on A's body, in the frame of the body's joint
  Eigen::MatrixXd dv0_dq;  // nc x nv, of an impulse: set by calcDiff, d(J v)/dq at v
  Contact own_contact;
  std::vector<int> own_x_columns, own_u_columns;
  RowMajorMatrix own_df_dx, own_df_du;  // set by updateForceDiff

  ContactDataAbstract() = default;
  ContactDataAbstract(const ContactDataAbstract&) = delete;  // views point into the object
};

/// Crocoddyl's base class of the data of contacts and impulses.
using ForceDataAbstract = ContactDataAbstract;

/// A contact. Users cannot derive from this class, because action models do not call its calc and calcDiff.
class ContactModelAbstract : public Printable {
 public:
  using DataPtr = std::shared_ptr<ContactDataAbstract>;

  /// For standalone evaluation, without an action model, at the motion in `data->pinocchio`; x is ignored. calc
  /// computes Jc, and sets a0 to the bias plus Jc times the accelerations. calcDiff computes da0_dx.
  void calc(const DataPtr& data, const ConstVectorRef& x) const;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) const;
  /// For standalone evaluation: set f (nc) and fext, or df_dx (nc x ndx) and df_du (nc x nu). Wrong sizes throw
  /// std::invalid_argument.
  void updateForce(const DataPtr& data, const Eigen::VectorXd& force) const;
  void updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx, const Eigen::MatrixXd& df_du) const;
  void setZeroForce(const DataPtr& data) const;
  void setZeroForceDiff(const DataPtr& data) const;
  std::shared_ptr<ContactDataAbstract> createData(MultibodyData* data) const;

  const std::shared_ptr<StateMultibody>& get_state() const { return state_; }       // state given to the constructor
  std::size_t get_nc() const { return static_cast<std::size_t>(contact_.rows()); }  // number of constraint rows
  std::size_t get_nu() const { return nu_; }                                        // number of controls
  FrameIndex get_id() const { return id_; }                                         // number of the frame
  ReferenceFrame get_type() const { return contact_.reference_frame; }              // the reference frame
  const Eigen::Vector2d& get_gains() const { return gains_; }                       // alpha [1/s^2], beta [1/s]
  /// Sets the stabilisation gains alpha [1/s^2], beta [1/s].
  void set_gains(const Eigen::Vector2d& gains);
  void set_id(FrameIndex id);                                              // selects another frame
  void set_type(ReferenceFrame type) { contact_.reference_frame = type; }  // selects another reference frame
  const Contact& get_contact() const { return contact_; }                  // the contact in the form of a scene
  void print(std::ostream& os) const override;                             // prints type and sizes

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

/// An axis of the reference frame.
enum class Vector3MaskType { x = 0, y = 1, z = 2 };

/// Constrains one component of a point's position, along an axis of the reference frame.
class ContactModel1D final : public ContactModelAbstract {
 public:
  /// Requires the position along the axis rotation^T e_z (in `type`) to be xref [m]. nu: number of controls.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, ReferenceFrame type,
                 const Eigen::Matrix3d& rotation, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  /// Uses the z axis of the reference frame, and nu = nv.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel1D(std::move(state), id, xref, type, Eigen::Matrix3d::Identity(), kDefaultNu, gains) {}
  /// Uses the z axis of the frame A.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, double xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel1D(std::move(state), id, xref, LOCAL, Eigen::Matrix3d::Identity(), nu, gains) {}

  /// Sobec's constructor: fixes the point at xref [m] in the world, along one axis (mask) of the reference frame.
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), Vector3MaskType mask = Vector3MaskType::z,
                 ReferenceFrame ref = ReferenceFrame::kLocal);
  ContactModel1D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame ref = ReferenceFrame::kLocal)
      : ContactModel1D(std::move(state), id, xref, kDefaultNu, gains, Vector3MaskType::z, ref) {}

  /// Get and set the reference: the component along the axis [m], or the point xref in the world [m].
  double get_reference() const { return contact_.axis.dot(contact_.B.placement.p); }
  void set_reference(double reference) { contact_.B.placement.p = reference * contact_.axis; }
  const Eigen::Vector3d& get_reference_point() const { return contact_.B.placement.p; }
  void set_reference(const Eigen::Vector3d& point) { contact_.B.placement.p = point; }

  const Eigen::Vector3d& get_axis() const { return contact_.axis; }  // unit vector
  /// Throws std::invalid_argument for an axis without direction.
  void set_axis(const Eigen::Vector3d& axis) { keep_axis("ContactModel1D::set_axis", axis); }
};

/// Constrains the x and z components of a point's position. xref: the position (x, z) in the world [m].
class ContactModel2D final : public ContactModelAbstract {
 public:
  /// nu: number of controls of the action.
  ContactModel2D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector2d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal);
  ContactModel2D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector2d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel2D(std::move(state), id, xref, kDefaultNu, gains) {}  // with nu = nv
  /// Returns the point's position (x, z) in the world [m].
  Eigen::Vector2d get_reference() const { return {contact_.B.placement.p.x(), contact_.B.placement.p.z()}; }
  /// Sets the point's position (x, z) in the world [m].
  void set_reference(const Eigen::Vector2d& r) { contact_.B.placement.p = Eigen::Vector3d(r.x(), 0, r.y()); }
};

/// Constrains a point's position. xref: the position in the world [m].
class ContactModel3D final : public ContactModelAbstract {
 public:
  /// nu: number of controls of the action. In sobec's constructors the reference frame is the last argument.
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, ReferenceFrame type,
                 std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel3D(std::move(state), id, xref, type, kDefaultNu, gains) {}  // with nu = nv
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal)
      : ContactModel3D(std::move(state), id, xref, type, nu, gains) {}  // sobec's
  ContactModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(), ReferenceFrame type = ReferenceFrame::kLocal)
      : ContactModel3D(std::move(state), id, xref, type, kDefaultNu, gains) {}  // sobec's, with nu = nv
  /// Returns the point's position in the world [m].
  const Eigen::Vector3d& get_reference() const { return contact_.B.placement.p; }
  void set_reference(const Eigen::Vector3d& reference) { contact_.B.placement.p = reference; }  // sets the position
};

/// Constrains a frame's placement. pref: the placement in the world.
class ContactModel6D final : public ContactModelAbstract {
 public:
  /// nu: number of controls of the action. The reference frame `type` is by default the frame A.
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, ReferenceFrame type,
                 std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, ReferenceFrame type,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel6D(std::move(state), id, pref, type, kDefaultNu, gains) {}  // with nu = nv
  ContactModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref, std::size_t nu,
                 const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel6D(std::move(state), id, pref, LOCAL, nu, gains) {}                   // in the axes of A
  const SE3<double>& get_reference() const { return contact_.B.placement; }               // placement in the world
  void set_reference(const SE3<double>& reference) { contact_.B.placement = reference; }  // sets the placement
};

/// Constrains a frame except its rotation about one axis: a hinge whose pin is fixed in A and in the world. Crocoddyl
/// has no such contact. pref: placement in the world. axis: direction of the pin, with the same components in A and in
/// pref.
class ContactModel5D final : public ContactModelAbstract {
 public:
  /// nu: number of controls of the action.
  ContactModel5D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                 const Eigen::Vector3d& axis, std::size_t nu, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero());
  ContactModel5D(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                 const Eigen::Vector3d& axis, const Eigen::Vector2d& gains = Eigen::Vector2d::Zero())
      : ContactModel5D(std::move(state), id, pref, axis, kDefaultNu, gains) {}            // with nu = nv
  const SE3<double>& get_reference() const { return contact_.B.placement; }               // placement in the world
  void set_reference(const SE3<double>& reference) { contact_.B.placement = reference; }  // sets the placement
  const Eigen::Vector3d& get_axis() const { return contact_.axis; }                       // unit vector
};

/// Constrains a frame A to a frame B', which has the placement `offset` in the frame `to` of another body of any robot.
class ContactModelBetweenBodies final : public ContactModelAbstract {
 public:
  /// Throws std::invalid_argument for a frame that does not exist, or numbers that are not finite.
  ContactModelBetweenBodies(std::shared_ptr<StateMultibody> state, ContactType contact_type, FrameIndex id,
                            FrameIndex to, const SE3<double>& offset, ReferenceFrame type, std::size_t nu,
                            const Eigen::Vector2d& gains = Eigen::Vector2d::Zero(),
                            const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ());
  FrameIndex get_to() const { return to_; }                  // number of the frame of B'
  const SE3<double>& get_offset() const { return offset_; }  // placement of B' in the frame `to`
  void set_offset(const SE3<double>& offset);                // sets the placement of B' in the frame `to`

 private:
  FrameIndex to_;
  SE3<double> offset_;
};

/// A contact as a scene file describes it: between any two bodies, or a body and the world, with offsets from bodies.
class ContactModelOfScene final : public ContactModelAbstract {
 public:
  ContactModelOfScene(std::shared_ptr<StateMultibody> state, const Contact& contact, std::size_t nu);  // nu: controls
};

struct ContactItem {  // A contact, its name, and whether it is active.
  std::string name;
  std::shared_ptr<ContactModelAbstract> contact;
  bool active = true;
};

struct ContactDataMultiple {  // The data of a stack's contacts, by name.
  std::map<std::string, std::shared_ptr<ContactDataAbstract>> contacts;

  // Rows of the active contacts, stacked in the order of the map's keys. They are set only if the contacts are
  // evaluated standalone, without an action model.
  Eigen::MatrixXd Jc, da0_dx;      // nc_total x nv, nc_total x ndx: set by calc, calcDiff
  Eigen::VectorXd a0;              // nc_total: set by calc
  Eigen::VectorXd dv;              // nv: set by updateAcceleration
  Eigen::MatrixXd ddv_dx;          // nv x ndx: set by updateAccelerationDiff
  std::vector<SpatialForce> fext;  // one per joint of each robot: sum of the contact forces on its body, in its frame
};

/// The contacts of an action model, by name. Their rows are stacked in the order of names.
class ContactModelMultiple : public NamedParts<StateMultibody, ContactItem> {
 public:
  using DataPtr = std::shared_ptr<ContactDataMultiple>;

  using ContactModelContainer = Container;
  using ContactDataContainer = std::map<std::string, std::shared_ptr<ContactDataAbstract>>;

  explicit ContactModelMultiple(std::shared_ptr<StateMultibody> state, std::size_t nu = kDefaultNu);  // an empty stack

  /// Throw std::invalid_argument for a new name that exists already, for an unknown name, and for contacts of another
  /// state or nu.
  void addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact, bool active = true);
  void removeContact(const std::string& name) { remove(name); }
  void changeContactStatus(const std::string& name, bool active) { change_status(name, active); }
  bool getContactStatus(const std::string& name) const { return part(name).active; }  // whether it is active

  /// For standalone evaluation: call calc or calcDiff of each active contact, and stack the results.
  void calc(const DataPtr& data, const ConstVectorRef& x) const;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) const;
  /// Set the forces (nc) and their derivatives (nc x ndx, nc x nu). Inactive contacts are set to zero.
  void updateForce(const DataPtr& data, const Eigen::VectorXd& force) const;
  void updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx, const Eigen::MatrixXd& df_du) const;
  void updateAcceleration(const DataPtr& data, const Eigen::VectorXd& dv) const;
  void updateAccelerationDiff(const DataPtr& data, const Eigen::MatrixXd& ddv_dx) const;
  std::shared_ptr<ContactDataMultiple> createData(MultibodyData* data) const;

  const ContactModelContainer& get_contacts() const { return parts_; }  // the contacts
  std::size_t get_nc() const { return nc_; }                            // rows of the active contacts
  std::size_t get_nc_total() const { return nc_total_; }                // rows of all contacts

 private:
  void count() override;
  std::size_t nc_ = 0, nc_total_ = 0;
};

/// Makes a stack of all contacts of a scene (for example of a scene file), with the contacts' names.
std::shared_ptr<ContactModelMultiple> contacts_of_scene(std::shared_ptr<StateMultibody> state, const Scene& scene,
                                                        std::size_t nu);

}  // namespace manycontact
