#include "support/random.hpp"

#include <Eigen/QR>
#include <cmath>
#include <numbers>
#include <string>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact::test {

double uniform(std::mt19937& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

bool chance(std::mt19937& rng, double probability) { return uniform(rng, 0, 1) < probability; }

namespace {

int pick(std::mt19937& rng, int n) { return std::uniform_int_distribution<int>(0, n - 1)(rng); }

template <class T>
const T& pick(std::mt19937& rng, const std::vector<T>& from) {
  return from[pick(rng, static_cast<int>(from.size()))];
}

Vec3<double> random_point(std::mt19937& rng, double reach) {
  Vec3<double> p;
  for (double& x : p) x = uniform(rng, -reach, reach);
  return p;
}

Eigen::Vector4d random_quaternion(std::mt19937& rng) { return random_vector(4, rng).normalized(); }

// Returns a parent of the next joint: the last joint or one of its ancestors, which numbers the tree depth first.
int random_parent(const Model& model, std::mt19937& rng, double branching) {
  int parent = model.njoints() - 1;
  if (parent < 0 || !chance(rng, branching)) return parent;
  std::vector<int> ancestors;
  const int base = model.floating_base ? 0 : -1;
  while (parent > base) ancestors.push_back(parent = model.joints[parent].parent);
  return ancestors.empty() ? model.njoints() - 1 : pick(rng, ancestors);
}

}  // namespace

Eigen::VectorXd random_vector(int n, std::mt19937& rng, double size) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(n);
  for (double& xi : x) xi = size * normal(rng);
  return x;
}

Mat3<double> random_rotation(std::mt19937& rng) {
  const Eigen::Vector4d q = random_quaternion(rng);
  return rotation_of_quaternion<double>(q[0], q[1], q[2], q[3]);
}

SE3<double> random_placement(std::mt19937& rng, double reach) {
  const Mat3<double> R = random_rotation(rng);
  return {R, random_point(rng, reach)};
}

Inertia<double> random_inertia(std::mt19937& rng) {
  const double mass = uniform(rng, 0.5, 3);
  Vec3<double> sides2;
  for (double& s : sides2) s = std::pow(uniform(rng, 0.1, 0.5), 2);
  const Mat3<double> R = random_rotation(rng);
  const Vec3<double> principal = mass / 12 * (sides2.sum() - sides2.array());
  return Inertia<double>::from_com(mass, random_point(rng, 0.2), R * principal.asDiagonal() * R.transpose());
}

Model random_model(std::mt19937& rng, const ModelOptions& options) {
  Model model;
  model.name = "random";
  model.floating_base = options.floating_base;
  for (int i = 0; i < options.njoints; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.inertia = random_inertia(rng);
    joint.parent = random_parent(model, rng, options.branching);
    if (i == 0 && options.floating_base) {
      joint.type = JointType::kFloating;
    } else {
      joint.type = pick(rng, options.types);
      joint.placement = random_placement(rng);
      if (chance(rng, options.plain_placements)) joint.placement.R.setIdentity();
      joint.axis = chance(rng, options.coordinate_axes) ? Vec3<double>(Vec3<double>::Unit(pick(rng, 3)))
                                                        : Vec3<double>(random_vector(3, rng).normalized());
    }
    Frame& frame = model.frames.emplace_back();
    frame.name = "link" + std::to_string(i);
    frame.joint = i;
    model.joints.push_back(std::move(joint));
  }
  for (Joint& joint : model.joints)
    if (options.passive > 0) joint.actuated = !chance(rng, options.passive);
  finalize(model);
  for (int i = model.first_actuated(); i < model.nv && options.armature > 0; ++i)
    model.armature[i] = uniform(rng, 0, options.armature);
  if (options.friction > 0) {
    model.damping = options.friction * random_vector(model.nv, rng).cwiseAbs();
    model.friction = options.friction * random_vector(model.nv, rng).cwiseAbs();
  }
  return model;
}

Eigen::VectorXd random_configuration(const Model& model, std::mt19937& rng) {
  Eigen::VectorXd q(model.nq);
  for (const Joint& joint : model.joints) {
    switch (joint.type) {
      case JointType::kRevolute:
        q[joint.idx_q] = uniform(rng, -std::numbers::pi, std::numbers::pi);
        break;
      case JointType::kPrismatic:
        q[joint.idx_q] = uniform(rng, -0.4, 0.4);
        break;
      case JointType::kFloating:
        q.segment<3>(joint.idx_q) = random_point(rng, 0.4);
        q.segment<4>(joint.idx_q + 3) = random_quaternion(rng);
        break;
      case JointType::kPlanar:
        q.segment<2>(joint.idx_q) = random_point(rng, 0.4).head<2>();
        q[joint.idx_q + 2] = uniform(rng, -std::numbers::pi, std::numbers::pi);
        break;
    }
  }
  return q;
}

namespace {

// Whether rows are independent by a wide margin. With random numbers other rows are rare.
bool full_rank(const Eigen::MatrixXd& J) {
  if (J.rows() > J.cols()) return false;
  const Eigen::VectorXd diagonal = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(J.transpose()).matrixQR().diagonal();
  return J.rows() == 0 || diagonal.cwiseAbs().minCoeff() > 0.02 * diagonal.cwiseAbs().maxCoeff();
}

ModelOptions random_model_options(std::mt19937& rng, const SceneOptions& scene) {
  ModelOptions options;
  options.passive = scene.passive;
  options.friction = scene.friction;
  options.njoints = 4 + pick(rng, 6);
  options.floating_base = chance(rng, 0.6);
  options.armature = chance(rng, 0.5) ? 0.1 : 0;
  return options;
}

void add_robots(std::mt19937& rng, const SceneOptions& options, RandomScene& s) {
  std::shared_ptr<const Model> model;
  for (int r = 0; r < options.nrobots; ++r) {
    const bool again = model && chance(rng, options.same_model) && options.models.empty();
    const ModelOptions of =
        options.models.empty() ? random_model_options(rng, options) : options.models[r % options.models.size()];
    if (!again) model = std::make_shared<Model>(random_model(rng, of));
    const SE3<double> base{random_rotation(rng), Vec3<double>(2 * r, 0, 1) + random_point(rng, 0.5)};
    const int number = add_robot(s.scene, "r" + std::to_string(r), model, base);
    const Robot& robot = s.scene.robots[number];
    s.q.conservativeResize(s.scene.nq);
    s.q.tail(model->nq) = random_configuration(*model, rng);
    if (model->floating_base) s.q.segment<3>(robot.idx_q) += base.p;
  }
  s.v = random_vector(s.scene.nv, rng);
  s.u = random_vector(s.scene.nu, rng, 5);
}

// Returns a body of the robot, or its fixed base if `or_base`.
Attachment random_attachment(const Scene& scene, int robot, bool or_base, std::mt19937& rng) {
  const Model& model = *scene.robots[robot].model;
  const bool base = or_base && !model.floating_base && chance(rng, 0.3);
  return {robot, base ? -1 : pick(rng, model.njoints()), random_placement(rng, 0.2)};
}

// Returns a body other than A's: of its own robot, or of another.
Attachment random_partner(const Scene& scene, const Attachment& A, std::mt19937& rng) {
  int robot = A.robot;
  if (scene.nrobots() > 1 && chance(rng, 0.5)) robot = (robot + 1 + pick(rng, scene.nrobots() - 1)) % scene.nrobots();
  return random_attachment(scene, robot, true, rng);
}

Contact random_contact(const RandomScene& s, const SceneOptions& options, std::mt19937& rng) {
  Contact c;
  c.name = "contact" + std::to_string(s.scene.contacts.size());
  c.type = pick(rng, options.types);
  c.reference_frame = pick(rng, options.frames);
  if (c.type == ContactType::k5D) c.reference_frame = ReferenceFrame::kLocal;
  c.axis = random_vector(3, rng).normalized();
  const bool on_body = chance(rng, options.between_bodies);
  c.A = random_attachment(s.scene, pick(rng, s.scene.nrobots()), on_body, rng);
  if (!s.scene.contacts.empty() && chance(rng, options.same_link)) {
    c.A.robot = s.scene.contacts.back().A.robot;
    c.A.joint = s.scene.contacts.back().A.joint;
  }
  if (on_body) c.B = random_partner(s.scene, c.A, rng);
  resolve_reference(s.scene, s.q, true, true, c);
  if (options.errors) {
    const double angle = uniform(rng, 0, 1.5);
    Vec6<double> error;
    error << random_point(rng, 0.2), angle * random_vector(3, rng).normalized();
    c.B.placement = c.B.placement * exp6<double>(error);
  }
  if (chance(rng, options.gains)) c.alpha = uniform(rng, 1, 50), c.beta = uniform(rng, 1, 15);
  return c;
}

// Returns a contact with the same equations, perhaps in other axes.
Contact repeated(const Contact& c, int number) {
  Contact copy = c;
  copy.name = "repeated" + std::to_string(number);
  if (c.type == ContactType::k3D || c.type == ContactType::k6D)
    copy.reference_frame =
        c.reference_frame == ReferenceFrame::kLocal ? ReferenceFrame::kWorld : ReferenceFrame::kLocal;
  return copy;
}

}  // namespace

RandomScene random_scene(std::mt19937& rng, const SceneOptions& options) {
  RandomScene s;
  s.scene.name = "random";
  s.scene.damping = options.damping;
  add_robots(rng, options, s);
  for (int tried = 0; tried < options.ncontacts; ++tried) {
    const Contact c = random_contact(s, options, rng);
    if (c.A.robot == c.B.robot && c.A.joint == c.B.joint) continue;
    if (c.A.joint < 0 && c.B.joint < 0) continue;
    Scene larger = s.scene;
    add_contact(larger, c);
    if (full_rank(contact_jacobian(larger, s.q))) s.scene = std::move(larger);
  }
  const int independent = static_cast<int>(s.scene.contacts.size());
  for (int k = 0; k < options.redundant + options.contradicting && independent > 0; ++k) {
    Contact c = repeated(s.scene.contacts[pick(rng, independent)], k);
    if (k >= options.redundant) {  // requests another acceleration for the same motion
      c.alpha += 10;
      c.B.placement.p += Vec3<double>(0.1, 0.1, 0.1);
    }
    add_contact(s.scene, c);
  }
  return s;
}

}  // namespace manycontact::test
