#include "stability/judge.hpp"

#include <cmath>
#include <sstream>

#include "support/measure.hpp"
#include "support/terms.hpp"

namespace manycontact::test {

namespace {

constexpr int kDenseTruth = 75;        // velocity coordinates up to which the truth is solved densely
constexpr int kDenseIfSingular = 110;  // unknowns up to which it is where refinement does not end
constexpr double kNoDigits = 1e-2;     // an error above this is a wrong answer whatever the condition
constexpr double kVanishing = 1e-12;   // of their scale: accelerations and forces that balance to nothing

template <class D>
bool finite(const Eigen::MatrixBase<D>& x) {
  for (Eigen::Index k = 0; k < x.size(); ++k)
    if (!std::isfinite(static_cast<double>(x[k]))) return false;
  return true;
}

std::vector<char> active(const Scene& scene) {
  std::vector<char> out;
  for (const Contact& c : scene.contacts) out.push_back(c.active);
  return out;
}

Truth<Quad> truth_of(const Problem& p) {
  const VecX<Quad> q = p.q.cast<Quad>(), v = p.v.cast<Quad>(), u = p.u.cast<Quad>();
  if (p.scene.nv <= kDenseTruth) return solve_truth<Quad>(p.scene, active(p.scene), q, v, u);
  SceneData data(p.scene, {Method::kSparseLdl, {}});
  (void)solve(p.scene, p.q, p.v, p.u, data);
  return refine_truth<Quad>(p.scene, data, q, v, u, kDenseIfSingular);
}

bool failed_islands_are_nan(const Scene& scene, const SceneData& data) {
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    if (data.report.islands[i].status != Status::kFailed) continue;
    for (int r : data.islands[i].island.robots)
      for (int k = 0; k < scene.robots[r].model->nv; ++k)
        if (!std::isnan(data.a[scene.robots[r].idx_v + k])) return false;
    for (int c : data.islands[i].island.contacts)
      for (int k = 0; k < scene.contacts[c].rows(); ++k)
        if (!std::isnan(data.f[data.f_offset[c] + k])) return false;
  }
  return true;
}

Outcome outcome_of(const Report& report, const Way& way) {
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
        << island.nc << ", nv " << island.nv << ", cond " << island.condition << ", residuals "
        << island.residual_dynamics << " " << island.residual_contact << "]";
  return out.str();
}

// Forces that vanish have no size of their own to measure rounding by: then that of forces which could hold tau_b.
double vanishing_force_scale(const Truths& truths, const SceneData& data) {
  double J = 0;
  for (std::size_t c = 0; c < data.contacts.size(); ++c)
    if (data.f_offset[c] >= 0) J = std::max(J, size_of(data.contacts[c].J));
  const double scale = J > 0 ? size_of(truths.tau_b) / J : 0;
  return size_of(truths.f) < kVanishing * scale ? scale : 0;
}

// Whether the status says what the contacts are: dependent or not, at odds or not. What is close to a threshold may be
// called either; with damping, K is regular and everything is ok.
bool well_labelled(const Problem& p, const Truths& truths, Status status) {
  if (p.scene.damping > 0 || truths.contradiction < 0) return true;
  if (status == Status::kOk) return truths.rank == truths.rows;
  if (truths.rank == truths.rows) return false;
  const bool nothing = truths.contradiction_over_gravity <= 1e-10;
  return status == Status::kInconsistent ? !nothing && truths.contradiction > 1e-10
                                         : nothing || truths.contradiction < 1e-6;
}

// Against the answer known in other units, as there: the numbers are of one size again.
double known_error(const KnownAnswer& known, const SceneData& data) {
  const Eigen::VectorXd a = data.a.cwiseQuotient(known.a_unit), f = data.f.cwiseQuotient(known.f_unit);
  const double ea = error_of(a, known.a), ef = f.size() > 0 ? error_of(f, known.f) : 0;
  return ea >= ef ? ea : ef >= ea ? ef : std::nan("");
}

// True errors over their bounds: of the islands' accelerations, then forces. Zero where both vanish.
double beyond_bound(const Problem& p, const Truths& truths, SceneData& data) {
  estimate_errors(p.scene, data);
  double worst = 0;
  const auto add = [&](const VecX<Quad>& truth, const Eigen::VectorXd& mine, double bound) {
    const double difference = difference_of(mine, truth), size = size_of(mine);
    if (std::isinf(bound)) return;  // of an answer that is zero, relative to itself
    if (difference > 0 && !(difference <= worst * bound * size)) worst = difference / (bound * size);
  };
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const Island& island = data.islands[i].island;
    std::vector<int> v, f;
    for (int r : island.robots)
      for (int k = 0; k < p.scene.robots[r].model->nv; ++k) v.push_back(p.scene.robots[r].idx_v + k);
    for (int c : island.contacts)
      for (int k = 0; k < p.scene.contacts[c].rows(); ++k) f.push_back(data.f_offset[c] + k);
    add(truths.a(v), data.a(v), data.report.islands[i].error_acceleration);
    if (!f.empty()) add(truths.f(f), data.f(f), data.report.islands[i].error_forces);
  }
  return worst;
}

}  // namespace

std::string classes(const std::string& letters) {
  std::string out = letters;
  for (char& c : out)
    if (c == 'r' || c == 'o' || c == 'f') c = 'e';
  return out;
}

std::string Row::letters() const {
  std::string out;
  for (const Cell& cell : cells) out += letter(cell.outcome);
  return out;
}

const std::vector<Way>& table_ways() {
  static const std::vector<Way> all = ways(true);
  return all;
}

Truths::Truths(const Problem& p) {
  Truth<Quad> truth = truth_of(p);
  if (p.only_known) truth.a = p.known->a, truth.f = p.known->f;
  exists = p.answerable && finite(truth.a) && finite(truth.f);
  for (bool regular : truth.regular) exists = exists && regular;
  a = truth.a;
  f = truth.f;
  if (!exists) return;
  const Eigen::VectorXd without = free_accelerations(p.scene, p.q, p.v, p.u);
  if (finite(without) && (size_of(p.v) == 0 || size_of(a) < kVanishing * size_of(without))) a_free = without;
  for (int r : truth.rank) rank += r;
  rows = static_cast<int>(f.size());
  if (p.scene.nv <= kDenseIfSingular && rows > 0 && !p.only_known) {
    const Terms terms(p.scene, active(p.scene), p.q, p.v, p.u);
    const Eigen::VectorXd a_true = a.template cast<double>();
    const double left = size_of(terms.J * a_true + terms.a0);
    const double size = size_of(terms.J.cwiseAbs() * a_true.cwiseAbs()) + size_of(terms.a0);
    contradiction = left == 0 ? 0 : left / size;
    contradiction_over_gravity = left == 0 ? 0 : left / std::max(size, p.scene.gravity.norm());
  }
  tau_b = -truth.h.template cast<double>();
  for (const Robot& r : p.scene.robots)
    tau_b.segment(r.idx_v + r.model->first_actuated(), r.model->nu()) += p.u.segment(r.idx_u, r.model->nu());
}

Cell judge_answer(const Problem& p, const Truths& truths, SceneData& data, const Way& way) {
  Cell cell;
  cell.answered = data.report.status != Status::kFailed && data.report.status != Status::kRegularised;
  cell.outcome = outcome_of(data.report, way);
  if (!cell.answered) {
    cell.note = describe(data.report);
    if (!failed_islands_are_nan(p.scene, data)) cell.outcome = Outcome::kWrong;
    return cell;
  }
  const std::vector<double> condition = conditions(p.scene, data);
  cell.note = describe(data.report);
  cell.allowed = allowed(data.report.condition);
  cell.error_a = cell.error_f = std::nan("");
  if (truths.exists) {
    cell.beyond_bound = beyond_bound(p, truths, data);
    const Errors e = errors<Quad>(p.scene, data, truths.a, truths.f, condition, truths.a_free);
    cell.error_a = e.acceleration;
    cell.error_f = e.forces;
    double excess = e.excess;
    if (const double scale = vanishing_force_scale(truths, data); scale > 0) {
      cell.error_f = difference_of(data.f, truths.f) / scale;
      excess = std::max(cell.error_a, cell.error_f) / cell.allowed;
    }
    if (!(excess <= 1 && cell.error_a <= kNoDigits && cell.error_f <= kNoDigits))
      cell.outcome = Outcome::kWrong;
    else if (!well_labelled(p, truths, data.report.status))
      cell.outcome = Outcome::kMislabelled;
    if (p.known && !p.only_known && !(known_error(*p.known, data) <= cell.allowed)) {
      cell.outcome = Outcome::kWrong;
      cell.note += ", in known units off by " + std::to_string(known_error(*p.known, data));
    }
  } else {
    cell.outcome = Outcome::kWrong;
  }
  return cell;
}

Row judge(const Case& which) {
  Row row;
  row.which = &which;
  row.cells.resize(table_ways().size());
  Problem p;
  try {
    p = which.make();
  } catch (const std::invalid_argument& e) {
    if (!which.bad_input) throw;
    for (Cell& cell : row.cells) cell.outcome = Outcome::kRefused, cell.note = e.what();
    return row;
  }
  const Truths truths(p);
  row.truth = truths.exists;
  for (std::size_t k = 0; k < row.cells.size(); ++k) {
    const Way& way = table_ways()[k];
    if (!which.small && (way.options.order || way.options.method == Method::kDense)) continue;
    try {
      SceneData data(p.scene, way.options);
      (void)solve(p.scene, p.q, p.v, p.u, data);
      row.cells[k] = judge_answer(p, truths, data, way);
    } catch (const std::exception& e) {
      row.cells[k].outcome = Outcome::kWrong;
      row.cells[k].note = std::string("throws: ") + e.what();
    }
  }
  return row;
}

}  // namespace manycontact::test
