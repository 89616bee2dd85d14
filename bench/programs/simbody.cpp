// Simbody runs realize(Stage::Acceleration), from new coordinates. Contacts are rigid Weld and Ball constraints.

#include <Simbody.h>

#include "bodies.hpp"
#include "program.hpp"

namespace manycontact::bench {

namespace {

SimTK::Vec3 vec(const Vec3<double>& x) { return {x[0], x[1], x[2]}; }

SimTK::Rotation rotation(const Mat3<double>& R) {
  return SimTK::Rotation(SimTK::Mat33(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
                         true);
}

SimTK::Transform place(const SE3<double>& M) { return {rotation(M.R), vec(M.p)}; }

SimTK::Body::Rigid rigid(const Body& b) {
  const Mat3<double>& I = b.inertia;
  const SimTK::Inertia about_com(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return SimTK::Body::Rigid(
      SimTK::MassProperties(b.mass, vec(b.com), about_com.shiftFromMassCenter(vec(b.com), b.mass)));
}

struct Acceleration : Loaded {
  explicit Acceleration(const Posed& scene)
      : s(scene),
        bodies(bodies_of(scene)),
        matter(system),
        forces(system),
        gravity(forces, matter, vec(s.scene.gravity)),
        torques(forces, matter) {
    for (const Body& b : bodies) mobods.push_back(add(b));
    const auto body = [&](int k) -> SimTK::MobilizedBody& { return k < 0 ? matter.updGround() : mobods[k]; };
    for (const Hold& h : holds_of(s, bodies)) {
      if (h.point)
        SimTK::Constraint::Ball(body(h.a), vec(h.in_a.p), body(h.b), vec(h.in_b.p));
      else
        SimTK::Constraint::Weld(body(h.a), place(h.in_a), body(h.b), place(h.in_b));
    }
    state = system.realizeTopology();
    system.realizeModel(state);
    set_motion();
  }

  void run() override {
    state.updQ();  // so that everything from positions on is computed again
    system.realize(state, SimTK::Stage::Acceleration);
  }

  Eigen::VectorXd accelerations() override {
    Eigen::VectorXd a(s.scene.nv);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const SimTK::Vector du = mobods[k].getUDotAsVector(state);
      if (bodies[k].type == JointType::kFloating) {  // du is in axes at rest that coincide with the body's
        const Eigen::Vector3d v = s.v.segment<3>(bodies[k].idx_v), w = s.v.segment<3>(bodies[k].idx_v + 3);
        a.segment<3>(bodies[k].idx_v) = Eigen::Vector3d(du[3], du[4], du[5]) - w.cross(v);
        a.segment<3>(bodies[k].idx_v + 3) << du[0], du[1], du[2];
      } else {
        a[bodies[k].idx_v] = du[0];
      }
    }
    return a;
  }

 private:
  SimTK::MobilizedBody add(const Body& b) {
    SimTK::MobilizedBody& parent = b.parent < 0 ? matter.updGround() : mobods[b.parent];
    if (b.type == JointType::kFloating)
      return SimTK::MobilizedBody::Free(parent, place(b.in_parent), rigid(b), SimTK::Transform());
    const SimTK::Rotation z_to_axis(SimTK::UnitVec3(vec(b.axis)), SimTK::ZAxis);  // a pin rotates about z
    return SimTK::MobilizedBody::Pin(parent, place(b.in_parent) * SimTK::Transform(z_to_axis), rigid(b), z_to_axis);
  }

  void set_motion() {
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const int v = bodies[k].idx_v;
      if (bodies[k].type == JointType::kFloating) {
        for (int i = 0; i < 3; ++i) {
          mobods[k].setOneU(state, i, s.v[v + 3 + i]);
          mobods[k].setOneU(state, 3 + i, s.v[v + i]);
        }
      } else {
        mobods[k].setOneU(state, 0, s.v[v]);
        torques.setOneMobilityForce(state, mobods[k], SimTK::MobilizerUIndex(0), s.u[bodies[k].idx_u]);
      }
    }
  }

  const Posed& s;
  std::vector<Body> bodies;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::Gravity gravity;
  SimTK::Force::DiscreteForces torques;
  std::vector<SimTK::MobilizedBody> mobods;
  SimTK::State state;
};

std::string version() {
  int major = 0, minor = 0, build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(build);
}

std::unique_ptr<Loaded> load(const Posed& s, const std::string&) { return std::make_unique<Acceleration>(s); }

std::string refuses(const Posed& s, const std::string&) { return strange(s); }

}  // namespace

const Program& program() {
  static const Program p{"Simbody", version(), {"realize"}, {}, refuses, load};
  return p;
}

}  // namespace manycontact::bench
