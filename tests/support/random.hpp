#pragma once
// Seeded random robots, states and scenes with moderate numbers: well-posed problems are well conditioned, too.

#include <limits>
#include <random>
#include <vector>

#include "manycontact/contact/jacobian.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double uniform(std::mt19937& rng, double low, double high);
bool chance(std::mt19937& rng, double probability);
/// Returns normally distributed entries, times `size`.
Eigen::VectorXd random_vector(int n, std::mt19937& rng, double size = 1);
Mat3<double> random_rotation(std::mt19937& rng);
/// Returns any rotation; the origin is within `reach` in each coordinate.
SE3<double> random_placement(std::mt19937& rng, double reach = 0.4);
/// Returns the inertia of a rotated box with an off-centre centre of mass.
Inertia<double> random_inertia(std::mt19937& rng);

struct ModelOptions {
  int njoints = 6;  // a floating base included
  bool floating_base = false;
  // One type is drawn for each joint; a type that is listed twice is drawn twice as often.
  std::vector<JointType> types = {JointType::kRevolute, JointType::kRevolute,  JointType::kRevolute,
                                  JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar,
                                  JointType::kFloating};
  double coordinate_axes = 0.5;   // chance that an axis is +x, +y or +z
  double plain_placements = 0.2;  // chance that a joint's placement does not rotate
  double branching = 0.3;         // chance that a joint's parent is an ancestor of the previous joint, not this itself
  double armature = 0;            // the largest armature; each coordinate but a floating base's has one
  double passive = 0;             // chance that a joint has no torque
  double friction = 0;            // the largest damping and friction; each coordinate has some if this is not 0
};

/// Returns a tree of random joints; frame "link<i>" is the child frame of joint i.
Model random_model(std::mt19937& rng, const ModelOptions& options = {});

/// Returns angles within +-pi, displacements within +-0.4, any orientation (unit quaternions).
Eigen::VectorXd random_configuration(const Model& model, std::mt19937& rng);

struct SceneOptions {
  int nrobots = 3;
  std::vector<ModelOptions> models = {};  // models of the robots, in turn; empty: each robot differs
  double same_model = 0.2;                // chance that a robot shares the previous robot's model, if `models` is empty
  int ncontacts = 8;                      // number tried; those that depend (nearly) on earlier ones are left out
  std::vector<ContactType> types = {ContactType::k1D, ContactType::k2D, ContactType::k3D, ContactType::k5D,
                                    ContactType::k6D};  // 5D in local axes
  std::vector<ReferenceFrame> frames = {ReferenceFrame::kLocal, ReferenceFrame::kWorld,
                                        ReferenceFrame::kLocalWorldAligned};
  double between_bodies = 0.5;  // chance that B' is on a body: as often of A's own robot (a loop) as of another
  double same_link = 0.3;       // chance that A is on the link of the contact before
  bool errors = true;           // A is off B' by up to 0.2 and an angle of up to 1.5
  double gains = 0.6;           // chance that a contact has gains
  double damping = 0;
  double passive = 0, friction = 0;  // as in the models, if these are not given
  // Contacts added at the end depend on others: consistent repetitions, and inconsistent ones.
  int redundant = 0, contradicting = 0;
};

/// A scene and a state of it. u: torques of the actuated coordinates.
struct RandomScene {
  Scene scene;
  Eigen::VectorXd q, v, u;  // nq, nv, nu
};

/// Returns robots 2 m apart at random places. Without redundant and contradicting contacts J has full rank.
RandomScene random_scene(std::mt19937& rng, const SceneOptions& options = {});

}  // namespace manycontact::test
