// Dynamics, kinematics and configurations of robots without contacts, and contact Jacobians of a scene.

#include "manycontact/algorithm/rigid_body.hpp"

#include <random>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "rigid_bodies.hpp"

namespace manycontact::python {

namespace {

using Input = Eigen::Ref<const Vector>;
using Memory = std::shared_ptr<RigidBodyData>;
using Forces = std::optional<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>;
using Three = std::tuple<Matrix, Matrix, Matrix>;

// Calls work(data) with the given RigidBodyData. If Python passed None, uses new RigidBodyData.
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
  shared<Bodies>(m, "RigidBodies")
      .def(py::init([](std::shared_ptr<Scene> scene, const std::string& robot) {
        const RigidBodies view(*scene, robot);
        return std::make_shared<Bodies>(Bodies{std::move(scene), view});
      }))
      .def(py::init([](std::shared_ptr<Model> model, const SE3<double>& base, const Eigen::Vector3d& gravity) {
        const RigidBodies view(*model, base, gravity);
        return std::make_shared<Bodies>(Bodies{std::move(model), view});
      }))
      .read_at<&RigidBodies::nq, &RigidBodies::nv, &RigidBodies::njoints>(
          [](const Bodies& b) -> const RigidBodies& { return *b.view; });
  shared<RigidBodyData>(m).constructors<void(const RigidBodies&)>(py::keep_alive<1, 2>());
  functions<&frame_names, &joint_names, &find_frame>(m);
  def(m, "find_joint", [](const RigidBodies& bodies, const std::string& name) {
    const BodyJoint joint = find_joint(bodies, name);
    return std::make_tuple(joint.robot, joint.joint);
  });
}

auto seeded(Vector (*random)(const RigidBodies&, std::mt19937&)) {
  return [random](const RigidBodies& bodies, unsigned seed) {
    std::mt19937 generator(seed);
    return random(bodies, generator);
  };
}

void add_manifold(py::module_& m) {
  def(m, "neutral", py::overload_cast<const RigidBodies&>(&neutral));
  def(m, "random_configuration", seeded(&random_configuration));
  def(m, "random_velocity", seeded(&random_velocity));
  def(m, "integrate", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&integrate));
  def(m, "difference", py::overload_cast<const RigidBodies&, const Input&, const Input&>(&difference));
  def(m, "interpolate", &interpolate);
  def(m, "integrate_derivatives", [](const RigidBodies& bodies, const Input& q, const Input& v) {
    IntegrateDerivatives d = integrate_derivatives(bodies, q, v);
    return std::make_tuple(std::move(d.dq), std::move(d.dv));
  });
  def(m, "difference_derivatives", [](const RigidBodies& bodies, const Input& q0, const Input& q1) {
    DifferenceDerivatives d = difference_derivatives(bodies, q0, q1);
    return std::make_tuple(std::move(d.dq0), std::move(d.dq1));
  });
}

// Returns a function for Python that returns a copy of f(bodies, inputs, data). If `data` is None, uses new data.
template <class... Inputs, class F>
auto of_state(F f) {
  return [f](const RigidBodies& bodies, Inputs... in, const Memory& data) {
    return with(bodies, data, [&](RigidBodyData& d) { return f(bodies, in..., d); });
  };
}

// Returns a function like that of of_state, but with forces on the bodies, and with the result converted by `convert`.
template <class Result, class Convert = std::identity>
auto with_forces(const Result& (*f)(const RigidBodies&, const Input&, const Input&, const Input&, RigidBodyData&,
                                    ForcesOnBodies),
                 Convert convert = {}) {
  return [=](const RigidBodies& bodies, const Input& q, const Input& v, const Input& x, const Memory& data,
             const Forces& fext) {
    return with(bodies, data, [&](RigidBodyData& d) { return convert(f(bodies, q, v, x, d, wrenches(fext))); });
  };
}

void add_joint_space(py::module_& m) {
  using In = const Input&;
  def(m, "rnea", with_forces<Vector>(&rnea));
  def(m, "nonlinear_effects", of_state<In, In>(&nonlinear_effects));
  def(m, "gravity_torques", of_state<In>(&gravity_torques));
  def(m, "aba", with_forces<Vector>(&aba));
  def(m, "crba", of_state<In>(&crba));
  def(m, "inverse_inertia_times",
      [](const RigidBodies& bodies, const Input& q, py::handle x, const Memory& data) -> py::array {
        const Doubles X = as_doubles(x);
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
      });
  def(m, "coriolis_matrix", of_state<In, In>(&coriolis_matrix));
  def(m, "rnea_derivatives", with_forces<TorqueDerivatives>(&rnea_derivatives, [](const TorqueDerivatives& x) {
        return Three(x.dq, x.dv, x.da);
      }));
  def(m, "aba_derivatives",
      with_forces<AccelerationDerivatives>(&aba_derivatives,
                                           [](const AccelerationDerivatives& x) { return Three(x.dq, x.dv, x.dtau); }));
}

using Motion = Vec6<double> (*)(const RigidBodies&, RigidBodyData&, const Attachment&, ReferenceFrame);

// Returns a function for Python that computes the motion of a frame, which may be given by name.
auto of_frame(Motion motion) {
  return [motion](const RigidBodies& bodies, RigidBodyData& data, const FrameName& frame, ReferenceFrame axes) {
    return motion(bodies, data, frame_in(bodies, frame), axes);
  };
}

void add_body_frames(py::module_& m) {
  def(m, "forward_kinematics",
      [](const RigidBodies& bodies, const Input& q, RigidBodyData& data, const std::optional<Vector>& v,
         const std::optional<Vector>& a) {
        if (a && !v) throw py::value_error("forward_kinematics: a is given, but not v");
        if (a)
          forward_kinematics(bodies, q, *v, *a, data);
        else if (v)
          forward_kinematics(bodies, q, *v, data);
        else
          forward_kinematics(bodies, q, data);
      });
  def(m, "frame_placement", [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame) {
    return frame_placement(bodies, data, frame_in(bodies, frame));
  });
  def(m, "frame_velocity", of_frame(&frame_velocity));
  def(m, "frame_acceleration", of_frame(&frame_acceleration));
  def(m, "frame_classical_acceleration", of_frame(&frame_classical_acceleration));
  def(m, "frame_bias_acceleration", of_frame(&frame_bias_acceleration));
  def(m, "frame_jacobian",
      [](const RigidBodies& bodies, const RigidBodyData& data, const FrameName& frame, ReferenceFrame axes) {
        return frame_jacobian(bodies, data, frame_in(bodies, frame), axes);
      });
  def(m, "joint_wrench", [](const RigidBodies& bodies, const RigidBodyData& data, const std::string& joint) {
    return joint_wrench(bodies, data, find_joint(bodies, joint));
  });
}

void add_wholes(py::module_& m) {
  functions<&total_mass, &center_of_mass, &center_of_mass_velocity, &center_of_mass_acceleration,
            &center_of_mass_jacobian, &centroidal_momentum, &centroidal_momentum_matrix, &centroidal_momentum_rate,
            &kinetic_energy, &potential_energy>(m);
}

void add_contact_rows(py::module_& m) {
  def(m, "contact_jacobian", [](const Scene& scene, const Input& q, const py::object& active) {
    return contact_jacobian(scene, q, flags_of(scene, active));
  });
  def(m, "contact_bias_acceleration", [](const Scene& scene, const Input& q, const Input& v, const py::object& active) {
    return contact_bias_acceleration(scene, q, v, flags_of(scene, active));
  });
  def(m, "contact_forces_on_bodies",
      [](const Scene& scene, const Input& q, const Input& f, const std::vector<int>& f_offset) {
        return rows_of_wrenches(contact_forces_on_bodies(scene, q, f, f_offset));
      });
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
