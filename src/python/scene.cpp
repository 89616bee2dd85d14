#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

using Placement = SE3<double>;

// ---- contacts ------------------------------------------------------------------------------------------------------

void add_attachments(py::module_& m) {
  using Held = Handle<Attachment>;
  value<Held>(m)
      .from_members<int, int, Placement, std::string>()
      .read_at<&Attachment::robot, &Attachment::joint, &Attachment::frame>(&Held::get)
      .fields<&Attachment::placement>();
}

void add_contacts(py::module_& m) {
  enumeration<ContactType>(m, "CONTACT_");
  enumeration<ReferenceFrame>(m);
  for (const char* name : {"LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED"}) m.attr(name) = m.attr("ReferenceFrame").attr(name);
  add_attachments(m);

  using Held = Handle<Contact>;
  value<Held>(m)
      .from_members<std::string, ContactType, ReferenceFrame, Attachment, Attachment, Eigen::Vector3d, double, double,
                    bool, std::optional<double>, std::optional<Eigen::Vector3d>, Eigen::Vector2d>()
      .fields<&Contact::name, &Contact::type, &Contact::reference_frame, &Contact::A, &Contact::B, &Contact::axis,
              &Contact::alpha, &Contact::beta, &Contact::mu, &Contact::normal, &Contact::box, &Contact::active>()
      .read_at<&Contact::rows>(&Held::get);
  add_items<Held>(m, "ContactList");
}

// ---- scenes --------------------------------------------------------------------------------------------------------

// Replaces a robot's model by one of the same structure. Items attached to a frame of the robot stay on that frame.
void take_model(Scene& scene, std::size_t number, const std::shared_ptr<const Model>& model) {
  const std::shared_ptr<const Model> old = scene.robots.at(number).model;
  if (model == old) return;
  if (!model || model->structure != old->structure)
    throw py::value_error("model: a model with the same joints is expected, such as Model.varied makes");
  const auto follow = [&](Attachment& at) {
    if (at.robot != static_cast<int>(number)) return;
    const int from = old->find_frame(at.frame), to = model->find_frame(at.frame);
    if (from < 0 || to < 0) return;
    at.placement = model->frames[to].placement * old->frames[from].placement.inverse() * at.placement;
  };
  for (Contact& contact : scene.contacts) follow(contact.A), follow(contact.B);
  for (ExternalWrench& push : scene.wrenches) follow(push.at);
  for (Spring& spring : scene.springs) follow(spring.A), follow(spring.B);
  scene.robots.at(number).model = model;
}

Items<Handle<Robot>> robots_of(const std::shared_ptr<Scene>& scene) {
  const auto robot = [scene](std::size_t k) {
    return Handle<Robot>([scene, k]() -> const Robot& { return scene->robots.at(k); },
                         [scene, k](const Robot& robot) {
                           take_model(*scene, k, robot.model);
                           scene->robots.at(k).base = robot.base;
                         });
  };
  return {[scene] { return scene->robots.size(); }, robot,
          [scene](const std::string& name) {
            const auto found = scene->robot_index.find(name);
            return found == scene->robot_index.end() ? -1 : found->second;
          },
          [scene](const std::string& name) { return no_robot(*scene, name); }};
}

void add_robots(py::module_& m) {
  using Held = Handle<Robot>;
  value<Held>(m)
      .read_at<&Robot::name>(&Held::get)
      .property(
          "model", [](const Held& r) { return std::const_pointer_cast<Model>(r.get().model); },
          [](const Held& r, const std::shared_ptr<Model>& model) {
            r.change([&](Robot& robot) { robot.model = model; });
          })
      .read_at<&Robot::idx_q, &Robot::idx_v, &Robot::idx_u>(&Held::get)
      .fields<&Robot::base>();
  add_items<Held>(m, "RobotList");
}

Handle<Contact> contact_data(const std::shared_ptr<Scene>& scene, const std::string& name) {
  return contacts_of(scene).at(static_cast<std::size_t>(contact_called(*scene, name)));
}

// Changes placement, gains and reference frame of a contact. They may change while SceneData are in use.
void change_contact(const std::shared_ptr<Scene>& scene, const std::string& name,
                    const std::optional<Placement>& placement, const std::optional<Eigen::Vector2d>& gains,
                    std::optional<ReferenceFrame> frame) {
  contact_data(scene, name).change([&](Contact& contact) {
    if (placement) contact.B.placement = *placement;
    if (gains) contact.alpha = (*gains)[0], contact.beta = (*gains)[1];
    if (frame) contact.reference_frame = *frame;
  });
}

// Returns a setter for a finite number of a scene, which must be at least 0 if `zero`, and otherwise above 0.
auto set_number(const char* name, double Scene::*member, bool zero) {
  return [=](Scene& scene, double x) {
    if (!(zero ? x >= 0 : x > 0) || !std::isfinite(x))
      throw py::value_error(std::string(name) + ": a finite " + (zero ? "number >= 0" : "length > 0") + " is expected");
    scene.*member = x;
  };
}

void add_scene(py::module_& m) {
  using S = Scene;
  value<S, std::shared_ptr<S>>(m)
      .def(py::init([](const std::string& name) {
        Scene scene;
        scene.name = name;
        return scene;
      }))
      .write<&S::name>()
      .property(
          "gravity", [](py::object self) { return view(self.cast<S&>().gravity, self, true); },
          [](S& s, const Eigen::Vector3d& g) { s.gravity = g; }, "damping", [](const S& s) { return s.damping; },
          set_number("Scene.damping", &S::damping, true), "tolerance", [](const S& s) { return s.tolerance; },
          set_number("Scene.tolerance", &S::tolerance, true), "moment_length",
          [](const S& s) { return s.moment_length; }, set_number("Scene.moment_length", &S::moment_length, false))
      .read("robots", &robots_of, "contacts", &contacts_of, "wrenches", &wrenches_of, "springs", &springs_of)
      .methods("contact", &contact_data)
      .methods<&change_contact>()
      .read<&S::nq, &S::nv, &S::nu, &S::robot_index, &S::contact_index>()
      .def("__repr__", [](const S& s) {
        return "<Scene '" + s.name + "': " + std::to_string(s.robots.size()) + " robots, nv = " + std::to_string(s.nv) +
               ", " + std::to_string(s.contacts.size()) + " contacts>";
      });
}

void add_configurations(py::module_& m) {
  def(m, "add_robot", [](Scene& scene, const std::string& name, std::shared_ptr<Model> model, const Placement& base) {
    if (!model) throw py::value_error("add_robot: a model is expected, not None");
    return add_robot(scene, name, std::move(model), base);
  });
  functions<&attach, &add_contact, &configuration_names, &velocity_names, &torque_names, &q_index, &v_index, &u_index,
            &resolve_references>(m);
}

void add_files(py::module_& m) {
  using F = SceneFile;
  value<F, std::shared_ptr<F>>(m)
      .read<&F::path, &F::files>()
      .read(
          "scene", [](const std::shared_ptr<F>& f) { return std::shared_ptr<Scene>(f, &f->scene); }, "findings",
          [](const F& f) { return f.findings; })
      .views<&F::q, &F::v, &F::u>();
  def(
      m, "load_scene", [](const std::string& path) { return std::make_shared<F>(load_scene(path)); }, Unlocked());
  def(
      m, "load_scene_text",
      [](const std::string& text, const std::string& path) { return std::make_shared<F>(load_scene_text(text, path)); },
      Unlocked());
}

}  // namespace

void add_scenes(py::module_& m) {
  add_contacts(m);
  add_force_classes(m);
  add_robots(m);
  add_scene(m);
  add_forces(m);
  add_configurations(m);
  add_files(m);
}

}  // namespace manycontact::python
