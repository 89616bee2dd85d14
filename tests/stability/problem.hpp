#pragma once
// A scene and a state to solve, and functions that build them.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "manycontact/model/scene.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::test {

/// A second truth: the same solution, known from another problem in other units for each entry.
struct KnownAnswer {
  VecX<Quad> a, f;
  Eigen::VectorXd a_unit, f_unit;  // data.a / a_unit is comparable with a
};

struct Problem {
  Scene scene;
  Eigen::VectorXd q, v, u;
  std::optional<KnownAnswer> known;
  bool only_known =
      false;  // the known solution is the truth: this problem's own rounding hides it even from quadruple precision
  bool answerable = true;  // false: any number in a solution is wrong
};

/// Returns a robot of models/, joints bent away from symmetry, at rest, with torques of a few N m.
Problem robot(const std::string& urdf, bool floating);
/// Returns robot "a" fixed or floating, and robot "b" floating, 1 m from it.
Problem two_robots(const std::string& urdf_a, bool floating_a, const std::string& urdf_b);
/// Returns n links of 1 kg and 0.3 m on revolute joints whose axes alternate between y and x, with frames "link<i>" at
/// the hinges and "tip" at the end. It is bent a little and at rest.
Problem chain(int n, bool floating);
/// Returns n links hinged about z in the xy plane, a regular polygon's first sides.
Problem planar_chain(int n);

/// Fixes a frame of robot r ("r" if there is one) where it is, with an offset on its link. Returns the contact.
Contact& hold(Problem& p, ContactType type, const std::string& frame, const Vec3<double>& offset = {0, 0, 0},
              ReferenceFrame axes = ReferenceFrame::kLocal, const std::string& robot = "r");
/// Ties frame A to frame B' on another body, as they are.
Contact& tie(Problem& p, ContactType type, const std::string& robot_a, const std::string& frame_a,
             const std::string& robot_b, const std::string& frame_b, const Vec3<double>& offset = {0, 0, 0},
             ReferenceFrame axes = ReferenceFrame::kLocal);

/// Sets random velocities of this size.
void move(Problem& p, double size = 0.3);
/// Returns the same problem rotated in the world: robot, gravity, references and all. Its solution is that of `p`, and
/// a zero of `p`'s J is a rounding error here. Bases are fixed; contacts with the world are in local axes.
Problem turned(Problem p);
/// Sets velocities that all contacts allow.
void move_within_contacts(Problem& p, double size = 0.3);
/// Puts one joint of robot r at an angle.
void bend(Problem& p, const std::string& joint, double angle);
void edit(Problem& p, const std::function<void(Model&)>& change, int robot = 0);
void scale(Inertia<double>& Y, double factor);

}  // namespace manycontact::test
