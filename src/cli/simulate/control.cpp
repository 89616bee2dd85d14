#include "control.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "manycontact/io/input_error.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::cli {

namespace {

// Cells of a line; quoted ones as RFC 4180 has them, but for line breaks.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (c == '"' && quoted && k + 1 < line.size() && line[k + 1] == '"')
      cells.back() += line[++k];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  return cells;
}

double number_in(const std::string& cell, const std::string& path, int line, const std::string& column) {
  double x = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(x))
    throw InputError(path, line, "column " + quote(column) + " holds " + quote(cell) + ", expected a number");
  return x;
}

}  // namespace

TimeTable::TimeTable(const std::string& path, const std::string& prefix, const std::vector<std::string>& names) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) throw InputError(path, 1, "cannot be read or is empty, expected a CSV file");
  const std::vector<std::string> titles = cells_of(line);
  if (titles[0] != "t") throw InputError(path, 1, "begins with the column " + quote(titles[0]) + ", expected t");
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < names.size(); ++i) index.emplace(names[i], static_cast<int>(i));
  std::vector<std::size_t> cell;  // of each column kept
  for (std::size_t k = 1; k < titles.size(); ++k) {
    if (titles[k].rfind(prefix, 0) != 0) continue;
    const std::string name = titles[k].substr(prefix.size());
    const auto found = index.find(name);
    if (found == index.end())
      throw InputError(path, 1, "column " + quote(titles[k]) + " is none of the scene's, " + suggestion(name, names));
    if (std::count(columns_.begin(), columns_.end(), found->second))
      throw InputError(path, 1, "column " + quote(titles[k]) + " stands twice, expected it once");
    columns_.push_back(found->second);
    cell.push_back(k);
  }
  for (int number = 2; std::getline(file, line); ++number) {
    if (line.empty() || line == "\r") continue;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != titles.size())
      throw InputError(path, number,
                       "has " + std::to_string(cells.size()) + " columns, expected " + std::to_string(titles.size()) +
                           " as in line 1");
    t_.push_back(number_in(cells[0], path, number, "t"));
    if (t_.size() > 1 && !(t_[t_.size() - 2] < t_.back()))
      throw InputError(path, number, "t does not grow, expected rows in the order of time");
    for (std::size_t k : cell) values_.push_back(number_in(cells[k], path, number, titles[k]));
  }
  if (t_.empty()) throw InputError(path, 1, "has no rows, expected at least one");
}

void TimeTable::at(double t, bool between, Eigen::VectorXd& x) const {
  // A step's time is a multiple of its size, and may miss a row's by rounding.
  const double late = t + 1e-9 * std::abs(t);
  const std::size_t after = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), late) - t_.begin());
  const std::size_t row = after == 0 ? 0 : after - 1, next = std::min(after, t_.size() - 1), n = columns_.size();
  const double share = between && next > row ? std::clamp((t - t_[row]) / (t_[next] - t_[row]), 0.0, 1.0) : 0;
  for (std::size_t k = 0; k < n; ++k)
    x[columns_[k]] = (1 - share) * values_[row * n + k] + share * values_[next * n + k];
}

void Control::read_torques(const std::string& path) {
  torques_.emplace(path, "u:", torque_names(file_.scene));
  if (torques_->empty()) throw InputError(path, 1, "has no column of torques, expected columns like u:robot/joint");
}

void Control::follow(double kp, double kd, const std::optional<std::string>& reference) {
  for (const Robot& robot : file_.scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (robot.model->torque_of(joint) >= 0 && joint.nv() > 1)
        throw InputError(
            file_.path, 1,
            "joint " + quote(robot.name + "/" + joint.name) + " has several coordinates, expected none such for --pd");
  kp_ = kp;
  kd_ = kd;
  follows_ = true;
  if (!reference) return;
  q_over_time_.emplace(*reference, "q:", configuration_names(file_.scene));
  v_over_time_.emplace(*reference, "v:", velocity_names(file_.scene));
  if (q_over_time_->empty())
    throw InputError(*reference, 1, "has no column of positions, expected columns like q:robot/joint");
}

const Eigen::VectorXd& Control::at(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  if (torques_) torques_->at(t, false, u_);
  out_ = u_;
  if (!follows_) return out_;
  if (q_over_time_) q_over_time_->at(t, true, q_);
  if (v_over_time_) v_over_time_->at(t, true, v_);
  for (const Robot& robot : file_.scene.robots)
    for (const Joint& joint : robot.model->joints) {
      const int k = robot.model->torque_of(joint);
      if (k < 0) continue;
      const int iq = robot.idx_q + joint.idx_q, iv = robot.idx_v + joint.idx_v;
      out_[robot.idx_u + k] += kp_ * (q_[iq] - q[iq]) + kd_ * (v_[iv] - v[iv]);
    }
  return out_;
}

}  // namespace manycontact::cli
