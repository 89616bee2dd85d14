#pragma once
// Joint torques during a simulation: those of the scene or of a file over time, plus a PD law towards a reference.

#include <optional>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact::cli {

/// Numbers over time from a CSV file with a column t in ascending order and columns called `prefix` + coordinate name.
class TimeTable {
 public:
  /// Reads columns `prefix` + name, and ignores other prefixes. Throws InputError, also if a name is not in `names`.
  TimeTable(const std::string& path, const std::string& prefix, const std::vector<std::string>& names);

  bool empty() const { return columns_.empty(); }
  /// Sets those entries of x that have a column to the values of the last row up to t, or does nothing before the first
  /// row. With `between`, values are interpolated between rows, and constant before the first row.
  void at(double t, bool between, Eigen::VectorXd& x) const;
  /// Computes the slope of each column's interpolation at t. It is 0 before the first row, and from the last row on.
  void slopes_at(double t, Eigen::VectorXd& slopes) const;
  /// Returns the coordinates that have a column, in the order of the columns.
  const std::vector<int>& columns() const { return columns_; }

 private:
  std::vector<int> columns_;  // index in x of each column's coordinate
  std::vector<double> t_, values_;
};

/// Torques u(t), and the PD law kp (q_ref(t) - q) + kd (v_ref(t) - v), whose torques `step` adds (simulation/step.hpp).
class Control {
 public:
  explicit Control(const SceneFile& file)
      : file_(file), u_(file.u), q_(file.q), v_(Eigen::VectorXd::Zero(file.v.size())) {}
  /// Reads torques over time from columns "u:r0/knee", constant until the next row. The scene's torques apply before
  /// the first row, and to joints without a column.
  void read_torques(const std::string& path);
  /// Sets a PD law towards the columns "q:r0/knee" and "v:r0/knee" of the file `reference`, interpolated between rows.
  /// Without a v: column, the velocity is the slope of q:. Without both, the reference is the scene's q at rest. gains:
  /// "kp kd; r0/knee kp kd; ...", where the first pair is for all other joints. Throws UsageError, and InputError for
  /// actuated multi-coordinate joints.
  void follow(const std::string& gains, const std::optional<std::string>& reference);

  const Eigen::VectorXd& torques_at(double t);
  void set_pd(double t, PdLaws& pd);  // sets pd.q_ref and pd.v_ref to the reference at time t
  /// Returns the torques of torques_at plus those of the PD law at q, v.
  const Eigen::VectorXd& at(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);

 private:
  void for_all(double kp, double kd);
  const SceneFile& file_;
  Eigen::VectorXd u_, q_, v_, out_, kp_, kd_, slopes_;  // kp_, kd_: nv
  std::vector<int> v_of_slope_;  // coordinate of v that follows the slope of each column of q_over_time_, or -1
  std::optional<TimeTable> torques_, q_over_time_, v_over_time_;
  bool follows_ = false;
  PdLaws pd_;
};

}  // namespace manycontact::cli
