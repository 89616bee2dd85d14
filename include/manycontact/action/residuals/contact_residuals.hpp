#pragma once
// Residuals of one contact's force, in the contact's own reference frame, of the contact model that stands on a frame.
// Names and constructors of Crocoddyl; nu defaults to nv as there. Zero while the contact is inactive. `fwddyn` is
// there for Crocoddyl's signatures and must be true: in this library forces are results.

#include "manycontact/action/cones.hpp"
#include "manycontact/action/residual.hpp"

namespace manycontact {

/// In whose axes a cone is given: the contact's reference frame (as in Crocoddyl), A's, the world's, or those of B'. A
/// point foot that tilts on the ground keeps its cone in the world's.
enum class ConeAxes { kContact, kFoot, kWorld, kOther };

/// r = B f - b, with B and b constant between changes of the reference; or turning, in other axes than the contact's.
class ContactResidual : public ResidualModelAbstract {
 public:
  /// Throws std::invalid_argument when no contact stands on the frame, or one of a type that does not fit.
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  bool fits(const ResidualDataAbstract& data) const override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void print(std::ostream& os) const override;

  FrameIndex get_id() const { return id_; }
  /// Takes effect at the action's next calc. Throws std::invalid_argument for a frame that does not exist.
  void set_id(FrameIndex id);
  /// Which of several contacts on that frame, by its name in ContactModelMultiple. Empty at first: the only one.
  const std::string& get_contact() const { return contact_; }
  void set_contact(const std::string& name) { contact_ = name; }
  bool is_fwddyn() const { return true; }
  ConeAxes get_axes() const { return axes_; }
  /// kContact at first. Throws std::invalid_argument for anything else on a residual that is no cone.
  void set_axes(ConeAxes axes);

 protected:
  /// Columns: unit wrenches of the contact's rows.
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

  ContactResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr,
                  std::size_t nu, bool fwddyn);
  /// Why a contact of this type does not fit; empty when it does.
  virtual std::string misfit(ContactType type) const = 0;
  virtual bool is_cone() const { return true; }
  /// B (nr x nc) and b (nr) for the contact's unit wrenches P. They come in with their sizes.
  virtual void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const = 0;
  const char* name_;
  FrameIndex id_;
  ConeAxes axes_ = ConeAxes::kContact;
  std::string contact_;
};

/// f - fref (nc): of fref the components the contact has.
class ResidualModelContactForce : public ContactResidual {
 public:
  ResidualModelContactForce(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& fref,
                            std::size_t nc, std::size_t nu, bool fwddyn = true);
  ResidualModelContactForce(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& fref,
                            std::size_t nc);
  const Vec6<double>& get_reference() const { return fref_; }
  void set_reference(const Vec6<double>& reference) { fref_ = reference; }

 private:
  bool is_cone() const override { return false; }
  std::string misfit(ContactType type) const override;
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
  Vec6<double> fref_;
};

/// A f of a friction cone, f the linear force (nf + 1).
class ResidualModelContactFrictionCone : public ContactResidual {
 public:
  ResidualModelContactFrictionCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const FrictionCone& fref,
                                   std::size_t nu, bool fwddyn = true);
  ResidualModelContactFrictionCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const FrictionCone& fref);
  const FrictionCone& get_reference() const { return fref_; }
  /// With as many facets as before.
  void set_reference(const FrictionCone& reference);

 private:
  std::string misfit(ContactType type) const override;
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
  FrictionCone fref_;
};

/// A f of a wrench cone, f the wrench of a 6D contact (nf + 13).
class ResidualModelContactWrenchCone : public ContactResidual {
 public:
  ResidualModelContactWrenchCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const WrenchCone& fref,
                                 std::size_t nu, bool fwddyn = true);
  ResidualModelContactWrenchCone(std::shared_ptr<StateMultibody> state, FrameIndex id, const WrenchCone& fref);
  const WrenchCone& get_reference() const { return fref_; }
  /// With as many facets as before.
  void set_reference(const WrenchCone& reference);

 private:
  std::string misfit(ContactType type) const override;
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
  WrenchCone fref_;
};

/// A f of a support polygon, f the wrench of a 6D contact (4).
class ResidualModelContactCoPPosition : public ContactResidual {
 public:
  ResidualModelContactCoPPosition(std::shared_ptr<StateMultibody> state, FrameIndex id, const CoPSupport& cref,
                                  std::size_t nu, bool fwddyn = true);
  ResidualModelContactCoPPosition(std::shared_ptr<StateMultibody> state, FrameIndex id, const CoPSupport& cref);
  const CoPSupport& get_reference() const { return cref_; }
  void set_reference(const CoPSupport& reference) { cref_ = reference; }

 private:
  std::string misfit(ContactType type) const override;
  void form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const override;
  CoPSupport cref_;
};

}  // namespace manycontact
