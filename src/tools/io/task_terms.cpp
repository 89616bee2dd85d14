#include <numeric>

#include "task_parts.hpp"

namespace manycontact::io {

TaskTerm TermReader::read(const Element& e, const std::vector<bool>& active, bool terminal) {
  const bool cost = e.name() == "cost";
  if (cost)
    e.allow({"name", "type", "weight", "activation", "weights", "lower", "upper", "eps", "robot", "reference", "frame",
             "xyz", "quat_xyzw", "reference_frame", "twist", "contact", "mu", "normal", "box"},
            {"pose"});
  else
    e.allow({"name", "type", "lower", "upper", "robot", "reference", "frame", "xyz", "quat_xyzw", "reference_frame",
             "twist", "contact", "mu", "normal", "box"},
            {"pose"});
  TaskTerm term;
  term.line = e.line();
  term.name = e.not_empty("name");
  term.residual = read_residual(e);
  check_attributes(e, term.residual);
  if (terminal && !of_state_alone(term.residual))
    e.where("type").fail(std::string(to_string(term.residual)) +
                         " is in <terminal>, which has no controls, accelerations or forces, expected a " + e.name() +
                         " of the state");
  if (takes(term.residual, "contact"))
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

// Reads the attribute `frame` of a frame residual; for other residuals the attribute `robot`, if it is given.
void TermReader::read_subject(const Element& e, TaskTerm& term) {
  const bool of_frame = takes(term.residual, "frame");
  const char* attribute = of_frame ? "frame" : "robot";
  if (!of_frame && !e.has("robot")) return;
  const std::string name = e.required(attribute);
  const End end = of_frame ? ends_.read(e, attribute) : ends_.robot(e, attribute, name);
  if (end.shifted) e.refuse(attribute, " is " + quote(name) + ", expected a name without +k or -k");
  if (of_frame) term.frame = end.frame.name;
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
  if (known.empty()) where.fail(what + ": there is no contact " + quote(name) + ", since the scene has no contacts");
  where.fail(what + ": there is no contact " + quote(name) + ", " + suggestion(name, known));
}

void TermReader::read_contact(const Element& e, const std::vector<bool>& active, TaskTerm& term) const {
  const std::string name = e.required("contact");
  const Where here = e.where("contact");
  term.contacts = contacts(here, e.label("contact"), name);
  for (const ContactGroup& group : scene_.contact_groups)
    term.copied = term.copied || (group.copied && group.name == name);
  for (const int c : term.contacts)
    if (!active[c])
      here.fail(e.label("contact") + ": " + quote(name) + " is not active in this phase, expected an active contact");
  if (term.contacts.empty())
    here.fail(e.label("contact") + ": " + quote(name) + " has no copies, expected at least one copy");
  const ContactType type = scene_.scene.contacts[term.contacts[0]].type;
  if (takes(term.residual, "box") && type != ContactType::k6D)
    here.fail(std::string(to_string(term.residual)) + " of contact " + quote(name) + ", of type " + to_string(type) +
              ", expected a 6d contact");
}

int TermReader::rows(const TaskTerm& term) const {
  if (const int fixed = fixed_rows(term.residual); fixed > 0) return fixed;
  const Scene& scene = scene_.scene;
  const Model* model = term.robots.empty() ? nullptr : scene.robots[term.robots[0]].model.get();
  const int nv = model ? model->nv : scene.nv, nu = model ? model->nu() : scene.nu;
  switch (term.residual) {
    case TaskResidual::kState:
      return 2 * nv;
    case TaskResidual::kControl:
    case TaskResidual::kJointEffort:
      return nu;
    case TaskResidual::kContactForce:
      return scene.contacts[term.contacts[0]].rows();
    default:
      return nv;
  }
}

int TermReader::reference_size(const TaskTerm& term) const {
  if (term.residual != TaskResidual::kState) return term.nr;
  const Scene& scene = scene_.scene;
  if (term.robots.empty()) return scene.nq + scene.nv;
  const Model& model = *scene.robots[term.robots[0]].model;
  return model.nq + model.nv;
}

// Normalises the quaternions of floating joints in a reference state.
void TermReader::normalise_bases(const Element& e, TaskTerm& term) const {
  const Scene& scene = scene_.scene;
  const auto normalise = [&](const Model& model, int first) {
    for (const Joint& joint : model.joints)
      if (joint.type == JointType::kFloating)
        normalise_quaternion(e.where("reference"),
                             "the quaternion of joint " + quote(joint.name) + " in " + e.label("reference"),
                             term.reference.segment<4>(first + joint.idx_q + 3));
  };
  if (!term.robots.empty()) return normalise(*scene.robots[term.robots[0]].model, 0);
  for (const Robot& robot : scene.robots) normalise(*robot.model, robot.idx_q);
}

void TermReader::read_reference(const Element& e, const char* attribute, TaskTerm& term) {
  const auto pose = e.child("pose");
  if (term.residual == TaskResidual::kState && e.optional(attribute, "") == "pose") {
    if (!pose) e.refuse(attribute, " is pose, expected <pose> elements in <" + e.name() + ">");
    for (const Element& next : e.children("pose")) read_pose(next, scene_.scene, ends_, term.poses);
    return;
  }
  if (pose)
    pose->fail("<pose> is in a <" + e.name() +
               "> of another type or without reference=\"pose\", expected type state with reference=\"pose\"");
  if (!e.has(attribute)) return;
  const auto list = parse_numbers(e.where(attribute), e.label(attribute), e.required(attribute),
                                  static_cast<std::size_t>(reference_size(term)));
  term.reference = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  if (term.residual == TaskResidual::kState) normalise_bases(e, term);
}

void TermReader::read_numbers(const Element& e, TaskTerm& term) {
  const TaskResidual r = term.residual;
  if (r == TaskResidual::kCom) (void)e.required("reference");
  read_reference(e, takes(r, "twist") ? "twist" : "reference", term);
  if (takes(r, "xyz")) {
    (void)e.required("xyz");
    (void)e.read("xyz", term.placement.p);
  }
  if (takes(r, "quat_xyzw")) {
    (void)e.required("quat_xyzw");
    (void)read_quaternion(e, "quat_xyzw", term.placement.R);
  }
  if (takes(r, "reference_frame")) term.reference_frame = read_reference_frame(e);
  if (takes(r, "mu")) term.mu = e.positive("mu");
  e.read("normal", term.normal);
  if (term.normal && !(term.normal->stableNorm() > kZeroDirection))
    e.refuse("normal", " is zero, expected a direction");
  if (takes(r, "box")) {
    (void)e.required("box");
    (void)e.read("box", term.box);
    if (!(term.box.minCoeff() > 0))
      e.refuse("box", " has a side of " + show(term.box.minCoeff()) + ", expected numbers above 0");
  }
}

}  // namespace manycontact::io
