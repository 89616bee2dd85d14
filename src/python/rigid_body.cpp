// Dynamics, kinematics and configurations of robots without contacts, and contact Jacobians of a scene.

#include "manycontact/algorithm/rigid_body.hpp"

#include <random>

#include "docs/analysis.hpp"
#include "docs/configurations.hpp"
#include "docs/frames.hpp"
#include "docs/rigid_bodies.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "rigid_bodies.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Input = Eigen::Ref<const Vector>;
using Memory = std::shared_ptr<RigidBodyData>;
using Forces = std::optional<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>;
using Three = std::tuple<Matrix, Matrix, Matrix>;

// work(data) with the data given, or for None with new ones.
template <class Work>
auto with(const RigidBodies& bodies, const Memory& data, Work&& work) {
  if (data) return work(*data);
  RigidBodyData own(bodies);
  return work(own);
}

std::vector<Vec6<double>> wrenches(const Forces& fext) {
  std::vector<Vec6<double>> out;
  for (Eigen::Index i = 0; fext && i < fext->rows(); ++i) out.push_back(fext->row(i).transpose());
  return out;
}

void add_bodies(py::module_& m) {
  py::class_<Bodies, std::shared_ptr<Bodies>> c(
      m, "RigidBodies",
      "A selection for rnea and similar functions: one robot of a scene, with q and v of its own, or a placed\n"
      "model.\n"
      "\n"
      "A Scene alone means all of its robots, and a Model alone is at the origin with gravity (0, 0, -9.81).");
  c.def(py::init([](std::shared_ptr<Scene> scene, const std::string& robot) {
          const RigidBodies view(*scene, robot);
          return std::make_shared<Bodies>(Bodies{std::move(scene), view});
        }),
        py::arg("scene").none(false), py::arg("robot"))
      .def(py::init([](std::shared_ptr<Model> model, const SE3<double>& base, const Eigen::Vector3d& gravity) {
             const RigidBodies view(*model, base, gravity);
             return std::make_shared<Bodies>(Bodies{std::move(model), view});
           }),
           py::arg("model").none(false), py::arg_v("base", SE3<double>(), "SE3()"),
           py::arg("gravity") = Eigen::Vector3d(0, 0, -9.81),
           "Select a model, with the placement of a fixed base and gravity (3) [m/s^2].")
      .def_property_readonly(
          "nq", [](const Bodies& b) { return b.view->nq(); }, "Number of configuration coordinates.")
      .def_property_readonly(
          "nv", [](const Bodies& b) { return b.view->nv(); }, "Number of velocity coordinates.")
      .def_property_readonly(
          "njoints", [](const Bodies& b) { return b.view->njoints(); }, "Movable joints, floating bases included.");
  py::class_<RigidBodyData, Memory>(
      m, "RigidBodyData",
      "State and workspace of rnea, aba, crba, forward_kinematics, and of functions of frames, for given bodies.\n"
      "\n"
      "It starts at the neutral configuration, at rest.")
      .def(py::init<const RigidBodies&>(), py::arg("bodies"), py::keep_alive<1, 2>());
  m.def("frame_names", &frame_names, py::arg("bodies"), doc::frame_names);
  m.def("joint_names", &joint_names, py::arg("bodies"), doc::joint_names);
  m.def("frame_called", &frame_called, py::arg("bodies"), py::arg("name"), doc::frame_called);
  m.attr("frame_id") = m.attr("frame_called");
  m.def(
      "joint_called",
      [](const RigidBodies& bodies, const std::string& name) {
        const BodyJoint joint = joint_called(bodies, name);
        return std::make_tuple(joint.robot, joint.joint);
      },
      py::arg("bodies"), py::arg("name"), doc::joint_called);
  m.attr("joint_id") = m.attr("joint_called");
}

void add_manifold(py::module_& m) {
  m.def("neutral", py::overload_cast<const RigidBodies&>(&neutral), py::arg("bodies"), doc::neutral);
  m.def(
      "random_configuration",
      [](const RigidBodies& bodies, unsigned seed) {
        std::mt19937 generator(seed);
        return random_configuration(bodies, generator);
      },
      py::arg("bodies"), py::arg("seed"), doc::random_configuration);
  m.def(
      "random_velocity",
      [](const RigidBodies& bodies, unsigned seed) {
        std::mt19937 generator(seed);
        return random_velocity(bodies, generator);
      },
      py::arg("bodies"), py::arg("seed"), doc::random_velocity);
  m.def("integrate", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&integrate), py::arg("bodies"),
        py::arg("q"), py::arg("v"), doc::integrate);
  m.def("difference", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&difference), py::arg("bodies"),
        py::arg("q0"), py::arg("q1"), doc::difference);
  m.def("interpolate", &interpolate, py::arg("bodies"), py::arg("q0"), py::arg("q1"), py::arg("share"),
        doc::interpolate);
  m.def(
      "integrate_derivatives",
      [](const RigidBodies& bodies, const Input& q, const Input& v) {
        IntegrateDerivatives d = integrate_derivatives(bodies, q, v);
        return std::make_tuple(std::move(d.dq), std::move(d.dv));
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), doc::integrate_derivatives);
  m.def(
      "difference_derivatives",
      [](const RigidBodies& bodies, const Input& q0, const Input& q1) {
        DifferenceDerivatives d = difference_derivatives(bodies, q0, q1);
        return std::make_tuple(std::move(d.dq0), std::move(d.dq1));
      },
      py::arg("bodies"), py::arg("q0"), py::arg("q1"), doc::difference_derivatives);
}

void add_joint_space(py::module_& m) {
  m.def(
      "rnea",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& a, const Memory& data,
         const Forces& fext) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return rnea(bodies, q, v, a, d, wrenches(fext)); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("a"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(), doc::rnea);
  m.def(
      "nonlinear_effects",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Memory& data) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return nonlinear_effects(bodies, q, v, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("data") = py::none(), doc::nonlinear_effects);
  m.def(
      "gravity_torques",
      [](const RigidBodies& bodies, const Input& q, const Memory& data) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return gravity_torques(bodies, q, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("data") = py::none(), doc::gravity_torques);
  m.def(
      "aba",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& tau, const Memory& data,
         const Forces& fext) -> Vector {
        return with(bodies, data,
                    [&](RigidBodyData& d) -> Vector { return aba(bodies, q, v, tau, d, wrenches(fext)); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("tau"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(), doc::aba);
  m.def(
      "crba",
      [](const RigidBodies& bodies, const Input& q, const Memory& data) -> Matrix {
        return with(bodies, data, [&](RigidBodyData& d) -> Matrix { return crba(bodies, q, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("data") = py::none(), doc::crba);
  m.def(
      "inverse_inertia_times",
      [](const RigidBodies& bodies, const Input& q, py::handle x, const Memory& data) -> py::array {
        const Doubles X = as_doubles(x, true);
        if (!X || X.ndim() > 2 || X.shape(0) != bodies.nv())
          throw py::value_error("inverse_inertia_times: x has to have the shape (nv,) or (nv, n), here (" +
                                std::to_string(bodies.nv()) + ",) or (" + std::to_string(bodies.nv()) + ", n)");
        check_numbers("x", X.data(), X.size());
        using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const Matrix columns =
            Eigen::Map<const Rows>(X.data(), X.shape(0), X.ndim() == 2 ? X.shape(1) : py::ssize_t(1));
        const Matrix out = with(
            bodies, data, [&](RigidBodyData& d) -> Matrix { return inverse_inertia_times(bodies, q, columns, d); });
        return X.ndim() == 2 ? copy(out) : copy(Vector(out.col(0)));
      },
      py::arg("bodies"), py::arg("q"), py::arg("x"), py::arg("data") = py::none(), doc::inverse_inertia_times);
  m.def(
      "coriolis_matrix",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Memory& data) -> Matrix {
        return with(bodies, data, [&](RigidBodyData& d) -> Matrix { return coriolis_matrix(bodies, q, v, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("data") = py::none(), doc::coriolis_matrix);
  m.def(
      "rnea_derivatives",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& a, const Memory& data,
         const Forces& fext) -> Three {
        return with(bodies, data, [&](RigidBodyData& d) -> Three {
          const TorqueDerivatives& out = rnea_derivatives(bodies, q, v, a, d, wrenches(fext));
          return {out.dq, out.dv, out.da};
        });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("a"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(), doc::rnea_derivatives);
  m.def(
      "aba_derivatives",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& tau, const Memory& data,
         const Forces& fext) -> Three {
        return with(bodies, data, [&](RigidBodyData& d) -> Three {
          const AccelerationDerivatives& out = aba_derivatives(bodies, q, v, tau, d, wrenches(fext));
          return {out.dq, out.dv, out.dtau};
        });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("tau"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(), doc::aba_derivatives);
}

using MotionOfFrame = Vec6<double> (*)(const RigidBodies&, RigidBodyData&, const Attachment&, ReferenceFrame);

void add_motion(py::module_& m, const char* name, MotionOfFrame motion, const char* doc) {
  m.def(
      name,
      [motion](const RigidBodies& bodies, RigidBodyData& data, const FrameName& frame,
               ReferenceFrame axes) -> Vec6<double> { return motion(bodies, data, frame.in(bodies), axes); },
      py::arg("bodies"), py::arg("data"), py::arg("frame"),
      py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"), doc);
}

void add_body_frames(py::module_& m) {
  m.def(
      "forward_kinematics",
      [](const RigidBodies& bodies, RigidBodyData& data, const Input& q, const std::optional<Vector>& v,
         const std::optional<Vector>& a) {
        if (a && !v) throw py::value_error("forward_kinematics: a is given, but not v");
        if (a)
          forward_kinematics(bodies, q, *v, *a, data);
        else if (v)
          forward_kinematics(bodies, q, *v, data);
        else
          forward_kinematics(bodies, q, data);
      },
      py::arg("bodies"), py::arg("data"), py::arg("q"), py::arg("v") = py::none(), py::arg("a") = py::none(),
      doc::forward_kinematics);
  m.def(
      "frame_placement",
      [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame) {
        return frame_placement(bodies, data, frame.in(bodies));
      },
      py::arg("bodies"), py::arg("data"), py::arg("frame"), doc::frame_placement);
  add_motion(m, "frame_velocity", &frame_velocity, doc::frame_velocity);
  add_motion(m, "frame_acceleration", &frame_acceleration, doc::frame_acceleration);
  add_motion(m, "frame_classical_acceleration", &frame_classical_acceleration, doc::frame_classical_acceleration);
  add_motion(m, "frame_drift", &frame_drift, doc::frame_drift);
  m.def(
      "frame_jacobian",
      [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame, ReferenceFrame axes) {
        return frame_jacobian(bodies, data, frame.in(bodies), axes);
      },
      py::arg("bodies"), py::arg("data"), py::arg("frame"),
      py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"), doc::frame_jacobian);
  m.def(
      "joint_wrench",
      [](const RigidBodies& bodies, const RigidBodyData& data, const std::string& joint) {
        return joint_wrench(bodies, data, joint_called(bodies, joint));
      },
      py::arg("bodies"), py::arg("data"), py::arg("joint"), doc::joint_wrench);
}

template <class Get>
void add_whole(py::module_& m, const char* name, Get get, const char* doc) {
  m.def(
      name, [get](const RigidBodies& bodies, RigidBodyData& data) { return get(bodies, data); }, py::arg("bodies"),
      py::arg("data"), doc);
}

void add_wholes(py::module_& m) {
  m.def("total_mass", &total_mass, py::arg("bodies"), doc::total_mass);
  add_whole(m, "center_of_mass", &center_of_mass, doc::center_of_mass);
  add_whole(m, "center_of_mass_velocity", &center_of_mass_velocity, doc::center_of_mass_velocity);
  add_whole(m, "center_of_mass_acceleration", &center_of_mass_acceleration, doc::center_of_mass_acceleration);
  add_whole(m, "center_of_mass_jacobian", &center_of_mass_jacobian, doc::center_of_mass_jacobian);
  add_whole(m, "centroidal_momentum", &centroidal_momentum, doc::centroidal_momentum);
  add_whole(m, "centroidal_momentum_matrix", &centroidal_momentum_matrix, doc::centroidal_momentum_matrix);
  add_whole(m, "centroidal_momentum_rate", &centroidal_momentum_rate, doc::centroidal_momentum_rate);
  add_whole(m, "kinetic_energy", &kinetic_energy, doc::kinetic_energy);
  add_whole(m, "potential_energy", &potential_energy, doc::potential_energy);
}

Matrix rows_of(const std::vector<Vec6<double>>& wrenches) {
  Matrix out(static_cast<Eigen::Index>(wrenches.size()), 6);
  for (std::size_t i = 0; i < wrenches.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = wrenches[i].transpose();
  return out;
}

std::vector<char> flags_or_scene(const Scene& scene, const py::object& active) {
  std::vector<char> flags;
  for (const Contact& contact : scene.contacts) flags.push_back(contact.active);
  if (!active.is_none()) set_flags("active", active, flags);
  return flags;
}

void add_contact_rows(py::module_& m) {
  m.def(
      "contact_jacobian",
      [](const Scene& scene, const Input& q, const py::object& active) {
        return contact_jacobian(scene, q, flags_or_scene(scene, active));
      },
      py::arg("scene"), py::arg("q"), py::arg("active") = py::none(), doc::contact_jacobian);
  m.def(
      "contact_drift",
      [](const Scene& scene, const Input& q, const Input& v, const py::object& active) {
        return contact_drift(scene, q, v, flags_or_scene(scene, active));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("active") = py::none(), doc::contact_drift);
  m.def(
      "contact_forces_on_bodies",
      [](const Scene& scene, const Input& q, const Input& f, const std::vector<int>& f_offset) {
        return rows_of(contact_forces_on_bodies(scene, q, f, f_offset));
      },
      py::arg("scene"), py::arg("q"), py::arg("f"), py::arg("f_offset"), doc::contact_forces_on_bodies);
}

}  // namespace

void add_rigid_bodies(py::module_& m) {
  add_bodies(m);
  add_manifold(m);
  add_joint_space(m);
  add_body_frames(m);
  add_wholes(m);
  add_contact_rows(m);
}

}  // namespace manycontact::python
