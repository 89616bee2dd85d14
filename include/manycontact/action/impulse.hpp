#pragma once
// Impulses with Crocoddyl's names and constructors, and stacks of impulses. An impulse stops or reverses the velocity
// of a frame. Its constraint rows J are those of a contact; control/impulse_fwddyn.hpp solves the equations.

#include "manycontact/action/contact.hpp"

namespace manycontact {

/// The data of an impulse f on A [N s, N m s]. The bias a0 is zero, and da0_dx is d(Jc w)/dq for constant w = v+ + e v.
/// Here v, v+ are the velocities before and after the impact, and e is the coefficient of restitution.
using ImpulseDataAbstract = ContactDataAbstract;

/// The data of a stack of impulses. The matrices and vectors are set in standalone evaluation only.
struct ImpulseDataMultiple : ContactDataMultiple {
  std::map<std::string, std::shared_ptr<ImpulseDataAbstract>>& impulses = contacts;
  Eigen::MatrixXd dv0_dq;     // nc_total x nv: set by calcDiff
  Eigen::VectorXd vnext;      // nv: set by updateVelocity
  Eigen::MatrixXd dvnext_dx;  // nv x ndx: set by updateVelocityDiff
};

/// An impulse. Users cannot derive from this class, because action models do not call its calc and calcDiff.
class ImpulseModelAbstract : public Printable {
 public:
  using DataPtr = std::shared_ptr<ImpulseDataAbstract>;

  /// For standalone evaluation, without an action model, at the motion in `data->pinocchio` (x is ignored): calc
  /// computes Jc, calcDiff computes dv0_dq.
  void calc(const DataPtr& data, const ConstVectorRef& x) const;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) const;
  /// For standalone evaluation: updateForce sets f = impulse (nc) and fext; updateForceDiff sets df_dx (nc x ndx).
  void updateForce(const DataPtr& data, const Eigen::VectorXd& impulse) const { contact_->updateForce(data, impulse); }
  void updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx) const;
  void setZeroForce(const DataPtr& data) const { contact_->setZeroForce(data); }
  void setZeroForceDiff(const DataPtr& data) const { contact_->setZeroForceDiff(data); }
  std::shared_ptr<ImpulseDataAbstract> createData(MultibodyData* data) const;

  /// Returns the state given to the constructor.
  const std::shared_ptr<StateMultibody>& get_state() const { return contact_->get_state(); }
  std::size_t get_nc() const { return contact_->get_nc(); }         // number of constraint rows
  std::size_t get_nu() const { return 0; }                          // number of controls
  FrameIndex get_id() const { return contact_->get_id(); }          // number of the frame
  ReferenceFrame get_type() const { return contact_->get_type(); }  // the reference frame
  void set_id(FrameIndex id) { contact_->set_id(id); }              // selects another frame
  void set_type(ReferenceFrame type) { contact_->set_type(type); }  // selects another reference frame
  /// Returns the contact model that has the same constraint rows as this impulse.
  const std::shared_ptr<ContactModelAbstract>& get_contact() const { return contact_; }
  void print(std::ostream& os) const override;  // prints type and sizes

 private:
  friend class ImpulseModel3D;
  friend class ImpulseModel6D;
  friend class ImpulseModelBetweenBodies;
  friend class ImpulseModelOfScene;
  ImpulseModelAbstract(const char* name, std::shared_ptr<ContactModelAbstract> contact);
  const char* name_;
  std::shared_ptr<ContactModelAbstract> contact_;
};

/// Stops the velocity of a point.
class ImpulseModel3D final : public ImpulseModelAbstract {
 public:
  /// Throws std::invalid_argument for a frame that does not exist, or numbers that are not finite.
  ImpulseModel3D(std::shared_ptr<StateMultibody> state, FrameIndex id, ReferenceFrame type = ReferenceFrame::kLocal)
      : ImpulseModelAbstract(
            "ImpulseModel3D",
            std::make_shared<ContactModel3D>(std::move(state), id, Eigen::Vector3d(Eigen::Vector3d::Zero()), type)) {}
};

/// Stops the velocity of a frame.
class ImpulseModel6D final : public ImpulseModelAbstract {
 public:
  /// Throws std::invalid_argument for a frame that does not exist, or numbers that are not finite.
  ImpulseModel6D(std::shared_ptr<StateMultibody> state, FrameIndex id, ReferenceFrame type = ReferenceFrame::kLocal)
      : ImpulseModelAbstract("ImpulseModel6D",
                             std::make_shared<ContactModel6D>(std::move(state), id, SE3<double>{}, type)) {}
};

/// Stops the relative velocity of two bodies' frames, as in ContactModelBetweenBodies.
class ImpulseModelBetweenBodies final : public ImpulseModelAbstract {
 public:
  /// Throws std::invalid_argument for a frame that does not exist, or numbers that are not finite.
  ImpulseModelBetweenBodies(std::shared_ptr<StateMultibody> state, ContactType contact_type, FrameIndex id,
                            FrameIndex to, const SE3<double>& offset = {}, ReferenceFrame type = ReferenceFrame::kLocal,
                            const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ())
      : ImpulseModelAbstract(
            "ImpulseModelBetweenBodies",
            std::make_shared<ContactModelBetweenBodies>(std::move(state), contact_type, id, to, offset, type,
                                                        kDefaultNu, Eigen::Vector2d(Eigen::Vector2d::Zero()), axis)) {}
};

/// An impulse with the rows of a contact of a scene: between any two bodies, or a body and the world, with offsets.
class ImpulseModelOfScene final : public ImpulseModelAbstract {
 public:
  /// Throws std::invalid_argument for a missing body.
  ImpulseModelOfScene(std::shared_ptr<StateMultibody> state, const Contact& contact)
      : ImpulseModelAbstract("ImpulseModelOfScene",
                             std::make_shared<ContactModelOfScene>(std::move(state), contact, kDefaultNu)) {}
};

struct ImpulseItem {  // An impulse, its name, and whether it is active.
  std::string name;
  std::shared_ptr<ImpulseModelAbstract> impulse;
  bool active = true;
};

/// The impulses of an action model, by name. Their rows are stacked in the order of names.
class ImpulseModelMultiple : public NamedParts<StateMultibody, ImpulseItem> {
 public:
  using DataPtr = std::shared_ptr<ImpulseDataMultiple>;

  using ImpulseModelContainer = Container;
  using ImpulseDataContainer = std::map<std::string, std::shared_ptr<ImpulseDataAbstract>>;

  explicit ImpulseModelMultiple(std::shared_ptr<StateMultibody> state);  // a stack without parts

  /// Throw std::invalid_argument for a new name that exists already, for an unknown name, and for impulses of another
  /// state.
  void addImpulse(const std::string& name, std::shared_ptr<ImpulseModelAbstract> impulse, bool active = true);
  void removeImpulse(const std::string& name);
  void changeImpulseStatus(const std::string& name, bool active);
  bool getImpulseStatus(const std::string& name) const { return part(name).active; }  // whether the impulse is active

  /// For standalone evaluation: call calc or calcDiff of each active impulse, and stack the results.
  void calc(const DataPtr& data, const ConstVectorRef& x) const;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) const;
  /// Set the impulses (nc) and their derivatives (nc x ndx). Inactive impulses are set to zero.
  void updateForce(const DataPtr& data, const Eigen::VectorXd& impulse) const;
  void updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx) const;
  void updateVelocity(const DataPtr& data, const Eigen::VectorXd& vnext) const;
  void updateVelocityDiff(const DataPtr& data, const Eigen::MatrixXd& dvnext_dx) const;
  std::shared_ptr<ImpulseDataMultiple> createData(MultibodyData* data) const;

  const ImpulseModelContainer& get_impulses() const { return parts_; }    // the impulses
  std::size_t get_nc() const { return contacts_->get_nc(); }              // rows of the active impulses
  std::size_t get_nc_total() const { return contacts_->get_nc_total(); }  // rows of all impulses
  /// Returns the stack of contact models that have the same constraint rows as these impulses.
  const std::shared_ptr<ContactModelMultiple>& get_contacts() const { return contacts_; }

 private:
  std::shared_ptr<ContactModelMultiple> contacts_;
};

}  // namespace manycontact
