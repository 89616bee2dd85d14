// External wrenches and springs of scenes.

#include "docs/scene.hpp"
#include "handle.hpp"
#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

// Returns the item as `add` would store it in a scene of the same robots. Throws if it does not fit.
template <class T>
T judged(const Scene& scene, T item, std::vector<T> Scene::*list, int (*add)(Scene&, T)) {
  Scene around;
  around.robots = scene.robots;
  add(around, std::move(item));
  return std::move((around.*list).front());
}

template <class T>
Items<Handle<T>> items_of(const std::shared_ptr<Scene>& scene, std::vector<T> Scene::*list,
                          std::unordered_map<std::string, int> Scene::*index, int (*add)(Scene&, T), const char* what) {
  const auto at = [scene, list, add, what](std::size_t k) {
    return Handle<T>([scene, list, k]() -> const T& { return ((*scene).*list).at(k); },
                     [scene, list, add, what, k](T item) {
                       T& now = ((*scene).*list).at(k);
                       if (item.name != now.name)
                         throw py::value_error(std::string(what) + " '" + now.name + "' of a scene keeps its name");
                       now = judged(*scene, std::move(item), list, add);
                     });
  };
  return {[scene, list] { return ((*scene).*list).size(); }, at,
          [scene, index](const std::string& name) {
            const auto found = ((*scene).*index).find(name);
            return found == ((*scene).*index).end() ? -1 : found->second;
          },
          [scene, list, what](const std::string& name) {
            std::vector<std::string> known;
            for (const T& item : (*scene).*list) known.push_back(item.name);
            return std::string("there is no ") + what + " " + quote(name) + ", " + suggestion(name, known);
          }};
}

}  // namespace

Items<Handle<Push>> pushes_of(const std::shared_ptr<Scene>& scene) {
  return items_of(scene, &Scene::pushes, &Scene::push_index, &add_push, "push");
}
Items<Handle<Spring>> springs_of(const std::shared_ptr<Scene>& scene) {
  return items_of(scene, &Scene::springs, &Scene::spring_index, &add_spring, "spring");
}

py::array wrenches_view(const std::vector<Vec6<double>>& w, py::handle owner) {
  static_assert(sizeof(Vec6<double>) == 6 * sizeof(double));
  const double* x = w.empty() ? nullptr : w.front().data();
  return view(x, {static_cast<py::ssize_t>(w.size()), 6}, {6, 1}, owner, true);
}

void set_wrenches(const char* name, py::handle values, std::vector<Vec6<double>>& w) {
  const Doubles x = checked_doubles(values, 2, static_cast<Eigen::Index>(w.size()), 6, true);
  if (!x) throw py::type_error(std::string(name) + ": a matrix of numbers is expected, a wrench (6) per push");
  check_numbers(name, x.data(), x.size());
  for (std::size_t k = 0; k < w.size(); ++k) w[k] = Eigen::Map<const Vec6<double>>(x.data() + 6 * k);
}

void add_force_classes(py::module_& m) {
  py::class_<Handle<Push>> push(
      m, "Push",
      "An external wrench on a body, at a frame; see attach().\n"
      "\n"
      "Assigning to the attributes of scene.pushes['wind'] changes the scene. SceneData.pushes contains the\n"
      "wrenches of\n"
      "a solve.");
  push.def(
      py::init([](const std::string& name, const Attachment& at, ReferenceFrame frame, const Vec6<double>& wrench) {
        return Handle<Push>(Push{name, at, frame, wrench});
      }),
      py::kw_only(), py::arg("name"), py::arg("at"),
      py::arg_v("reference_frame", ReferenceFrame::kLocal, "ReferenceFrame.LOCAL"),
      py::arg("wrench") = Vec6<double>(Vec6<double>::Zero()),
      "Make a push. wrench contains force and torque about the frame's origin (6) [N, N m], in the frame's axes\n"
      "(LOCAL)\n"
      "or the world's (WORLD and LOCAL_WORLD_ALIGNED are the same).");
  handle_field(push, "name", &Push::name, "Name.");
  handle_field(push, "at", &Push::at, "Attachment. Its placement may change while data are in use, but not its body.");
  handle_field(push, "reference_frame", &Push::reference_frame, "ReferenceFrame: axes of the wrench.");
  handle_field(push, "wrench", &Push::wrench, "Force and torque (6) [N, N m]; initial value of new data.");
  add_value(push);
  add_items<Handle<Push>>(m, "PushList", "A scene's pushes, by number or name.", true);

  py::class_<Handle<Spring>> spring(
      m, "Spring",
      "A spring and damper between two points.\n"
      "\n"
      "It pulls A towards B with the force stiffness (s - length) + damping ds/dt, where s is the distance of\n"
      "the points.");
  spring.def(py::init([](const std::string& name, const Attachment& A, const Attachment& B, double stiffness,
                         double length, double damping) {
               return Handle<Spring>(Spring{name, A, B, stiffness, length, damping});
             }),
             py::kw_only(), py::arg("name"), py::arg("A"), py::arg_v("B", Attachment(), "Attachment()"),
             py::arg("stiffness"), py::arg("length") = 0.0, py::arg("damping") = 0.0,
             "Make a spring: stiffness [N/m], length at rest [m], damping [N s/m]. B may be in the world.");
  handle_field(spring, "name", &Spring::name, "Name.");
  handle_field(spring, "A", &Spring::A, "Attachment of one end.");
  handle_field(spring, "B", &Spring::B, "Attachment of the other end.");
  handle_field(spring, "stiffness", &Spring::stiffness, "Stiffness [N/m].");
  handle_field(spring, "length", &Spring::length, "Length at rest [m].");
  handle_field(spring, "damping", &Spring::damping, "Damping [N s/m].");
  add_value(spring);
  add_items<Handle<Spring>>(m, "SpringList", "A scene's springs between points, by number or name.", true);
}

void add_forces(py::module_& m) {
  m.def("add_push", &add_push, py::arg("scene"), py::arg("push"), doc::add_push);
  m.def("add_spring", &add_spring, py::arg("scene"), py::arg("spring"), doc::add_spring);
  m.def("add_joint_spring", &add_joint_spring, py::arg("scene"), py::arg("robot"), py::arg("joint"),
        py::arg("stiffness"), py::arg("rest") = 0.0, doc::add_joint_spring);
  m.def("push_names", &push_names, py::arg("scene"), doc::push_names);
}

}  // namespace manycontact::python
