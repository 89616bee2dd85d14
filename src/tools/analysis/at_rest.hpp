#pragma once
#include <algorithm>
#include <cmath>

#include "manycontact/contact/motion_of.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/views.hpp"
#include "mixed.hpp"

namespace manycontact::internal {

inline std::vector<char> active_of(const SceneData& data) {
  std::vector<char> active;
  for (const int first : data.f_offset) active.push_back(first >= 0);
  return active;
}

template <class Act>
void each_row(const Scene& scene, const SceneData& data, std::size_t island, Act&& act) {
  for (const int c : solved_island(data, island).contacts)
    for (int k = 0; k < scene.contacts[c].rows(); ++k) act(data.f_offset[c] + k);
}
inline std::vector<int> rows_of(const Scene& scene, const SceneData& data, std::size_t island) {
  std::vector<int> rows;
  each_row(scene, data, island, [&](int row) { rows.push_back(row); });
  return rows;
}
/// Returns a bound of the change that rounding errors of J cause in an island's n, where J^T n = 0. change: the result
/// of AtRest::change_of_null.
inline double change_in(const Scene& scene, const SceneData& data, std::size_t island, const Eigen::VectorXd& n,
                        const Eigen::VectorXd& change) {
  double sum = 0, most = 0;
  each_row(scene, data, island, [&](int row) {
    sum += std::abs(n[row]);
    most = std::max(most, std::abs(change[row]));
  });
  return most * sum;
}
template <class Act>
void each_coordinate(const Scene& scene, const SceneData& data, std::size_t island, Act&& act) {
  for (const int r : solved_island(data, island).robots)
    for (int k = 0; k < scene.robots[r].model->nv; ++k) act(scene.robots[r].idx_v + k);
}

/// A copy of the scene with zero velocity, gravity and damping, in which accelerations of rows can be prescribed.
class AtRest {
 public:
  AtRest(const Scene& scene, const std::vector<char>& active, const Options& options)
      : scene_(without_forces(scene)), data_(scene_, options), zero_(Eigen::VectorXd::Zero(scene.nv)) {
    data_.active = active;
    prepare(scene_, data_);
  }
  /// Copies the scene with the active contacts and the redundant rows of the solution `of`.
  AtRest(const Scene& scene, const SceneData& of) : AtRest(scene, active_of(of), of.options) {
    keep_dependent_as(of, scene_, data_);
  }

  Eigen::Index rows() const { return data_.f.size(); }
  Status worst() const { return worst_; }                    // worst status of all solves
  const Eigen::VectorXd& forces() const { return data_.f; }  // forces of the last solve

  /// Returns the placement error of each constraint row of the contacts at q, which Baumgarte gains would correct.
  Eigen::VectorXd errors(const Eigen::VectorXd& q) const {
    return of_contacts(q, nullptr,
                       [](const Contact&, const ContactData<double>& d) -> Eigen::VectorXd { return d.a0; });
  }
  Eigen::VectorXd velocities(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {  // J v
    return of_contacts(q, v.data(),
                       [](const Contact&, const ContactData<double>& d) -> Eigen::VectorXd { return d.W * d.nu; });
  }
  /// Returns Jdot v. The bias a0 of the solver has one more term, except in 6D contacts, if the contact's frames move
/// relative to each other.
  Eigen::VectorXd bias(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    return of_contacts(q, v.data(), [](const Contact& c, const ContactData<double>& d) -> Eigen::VectorXd {
      Vec6<double> rate = d.nudot;
      const Vec3<double> turning = d.vA.tail<3>();
      for (const int first : {0, 3})
        if (rows_turn(c)) rate.segment<3>(first) += turning.cross(Vec3<double>(d.nu.segment<3>(first)));
      return d.W * rate;
    });
  }
  /// Returns for each row the squared largest body velocity of its contact: the magnitude of the terms of Jdot v.
  Eigen::VectorXd bias_terms(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    return of_contacts(q, v.data(), [](const Contact&, const ContactData<double>& d) -> Eigen::VectorXd {
      const double speed = std::max(d.vA.cwiseAbs().maxCoeff(), d.vB.cwiseAbs().maxCoeff());
      return Eigen::VectorXd::Constant(d.W.rows(), speed * speed);
    });
  }
  /// Computes the x with least x^T M x among all x that minimise |J x - wanted|. A damping above 0 minimises x^T M x +
  /// |J x - wanted|^2 / damping instead. If an island has no solution, its x is NaN; then returns false.
  bool least_motion(const Eigen::VectorXd& q, const Eigen::VectorXd& wanted, Eigen::VectorXd& x, double damping = 0) {
    scene_.damping = damping;
    // a0 contains the placement errors, because alpha = 1; adding errors(q) cancels them
    const Status status = solve_tau(scene_, q, zero_, zero_, wanted + errors(q), data_).status;
    worst_ = std::max(worst_, status);
    x = data_.a;
    return status != Status::kFailed;
  }
  /// Returns the projection of w on the null space of J^T. A second projection removes rounding errors of the first.
  Eigen::VectorXd null_component(const Eigen::VectorXd& q, Eigen::VectorXd w) {
    Eigen::VectorXd x;
    for (int pass = 0; pass < 2; ++pass) {
      (void)least_motion(q, w, x);
      w -= velocities(q, x);
    }
    return w;
  }
  /// Returns how much an error E of J changes a vector n with J^T n = 0 and sum |n_k| = 1, per row. `inaccuracy` bounds
  /// the entries of E per column (inaccuracy_of). The change is f with J^T f = E^T n for one E^T n of random signs.
  Eigen::VectorXd change_of_null(const Eigen::VectorXd& q, const Eigen::VectorXd& inaccuracy) {
    if (inaccuracy.isZero(0)) return Eigen::VectorXd::Zero(rows());
    const Eigen::VectorXd y = inaccuracy.cwiseProduct(mixed(inaccuracy.size(), 0).cwiseSign());
    (void)solve_tau(scene_, q, zero_, y, errors(q), data_);
    return data_.f;
  }
  /// Returns the projection of v on the motions with J v = 0. A second projection removes rounding errors of the first.
  Eigen::VectorXd allowed_part(const Eigen::VectorXd& q, Eigen::VectorXd v) {
    Eigen::VectorXd x;
    for (int pass = 0; pass < 2; ++pass) {
      (void)least_motion(q, velocities(q, v), x);
      v -= x;
    }
    return v;
  }

 private:
  static Scene without_forces(Scene scene) {
    scene.gravity.setZero();
    drop_applied_forces(scene);
    scene.damping = 0;
    for (Contact& contact : scene.contacts) contact.alpha = 1, contact.beta = 0;  // a0 at rest: placement error
    return scene;
  }
  template <class Rows>
  Eigen::VectorXd of_contacts(const Eigen::VectorXd& q, const double* v, Rows&& rows) const {
    Eigen::VectorXd out(data_.f.size());
    each_contact_at(scene_, data_.active, q, v, [&](int c, const ContactData<double>& d) {
      out.segment(data_.f_offset[c], d.W.rows()) = rows(scene_.contacts[c], d);
    });
    return out;
  }

  Scene scene_;
  SceneData data_;
  Eigen::VectorXd zero_;
  Status worst_ = Status::kOk;
};

}  // namespace manycontact::internal
