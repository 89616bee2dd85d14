#include "data.hpp"
#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/rank_changes.hpp"
#include "manycontact/analysis/redistribute_forces.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/analysis/unique_forces.hpp"
#include "manycontact/contact/jacobian.hpp"

namespace manycontact::python {

namespace {

void add_errors(py::module_& m) {
  value<PlacementError>(m).read<&PlacementError::contact, &PlacementError::position, &PlacementError::angle>().def(
      "__repr__", [](const PlacementError& e) {
        return "<PlacementError of contact " + std::to_string(e.contact) + ": " + text::number(e.position) + " m, " +
               text::number(e.angle) + " rad>";
      });
  value<VelocityError>(m).read<&VelocityError::contact, &VelocityError::linear, &VelocityError::angular>().def(
      "__repr__", [](const VelocityError& e) {
        return "<VelocityError of contact " + std::to_string(e.contact) + ": " + text::number(e.linear) + " m/s, " +
               text::number(e.angular) + " rad/s>";
      });
  def(m, "placement_errors", [](const Scene& scene, const Raw& q, const py::object& active) {
    const auto Q = checked("q", q, scene.nq);
    return placement_errors(scene, Q, flags_of(scene, active));
  });
  def(m, "velocity_errors", [](const Scene& scene, const Raw& q, const Raw& v, const py::object& active) {
    const auto Q = checked("q", q, scene.nq), V = checked("v", v, scene.nv);
    return velocity_errors(scene, Q, V, flags_of(scene, active));
  });
}

void add_violations(py::module_& m) {
  enumeration<ViolationKind>(m);
  value<Violation>(m).read<&Violation::contact, &Violation::kind, &Violation::by, &Violation::needs>();
  def(m, "violations", [](const Scene& scene, const Raw& q, const Data& data) {
    const auto Q = checked("q", q, scene.nq);
    const SceneData& d = data.at_rest();
    if (d.f_offset.size() != scene.contacts.size())
      throw py::value_error("violations: the data belong to another scene");
    return violations(scene, Q, d.f, d.f_offset);
  });
  enumeration<LimitKind>(m);
  value<LimitPassed>(m)
      .read<&LimitPassed::robot, &LimitPassed::dof, &LimitPassed::quantity, &LimitPassed::value, &LimitPassed::limit>();
  def(m, "limits_passed", [](const Scene& scene, const Raw& q, const Raw& v, const Raw& u) {
    const auto Q = checked("q", q, scene.nq), V = checked("v", v, scene.nv), U = checked("u", u, scene.nu);
    return limits_passed(scene, Q, V, U);
  });
}

void add_forces_on_bodies(py::module_& m) {
  def(m, "forces_on_bodies", [](const Scene& scene, const Raw& q, const Raw& v, const Data& data) {
    const auto Q = checked("q", q, scene.nq), V = checked("v", v, scene.nv);
    return rows_of_wrenches(data.use([&](SceneData& d) {
      if (d.serial == 0) throw std::logic_error("forces_on_bodies: there is no solution, call solve first");
      return forces_on_bodies(scene, Q, V, d.f, d.f_offset, d.wrenches);
    }));
  });
}

py::array_t<bool> bools(const std::vector<char>& flags) {
  py::array_t<bool> out(static_cast<py::ssize_t>(flags.size()));
  std::copy(flags.begin(), flags.end(), out.mutable_data());
  return out;
}

std::optional<Vector> vector_or_none(const char* name, const std::optional<Raw>& given, Eigen::Index n) {
  return given ? std::optional<Vector>(checked(name, *given, n)) : std::nullopt;
}

void add_redistribution(py::module_& m) {
  def(m, "unique_forces", at_solution(&unique_forces, bools));
  def(m, "force_null_space", at_solution(&force_null_space, scipy_csc));
  def(m, "redistribute_forces",
      [](const Scene& scene, const Raw& q, const Data& data, const std::optional<Raw>& reference,
         const std::optional<Raw>& weights) -> Vector {
        const auto Q = checked("q", q, scene.nq);
        const Eigen::Index n = data.at_rest().f.size();
        const auto towards = vector_or_none("reference", reference, n), w = vector_or_none("weights", weights, n);
        return data.use([&](SceneData& d) {
          return redistribute_forces(scene, Q, d, towards.value_or(Vector()), w.value_or(Vector()));
        });
      });
}

void add_rank_changes(py::module_& m) {
  value<RankChange>(m)
      .read<&RankChange::island, &RankChange::singular, &RankChange::rank, &RankChange::rows, &RankChange::contacts,
            &RankChange::coordinate>();
  def(m, "rank_changes", at_solution(&rank_changes));
}

void add_near_dependent(py::module_& m) {
  value<NearDependent>(m)
      .read<&NearDependent::island, &NearDependent::rows, &NearDependent::left, &NearDependent::times,
            &NearDependent::coordinate, &NearDependent::acceleration, &NearDependent::without>();
  def(m, "near_dependent", at_solution(&near_dependent));
  value<RankGap>(m)
      .read<&RankGap::known, &RankGap::least_kept, &RankGap::most_dropped, &RankGap::kept, &RankGap::dropped,
            &RankGap::gap>();
  def(m, "rank_gap", [](const Scene& scene, const Data& data, std::size_t island) {
    return data.use([&](SceneData& d) {
      if (island >= d.report.islands.size())
        throw py::value_error("rank_gap: there is no island " + std::to_string(island));
      return rank_gap(scene, d, island);
    });
  });
}

void add_consistent(py::module_& m) {
  value<ConsistentState>(m)
      .read<&ConsistentState::q, &ConsistentState::v, &ConsistentState::status, &ConsistentState::steps,
            &ConsistentState::misplaced, &ConsistentState::moving, &ConsistentState::consistent>();
  def(m, "make_consistent",
      [](const Scene& scene, const Raw& q, const Raw& v, const py::object& active, const Options& options) {
        const auto Q = checked("q", q, scene.nq), V = checked("v", v, scene.nv);
        const std::vector<char> flags = flags_of(scene, active);
        const py::gil_scoped_release unlocked;
        return make_consistent(scene, flags, Q, V, options);
      });
}

}  // namespace

void add_analysis(py::module_& m) {
  add_errors(m);
  add_violations(m);
  add_redistribution(m);
  add_forces_on_bodies(m);
  add_rank_changes(m);
  add_near_dependent(m);
  add_consistent(m);
}

}  // namespace manycontact::python
