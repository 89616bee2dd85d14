#include "unit_forces.hpp"

#include <algorithm>
#include <numeric>

#include "manycontact/model/applied_forces.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::internal {

namespace {

int robot_of(const Scene& scene, int coordinate) {
  const auto after = std::upper_bound(scene.robots.begin(), scene.robots.end(), coordinate,
                                      [](int i, const Robot& robot) { return i < robot.idx_v; });
  return static_cast<int>(after - scene.robots.begin()) - 1;  // robots without coordinates come before one with
}

Scene with_ends(const Scene& scene, std::vector<int> (&push)[2]) {
  Scene out = scene;
  drop_applied_forces(out);
  out.contacts.clear(), out.contact_index.clear();
  for (const Spring& spring : scene.springs)
    for (const int end : {0, 1}) {
      const Attachment& at = end == 0 ? spring.A : spring.B;
      push[end].push_back(at.robot < 0 ? -1 : static_cast<int>(out.pushes.size()));
      if (at.robot >= 0) out.pushes.push_back({"", at, ReferenceFrame::kWorld});
    }
  return out;
}

}  // namespace

int UnitTorques::number(const Scene& scene, const std::vector<char>& active, std::span<UnitForce> forces) {
  islands_.resize(scene.robots.size());
  count_.assign(scene.robots.size(), 0);
  sparse::UnionFind islands(islands_);
  const auto join = [&](const Attachment& A, const Attachment& B) {
    if (A.robot >= 0 && B.robot >= 0) islands.join(A.robot, B.robot);
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) join(scene.contacts[c].A, scene.contacts[c].B);
  for (const UnitForce& force : forces)
    if (force.spring >= 0) join(scene.springs[force.spring].A, scene.springs[force.spring].B);
  int most = 0;
  for (UnitForce& force : forces) {
    force.island =
        islands.root(force.spring >= 0 ? scene.springs[force.spring].A.robot : robot_of(scene, force.coordinate));
    force.number = count_[static_cast<std::size_t>(force.island)]++;
    most = std::max(most, force.number + 1);
  }
  return most;
}

UnitTorques::UnitTorques(const Scene& scene)
    : ends_(with_ends(scene, push_)),
      forces_(ends_),
      scratch_(forces_),
      robots_(scene.robots.size()),
      w_(ends_.pushes.size(), Vec6<double>::Zero()) {
  std::iota(robots_.begin(), robots_.end(), 0);
  for (Eigen::VectorXd* x : {&rest_, &tau_, &joints_, &a_, &by_q_, &by_v_}) x->setZero(scene.nv);
  by_w_.setZero(static_cast<Eigen::Index>(6 * w_.size()));
}

void UnitTorques::place(const Scene& scene, const Eigen::VectorXd& q) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) ends_.robots[r].base = scene.robots[r].base;
  q_ = q;
  clear();
  (void)torques();
}

void UnitTorques::clear() {
  std::fill(w_.begin(), w_.end(), Vec6<double>(Vec6<double>::Zero()));
  joints_.setZero();
}

void UnitTorques::add(const UnitForce& force, double amount) {
  if (force.spring < 0) {
    joints_[force.coordinate] += amount;
    return;
  }
  for (const int end : {0, 1})
    if (const int p = push_[end][static_cast<std::size_t>(force.spring)]; p >= 0)
      w_[static_cast<std::size_t>(p)].head<3>() += (end == 0 ? amount : -amount) * force.direction;
}

const Eigen::VectorXd& UnitTorques::torques() {
  tau_ = joints_;
  if (!w_.empty()) add_applied_forces<double>(ends_, q_.data(), rest_.data(), w_, forces_, tau_.data());
  return tau_;
}

void UnitTorques::look(const Eigen::VectorXd& a) {
  a_ = a;
  clear();
  if (!w_.empty())
    add_applied_adjoint(ends_, rest_.data(), forces_, robots_, a_.data(), scratch_, by_q_.data(), by_v_.data(),
                        by_w_.data());
}

double UnitTorques::along(const UnitForce& force) const {
  if (force.spring < 0) return a_[force.coordinate];
  double out = 0;
  for (const int end : {0, 1})
    if (const int p = push_[end][static_cast<std::size_t>(force.spring)]; p >= 0)
      out += (end == 0 ? 1 : -1) * force.direction.dot(by_w_.segment<3>(6 * p));
  return out;
}

}  // namespace manycontact::internal
