#include "watch.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "../text/describe.hpp"
#include "../text/table.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/analysis/names.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostShown = 8;
constexpr double kSingular = 1e4;  // growth of the condition number that indicates a singular configuration
constexpr double kPassed = 1e-2;   // the motion passed a singular configuration if the least singular value of the
                                   // contacts is below this share of the largest
constexpr double kGained = 0.01;   // least reported energy change without a source, relative to the kinetic energy

double torque_power(const Scene& scene, const Eigen::VectorXd& u, const Eigen::VectorXd& v) {
  double power = 0;
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) power += u[robot.idx_u + k] * v[robot.idx_v + robot.model->actuated[k]];
  return power;
}

double size_of(const Violation& x) { return x.by; }
double size_of(const LimitPassed& x) { return std::abs(x.value - x.limit); }
double size_of(const TurningRows& x) { return x.rate; }

// Return the key of a finding: contact or coordinate, and kind. With `group`, findings of copies have the same key.
std::vector<int> key_of(const Violation& x, const std::vector<int>& group) {
  return {group.empty() ? x.contact : group[x.contact], static_cast<int>(x.kind)};
}
std::vector<int> key_of(const LimitPassed& x, const std::vector<int>& group) {
  return {group.empty() ? x.robot : group[x.robot], x.dof, static_cast<int>(x.quantity)};
}
std::vector<int> key_of(const TurningRows& x, const std::vector<int>& group) {
  return {group.empty() ? x.contact : group[x.contact]};
}

int member_of(const LimitPassed& x) { return x.robot; }
int member_of(const auto& x) { return x.contact; }

// Merges the findings of a step that started at t into `seen`, which keeps per key_of a finding the first time and
// the worst finding.
template <class Found, class Seen>
void take(const std::vector<Found>& found, double t, std::map<std::vector<int>, Seen>& seen) {
  for (const Found& x : found) {
    const auto [at, fresh] = seen.try_emplace(key_of(x, {}), Seen{t, x});
    if (!fresh && size_of(x) > size_of(at->second.worst)) at->second.worst = x;
  }
}

template <class Seen>
std::vector<const Seen*> by_time(const std::map<std::vector<int>, Seen>& seen) {
  std::vector<const Seen*> out;
  for (const auto& [key, x] : seen) out.push_back(&x);
  std::ranges::stable_sort(out, {}, &Seen::first);
  return out;
}

// Prints a line per kind of finding and group of copies: first time, members (contacts or robots) and worst finding.
// names(...) returns one name for several members.
template <class Seen, class Names>
void print_copies(std::ostream& out, const Scene& scene, const std::map<std::vector<int>, Seen>& seen,
                  const std::string& most, const std::vector<int>& group, Names&& names) {
  std::map<std::vector<int>, std::size_t> line_of;
  std::vector<std::vector<const Seen*>> lines;
  for (const Seen* x : by_time(seen)) {
    const auto [at, fresh] = line_of.try_emplace(key_of(x->worst, group), lines.size());
    if (fresh) lines.emplace_back();
    lines[at->second].push_back(x);
  }
  for (std::size_t k = 0; k < lines.size() && k < kMostShown; ++k) {
    const Seen* worst = *std::ranges::max_element(lines[k], {}, [](const Seen* x) { return size_of(x->worst); });
    std::set<int> members;
    for (const Seen* x : lines[k]) members.insert(member_of(x->worst));
    const std::string who = members.size() > 1 ? names(scene, {members.begin(), members.end()}) + "; " : "";
    wrap(out,
         "from t = " + number(lines[k].front()->first, 4) + " s on, " + who + most + ": " +
             in_words(scene, worst->worst),
         2);
  }
  if (lines.size() > kMostShown) out << "  ... and " << lines.size() - kMostShown << " more, later\n";
}

}  // namespace

struct Watch::Applied {
  explicit Applied(const Scene& scene) : forces(scene), tau(scene.nv) {}
  AppliedForces<double> forces;
  Eigen::VectorXd tau;

  AppliedPower at(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const SimulationData& sim) {
    tau.setZero();
    add_applied_forces<double>(scene, q.data(), v.data(), sim.dynamics.wrenches, forces, tau.data());
    return power_of(scene, forces);
  }
};

Watch::Watch(const Scene& scene, const Options& options) : posture_(scene, options) {
  if (has_applied_forces(scene)) applied_ = std::make_unique<Applied>(scene);
}
Watch::~Watch() = default;
Watch::Watch(Watch&&) noexcept = default;

void Watch::look(const Scene& scene, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                 const Eigen::VectorXd& u, const SimulationData& sim) {
  work_ += sim.h * (torque_power(scene, u, v) + torque_power(scene, u, sim.v)) / 2;
  friction_work_ += sim.work.friction + sim.work.dampers;
  spring_work_ += sim.work.springs;
  if (applied_) {
    const AppliedPower before = applied_->at(scene, q, v, sim), after = applied_->at(scene, sim.q, sim.v, sim);
    push_work_ += sim.h * (before.wrenches + after.wrenches) / 2;
  }
  keep_dependent_as(sim.dynamics, posture_.rest.scene, posture_.dynamics);
  const ClosestPosture closest = follow_posture(scene, sim.dynamics.active, q, posture_);
  if (closest.share < least_share_) least_share_ = closest.share, share_time_ = t - (1 - closest.at) * sim.h;
  if (closest.share < kPassed && singular_time_ < 0) singular_time_ = t - (1 - closest.at) * sim.h;
  Eigen::VectorXd loads = robot_weights(scene);
  for (std::size_t r = 0; sim.integrator == Integrator::kSemiImplicitEuler && r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    if (robot.model->nv > 0)
      loads[r] += robot.model->mass() * v.segment(robot.idx_v, robot.model->nv).cwiseAbs().maxCoeff() / sim.h;
  }
  take(violations(scene, q, sim.f, sim.f_offset, loads), t, violations_);
  take(limits_passed(scene, q, v, u), t, limits_);
  take(turning_rows(scene, q, v, sim.dynamics.active), t, turning_);
  if (first_condition_ == 0 && std::isfinite(sim.condition)) first_condition_ = sim.condition;
  if (sim.condition > largest_condition_) largest_condition_ = sim.condition, condition_time_ = t;
  if (active_ != sim.dynamics.active) active_ = sim.dynamics.active, most_rank_ = -1;
  if (sim.dynamics.report.rank < most_rank_ && rank_time_ < 0) rank_time_ = t;
  most_rank_ = std::max(most_rank_, sim.dynamics.report.rank);
}

void Watch::judge_rows(const Scene& scene, const Eigen::VectorXd& u, const SimulationData& sim, Findings& to) {
  SceneData data(scene, sim.dynamics.options);
  data.active = sim.dynamics.active;
  if (solve(scene, sim.q, sim.v, u, data).status == Status::kFailed) return;
  find_near_dependent(scene, sim.q, data, to);
  std::vector<std::string> rows;
  for (const NearlyDependent& n : to.near_dependent) rows.insert(rows.end(), n.rows.begin(), n.rows.end());
  if (!rows.empty()) near_dependent_ = "nearly dependent rows: " + join(rows, 2);
}

void Watch::print(std::ostream& out, const SceneFile& file, const SimulationData& sim, const Invariants& start,
                  const Invariants& end, double most_kinetic) const {
  const Scene& scene = file.scene;
  const auto contacts = [](const Scene& of, const std::vector<int>& list) { return contact_names(of, list); };
  const auto robots = [](const Scene& of, const std::vector<int>& list) { return robot_names(of, list); };
  print_copies(out, scene, violations_, "at most", group_of_contacts(file), contacts);
  print_copies(out, scene, limits_, "farthest", file.robot_group, robots);
  print_copies(out, scene, turning_, "at most", group_of_contacts(file), contacts);
  const double gained = gained_energy(start, end, most_kinetic);
  const bool gains = std::ranges::any_of(scene.contacts, [](const Contact& c) { return c.alpha != 0 || c.beta != 0; });
  const std::string advice =
      (!gains && end.violation_position >= kPlacementError ? "; --gains recommended keeps loops closed" : "") +
      std::string(gained != 0 ? "; shorter steps keep more of the energy" : "");
  const bool passed = singular_time_ >= 0 && (rank_time_ < 0 || singular_time_ < rank_time_);
  if (passed || rank_time_ >= 0 || largest_condition_ > kSingular * first_condition_)
    wrap(out,
         (passed ? "the motion passes a singular configuration at t = " + number(singular_time_, 4) +
                       " s: contact rows lose rank there"
          : rank_time_ >= 0 ? "the motion is near a singular configuration at t = " + number(rank_time_, 4) +
                                  " s: contact rows lose rank"
                            : "the motion is near a singular configuration at t = " + number(condition_time_, 4) +
                                  " s: the condition is " + scientific(largest_condition_) + ", at the start " +
                                  scientific(first_condition_)) +
             "; forces there depend on the step" + advice,
         2);
  print_energy(out, scene, sim, gained, start, end, most_kinetic);
}

double Watch::gained_energy(const Invariants& start, const Invariants& end, double most_kinetic) const {
  const double gained = end.energy() - start.energy() - work_ - friction_work_ - push_work_ - spring_work_;
  const double passed = std::abs(work_) + std::abs(friction_work_) + std::abs(push_work_) + std::abs(spring_work_);
  const bool counts = std::abs(gained) > kGained * std::max(most_kinetic, passed) &&
                      std::abs(gained) > 1e-9 * std::abs(start.potential);
  return counts ? gained : 0;
}

void Watch::print_energy(std::ostream& out, const Scene& scene, const SimulationData& sim, double gained,
                         const Invariants& start, const Invariants& end, double most_kinetic) const {
  constexpr double kRounding = 1e-12;  // rounding error of an energy, relative to the total energy at the start
  if (-spring_work_ > std::max({kGained * most_kinetic, kGained * (start.potential - end.potential),
                                kRounding * std::abs(start.energy())}))
    wrap(out,
         "steps of " + number(sim.h) + " s removed " + number(-spring_work_) +
             " J from springs that oscillate too fast for these steps; shorter steps remove less, and --integrator rk4 "
             "almost nothing",
         2);
  if (gained == 0) return;
  const std::string why = near_dependent_.empty()
                              ? "steps of " + number(sim.h) +
                                    " s are too long for this motion, or gains correct contacts that are out of place" +
                                    (gained < 0 && scene.damping > 0 ? ", or --damping dissipates energy" : "")
                              : near_dependent_;
  wrap(out,
       gained > 0 ? "energy grew by " + number(gained) + " J more than the torques" +
                        (applied_ ? " and wrenches" : "") + " gave: " + why
                  : "energy fell by " + number(-gained) + " J more than torques" +
                        (friction_work_ < 0 ? ", friction" : "") + " and impacts dissipated: " + why,
       2);
}

void Watch::add_to(Json& json, const Scene& scene) const {
  const auto list = [&](const char* key, const auto& seen) {
    json[key] = Json::array();
    for (const auto* x : by_time(seen)) {
      Json entry = json_of(scene, x->worst);
      entry["first_time"] = x->first;
      json[key].push_back(entry);
    }
  };
  list("violations", violations_);
  list("limits_passed", limits_);
  list("turning_rows", turning_);
  json["work_of_torques"] = work_;
  json["work_of_friction"] = friction_work_;
  json["work_of_wrenches"] = push_work_;
  json["taken_from_springs"] = -spring_work_;
  json["closest_to_singular"] = least_share_;
  json["closest_to_singular_time"] = share_time_;
  json["largest_condition"] = largest_condition_;
  json["largest_condition_time"] = condition_time_;
}

}  // namespace manycontact::cli
