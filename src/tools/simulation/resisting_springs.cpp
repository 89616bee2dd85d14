#include "resisting_springs.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "internal.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/solve_step.hpp"
#include "manycontact/dynamics/views.hpp"
#include "resisting_forces.hpp"
#include "spring_share.hpp"

namespace manycontact::internal {

namespace {

constexpr double kFelt = 1e-3;           // rows across a spring are left out if D J M^-1 J^T is below this
constexpr double kNothing = 1e-12;       // D of a row across a spring is raised until D J K^-1 J^T has this value
constexpr std::size_t kMostRows = 3000;  // most rows for which J K^-1 J^T is stored dense
constexpr double kMostZeros = 8;         // largest ratio of entries to nonzeros at which J K^-1 J^T is stored dense
constexpr int kFewNumbers = 32;          // fewer unit forces on an island are solved one by one
constexpr int kMostCoordinates = 2000;   // most velocities of an island for which K^-1 is computed as a matrix

// Returns J M^-1 J^T of the end's body alone. This is an upper bound, because joints and contacts only reduce it.
double mobility_of_end(const Scene& scene, const Attachment& at) {
  if (!moves(at)) return 0;
  const Inertia<double>& Y = scene.robots[at.robot].model->joints[at.joint].inertia;
  if (!(Y.m > 0)) return std::numeric_limits<double>::infinity();
  const Vec3<double> com = Y.h / Y.m;
  const Mat3<double> I = Y.seen_at(-com).I;
  const double least = I.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
  const double lever2 = (at.placement.p - com).squaredNorm();
  return 1 / Y.m + (lever2 == 0 ? 0 : least > 0 ? lever2 / least : std::numeric_limits<double>::infinity());
}

Scene without_springs(const Scene& scene) {
  Scene out = scene;
  out.springs.clear(), out.spring_index.clear();
  return out;
}

void follow_loads(const Scene& scene, Scene& loads) {
  for (std::size_t k = 0; k < scene.wrenches.size(); ++k) {
    loads.wrenches[k].at.placement = scene.wrenches[k].at.placement;
    loads.wrenches[k].reference_frame = scene.wrenches[k].reference_frame;
  }
  for (std::size_t k = 0; k < scene.joint_springs.size(); ++k) {
    loads.joint_springs[k].stiffness = scene.joint_springs[k].stiffness;
    loads.joint_springs[k].rest = scene.joint_springs[k].rest;
  }
  for (std::size_t r = 0; r < scene.robots.size(); ++r) loads.robots[r].base = scene.robots[r].base;
}

// Returns the acceleration of a spring's end relative to the robot's base, for zero joint accelerations.
Vec3<double> acceleration_of_end(const Scene& scene, const Attachment& at, const AppliedForces<double>& forces) {
  if (!moves(at)) return Vec3<double>::Zero();
  const Kinematics<double>& kin = forces.robots[forces.number[at.robot]].kin;
  const auto of = [&](int joint, const Vec3<double>& p) {
    const Vec6<double>&v = kin.v[joint], &a = kin.a[joint];
    const Vec3<double> w = v.tail<3>(), speed = v.head<3>() + w.cross(p);
    return Vec3<double>(a.head<3>() + Vec3<double>(a.tail<3>()).cross(p) + w.cross(speed));
  };
  const SE3<double>& M = kin.oMi[at.joint];
  const Vec3<double> end = of(at.joint, M.p + M.R * at.placement.p);
  return scene.robots[at.robot].model->floating_base ? Vec3<double>(end - of(0, kin.oMi[0].p))
                                                     : Vec3<double>(end - kin.a_base.head<3>());
}

// Returns the share (0 to 1) of the motion across a spring that rotates the spring without stretching it. With c the
// rate across the spring, s its length, T its tension and n its direction, a step h raises its energy by
//     h^2 T / (2 s) (c^2 + s n^T (p_A'' - p_B''))
double turning(const Scene& scene, const Spring& spring, const AppliedForces<double>::OfSpring& at,
               const AppliedForces<double>& forces, double h) {
  const Vec3<double> n = at.d / at.length, across = at.rate - n * n.dot(at.rate);
  const double bend =
      n.dot(acceleration_of_end(scene, spring.A, forces) - acceleration_of_end(scene, spring.B, forces));
  const double c2 = across.squaredNorm(), turn2 = h * h * c2 / (at.length * at.length);
  return c2 > 0 ? std::clamp(-at.length * bend / c2, 0.0, 1.0) / (1 + turn2 * turn2) : 0;
}

void add_rows(const Scene& scene, const Spring& spring, int number, const AppliedForces<double>& forces, double h,
              double mobility, ResistingSprings& s) {
  const AppliedForces<double>::OfSpring& at = forces.springs[number];
  const double k = spring.stiffness, D = h * h * k + h * spring.damping, e = at.length - spring.length;
  const Vec3<double> n = at.length > 0 ? Vec3<double>(at.d / at.length) : Vec3<double>(Vec3<double>::UnitX());
  if (D > 0) s.rows.push_back({number, n, D, h * k * e / D, k, e, -1, 0});
  if (!(k > 0)) return;
  const double across = spring.length == 0 ? k : k * e / at.length;
  const bool idle = !(across > 0) || (spring.length > 0 && !(h * h * across * mobility > kFelt));
  const double turns = !idle && at.length > 0 ? turning(scene, spring, at, forces, h) : 0;
  const Vec3<double> first = n.unitOrthogonal();
  for (const Vec3<double>& direction : {first, Vec3<double>(n.cross(first))})
    s.rows.push_back({number, direction, idle ? kIdle : h * h * across, 0, idle ? 0 : across, 0, turns,
                      spring.length == 0 ? 0 : at.length});
}

bool solved(Status status, SimulationData& d) {
  ++d.solves;
  d.worst = std::max(d.worst, status);
  return status != Status::kFailed;
}

bool solves(const Eigen::VectorXd& b, const Eigen::VectorXd& wanted, SimulationData& d) {
  const auto [rest, data] = at_rest_with_joints(d);
  return solved(solve_tau(rest, d.q, d.at_rest.zero, b, wanted, data).status, d);
}

// Solves K v+ = b in SIMD batches, which add M v and the bias to b, and returns whether that succeeded. If batches
// cannot solve, it returns nothing, and these terms are in b and d.tau instead.
std::optional<bool> solve_in_batches(Eigen::VectorXd& b, SimulationData& d) {
  if (!d.in_batches) return std::nullopt;
  d.next_contact_v.resize(d.wanted.size());
  const auto [rest, data] = at_rest_with_joints(d);
  const StartOfStep start{d.v.data(), d.stop.data(), d.at_rest.gravity, d.h, d.next_contact_v.data()};
  d.in_batches = solve_step(rest, d.q, b, d.wanted, start, data);
  if (d.in_batches) return solved(data.report.status, d);
  b -= d.tau;
  find_momentum(d);
  b += d.tau;
  return std::nullopt;
}

const Eigen::VectorXd& answer(SimulationData& d) { return at_rest_with_joints(d).data.a; }

// Sets the contacts' alpha to zero during its lifetime, so that placement errors do not affect unit-force responses.
class WithoutGains {
 public:
  WithoutGains(Scene& rest, std::vector<double>& gains) : rest_(rest), gains_(gains) {
    gains_.resize(rest.contacts.size());
    for (std::size_t c = 0; c < gains_.size(); ++c) gains_[c] = std::exchange(rest.contacts[c].alpha, 0);
  }
  ~WithoutGains() {
    for (std::size_t c = 0; c < gains_.size(); ++c) rest_.contacts[c].alpha = gains_[c];
  }
  WithoutGains(const WithoutGains&) = delete;
  WithoutGains& operator=(const WithoutGains&) = delete;

 private:
  Scene& rest_;
  std::vector<double>& gains_;
};

bool islands_fit(const SceneData& data) {
  for (std::size_t i = 0; i < island_count(data); ++i)
    if (solved_island(data, i).nv > kMostCoordinates) return false;
  return true;
}

// Computes K^-1 of every island with one panel. Returns null if that fails or one solve per unit force is cheaper.
const DerivativeData* find_inverse(SimulationData& d, const ResistingSprings& s) {
  const auto [rest, data] = at_rest_with_joints(d);
  if (s.numbers < kFewNumbers || !islands_fit(data)) return nullptr;
  ++d.solves;
  if (solve_tau(rest, d.q, d.at_rest.zero, d.at_rest.zero, data).status == Status::kFailed) return nullptr;
  DerivativeRequest by_torques;
  by_torques.q = by_torques.v = by_torques.forces = false, by_torques.tau = true;
  const DerivativeData& inverse = differentiate(rest, data, by_torques);
  for (const IslandDerivatives& of : inverse.islands)
    if (!of.X.allFinite()) return nullptr;
  return &inverse;
}

// Computes a = K^-1 b. `inverse` contains K^-1.
void multiply(const Scene& rest, const SceneData& data, const DerivativeData& inverse, const Eigen::VectorXd& b,
              Eigen::VectorXd& a) {
  a.setZero(b.size());
  for (std::size_t i = 0; i < inverse.islands.size(); ++i) {
    const std::vector<int>& robots = solved_island(data, i).robots;
    const auto X = inverse.islands[i].da_du();
    for (int by = 0, column = 0; const int r : robots) {
      const Robot& from = rest.robots[r];
      const auto own = b.segment(from.idx_v, from.model->nv);
      column = std::exchange(by, by + from.model->nv);
      if (own.isZero(0)) continue;
      for (int row = 0; const int other : robots) {
        const Robot& to = rest.robots[other];
        a.segment(to.idx_v, to.model->nv).noalias() += X.block(row, column, to.model->nv, own.size()) * own;
        row += to.model->nv;
      }
    }
  }
}

// Calls use(i, j, x) for the entries x of row i and column j of J K^-1 J^T, where j is the row of a unit force. Returns
// false if a solve failed.
template <class Use>
bool each_response(SimulationData& d, ResistingSprings& s, Use&& use) {
  const auto [rest, data] = at_rest_with_joints(d);
  const WithoutGains without(rest, s.gains);
  const DerivativeData* inverse = find_inverse(d, s);
  s.none.setZero(d.wanted.size());
  for (int number = 0; number < s.numbers; ++number) {
    std::ranges::fill(s.asked, -1);
    s.unit.clear();
    for (std::size_t k = 0; k < s.ends.size(); ++k)
      if (s.ends[k].number == number) {
        s.asked[s.ends[k].island] = static_cast<int>(k);
        s.unit.add(s.ends[k], 1);
      }
    s.b = s.unit.torques();
    if (inverse)
      multiply(rest, data, *inverse, s.b, s.by_unit);
    else if (!solves(s.b, s.none, d))
      return false;
    s.unit.look(inverse ? s.by_unit : answer(d));
    for (std::size_t k = 0; k < s.ends.size(); ++k)
      if (const int by = s.asked[s.ends[k].island]; by >= 0) use(s.row[k], s.row[by], s.unit.along(s.ends[k]));
  }
  return true;
}

// Computes J K^-1 J^T, in s.C if it is stored dense, otherwise in s.entries. Returns false if a solve failed.
bool find_responses(SimulationData& d, ResistingSprings& s) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  s.is_dense ? (void)s.C.setZero(n, n) : s.entries.clear();
  s.own.setZero(n);
  if (!each_response(d, s, [&](int i, int j, double x) {
        s.is_dense ? (void)(s.C(i, j) += x) : (void)s.entries.emplace_back(i, j, x);
        if (i == j) s.own[i] += x;
      }))
    return false;
  return true;
}

double rate_at_start(const SimulationData& d, const ResistingSprings::Row& row) {
  return row.direction.dot(d.applied->springs[row.spring].rate);
}

// Computes g of rows along springs. Springs do not resist the share row.keeps of the start velocity.
void keep_along(const SimulationData& d, ResistingSprings& s) {
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    ResistingSprings::Row& row = s.rows[i];
    if (is_across(row)) continue;
    const double stiff = d.h * d.h * row.k;
    row.keeps = spring_share(stiff * s.own[i]);
    row.g -= row.keeps * stiff / row.D * rate_at_start(d, row);
  }
}

// Computes D of rows across springs from the tension at the end of the step, which the rows along springs predict. A
// spring that relaxes within the step is not stiff across its direction.
void take_tensions(const SimulationData& d, ResistingSprings& s) {
  s.stretching = s.p;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    double& x = s.stretching[i];
    x = is_across(s.rows[i]) ? 0 : x - s.rows[i].g;
  }
  solve_rows(s, s.stretching);
  double pull = 0;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    ResistingSprings::Row& row = s.rows[i];
    if (!is_across(row)) pull = -s.stretching[i] / d.h;
    if (!is_across(row) || row.length == 0 || row.D == kIdle) continue;
    row.k = std::max(pull, 0.0) / row.length;
    row.D = std::max(d.h * d.h * row.k, kNothing / std::max(s.own[i], kNothing));
  }
}

// Computes g of rows across springs from the start velocity without its stretching part. Springs do not resist the
// share row.keeps of this velocity, nor the rotating share row.turns of the rest.
void keep_across(const SimulationData& d, ResistingSprings& s) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  s.rate.resize(n), s.stretching.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    s.rate[i] = rate_at_start(d, row);
    s.stretching[i] = is_across(row) ? 0 : s.rate[i];
  }
  solve_rows(s, s.stretching);
  if (s.is_dense)
    s.rate.noalias() -= s.C * s.stretching;
  else
    for (const auto& e : s.entries) s.rate[e.row()] -= e.value() * s.stretching[e.col()];
  for (Eigen::Index i = 0; i < n; ++i)
    if (ResistingSprings::Row& row = s.rows[i]; is_across(row)) {
      row.keeps = spring_share(row.D * s.own[i]);
      row.g = ((1 - row.turns) * (1 - row.keeps) - 1) * s.rate[i];
    }
}

// Finds D and g of rows across springs from the solution of the rows along springs.
bool find_across(const SimulationData& d, ResistingSprings& s) {
  if (std::ranges::none_of(s.rows, is_across)) return true;
  if (!factorize_rows(false, s)) return false;
  take_tensions(d, s);
  keep_across(d, s);
  return true;
}

// Returns whether J K^-1 J^T is stored dense, because it has few rows or enough nonzero entries.
bool is_dense(const ResistingSprings& s) {
  double responses = 0;
  for (const UnitForce& end : s.ends) responses += 2 * end.number + 1;
  const auto of_rows = static_cast<double>(s.ends.size());
  return s.rows.size() <= kFewRows || (s.rows.size() <= kMostRows && kMostZeros * responses >= of_rows * of_rows);
}

}  // namespace

ResistingSprings::ResistingSprings(const Scene& scene)
    : loads(without_springs(scene)), unit(scene), asked(scene.robots.size()) {
  if (has_applied_forces(loads)) of_loads = std::make_shared<AppliedForces<double>>(loads);
  for (const Spring& spring : scene.springs)
    mobility.push_back(mobility_of_end(scene, spring.A) + mobility_of_end(scene, spring.B));
}

void add_loads(const Scene& scene, SimulationData& d) {
  if (!d.applied) return;
  ResistingSprings* s = d.resisting && d.resisting->springs ? &*d.resisting->springs : nullptr;
  if (!s) return add_applied_forces<double>(scene, d.q.data(), d.v.data(), d.dynamics.wrenches, *d.applied, d.w.data());
  find_applied_wrenches<double>(scene, d.q.data(), d.v.data(), d.dynamics.wrenches, *d.applied);
  follow_loads(scene, s->loads);
  if (s->of_loads)
    add_applied_forces<double>(s->loads, d.q.data(), d.v.data(), d.dynamics.wrenches, *s->of_loads, d.w.data());
}

void take_springs(const Scene& scene, SimulationData& d) {
  ResistingSprings& s = *d.resisting->springs;
  s.rows.clear(), s.ends.clear(), s.row.clear();
  s.unit.find_islands(scene, d.dynamics.active);
  s.unit.begin_numbers();
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const AppliedForces<double>::OfSpring& at = d.applied->springs[k];
    for (const Attachment* end : {&scene.springs[k].A, &scene.springs[k].B})
      // a spring without a direction gives NaN torques, with which the solve fails
      if (const Robot* robot = moves(*end) ? &scene.robots[end->robot] : nullptr; robot && !at.directed)
        d.w.segment(robot->idx_v, robot->model->nv).setConstant(std::numeric_limits<double>::quiet_NaN());
    const auto first = static_cast<int>(s.rows.size());
    add_rows(scene, scene.springs[k], static_cast<int>(k), *d.applied, d.h, s.mobility[k], s);
    for (int i = first; i < static_cast<int>(s.rows.size()); ++i) {
      if (s.rows[i].D == kIdle) continue;
      s.unit.add_forces(static_cast<int>(k), s.rows[i].direction, s.ends);
      s.row.resize(s.ends.size(), i);
    }
  }
  s.numbers = s.unit.numbers();
  s.is_dense = is_dense(s);
  s.unit.place(scene, d.q);
}

bool solve_with_springs(Eigen::VectorXd& b, SimulationData& d) {
  if (const std::optional<bool> done = solve_in_batches(b, d)) return *done;
  ResistingSprings* s = d.resisting && d.resisting->springs ? &*d.resisting->springs : nullptr;
  if (!solves(b, d.wanted, d)) return false;
  if (!s) return true;
  s->without = answer(d), s->f_without = at_rest_with_joints(d).data.f;
  if (s->rows.empty()) return true;
  s->unit.look(s->without);
  const auto n = static_cast<Eigen::Index>(s->rows.size());
  s->p.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResistingSprings::Row& row = s->rows[i];
    s->p[i] = -s->unit.along(row.spring, row.direction, -1);
  }
  if (!find_responses(d, *s)) return false;
  keep_along(d, *s);
  if (!find_across(d, *s)) return false;
  for (Eigen::Index i = 0; i < n; ++i) s->p[i] -= s->rows[i].g;
  if (!factorize_rows(true, *s)) return false;
  solve_rows(*s, s->p);
  s->unit.clear();
  for (std::size_t k = 0; k < s->ends.size(); ++k) s->unit.add(s->ends[k], s->p[s->row[k]]);
  s->b = b + s->unit.torques();
  return solves(s->b, d.wanted, d);
}

void account_for_springs(const Scene& scene, SimulationData& d, const Eigen::VectorXd& v_next) {
  ResistingSprings& s = *d.resisting->springs;
  s.unit.look(v_next);
  s.given.resize(static_cast<Eigen::Index>(s.rows.size()));
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    const Spring& spring = scene.springs[row.spring];
    const double before = rate_at_start(d, row), after = s.unit.along(row.spring, row.direction, -1),
                 mean = (before + after) / 2, moved = d.h * after;
    const double k = is_across(row) ? row.k * (1 - row.turns) : row.k;  // the rotating part does not stretch it
    const double damper = is_across(row) ? 0 : -d.h * spring.damping * after;
    double& given = s.given[i];
    given = (s.p[i] - damper) * mean;
    d.work.dampers += damper * mean;
    d.work.springs += (1 - row.keeps) * (given + k * moved * (row.e + moved / 2));
  }
}

}  // namespace manycontact::internal
