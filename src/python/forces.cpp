#include <array>

#include "manycontact/model/suggestion.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

std::array<Attachment*, 2> ends(Contact& x) { return {&x.A, &x.B}; }
std::array<Attachment*, 2> ends(Spring& x) { return {&x.A, &x.B}; }
std::array<Attachment*, 1> ends(ExternalWrench& x) { return {&x.at}; }

// Returns an item as `add` stores it in a scene of only the item's robots. Throws if `add` refuses the item.
template <class T>
T judged(const Scene& scene, T item, std::vector<T> Scene::*list, int (*add)(Scene&, T)) {
  Scene around;
  std::vector<int> numbers;
  for (Attachment* at : ends(item)) {
    if (at->robot < 0 || at->robot >= scene.nrobots()) continue;
    const auto known = std::ranges::find(numbers, at->robot);
    const auto number = static_cast<int>(known - numbers.begin());
    if (known == numbers.end()) {
      numbers.push_back(at->robot);
      around.robots.push_back(scene.robots[at->robot]);
    }
    at->robot = number;
  }
  add(around, std::move(item));
  T taken = std::move((around.*list).front());
  for (Attachment* at : ends(taken))
    if (at->robot >= 0) at->robot = numbers[at->robot];
  return taken;
}

template <class T>
Items<Handle<T>> items_of(const std::shared_ptr<Scene>& scene, std::vector<T> Scene::*list,
                          std::unordered_map<std::string, int> Scene::*index, int (*add)(Scene&, T), const char* what) {
  const auto at = [scene, list, add, what](std::size_t k) {
    return Handle<T>([scene, list, k]() -> const T& { return ((*scene).*list).at(k); },
                     [scene, list, add, what, k](T item) {
                       T& now = ((*scene).*list).at(k);
                       if (item.name != now.name)
                         throw py::value_error("the name of " + std::string(what) + " '" + now.name +
                                               "' of a scene cannot be changed");
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

Items<Handle<Contact>> contacts_of(const std::shared_ptr<Scene>& scene) {
  return items_of(scene, &Scene::contacts, &Scene::contact_index, &add_contact, "contact");
}
Items<Handle<ExternalWrench>> wrenches_of(const std::shared_ptr<Scene>& scene) {
  return items_of(scene, &Scene::wrenches, &Scene::wrench_index, &add_external_wrench, "external wrench");
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
  const Doubles x = checked_doubles(values, 2, static_cast<Eigen::Index>(w.size()), 6);
  if (!x)
    throw py::type_error(std::string(name) + ": a matrix of numbers is expected, six numbers for each external wrench");
  check_numbers(name, x.data(), x.size());
  for (std::size_t k = 0; k < w.size(); ++k) w[k] = Eigen::Map<const Vec6<double>>(x.data() + 6 * k);
}

Eigen::MatrixXd rows_of_wrenches(const std::vector<Vec6<double>>& w) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(w.size()), 6);
  for (std::size_t i = 0; i < w.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = w[i].transpose();
  return out;
}

void add_force_classes(py::module_& m) {
  value<Handle<ExternalWrench>>(m)
      .from_members<std::string, Attachment, ReferenceFrame, Vec6<double>>()
      .fields<&ExternalWrench::name, &ExternalWrench::at, &ExternalWrench::reference_frame, &ExternalWrench::wrench>();
  add_items<Handle<ExternalWrench>>(m, "ExternalWrenchList");
  value<Handle<Spring>>(m)
      .from_members<std::string, Attachment, Attachment, double, double, double>()
      .fields<&Spring::name, &Spring::A, &Spring::B, &Spring::stiffness, &Spring::length, &Spring::damping>();
  add_items<Handle<Spring>>(m, "SpringList");
}

void add_forces(py::module_& m) { functions<&add_external_wrench, &add_spring, &add_joint_spring, &wrench_names>(m); }

}  // namespace manycontact::python
