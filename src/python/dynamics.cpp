// Data, solutions and views of intermediate results.

#include <variant>

#include "data.hpp"
#include "docs/solve.hpp"
#include "manycontact/algorithm/frames.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::python {

using Vector = Eigen::VectorXd;

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

Handle<Options> options_in(const std::shared_ptr<Data>& data) {
  return {[data]() -> const Options& { return data->at_rest().options; },
          [data](const Options& options) { data->at_rest().options = options; }};
}

void add_data(py::module_& m) {
  py::class_<Data, std::shared_ptr<Data>>(
      m, "SceneData", "The variable part of a scene: inputs, the solution, and the workspace. Use one per thread.")
      .def(py::init([](const Scene& scene, const Options& options) {
             return Data(std::make_shared<SceneData>(scene, options));
           }),
           py::arg("scene"), py::arg_v("options", Options(), "Options()"))
      .def_property(
          "options", &options_in, [](const Data& d, const Options& options) { d.at_rest().options = options; },
          "Options of the solves.")
      .def_property(
          "active", [](const std::shared_ptr<Data>& d) { return flags_view(d->at_rest().active, py::cast(d)); },
          [](const Data& d, py::handle values) { set_flags("SceneData.active", values, d.at_rest().active); },
          "One bool per contact of the scene; data.active[i] = False switches a contact off.")
      .def_property(
          "pushes", [](const std::shared_ptr<Data>& d) { return wrenches_view(d->at_rest().pushes, py::cast(d)); },
          [](const Data& d, py::handle values) { set_wrenches("SceneData.pushes", values, d.at_rest().pushes); },
          "One wrench (6) per push of the scene [N, N m]; data.pushes[i] = ... changes one.")
      .def_property_readonly(
          "a", [](const Data& d) { return d.at_rest().a; }, "Accelerations (nv) [m/s^2, rad/s^2]; a copy.")
      .def_property_readonly(
          "f", [](const Data& d) { return d.at_rest().f; },
          "Contact forces on A (one entry per constraint row of the active contacts), in each contact's reference\n"
          "frame [N, N m]; a copy.")
      .def_property_readonly(
          "v", [](const Data& d) { return d.at_rest().v; }, "Velocity (nv) of the last solve; a copy.")
      .def_property_readonly(
          "tau", [](const Data& d) { return d.at_rest().tau; }, "Torques (nv) of the last solve; a copy.")
      .def_property_readonly(
          "serial", [](const Data& d) { return d.at_rest().serial; }, "Number of the solve; 0: there is no solution.")
      .def_property_readonly(
          "f_offset", [](const Data& d) { return d.at_rest().f_offset; },
          "Per contact: its first row in f, or -1 if it is not active.")
      .def_property_readonly(
          "report", [](const Data& d) { return d.at_rest().report; }, "Report of the last solve; a copy.");
}

void add_solutions(py::module_& m) {
  m.def(
      "solve",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& u, const Data& data) {
        check_numbers("q", q.array.data(), q.array.size());
        check_numbers("v", v.array.data(), v.array.size());
        check_numbers("u", u.array.data(), u.array.size());
        const auto Q = q.vector(), V = v.vector(), U = u.vector();
        return Report(data.use([&](SceneData& d) -> const Report& { return solve(scene, Q, V, U, d); }));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("u"), py::arg("data"), doc::solve);
  m.def(
      "solve_tau",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& tau, const Data& data) {
        check_numbers("q", q.array.data(), q.array.size());
        check_numbers("v", v.array.data(), v.array.size());
        check_numbers("tau", tau.array.data(), tau.array.size());
        const auto Q = q.vector(), V = v.vector(), T = tau.vector();
        return Report(data.use([&](SceneData& d) -> const Report& { return solve_tau(scene, Q, V, T, d); }));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("tau"), py::arg("data"), doc::solve_tau);
  m.def(
      "prepare", [](const Scene& scene, const Data& data) { data.use([&](SceneData& d) { prepare(scene, d); }); },
      py::arg("scene"), py::arg("data"), doc::prepare);
  m.def(
      "estimate_condition",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) {
          estimate_condition(scene, d);
          return d.report;
        });
      },
      py::arg("scene"), py::arg("data"), doc::estimate_condition);
  m.def(
      "system_quality",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) { return system_quality(scene, d); });
      },
      py::arg("scene"), py::arg("data"), doc::system_quality);
  m.def(
      "estimate_errors",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) {
          estimate_errors(scene, d);
          return d.report;
        });
      },
      py::arg("scene"), py::arg("data"), doc::estimate_errors);
  m.def(
      "quasi_static",
      [](const Scene& scene, const Raw& q, const std::shared_ptr<Data>& data) -> Vector {
        check_numbers("q", q.array.data(), q.array.size());
        const auto Q = q.vector();
        if (data) return data->use([&](SceneData& d) { return quasi_static(scene, Q, d); });
        const py::gil_scoped_release unlocked;
        return quasi_static(scene, Q);
      },
      py::arg("scene"), py::arg("q"), py::arg("data") = py::none(), doc::quasi_static);
  m.def("lanes_here", &lanes_here, doc::lanes_here);
  m.def(
      "force_names", [](const Scene& scene, const Data& data) { return force_names(scene, data.at_rest()); },
      py::arg("scene"), py::arg("data"), doc::force_names);
  m.def(
      "contact_force",
      [](const Scene& scene, const Data& data, const std::variant<int, std::string>& contact) -> Vector {
        const int* number = std::get_if<int>(&contact);
        return data.force_of(scene, number ? *number : contact_called(scene, std::get<std::string>(contact)));
      },
      py::arg("scene"), py::arg("data"), py::arg("contact"), doc::contact_force);
}

// ---- views ---------------------------------------------------------------------------------------------------------

int robot_number(const Scene& scene, const std::string& name) {
  const auto found = scene.robot_index.find(name);
  if (found == scene.robot_index.end()) throw py::value_error(no_robot(scene, name));
  return found->second;
}

void add_views(py::module_& m) {
  py::class_<Island> island(m, "Island", "Robots that are coupled by active contacts.");
  add_value(island)
      .def_readonly("robots", &Island::robots, "Numbers of the robots in the scene, ascending.")
      .def_readonly("contacts", &Island::contacts, "Numbers of the active contacts in the scene, ascending.")
      .def_readonly("dof_offset", &Island::dof_offset, "Per robot: its first velocity coordinate in the island.")
      .def_readonly("row_offset", &Island::row_offset, "Per contact: its first constraint row in the island.")
      .def_readonly("nv", &Island::nv, "Number of velocity coordinates.")
      .def_readonly("nc", &Island::nc, "Number of constraint rows.");
  m.def(
      "island_count", [](const Data& data) { return island_count(data.at_rest()); }, py::arg("data"),
      doc::island_count);
  m.def(
      "island_of",
      [](const Data& data, std::size_t i) {
        if (i >= island_count(data.at_rest())) throw py::value_error("island_of: there is no such island");
        return island_of(data.at_rest(), i);
      },
      py::arg("data"), py::arg("island"), doc::island_of);
  m.def(
      "update_kinematics",
      [](const Scene& scene, const Vector& q, const Vector& v, const Data& data) {
        data.use([&](SceneData& d) { update_kinematics(scene, q, v, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("data"), doc::update_kinematics);
  m.def(
      "frame_placement",
      [](const Scene& scene, const Data& data, const std::string& robot, const std::string& frame) {
        const int r = robot_number(scene, robot);
        const Robot& owner = scene.robots[r];
        const int number = owner.model->find_frame(frame);
        if (number < 0) throw py::value_error(no_frame(robot, *owner.model, frame));
        data.use([&](SceneData& d) { d.serial != 0 ? complete(scene, d) : prepare(scene, d); });  // or refuse the scene
        const Frame& f = owner.model->frames[number];
        return frame_placement<double>(kinematics_of(data.at_rest(), r), owner.base, f.joint, f.placement);
      },
      py::arg("scene"), py::arg("data"), py::arg("robot"), py::arg("frame"), doc::scene_frame_placement);
  m.def(
      "complete", [](const Scene& scene, const Data& data) { data.use([&](SceneData& d) { complete(scene, d); }); },
      py::arg("scene"), py::arg("data"), doc::complete);
}

}  // namespace

void add_dynamics(py::module_& m) {
  add_data(m);
  add_solutions(m);
  add_views(m);
}

}  // namespace manycontact::python
