#pragma once
// Residuals of one frame of a robot. Names and constructors are Crocoddyl's; nu is nv by default.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: contains the frame's number.
class FrameResidual : public NamedResidual {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  bool fits(const ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  FrameIndex get_id() const { return id_; }  // number of the frame
  /// Takes effect at the action's next calc. Throws std::invalid_argument for a frame that does not exist.
  void set_id(FrameIndex id);

 protected:
  /// Throws std::invalid_argument for a frame that does not exist.
  FrameResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr, std::size_t nu,
                Dependence on);
  FrameIndex id_;
};

/// The placement error log6(pref^-1 oMf) (6) [m, rad] of the frame's placement oMf in the world, in the axes of pref.
class ResidualModelFramePlacement : public ResidualWithReference<FrameResidual, SE3<double>> {
 public:
  /// Throws std::invalid_argument for a frame that does not exist.
  ResidualModelFramePlacement(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                              std::size_t nu = kDefaultNu)
      : ResidualWithReference(pref, "ResidualModelFramePlacement", std::move(state), id, 6u, nu,
                              Dependence{.q = true}) {}

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The position of the frame minus xref (3) [m], in the world.
class ResidualModelFrameTranslation : public ResidualWithReference<FrameResidual, Eigen::Vector3d> {
 public:
  /// Throws std::invalid_argument for a frame that does not exist.
  ResidualModelFrameTranslation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                                std::size_t nu = kDefaultNu)
      : ResidualWithReference(xref, "ResidualModelFrameTranslation", std::move(state), id, 3u, nu,
                              Dependence{.q = true}) {}

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The rotation error log3(Rref^T R) (3) [rad] of the frame's rotation R in the world.
class ResidualModelFrameRotation : public ResidualWithReference<FrameResidual, Eigen::Matrix3d> {
 public:
  /// Throws std::invalid_argument for a frame that does not exist.
  ResidualModelFrameRotation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Matrix3d& Rref,
                             std::size_t nu = kDefaultNu)
      : ResidualWithReference(Rref, "ResidualModelFrameRotation", std::move(state), id, 3u, nu, Dependence{.q = true}) {
  }

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The frame's spatial velocity [linear; angular] minus vref (6) [m/s, rad/s], in the axes of the frame `type`.
class ResidualModelFrameVelocity : public ResidualWithReference<FrameResidual, Vec6<double>> {
 public:
  /// Throws std::invalid_argument for a frame that does not exist.
  ResidualModelFrameVelocity(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& vref,
                             ReferenceFrame type, std::size_t nu = kDefaultNu)
      : ResidualWithReference(vref, "ResidualModelFrameVelocity", std::move(state), id, 6u, nu,
                              Dependence{.q = true, .v = true}),
        type_(type) {}
  ReferenceFrame get_type() const { return type_; }     // the reference frame
  void set_type(ReferenceFrame type) { type_ = type; }  // selects another reference frame

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  ReferenceFrame type_;
};

}  // namespace manycontact
