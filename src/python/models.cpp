// Placements, models and URDF files.

#include <optional>
#include <variant>

#include "docs/scene.hpp"
#include "manycontact/io/urdf.hpp"
#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

using Placement = SE3<double>;

constexpr double kOrthonormal = 1e-6;  // tolerance, equal to that for the unit length of quaternions in files

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
  py::class_<Placement> c(
      m, "SE3", "A placement aMb: x_a = R x_b + p converts coordinates from frame b to frame a. It is immutable.");
  add_value(c)
      .def(py::init(&placement), py::arg_v("R", Eigen::Matrix3d(Eigen::Matrix3d::Identity()), "numpy.eye(3)"),
           py::arg("p") = Eigen::Vector3d(Eigen::Vector3d::Zero()),
           "Make a placement from a rotation matrix (3, 3) and a translation (3) [m].")
      .def_static("from_quaternion", &placement_of_quaternion, py::arg("xyzw"),
                  py::arg("p") = Eigen::Vector3d(Eigen::Vector3d::Zero()),
                  "Make a placement from a unit quaternion (x, y, z, w) and a translation (3) [m].")
      .def_static("Identity", &Placement::Identity)
      .def_property_readonly(
          "R", [](const Placement& M) { return copy(M.R); },
          "Rotation matrix (3, 3); an array that cannot be written into.")
      .def_property_readonly(
          "p", [](const Placement& M) -> Eigen::Vector3d { return M.p; }, "Translation (3) [m].")
      .def_property_readonly(
          "rotation", [](const Placement& M) { return copy(M.R); }, "Pinocchio's name of R.")
      .def_property_readonly(
          "translation", [](const Placement& M) -> Eigen::Vector3d { return M.p; }, "Pinocchio's name of p.")
      .def_property_readonly(
          "quaternion", [](const Placement& M) { return quaternion_of_rotation<double>(M.R); },
          "Unit quaternion (x, y, z, w), w >= 0.")
      .def("inverse", &Placement::inverse, "bMa.")
      .def(
          "__mul__", [](const Placement& a, const Placement& b) { return a * b; }, "Return the product aMc = aMb bMc.")
      .def(
          "act", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act(v); }, py::arg("motion"),
          "Convert a motion (6, linear part first) from frame b to frame a.")
      .def(
          "act_inverse", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act_inverse(v); },
          py::arg("motion"), "Convert a motion (6, linear part first) from frame a to frame b.")
      .def(
          "act_force", [](const Placement& M, const Vec6<double>& f) -> Vec6<double> { return M.act_force(f); },
          py::arg("force"), "Convert a force (6, linear part first) from frame b to frame a.")
      .def("action", &Placement::action, "Return the matrix (6, 6) of act.")
      .def("__repr__", [](const Placement& M) {
        const auto x = pose_of_placement(M);
        std::ostringstream out;
        out << "SE3(p=[" << x[0] << ", " << x[1] << ", " << x[2] << "], quaternion=[" << x[3] << ", " << x[4] << ", "
            << x[5] << ", " << x[6] << "])";
        return out.str();
      });
}

// A list of a model's joints or frames, which keeps the model.
template <class T>
Items<std::shared_ptr<T>> items_of(const std::shared_ptr<Model>& model, std::vector<T> Model::*list,
                                   int (Model::*find)(const std::string&) const) {
  return {[model, list] { return (*model.*list).size(); },
          [model, list](std::size_t k) { return std::shared_ptr<T>(model, &(*model.*list)[k]); },
          [model, find](const std::string& name) { return (*model.*find)(name); }};
}

void add_joints(py::module_& m) {
  add_enumeration<JointType>(m, "JointType", "type of joint", "Types of joints.",
                             {{"REVOLUTE", JointType::kRevolute},
                              {"PRISMATIC", JointType::kPrismatic},
                              {"FLOATING", JointType::kFloating},
                              {"PLANAR", JointType::kPlanar}});

  py::class_<Joint, std::shared_ptr<Joint>> joint(
      m, "Joint", "A joint and the body that it moves. The joint frame is the child frame at q = 0.");
  add_value(joint)
      .def_readonly("name", &Joint::name, "Name.")
      .def_readonly("type", &Joint::type, "JointType.")
      .def_readonly("parent", &Joint::parent, "Number of the parent joint; -1: the robot's base.")
      .def_readonly("idx_q", &Joint::idx_q, "First coordinate in the model's q.")
      .def_readonly("idx_v", &Joint::idx_v, "First coordinate in the model's v.")
      .def_property_readonly("nq", &Joint::nq, "Number of coordinates in q.")
      .def_property_readonly("nv", &Joint::nv, "Number of coordinates in v.")
      .def_readonly("placement", &Joint::placement, "Placement of the joint frame in the parent joint's frame (SE3).")
      .def_readonly("axis", &Joint::axis, "Unit vector (3) in the joint frame.")
      .def_property_readonly(
          "mass", [](const Joint& j) { return j.inertia.m; }, "Mass of the body [kg].")
      .def_readonly("lower", &Joint::lower, "Lower position limits (nv) [rad, m]; -inf: none.")
      .def_readonly("upper", &Joint::upper, "Upper position limits (nv) [rad, m]; inf: none.")
      .def_readonly("velocity_limit", &Joint::velocity_limit, "Velocity limits (nv) [rad/s, m/s]; inf: none.")
      .def_readonly("effort_limit", &Joint::effort_limit, "Effort limits (nv) [N m, N]; inf: none.");

  py::class_<Frame, std::shared_ptr<Frame>> frame(m, "Frame",
                                                  "A named frame that is fixed to a joint's body, such as a link.");
  add_value(frame)
      .def_readonly("name", &Frame::name, "Name.")
      .def_readonly("joint", &Frame::joint, "Number of the joint; -1: fixed to the robot's base.")
      .def_readonly("placement", &Frame::placement, "Placement in the joint's frame (SE3).");

  add_items<std::shared_ptr<Joint>>(m, "JointList", "A model's joints, by number or name.", true);
  add_items<std::shared_ptr<Frame>>(m, "FrameList", "A model's frames, by number or name.", true);
}

void add_findings(py::module_& m) {
  py::class_<Finding> finding(m, "Finding", "Questionable but usable input, and how it is interpreted.");
  add_value(finding)
      .def_readonly("kind", &Finding::kind,
                    "'inertia', 'limits', 'unread', 'mimic', 'dynamics', 'passive', 'base', 'consistent', 'pose' or\n"
                    "'rest'.")
      .def_readonly("name", &Finding::name, "Name of the joint, link or other element.")
      .def_readonly("text", &Finding::text, "The content of the file, and how it is interpreted.")
      .def_readonly("file", &Finding::file, "Path of the file.")
      .def_readonly("line", &Finding::line, "Line in the file.")
      .def("__repr__", [](const Finding& f) {
        return f.file + ":" + std::to_string(f.line) + ": " + f.kind + ": " + f.name + ": " + f.text;
      });
}

using OneOrMany = std::variant<double, Eigen::VectorXd>;

// Factors or values per joint or coordinate: one number for all, or as many.
Eigen::VectorXd per(const char* name, const OneOrMany& given, Eigen::Index count) {
  const Eigen::VectorXd x =
      given.index() == 0 ? Eigen::VectorXd(Eigen::VectorXd::Constant(count, std::get<0>(given))) : std::get<1>(given);
  if (x.size() != count || !x.allFinite())
    throw py::value_error(std::string(name) + ": one finite number is expected, or " + std::to_string(count));
  return x;
}

// One value is that of every joint: a floating base has none. Otherwise there is one value for each velocity.
Eigen::VectorXd per_velocity(const char* name, const OneOrMany& given, const Model& model) {
  Eigen::VectorXd x = per(name, given, model.nv);
  for (const Joint& joint : model.joints)
    if (given.index() == 0 && joint.type == JointType::kFloating) x.segment<6>(joint.idx_v).setZero();
  return x;
}

// Scales bodies, with everything that is fixed on them, about the origins of their joints.
std::shared_ptr<Model> varied(const Model& of, const OneOrMany& mass, const OneOrMany& length,
                              const std::optional<OneOrMany>& armature, const std::optional<OneOrMany>& damping,
                              const std::optional<OneOrMany>& friction) {
  const Eigen::VectorXd masses = per("mass", mass, of.njoints()), lengths = per("length", length, of.njoints());
  if (!(masses.array() > 0).all() || !(lengths.array() > 0).all())
    throw py::value_error("mass, length: factors above 0 are expected");
  auto out = std::make_shared<Model>(of);
  const auto scale = [](Inertia<double>& Y, double m, double s) { Y.m *= m, Y.h *= m * s, Y.I *= m * s * s; };
  for (int i = 0; i < of.njoints(); ++i) {
    Joint& joint = out->joints[i];
    scale(joint.inertia, masses[i], lengths[i]);
    if (joint.parent >= 0) joint.placement.p *= lengths[joint.parent];
  }
  for (Frame& frame : out->frames) {
    if (frame.joint < 0) continue;
    frame.placement.p *= lengths[frame.joint];
    scale(frame.inertia, masses[frame.joint], lengths[frame.joint]);
  }
  const auto set = [&](const char* name, const std::optional<OneOrMany>& given, Eigen::VectorXd Model::*member) {
    if (!given) return;
    (*out).*member = per_velocity(name, *given, of);
    if (!(((*out).*member).array() >= 0).all())
      throw py::value_error(std::string(name) + ": no negative one is expected");
  };
  set("armature", armature, &Model::armature);
  set("damping", damping, &Model::damping);
  set("friction", friction, &Model::friction);
  finalize(*out);
  return out;
}

void add_robot_models(py::module_& m) {
  py::class_<Model, std::shared_ptr<Model>> model(m, "Model", "One robot or object: a kinematic tree. It is constant.");
  add_value(model)
      .def_readonly("name", &Model::name, "Name.")
      .def_readonly("floating_base", &Model::floating_base, "Whether joint 0 is a floating base.")
      .def_readonly("nq", &Model::nq, "Number of configuration coordinates.")
      .def_readonly("nv", &Model::nv, "Number of velocity coordinates.")
      .def_property_readonly("nu", &Model::nu,
                             "Number of actuated coordinates: all except those of a floating base and passive joints.")
      .def_property_readonly(
          "joints",
          [](const std::shared_ptr<Model>& x) {
            auto joints = items_of(x, &Model::joints, &Model::find_joint);
            joints.none = [x](const std::string& name) { return no_joint(*x, name); };
            return joints;
          },
          "Joints, by number or name.")
      .def_property_readonly(
          "frames",
          [](const std::shared_ptr<Model>& x) {
            auto frames = items_of(x, &Model::frames, &Model::find_frame);
            frames.none = [x](const std::string& name) { return no_frame(x->name, *x, name); };
            return frames;
          },
          "Frames, by number or name.")
      .def_readonly("armature", &Model::armature, "Reflected rotor inertia (nv) [kg m^2, kg].")
      .def("varied", &varied, py::kw_only(), py::arg("mass") = 1.0, py::arg("length") = 1.0,
           py::arg("armature") = py::none(), py::arg("damping") = py::none(), py::arg("friction") = py::none(),
           "Return a model of the same joints with other masses, lengths, armatures, damping and friction.\n"
           "\n"
           "Parameters\n"
           "----------\n"
           "mass, length : float or array (joints)\n"
           "    Factors above 0. A body is scaled, with all that is fixed on it, about the origin of its joint.\n"
           "armature, damping, friction : float or array (nv), optional\n"
           "    Values of 0 or more [kg m^2, N m s, N m]; one number is that of all joints except a floating base.\n"
           "    None leaves the values of this model.\n"
           "\n"
           "Raises\n"
           "------\n"
           "ValueError\n"
           "    A size does not fit, or a number is out of its range.")
      .def("find_frame", &Model::find_frame, py::arg("name"), "Return the number of the frame, or -1.")
      .def("find_joint", &Model::find_joint, py::arg("name"), "Return the number of the joint, or -1.")
      .def("mass", &Model::mass, "Return the total mass [kg].")
      .def("__repr__", [](const Model& x) { return "<Model '" + x.name + "', nv = " + std::to_string(x.nv) + ">"; });

  m.def(
      "load_urdf",
      [](const std::string& path, bool floating_base, double armature,
         const std::map<std::string, std::vector<double>>& joint_armature, const std::map<std::string, double>& locked,
         bool refuse_mimic, const std::set<std::string>& passive, bool model_dynamics, bool refuse_inertia,
         const std::set<std::string>& actuated, const std::map<std::string, double>& joint_damping,
         const std::string& root) {
        return std::make_shared<Model>(
            load_urdf(path, {floating_base, armature, joint_armature, locked, refuse_mimic, passive, model_dynamics,
                             refuse_inertia, actuated, joint_damping, root}));
      },
      py::arg("path"), py::kw_only(), py::arg("floating_base") = false, py::arg("armature") = 0.0,
      py::arg("joint_armature") = std::map<std::string, std::vector<double>>(),
      py::arg("locked") = std::map<std::string, double>(), py::arg("refuse_mimic") = false,
      py::arg("passive") = std::set<std::string>(), py::arg("model_dynamics") = false,
      py::arg("refuse_inertia") = false, py::arg("actuated") = std::set<std::string>(),
      py::arg("joint_damping") = std::map<std::string, double>(), py::arg("root") = "", doc::load_urdf);
  m.def(
      "urdf_findings",
      [](const std::string& path, bool floating_base) {
        std::vector<Finding> findings;
        UrdfOptions options;
        options.floating_base = floating_base;
        (void)load_urdf(path, options, &findings);
        return findings;
      },
      py::arg("path"), py::kw_only(), py::arg("floating_base") = false, doc::urdf_findings);
}

}  // namespace

void add_models(py::module_& m) {
  add_placements(m);
  add_joints(m);
  add_findings(m);
  add_robot_models(m);
}

}  // namespace manycontact::python
