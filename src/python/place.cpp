// Inverse kinematics of a scene.

#include "manycontact/analysis/place.hpp"

#include "docs/place.hpp"
#include "rigid_bodies.hpp"

namespace manycontact::python {

namespace {

using Given = std::optional<std::vector<std::optional<double>>>;

Partial partial(const char* name, const Given& given) {
  if (!given) return {};
  if (given->size() != 3)
    throw py::value_error(std::string(name) + ": three numbers are expected, None for what is left open");
  return {(*given)[0], (*given)[1], (*given)[2]};
}

void add_goals(py::module_& m) {
  py::class_<Goal> goal(m, "Goal", "A goal for a configuration, made by pose_goal and similar functions; see place().");
  add_copy(goal);
  goal.def_readonly("name", &Goal::name, "Name in error messages.")
      .def_readwrite("weight", &Goal::weight, "Weight against other goals.")
      .def("__repr__", [](const Goal& g) { return "<Goal '" + g.name + "'>"; });
  m.def(
      "pose_goal",
      [](const Scene& scene, const FrameName& frame, const std::optional<SE3<double>>& placement, const Given& position,
         const Given& rpy, double weight) {
        if (placement && (position || rpy))
          throw py::value_error(
              "pose_goal: placement is given together with position or rpy, expected one or the other");
        const Attachment at = frame.in(scene);
        return placement ? pose_goal(at, *placement, weight)
                         : pose_goal(at, partial("position", position), partial("rpy", rpy), weight);
      },
      py::arg("scene"), py::arg("frame"), py::arg("placement") = py::none(), py::arg("position") = py::none(),
      py::arg("rpy") = py::none(), py::arg("weight") = 1.0, doc::pose_goal);
  m.def(
      "center_of_mass_goal",
      [](const Scene& scene, const Given& position, const std::string& robot, double weight) {
        return center_of_mass_goal(scene, partial("position", position), robot, weight);
      },
      py::arg("scene"), py::arg("position"), py::arg("robot") = "", py::arg("weight") = 1.0, doc::center_of_mass_goal);
  m.def("joint_goal", &joint_goal, py::arg("scene"), py::arg("joint"), py::arg("value"), py::arg("weight") = 1.0,
        doc::joint_goal);
  m.def("contact_goal", &contact_goal, py::arg("scene"), py::arg("contact"), py::arg("weight") = 1.0,
        doc::contact_goal);
}

}  // namespace

void add_place(py::module_& m) {
  add_goals(m);
  py::class_<GoalLeft> left(m, "GoalLeft", "The remaining error of a goal.");
  add_value(left)
      .def_readonly("position", &GoalLeft::position, "Remaining position error [m].")
      .def_readonly("angle", &GoalLeft::angle, "Remaining angle error [rad].");
  py::class_<PlacedScene> placed(m, "PlacedScene", "The configuration that place() found, and its remaining errors.");
  add_value(placed)
      .def_property_readonly(
          "q", [](const PlacedScene& x) { return x.q; }, "Configuration (nq), within the limits; a copy.")
      .def_readonly("iterations", &PlacedScene::iterations, "Number of steps from all starts.")
      .def_readonly("out_of_steps", &PlacedScene::out_of_steps,
                    "Whether the search for q ended at the largest number of steps, while the error still decreased.")
      .def_readonly("left", &PlacedScene::left, "List of GoalLeft, one per goal.")
      .def("met", &PlacedScene::met, py::arg("error") = 1e-9,
           "Return whether the remaining errors of all goals are at most `error` [m, rad].");
  m.def(
      "place",
      [](const Scene& scene, const ConstVectorRef& q, const std::vector<Goal>& goals, int iterations, double tolerance,
         int restarts, unsigned seed) {
        const py::gil_scoped_release unlocked;
        return place(scene, q, goals, {iterations, tolerance, restarts, seed});
      },
      py::arg("scene"), py::arg("q"), py::arg("goals"), py::arg("iterations") = 1000, py::arg("tolerance") = 1e-12,
      py::arg("restarts") = 0, py::arg("seed") = 0, doc::place);
}

}  // namespace manycontact::python
