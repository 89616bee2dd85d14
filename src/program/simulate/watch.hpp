#pragma once
// Finds events of a simulation that the final state does not show, such as contacts that pull, slip or tip, joints
// beyond limits, singular configurations, and energy without a source.

#include <map>
#include <memory>
#include <set>

#include "../text/findings.hpp"
#include "manycontact/simulation/posture.hpp"
#include "simulate.hpp"

namespace manycontact::cli {

class Watch {
 public:
  Watch(const Scene& scene, const Options& options);
  ~Watch();
  Watch(Watch&&) noexcept;
  /// Checks a step that started at t from q, v with torques u and ended in the state of `sim`.
  void look(const Scene& scene, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& u,
            const SimulationData& sim);
  /// Returns true if no earlier call had the same set of active contacts in `sim`.
  bool is_new(const SimulationData& sim) { return judged_.insert(sim.dynamics.active).second; }
  /// Finds nearly dependent rows at the state of `sim` with torques u, and adds them to the findings `to`.
  void judge_rows(const Scene& scene, const Eigen::VectorXd& u, const SimulationData& sim, Findings& to);
  /// Returns a text such as "nearly dependent rows: loop[2]", or "" if judge_rows has found no rows.
  const std::string& nearly_dependent() const { return near_dependent_; }
  void lost(double energy) { work_ -= energy; }  // energy: dissipated by an impact

  double work() const { return work_; }                   // work of torques, minus energy that impacts dissipated [J]
  double work_of_wrenches() const { return push_work_; }  // work of external wrenches [J]
  void print(std::ostream& out, const SceneFile& file, const SimulationData& sim, const Invariants& start,
             const Invariants& end, double most_kinetic) const;
  /// Adds the keys violations, limits_passed and turning_rows, whose items have first_time [s]. Also adds work [J],
  /// largest_condition and the nearest singular configuration, the latter two with their times.
  void add_to(Json& json, const Scene& scene) const;

 private:
  template <class Finding>
  struct Seen {
    double first = 0;
    Finding worst;
  };
  std::map<std::vector<int>, Seen<Violation>> violations_;  // key: contact and kind
  std::map<std::vector<int>, Seen<LimitPassed>> limits_;    // key: robot, coordinate and quantity
  std::map<std::vector<int>, Seen<TurningRows>> turning_;   // key: contact
  // Returns the energy change without a source or sink [J], or 0 if the change is small.
  double gained_energy(const Invariants& start, const Invariants& end, double most_kinetic) const;
  void print_energy(std::ostream& out, const Scene& scene, const SimulationData& sim, double gained,
                    const Invariants& start, const Invariants& end, double most_kinetic) const;

  struct Applied;  // computes the power of external wrenches and dampers [W], with the wrenches of `sim`
  std::unique_ptr<Applied> applied_;  // null if the scene has no external wrenches and springs

  double work_ = 0, friction_work_ = 0, push_work_ = 0, spring_work_ = 0;
  PostureData posture_;
  double least_share_ = 1, share_time_ = 0;  // least ratio of the smallest to the largest singular value, and its time
  // First time at which the least singular value is near zero, relative to the largest, or -1.
  double singular_time_ = -1;
  double first_condition_ = 0, largest_condition_ = 0, condition_time_ = 0;
  int most_rank_ = -1;
  double rank_time_ = -1;  // first time at which independent rows became dependent, or -1
  std::vector<char> active_;
  std::set<std::vector<char>> judged_;  // sets of active contacts that were seen
  std::string near_dependent_;          // the text of nearly_dependent()
};

}  // namespace manycontact::cli
