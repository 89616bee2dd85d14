#include <cmath>
#include <iomanip>
#include <sstream>

#include "../files/csv_read.hpp"
#include "manycontact/analysis/names.hpp"
#include "manycontact/model/expect_state.hpp"
#include "view.hpp"

namespace manycontact::cli {

namespace {

constexpr double kUnitLength = 1e-3;  // permitted error of a quaternion's norm; tables may have few digits

using Columns = std::vector<std::size_t>;

Columns columns(const CsvReader& row, const std::string& prefix, const std::vector<std::string>& names) {
  Columns out;
  for (const std::string& name : names) out.push_back(row.column(prefix + name));
  return out;
}

Eigen::VectorXd numbers(const CsvReader& row, const Columns& list) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) out[k] = row.number(list[k]);
  return out;
}

class Forces {  // reads the forces of states from a separate file
 public:
  Forces(const std::string& path, const Scene& scene) : row_(path) {
    for (const Contact& contact : scene.contacts) {
      std::vector<std::string> names;
      for (int k = 0; k < contact.rows(); ++k) names.push_back(row_name(contact, k));
      columns_.push_back(columns(row_, "f:", names));
    }
    more_ = row_.next();
  }

  /// Sets the forces of a state if the file has a row at the state's time. States must be given in the order of time.
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
  void finish() const {  // throws InputError if rows after the last state remain
    if (more_) refuse();
  }

 private:
  [[noreturn]] void refuse() const {
    std::ostringstream t;
    t << std::setprecision(15) << row_.t();
    row_.fail("contains forces at t = " + t.str() + ", where the trajectory has no state, expected a time of a state");
  }

  CsvReader row_;
  std::vector<Columns> columns_;  // one entry per contact
  bool more_ = false;
};

}  // namespace

void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording) {
  CsvReader row(path);
  const Columns q = columns(row, "q:", configuration_names(scene)), v = columns(row, "v:", velocity_names(scene));
  const bool drift = row.has("violation_position") && row.has("violation_velocity");
  std::optional<Forces> forces_file;
  if (forces) forces_file.emplace(*forces, scene);

  const std::vector<char> active = recording.dynamics.active;  // flags of the contacts that are active in the scene
  while (row.next()) {
    ViewState state{row.t(), numbers(row, q), numbers(row, v), active};
    if (const std::string why = unusable_configuration("q", state.q, scene, kUnitLength); !why.empty()) row.fail(why);
    if (drift)
      state.drift.emplace(row.number(row.column("violation_position")), row.number(row.column("violation_velocity")));
    if (forces_file) forces_file->set(state);
    add_state(state, recording);
  }
  if (row.t() == -INFINITY) row.fail("has no states, expected at least one row");
  if (forces_file) forces_file->finish();
}

}  // namespace manycontact::cli
