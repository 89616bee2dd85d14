#pragma once
#include <algorithm>

#include "manycontact/dynamics/solve_wanted.hpp"
#include "motion_of.hpp"

namespace manycontact::internal {

/// The scene at rest, without gravity and damping, whose contacts ask for motions; all others are their errors.
class AtRest {
 public:
  AtRest(const Scene& scene, const std::vector<char>& active, const Options& options)
      : scene_(without_forces(scene)), data_(scene_, options), zero_(Eigen::VectorXd::Zero(scene.nv)) {
    data_.active = active;
    prepare(scene_, data_);
  }

  Eigen::Index rows() const { return data_.f.size(); }
  Status worst() const { return worst_; }  // of its solves

  /// e, the errors of placement that gains correct, per row.
  Eigen::VectorXd errors(const Eigen::VectorXd& q) const {
    return of_contacts(q, nullptr, [](const ContactData<double>& d) -> Eigen::VectorXd { return d.a0; });
  }
  /// J v, per row.
  Eigen::VectorXd velocities(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    return of_contacts(q, v.data(), [](const ContactData<double>& d) -> Eigen::VectorXd { return d.W * d.nu; });
  }
  /// Of all x with the least |J x - wanted| the one of least x^T M x: [M J^T; J 0] [x; -f] = [0; wanted]. NaN in
  /// islands that have no such answer; then false.
  bool least_motion(const Eigen::VectorXd& q, const Eigen::VectorXd& wanted, Eigen::VectorXd& x) {
    // the errors, which alpha = 1 adds to a0, are part of what is asked for already
    const Status status = solve_tau(scene_, q, zero_, zero_, wanted + errors(q), data_).status;
    worst_ = std::max(worst_, status);
    x = data_.a;
    return status != Status::kFailed;
  }

 private:
  static Scene without_forces(Scene scene) {
    scene.gravity.setZero();
    scene.damping = 0;
    for (Contact& contact : scene.contacts) contact.alpha = 1, contact.beta = 0;  // a0 at rest is e
    return scene;
  }
  template <class Rows>
  Eigen::VectorXd of_contacts(const Eigen::VectorXd& q, const double* v, Rows&& rows) const {
    Eigen::VectorXd out(data_.f.size());
    each_contact_at(scene_, data_.active, q, v,
                    [&](int c, const ContactData<double>& d) { out.segment(data_.f_offset[c], d.W.rows()) = rows(d); });
    return out;
  }

  Scene scene_;
  SceneData data_;
  Eigen::VectorXd zero_;
  Status worst_ = Status::kOk;
};

}  // namespace manycontact::internal
