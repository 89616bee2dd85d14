// Scenes, their contacts and their files.

#include "docs/scene.hpp"

#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

using Placement = SE3<double>;

// ---- contacts ------------------------------------------------------------------------------------------------------

// A contact as add_contact would take it into the scene, by its two robots alone; throws where it does not fit.
Contact judged(const Scene& scene, Contact contact) {
  Scene around;
  std::vector<int> numbers;
  for (Attachment* at : {&contact.A, &contact.B}) {
    if (at->robot < 0 || at->robot >= scene.nrobots()) continue;
    const auto known = std::find(numbers.begin(), numbers.end(), at->robot);
    const auto number = static_cast<int>(known - numbers.begin());
    if (known == numbers.end()) {
      numbers.push_back(at->robot);
      around.robots.push_back(scene.robots[static_cast<std::size_t>(at->robot)]);
    }
    at->robot = number;
  }
  add_contact(around, std::move(contact));
  Contact taken = std::move(around.contacts.front());
  for (Attachment* at : {&taken.A, &taken.B})
    if (at->robot >= 0) at->robot = numbers[static_cast<std::size_t>(at->robot)];
  return taken;
}

Handle<Contact> contact_of_scene(const std::shared_ptr<Scene>& scene, std::size_t k) {
  const auto set = [scene, k](Contact contact) {
    Contact& now = scene->contacts.at(k);
    if (contact.name != now.name) throw py::value_error("contact '" + now.name + "' of a scene keeps its name");
    now = judged(*scene, std::move(contact));
  };
  return {[scene, k]() -> const Contact& { return scene->contacts.at(k); }, set};
}

Items<Handle<Contact>> contacts_of(const std::shared_ptr<Scene>& scene) {
  return {[scene] { return scene->contacts.size(); }, [scene](std::size_t k) { return contact_of_scene(scene, k); },
          [scene](const std::string& name) {
            const auto found = scene->contact_index.find(name);
            return found == scene->contact_index.end() ? -1 : found->second;
          },
          [scene](const std::string& name) { return no_contact(*scene, name); }};
}

void add_attachments(py::module_& m) {
  py::class_<Handle<Attachment>> c(m, "Attachment",
                                   "A frame on a joint's body of a robot, or in the world; see attach().\n"
                                   "\n"
                                   "Attachment(placement=M) is the placement M in the world.");
  c.def(py::init([](int robot, int joint, const Placement& placement, const std::string& frame) {
          return Handle<Attachment>(Attachment{robot, joint, placement, frame});
        }),
        py::kw_only(), py::arg("robot") = -1, py::arg("joint") = -1, py::arg_v("placement", Placement(), "SE3()"),
        py::arg("frame") = "")
      .def_property_readonly(
          "robot", [](const Handle<Attachment>& h) { return h.get().robot; }, "Number of the robot; -1: the world.")
      .def_property_readonly(
          "joint", [](const Handle<Attachment>& h) { return h.get().joint; },
          "Number of the joint of its model; -1: its fixed base.")
      .def_property_readonly(
          "frame", [](const Handle<Attachment>& h) { return h.get().frame; },
          "Name of the frame that it was made from; empty if unknown.");
  handle_field(c, "placement", &Attachment::placement,
               "Placement of the frame on that body (SE3); assign a new SE3 to change it.");
  add_value(c);
}

Handle<Contact> make_contact(const std::string& name, ContactType type, ReferenceFrame frame, const Attachment& A,
                             const Attachment& B, const Eigen::Vector3d& axis, double alpha, double beta, bool active,
                             std::optional<double> mu, const std::optional<Eigen::Vector3d>& normal,
                             const Eigen::Vector2d& box) {
  Contact c;
  c.name = name, c.type = type, c.reference_frame = frame, c.A = A, c.B = B, c.axis = axis;
  c.alpha = alpha, c.beta = beta, c.active = active, c.mu = mu, c.normal = normal, c.box = box;
  return Handle<Contact>(std::move(c));
}

void add_contacts(py::module_& m) {
  add_enumeration<ContactType>(m, "ContactType", "type of contact",
                               "The motion that a contact constrains: that of a point, a frame, or a hinge.",
                               {{"CONTACT_1D", ContactType::k1D},
                                {"CONTACT_2D", ContactType::k2D},
                                {"CONTACT_3D", ContactType::k3D},
                                {"CONTACT_5D", ContactType::k5D},
                                {"CONTACT_6D", ContactType::k6D}});
  add_enumeration<ReferenceFrame>(m, "ReferenceFrame", "reference frame",
                                  "Axes of forces and velocities, with Pinocchio's names.",
                                  {{"LOCAL", ReferenceFrame::kLocal},
                                   {"WORLD", ReferenceFrame::kWorld},
                                   {"LOCAL_WORLD_ALIGNED", ReferenceFrame::kLocalWorldAligned}});
  for (const char* name : {"LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED"}) m.attr(name) = m.attr("ReferenceFrame").attr(name);
  add_attachments(m);

  py::class_<Handle<Contact>> c(
      m, "Contact",
      "A bilateral contact between frame A on a robot and frame B' on another body or in the world.\n"
      "\n"
      "Assigning to the attributes of scene.contacts[0] changes the scene.");
  c.def(py::init(&make_contact), py::kw_only(), py::arg("name"),
        py::arg_v("type", ContactType::k6D, "ContactType.CONTACT_6D"),
        py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"), py::arg("A"),
        py::arg_v("B", Attachment(), "Attachment()"), py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()),
        py::arg("alpha") = 0.0, py::arg("beta") = 0.0, py::arg("active") = true, py::arg("mu") = py::none(),
        py::arg("normal") = py::none(), py::arg("box") = Eigen::Vector2d(Eigen::Vector2d::Zero()),
        "Make a contact; see the attributes.");
  handle_field(c, "name", &Contact::name, "Name.");
  handle_field(c, "type", &Contact::type, "ContactType. After a change make new SceneData.");
  handle_field(c, "reference_frame", &Contact::reference_frame,
               "ReferenceFrame of the force and, for 1D and 2D contacts, of the constraint rows.");
  handle_field(c, "A", &Contact::A, "Attachment of frame A. After a change make new SceneData.");
  handle_field(c, "B", &Contact::B, "Attachment of frame B'; its placement may change while data are in use.");
  handle_field(c, "axis", &Contact::axis, "Unit vector (3). After a change make new SceneData.");
  handle_field(c, "alpha", &Contact::alpha, "Stabilisation gain of position errors [1/s^2].");
  handle_field(c, "beta", &Contact::beta, "Stabilisation gain of velocities [1/s].");
  handle_field(c, "mu", &Contact::mu, "Coefficient of friction of a unilateral contact; None: the contact may pull.");
  handle_field(
      c, "normal", &Contact::normal,
      "Direction out of the surface (3), in the world, or in the axes of B' if B is on a body. None: the world's\n"
      "z for points, A's own z for 6D.");
  handle_field(c, "box", &Contact::box, "Length and width of the support area of a 6D contact (2) [m]; zero: none.");
  handle_field(c, "active", &Contact::active, "Initial flag of new data; SceneData.active switches the contact later.");
  c.def_property_readonly(
      "rows", [](const Handle<Contact>& h) { return h.get().rows(); }, "Number of constraint rows, 1 to 6.");
  add_value(c);
  add_items<Handle<Contact>>(m, "ContactList",
                             "A scene's contacts, by number or name. Assigning to their attributes changes the scene.",
                             true);
}

// ---- scenes --------------------------------------------------------------------------------------------------------

// Another model of the same structure: what is attached to one of the robot's frames stays there.
void take_model(Scene& scene, std::size_t number, const std::shared_ptr<const Model>& model) {
  const std::shared_ptr<const Model> old = scene.robots.at(number).model;
  if (model == old) return;
  if (!model || model->structure != old->structure)
    throw py::value_error("model: one of the same joints is expected, as Model.varied makes it");
  const auto follow = [&](Attachment& at) {
    if (at.robot != static_cast<int>(number)) return;
    const int from = old->find_frame(at.frame), to = model->find_frame(at.frame);
    if (from < 0 || to < 0) return;
    at.placement = model->frames[to].placement * old->frames[from].placement.inverse() * at.placement;
  };
  for (Contact& contact : scene.contacts) follow(contact.A), follow(contact.B);
  for (Push& push : scene.pushes) follow(push.at);
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
  py::class_<Held> c(m, "Robot", "An instance of a model in a scene.");
  c.def_property_readonly(
       "name", [](const Held& r) { return r.get().name; }, "Name.")
      .def_property(
          "model", [](const Held& r) { return std::const_pointer_cast<Model>(r.get().model); },
          [](const Held& r, const std::shared_ptr<Model>& model) {
            r.change([&](Robot& robot) { robot.model = model; });
          },
          "Model. Assign a model of the same joints, as Model.varied makes it; existing data become invalid. "
          "Contacts,\n"
          "pushes and springs remain on the frames that they were made from.")
      .def_property_readonly(
          "idx_q", [](const Held& r) { return r.get().idx_q; }, "First coordinate in the scene's q.")
      .def_property_readonly(
          "idx_v", [](const Held& r) { return r.get().idx_v; }, "First coordinate in the scene's v.")
      .def_property_readonly(
          "idx_u", [](const Held& r) { return r.get().idx_u; }, "First torque in the scene's u.");
  handle_field(
      c, "base", &Robot::base,
      "Placement in the world (SE3): of a fixed base, or of a floating base in neutral(). Contacts do not move\n"
      "with it.");
  add_value(c);
  add_items<Held>(m, "RobotList", "A scene's robots, by number or name.", true);
}

// The members that may change while data are in use.
void change_contact(const std::shared_ptr<Scene>& scene, const std::string& name,
                    const std::optional<Placement>& placement, const std::optional<Eigen::Vector2d>& gains,
                    std::optional<ReferenceFrame> frame) {
  contact_of_scene(scene, static_cast<std::size_t>(contact_called(*scene, name))).change([&](Contact& contact) {
    if (placement) contact.B.placement = *placement;
    if (gains) contact.alpha = (*gains)[0], contact.beta = (*gains)[1];
    if (frame) contact.reference_frame = *frame;
  });
}

void add_scene(py::module_& m) {
  py::class_<Scene, std::shared_ptr<Scene>> c(
      m, "Scene",
      "Robots, and the contacts among them and with the world.\n"
      "\n"
      "While data are in use, these may change: gravity, damping, placements of fixed bases, the placement of B,\n"
      "gains\n"
      "and reference frame of a contact, and everything of pushes and springs except their bodies. Other changes\n"
      "need\n"
      "new data.");
  c.def(py::init([](const std::string& name) {
          Scene scene;
          scene.name = name;
          return scene;
        }),
        py::arg("name") = "")
      .def_readwrite("name", &Scene::name, "Name.")
      .def_property(
          "gravity", [](py::object self) { return view(self.cast<Scene&>().gravity, self, true); },
          [](Scene& s, const Eigen::Vector3d& g) { s.gravity = g; },
          "Gravity (3) [m/s^2]; an array that shares the scene's memory.")
      .def_property(
          "damping", [](const Scene& s) { return s.damping; },
          [](Scene& s, double damping) {
            if (!(damping >= 0) || !std::isfinite(damping))
              throw py::value_error("Scene.damping: a finite number >= 0 is expected");
            s.damping = damping;
          },
          "Damping delta >= 0 on the diagonal of J M^-1 J^T [1/kg].")
      .def_property(
          "tolerance", [](const Scene& s) { return s.tolerance; },
          [](Scene& s, double tolerance) {
            if (!(tolerance >= 0) || !std::isfinite(tolerance))
              throw py::value_error("Scene.tolerance: a finite number >= 0 is expected");
            s.tolerance = tolerance;
          },
          "Geometric tolerance [m]; for angles it is divided by the longest moment arm. Rows that are dependent to\n"
          "within it are treated as dependent. 0: exact up to rounding errors.")
      .def_property(
          "moment_length", [](const Scene& s) { return s.moment_length; },
          [](Scene& s, double length) {
            if (!(length > 0) || !std::isfinite(length))
              throw py::value_error("Scene.moment_length: a finite length > 0 is expected");
            s.moment_length = length;
          },
          "Length L [m] that weights moments against forces: least-norm contact forces minimise sum f^2 + sum (m /\n"
          "L)^2.")
      .def_property_readonly("robots", &robots_of, "Robots, by number or name.")
      .def_property_readonly("contacts", &contacts_of, "Contacts, by number or name: scene.contacts['left'].mu = 0.5.")
      .def_property_readonly("pushes", &pushes_of, "Pushes, by number or name.")
      .def_property_readonly("springs", &springs_of, "Springs between points, by number or name.")
      .def(
          "contact",
          [](const std::shared_ptr<Scene>& s, const std::string& name) {
            return contact_of_scene(s, static_cast<std::size_t>(contact_called(*s, name)));
          },
          py::arg("name"), "Return the contact with the given name, as scene.contacts[name].")
      .def("change_contact", &change_contact, py::arg("name"), py::kw_only(), py::arg("placement") = py::none(),
           py::arg("gains") = py::none(), py::arg("reference_frame") = py::none(),
           "Change the placement of B, the gains (alpha, beta) or the reference frame of a contact, while data are in\n"
           "use.")
      .def_readonly("nq", &Scene::nq, "Number of configuration coordinates.")
      .def_readonly("nv", &Scene::nv, "Number of velocity coordinates.")
      .def_readonly("nu", &Scene::nu, "Number of actuated coordinates.")
      .def_readonly("robot_index", &Scene::robot_index, "Dictionary {name: number}; a copy.")
      .def_readonly("contact_index", &Scene::contact_index, "Dictionary {name: number}; a copy.");
  add_value(c).def("__repr__", [](const Scene& s) {
    return "<Scene '" + s.name + "': " + std::to_string(s.robots.size()) + " robots, nv = " + std::to_string(s.nv) +
           ", " + std::to_string(s.contacts.size()) + " contacts>";
  });
}

void add_configurations(py::module_& m) {
  m.def(
      "add_robot",
      [](Scene& scene, const std::string& name, std::shared_ptr<Model> model, const Placement& base) {
        if (!model) throw py::value_error("add_robot: a model is expected, not None");
        return add_robot(scene, name, std::move(model), base);
      },
      py::arg("scene"), py::arg("name"), py::arg("model"), py::arg_v("base", Placement(), "SE3()"), doc::add_robot);
  m.def("attach", &attach, py::arg("scene"), py::arg("robot"), py::arg("frame"),
        py::arg_v("offset", Placement(), "SE3()"), doc::attach);
  m.def("add_contact", &add_contact, py::arg("scene"), py::arg("contact"), doc::add_contact);
  m.def("configuration_names", &configuration_names, py::arg("scene"), doc::configuration_names);
  m.def("velocity_names", &velocity_names, py::arg("scene"), doc::velocity_names);
  m.def("torque_names", &torque_names, py::arg("scene"), doc::torque_names);
  m.def("q_index", &q_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), doc::q_index);
  m.def("v_index", &v_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), doc::v_index);
  m.def("u_index", &u_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), doc::u_index);

  m.def("resolve_references", &resolve_references, py::arg("scene"), py::arg("q"), doc::resolve_references);
}

void add_files(py::module_& m) {
  py::class_<SceneFile, std::shared_ptr<SceneFile>> c(
      m, "SceneFile", "A scene from a file, with its configuration, velocity and torques.");
  c.def_readonly("path", &SceneFile::path, "Path of the file.")
      .def_readonly("files", &SceneFile::files, "All files read: path, included scenes, URDFs.")
      .def_property_readonly(
          "scene", [](const std::shared_ptr<SceneFile>& f) { return std::shared_ptr<Scene>(f, &f->scene); }, "Scene.");
  member_view(c, "q", &SceneFile::q, "Configuration (nq) [m, rad, quaternions].");
  member_view(c, "v", &SceneFile::v, "Velocity (nv) [m/s, rad/s].");
  member_view(c, "u", &SceneFile::u, "Torques of the actuated coordinates (nu) [N m, N].");
  c.def_property_readonly(
      "findings", [](const SceneFile& f) { return f.findings; },
      "List of Finding: questionable input in the robots' files, with names such as 'robot/joint'.");
  add_value(c);
  m.def(
      "load_scene", [](const std::string& path) { return std::make_shared<SceneFile>(load_scene(path)); },
      py::arg("path"), Unlocked(), doc::load_scene);
  m.def(
      "load_scene_text",
      [](const std::string& text, const std::string& path) {
        return std::make_shared<SceneFile>(load_scene_text(text, path));
      },
      py::arg("text"), py::arg("path") = "scene.xml", Unlocked(), doc::load_scene_text);
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
