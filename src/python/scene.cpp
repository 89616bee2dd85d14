// Placements, models, scenes, files: floors spatial, model, contact (references), algorithm (configurations) and io.

#include <pybind11/operators.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/io/urdf.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

using Placement = SE3<double>;

constexpr double kOrthonormal = 1e-6;  // as far as quaternions of files may be from unit length

Placement placement(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  if (!(R.transpose() * R).isIdentity(kOrthonormal) || !(R.determinant() > 0))
    throw py::value_error("SE3: R is not a rotation matrix");
  return {R, p};
}

Placement placement_of_quaternion(const Eigen::Vector4d& q, const Eigen::Vector3d& p) {
  if (!(std::abs(q.norm() - 1) <= kOrthonormal))
    throw py::value_error("SE3.from_quaternion: the quaternion has the length " + std::to_string(q.norm()) +
                          ", 1 is expected");
  return {rotation_of_quaternion<double>(q[0], q[1], q[2], q[3]), p};
}

void add_placements(py::module_& m) {
  py::class_<Placement> c(m, "SE3", "A placement aMb: x_a = R x_b + p maps coordinates in frame b to frame a.");
  c.def(py::init(&placement), py::arg("R") = Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
        py::arg("p") = Eigen::Vector3d(Eigen::Vector3d::Zero()), "R: rotation matrix (3, 3); p: translation (3) [m].")
      .def_static("from_quaternion", &placement_of_quaternion, py::arg("xyzw"),
                  py::arg("p") = Eigen::Vector3d(Eigen::Vector3d::Zero()),
                  "Of a unit quaternion (x, y, z, w) and a translation (3) [m].")
      .def_static("Identity", &Placement::Identity)
      .def_property(
          "R", [](const Placement& M) -> Eigen::Matrix3d { return M.R; },
          [](Placement& M, const Eigen::Matrix3d& R) { M = placement(R, M.p); }, "Rotation matrix (3, 3).")
      .def_property(
          "p", [](const Placement& M) -> Eigen::Vector3d { return M.p; },
          [](Placement& M, const Eigen::Vector3d& p) { M.p = p; }, "Translation (3) [m].")
      .def_property_readonly(
          "rotation", [](const Placement& M) -> Eigen::Matrix3d { return M.R; }, "R.")
      .def_property_readonly(
          "translation", [](const Placement& M) -> Eigen::Vector3d { return M.p; }, "p.")
      .def_property_readonly(
          "quaternion", [](const Placement& M) { return quaternion_of_rotation<double>(M.R); },
          "Unit quaternion (x, y, z, w), w >= 0.")
      .def("inverse", &Placement::inverse, "bMa.")
      .def(
          "__mul__", [](const Placement& a, const Placement& b) { return a * b; }, "aMc = aMb bMc.")
      .def(
          "act", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act(v); }, py::arg("motion"),
          "The motion (6, linear first) in a of one given in b.")
      .def(
          "act_inverse", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act_inverse(v); },
          py::arg("motion"), "The motion in b of one given in a.")
      .def(
          "act_force", [](const Placement& M, const Vec6<double>& f) -> Vec6<double> { return M.act_force(f); },
          py::arg("force"), "The force (6, linear first) in a of one given in b.")
      .def("action", &Placement::action, "The matrix (6, 6) of act.")
      .def("__repr__", [](const Placement& M) {
        const auto x = pose_of_placement(M);
        std::ostringstream out;
        out << "SE3(p=[" << x[0] << ", " << x[1] << ", " << x[2] << "], quaternion=[" << x[3] << ", " << x[4] << ", "
            << x[5] << ", " << x[6] << "])";
        return out.str();
      });
}

void add_models(py::module_& m) {
  py::enum_<JointType>(m, "JointType")
      .value("kRevolute", JointType::kRevolute)
      .value("kPrismatic", JointType::kPrismatic)
      .value("kFloating", JointType::kFloating)
      .value("kPlanar", JointType::kPlanar);

  py::class_<Joint>(m, "Joint", "A joint and the body it carries. The joint frame is the child frame at q = 0.")
      .def_readonly("name", &Joint::name)
      .def_readonly("type", &Joint::type)
      .def_readonly("parent", &Joint::parent, "Number of the parent joint; -1: the robot's base.")
      .def_readonly("idx_q", &Joint::idx_q, "First coordinate in the model's q.")
      .def_readonly("idx_v", &Joint::idx_v, "First coordinate in the model's v.")
      .def_property_readonly("nq", &Joint::nq)
      .def_property_readonly("nv", &Joint::nv)
      .def_readonly("placement", &Joint::placement, "Of the joint frame in the parent joint's frame.")
      .def_readonly("axis", &Joint::axis, "Unit vector (3) in the joint frame.")
      .def_property_readonly(
          "mass", [](const Joint& j) { return j.inertia.m; }, "Of the body [kg].")
      .def_readonly("lower", &Joint::lower, "Position limits (nv) [rad, m], infinite where there are none.")
      .def_readonly("upper", &Joint::upper)
      .def_readonly("velocity_limit", &Joint::velocity_limit, "(nv) [rad/s, m/s].")
      .def_readonly("effort_limit", &Joint::effort_limit, "(nv) [N m, N].");

  py::class_<Frame>(m, "Frame", "A named frame fixed on a joint's body: a link.")
      .def_readonly("name", &Frame::name)
      .def_readonly("joint", &Frame::joint, "Number of the joint; -1: fixed to the robot's base.")
      .def_readonly("placement", &Frame::placement, "In the joint's frame.");

  py::class_<Finding>(m, "Finding", "Something odd but usable, and how it is taken.")
      .def_readonly("kind", &Finding::kind, "'inertia', 'limits', 'unread', 'mimic', 'dynamics', 'passive', 'base'.")
      .def_readonly("name", &Finding::name, "Of the joint, link or other element.")
      .def_readonly("text", &Finding::text)
      .def_readonly("file", &Finding::file)
      .def_readonly("line", &Finding::line)
      .def("__repr__", [](const Finding& f) {
        return f.file + ":" + std::to_string(f.line) + ": " + f.kind + ": " + f.name + ": " + f.text;
      });

  py::class_<Model, std::shared_ptr<Model>>(m, "Model", "One robot or object: a kinematic tree. Constant.")
      .def_readonly("name", &Model::name)
      .def_readonly("floating_base", &Model::floating_base)
      .def_readonly("nq", &Model::nq)
      .def_readonly("nv", &Model::nv)
      .def_property_readonly("nu", &Model::nu, "Actuated coordinates: all but a floating base and passive joints.")
      .def_property_readonly(
          "joints", [](const Model& x) { return x.joints; }, "List of Joint.")
      .def_property_readonly(
          "frames", [](const Model& x) { return x.frames; }, "List of Frame.")
      .def_readonly("armature", &Model::armature, "Reflected rotor inertia (nv) [kg m^2, kg].")
      .def("find_frame", &Model::find_frame, py::arg("name"), "Number of the frame, -1 if there is none.")
      .def("find_joint", &Model::find_joint, py::arg("name"), "Number of the joint, -1 if there is none.")
      .def("mass", &Model::mass, "Total mass [kg].")
      .def("__repr__", [](const Model& x) { return "<Model '" + x.name + "', nv = " + std::to_string(x.nv) + ">"; });

  m.def(
      "load_urdf",
      [](const std::string& path, bool floating_base, double armature,
         const std::map<std::string, std::vector<double>>& joint_armature, const std::map<std::string, double>& locked,
         bool refuse_mimic, const std::set<std::string>& passive, bool model_dynamics, bool refuse_inertia,
         const std::set<std::string>& actuated) {
        return std::make_shared<Model>(load_urdf(path, {floating_base, armature, joint_armature, locked, refuse_mimic,
                                                        passive, model_dynamics, refuse_inertia, actuated}));
      },
      py::arg("path"), py::kw_only(), py::arg("floating_base") = false, py::arg("armature") = 0.0,
      py::arg("joint_armature") = std::map<std::string, std::vector<double>>(),
      py::arg("locked") = std::map<std::string, double>(), py::arg("refuse_mimic") = false,
      py::arg("passive") = std::set<std::string>(), py::arg("model_dynamics") = false,
      py::arg("refuse_inertia") = false, py::arg("actuated") = std::set<std::string>(),
      "A robot from a URDF file.\n\n"
      "floating_base: joint 0 is then 'root', carrying the root link.\n"
      "armature: reflected rotor inertia of every joint [kg m^2; kg for prismatic joints].\n"
      "joint_armature: {joint: [numbers]} overrides it. locked: {joint: position} freezes joints.\n"
      "passive: joints without torques. model_dynamics: the URDF's damping and friction of joints.\n"
      "refuse_inertia: principal moments that no body has are an error, not a finding.\n"
      "actuated: floating joints of the file that have torques; by default they are passive.\n"
      "What is odd but usable is taken, and told by urdf_findings.\n"
      "Joints are numbered depth first, children in byte order of their names.\n"
      "Raises InputError (a ValueError) for the file, ValueError for options that do not fit.");
  m.def(
      "urdf_findings",
      [](const std::string& path, bool floating_base) {
        std::vector<Finding> findings;
        UrdfOptions options;
        options.floating_base = floating_base;
        (void)load_urdf(path, options, &findings);
        return findings;
      },
      py::arg("path"), py::kw_only(), py::arg("floating_base") = false,
      "List of Finding: what load_urdf finds odd in a file and takes nevertheless, by line.");
}

// ---- scenes --------------------------------------------------------------------------------------------------------

std::size_t contact_number(const Scene& scene, const std::string& name) {
  const auto found = scene.contact_index.find(name);
  if (found == scene.contact_index.end()) throw py::value_error("there is no contact '" + name + "'");
  return static_cast<std::size_t>(found->second);
}

// What may change under data in use.
void change_contact(Scene& scene, const std::string& name, const std::optional<Placement>& placement,
                    const std::optional<Eigen::Vector2d>& gains, const std::optional<ReferenceFrame>& frame) {
  Contact& contact = scene.contacts[contact_number(scene, name)];
  if (placement) contact.B.placement = *placement;
  if (gains) contact.alpha = (*gains)[0], contact.beta = (*gains)[1];
  if (frame) contact.reference_frame = *frame;
}

Contact make_contact(const std::string& name, ContactType type, ReferenceFrame frame, const Attachment& A,
                     const Attachment& B, const Eigen::Vector3d& axis, double alpha, double beta, bool active) {
  return {name, type, frame, A, B, axis, alpha, beta, active};
}

void add_contacts(py::module_& m) {
  add_enumeration<ContactType>(m, "ContactType", "Which motions of frame A a contact holds.",
                               {{"k1D", ContactType::k1D},
                                {"k2D", ContactType::k2D},
                                {"k3D", ContactType::k3D},
                                {"k5D", ContactType::k5D},
                                {"k6D", ContactType::k6D}});
  py::enum_<ReferenceFrame>(m, "ReferenceFrame")
      .value("kLocal", ReferenceFrame::kLocal)
      .value("kWorld", ReferenceFrame::kWorld)
      .value("kLocalWorldAligned", ReferenceFrame::kLocalWorldAligned)
      .value("LOCAL", ReferenceFrame::kLocal)
      .value("WORLD", ReferenceFrame::kWorld)
      .value("LOCAL_WORLD_ALIGNED", ReferenceFrame::kLocalWorldAligned)
      .export_values();

  py::class_<Attachment>(m, "Attachment",
                         "A place on a joint's body of a robot, or in the world: see attach().\n"
                         "Attachment(placement=M) is the placement M in the world.")
      .def(py::init([](int robot, int joint, const Placement& placement, const std::string& frame) {
             return Attachment{robot, joint, placement, frame};
           }),
           py::kw_only(), py::arg("robot") = -1, py::arg("joint") = -1, py::arg_v("placement", Placement(), "SE3()"),
           py::arg("frame") = "")
      .def_readonly("robot", &Attachment::robot, "Number of the robot; -1: the world.")
      .def_readonly("joint", &Attachment::joint, "Number of the joint of its model; -1: its fixed base.")
      .def_property(
          "placement", [](const Attachment& x) { return x.placement; },
          [](Attachment& x, const Placement& M) { x.placement = M; }, "Of the contact's frame on that body.")
      .def_readonly("frame", &Attachment::frame);

  py::class_<Contact>(m, "Contact", "A bilateral contact: frame A on a robot, B' on another body or in the world.")
      .def(py::init(&make_contact), py::kw_only(), py::arg("name"),
           py::arg_v("type", ContactType::k6D, "ContactType.k6D"),
           py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.kLocal"), py::arg("A"),
           py::arg_v("B", Attachment(), "Attachment()"), py::arg("axis") = Eigen::Vector3d(Eigen::Vector3d::UnitZ()),
           py::arg("alpha") = 0.0, py::arg("beta") = 0.0, py::arg("active") = true,
           "reference_frame: of the force, of 1D's and 2D's components, and of their derivatives.\n"
           "axis: of 1D contacts, the component held (3), in the reference frame; of 5D contacts, the hinge's.\n"
           "alpha [1/s^2], beta [1/s]: stabilisation gains.")
      .def_readwrite("name", &Contact::name)
      .def_readwrite("type", &Contact::type)
      .def_readwrite("reference_frame", &Contact::reference_frame)
      .def_property(
          "A", [](const Contact& c) { return c.A; }, [](Contact& c, const Attachment& a) { c.A = a; })
      .def_property(
          "B", [](const Contact& c) { return c.B; }, [](Contact& c, const Attachment& b) { c.B = b; })
      .def_property(
          "axis", [](const Contact& c) -> Eigen::Vector3d { return c.axis; },
          [](Contact& c, const Eigen::Vector3d& axis) { c.axis = axis; })
      .def_readwrite("alpha", &Contact::alpha, "[1/s^2]")
      .def_readwrite("beta", &Contact::beta, "[1/s]")
      .def_readwrite("mu", &Contact::mu, "Friction coefficient of a contact that only pushes; None: it may pull.")
      .def_property(
          "normal", [](const Contact& c) -> std::optional<Eigen::Vector3d> { return c.normal; },
          [](Contact& c, const std::optional<Eigen::Vector3d>& normal) { c.normal = normal; },
          "Out of the surface (3): in the world, or in B' axes where B is on a body; None: the world's z for points, "
          "A's "
          "own z for 6D.")
      .def_property(
          "box", [](const Contact& c) -> Eigen::Vector2d { return c.box; },
          [](Contact& c, const Eigen::Vector2d& box) { c.box = box; }, "Length and width of the support (2) [m].")
      .def_readwrite("active", &Contact::active, "At the start; SceneData.active may switch it later.")
      .def_property_readonly("rows", &Contact::rows)
      .def("__repr__", [](const Contact& c) { return "<Contact '" + c.name + "', " + to_string(c.type) + ">"; });
}

void add_scene(py::module_& m) {
  py::class_<Robot>(m, "Robot", "An instance of a model in a scene.")
      .def_readonly("name", &Robot::name)
      .def_property_readonly("model", [](const Robot& r) { return std::const_pointer_cast<Model>(r.model); })
      .def_property_readonly(
          "base", [](const Robot& r) { return r.base; },
          "In the world: where a fixed base stands, where a floating one starts.")
      .def_readonly("idx_q", &Robot::idx_q, "First coordinate in the scene's q.")
      .def_readonly("idx_v", &Robot::idx_v, "First coordinate in the scene's v.")
      .def_readonly("idx_u", &Robot::idx_u, "First torque in the scene's u.");

  py::class_<Scene, std::shared_ptr<Scene>>(
      m, "Scene", "Robots and the contacts among them and with the world; constant under the data made for it.")
      .def(py::init([](const std::string& name) {
             Scene scene;
             scene.name = name;
             return scene;
           }),
           py::arg("name") = "")
      .def_readwrite("name", &Scene::name)
      .def_property(
          "gravity", [](const Scene& s) -> Eigen::Vector3d { return s.gravity; },
          [](Scene& s, const Eigen::Vector3d& g) { s.gravity = g; }, "(3) [m/s^2]")
      .def_property(
          "damping", [](const Scene& s) { return s.damping; },
          [](Scene& s, double damping) {
            if (!(damping >= 0) || !std::isfinite(damping))
              throw py::value_error("Scene.damping: a finite number >= 0 is expected");
            s.damping = damping;
          },
          "delta >= 0 on the diagonal of J M^-1 J^T [1/kg].")
      .def_property_readonly(
          "robots", [](const Scene& s) { return s.robots; }, "List of Robot; a copy.")
      .def_property_readonly(
          "contacts", [](const Scene& s) { return s.contacts; },
          "List of Contact; a copy: change_contact() changes the scene's.")
      .def(
          "contact", [](const Scene& s, const std::string& name) { return s.contacts[contact_number(s, name)]; },
          py::arg("name"), "A copy of the contact of that name.")
      .def("change_contact", &change_contact, py::arg("name"), py::kw_only(), py::arg("placement") = py::none(),
           py::arg("gains") = py::none(), py::arg("reference_frame") = py::none(),
           "What may change of a contact under data in use: B's placement, gains (alpha, beta), the reference frame.")
      .def_readonly("nq", &Scene::nq)
      .def_readonly("nv", &Scene::nv)
      .def_readonly("nu", &Scene::nu)
      .def_readonly("robot_index", &Scene::robot_index, "{name: number}; a copy.")
      .def_readonly("contact_index", &Scene::contact_index, "{name: number}; a copy.")
      .def("__copy__", [](const Scene& s) { return Scene(s); })
      .def("__deepcopy__", [](const Scene& s, py::dict) { return Scene(s); })
      .def("__repr__", [](const Scene& s) {
        return "<Scene '" + s.name + "': " + std::to_string(s.robots.size()) + " robots, nv = " + std::to_string(s.nv) +
               ", " + std::to_string(s.contacts.size()) + " contacts>";
      });

  m.def(
      "add_robot",
      [](Scene& scene, const std::string& name, std::shared_ptr<Model> model, const Placement& base) {
        if (!model) throw py::value_error("add_robot: a model is expected, not None");
        return add_robot(scene, name, std::move(model), base);
      },
      py::arg("scene"), py::arg("name"), py::arg("model"), py::arg_v("base", Placement(), "SE3()"),
      "Appends a robot; returns its number. base: where its base stands (fixed), or where neutral(scene) starts it.");
  m.def("attach", &attach, py::arg("scene"), py::arg("robot"), py::arg("frame"),
        py::arg_v("offset", Placement(), "SE3()"), "The attachment of a robot's frame, with an offset on it.");
  m.def("add_contact", &add_contact, py::arg("scene"), py::arg("contact"), "Appends a contact; returns its number.");
  m.def("configuration_names", &configuration_names, py::arg("scene"), "Names of q: 'r0/knee', 'r0/root[0]'.");
  m.def("velocity_names", &velocity_names, py::arg("scene"), "Names of v.");
  m.def("torque_names", &torque_names, py::arg("scene"), "Names of u.");
  m.def("q_index", &q_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), "First coordinate of a joint in q.");
  m.def("v_index", &v_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), "First coordinate of a joint in v.");
  m.def("u_index", &u_index, py::arg("scene"), py::arg("robot"), py::arg("joint"), "First torque of a joint in u.");

  using Vector = Eigen::VectorXd;
  using Input = Eigen::Ref<const Vector>;
  m.def("neutral", py::overload_cast<const Scene&>(&neutral), py::arg("scene"),
        "The configuration (nq) with joints at zero and floating bases where Robot.base has them.");
  m.def(
      "random_configuration",
      [](const Scene& scene, unsigned seed) {
        std::mt19937 generator(seed);
        return random_configuration(scene, generator);
      },
      py::arg("scene"), py::arg("seed"), "A configuration (nq) within the joints' limits, any orientation of bases.");
  m.def("integrate", py::overload_cast<const Scene&, const Input&, const Input&>(&integrate), py::arg("scene"),
        py::arg("q"), py::arg("v"), "q (+) v (nq): reached from q by the velocity v (nv) held for unit time.");
  m.def("difference", py::overload_cast<const Scene&, const Input&, const Input&>(&difference), py::arg("scene"),
        py::arg("q0"), py::arg("q1"), "q1 (-) q0 (nv): the v with integrate(scene, q0, v) = q1.");
  m.def("resolve_references", &resolve_references, py::arg("scene"), py::arg("q"),
        "Moves B' of every contact onto A at configuration q (nq): there they all hold.");
}

void add_files(py::module_& m) {
  py::class_<SceneFile, std::shared_ptr<SceneFile>>(m, "SceneFile", "A scene from a file, with its state.")
      .def_readonly("path", &SceneFile::path)
      .def_property_readonly("scene",
                             [](const std::shared_ptr<SceneFile>& f) { return std::shared_ptr<Scene>(f, &f->scene); })
      .def_property_readonly(
          "q", [](const SceneFile& f) { return f.q; }, "Configuration (nq) [m, rad, quaternions].")
      .def_property_readonly(
          "v", [](const SceneFile& f) { return f.v; }, "Velocity (nv) [m/s, rad/s].")
      .def_property_readonly(
          "u", [](const SceneFile& f) { return f.u; }, "Torques of actuated joints (nu) [N m, N].")
      .def_property_readonly(
          "findings", [](const SceneFile& f) { return f.findings; },
          "List of Finding: what reading the robots' files found odd; names as 'robot/joint'.");
  m.def(
      "load_scene", [](const std::string& path) { return std::make_shared<SceneFile>(load_scene(path)); },
      py::arg("path"), Unlocked(),
      "A scene from its XML file, with q, v, u. Raises InputError (a ValueError) \"FILE:LINE: what is wrong\".");
  m.def(
      "load_scene_text",
      [](const std::string& text, const std::string& path) {
        return std::make_shared<SceneFile>(load_scene_text(text, path));
      },
      py::arg("text"), py::arg("path") = "scene.xml", Unlocked(),
      "A scene from XML text, as if it stood in the file `path`: URDF files are found relative to that.");
}

}  // namespace

void add_scenes(py::module_& m) {
  add_placements(m);
  add_models(m);
  add_contacts(m);
  add_scene(m);
  add_files(m);
}

}  // namespace manycontact::python
