#include "unit_forces.hpp"

#include <algorithm>
#include <numeric>

#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::internal {

namespace {

int robot_of(const Scene& scene, int coordinate) {
  const auto after = std::upper_bound(scene.robots.begin(), scene.robots.end(), coordinate,
                                      [](int i, const Robot& robot) { return i < robot.idx_v; });
  // Robots without coordinates have the idx_v of the next robot. The last robot of equal idx_v has the coordinate.
  return static_cast<int>(after - scene.robots.begin()) - 1;
}

Scene with_ends(const Scene& scene, std::vector<int> (&push)[2]) {
  Scene out = scene;
  drop_applied_forces(out);
  out.contacts.clear(), out.contact_index.clear();
  for (const Spring& spring : scene.springs)
    for (const int end : {0, 1}) {
      const Attachment& at = end == 0 ? spring.A : spring.B;
      push[end].push_back(at.robot < 0 ? -1 : static_cast<int>(out.wrenches.size()));
      if (at.robot >= 0) out.wrenches.push_back({"", at, ReferenceFrame::kWorld});
    }
  return out;
}

}  // namespace

void find_robot_sets(const Scene& scene, const std::vector<char>& active, bool by_springs, std::vector<int>& first) {
  first.resize(scene.robots.size());
  sparse::UnionFind sets(first);
  const auto join = [&](const Attachment& A, const Attachment& B) {
    if (moves(A) && moves(B)) sets.join(A.robot, B.robot);
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) join(scene.contacts[c].A, scene.contacts[c].B);
  for (std::size_t s = 0; by_springs && s < scene.springs.size(); ++s) join(scene.springs[s].A, scene.springs[s].B);
  for (std::size_t r = 0; r < first.size(); ++r) first[r] = sets.root(static_cast<int>(r));
}

void UnitTorques::find_islands(const Scene& scene, const std::vector<char>& active) {
  find_robot_sets(scene, active, false, islands_);
  for (std::size_t s = 0; s < scene.springs.size(); ++s)
    for (const int end : {0, 1}) {
      const Attachment& at = end == 0 ? scene.springs[s].A : scene.springs[s].B;
      island_of_end_[end][s] = moves(at) ? islands_[at.robot] : -1;
    }
}

void UnitTorques::give_number(UnitForce& force) {
  force.number = count_[force.island]++;
  most_ = std::max(most_, force.number + 1);
}

void UnitTorques::add_forces(int spring, const Vec3<double>& direction, std::vector<UnitForce>& to) {
  const int A = island_of(spring, 0), B = island_of(spring, 1);
  to.push_back({spring, direction, -1, A});
  give_number(to.back());
  if (B < 0 || B == A) return;
  to.push_back({spring, direction, -1, B});
  give_number(to.back());
}

void UnitTorques::add_force(const Scene& scene, int coordinate, std::vector<UnitForce>& to) {
  to.push_back({-1, Vec3<double>::Zero(), coordinate, islands_[robot_of(scene, coordinate)]});
  give_number(to.back());
}

UnitTorques::UnitTorques(const Scene& scene)
    : islands_(scene.robots.size()),
      count_(scene.robots.size(), 0),
      ends_(with_ends(scene, push_)),
      forces_(ends_),
      scratch_(forces_),
      robots_(scene.robots.size()),
      w_(ends_.wrenches.size(), Vec6<double>::Zero()) {
  std::iota(robots_.begin(), robots_.end(), 0);
  for (std::vector<int>& islands : island_of_end_) islands.assign(scene.springs.size(), -1);
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
  std::ranges::fill(w_, Vec6<double>(Vec6<double>::Zero()));
  joints_.setZero();
}

void UnitTorques::add(const UnitForce& force, double amount) {
  if (force.spring < 0) {
    joints_[force.coordinate] += amount;
    return;
  }
  for (const int end : {0, 1})
    if (force.island < 0 || island_of(force.spring, end) == force.island)
      if (const int p = push_[end][force.spring]; p >= 0)
        w_[p].head<3>() += (end == 0 ? amount : -amount) * force.direction;
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
  return force.spring < 0 ? a_[force.coordinate] : along(force.spring, force.direction, force.island);
}

double UnitTorques::along(int spring, const Vec3<double>& direction, int island) const {
  double out = 0;
  for (const int end : {0, 1})
    if (island < 0 || island_of(spring, end) == island)
      if (const int p = push_[end][spring]; p >= 0) out += (end == 0 ? 1 : -1) * direction.dot(by_w_.segment<3>(6 * p));
  return out;
}

}  // namespace manycontact::internal
