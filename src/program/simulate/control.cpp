#include "control.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "../files/csv_read.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/model/suggestion.hpp"
#include "simulate.hpp"

namespace manycontact::cli {

namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

TimeTable::TimeTable(const std::string& path, const std::string& prefix, const std::vector<std::string>& names) {
  CsvReader csv(path);
  std::unordered_map<std::string, int> index;
  for (std::size_t i = 0; i < names.size(); ++i) index.emplace(names[i], static_cast<int>(i));
  std::vector<std::size_t> cell;  // one entry per entry of columns_: index of its cell in a row of the file
  for (std::size_t k = 0; k < csv.names().size(); ++k) {
    const std::string& title = csv.names()[k];
    if (!title.starts_with(prefix)) continue;
    const std::string name = title.substr(prefix.size());
    const auto found = index.find(name);
    if (found == index.end())
      csv.fail("column " + quote(title) + " names nothing in the scene, " + suggestion(name, names));
    columns_.push_back(found->second);
    cell.push_back(k);
  }
  while (csv.next()) {
    t_.push_back(csv.t());
    for (std::size_t k : cell) values_.push_back(csv.number(k));
  }
  if (t_.empty()) csv.fail("has no rows, expected at least one row");
}

void TimeTable::at(double t, bool between, Eigen::VectorXd& x) const {
  // t is a multiple of the step size, and may differ from the time of a row by a rounding error
  const double late = t + 1e-9 * std::abs(t);
  if (!between && late < t_.front()) return;
  const std::size_t after = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), late) - t_.begin());
  const std::size_t row = after == 0 ? 0 : after - 1, next = std::min(after, t_.size() - 1), n = columns_.size();
  const double share = between && next > row ? std::clamp((t - t_[row]) / (t_[next] - t_[row]), 0.0, 1.0) : 0;
  for (std::size_t k = 0; k < n; ++k)
    x[columns_[k]] = (1 - share) * values_[row * n + k] + share * values_[next * n + k];
}

void TimeTable::slopes_at(double t, Eigen::VectorXd& slopes) const {
  const std::size_t after = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t + 1e-9 * std::abs(t)) -
                                                     t_.begin()),
                    n = columns_.size();
  slopes.setZero(static_cast<Eigen::Index>(n));
  if (after == 0 || after == t_.size()) return;
  for (std::size_t k = 0; k < n; ++k)
    slopes[k] = (values_[after * n + k] - values_[(after - 1) * n + k]) / (t_[after] - t_[after - 1]);
}

void Control::read_torques(const std::string& path) {
  torques_.emplace(path, "u:", torque_names(file_.scene));
  if (torques_->empty()) throw InputError(path, 1, "has no column of torques, expected columns like u:robot/joint");
}

void Control::follow(const std::string& gains, const std::optional<std::string>& reference) {
  const Scene& scene = file_.scene;
  kp_.setZero(scene.nv), kd_.setZero(scene.nv);
  const std::vector<std::string> names = velocity_names(scene), torques = torque_names(scene);
  std::size_t begin = 0;
  for (bool first = true; begin <= gains.size(); first = false) {
    const std::size_t end = std::min(gains.find(';', begin), gains.size());
    const std::string entry = trimmed(gains.substr(begin, end - begin));
    begin = end + 1;
    const std::size_t space = entry.find(' ');
    const std::string name = entry.substr(0, space);
    if (name.find('/') == std::string::npos) {
      if (!first) throw UsageError("option --pd names no joint in '" + entry + "', expected 'robot/joint kp kd'");
      const Gains k = two_numbers("--pd", "kp kd", entry);
      for_all(k.alpha, k.beta);
      continue;
    }
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      throw UsageError("option --pd: there is no joint " + quote(name) + " with one coordinate, " +
                       suggestion(name, names));
    const Gains k = two_numbers("--pd", "kp kd", space == std::string::npos ? "" : entry.substr(space + 1));
    const auto i = found - names.begin();
    if (std::ranges::find(torques, name) == torques.end())
      throw UsageError("option --pd: joint " + quote(name) + " has no torque, expected an actuated joint");
    kp_[i] = k.alpha, kd_[i] = k.beta;
  }
  follows_ = true;
  if (!reference) return;
  q_over_time_.emplace(*reference, "q:", configuration_names(scene));
  v_over_time_.emplace(*reference, "v:", velocity_names(scene));
  if (q_over_time_->empty())
    throw InputError(*reference, 1, "has no column of positions, expected columns like q:robot/joint");
  const std::vector<int>& given = v_over_time_->columns();
  v_of_slope_.assign(q_over_time_->columns().size(), -1);
  for (std::size_t k = 0; k < v_of_slope_.size(); ++k)
    for (const Robot& robot : file_.scene.robots)
      for (const Joint& joint : robot.model->joints)
        if (joint.nv() == 1 && robot.idx_q + joint.idx_q == q_over_time_->columns()[k] &&
            std::ranges::find(given, robot.idx_v + joint.idx_v) == given.end())
          v_of_slope_[k] = robot.idx_v + joint.idx_v;
}

void Control::for_all(double kp, double kd) {
  for (const Robot& robot : file_.scene.robots)
    for (const Joint& joint : robot.model->joints) {
      if (robot.model->torque_index(joint) < 0) continue;
      if (joint.nv() > 1)
        throw InputError(file_.path, 1,
                         "joint " + quote(robot.name + "/" + joint.name) +
                             " has several coordinates, expected one coordinate for --pd");
      kp_[robot.idx_v + joint.idx_v] = kp, kd_[robot.idx_v + joint.idx_v] = kd;
    }
}

const Eigen::VectorXd& Control::torques_at(double t) {
  if (torques_) torques_->at(t, false, u_);
  return u_;
}

void Control::set_pd(double t, PdLaws& pd) {
  if (!follows_) return;
  if (q_over_time_) q_over_time_->at(t, true, q_);
  if (v_over_time_) v_over_time_->at(t, true, v_);
  if (q_over_time_) q_over_time_->slopes_at(t, slopes_);
  for (std::size_t k = 0; k < v_of_slope_.size(); ++k)
    if (v_of_slope_[k] >= 0) v_[v_of_slope_[k]] = slopes_[k];
  pd.kp = kp_, pd.kd = kd_, pd.v_ref = v_;
  pd.q_ref.setZero(kp_.size());
  for (const Robot& robot : file_.scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() == 1) pd.q_ref[robot.idx_v + joint.idx_v] = q_[robot.idx_q + joint.idx_q];
}

const Eigen::VectorXd& Control::at(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  out_ = torques_at(t);
  if (!follows_) return out_;
  set_pd(t, pd_);
  for (const Robot& robot : file_.scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (const int k = robot.model->torque_index(joint), i = robot.idx_v + joint.idx_v; k >= 0 && joint.nv() == 1)
        out_[robot.idx_u + k] +=
            kp_[i] * (pd_.q_ref[i] - q[robot.idx_q + joint.idx_q]) + kd_[i] * (pd_.v_ref[i] - v[i]);
  return out_;
}

}  // namespace manycontact::cli
