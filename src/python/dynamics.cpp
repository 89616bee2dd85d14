#include <variant>

#include "data.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::python {

py::array_t<bool> flags_view(std::vector<char>& flags, py::handle owner) {
  static_assert(sizeof(bool) == sizeof(char));
  return py::array_t<bool>({flags.size()}, {1}, reinterpret_cast<const bool*>(flags.data()), owner);
}

void set_flags(const std::string& name, py::handle values, std::vector<char>& flags) {
  const py::array given = py::array::ensure(values);
  const char kind = given ? given.dtype().kind() : 'O';
  const bool whole = kind == 'b' || kind == 'i' || kind == 'u';
  if (!given || given.ndim() == 0 || (!whole && given.size() > 0))
    throw py::type_error(name + ": a sequence of bools is expected, one per contact");
  if (given.ndim() != 1 || given.size() != static_cast<py::ssize_t>(flags.size()))
    throw py::value_error(name + ": " + std::to_string(flags.size()) + " flags are expected, one per contact, not " +
                          shape_of(given));
  const auto numbers = py::array_t<std::int64_t, py::array::forcecast>::ensure(given);
  for (py::ssize_t k = 0; k < numbers.size(); ++k)
    if (numbers.at(k) != 0 && numbers.at(k) != 1)
      throw py::value_error(name + "[" + std::to_string(k) + "] is " + std::to_string(numbers.at(k)) +
                            ", a bool is expected");
  for (std::size_t k = 0; k < flags.size(); ++k) flags[k] = static_cast<char>(numbers.at(static_cast<py::ssize_t>(k)));
}

std::vector<char> flags_of(const Scene& scene, const py::object& active) {
  std::vector<char> flags = active_contacts(scene);
  if (!active.is_none()) set_flags("active", active, flags);
  return flags;
}

Eigen::Map<const Vector> checked(const char* name, const Raw& given) {
  check_numbers(name, given.array.data(), given.array.size());
  return given.vector();
}

Eigen::Map<const Vector> checked(const char* name, const Raw& given, Eigen::Index size) {
  const auto x = checked(name, given);
  if (x.size() != size)
    throw py::value_error(std::string(name) + ": " + std::to_string(size) + " numbers are expected, not " +
                          std::to_string(x.size()));
  return x;
}

Vector Data::force_of(const Scene& scene, int contact) const {
  const SceneData& d = at_rest();
  State& s = *state_;
  const bool checked = s.checked_scene == &scene && s.checked_serial == d.serial && s.checked_active == d.active;
  const auto c = static_cast<std::size_t>(contact);
  const bool there = contact >= 0 && c < d.f_offset.size() && c < scene.contacts.size() && d.f_offset[c] >= 0;
  if (!checked || !there || d.f_offset[c] + scene.contacts[c].rows() > d.f.size()) {
    Vector f = contact_force(scene, d, contact);
    s.checked_scene = &scene, s.checked_serial = d.serial, s.checked_active = d.active;
    return f;
  }
  return d.f.segment(d.f_offset[c], scene.contacts[c].rows());
}

namespace {

// ---- data and solve ------------------------------------------------------------------------------------------------

void add_data(py::module_& m) {
  using Shared = std::shared_ptr<Data>;
  using S = SceneData;
  const auto make = [](const Scene& scene, const Options& options) {
    return Data(std::make_shared<SceneData>(scene, options));
  };
  shared<Data>(m, "SceneData")
      .def(py::init(make))
      .handle<Shared>(
          "options", [](const Shared& d) -> const Options& { return d->at_rest().options; },
          [](const Shared& d, const Options& options) { d->at_rest().options = options; })
      .property(
          "active", [](const Shared& d) { return flags_view(d->at_rest().active, py::cast(d)); },
          [](const Data& d, py::handle values) { set_flags("SceneData.active", values, d.at_rest().active); },
          "wrenches", [](const Shared& d) { return wrenches_view(d->at_rest().wrenches, py::cast(d)); },
          [](const Data& d, py::handle values) { set_wrenches("SceneData.wrenches", values, d.at_rest().wrenches); })
      .read_at<&S::a, &S::f, &S::v, &S::tau, &S::serial, &S::f_offset, &S::report>(&Data::at_rest);
}

// Returns a function for Python that solves at q and v, with torques whose argument is called `name`.
auto solution(decltype(solve)* of_torques, const char* name) {
  return [=](const Scene& scene, const Raw& q, const Raw& v, const Raw& torques, const Data& data) {
    const auto Q = checked("q", q), V = checked("v", v), T = checked(name, torques);
    return Report(data.use([&](SceneData& d) -> const Report& { return of_torques(scene, Q, V, T, d); }));
  };
}

// Returns a function for Python that makes an estimate and returns the report with this estimate.
auto reported(void (*estimate)(const Scene&, SceneData&)) {
  return with_data([estimate](const Scene& scene, SceneData& data) {
    estimate(scene, data);
    return data.report;
  });
}

void add_solutions(py::module_& m) {
  def(m, "solve", solution(&solve, "u"));
  def(m, "solve_tau", solution(&solve_tau, "tau"));
  def(m, "prepare", with_data(&prepare));
  def(m, "estimate_condition", reported(&estimate_condition));
  def(m, "system_quality", with_data(&system_quality));
  def(m, "estimate_errors", reported(&estimate_errors));
  def(m, "quasi_static", [](const Scene& scene, const Raw& q, const std::shared_ptr<Data>& data) -> Vector {
    const auto Q = checked("q", q);
    if (data) return data->use([&](SceneData& d) { return quasi_static(scene, Q, d); });
    const py::gil_scoped_release unlocked;
    return quasi_static(scene, Q);
  });
  def(m, "available_simd_levels", &available_simd_levels);
  def(m, "force_names", [](const Scene& scene, const Data& data) { return force_names(scene, data.at_rest()); });
  def(m, "contact_force",
      [](const Scene& scene, const Data& data, const std::variant<int, std::string>& contact) -> Vector {
        const int* number = std::get_if<int>(&contact);
        return data.force_of(scene, number ? *number : contact_called(scene, std::get<std::string>(contact)));
      });
}

// ---- views ---------------------------------------------------------------------------------------------------------

void add_views(py::module_& m) {
  value<Island>(m)
      .read<&Island::robots, &Island::contacts, &Island::dof_offset, &Island::row_offset, &Island::nv, &Island::nc>();
  def(m, "island_count", [](const Data& data) { return island_count(data.at_rest()); });
  def(m, "solved_island", [](const Data& data, std::size_t i) {
    if (i >= island_count(data.at_rest()))
      throw py::value_error("solved_island: there is no island " + std::to_string(i));
    return solved_island(data.at_rest(), i);
  });
  def(m, "update_kinematics", [](const Scene& scene, const Vector& q, const Vector& v, const Data& data) {
    data.use([&](SceneData& d) { update_kinematics(scene, q, v, d); });
  });
  def_as(m, "frame_placement", "scene_frame_placement",
         [](const Scene& scene, const Data& data, const std::string& robot, const std::string& frame) {
           const int r = robot_called(scene, robot);
           const Robot& owner = scene.robots[r];
           const int number = owner.model->find_frame(frame);
           if (number < 0) throw py::value_error(no_frame(robot, *owner.model, frame));
           const Frame& f = owner.model->frames[number];
           SE3<double> out;
           data.use([&](SceneData& d) {
             if (d.serial == 0) prepare(scene, d);  // prepare throws if this is not possible
             out = frame_placement<double>(robot_kinematics(scene, d, r), owner.base, f.joint, f.placement);
           });
           return out;
         });
}

}  // namespace

void add_dynamics(py::module_& m) {
  add_data(m);
  add_solutions(m);
  add_views(m);
}

}  // namespace manycontact::python
