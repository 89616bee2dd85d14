// Dynamics, kinematics and configurations of robots without contacts; contact Jacobians of a scene: floors model,
// algorithm and contact.

#include "manycontact/algorithm/rigid_body.hpp"

#include <random>

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
      "One robot of a scene with q and v of its own, or a model somewhere: what rnea and alike take where a Scene "
      "(all\n"
      "of its robots) and a Model (at the origin, gravity (0, 0, -9.81)) do not say enough.");
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
           "base: where the base of a fixed one stands. gravity: (3) [m/s^2].")
      .def_property_readonly("nq", [](const Bodies& b) { return b.view->nq(); })
      .def_property_readonly("nv", [](const Bodies& b) { return b.view->nv(); })
      .def_property_readonly(
          "njoints", [](const Bodies& b) { return b.view->njoints(); }, "Movable joints, floating bases included.");
  py::class_<RigidBodyData, Memory>(
      m, "RigidBodyData",
      "State and memory of rnea, aba, crba, forward_kinematics and what is asked of frames and of the whole then; for\n"
      "the bodies it was made for. It starts at the neutral configuration.")
      .def(py::init<const RigidBodies&>(), py::arg("bodies"), py::keep_alive<1, 2>());
  m.def("frame_names", &frame_names, py::arg("bodies"), "Links: 'knee' where there is one robot, else 'r0/knee'.");
  m.def("joint_names", &joint_names, py::arg("bodies"), "Movable joints, in the order of numbers, alike.");
  m.def("frame_called", &frame_called, py::arg("bodies"), py::arg("name"),
        "The Attachment of a link, or of the one that a joint of that name carries: 'knee' where there is one robot,\n"
        "'r0/knee' always.");
  m.def(
      "joint_called",
      [](const RigidBodies& bodies, const std::string& name) {
        const BodyJoint joint = joint_called(bodies, name);
        return std::make_tuple(joint.robot, joint.joint);
      },
      py::arg("bodies"), py::arg("name"), "Numbers of the robot in its scene and of the joint in its model.");
}

void add_manifold(py::module_& m) {
  m.def("neutral", py::overload_cast<const RigidBodies&>(&neutral), py::arg("bodies"),
        "The configuration (nq) with joints at zero and floating bases where Robot.base has them.");
  m.def(
      "random_configuration",
      [](const RigidBodies& bodies, unsigned seed) {
        std::mt19937 generator(seed);
        return random_configuration(bodies, generator);
      },
      py::arg("bodies"), py::arg("seed"), "A configuration (nq) within the joints' limits, any orientation of bases.");
  m.def(
      "random_velocity",
      [](const RigidBodies& bodies, unsigned seed) {
        std::mt19937 generator(seed);
        return random_velocity(bodies, generator);
      },
      py::arg("bodies"), py::arg("seed"), "A velocity (nv) within the joints' limits, else +-1 [m/s, rad/s].");
  m.def("integrate", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&integrate), py::arg("bodies"),
        py::arg("q"), py::arg("v"), "q (+) v (nq): reached from q by the velocity v (nv) held for unit time.");
  m.def("difference", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&difference), py::arg("bodies"),
        py::arg("q0"), py::arg("q1"), "q1 (-) q0 (nv): the v with integrate(bodies, q0, v) = q1.");
  m.def("interpolate", &interpolate, py::arg("bodies"), py::arg("q0"), py::arg("q1"), py::arg("share"),
        "q0 (+) share (q1 (-) q0) (nq): q0 at 0, q1 at 1.");
  m.def(
      "integrate_derivatives",
      [](const RigidBodies& bodies, const Input& q, const Input& v) {
        IntegrateDerivatives d = integrate_derivatives(bodies, q, v);
        return std::make_tuple(std::move(d.dq), std::move(d.dv));
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"),
      "Of q (+) v by q and by v, (nv, nv) each, on the tangent spaces at q and q (+) v.");
  m.def(
      "difference_derivatives",
      [](const RigidBodies& bodies, const Input& q0, const Input& q1) {
        DifferenceDerivatives d = difference_derivatives(bodies, q0, q1);
        return std::make_tuple(std::move(d.dq0), std::move(d.dq1));
      },
      py::arg("bodies"), py::arg("q0"), py::arg("q1"),
      "Of q1 (-) q0 by q0 and by q1, (nv, nv) each, on the tangent spaces at q0 and q1.");
}

void add_joint_space(py::module_& m) {
  m.def(
      "rnea",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& a, const Memory& data,
         const Forces& fext) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return rnea(bodies, q, v, a, d, wrenches(fext)); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("a"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(),
      "Torques tau (nv) [N m, N] that give the accelerations a (nv) at q (nq), v (nv), without contacts:\n\n"
      "    tau = M(q) a + h(q, v) - sum J^T fext        h = C(q, v) v + g(q) - tau_f(v)\n\n"
      "bodies: a Scene (all its robots), a Model or RigidBodies (one robot of a scene). tau_f: the joints' friction,\n"
      "where it is modelled. fext: (njoints, 6) wrenches on the bodies, in their joints' child frames.\n"
      "data: RigidBodyData, which is at q, v, a then; None: new ones.");
  m.def(
      "nonlinear_effects",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Memory& data) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return nonlinear_effects(bodies, q, v, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("data") = py::none(),
      "h(q, v) (nv) [N m, N]: rnea without accelerations.");
  m.def(
      "gravity_torques",
      [](const RigidBodies& bodies, const Input& q, const Memory& data) -> Vector {
        return with(bodies, data, [&](RigidBodyData& d) -> Vector { return gravity_torques(bodies, q, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("data") = py::none(),
      "g(q) (nv) [N m, N]: what holds the robots still without contacts.");
  m.def(
      "aba",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Input& tau, const Memory& data,
         const Forces& fext) -> Vector {
        return with(bodies, data,
                    [&](RigidBodyData& d) -> Vector { return aba(bodies, q, v, tau, d, wrenches(fext)); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("tau"), py::arg("data") = py::none(),
      py::arg("fext") = py::none(),
      "Accelerations a (nv) [m/s^2, rad/s^2] by torques tau (nv), without contacts: undoes rnea. NaN for a robot "
      "whose\n"
      "M is singular.");
  m.def(
      "crba",
      [](const RigidBodies& bodies, const Input& q, const Memory& data) -> Matrix {
        return with(bodies, data, [&](RigidBodyData& d) -> Matrix { return crba(bodies, q, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("data") = py::none(),
      "The joint-space inertia M (nv, nv), armature included; zero between robots.");
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
      py::arg("bodies"), py::arg("q"), py::arg("x"), py::arg("data") = py::none(),
      "M^-1 x of a vector (nv) or of columns (nv, n), by L^T D L along the trees; M^-1 is not formed. NaN for a robot\n"
      "whose M is singular.");
  m.def(
      "coriolis_matrix",
      [](const RigidBodies& bodies, const Input& q, const Input& v, const Memory& data) -> Matrix {
        return with(bodies, data, [&](RigidBodyData& d) -> Matrix { return coriolis_matrix(bodies, q, v, d); });
      },
      py::arg("bodies"), py::arg("q"), py::arg("v"), py::arg("data") = py::none(),
      "C (nv, nv) with C v the Coriolis and centrifugal torques, and dM/dt - 2 C skew.");
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
      py::arg("fext") = py::none(), "rnea's tau by q (on the tangent space), v and a: three (nv, nv).");
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
      py::arg("fext") = py::none(), "aba's a by q (on the tangent space), v and tau: three (nv, nv).");
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
      "Takes the data to q (nq), v (nv), a (nv); zero where they are not given.");
  m.def(
      "frame_placement",
      [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame) {
        return frame_placement(bodies, data, frame.in(bodies));
      },
      py::arg("bodies"), py::arg("data"), py::arg("frame"),
      "SE3 oMf in the world of a frame, a name or an Attachment, at the data's state.");
  add_motion(
      m, "frame_velocity", &frame_velocity,
      "Spatial velocity (6), linear first [m/s, rad/s], at the data's state. Axes: LOCAL: the frame's own, at its\n"
      "origin; WORLD: the world's, at the world's origin; LOCAL_WORLD_ALIGNED: the world's, at the frame's.");
  add_motion(m, "frame_acceleration", &frame_acceleration, "Spatial acceleration (6) [m/s^2, rad/s^2].");
  add_motion(m, "frame_classical_acceleration", &frame_classical_acceleration,
             "The same with the acceleration of the frame's origin as a point for its linear part.");
  add_motion(m, "frame_drift", &frame_drift, "(dJ/dt) v (6): frame_velocity's numbers change in time by J a + this.");
  m.def(
      "frame_jacobian",
      [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame, ReferenceFrame axes) {
        return frame_jacobian(bodies, data, frame.in(bodies), axes);
      },
      py::arg("bodies"), py::arg("data"), py::arg("frame"),
      py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"), "J (6, nv): frame_velocity = J v.");
  m.def(
      "joint_wrench",
      [](const RigidBodies& bodies, const RigidBodyData& data, const std::string& joint) {
        return joint_wrench(bodies, data, joint_called(bodies, joint));
      },
      py::arg("bodies"), py::arg("data"), py::arg("joint"),
      "What a joint carries: the wrench (6) on its child body, force [N] and moment [N m] in the child frame, about "
      "its\n"
      "origin, by the last rnea, nonlinear_effects or gravity_torques. The child is the file's, whichever link is the\n"
      "root. In a scene with contacts, pushes or springs: rnea with the accelerations of solve and\n"
      "fext=forces_on_bodies(scene, q, v, data).");
}

template <class Get>
void add_whole(py::module_& m, const char* name, Get get, const char* doc) {
  m.def(
      name, [get](const RigidBodies& bodies, RigidBodyData& data) { return get(bodies, data); }, py::arg("bodies"),
      py::arg("data"), doc);
}

void add_wholes(py::module_& m) {
  m.def("total_mass", &total_mass, py::arg("bodies"), "[kg]; without what is merged into a fixed base.");
  add_whole(m, "center_of_mass", &center_of_mass, "(3) in the world [m], at the data's state.");
  add_whole(m, "center_of_mass_velocity", &center_of_mass_velocity, "(3) [m/s]");
  add_whole(m, "center_of_mass_acceleration", &center_of_mass_acceleration, "(3) [m/s^2]");
  add_whole(m, "center_of_mass_jacobian", &center_of_mass_jacobian, "(3, nv): its velocity is J v.");
  add_whole(m, "centroidal_momentum", &centroidal_momentum,
            "Momentum (6) about the centre of mass, in the world's axes: linear [N s], angular [N m s].");
  add_whole(m, "centroidal_momentum_matrix", &centroidal_momentum_matrix, "A (6, nv): the momentum is A v.");
  add_whole(m, "centroidal_momentum_rate", &centroidal_momentum_rate,
            "Its rate (6) [N, N m] at the data's v and a: the sum of all outer forces about the centre of mass.");
  add_whole(m, "kinetic_energy", &kinetic_energy, "[J], rotors included.");
  add_whole(m, "potential_energy", &potential_energy, "[J], zero at the world's origin.");
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
      py::arg("scene"), py::arg("q"), py::arg("active") = py::none(),
      "J (rows, nv) of the active contacts at q (nq), in the scene's order: J a + a0 = 0, M a + h = S^T u + J^T f.\n"
      "active: one bool per contact; by default as the scene has them.");
  m.def(
      "contact_drift",
      [](const Scene& scene, const Input& q, const Input& v, const py::object& active) {
        return contact_drift(scene, q, v, flags_or_scene(scene, active));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("active") = py::none(),
      "a0 (rows) [m/s^2, rad/s^2]: (dJ/dt) v, and what gains ask for.");
  m.def(
      "contact_forces_on_bodies",
      [](const Scene& scene, const Input& q, const Input& f, const std::vector<int>& f_offset) {
        return rows_of(contact_forces_on_bodies(scene, q, f, f_offset));
      },
      py::arg("scene"), py::arg("q"), py::arg("f"), py::arg("f_offset"),
      "The forces f of contacts alone (SceneData.f, with its f_offset) at q (nq) as rnea's fext (njoints, 6).");
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
