#pragma once
// Residuals of one frame of a robot. Names and constructors are Crocoddyl's; nu is nv by default.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: a frame.
class FrameResidual : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  bool fits(const ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  FrameIndex get_id() const { return id_; }  // number of the frame
  /// Takes effect at the action's next calc. Throws std::invalid_argument for a frame that does not exist.
  void set_id(FrameIndex id);

 protected:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  FrameResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr, std::size_t nu,
                Dependence on);
  const char* name_;
  FrameIndex id_;
};

/// The placement error log6(pref^-1 oMf) (6), in the reference's axes.
class ResidualModelFramePlacement : public FrameResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFramePlacement(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref,
                              std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFramePlacement(std::shared_ptr<StateMultibody> state, FrameIndex id, const SE3<double>& pref);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;

  const SE3<double>& get_reference() const { return pref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const SE3<double>& reference) { pref_ = reference; }

 private:
  SE3<double> pref_;
};

/// The position of the frame minus xref (3) [m], in the world.
class ResidualModelFrameTranslation : public FrameResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameTranslation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref,
                                std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameTranslation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Vector3d& xref);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;

  const Eigen::Vector3d& get_reference() const { return xref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::Vector3d& reference) { xref_ = reference; }

 private:
  Eigen::Vector3d xref_;
};

/// The rotation error log3(Rref^T R) (3) [rad].
class ResidualModelFrameRotation : public FrameResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameRotation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Matrix3d& Rref,
                             std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameRotation(std::shared_ptr<StateMultibody> state, FrameIndex id, const Eigen::Matrix3d& Rref);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;

  const Eigen::Matrix3d& get_reference() const { return Rref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::Matrix3d& reference) { Rref_ = reference; }

 private:
  Eigen::Matrix3d Rref_;
};

/// The frame's spatial velocity [linear; angular] minus vref (6), both in the axes of `type` (algorithm/frames.hpp).
class ResidualModelFrameVelocity : public FrameResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameVelocity(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& vref,
                             ReferenceFrame type, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelFrameVelocity(std::shared_ptr<StateMultibody> state, FrameIndex id, const Vec6<double>& vref,
                             ReferenceFrame type);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;

  const Vec6<double>& get_reference() const { return vref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Vec6<double>& reference) { vref_ = reference; }
  ReferenceFrame get_type() const { return type_; }     // the reference frame
  void set_type(ReferenceFrame type) { type_ = type; }  // selects another reference frame

 private:
  Vec6<double> vref_;
  ReferenceFrame type_;
};

}  // namespace manycontact
