#include "manycontact/analysis/place.hpp"

#include "rigid_bodies.hpp"

namespace manycontact::python {

namespace {

using Given = std::optional<std::vector<std::optional<double>>>;

Partial partial(const char* name, const Given& given) {
  if (!given) return {};
  if (given->size() != 3)
    throw py::value_error(std::string(name) + ": three entries are expected, numbers or None for free coordinates");
  return {(*given)[0], (*given)[1], (*given)[2]};
}

void add_goals(py::module_& m) {
  Class<Goal> goal(m, "Goal");
  add_copy(goal);
  goal.read<&Goal::name>().write<&Goal::weight>().def("__repr__",
                                                      [](const Goal& g) { return "<Goal '" + g.name + "'>"; });
  def(m, "pose_goal",
      [](const Scene& scene, const FrameName& frame, const std::optional<SE3<double>>& placement, const Given& position,
         const Given& rpy, double weight) {
        if (placement && (position || rpy))
          throw py::value_error(
              "pose_goal: placement is given together with position or rpy, expected either placement, or position and "
              "rpy");
        const Attachment at = frame_in(scene, frame);
        return placement ? pose_goal(at, *placement, weight)
                         : pose_goal(at, partial("position", position), partial("rpy", rpy), weight);
      });
  def(m, "center_of_mass_goal", [](const Scene& scene, const Given& position, const std::string& robot, double weight) {
    return center_of_mass_goal(scene, partial("position", position), robot, weight);
  });
  functions<&joint_goal, &contact_goal>(m);
}

}  // namespace

void add_place(py::module_& m) {
  add_goals(m);
  value<GoalLeft>(m).read<&GoalLeft::position, &GoalLeft::angle>();
  value<PlacedScene>(m)
      .read<&PlacedScene::q, &PlacedScene::iterations, &PlacedScene::out_of_steps, &PlacedScene::left>()
      .def("met", &PlacedScene::met);
  def(m, "place",
      [](const Scene& scene, const ConstVectorRef& q, const std::vector<Goal>& goals, int iterations, double tolerance,
         int restarts, unsigned seed) {
        const py::gil_scoped_release unlocked;
        return place(scene, q, goals, {iterations, tolerance, restarts, seed});
      });
}

}  // namespace manycontact::python
