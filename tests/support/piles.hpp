#pragma once
// Many free bodies coupled by contacts, made in code: towers, tables, pyramids, grids, walls.

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "support/random.hpp"

namespace manycontact::test {

using Pile = RandomScene;

class PileMaker {
 public:
  PileMaker() {
    Model model;
    model.name = "box";
    model.floating_base = true;
    Joint joint;
    joint.name = "base";
    joint.type = JointType::kFloating;
    joint.inertia = Inertia<double>::from_com(9, Vec3<double>::Zero(), Vec3<double>(1, 1.1, 1.2).asDiagonal());
    for (Eigen::VectorXd* limit : {&joint.lower, &joint.upper, &joint.velocity_limit, &joint.effort_limit})
      limit->setConstant(joint.nv(), INFINITY);
    model.joints.push_back(std::move(joint));
    finalize(model);
    box_ = std::make_shared<const Model>(std::move(model));
  }

  /// Adds a box of unit edges; returns its number.
  int box(double x, double y, double z) {
    places_.push_back({x, y, z});
    add_robot(pile_.scene, "box" + std::to_string(places_.size()), box_);
    return static_cast<int>(places_.size()) - 1;
  }
  /// Adds a contact between box a and box b, or the ground (-1), at a point of the world.
  void join(ContactType type, int a, int b, const Vec3<double>& at) {
    Contact c;
    c.name = "contact" + std::to_string(pile_.scene.contacts.size());
    c.type = type;
    c.A.robot = a;
    c.A.joint = 0;
    c.A.placement.p = at - places_[a];
    c.B.placement.p = at;
    if (b >= 0) {
      c.B.robot = b;
      c.B.joint = 0;
      c.B.placement.p = at - places_[b];
    }
    add_contact(pile_.scene, c);
  }
  /// Returns all boxes at their places, in motion unless speed is 0.
  Pile finish(double speed = 0.1) {
    std::mt19937 rng(11);
    std::uniform_real_distribution<double> noise(-speed, speed);
    pile_.q.setZero(pile_.scene.nq);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      pile_.q.segment<3>(pile_.scene.robots[k].idx_q) = places_[k];
      pile_.q[pile_.scene.robots[k].idx_q + 6] = 1;
    }
    pile_.v = Eigen::VectorXd::NullaryExpr(pile_.scene.nv, [&] { return noise(rng); });
    pile_.u.setZero(pile_.scene.nu);
    return std::move(pile_);
  }

 private:
  std::shared_ptr<const Model> box_;
  std::vector<Vec3<double>> places_;
  Pile pile_;
};

/// Returns boxes welded one on the other, the lowest to the ground.
inline Pile tower(int boxes, double speed = 0.1) {
  PileMaker make;
  for (int i = 0; i < boxes; ++i) {
    make.box(0, 0, i);
    make.join(ContactType::k6D, i, i - 1, {0, 0, i - 0.5});
  }
  return make.finish(speed);
}

/// Returns boxes welded on one box, which is welded to the ground.
inline Pile table(int boxes, double speed = 0.1) {
  PileMaker make;
  make.box(0, 0, 0);
  make.join(ContactType::k6D, 0, -1, {0, 0, -0.5});
  const int side = static_cast<int>(std::ceil(std::sqrt(boxes)));
  for (int i = 1; i <= boxes; ++i) {
    make.box(i % side, i / side, 1);
    make.join(ContactType::k6D, i, 0, {1.0 * (i % side), 1.0 * (i / side), 0.5});
  }
  return make.finish(speed);
}

/// Returns rows of boxes, each welded to the two below, the lowest row to the ground.
inline Pile pyramid(int rows, double speed = 0.1) {
  PileMaker make;
  std::vector<int> below;
  for (int r = 0; r < rows; ++r) {
    std::vector<int> row;
    for (int i = 0; i < rows - r; ++i) {
      const double x = i + 0.5 * r;
      row.push_back(make.box(x, 0, r));
      if (r == 0) make.join(ContactType::k6D, row.back(), -1, {x, 0, -0.5});
      for (int d = 0; r > 0 && d < 2; ++d)
        make.join(ContactType::k6D, row.back(), below[i + d], {x + (d == 0 ? -0.25 : 0.25), 0, r - 0.5});
    }
    below = row;
  }
  return make.finish(speed);
}

/// Returns n x n boxes in a plane, coupled to their neighbours; the corner or the lowest row is welded to the ground.
inline Pile grid(int n, ContactType type, bool row_welded, double speed = 0.1) {
  PileMaker make;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int box = make.box(i, 0, j);
      if (j == 0 && (row_welded || i == 0)) make.join(ContactType::k6D, box, -1, {1.0 * i, 0, -0.5});
      if (j > 0) make.join(type, box, box - 1, {1.0 * i, 0, j - 0.5});
      if (i > 0) make.join(type, box, box - n, {i - 0.5, 0, 1.0 * j});
    }
  return make.finish(speed);
}

/// Returns n x n boxes at uneven places in a plane, each coupled to its neighbours by points of this plane, the lowest
/// row welded to the ground: rows depend on each other with coefficients of any size.
inline Pile uneven_wall(int n, double speed = 0.1) {
  PileMaker make;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  std::vector<Vec3<double>> places;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3<double> at(i + noise(rng), 0, j + noise(rng));
      places.push_back(at);
      const int box = make.box(at[0], at[1], at[2]);
      if (j == 0) make.join(ContactType::k6D, box, -1, {at[0], 0, -0.5});
      if (j > 0) make.join(ContactType::k3D, box, box - 1, 0.5 * (at + places[box - 1]));
      if (i > 0) make.join(ContactType::k3D, box, box - n, 0.5 * (at + places[box - n]));
    }
  return make.finish(speed);
}

/// Returns n x n boxes welded to one box, their hub, and each to its neighbours.
inline Pile hub(int n, double speed = 0.1) {
  PileMaker make;
  make.box(0, 0, 0);
  make.join(ContactType::k6D, 0, -1, {0, 0, -0.5});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int box = make.box(i, j, 1);
      make.join(ContactType::k6D, box, 0, {1.0 * i, 1.0 * j, 0.5});
      if (j > 0) make.join(ContactType::k6D, box, box - 1, {1.0 * i, j - 0.5, 1});
      if (i > 0) make.join(ContactType::k6D, box, box - n, {i - 0.5, 1.0 * j, 1});
    }
  return make.finish(speed);
}

/// Returns boxes near a grid of a plane or of space, coupled to neighbours and some others by points, welds, four
/// points a face, or all contact types; some bonds are left out. They are in motion or at rest, rotated or not.
inline Pile random_pile(unsigned seed) {
  std::mt19937 rng(seed);
  const auto number = [&rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
  };
  const auto integer = [&rng](int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); };
  const bool in_space = integer(0, 4) == 0, in_plane = integer(0, 1) == 0;
  const int side = in_space ? integer(3, 4) : integer(4, 9), boxes = in_space ? side * side * side : side * side;
  const double noise = integer(0, 2) > 0 ? number(0, 0.3) : 0;
  PileMaker make;
  std::vector<Vec3<double>> at;
  for (int k = 0; k < boxes; ++k) {
    const double x = number(-noise, noise), y = number(-noise, noise), z = number(-noise, noise);
    at.emplace_back(k % side + x, in_space ? k / (side * side) + y : in_plane ? 0 : y, k / side % side + z);
    make.box(at.back()[0], at.back()[1], at.back()[2]);
  }
  constexpr ContactType kTypes[] = {ContactType::k3D, ContactType::k6D, ContactType::k1D, ContactType::k2D};
  const int kind = integer(0, 3), type = integer(0, 2) > 0 ? 0 : 1;
  const double left_out = integer(0, 1) > 0 ? number(0, 0.4) : 0, others = number(0, 0.3);
  const auto join = [&](int a, int b) {
    const Vec3<double> middle = 0.5 * (at[a] + at[b]);
    if (kind == 2)
      for (const double x : {-0.2, 0.2})
        for (const double y : {-0.2, 0.2}) make.join(ContactType::k3D, a, b, middle + Vec3<double>(x, y, 0));
    else
      make.join(kTypes[kind == 3 ? integer(0, 3) : type], a, b, middle);
  };
  for (int k = 0; k < boxes; ++k) {
    const int i = k % side, j = k / side % side, l = k / (side * side);
    if (j == 0 && (k == 0 || integer(0, 3) > 0))
      make.join(integer(0, 1) > 0 ? ContactType::k6D : ContactType::k3D, k, -1, at[k] - Vec3<double>(0, 0, 0.5));
    if (j > 0 && number(0, 1) >= left_out) join(k, k - side);
    if (i > 0 && number(0, 1) >= left_out) join(k, k - 1);
    if (l > 0 && number(0, 1) >= left_out) join(k, k - side * side);
    if (number(0, 1) < others)
      if (const int other = integer(0, boxes - 1); other != k) join(k, other);
  }
  Pile pile = make.finish(integer(0, 1) > 0 ? 0.1 : 0);
  if (integer(0, 2) > 0) return pile;
  for (const Robot& box : pile.scene.robots) {
    const auto small = [&] { return Vec3<double>(number(-1, 1), number(-1, 1), number(-1, 1)); };
    const Vec3<double> moved = small(), turned = small();
    pile.q.segment<3>(box.idx_q) += 0.1 * moved;
    pile.q.segment<4>(box.idx_q + 3) =
        Eigen::Quaterniond(1, 0.2 * turned[0], 0.2 * turned[1], 0.2 * turned[2]).normalized().coeffs();
  }
  return pile;
}

}  // namespace manycontact::test
