// Inverse kinematics of a scene: floor analysis.

#include "manycontact/analysis/place.hpp"

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
  py::class_<Goal> goal(m, "Goal", "What is wanted of a configuration, by pose_goal and alike; see place().");
  add_copy(goal);
  goal.def_readonly("name", &Goal::name).def_readwrite("weight", &Goal::weight).def("__repr__", [](const Goal& g) {
    return "<Goal '" + g.name + "'>";
  });
  m.def(
      "pose_goal",
      [](const Scene& scene, const FrameName& frame, const std::optional<SE3<double>>& placement, const Given& position,
         const Given& rpy, double weight) {
        if (placement && (position || rpy))
          throw py::value_error("pose_goal: placement is given beside position or rpy, expected one or the other");
        const Attachment at = frame.in(scene);
        return placement ? pose_goal(at, *placement, weight)
                         : pose_goal(at, partial("position", position), partial("rpy", rpy), weight);
      },
      py::arg("scene"), py::arg("frame"), py::arg("placement") = py::none(), py::arg("position") = py::none(),
      py::arg("rpy") = py::none(), py::arg("weight") = 1.0,
      "A frame's place in the world: an SE3; or position x, y, z [m] and rpy, its turns about the world's x, y, z "
      "[rad],\n"
      "with None for what is left open: position=(None, None, 0) is z = 0 alone, rpy=(0, 0, None) the frame's z up.\n"
      "frame: 'r/sole', or an Attachment.");
  m.def(
      "center_of_mass_goal",
      [](const Scene& scene, const Given& position, const std::string& robot, double weight) {
        return center_of_mass_goal(scene, partial("position", position), robot, weight);
      },
      py::arg("scene"), py::arg("position"), py::arg("robot") = "", py::arg("weight") = 1.0,
      "The centre of mass [m] of a robot, or of all; None for what of x, y, z is left open.");
  m.def("joint_goal", &joint_goal, py::arg("scene"), py::arg("joint"), py::arg("value"), py::arg("weight") = 1.0,
        "The position [rad, m] of a joint with one coordinate, by its name 'r/knee'.");
  m.def("contact_goal", &contact_goal, py::arg("scene"), py::arg("contact"), py::arg("weight") = 1.0,
        "A contact of the scene, active or not, is in place.");
}

}  // namespace

void add_place(py::module_& m) {
  add_goals(m);
  py::class_<GoalLeft> left(m, "GoalLeft", "How far a goal is from being met.");
  add_value(left).def_readonly("position", &GoalLeft::position, "[m]").def_readonly("angle", &GoalLeft::angle, "[rad]");
  py::class_<PlacedScene> placed(m, "PlacedScene", "The configuration that place() found, and what it lacks.");
  add_value(placed)
      .def_property_readonly(
          "q", [](const PlacedScene& x) { return x.q; }, "Configuration (nq), within the limits; a copy.")
      .def_readonly("iterations", &PlacedScene::iterations, "Steps tried, from all starts.")
      .def_readonly("left", &PlacedScene::left, "List of GoalLeft, by goal.")
      .def("met", &PlacedScene::met, py::arg("error") = 1e-9, "Whether every goal is met but for an error [m, rad].");
  m.def(
      "place",
      [](const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const std::vector<Goal>& goals, int iterations,
         double tolerance, int restarts, unsigned seed) {
        const py::gil_scoped_release unlocked;
        return place(scene, q, goals, {iterations, tolerance, restarts, seed});
      },
      py::arg("scene"), py::arg("q"), py::arg("goals"), py::arg("iterations") = 100, py::arg("tolerance") = 1e-12,
      py::arg("restarts") = 0, py::arg("seed") = 0,
      "Inverse kinematics: a configuration near q (nq) that meets a list of Goal, within the joints' limits, by "
      "damped\n"
      "Gauss-Newton steps. Goals that contradict each other share what is left by their weights. Returns a "
      "PlacedScene,\n"
      "which says what is left of each; its q never leaves the limits. restarts: how often the search starts again, "
      "from\n"
      "random joints within the limits (by seed), while goals are missed.");
}

}  // namespace manycontact::python
