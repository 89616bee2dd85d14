#include "stability/judge.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "manycontact/dynamics/solve.hpp"
#include "stability/derivatives.hpp"
#include "support/measure.hpp"

namespace manycontact::test {

namespace {

constexpr double kNoDigits = 1e-2;         // an error above this is a wrong solution whatever the condition
constexpr double kMostOfSingle = 1e-2;     // relative to the largest entry: single precision is refused beyond
constexpr double kVanishingForce = 1e-12;  // relative to their scale: smaller forces cancel

bool is_failed(const Report& report, std::size_t island) { return report_of(report, island).status == Status::kFailed; }

bool failed_islands_are_nan(const Truths& truths, const SceneData& data) {
  const auto is_nan = [](double x) { return std::isnan(x); };
  for (std::size_t i = 0; i < truths.islands.size(); ++i) {
    const IslandTruth& island = truths.islands[i];
    if (is_failed(data.report, i) &&
        !(data.a(island.v).unaryExpr(is_nan).all() && data.f(island.f).unaryExpr(is_nan).all()))
      return false;
  }
  return true;
}

bool any_in(Precision precision, const Report& report) {
  return std::ranges::any_of(report.islands, [=](const auto& i) { return i.precision == precision; });
}

Outcome outcome_of(const Report& report, const Way& way) {
  if (report.status != Status::kFailed && !any_in(way.options.precision, report)) return Outcome::kInDouble;
  switch (report.status) {
    case Status::kRedundant:
      return Outcome::kRedundant;
    case Status::kInconsistent:
      return Outcome::kInconsistent;
    case Status::kRegularised:
      return Outcome::kRegularised;
    case Status::kFailed:
      return Outcome::kRefused;
    case Status::kOk:
      break;
  }
  bool other = false, reordered = false;
  int steps = 0;
  for (const IslandReport& island : report.islands) {
    other |= way.options.method == Method::kAuto ? island.reason != Reason::kNone && !island.changed_order
                                                 : island.method != way.options.method;
    reordered |= island.changed_order;
    steps = std::max(steps, island.refinement_steps);
  }
  return other ? Outcome::kFallback : reordered ? Outcome::kReordered : steps > 1 ? Outcome::kRefined : Outcome::kExact;
}

std::string describe(const Report& report) {
  std::ostringstream out;
  out << to_string(report.status);
  for (const IslandReport& island : report.islands)
    out << " [" << to_string(island.method) << ", " << to_string(island.reason) << ", rank " << island.rank << "/"
        << island.nc << ", nv " << island.nv << ", residuals " << island.residual_dynamics << " "
        << island.residual_contact << "]";
  return out.str();
}

// Rounding errors of vanishing forces are measured relative to forces that could balance tau_b.
double vanishing_force_scale(const Truths& truths) {
  const double scale = truths.J_size > 0 ? size_of(truths.tau_b) / truths.J_size : 0;
  return size_of(truths.f) < kVanishingForce * scale ? scale : 0;
}

double relative(double difference, double size) { return difference == 0 ? 0 : difference / size; }

// Relative errors in the maximum norm of the worst robot, and the largest relative to the allowed one.
struct ValueErrors {
  double a = 0, f = 0, excess = 0;
};
ValueErrors value_errors(const Truths& truths, const SceneData& data) {
  ValueErrors out;
  const double vanishing = vanishing_force_scale(truths);
  for (const RobotPlaces& at : truths.robots) {
    if (is_failed(data.report, at.island)) continue;
    const VecX<Quad> a = truths.a(at.v), f = truths.f(at.f);
    const double free = truths.a_free.size() > 0 ? size_of(truths.a_free(at.v)) : 0;
    const double ea = relative(difference_of(data.a(at.v), a), worse(size_of(a), free));
    const double ef = relative(difference_of(data.f(at.f), f), vanishing > 0 ? vanishing : size_of(f));
    out.a = worse(out.a, ea);
    out.f = worse(out.f, ef);
    const bool single = report_of(data.report, at.island).precision == Precision::kSingle;
    out.excess = worse(out.excess, worse(ea, ef) / std::max(single ? kMostOfSingle : 0,
                                                            allowed(condition_of(truths, data.report, at.island))));
  }
  return out;
}

// Whether regularised islands have a valid reason: the damped K is too ill-conditioned, or error bounds are 1 or more.
bool regularised_for_a_reason(const Truths& truths, const Report& report) {
  for (std::size_t i = 0; i < truths.islands.size(); ++i) {
    const IslandReport& island = report_of(report, i);
    if (island.status != Status::kRegularised) continue;
    if (island.reason == Reason::kUncertain && std::max(island.error_acceleration, island.error_forces) >= 1) continue;
    if (island.reason != Reason::kDampingLost || !(allowed(truths.islands[i].damped_condition.product()) >= 1))
      return false;
  }
  return true;
}

// Whether the status is right on dependency and consistency of the contacts. Either status is right close to a
// threshold; with damping K is regular and every status is ok, unless the damping is lost.
bool well_labelled(const Problem& p, const Truths& truths, const Report& report) {
  if (report.status == Status::kRegularised) return regularised_for_a_reason(truths, report);
  if (p.scene.damping > 0 || truths.contradiction < 0) return true;
  if (report.status == Status::kOk) return truths.rank == truths.rows;
  if (truths.rank == truths.rows) return false;
  const bool nothing = truths.contradiction_over_gravity <= 1e-10;
  return report.status == Status::kInconsistent ? !nothing && truths.contradiction > 1e-10
                                                : nothing || truths.contradiction < 1e-6;
}

// Returns the error relative to the known solution, in its units, in which the numbers have similar sizes.
double known_error(const KnownAnswer& known, const SceneData& data) {
  const Eigen::VectorXd a = data.a.cwiseQuotient(known.a_unit), f = data.f.cwiseQuotient(known.f_unit);
  const double ea = error_of(a, known.a), ef = f.size() > 0 ? error_of(f, known.f) : 0;
  return ea >= ef ? ea : ef >= ea ? ef : std::nan("");
}

// Returns true errors divided by their bounds, the largest over islands, accelerations and forces; zero if both vanish,
// and if the truth does not have q's last digits.
double beyond_bound(const Problem& p, const Truths& truths, SceneData& data) {
  estimate_errors(p.scene, data);
  if (p.only_known) return 0;
  double worst = 0;
  const auto add = [&](const VecX<Quad>& truth, const Eigen::VectorXd& mine, double bound) {
    const double difference = difference_of(mine, truth), size = size_of(mine);
    if (std::isinf(bound)) return;  // a zero solution, relative to itself
    if (difference > 0 && !(difference <= worst * bound * size)) worst = difference / (bound * size);
  };
  for (const IslandReport& report : data.report.islands) {
    if (report.status == Status::kFailed) continue;
    std::vector<int> v, f;
    for (std::size_t i = 0; i < truths.islands.size(); ++i) {
      if (&report_of(data.report, i) != &report) continue;
      v.insert(v.end(), truths.islands[i].v.begin(), truths.islands[i].v.end());
      f.insert(f.end(), truths.islands[i].f.begin(), truths.islands[i].f.end());
    }
    add(truths.a(v), data.a(v), report.error_acceleration);
    if (!f.empty()) add(truths.f(f), data.f(f), report.error_forces);
  }
  return worst;
}

}  // namespace

std::string classes(const std::string& letters) {
  std::string out = letters;
  for (char& c : out)
    if (c == 'e' || c == 'r' || c == 'o' || c == 'f') c = 'a';
  return out;
}

bool agree(const std::string& classes, const std::string& others) {
  const std::string answers = "aDIGd";
  return std::ranges::equal(classes, others, [&](char a, char b) {
    return a == b || ((a == 'd' || b == 'd') && answers.find(a) < answers.size() && answers.find(b) < answers.size());
  });
}

std::string Row::letters() const {
  std::string out;
  for (std::size_t k = 0; k < table_ways().size(); ++k) out += letter(cells[k].outcome);
  return out;
}

const std::vector<Way>& table_ways() {
  static const std::vector<Way> all = [] {
    std::vector<Way> out = ways(true);
    for (Precision precision : kPrecisions) {
      if (precision == Precision::kDouble) continue;
      out.push_back({"auto in " + to_string(precision), {}});
      out.back().options.precision = precision;
    }
    return out;
  }();
  return all;
}

const std::vector<Way>& judged_ways() {
  static const std::vector<Way> all = [] {
    std::vector<Way> out = table_ways();
    const std::vector<Way> here = ways_here(true);
    out.insert(out.end(), here.begin() + static_cast<std::ptrdiff_t>(ways(true).size()), here.end());
    return out;
  }();
  return all;
}

Cell judge_answer(const Problem& p, const Truths& truths, SceneData& data, const Way& way) {
  Cell cell;
  cell.answered = data.report.status != Status::kFailed;
  cell.outcome = outcome_of(data.report, way);
  cell.note = describe(data.report);
  const auto wrong = [&cell](const std::string& why) {
    cell.outcome = Outcome::kWrong;
    cell.note += ", " + why;
  };
  if (!failed_islands_are_nan(truths, data)) wrong("failed, with numbers");
  const std::vector<IslandReport>& islands = data.report.islands;
  if (std::all_of(islands.begin(), islands.end(), [](const auto& i) { return i.status == Status::kFailed; }))
    return cell;
  if (!truths.exists) {
    cell.error_a = cell.error_f = std::nan("");
    wrong("numbers where there are none");
    return cell;
  }
  for (std::size_t i = 0; i < truths.islands.size(); ++i) {
    cell.condition = worse(cell.condition, condition_of(truths, data.report, i));
    cell.allowed = worse(cell.allowed, allowed(condition_of(truths, data.report, i)));
  }
  const bool single = any_in(Precision::kSingle, data.report);  // derivatives are as accurate as a and f
  if (single) cell.allowed = worse(cell.allowed, kMostOfSingle);
  const ValueErrors e = value_errors(truths, data);
  cell.error_a = e.a;
  cell.error_f = e.f;
  cell.beyond_bound = beyond_bound(p, truths, data);
  if (any_in(Precision::kExtended, data.report) && (p.only_known || cell.condition > kTrueCondition))
    cell.beyond_bound = 0;  // the truth is no more accurate
  const DirectionErrors d = single ? DirectionErrors{} : direction_errors(p, truths, data);
  cell.error_d = d.largest;
  if (!(e.excess <= 1 && e.a <= kNoDigits && e.f <= kNoDigits)) wrong("values");
  if (!(d.excess <= 1)) wrong("derivatives");
  if (p.known && !p.only_known && !(known_error(*p.known, data) <= cell.allowed)) wrong("in known units");
  if (cell.answered && cell.outcome != Outcome::kWrong && !well_labelled(p, truths, data.report))
    cell.outcome = Outcome::kMislabelled;
  return cell;
}

Row judge(const Case& which) {
  Row row;
  row.which = &which;
  row.cells.resize(judged_ways().size());
  Problem p;
  try {
    p = which.make();
  } catch (const std::invalid_argument& e) {
    if (!which.bad_input) throw;
    for (Cell& cell : row.cells) cell.outcome = Outcome::kRefused, cell.note = e.what();
    return row;
  }
  const Truths truths(p);
  std::optional<Truths> undamped;  // if a solution claims to be without damping
  row.truth = truths.exists;
  row.derivatives = !truths.directions.empty();
  for (std::size_t k = 0; k < row.cells.size(); ++k) {
    const Way& way = judged_ways()[k];
    if (!which.small && (way.options.order || way.options.method == Method::kDense)) continue;
    try {
      SceneData data(p.scene, way.options);
      (void)solve(p.scene, p.q, p.v, p.u, data);
      const bool regularised = std::any_of(data.report.islands.begin(), data.report.islands.end(),
                                           [](const auto& i) { return i.reason == Reason::kDampingLost; });
      if (regularised && !undamped) undamped.emplace(without_damping(p));
      row.cells[k] = judge_answer(p, regularised ? claimed(truths, *undamped, data.report) : truths, data, way);
    } catch (const std::exception& e) {
      row.cells[k].outcome = Outcome::kWrong;
      row.cells[k].note = std::string("throws: ") + e.what();
    }
  }
  return row;
}

}  // namespace manycontact::test
