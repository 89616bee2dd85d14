#include <optional>
#include <variant>

#include "manycontact/io/urdf.hpp"
#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

using Placement = SE3<double>;

constexpr double kOrthonormal = 1e-6;  // tolerance of R^T R = 1, as for quaternions in files

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
  value<Placement>(m, "SE3")
      .def(py::init(&placement))
      .def_static("from_quaternion", &placement_of_quaternion)
      .def_static("Identity", &Placement::Identity)
      .read(
          "R", [](const Placement& M) { return copy(M.R); }, "p",
          [](const Placement& M) -> Eigen::Vector3d { return M.p; }, "rotation",
          [](const Placement& M) { return copy(M.R); }, "translation",
          [](const Placement& M) -> Eigen::Vector3d { return M.p; }, "quaternion",
          [](const Placement& M) { return quaternion_of_rotation<double>(M.R); })
      .def("inverse", &Placement::inverse)
      .def("__mul__", [](const Placement& a, const Placement& b) { return a * b; })
      .def("act", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act(v); })
      .def("act_inverse", [](const Placement& M, const Vec6<double>& v) -> Vec6<double> { return M.act_inverse(v); })
      .def("act_force", [](const Placement& M, const Vec6<double>& f) -> Vec6<double> { return M.act_force(f); })
      .def("action", &Placement::action)
      .def("__repr__", [](const Placement& M) {
        const auto x = pose_of_placement(M);
        std::ostringstream out;
        out << "SE3(p=[" << x[0] << ", " << x[1] << ", " << x[2] << "], quaternion=[" << x[3] << ", " << x[4] << ", "
            << x[5] << ", " << x[6] << "])";
        return out.str();
      });
}

// Returns a list of a model's joints or frames, which keeps the model alive.
template <class T>
Items<std::shared_ptr<T>> items_of(const std::shared_ptr<Model>& model, std::vector<T> Model::*list,
                                   int (Model::*find)(const std::string&) const) {
  return {[model, list] { return (*model.*list).size(); },
          [model, list](std::size_t k) { return std::shared_ptr<T>(model, &(*model.*list)[k]); },
          [model, find](const std::string& name) { return (*model.*find)(name); }};
}

void add_joints(py::module_& m) {
  enumeration<JointType>(m);

  value<Joint, std::shared_ptr<Joint>>(m)
      .read<&Joint::name, &Joint::type, &Joint::parent, &Joint::idx_q, &Joint::idx_v, &Joint::nq, &Joint::nv,
            &Joint::placement, &Joint::axis, &Joint::lower, &Joint::upper, &Joint::velocity_limit,
            &Joint::effort_limit>()
      .read("mass", [](const Joint& j) { return j.inertia.m; });

  value<Frame, std::shared_ptr<Frame>>(m).read<&Frame::name, &Frame::joint, &Frame::placement>();

  add_items<std::shared_ptr<Joint>>(m, "JointList");
  add_items<std::shared_ptr<Frame>>(m, "FrameList");
}

void add_findings(py::module_& m) {
  value<Finding>(m).read<&Finding::kind, &Finding::name, &Finding::text, &Finding::file, &Finding::line>().def(
      "__repr__", [](const Finding& f) {
        return f.file + ":" + std::to_string(f.line) + ": " + f.kind + ": " + f.name + ": " + f.text;
      });
}

using OneOrMany = std::variant<double, Eigen::VectorXd>;

// Expands `given`, which is one number for all joints or coordinates, or `count` numbers, to `count` numbers.
Eigen::VectorXd per(const char* name, const OneOrMany& given, Eigen::Index count) {
  const Eigen::VectorXd x =
      given.index() == 0 ? Eigen::VectorXd(Eigen::VectorXd::Constant(count, std::get<0>(given))) : std::get<1>(given);
  if (x.size() != count || !x.allFinite())
    throw py::value_error(std::string(name) + ": one finite number or " + std::to_string(count) +
                          " finite numbers are expected");
  return x;
}

// Expands `given` to one number per velocity. A single number applies to every joint except a floating base.
Eigen::VectorXd per_velocity(const char* name, const OneOrMany& given, const Model& model) {
  Eigen::VectorXd x = per(name, given, model.nv);
  for (const Joint& joint : model.joints)
    if (given.index() == 0 && joint.type == JointType::kFloating) x.segment<6>(joint.idx_v).setZero();
  return x;
}

// Returns a copy of a model whose bodies and frames are scaled by mass and length about the origins of their joints.
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
      throw py::value_error(std::string(name) + ": numbers of 0 or more are expected");
  };
  set("armature", armature, &Model::armature);
  set("damping", damping, &Model::damping);
  set("friction", friction, &Model::friction);
  finalize(*out);
  return out;
}

void add_robot_models(py::module_& m) {
  value<Model, std::shared_ptr<Model>>(m)
      .read<&Model::name, &Model::floating_base, &Model::nq, &Model::nv, &Model::nu, &Model::armature>()
      .read(
          "joints",
          [](const std::shared_ptr<Model>& x) {
            auto joints = items_of(x, &Model::joints, &Model::find_joint);
            joints.none = [x](const std::string& name) { return no_joint(*x, name); };
            return joints;
          },
          "frames",
          [](const std::shared_ptr<Model>& x) {
            auto frames = items_of(x, &Model::frames, &Model::find_frame);
            frames.none = [x](const std::string& name) { return no_frame(x->name, *x, name); };
            return frames;
          })
      .methods<&varied, &Model::find_frame, &Model::find_joint, &Model::mass>()
      .def("__repr__", [](const Model& x) { return "<Model '" + x.name + "', nv = " + std::to_string(x.nv) + ">"; });

  // Reads names from any iterable, such as a list or a set, but refuses a single string.
  const auto names = [](const char* what, const py::iterable& given) {
    if (py::isinstance<py::str>(given))
      throw py::type_error(std::string("load_urdf: ") + what + " is a string, a list of names is expected");
    std::set<std::string> out;
    for (const py::handle name : given) out.insert(name.cast<std::string>());
    return out;
  };
  def(m, "load_urdf",
      [names](const std::string& path, bool floating_base, double armature,
              const std::map<std::string, std::vector<double>>& joint_armature,
              const std::map<std::string, double>& locked, bool refuse_mimic, const py::iterable& passive,
              bool model_dynamics, bool refuse_inertia, const py::iterable& actuated,
              const std::map<std::string, double>& joint_damping, const std::string& root) {
        return std::make_shared<Model>(
            load_urdf(path, {floating_base, armature, joint_armature, locked, refuse_mimic, names("passive", passive),
                             model_dynamics, refuse_inertia, names("actuated", actuated), joint_damping, root}));
      });
  def(m, "urdf_findings", [](const std::string& path, bool floating_base) {
    std::vector<Finding> findings;
    UrdfOptions options;
    options.floating_base = floating_base;
    (void)load_urdf(path, options, &findings);
    return findings;
  });
}

}  // namespace

void add_models(py::module_& m) {
  add_placements(m);
  add_joints(m);
  add_findings(m);
  add_robot_models(m);
}

}  // namespace manycontact::python
