// Implements Equations in double-double. This file is compiled once per instruction level; only the Level is visible to
// the linker (src/core/simd/levels.cmake). Templates of the rigid-body algorithms are instantiated here.

#include <algorithm>
#include <optional>

#include "equations.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/contact/products.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/spatial/double_double.hpp"
#include "simd/levels.hpp"

namespace manycontact::extended {

namespace {

using S = DoubleDouble;
using V6 = Vec6<S>;
using Rows = Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1>;  // rows of one contact

struct ForceSize {
  double force = 0, moment = 0;
};

struct RobotWork {  // one robot's kinematics; accelerations and forces of its bodies for a vector x
  explicit RobotWork(const Model& model)
      : kin(model),
        a(model.njoints()),
        f(model.njoints()),
        external(model.njoints()),
        sizes(model.njoints()),
        h(model.nv) {}
  Kinematics<S> kin;
  std::vector<V6> a, f, external;  // njoints: accelerations, forces, contact forces of bodies
  std::vector<ForceSize> sizes;    // njoints: magnitudes of contact forces, scratch
  VecX<S> h;
};

class LevelEquations final : public Equations {
 public:
  explicit LevelEquations(const Scene& scene);

  void begin(const Job& job, const Part& part, const double* a, const double* f) override;
  void add(const Part& part, const double* da, const double* df, bool residual) override;
  void residual(const Part& part, double* of_dynamics, double* of_contacts) const override;
  void round(const Part& part, double* a, double* f) const override;
  void difference(const Part& part, const double* a, const double* f, double* da, double* df) const override;
  void begin_projection(const Part& part, Projected what, const double* weights) override;
  void project(const Part& part, const double* dy, double* change) override;
  void gradient_of_rest(const Part& part, double* torque) override;
  void take_rest(const Part& part) override;
  void set_rest(const Part& part, const double* f) override;
  double torque_of_rest(const Part& part, double* torque) override;
  void add_to_rest(const Part& part, const double* df) override;

 private:
  int first_row(int c) const { return (*f_offset_)[c]; }
  Eigen::Index rows(int c) const { return scene_->contacts[c].rows(); }
  RobotWork& robot(int r) { return *robots_[r]; }
  template <class Use>
  void each_robot(const Part& part, Use&& use) {
    for (int r : part.robots) use(scene_->robots[r], *scene_->robots[r].model, *robots_[r]);
  }
  template <class Use>
  void each_row(const Part& part, Use&& use) const {
    for (int c : part.contacts)
      for (Eigen::Index i = 0; i < rows(c); ++i) use(first_row(c) + i);
  }
  template <class Use>
  void each_coordinate(const Part& part, Use&& use) const {
    for (int r : part.robots) {
      const Robot& of = scene_->robots[r];
      for (int i = 0; i < of.model->nv; ++i) use(of.idx_v + i);
    }
  }
  void evaluate(const Job& job, const Part& part);
  void take_applied_forces(const Job& job);
  void motions(const Part& part, const S* a);
  Rows contact_rows_of_motion(int c) const;
  void put_forces(const Part& part, const S* f);
  void put_sizes(const Part& part);
  void torques(const Part& part, bool inertial);
  void evaluate_residual(const Part& part);

  const Scene* scene_ = nullptr;
  const std::vector<int>* f_offset_ = nullptr;
  const double* damping_ = nullptr;
  std::vector<std::unique_ptr<RobotWork>> robots_;
  std::vector<std::optional<ContactData<S>>> contacts_;  // J is not used
  std::optional<AppliedForces<S>> applied_;
  std::vector<V6> w_;
  VecX<S> q_, v_, tau_;                    // vectors of the scene
  VecX<S> a_, f_, b_a_, b_f_, r_a_, r_f_;  // x, b and r
  VecX<S> y_, torque_;                     // scratch
  VecX<S> rest_, square_, weighed_;        // projections: rest, S^2, S^2 rest
  Projected projected_ = Projected::kForces;
};

LevelEquations::LevelEquations(const Scene& scene) : contacts_(scene.contacts.size()) {
  for (const Robot& of : scene.robots) robots_.push_back(std::make_unique<RobotWork>(*of.model));
  Eigen::Index all = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    contacts_[c].emplace(scene.contacts[c], ContactSupport{});
    all += scene.contacts[c].rows();
  }
  if (has_applied_forces(scene)) applied_.emplace(scene);
  w_.resize(scene.wrenches.size());
  q_.resize(scene.nq);
  for (VecX<S>* x : {&v_, &tau_, &a_, &b_a_, &r_a_, &y_, &torque_}) x->resize(scene.nv);
  for (VecX<S>* x : {&f_, &b_f_, &r_f_, &rest_, &square_, &weighed_}) x->resize(all);
}

void LevelEquations::take_applied_forces(const Job& job) {  // adds springs and external wrenches to the torques
  if (!job.applied) return;
  if (!applied_) applied_.emplace(job.scene);
  w_.resize(job.w.size());
  for (std::size_t k = 0; k < job.w.size(); ++k) w_[k] = job.w[k].cast<S>();
  add_applied_forces<S>(job.scene, q_.data(), v_.data(), w_, *applied_, tau_.data());
}

void LevelEquations::evaluate(const Job& job, const Part& part) {
  const Scene& scene = job.scene;
  for (Eigen::Index i = 0; i < q_.size(); ++i) q_[i] = job.q[i];
  for (Eigen::Index i = 0; i < v_.size(); ++i) v_[i] = job.v[i], tau_[i] = job.tau[i];
  take_applied_forces(job);
  each_robot(part, [&](const Robot& of, const Model& model, RobotWork& at) {
    add_friction<S>(model, v_.data() + of.idx_v, tau_.data() + of.idx_v);
    forward_kinematics<S>(model, of.base, q_.segment(of.idx_q, model.nq), at.kin);
    forward_accelerations<S>(model, v_.segment(of.idx_v, model.nv), nullptr, scene.gravity, at.kin);
    inverse_dynamics<S>(model, at.kin, nullptr, {}, at.f, at.h);
  });
  const ContactSupport none;
  for (int c : part.contacts) {
    const Contact& contact = scene.contacts[c];
    contact_rows<S>(scene, contact, none, robot(contact.A.robot).kin,
                    contact.B.robot < 0 ? nullptr : &robot(contact.B.robot).kin, *contacts_[c]);
  }
}

void LevelEquations::begin(const Job& job, const Part& part, const double* a, const double* f) {
  scene_ = &job.scene;
  f_offset_ = &job.f_offset;
  damping_ = job.damping;
  evaluate(job, part);
  each_robot(part, [&](const Robot& of, const Model& model, const RobotWork& at) {
    for (int i = 0; i < model.nv; ++i) b_a_[of.idx_v + i] = tau_[of.idx_v + i] - at.h[i];
  });
  for (int c : part.contacts) {
    const auto& a0 = contacts_[c]->a0;
    for (Eigen::Index i = 0, k = first_row(c); i < rows(c); ++i, ++k)
      b_f_[k] = (job.prescribed ? S(job.prescribed[k]) : S(0)) - a0[i];
  }
  each_coordinate(part, [&](Eigen::Index k) { a_[k] = a[k]; });
  each_row(part, [&](Eigen::Index k) { f_[k] = f[k]; });
  evaluate_residual(part);
}

void LevelEquations::motions(const Part& part, const S* a) {  // bodies' accelerations due to joint accelerations a
  each_robot(part, [&](const Robot& of, const Model& model, RobotWork& at) {
    for (int i = 0; i < model.njoints(); ++i) {
      const Joint& joint = model.joints[i];
      V6 sum = V6::Zero();
      if (joint.parent >= 0) sum = at.a[joint.parent];
      for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) sum += at.kin.J.col(k) * a[of.idx_v + k];
      at.a[i] = sum;
    }
  });
}

Rows LevelEquations::contact_rows_of_motion(int c) const {  // J a of a contact, after `motions`
  const Contact& contact = scene_->contacts[c];
  const ContactData<S>& of = *contacts_[c];
  V6 motion = V6::Zero();
  const auto body = [&](const Attachment& at) -> const V6& { return robots_[at.robot]->a[at.joint]; };
  if (moves(contact.A)) motion = of.aMA.act_inverse(body(contact.A));
  if (moves(contact.B)) motion -= of.bMA.act_inverse(body(contact.B));
  return of.W * motion;
}

void LevelEquations::put_forces(const Part& part, const S* f) {  // contacts' forces on bodies, into `external`
  for (int r : part.robots)
    for (V6& force : robot(r).external) force.setZero();
  for (int c : part.contacts) {
    const ContactData<S>& of = *contacts_[c];
    V6 F = V6::Zero();
    for (Eigen::Index i = 0; i < rows(c); ++i) F += of.W.row(i).transpose() * f[first_row(c) + i];
    each_body_force<S>(scene_->contacts[c], of, F,
                       [&](const Attachment& at, const V6& force) { robot(at.robot).external[at.joint] += force; });
  }
}

// Sets torque_ = M a - J^T f, without armature, from the bodies' accelerations (if `inertial`) and forces.
void LevelEquations::torques(const Part& part, bool inertial) {
  each_robot(part, [&](const Robot& of, const Model& model, RobotWork& at) {
    for (std::size_t i = 0; i < at.f.size(); ++i) {
      at.f[i] = -at.external[i];
      if (inertial) at.f[i] += at.kin.Y[i] * at.a[i];
    }
    for (int i = model.njoints() - 1; i >= 0; --i) {
      const Joint& joint = model.joints[i];
      const V6& force = at.f[i];
      for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) torque_[of.idx_v + k] = dot(at.kin.J.col(k), force);
      if (joint.parent >= 0) at.f[joint.parent] += force;
    }
  });
}

// Computes r = b - K x from the whole x, instead of updating r, so that the next correction reveals the errors of r.
void LevelEquations::evaluate_residual(const Part& part) {
  motions(part, a_.data());
  put_forces(part, f_.data());
  torques(part, true);
  each_robot(part, [&](const Robot& of, const Model& model, const RobotWork&) {
    for (int i = 0, k = of.idx_v; i < model.nv; ++i, ++k) r_a_[k] = b_a_[k] - torque_[k] - S(model.armature[i]) * a_[k];
  });
  for (int c : part.contacts) {
    const Rows Ja = contact_rows_of_motion(c);
    const S damping(damping_[c]);
    for (Eigen::Index i = 0, k = first_row(c); i < rows(c); ++i, ++k) r_f_[k] = b_f_[k] - Ja[i] - damping * f_[k];
  }
}

void LevelEquations::add(const Part& part, const double* da, const double* df, bool residual) {
  each_coordinate(part, [&](Eigen::Index k) { a_[k] += S(da[k]); });
  each_row(part, [&](Eigen::Index k) { f_[k] += S(df[k]); });
  if (residual) evaluate_residual(part);
}

void LevelEquations::residual(const Part& part, double* of_dynamics, double* of_contacts) const {
  each_coordinate(part, [&](Eigen::Index k) { of_dynamics[k] = static_cast<double>(r_a_[k]); });
  each_row(part, [&](Eigen::Index k) { of_contacts[k] = static_cast<double>(r_f_[k]); });
}

void LevelEquations::round(const Part& part, double* a, double* f) const {
  each_coordinate(part, [&](Eigen::Index k) { a[k] = static_cast<double>(a_[k]); });
  each_row(part, [&](Eigen::Index k) { f[k] = static_cast<double>(f_[k]); });
}

void LevelEquations::difference(const Part& part, const double* a, const double* f, double* da, double* df) const {
  each_coordinate(part, [&](Eigen::Index k) { da[k] = static_cast<double>(a_[k] - S(a[k])); });
  each_row(part, [&](Eigen::Index k) { df[k] = static_cast<double>(f_[k] - S(f[k])); });
}

void LevelEquations::begin_projection(const Part& part, Projected what, const double* weights) {
  projected_ = what;
  each_row(part, [&](Eigen::Index k) {
    square_[k] = S(weights[k]) * S(weights[k]);
    rest_[k] = what == Projected::kForces ? f_[k] : r_f_[k];
  });
}

void LevelEquations::project(const Part& part, const double* dy, double* change) {
  each_coordinate(part, [&](Eigen::Index k) { y_[k] = dy[k]; });
  motions(part, y_.data());
  for (int c : part.contacts) {
    const Rows Jy = contact_rows_of_motion(c);
    for (Eigen::Index i = 0, k = first_row(c); i < rows(c); ++i, ++k) {
      const S taken = projected_ == Projected::kForces ? square_[k] * Jy[i] : Jy[i];
      rest_[k] -= taken;
      change[k] = static_cast<double>(taken);
    }
  }
}

void LevelEquations::gradient_of_rest(const Part& part, double* torque) {
  const S* forces = rest_.data();
  if (projected_ == Projected::kResidual) {
    each_row(part, [&](Eigen::Index k) { weighed_[k] = square_[k] * rest_[k]; });
    forces = weighed_.data();
  }
  put_forces(part, forces);
  torques(part, false);
  each_coordinate(part, [&](Eigen::Index k) { torque[k] = -static_cast<double>(torque_[k]); });
}

void LevelEquations::take_rest(const Part& part) {
  if (projected_ == Projected::kForces)
    each_row(part, [&](Eigen::Index k) { f_[k] -= rest_[k]; });
  else
    each_row(part, [&](Eigen::Index k) { b_f_[k] -= rest_[k], r_f_[k] -= rest_[k]; });
}

void LevelEquations::set_rest(const Part& part, const double* f) {
  each_row(part, [&](Eigen::Index k) { rest_[k] = f[k]; });
}

void LevelEquations::put_sizes(const Part& part) {  // sums magnitudes of contact forces per body, which cannot cancel
  for (int r : part.robots) std::ranges::fill(robot(r).sizes, ForceSize{});
  const auto put = [&](const Attachment& at, const SE3<S>& M, double force, double moment) {
    if (!moves(at)) return;
    ForceSize& size = robot(at.robot).sizes[at.joint];
    size.force += force;
    size.moment += moment + M.p.template cast<double>().norm() * force;
  };
  for (int c : part.contacts) {
    const Contact& contact = scene_->contacts[c];
    const ContactData<S>& of = *contacts_[c];
    double force = 0, moment = 0;
    for (Eigen::Index i = 0; i < rows(c); ++i) {
      const double size = std::abs(rest_[first_row(c) + i].hi);
      force += of.W.row(i).template head<3>().template cast<double>().norm() * size;
      moment += of.W.row(i).template tail<3>().template cast<double>().norm() * size;
    }
    put(contact.A, of.aMA, force, moment);
    put(contact.B, of.bMA, force, moment);
  }
}

double LevelEquations::torque_of_rest(const Part& part, double* torque) {
  put_forces(part, rest_.data());
  torques(part, false);
  put_sizes(part);
  double largest = 0, terms = 0;
  each_coordinate(part, [&](Eigen::Index k) {
    torque[k] = -torque_[k].hi;
    largest = std::max(largest, std::abs(torque[k]));
  });
  each_robot(part, [&](const Robot&, const Model& model, RobotWork& at) {
    for (int i = model.njoints() - 1; i >= 0; --i) {
      const Joint& joint = model.joints[i];
      const ForceSize& size = at.sizes[i];
      for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
        const Vec6<double> J = at.kin.J.col(k).template cast<double>();
        terms = std::max(terms, J.head<3>().norm() * size.force + J.tail<3>().norm() * size.moment);
      }
      if (joint.parent < 0) continue;
      at.sizes[joint.parent].force += size.force;
      at.sizes[joint.parent].moment += size.moment;
    }
  });
  return largest == 0 ? 0 : largest / terms;
}

void LevelEquations::add_to_rest(const Part& part, const double* df) {
  each_row(part, [&](Eigen::Index k) { rest_[k] += S(df[k]); });
}

std::unique_ptr<Equations> make(const Scene& scene) { return std::make_unique<LevelEquations>(scene); }

}  // namespace

extern const Level MANYCONTACT_OF_LEVEL(level_);
const Level MANYCONTACT_OF_LEVEL(level_) = {make};

}  // namespace manycontact::extended
