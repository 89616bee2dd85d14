#pragma once
// Events of a simulation that the final state does not show: contacts that pull, slip or tip, joints beyond limits,
// singular configurations, energy without a source.

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
  /// Returns true in the first call for each set of active contacts of `sim`.
  bool is_new(const SimulationData& sim) { return judged_.insert(sim.dynamics.active).second; }
  /// Finds nearly dependent rows at the state of `sim` with torques u, and adds them to the findings `to`.
  void judge_rows(const Scene& scene, const Eigen::VectorXd& u, const SimulationData& sim, Findings& to);
  /// Text on the rows that judge_rows has found, "nearly dependent rows: loop[2]"; empty if it has found no row.
  const std::string& nearly_dependent() const { return near_dependent_; }
  void lost(double energy) { work_ -= energy; }  // subtracts the energy that an impact dissipated

  double work() const { return work_; }  // J: work of the torques, less the energy dissipated by impacts
  double work_of_wrenches() const { return push_work_; }  // J: work of external wrenches
  /// Prints the findings; copies of a robot or a contact share a line.
  void print(std::ostream& out, const SceneFile& file, const SimulationData& sim, const Invariants& start,
             const Invariants& end, double most_kinetic) const;
  /// Adds the keys violations, limits_passed and turning_rows, whose items have first_time [s]; work [J]; and
  /// largest_condition and the nearest singular configuration, with their times.
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
  // Returns the energy change without a source or sink; 0 if the change is small [J].
  double gained_energy(const Invariants& start, const Invariants& end, double most_kinetic) const;
  void print_energy(std::ostream& out, const Scene& scene, const SimulationData& sim, double gained,
                    const Invariants& start, const Invariants& end, double most_kinetic) const;

  // The power of external wrenches and dampers [W]; `wrenches` as in `sim`.
  struct Applied;
  std::unique_ptr<Applied> applied_;  // nullptr: no wrenches and dampers

  double work_ = 0, friction_work_ = 0, push_work_ = 0, spring_work_ = 0;
  PostureData posture_;
  double least_share_ = 1, share_time_ = 0;  // least share of the smallest singular value in the largest, and its time
  double singular_time_ = -1;                // first time at which that share is near zero; -1: never
  double first_condition_ = 0, largest_condition_ = 0, condition_time_ = 0;
  int most_rank_ = -1;
  double rank_time_ = -1;  // first time at which independent rows became dependent; -1: never
  std::vector<char> active_;
  std::set<std::vector<char>> judged_;  // sets of active contacts
  std::string near_dependent_;          // the text of nearly_dependent()
};

}  // namespace manycontact::cli
