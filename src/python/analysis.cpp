// What a careful reader asks of a state, and states that fit their contacts: floor analysis.

#include "data.hpp"
#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/rank_changes.hpp"
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
  py::class_<PlacementError> place(m, "PlacementError", "A contact whose frames do not stand where it holds them.");
  add_value(place)
      .def_readonly("contact", &PlacementError::contact, "Its number in the scene.")
      .def_readonly("position", &PlacementError::position, "[m]")
      .def_readonly("angle", &PlacementError::angle, "[rad]; 0 for points.")
      .def("__repr__", [](const PlacementError& e) {
        return "<PlacementError of contact " + std::to_string(e.contact) + ": " + text::number(e.position) + " m, " +
               text::number(e.angle) + " rad>";
      });
  py::class_<VelocityError> velocity(m, "VelocityError", "A contact whose frames move against each other.");
  add_value(velocity)
      .def_readonly("contact", &VelocityError::contact, "Its number in the scene.")
      .def_readonly("linear", &VelocityError::linear, "[m/s]")
      .def_readonly("angular", &VelocityError::angular, "[rad/s]; 0 for points.")
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
      py::arg("scene"), py::arg("q"), py::arg("active") = py::none(),
      "Contacts out of place at q (nq) by 1e-6 m or rad or more: a list of PlacementError.\n"
      "active: one bool per contact; by default as the scene has them.");
  m.def(
      "velocity_errors",
      [](const Scene& scene, const Raw& q, const Raw& v, const py::object& active) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        return velocity_errors(scene, flags_of(scene, active), q.vector(), v.vector());
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("active") = py::none(),
      "Contacts that v (nv) at q (nq) moves although they are held, by 1e-6 m/s or rad/s or more: a list of\n"
      "VelocityError. make_consistent mends them.");
}

void add_violations(py::module_& m) {
  add_enumeration<Violating>(m, "Violating", "way to violate", "What a contact does that none can which only pushes.",
                             {{"PULLS", Violating::kPulls},
                              {"SLIPS", Violating::kSlips},
                              {"TIPS", Violating::kTips},
                              {"TURNS", Violating::kTurns}});
  py::class_<Violation> violation(m, "Violation", "A contact with a mu whose force no contact that only pushes bears.");
  add_value(violation)
      .def_readonly("contact", &Violation::contact, "Its number in the scene.")
      .def_readonly("kind", &Violation::kind, "Violating")
      .def_readonly(
          "by", &Violation::by,
          "PULLS: the pull [N]; SLIPS: the force beyond the cone [N]; TIPS: from the centre of pressure to the\n"
          "box [m]; TURNS: [N m].")
      .def_readonly("needs", &Violation::needs, "SLIPS: the mu that would do.");
  m.def(
      "violations",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const SceneData& d = data.at_rest();
        if (d.f_offset.size() != scene.contacts.size())
          throw py::value_error("violations: the data are of another scene");
        return violations(scene, q.vector(), d.f, d.f_offset);
      },
      py::arg("scene"), py::arg("q"), py::arg("data"),
      "After solve at q (nq): a list of Violation, of the active contacts with a mu that pull, slip, tip or turn.");
  add_enumeration<Limited>(
      m, "Limited", "limited quantity", "What a limit is of.",
      {{"POSITION", Limited::kPosition}, {"VELOCITY", Limited::kVelocity}, {"EFFORT", Limited::kEffort}});
  py::class_<LimitPassed> passed(m, "LimitPassed", "A coordinate beyond a limit of its robot's file.");
  add_value(passed)
      .def_readonly("robot", &LimitPassed::robot, "Its number.")
      .def_readonly("dof", &LimitPassed::dof, "Of that robot's velocity coordinates.")
      .def_readonly("quantity", &LimitPassed::quantity, "Limited")
      .def_readonly("value", &LimitPassed::value)
      .def_readonly("limit", &LimitPassed::limit);
  m.def(
      "limits_passed",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& u) {
        fits("q", q, scene.nq);
        fits("v", v, scene.nv);
        fits("u", u, scene.nu);
        return limits_passed(scene, q.vector(), v.vector(), u.vector());
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("u"),
      "A list of LimitPassed: what of q (nq), v (nv), u (nu) is beyond the joints' limits.");
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
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("data"),
      "What acts on bodies from outside their joints at q (nq), v (nv), after solve: the forces of contacts, "
      "data.pushes\n"
      "and the scene's springs between points, as rnea's fext (njoints, 6).");
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
      py::arg("scene"), py::arg("q"), py::arg("data"),
      "Per row of data.f, after solve at q (nq): True where the force is unique, False where contacts could share it\n"
      "otherwise with the same accelerations. Those have the least norm, newton metres counted by "
      "Scene.moment_length.");
}

void add_rank_changes(py::module_& m) {
  py::class_<RankChange> c(m, "RankChange", "An island whose contact rows have less rank here than beside.");
  add_value(c)
      .def_readonly("island", &RankChange::island, "Its number.")
      .def_readonly("singular", &RankChange::singular,
                    "The posture is singular: a is that of it alone, no derivative exists. False: rows depend on each\n"
                    "other while loops are closed; derivatives exist along their motions, not across them.")
      .def_readonly("rank", &RankChange::rank)
      .def_readonly("rows", &RankChange::rows)
      .def_readonly("contacts", &RankChange::contacts, "Numbers of those whose rows depend on each other.")
      .def_readonly("coordinate", &RankChange::coordinate,
                    "Of v: held beside q and not here, most of all; -1: the island is too large.");
  m.def(
      "rank_changes",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        return data.use([&](SceneData& d) { return rank_changes(scene, Q, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("data"),
      "After solve at q (nq): a list of RankChange, of islands whose contact rows depend on each other here and not\n"
      "beside it, where derivatives do not exist.");
}

void add_near_dependent(py::module_& m) {
  py::class_<NearDependent> c(m, "NearDependent", "Rows of an island that only just count, and what would be without.");
  add_value(c)
      .def_readonly("island", &NearDependent::island, "Its number.")
      .def_readonly("rows", &NearDependent::rows, "Of data.f, ascending.")
      .def_readonly("left", &NearDependent::left, "What the rows before leave of the least of them, of its size.")
      .def_readonly("times", &NearDependent::times, "The largest force beside the loads.")
      .def_readonly("coordinate", &NearDependent::coordinate, "Of v, whose acceleration changes most without them,")
      .def_readonly("acceleration", &NearDependent::acceleration, "from [m/s^2, rad/s^2]")
      .def_readonly("without", &NearDependent::without, "to.");
  m.def(
      "near_dependent",
      [](const Scene& scene, const Raw& q, const Data& data) {
        fits("q", q, scene.nq);
        const auto Q = q.vector();
        return data.use([&](SceneData& d) { return near_dependent(scene, Q, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("data"),
      "After solve at q (nq): a list of NearDependent, of islands with rows of which the ones before leave less than "
      "a\n"
      "thousandth, but more than rounding.");
  py::class_<RankGap> gap(m, "RankGap", "How near the decision was which rows of an island depend on each other.");
  add_value(gap)
      .def_readonly("known", &RankGap::known, "False: damping decides, the island failed or is too large.")
      .def_readonly("least_kept", &RankGap::least_kept,
                    "What is left of the row that counts of which least is, of its size.")
      .def_readonly("most_dropped", &RankGap::most_dropped,
                    "Of the row that does not count of which most is; at least eps.")
      .def_readonly("kept", &RankGap::kept, "That row of data.f; -1: there is none.")
      .def_readonly("dropped", &RankGap::dropped, "That row; -1: all count.")
      .def_property_readonly("gap", &RankGap::gap, "least_kept / most_dropped; below 1000 either could be the other.");
  m.def(
      "rank_gap",
      [](const Scene& scene, const Data& data, std::size_t island) {
        return data.use([&](SceneData& d) {
          if (island >= d.report.islands.size()) throw py::value_error("rank_gap: there is no such island");
          return rank_gap(scene, d, island);
        });
      },
      py::arg("scene"), py::arg("data"), py::arg("island"), "RankGap of an island, after solve.");
}

void add_consistent(py::module_& m) {
  py::class_<ConsistentState> c(m, "ConsistentState", "A state that fits its contacts, and what it lacks.");
  add_value(c)
      .def_property_readonly(
          "q", [](const ConsistentState& x) { return x.q; }, "Configuration (nq); a copy.")
      .def_property_readonly(
          "v", [](const ConsistentState& x) { return x.v; }, "Velocity (nv); a copy.")
      .def_readonly("status", &ConsistentState::status, "The worst Status of its solves.")
      .def_readonly("steps", &ConsistentState::steps, "Of Gauss-Newton, on positions.")
      .def_readonly("misplaced", &ConsistentState::misplaced, "List of PlacementError: what could not be closed.")
      .def_readonly("moving", &ConsistentState::moving, "List of VelocityError: what still moves.")
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
      py::arg_v("options", Options(), "Options()"),
      "The nearest state to q (nq), v (nv) found in which contacts are in place and nothing moves against them: the\n"
      "least change in the kinetic metric, by Gauss-Newton on positions and one projection of velocities. What cannot\n"
      "be closed from there is listed in the ConsistentState. active: one bool per contact; by default the scene's.");
}

}  // namespace

void add_analysis(py::module_& m) {
  add_errors(m);
  add_violations(m);
  add_unique_forces(m);
  add_forces_on_bodies(m);
  add_rank_changes(m);
  add_near_dependent(m);
  add_consistent(m);
}

}  // namespace manycontact::python
