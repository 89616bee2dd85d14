#include "trajectory_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <unordered_map>

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

// A line of the file: its cells by the header's columns.
class Row {
 public:
  Row(const std::string& path, std::ifstream& stream) : path_(path), stream_(stream) {
    std::string line;
    if (!std::getline(stream_, line)) fail("cannot be read or is empty, expected the CSV of a trajectory");
    const std::vector<std::string> names = cells_of(line);
    for (std::size_t k = 0; k < names.size(); ++k) column_.emplace(names[k], k);
    count_ = names.size();
  }

  /// The next line; false at the end.
  bool next() {
    std::string line;
    if (!std::getline(stream_, line)) return false;
    ++line_;
    cells_ = cells_of(line);
    if (cells_.size() != count_)
      fail("has " + std::to_string(cells_.size()) + " cells, expected " + std::to_string(count_) + " as the header");
    return true;
  }

  bool has(const std::string& name) const { return column_.contains(name); }
  std::size_t column(const std::string& name) const {
    const auto found = column_.find(name);
    if (found == column_.end()) fail("there is no column " + quote(name) + ", expected the trajectory of this scene");
    return found->second;
  }
  bool is_empty(std::size_t column) const { return cells_[column].empty(); }
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
  const std::string& path_;
  std::ifstream& stream_;
  int line_ = 1;
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

// Per contact the columns of its force, none where the file has none.
std::vector<Columns> force_columns(const Row& row, const Scene& scene) {
  std::vector<Columns> out(scene.contacts.size());
  for (std::size_t c = 0; c < out.size(); ++c)
    for (int k = 0; k < scene.contacts[c].rows(); ++k) {
      const std::string name = "f:" + scene.contacts[c].name + "[" + std::to_string(k) + "]";
      if (!row.has(name)) break;
      out[c].push_back(row.column(name));
    }
  return out;
}

Eigen::VectorXd numbers(const Row& row, const Columns& list) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) out[static_cast<Eigen::Index>(k)] = row.number(list[k]);
  return out;
}

}  // namespace

void read_trajectory(const std::string& path, const Scene& scene, Recording& recording) {
  std::ifstream stream(path);
  Row row(path, stream);
  const std::size_t t = row.column("t");
  const Columns q = columns(row, "q:", configuration_names(scene)), v = columns(row, "v:", velocity_names(scene));
  const std::vector<Columns> f = force_columns(row, scene);
  const bool drift = row.has("drift_position") && row.has("drift_velocity");

  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  double last = -INFINITY;
  while (row.next()) {
    ViewState state{row.number(t), numbers(row, q), numbers(row, v), active};
    if (!(state.t > last)) row.fail("the time does not grow, expected rows in the order of their times");
    last = state.t;
    if (drift) state.drift.emplace(row.number(row.column("drift_position")), row.number(row.column("drift_velocity")));
    state.forces.emplace(f.size());
    for (std::size_t c = 0; c < f.size(); ++c) {
      if (static_cast<int>(f[c].size()) != scene.contacts[c].rows()) continue;
      state.active[c] = !row.is_empty(f[c][0]);
      if (state.active[c]) (*state.forces)[c] = numbers(row, f[c]);
    }
    add_state(state, recording);
  }
  if (last == -INFINITY) row.fail("has no states, expected a row for each");
}

}  // namespace manycontact::cli
