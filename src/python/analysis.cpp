// Checks of states and solutions, and states that are consistent with their contacts.

#include "docs/analysis.hpp"

#include "data.hpp"
#include "docs/place.hpp"
#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/rank_changes.hpp"
#include "manycontact/analysis/redistribute_forces.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/analysis/unique_forces.hpp"
#include "manycontact/contact/jacobian.hpp"

namespace manycontact::python {

namespace {

using Vector = Eigen::VectorXd;

void fits(const char* name, const Raw& x, int size) {
  check_numbers(name, x.array.data(), x.array.size());
  if (x.array.size() != size)
    throw py::value_error(std::string(name) + ": " + std::to_string(size) + " numbers are expected, not " +
                          std::to_string(x.array.size()));
}

// None: as the scene has them.
std::vector<char> flags_of(const Scene& scene, const py::object& active) {
  std::vector<char> flags;
  for (const Contact& contact : scene.contacts) flags.push_back(contact.active);
  if (!active.is_none()) set_flags("active", active, flags);
  return flags;
}

void add_errors(py::module_& m) {
  py::class_<PlacementError> place(m, "PlacementError",
                                   "A contact whose frames are not where the contact requires them.");
  add_value(place)
      .def_readonly("contact", &PlacementError::contact, "Number of the contact in the scene.")
      .def_readonly("position", &PlacementError::position, "Position error [m].")
      .def_readonly("angle", &PlacementError::angle, "Angle error [rad]; 0 for points.")
      .def("__repr__", [](const PlacementError& e) {
        return "<PlacementError of contact " + std::to_string(e.contact) + ": " + text::number(e.position) + " m, " +
               text::number(e.angle) + " rad>";
      });
  py::class_<VelocityError> velocity(m, "VelocityError", "A contact whose frames move relative to each other.");
  add_value(velocity)
      .def_readonly("contact", &VelocityError::contact, "Number of the contact in the scene.")
      .def_readonly("linear", &VelocityError::linear, "Linear velocity [m/s].")
      .def_readonly("angular", &VelocityError::angular, "Angular velocity [rad/s]; 0 for points.")
      .def("__repr__", [](const VelocityError& e) {
        return "<VelocityError of contact " + std::to_string(e.contact) + ": " + text::number(e.linear) + " m/s, " +
               text::number(e.angular) + " rad/s>";
      });
  m.def(
      "placement_errors",
      [](const Scene& scene, const Raw& q, const py::object& active) {
        fits("q", q, scene.nq);
        return placement_errors(scene, flags_of(scene, active), q.vector());
      },
      py::arg("scene"), py::arg("q"), py::arg("active") = py::none(), doc::placement_errors);
  m.def(
      "velocity_errors",
      [](const Scene& scene, const Raw& q, const Raw& v, const py::object& active) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        return velocity_errors(scene, flags_of(scene, active), q.vector(), v.vector());
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("active") = py::none(), doc::velocity_errors);
}

void add_violations(py::module_& m) {
  add_enumeration<ViolationKind>(m, "ViolationKind", "way to violate",
                                 "How a contact force violates the conditions of a unilateral contact.",
                                 {{"PULLS", ViolationKind::kPulls},
                                  {"SLIPS", ViolationKind::kSlips},
                                  {"TIPS", ViolationKind::kTips},
                                  {"TURNS", ViolationKind::kTurns}});
  py::class_<Violation> violation(m, "Violation", "A contact force that a unilateral contact cannot exert.");
  add_value(violation)
      .def_readonly("contact", &Violation::contact, "Number of the contact in the scene.")
      .def_readonly("kind", &Violation::kind, "ViolationKind.")
      .def_readonly(
          "by", &Violation::by,
          "PULLS: the pull [N]; SLIPS: the force outside the cone [N]; TIPS: distance of the centre of pressure from\n"
          "the box [m]; TURNS: excess torque [N m].")
      .def_readonly("needs", &Violation::needs, "SLIPS: the coefficient of friction that would be sufficient.");
  m.def(
      "violations",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const SceneData& d = data.at_rest();
        if (d.f_offset.size() != scene.contacts.size())
          throw py::value_error("violations: the data are of another scene");
        return violations(scene, q.vector(), d.f, d.f_offset);
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), doc::violations);
  add_enumeration<LimitKind>(
      m, "LimitKind", "limited quantity", "The quantity that exceeds a limit.",
      {{"POSITION", LimitKind::kPosition}, {"VELOCITY", LimitKind::kVelocity}, {"EFFORT", LimitKind::kEffort}});
  py::class_<LimitPassed> passed(m, "LimitPassed", "A coordinate that exceeds a limit of its robot's file.");
  add_value(passed)
      .def_readonly("robot", &LimitPassed::robot, "Number of the robot.")
      .def_readonly("dof", &LimitPassed::dof, "Number of the coordinate in that robot's v.")
      .def_readonly("quantity", &LimitPassed::quantity, "LimitKind: position, velocity or effort.")
      .def_readonly("value", &LimitPassed::value, "Value that exceeds the limit.")
      .def_readonly("limit", &LimitPassed::limit, "The limit.");
  m.def(
      "limits_passed",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& u) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        fits("u", u, scene.nu);
        return limits_passed(scene, q.vector(), v.vector(), u.vector());
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("u"), doc::limits_passed);
}

void add_forces_on_bodies(py::module_& m) {
  m.def(
      "forces_on_bodies",
      [](const Scene& scene, const Raw& q, const Raw& v, const Data& data) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        const auto Q = q.vector();
        const auto V = v.vector();
        const std::vector<Vec6<double>> on = data.use([&](SceneData& d) {
          if (d.serial == 0) throw std::logic_error("forces_on_bodies: solve first");
          return forces_on_bodies(scene, Q, V, d.f, d.f_offset, d.pushes);
        });
        Eigen::MatrixXd out(static_cast<Eigen::Index>(on.size()), 6);
        for (std::size_t i = 0; i < on.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = on[i].transpose();
        return out;
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("data"), doc::forces_on_bodies);
}

void add_unique_forces(py::module_& m) {
  m.def(
      "unique_forces",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        const std::vector<char> unique = data.use([&](SceneData& d) { return unique_forces(scene, Q, d); });
        py::array_t<bool> out(static_cast<py::ssize_t>(unique.size()));
        std::copy(unique.begin(), unique.end(), out.mutable_data());
        return out;
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), doc::unique_forces);
}

std::optional<Eigen::VectorXd> vector_or_none(const char* name, const std::optional<Raw>& given, Eigen::Index n) {
  if (!given) return std::nullopt;
  fits(name, *given, static_cast<int>(n));
  return Eigen::VectorXd(given->vector());
}

void add_redistribution(py::module_& m) {
  m.def(
      "force_null_space",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        return scipy_csc(data.use([&](SceneData& d) { return force_null_space(scene, Q, d); }));
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), doc::force_null_space);
  m.def(
      "redistribute_forces",
      [](const Scene& scene, const Raw& q, const Data& data, const std::optional<Raw>& reference,
         const std::optional<Raw>& weights) -> Vector {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        const Eigen::Index n = data.at_rest().f.size();
        const auto towards = vector_or_none("reference", reference, n), w = vector_or_none("weights", weights, n);
        return data.use([&](SceneData& d) {
          return redistribute_forces(scene, Q, d, towards.value_or(Vector()), w.value_or(Vector()));
        });
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), py::arg("reference") = py::none(),
      py::arg("weights") = py::none(), doc::redistribute_forces);
}

void add_rank_changes(py::module_& m) {
  py::class_<RankChange> c(
      m, "RankChange", "An island whose constraint rows have a smaller rank here than at neighbouring configurations.");
  add_value(c)
      .def_readonly("island", &RankChange::island, "Number of the island.")
      .def_readonly(
          "singular", &RankChange::singular,
          "True: the configuration is singular, and no derivative exists. False: rows are dependent only while loops\n"
          "are closed, and derivatives exist along such motions.")
      .def_readonly("rank", &RankChange::rank, "Rank of the constraint rows.")
      .def_readonly("rows", &RankChange::rows, "Number of constraint rows.")
      .def_readonly("contacts", &RankChange::contacts, "Numbers of the contacts with dependent rows.")
      .def_readonly(
          "coordinate", &RankChange::coordinate,
          "Coordinate of v that is constrained most at neighbouring configurations, but not here; -1: the island is\n"
          "too large.");
  m.def(
      "rank_changes",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        return data.use([&](SceneData& d) { return rank_changes(scene, Q, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), doc::rank_changes);
}

void add_near_dependent(py::module_& m) {
  py::class_<NearDependent> c(m, "NearDependent", "Nearly dependent rows of an island, and the solution without them.");
  add_value(c)
      .def_readonly("island", &NearDependent::island, "Number of the island.")
      .def_readonly("rows", &NearDependent::rows, "Nearly dependent rows, as indices of data.f, ascending.")
      .def_readonly(
          "left", &NearDependent::left,
          "Smallest relative residual of these rows after projection on the complement of the preceding rows.")
      .def_readonly("times", &NearDependent::times, "Ratio of the largest force to the loads.")
      .def_readonly("coordinate", &NearDependent::coordinate,
                    "Coordinate of v whose acceleration changes most without these rows.")
      .def_readonly("acceleration", &NearDependent::acceleration, "Its acceleration with the rows [m/s^2, rad/s^2].")
      .def_readonly("without", &NearDependent::without, "Its acceleration without the rows [m/s^2, rad/s^2].");
  m.def(
      "near_dependent",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        return data.use([&](SceneData& d) { return near_dependent(scene, Q, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("data"), doc::near_dependent);
  py::class_<RankGap> gap(m, "RankGap", "How reliable the rank decision of an island was.");
  add_value(gap)
      .def_readonly("known", &RankGap::known, "False: damping decides, or the island failed or is too large.")
      .def_readonly("least_kept", &RankGap::least_kept, "Smallest relative residual of an accepted row.")
      .def_readonly("most_dropped", &RankGap::most_dropped,
                    "Largest relative residual of a rejected row; at least the machine precision.")
      .def_readonly("kept", &RankGap::kept, "Index of that accepted row in data.f; -1: there is none.")
      .def_readonly("dropped", &RankGap::dropped, "Index of that rejected row in data.f; -1: no row was rejected.")
      .def_property_readonly("gap", &RankGap::gap,
                             "least_kept / most_dropped; below 1000 the decision is not reliable.");
  m.def(
      "rank_gap",
      [](const Scene& scene, const Data& data, std::size_t island) {
        return data.use([&](SceneData& d) {
          if (island >= d.report.islands.size()) throw py::value_error("rank_gap: there is no such island");
          return rank_gap(scene, d, island);
        });
      },
      py::arg("scene"), py::arg("data"), py::arg("island"), doc::rank_gap);
}

void add_consistent(py::module_& m) {
  py::class_<ConsistentState> c(m, "ConsistentState",
                                "A state that is consistent with its contacts, and its remaining errors.");
  add_value(c)
      .def_property_readonly(
          "q", [](const ConsistentState& x) { return x.q; }, "Configuration (nq); a copy.")
      .def_property_readonly(
          "v", [](const ConsistentState& x) { return x.v; }, "Velocity (nv); a copy.")
      .def_readonly("status", &ConsistentState::status, "Worst Status of its solves.")
      .def_readonly("steps", &ConsistentState::steps, "Number of Gauss-Newton steps for the configuration.")
      .def_readonly("misplaced", &ConsistentState::misplaced,
                    "List of PlacementError: contacts that could not be brought into place.")
      .def_readonly("moving", &ConsistentState::moving, "List of VelocityError: contacts that still move.")
      .def_property_readonly("consistent", &ConsistentState::consistent, "Whether both lists are empty.");
  m.def(
      "make_consistent",
      [](const Scene& scene, const Raw& q, const Raw& v, const py::object& active, const Options& options) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        const std::vector<char> flags = flags_of(scene, active);
        const auto Q = q.vector(), V = v.vector();
        const py::gil_scoped_release unlocked;
        return make_consistent(scene, flags, Q, V, options);
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("active") = py::none(),
      py::arg_v("options", Options(), "Options()"), doc::make_consistent);
}

}  // namespace

void add_analysis(py::module_& m) {
  add_errors(m);
  add_violations(m);
  add_unique_forces(m);
  add_redistribution(m);
  add_forces_on_bodies(m);
  add_rank_changes(m);
  add_near_dependent(m);
  add_consistent(m);
}

}  // namespace manycontact::python
