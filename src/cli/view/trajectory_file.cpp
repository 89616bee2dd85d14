#include "trajectory_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <unordered_map>

#include "manycontact/analysis/names.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::cli {

namespace {

// The cells of a line; quotes as RFC 4180 has them, but no line breaks inside.
std::vector<std::string> cells_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool twice = quoted && line.substr(i, 2) == "\"\"";
    if (twice)
      cells.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += line[i];
  }
  return cells;
}

// A CSV, line by line: cells by the header's columns.
class Row {
 public:
  explicit Row(const std::string& path) : path_(path), stream_(path) {
    std::string line;
    if (!std::getline(stream_, line)) fail("cannot be read or is empty, expected a CSV with a header");
    const std::vector<std::string> names = cells_of(line);
    for (std::size_t k = 0; k < names.size(); ++k) column_.emplace(names[k], k);
    count_ = names.size();
  }

  /// The next line; false at the end. Its t is above the last one's.
  bool next() {
    std::string line;
    if (!std::getline(stream_, line)) return false;
    ++line_;
    cells_ = cells_of(line);
    if (cells_.size() != count_)
      fail("has " + std::to_string(cells_.size()) + " cells, expected " + std::to_string(count_) + " as the header");
    const double t = number(column("t"));
    if (!(t > t_)) fail("the time does not grow, expected rows in the order of their times");
    t_ = t;
    return true;
  }
  double t() const { return t_; }

  bool has(const std::string& name) const { return column_.contains(name); }
  std::size_t column(const std::string& name) const {
    const auto found = column_.find(name);
    if (found == column_.end()) fail("there is no column " + quote(name) + ", expected the columns of this scene");
    return found->second;
  }
  double number(std::size_t column) const {
    const std::string& text = cells_[column];
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
      fail("cell " + std::to_string(column + 1) + " is " + quote(text) + ", expected a finite number");
    return x;
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(path_, line_, message); }

 private:
  std::string path_;
  std::ifstream stream_;
  int line_ = 1;
  double t_ = -INFINITY;
  std::unordered_map<std::string, std::size_t> column_;
  std::size_t count_ = 0;
  std::vector<std::string> cells_;
};

using Columns = std::vector<std::size_t>;

Columns columns(const Row& row, const std::string& prefix, const std::vector<std::string>& names) {
  Columns out;
  for (const std::string& name : names) out.push_back(row.column(prefix + name));
  return out;
}

Eigen::VectorXd numbers(const Row& row, const Columns& list) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) out[static_cast<Eigen::Index>(k)] = row.number(list[k]);
  return out;
}

// The forces of states, from a file of their own.
class Forces {
 public:
  Forces(const std::string& path, const Scene& scene) : row_(path) {
    for (const Contact& contact : scene.contacts) {
      std::vector<std::string> names;
      for (int k = 0; k < contact.rows(); ++k) names.push_back(row_name(contact, k));
      columns_.push_back(columns(row_, "f:", names));
    }
    more_ = row_.next();
  }

  /// Into a state, where the file has its time. States come in the order of theirs.
  void set(ViewState& state) {
    const double early = state.t - 1e-9 * std::abs(state.t);
    if (more_ && row_.t() < early) refuse();
    if (!more_ || row_.t() > 2 * state.t - early) return;
    state.forces.emplace();
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      state.forces->push_back(numbers(row_, columns_[c]));
      state.active[c] = !state.forces->back().isZero(0);
    }
    more_ = row_.next();
  }
  /// After the last state: no row may be left.
  void finish() const {
    if (more_) refuse();
  }

 private:
  [[noreturn]] void refuse() const {
    std::ostringstream t;
    t << std::setprecision(15) << row_.t();
    row_.fail("holds forces at t = " + t.str() + ", where the trajectory has no state, expected its times");
  }

  Row row_;
  std::vector<Columns> columns_;  // per contact
  bool more_ = false;
};

}  // namespace

void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording) {
  Row row(path);
  const Columns q = columns(row, "q:", configuration_names(scene)), v = columns(row, "v:", velocity_names(scene));
  const bool drift = row.has("drift_position") && row.has("drift_velocity");
  std::optional<Forces> forces_file;
  if (forces) forces_file.emplace(*forces, scene);

  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  while (row.next()) {
    ViewState state{row.t(), numbers(row, q), numbers(row, v), active};
    if (drift) state.drift.emplace(row.number(row.column("drift_position")), row.number(row.column("drift_velocity")));
    if (forces_file) forces_file->set(state);
    add_state(state, recording);
  }
  if (row.t() == -INFINITY) row.fail("has no states, expected a row for each");
  if (forces_file) forces_file->finish();
}

}  // namespace manycontact::cli
