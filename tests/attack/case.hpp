#pragma once
// A scene for attacks, as plain numbers. The library reads it as URDF and scene file; the reference uses the numbers.
// Units are SI, coordinates are in the library's order.

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace manycontact::attack {

using Numbers = std::array<double, 3>;

enum class Kind { kRevolute, kPrismatic, kFloating, kPlanar, kFixed };
constexpr int nq_of(Kind k) { return k == Kind::kFloating ? 7 : k == Kind::kPlanar ? 3 : k == Kind::kFixed ? 0 : 1; }
constexpr int nv_of(Kind k) { return k == Kind::kFloating ? 6 : k == Kind::kPlanar ? 3 : k == Kind::kFixed ? 0 : 1; }

struct Link {  // a link and the joint that carries it
  std::string name, joint;
  int parent = -1;  // parent link; -1: the root
  Kind kind = Kind::kRevolute;
  Numbers xyz = {}, rpy = {}, axis = {0, 0, 1};  // placement and axis of the joint in its parent link
  double mass = 0;
  Numbers com = {}, com_rpy = {};
  std::array<double, 6> inertia = {};  // ixx ixy ixz iyy iyz izz about the centre of mass
  double armature = 0;
  std::optional<double> locked;  // fixed at this value
  double stiffness = 0, rest = 0, damping = 0;  // spring and damper in the joint
  // Whether the joint is traversed backwards: xyz, rpy and axis are those of the parent's frame in this link, and q
  // moves the parent. The file contains the joint in this direction, with another root.
  bool reversed = false;
  int iq = -1, iv = -1;          // indices in the tree's q and v; set by number_coordinates

  bool moves() const { return nv_of(kind) > 0 && !locked; }
};

struct Tree {
  std::string urdf;  // path of the tree's file; empty: write_case writes one
  bool floating = false;
  Numbers xyz = {}, rpy = {};  // of a fixed base
  std::vector<Link> links;     // parents first, the root first of all
  std::vector<double> q, v, u;
  int nq = 0, nv = 0;

  int free() const { return floating ? 6 : 0; }  // coordinates of the base, which have no torque
};

struct Hold {      // a contact
  int rows = 3;    // 1, 2, 3, 5, 6
  int tree = 0, link = 0;
  Numbers offset = {};
  std::array<double, 4> turned = {0, 0, 0, 1};  // quaternion xyzw
  int to_tree = -1, to_link = 0;                // -1: the world
  Numbers place = {};                           // B' on that link, or in the world
  std::array<double, 4> place_turned = {0, 0, 0, 1};
  std::string frame = "local";
  Numbers axis = {0, 0, 1};
  double alpha = 0, beta = 0;
};

struct ExternalWrench {
  int tree = 0, link = 0;
  Numbers offset = {}, force = {}, torque = {};
  bool world = false;  // whether it is in the world's axes
};

struct Spring {  // a spring and damper between two points
  int tree = 0, link = 0;
  Numbers offset = {};
  int to_tree = -1, to_link = 0;  // -1: the world
  Numbers place = {};
  double stiffness = 0, length = 0, damping = 0;

  bool directed() const { return length != 0 || damping != 0; }
};

struct Case {
  std::string name;
  Numbers gravity = {0, 0, -9.81};
  double damping = 0;
  std::vector<Tree> trees;
  std::vector<Hold> holds;
  std::vector<ExternalWrench> wrenches;
  std::vector<Spring> springs;

  int nv() const;
  int rows() const;
  int wrench_entries() const { return static_cast<int>(6 * wrenches.size()); }
};

/// Sets iq, iv of all links, nq, nv: depth first, children in the byte order of their joints' names.
void number_coordinates(Tree& tree);

/// Returns the link whose joint moves this one, past fixed and locked joints; -1: none does.
int moving_link(const Tree& tree, int link);

/// Removes what the library refuses: contacts and springs of a body with itself, and elements on immovable bodies only.
void drop_refused(Case& c);

/// Returns the scene file's text; trees that come from no file are named r<k>.urdf in its folder.
std::string scene_text(const Case& c);
std::string urdf_text(const Tree& tree);
/// Writes all files into a folder, which is created; returns the scene's path.
std::string write_case(const Case& c, const std::string& folder);

/// Returns a robot from its URDF, at its neutral state.
Tree read_tree(const std::string& urdf, bool floating);

/// Dimensions of hostility, which can be combined.
inline const std::vector<std::string> kDimensions = {
    "mass",  "massless", "armature", "lock",   "fast",      "force", "still",   "posture", "gravity", "weightless",
    "many",  "pairs",    "multi",    "gains",  "drift",     "near",  "damping", "units",   "mixed",   "redundant",
    "joint", "chain",    "exact",    "lever",  "push",      "spring", "joint_spring", "damper", "root", "herd", "pile"};
Case random_case(std::uint64_t seed, const std::vector<std::string>& dimensions);
/// Draws up to three of the given dimensions with the seed.
std::vector<std::string> draw_dimensions(std::uint64_t seed, const std::vector<std::string>& from);

/// Returns mechanisms of the literature, closed by one contact with redundant rows: a parallelogram of four bars,
/// Bennett's four hinges in space, Bricard's six on the edges of a cube.
std::vector<Case> published_mechanisms();

/// Returns a robot with its frames fixed, in a random configuration near neutral: at rest, or moving for an impact.
Case random_posture(std::uint64_t seed, const Tree& robot, const std::vector<std::string>& frames, int rows,
                    double velocity);

}  // namespace manycontact::attack
