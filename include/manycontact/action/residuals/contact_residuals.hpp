#pragma once
// Residuals of the force of one contact, in the contact's reference frame. The constructors select the contact by its
// frame. Names and constructors are Crocoddyl's; nu is nv by default. A residual is zero while the contact is inactive.
// `fwddyn` must be true: this library has no inverse-dynamics formulation, in which forces are controls. Constructors
// throw std::invalid_argument for a frame that does not exist.

#include "manycontact/action/cones.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"

namespace manycontact {

/// The axes of a cone: the contact's reference frame (as in Crocoddyl), A, the world (for rotating point feet), or B'.
enum class ConeAxes { kContact, kFoot, kWorld, kOther };

/// The base class of residuals r = B f - b, with the contact force f. B and b depend on the reference, and with axes
/// other than kContact also on q.
class ContactResidual : public FrameResidual {
 public:
  /// Throws std::invalid_argument if there is no contact on the frame, or its type does not fit.
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  bool fits(const ResidualDataAbstract& data) const override;

  /// Returns the name in ContactModelMultiple that selects one of several contacts on the frame. It may be empty if the
  /// frame has only one contact.
  const std::string& get_contact() const { return contact_; }
  void set_contact(const std::string& name) { contact_ = name; }  // selects the contact by its name
  bool is_fwddyn() const { return true; }                         // always true; Crocoddyl's signature
  ConeAxes get_axes() const { return axes_; }                     // the axes of the cone
  /// Sets the cone's axes; initially kContact. A residual without cone throws std::invalid_argument for other axes.
  void set_axes(ConeAxes axes);

 protected:
  /// A matrix whose columns are the unit wrenches of the contact's rows, in the axes of the cone.
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

  /// Throws std::invalid_argument for a frame that does not exist, or unless fwddyn is true.
  ContactResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr,
                  std::size_t nu, bool fwddyn);
  /// Returns why a contact of this type does not fit the residual; empty if it fits. By default only 6D contacts fit.
  virtual std::string misfit(ContactType type) const;
  virtual bool is_cone() const { return true; }  // whether the residual is that of a cone
  /// Computes B (nr x nc) and b (nr) for the contact's unit wrenches P. B and b already have these sizes.
  virtual void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const = 0;
  ConeAxes axes_ = ConeAxes::kContact;
  std::string contact_;

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The contact force minus fref (nc). Components of fref that the contact does not transmit are not used.
class ResidualModelContactForce : public ResidualWithReference<ContactResidual, Vec6<double>> {
 public:
  /// nc: number of rows of the contact.
  ResidualModelContactForce(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& fref,
                            std::size_t nc, std::size_t nu = kDefaultNu, bool fwddyn = true);

 private:
  bool is_cone() const override { return false; }
  std::string misfit(ContactType type) const override;
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
};

/// The rows A f of a friction cone (nf + 1), where f is the linear force.
class ResidualModelContactFrictionCone : public ResidualWithReference<ContactResidual, FrictionCone> {
 public:
  /// fref: the cone. Its number of facets determines nr and cannot change later.
  ResidualModelContactFrictionCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const FrictionCone& fref,
                                   std::size_t nu = kDefaultNu, bool fwddyn = true)
      : ResidualWithReference(fref, "ResidualModelContactFrictionCone", std::move(state), id, fref.get_nf() + 1, nu,
                              fwddyn) {}

 private:
  std::string misfit(ContactType) const override { return ""; }
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
};

/// The rows A f of a wrench cone (nf + 13), where f is the wrench of a 6D contact.
class ResidualModelContactWrenchCone : public ResidualWithReference<ContactResidual, WrenchCone> {
 public:
  /// fref: the cone. Its number of facets determines nr and cannot change later.
  ResidualModelContactWrenchCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const WrenchCone& fref,
                                 std::size_t nu = kDefaultNu, bool fwddyn = true)
      : ResidualWithReference(fref, "ResidualModelContactWrenchCone", std::move(state), id, fref.get_nf() + 13, nu,
                              fwddyn) {}

 private:
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
};

/// The 4 rows A f of a rectangular support for the centre of pressure, where f is the wrench of a 6D contact.
class ResidualModelContactCoPPosition : public ResidualWithReference<ContactResidual, CoPSupport> {
 public:
  /// cref: the support polygon.
  ResidualModelContactCoPPosition(std::shared_ptr<StateMultibody> state, FrameIndex id, const CoPSupport& cref,
                                  std::size_t nu = kDefaultNu, bool fwddyn = true)
      : ResidualWithReference(cref, "ResidualModelContactCoPPosition", std::move(state), id, 4u, nu, fwddyn) {}

 private:
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
};

}  // namespace manycontact
