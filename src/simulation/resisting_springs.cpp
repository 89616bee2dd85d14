#include "resisting_springs.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "internal.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

constexpr double kFelt = 1e-3;       // D J M^-1 J^T below which a row across a spring changes nothing to speak of
constexpr double kNothing = 1e-12;   // of that, for a row that does nothing
constexpr double kIdle = 1e-300;      // D of a row that is left out
constexpr Eigen::Index kFewRows = 64;  // for a dense factor

// J M^-1 J^T of a body alone, at most; what it is joined to makes it less.
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
  for (std::size_t k = 0; k < scene.pushes.size(); ++k) {
    loads.pushes[k].at.placement = scene.pushes[k].at.placement;
    loads.pushes[k].reference_frame = scene.pushes[k].reference_frame;
  }
  for (std::size_t k = 0; k < scene.joint_springs.size(); ++k) {
    loads.joint_springs[k].stiffness = scene.joint_springs[k].stiffness;
    loads.joint_springs[k].rest = scene.joint_springs[k].rest;
  }
  for (std::size_t r = 0; r < scene.robots.size(); ++r) loads.robots[r].base = scene.robots[r].base;
}

// How a spring's end accelerates while its robot's joints and its base, seen from the world, go on as they do.
Vec3<double> acceleration_of_end(const Scene& scene, const Attachment& at, const AppliedForces<double>& forces) {
  if (!moves(at)) return Vec3<double>::Zero();
  const Kinematics<double>& kin = forces.robots[static_cast<std::size_t>(forces.number[at.robot])].kin;
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

// How much of what a spring's ends do across it is a turn that does not stretch it, 0 ... 1: with c the rate across it,
// T / s (c^2 + s n^T (p_A'' - p_B'')) is what its energy rises by, twice over h^2.
double turning(const Scene& scene, const Spring& spring, const AppliedForces<double>::OfSpring& at,
               const AppliedForces<double>& forces, double h) {
  const Vec3<double> n = at.d / at.length, across = at.rate - n * n.dot(at.rate);
  const double bend = n.dot(acceleration_of_end(scene, spring.A, forces) - acceleration_of_end(scene, spring.B, forces));
  const double c2 = across.squaredNorm(), turn2 = h * h * c2 / (at.length * at.length);
  return c2 > 0 ? std::clamp(-at.length * bend / c2, 0.0, 1.0) / (1 + turn2 * turn2) : 0;
}

void add_rows(const Scene& scene, const Spring& spring, int number, const AppliedForces<double>& forces, double h, double mobility,
              ResistingSprings& s) {
  const AppliedForces<double>::OfSpring& at = forces.springs[static_cast<std::size_t>(number)];
  const double k = spring.stiffness, D = h * h * k + h * spring.damping, e = at.length - spring.length;
  const Vec3<double> n = at.length > 0 ? Vec3<double>(at.d / at.length) : Vec3<double>(Vec3<double>::UnitX());
  if (D > 0) s.rows.push_back({number, n, D, h * k * e / D, k, e, -1, 0});
  if (!(k > 0)) return;
  const double across = spring.length == 0 ? k : k * e / at.length;
  const bool idle = !(across > 0) || (spring.length > 0 && !(h * h * across * mobility > kFelt));
  const double keeps = !idle && at.length > 0 ? turning(scene, spring, at, forces, h) : 0;
  const Vec3<double> first = n.unitOrthogonal();
  for (const Vec3<double>& direction : {first, Vec3<double>(n.cross(first))})
    s.rows.push_back({number, direction, idle ? kIdle : h * h * across, 0, idle ? 0 : across, 0, keeps,
                      spring.length == 0 ? 0 : at.length});
}

bool solves(const Eigen::VectorXd& b, const Eigen::VectorXd& wanted, SimulationData& d) {
  const auto [rest, data] = at_rest_with_joints(d);
  const Status status = solve_tau(rest, d.q, d.at_rest.zero, b, wanted, data).status;
  d.worst = std::max(d.worst, status);
  return status != Status::kFailed;
}

const Eigen::VectorXd& answer(SimulationData& d) { return at_rest_with_joints(d).data.a; }

// use(row, of which row's force, J K^-1 J^T); false when a solve failed.
template <class Use>
bool each_response(SimulationData& d, ResistingSprings& s, Use&& use) {
  s.none.setZero(d.wanted.size());
  for (int number = 0; number < s.numbers; ++number) {
    std::fill(s.asked.begin(), s.asked.end(), -1);
    s.unit.clear();
    for (std::size_t k = 0; k < s.ends.size(); ++k)
      if (s.ends[k].number == number) {
        s.asked[static_cast<std::size_t>(s.ends[k].island)] = static_cast<int>(k);
        s.unit.add(s.ends[k], 1);
      }
    s.b = s.unit.torques();
    if (!solves(s.b, s.none, d)) return false;
    s.unit.look(answer(d));
    for (std::size_t k = 0; k < s.ends.size(); ++k)
      if (const int by = s.asked[static_cast<std::size_t>(s.ends[k].island)]; by >= 0)
        use(s.row[k], s.row[static_cast<std::size_t>(by)], s.unit.along(s.ends[k]));
  }
  return true;
}

bool is_across(const ResistingSprings::Row& row) { return row.keeps >= 0; }

// J K^-1 J^T into C, or into entries where there are many rows.
bool find_responses(SimulationData& d, ResistingSprings& s) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  const bool few = n <= kFewRows;
  few ? (void)s.C.setZero(n, n) : s.entries.clear();
  s.own.setZero(n);
  if (!each_response(d, s, [&](int i, int j, double x) {
        few ? (void)(s.C(i, j) += x) : (void)s.entries.emplace_back(i, j, x);
        if (i == j) s.own[i] += x;
      }))
    return false;
  for (Eigen::Index i = 0; i < n; ++i)
    if (const ResistingSprings::Row& row = s.rows[static_cast<std::size_t>(i)]; !is_across(row))
      s.fast[static_cast<std::size_t>(row.spring)] = d.h * d.h * row.k * s.own[i];
  return true;
}

// x of (D^-1 + J K^-1 J^T) x = x, of the rows along springs or of all.
bool solve_rows(bool all, ResistingSprings& s, Eigen::VectorXd& x) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  const auto has = [&](Eigen::Index i) { return all || !is_across(s.rows[static_cast<std::size_t>(i)]); };
  const auto own = [&](Eigen::Index i) { return 1 / s.rows[static_cast<std::size_t>(i)].D; };
  if (n <= kFewRows) {
    s.with_D = s.C;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!has(i)) s.with_D.row(i).setZero(), s.with_D.col(i).setZero();
      s.with_D(i, i) += own(i);
    }
    s.factor.compute(s.with_D);
    s.factor.solveInPlace(x);
    return true;
  }
  s.own_entries.clear();
  for (const auto& e : s.entries)
    if (has(e.row()) && has(e.col())) s.own_entries.push_back(e);
  for (Eigen::Index i = 0; i < n; ++i) s.own_entries.emplace_back(static_cast<int>(i), static_cast<int>(i), own(i));
  s.S.resize(n, n);
  s.S.setFromTriplets(s.own_entries.begin(), s.own_entries.end());
  s.sparse_factor.compute(s.S);
  if (s.sparse_factor.info() != Eigen::Success) return false;
  x = s.sparse_factor.solve(x).eval();
  return true;
}

// D across springs by what they pull with at the end of the step, as far as it is known by the rows along them: a spring
// that a step relaxes is not stiff across itself.
bool take_tensions(const SimulationData& d, ResistingSprings& s) {
  if (std::none_of(s.rows.begin(), s.rows.end(), is_across)) return true;
  s.stretching = s.p;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    double& x = s.stretching[static_cast<Eigen::Index>(i)];
    x = is_across(s.rows[i]) ? 0 : x - s.rows[i].g;
  }
  if (!solve_rows(false, s, s.stretching)) return false;
  double pull = 0;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    ResistingSprings::Row& row = s.rows[i];
    if (!is_across(row)) pull = -s.stretching[static_cast<Eigen::Index>(i)] / d.h;
    if (!is_across(row) || row.length == 0 || row.D == kIdle) continue;
    row.k = std::max(pull, 0.0) / row.length;
    row.D = std::max(d.h * d.h * row.k, kNothing / std::max(s.own[static_cast<Eigen::Index>(i)], kNothing));
  }
  return true;
}

// g across springs: J of the velocity at the start less what stretches springs.
bool keep_turning(const SimulationData& d, ResistingSprings& s) {
  const auto n = static_cast<Eigen::Index>(s.rows.size());
  if (std::none_of(s.rows.begin(), s.rows.end(), is_across)) return true;
  s.rate.resize(n), s.stretching.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResistingSprings::Row& row = s.rows[static_cast<std::size_t>(i)];
    s.rate[i] = row.direction.dot(d.applied->springs[static_cast<std::size_t>(row.spring)].rate);
    s.stretching[i] = is_across(row) ? 0 : s.rate[i];
  }
  if (!solve_rows(false, s, s.stretching)) return false;
  if (n <= kFewRows)
    s.rate.noalias() -= s.C * s.stretching;
  else
    for (const auto& e : s.entries) s.rate[e.row()] -= e.value() * s.stretching[e.col()];
  for (Eigen::Index i = 0; i < n; ++i)
    if (ResistingSprings::Row& row = s.rows[static_cast<std::size_t>(i)]; is_across(row)) row.g = -row.keeps * s.rate[i];
  return true;
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
  if (!s)
    return add_applied_forces<double>(scene, d.q.data(), d.v.data(), d.dynamics.pushes, *d.applied, d.w.data());
  find_applied_wrenches<double>(scene, d.q.data(), d.v.data(), d.dynamics.pushes, *d.applied);
  follow_loads(scene, s->loads);
  if (s->of_loads)
    add_applied_forces<double>(s->loads, d.q.data(), d.v.data(), d.dynamics.pushes, *s->of_loads, d.w.data());
}

void take_springs(const Scene& scene, SimulationData& d) {
  ResistingSprings& s = *d.resisting->springs;
  s.rows.clear(), s.ends.clear(), s.row.clear();
  s.fast.assign(scene.springs.size(), 0);
  s.unit.find_islands(scene, d.dynamics.active);
  s.unit.begin_numbers();
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const AppliedForces<double>::OfSpring& at = d.applied->springs[k];
    if (!at.directed) d.w.setConstant(std::numeric_limits<double>::quiet_NaN());  // the step fails
    const auto first = static_cast<int>(s.rows.size());
    add_rows(scene, scene.springs[k], static_cast<int>(k), *d.applied, d.h, s.mobility[k], s);
    for (int i = first; i < static_cast<int>(s.rows.size()); ++i) {
      if (s.rows[static_cast<std::size_t>(i)].D == kIdle) continue;
      s.unit.add_forces(static_cast<int>(k), s.rows[static_cast<std::size_t>(i)].direction, s.ends);
      s.row.resize(s.ends.size(), i);
    }
  }
  s.numbers = s.unit.numbers();
  s.unit.place(scene, d.q);
}

bool solve_with_springs(const Eigen::VectorXd& b, SimulationData& d) {
  ResistingSprings* s = d.resisting && d.resisting->springs ? &*d.resisting->springs : nullptr;
  if (!solves(b, d.wanted, d)) return false;
  if (!s || s->rows.empty()) return true;
  s->unit.look(answer(d));
  const auto n = static_cast<Eigen::Index>(s->rows.size());
  s->p.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResistingSprings::Row& row = s->rows[static_cast<std::size_t>(i)];
    s->p[i] = -s->unit.along(row.spring, row.direction, -1);
  }
  if (!find_responses(d, *s) || !take_tensions(d, *s) || !keep_turning(d, *s)) return false;
  for (Eigen::Index i = 0; i < n; ++i) s->p[i] -= s->rows[static_cast<std::size_t>(i)].g;
  if (!solve_rows(true, *s, s->p)) return false;
  s->unit.clear();
  for (std::size_t k = 0; k < s->ends.size(); ++k) s->unit.add(s->ends[k], s->p[s->row[k]]);
  s->b = b + s->unit.torques();
  return solves(s->b, d.wanted, d);
}

void account_for_springs(const Scene& scene, SimulationData& d, const Eigen::VectorXd& v_next) {
  ResistingSprings& s = *d.resisting->springs;
  s.unit.look(v_next);
  s.rate.resize(static_cast<Eigen::Index>(s.rows.size()));
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    const Spring& spring = scene.springs[static_cast<std::size_t>(row.spring)];
    const double before = row.direction.dot(d.applied->springs[static_cast<std::size_t>(row.spring)].rate),
                 after = s.unit.along(row.spring, row.direction, -1), mean = (before + after) / 2, moved = d.h * after;
    s.rate[static_cast<Eigen::Index>(i)] = after;
    const double k = is_across(row) ? row.k * (1 - row.keeps) : row.k;  // what turns with its bodies is not stretched
    const double damper = is_across(row) ? 0 : -d.h * spring.damping * after;
    d.work.dampers += damper * mean;
    d.work.springs += (s.p[static_cast<Eigen::Index>(i)] - damper) * mean + k * moved * (row.e + moved / 2);
  }
}

}  // namespace manycontact::internal
