#include <numeric>

#include "task_parts.hpp"

namespace manycontact::io {

namespace {

bool needs_contact(TaskResidual r) {
  return r == TaskResidual::kContactForce || r == TaskResidual::kFrictionCone || r == TaskResidual::kWrenchCone ||
         r == TaskResidual::kCop;
}

bool needs_frame(TaskResidual r) {
  return r == TaskResidual::kFramePlacement || r == TaskResidual::kFrameTranslation ||
         r == TaskResidual::kFrameRotation || r == TaskResidual::kFrameVelocity;
}

// A terminal node has a state, and neither controls nor accelerations nor forces.
double read_positive(const Element& e, const char* attribute) {
  const double x = e.required_number(attribute);
  if (!(x > 0)) e.where(attribute).fail(e.label(attribute) + " is " + show(x) + ", expected a number above 0");
  return x;
}

}  // namespace

}  // namespace manycontact::io

namespace manycontact {

bool of_state_alone(TaskResidual r) {
  return r == TaskResidual::kState || r == TaskResidual::kCom || r == TaskResidual::kCentroidalMomentum ||
         io::needs_frame(r);
}

}  // namespace manycontact

namespace manycontact::io {

TaskTerm TermReader::read(const Element& e, const std::vector<bool>& active, bool terminal) {
  const bool cost = e.name() == "cost";
  if (cost)
    e.allow_attributes({"name", "type", "weight", "activation", "weights", "lower", "upper", "eps", "robot",
                        "reference", "frame", "xyz", "quat_xyzw", "reference_frame", "twist", "contact", "mu", "normal",
                        "box"});
  else
    e.allow_attributes({"name", "type", "lower", "upper", "robot", "reference", "frame", "xyz", "quat_xyzw",
                        "reference_frame", "twist", "contact", "mu", "normal", "box"});
  e.allow_children({"pose"});
  TaskTerm term;
  term.line = e.line();
  term.name = e.required("name");
  if (term.name.empty()) e.where("name").fail(e.label("name") + " is empty, expected a name");
  term.residual = read_residual(e);
  check_attributes(e, term.residual);
  if (terminal && !of_state_alone(term.residual))
    e.where("type").fail(std::string(to_string(term.residual)) +
                         " in <terminal>, where there are neither controls nor accelerations nor forces, expected a " +
                         e.name() + " of the state");
  if (needs_contact(term.residual))
    read_contact(e, active, term);
  else
    read_subject(e, term);
  term.nr = rows(term);
  read_numbers(e, term);
  if (cost)
    read_activation(e, term);
  else
    read_bounds(e, term);
  return term;
}

void TermReader::read_subject(const Element& e, TaskTerm& term) {
  if (!needs_frame(term.residual)) return read_robots(e, term);
  const End end = ends_.read(e, "frame");
  if (end.shifted)
    e.where("frame").fail(e.label("frame") + " is " + quote(e.required("frame")) + ", expected it without +k or -k");
  term.frame = end.frame.name;
  term.copied = end.copied;
  term.robots.resize(static_cast<std::size_t>(end.count));
  std::iota(term.robots.begin(), term.robots.end(), end.first);
}

void TermReader::read_robots(const Element& e, TaskTerm& term) const {
  if (!e.has("robot")) return;
  const std::string name = e.required("robot");
  const End end = ends_.robot(e, "robot", name);
  if (end.shifted) e.where("robot").fail(e.label("robot") + " is " + quote(name) + ", expected it without +k or -k");
  term.copied = end.copied;
  term.robots.resize(static_cast<std::size_t>(end.count));
  std::iota(term.robots.begin(), term.robots.end(), end.first);
}

std::vector<int> TermReader::contacts(const Where& where, const std::string& what, const std::string& name) const {
  std::vector<std::string> known;
  for (const ContactGroup& group : scene_.contact_groups) {
    if (group.name == name) {
      std::vector<int> all(static_cast<std::size_t>(group.count));
      std::iota(all.begin(), all.end(), group.first);
      return all;
    }
    known.push_back(group.name);
  }
  const auto one = scene_.scene.contact_index.find(name);
  if (one != scene_.scene.contact_index.end()) return {one->second};
  if (known.empty()) where.fail(what + ": there is no contact " + quote(name) + ", the scene has none");
  where.fail(what + ": there is no contact " + quote(name) + ", " + suggestion(name, known));
}

void TermReader::read_contact(const Element& e, const std::vector<bool>& active, TaskTerm& term) const {
  const std::string name = e.required("contact");
  const Where here = e.where("contact");
  term.contacts = contacts(here, e.label("contact"), name);
  for (const ContactGroup& group : scene_.contact_groups)
    term.copied = term.copied || (group.copied && group.name == name);
  for (const int c : term.contacts)
    if (!active[static_cast<std::size_t>(c)])
      here.fail(e.label("contact") + ": " + quote(name) + " is not active in this phase, expected one of its contacts");
  if (term.contacts.empty()) here.fail(e.label("contact") + ": " + quote(name) + " has no copies, expected some");
  const ContactType type = scene_.scene.contacts[static_cast<std::size_t>(term.contacts[0])].type;
  const bool wrench = term.residual == TaskResidual::kWrenchCone || term.residual == TaskResidual::kCop;
  if (wrench && type != ContactType::k6D)
    here.fail(std::string(to_string(term.residual)) + " of contact " + quote(name) + ", of type " + to_string(type) +
              ", expected a 6d contact");
}

int TermReader::rows(const TaskTerm& term) const {
  const Scene& scene = scene_.scene;
  const Model* model =
      term.robots.empty() ? nullptr : scene.robots[static_cast<std::size_t>(term.robots[0])].model.get();
  const int nv = model ? model->nv : scene.nv, nu = model ? model->nu() : scene.nu;
  switch (term.residual) {
    case TaskResidual::kState:
      return 2 * nv;
    case TaskResidual::kControl:
    case TaskResidual::kJointEffort:
      return nu;
    case TaskResidual::kJointAcceleration:
      return nv;
    case TaskResidual::kCom:
    case TaskResidual::kFrameTranslation:
    case TaskResidual::kFrameRotation:
      return 3;
    case TaskResidual::kCentroidalMomentum:
    case TaskResidual::kFramePlacement:
    case TaskResidual::kFrameVelocity:
      return 6;
    case TaskResidual::kContactForce:
      return scene.contacts[static_cast<std::size_t>(term.contacts[0])].rows();
    case TaskResidual::kFrictionCone:
      return 5;
    case TaskResidual::kWrenchCone:
      return 17;
    case TaskResidual::kCop:
      return 4;
    case TaskResidual::kControlGrav:
    case TaskResidual::kContactControlGrav:
      return scene.nv;
  }
  return 0;
}

int TermReader::reference_size(const TaskTerm& term) const {
  if (term.residual != TaskResidual::kState) return term.nr;
  const Scene& scene = scene_.scene;
  if (term.robots.empty()) return scene.nq + scene.nv;
  const Model& model = *scene.robots[static_cast<std::size_t>(term.robots[0])].model;
  return model.nq + model.nv;
}

// Quaternions of floating joints in a state.
void TermReader::normalise_bases(const Element& e, TaskTerm& term) const {
  const Scene& scene = scene_.scene;
  const auto normalise = [&](const Model& model, int first) {
    for (const Joint& joint : model.joints)
      if (joint.type == JointType::kFloating)
        normalise_quaternion(e.where("reference"),
                             "the quaternion of joint " + quote(joint.name) + " in " + e.label("reference"),
                             term.reference.segment<4>(first + joint.idx_q + 3));
  };
  if (!term.robots.empty()) return normalise(*scene.robots[static_cast<std::size_t>(term.robots[0])].model, 0);
  for (const Robot& robot : scene.robots) normalise(*robot.model, robot.idx_q);
}

void TermReader::read_reference(const Element& e, const char* attribute, TaskTerm& term) {
  const auto pose = e.child("pose");
  if (term.residual == TaskResidual::kState && e.optional(attribute, "") == "pose") {
    if (!pose) e.where(attribute).fail(e.label(attribute) + " is pose, expected <pose> elements in it");
    for (auto next = pose; next; next = next->next("pose")) read_pose(*next, scene_.scene, ends_, term.poses);
    return;
  }
  if (pose) pose->fail("<pose> in a <" + e.name() + "> without reference=\"pose\", expected one of type state with it");
  if (!e.has(attribute)) return;
  const auto list = parse_numbers(e.where(attribute), e.label(attribute), e.required(attribute),
                                  static_cast<std::size_t>(reference_size(term)));
  term.reference = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  if (term.residual == TaskResidual::kState) normalise_bases(e, term);
}

void TermReader::read_numbers(const Element& e, TaskTerm& term) {
  const TaskResidual r = term.residual;
  if (r == TaskResidual::kCom) (void)e.required("reference");
  read_reference(e, r == TaskResidual::kFrameVelocity ? "twist" : "reference", term);
  if (r == TaskResidual::kFramePlacement || r == TaskResidual::kFrameTranslation) {
    (void)e.required("xyz");
    term.placement.p = Vec3<double>(e.numbers<3>("xyz")->data());
  }
  if (r == TaskResidual::kFramePlacement || r == TaskResidual::kFrameRotation) {
    (void)e.required("quat_xyzw");
    (void)read_quaternion(e, "quat_xyzw", term.placement.R);
  }
  if (r == TaskResidual::kFrameVelocity)
    term.reference_frame =
        static_cast<ReferenceFrame>(e.choice("reference_frame", {"local", "world", "local_world_aligned"}, 0));
  if (r == TaskResidual::kFrictionCone || r == TaskResidual::kWrenchCone) term.mu = read_positive(e, "mu");
  if (const auto normal = e.numbers<3>("normal")) {
    term.normal = Vec3<double>(normal->data());
    if (!(term.normal->stableNorm() > kZeroDirection))
      e.where("normal").fail(e.label("normal") + " is zero, expected a direction");
  }
  if (r == TaskResidual::kWrenchCone || r == TaskResidual::kCop) {
    (void)e.required("box");
    term.box = Eigen::Vector2d(e.numbers<2>("box")->data());
    if (!(term.box.minCoeff() > 0))
      e.where("box").fail(e.label("box") + " has a side of " + show(term.box.minCoeff()) +
                          ", expected numbers above 0");
  }
}

}  // namespace manycontact::io
