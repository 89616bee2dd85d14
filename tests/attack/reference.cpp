#include "reference.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "motion.hpp"

namespace manycontact::attack {

namespace {

template <class T>
using Bodies = std::vector<std::vector<Body<T>>>;

// Coordinates of all trees, one after the other, and external wrenches.
template <class T>
struct State {
  std::vector<T> q, v, a, w;
};

template <class T, class From>
std::vector<T> all(const Case& c, From&& of) {
  std::vector<T> x;
  for (const Tree& t : c.trees)
    for (double y : of(t)) x.push_back(T(y));
  return x;
}
template <class T>
std::vector<T> all_q(const Case& c) {
  return all<T>(c, [](const Tree& t) -> const std::vector<double>& { return t.q; });
}
template <class T>
std::vector<T> all_v(const Case& c) {
  return all<T>(c, [](const Tree& t) -> const std::vector<double>& { return t.v; });
}

std::vector<double> all_w(const Case& c) {
  std::vector<double> w;
  for (const ExternalWrench& p : c.wrenches)
    for (const Numbers* x : {&p.force, &p.torque}) w.insert(w.end(), x->begin(), x->end());
  return w;
}
template <class T>
State<T> state_of(const Case& c) {
  const std::vector<double> w = all_w(c);
  return {all_q<T>(c), all_v<T>(c), {}, {w.begin(), w.end()}};
}

template <class T>
Bodies<T> move_all(const Case& c, const State<T>& s) {
  Bodies<T> bodies;
  std::size_t q = 0, v = 0;
  for (const Tree& t : c.trees) {
    bodies.push_back(move<T>(t, s.q.data() + q, s.v.data() + v, s.a.empty() ? nullptr : s.a.data() + v));
    q += t.nq, v += t.nv;
  }
  return bodies;
}

// Returns J a + a0 of all holds, or their relative velocities.
template <class T>
std::vector<T> rows_at(const Case& c, const Bodies<T>& bodies, bool velocities) {
  std::vector<T> x;
  for (const Hold& h : c.holds) {
    const Touch<T> t = touch<T>(c, h, bodies);
    for (const auto& row : t.rows)
      x.push_back(velocities ? dot(row[0], t.v) + dot(row[1], t.w) : dot(row[0], t.linear) + dot(row[1], t.angular));
  }
  return x;
}

// Returns the wrenches of the holds on the links: f in their rows acts on A and, reversed, on B's body.
template <class T>
std::vector<std::vector<Wrench<T>>> contact_wrenches(const Case& c, const Bodies<T>& bodies, const Column& f) {
  std::vector<std::vector<Wrench<T>>> on;
  for (const auto& b : bodies) on.emplace_back(b.size());
  std::size_t k = 0;
  for (const Hold& h : c.holds) {
    const Touch<T> t = touch<T>(c, h, bodies);
    Vec<T> force, moment;
    for (const auto& row : t.rows) {
      force = force + T(f[k]) * row[0], moment = moment + T(f[k]) * row[1];
      ++k;
    }
    force = t.R * force, moment = t.R * moment;
    const auto act = [&](int tree, int link, T sign) {
      Wrench<T>& w = on[tree][link];
      w.force = w.force + sign * force;
      w.moment = w.moment + sign * (moment + cross(t.p - bodies[tree][link].p, force));
    };
    act(h.tree, h.link, T(1.0));
    if (h.to_tree >= 0) act(h.to_tree, h.to_link, T(-1.0));
  }
  return on;
}

// Adds the wrench of a force at a point, and of a moment.
template <class T>
void act_at(const Body<T>& at, const Body<T>& link, const Vec<T>& force, const Vec<T>& moment, Wrench<T>& on) {
  on.force = on.force + force;
  on.moment = on.moment + moment + cross(at.p - link.p, force);
}

template <class T>
void add_pushes(const Case& c, const State<T>& s, const Bodies<T>& bodies, std::vector<std::vector<Wrench<T>>>& on) {
  for (std::size_t k = 0; k < c.wrenches.size(); ++k) {
    const ExternalWrench& p = c.wrenches[k];
    const Body<T>& link = bodies[p.tree][p.link];
    const T* w = s.w.data() + 6 * k;
    Vec<T> force(w[0], w[1], w[2]), moment(w[3], w[4], w[5]);
    if (!p.world) force = link.R * force, moment = link.R * moment;
    act_at(point_of(link, p.offset), link, force, moment, on[p.tree][p.link]);
  }
}

template <class T>
void add_springs(const Case& c, const Bodies<T>& bodies, std::vector<std::vector<Wrench<T>>>& on) {
  for (const Spring& s : c.springs) {
    const Body<T> world{}, &link = bodies[s.tree][s.link],
                           &other = s.to_tree < 0 ? world : bodies[s.to_tree][s.to_link];
    const Body<T> A = point_of(link, s.offset), B = point_of(other, s.place);
    const Vec<T> d = A.p - B.p;
    T pull(s.stiffness);  // divided by the length
    if (s.directed()) {
      const T length = root(dot(d, d)), speed = dot(d, A.v - B.v) / length;
      pull = (T(s.stiffness) * (length - T(s.length)) + T(s.damping) * speed) / length;
    }
    act_at(A, link, -pull * d, Vec<T>(), on[s.tree][s.link]);
    if (s.to_tree >= 0) act_at(B, other, pull * d, Vec<T>(), on[s.to_tree][s.to_link]);
  }
}

// Returns joint forces for the motion s with contact forces f and, if `acting`, gravity, wrenches, springs and dampers.
template <class T>
std::vector<T> forces_at(const Case& c, const State<T>& s, const Bodies<T>& bodies, const Column& f, bool acting) {
  const Vec<T> g = acting ? Vec<T>(c.gravity) : Vec<T>();
  auto on = contact_wrenches<T>(c, bodies, f);
  if (acting) add_pushes(c, s, bodies, on), add_springs(c, bodies, on);
  std::vector<T> tau;
  std::size_t q = 0, v = 0;
  for (std::size_t k = 0; k < c.trees.size(); ++k) {
    auto own = joint_forces<T>(c.trees[k], bodies[k], g, s.a.empty() ? nullptr : s.a.data() + v, on[k]);
    for (const Link& l : c.trees[k].links)
      if (acting && l.moves() && nv_of(l.kind) == 1)
        own[l.iv] = own[l.iv] + T(l.stiffness) * (s.q[q + l.iq] - T(l.rest)) + T(l.damping) * s.v[v + l.iv];
    tau.insert(tau.end(), own.begin(), own.end());
    q += c.trees[k].nq, v += c.trees[k].nv;
  }
  return tau;
}

Column torques(const Case& c) {
  Column tau;
  for (const Tree& t : c.trees) {
    for (int k = 0; k < t.free(); ++k) tau.push_back(0);
    for (double u : t.u) tau.push_back(u);
  }
  return tau;
}

// Returns the largest term of a contact's rows: accelerations, centripetal ones, gains times placements and velocities.
double size_of_terms(const Case& c, const Hold& h, const Bodies<Quad>& bodies) {
  double most = 0;
  for (const double g : c.gravity) most = std::max(most, std::abs(g));
  const auto size = [](const Vec<Quad>& x) { return std::abs(static_cast<double>(root(dot(x, x)))); };
  const Touch<Quad> t = touch<Quad>(c, h, bodies);
  for (const auto& [tree, link] : {std::pair(h.tree, h.link), std::pair(h.to_tree, h.to_link)}) {
    if (tree < 0) continue;
    const Body<Quad>& b = bodies[tree][link];
    const double lever = size(t.p - b.p), w = size(b.w);
    most = std::max({most, size(b.acceleration), size(b.turning) * (1 + lever), w * w * (1 + lever), w * size(b.v),
                     h.beta * (size(b.v) + w * (1 + lever)), h.alpha * (1 + lever + size(t.p))});
  }
  return most;
}

// Returns the first tree of each tree's island. Contacts couple trees, and so do springs if both ends move.
std::vector<int> islands(const Case& c) {
  std::vector<int> first(c.trees.size());
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = static_cast<int>(k);
  const auto join = [&](int x, int y) {
    const int a = std::min(first[x], first[y]), b = std::max(first[x], first[y]);
    std::replace(first.begin(), first.end(), b, a);
  };
  for (const Hold& h : c.holds)
    if (h.to_tree >= 0) join(h.tree, h.to_tree);
  for (const Spring& s : c.springs)
    if (s.to_tree >= 0 && moving_link(c.trees[s.to_tree], s.to_link) >= 0) join(s.tree, s.to_tree);
  return first;
}

// Counts the accepted pivots for thresholds from rounding errors of double precision to clearly more.
void count_pivots(const Qr& qr, std::set<int>& ranks) {
  for (const double threshold : {1e-14, 1e-13, 1e-12, 3e-12, 1e-11, 3e-11, 1e-10, 1e-9}) {
    int rank = 0;
    while (rank < static_cast<int>(qr.left.size()) && qr.left[rank] > 0 && qr.left[rank] > Quad(threshold) * qr.left[0])
      ++rank;
    ranks.insert(rank);
  }
}

}  // namespace

struct Reference::Solved {
  SaddlePoint factor;
  Answer answer;
};

Reference::~Reference() = default;

Reference::Reference(const Case& c) : case_(c), nv_(c.nv()), rows_(c.rows()), M_(nv_, nv_), J_(rows_, nv_) {
  const State<Quad> now = state_of<Quad>(c);
  const Bodies<Quad> bodies = move_all(c, now);
  const Column none(rows_, Quad(0)), still(nv_, Quad(0));
  b1_ = torques(c);
  const Column h = forces_at(c, now, bodies, none, true);
  for (int k = 0; k < nv_; ++k) b1_[k] -= h[k];
  b2_ = rows_at(c, bodies, false);
  for (Quad& x : b2_) x = -x;
  const std::vector<int> island = islands(c);
  terms_.assign(c.trees.size(), 0);
  for (const Hold& h : c.holds) {
    double& terms = terms_[island[h.tree]];
    terms = std::max(terms, size_of_terms(c, h, bodies));
    island_of_row_.insert(island_of_row_.end(), h.rows, island[h.tree]);
  }
  for (int j = 0; j < nv_; ++j) {
    Column e(nv_, Quad(0));
    e[j] = 1;
    const State<Quad> accelerated{now.q, still, e, {}}, moved{now.q, e, {}, {}};
    const Column m = forces_at(c, accelerated, move_all(c, accelerated), none, false);
    const Column v = rows_at(c, move_all(c, moved), true);
    for (int i = 0; i < nv_; ++i) M_(i, j) = m[i];
    for (int i = 0; i < rows_; ++i) J_(i, j) = v[i];
  }
  if (c.damping > 0) {
    ranks_ = {rows_};
    return;
  }
  // J is used as it is, and with each row divided by its own size, unless the row is rounding error.
  Matrix as_is(nv_, rows_), scaled(nv_, rows_);
  const Quad rounding = Quad(1e-13) * Quad(largest_J());
  for (int i = 0; i < rows_; ++i) {
    Quad size = 0;
    for (int j = 0; j < nv_; ++j) size = std::max(size, fabsq(J_(i, j)));
    for (int j = 0; j < nv_; ++j) as_is(j, i) = J_(i, j), scaled(j, i) = size > rounding ? J_(i, j) / size : Quad(0);
  }
  std::set<int> ranks;
  count_pivots(Qr(as_is, nv_, true), ranks);
  count_pivots(Qr(scaled, nv_, true), ranks);
  if (largest_J() < 1e-14) ranks.insert(0);  // rounding of unit motions, or of moment arms in metres
  ranks_.assign(ranks.rbegin(), ranks.rend());
}

Reference::Solved& Reference::solved(int rank) {
  for (const auto& s : solved_)
    if (s->answer.rank == rank) return *s;
  auto s = std::make_unique<Solved>(Solved{SaddlePoint(M_, J_, Quad(case_.damping), rank), {}});
  Answer& x = s->answer;
  x.rank = rank;
  x.regular = s->factor.regular();
  if (x.regular) {
    s->factor.solve(b1_, b2_, x.a, x.f);
    x.condition = static_cast<double>(s->factor.condition());
    x.balance.resize(terms_.size());
    for (int i = 0; i < rows_; ++i) {
      Quad left = Quad(case_.damping) * x.f[i] - b2_[i], size = 0;
      for (int j = 0; j < nv_; ++j) left += J_(i, j) * x.a[j], size += fabsq(J_(i, j) * x.a[j]);
      Balance& b = x.balance[island_of_row_[i]];
      b.left = std::max(b.left, static_cast<double>(fabsq(left)));
      b.moved = std::max(b.moved, static_cast<double>(size));
      b.drift = std::max(b.drift, static_cast<double>(fabsq(b2_[i])));
    }
    for (std::size_t k = 0; k < x.balance.size(); ++k) {
      Balance& b = x.balance[k];
      b.terms = std::max({terms_[k], b.moved, b.drift});
      x.terms = std::max(x.terms, b.terms);
    }
  }
  solved_.push_back(std::move(s));
  return *solved_.back();
}

const Answer& Reference::at(int rank) { return solved(rank).answer; }

double Reference::free_size() const {
  const Lu lu(M_);
  return lu.regular ? largest(lu.solve(b1_)) : 0;
}

namespace {

// Returns q (+) e dq.
std::vector<Dual> moved_along(const Case& c, const std::vector<double>& dq) {
  std::vector<Dual> q = all_q<Dual>(c);
  std::size_t first_q = 0, first_v = 0;
  for (const Tree& t : c.trees) {
    for (const Link& l : t.links) {
      if (!l.moves()) continue;
      Dual* x = q.data() + first_q + l.iq;
      const double* d = dq.data() + first_v + l.iv;
      if (l.kind == Kind::kPlanar) {
        const Quad s = sinq(x[2].v), k = cosq(x[2].v);
        x[0].d = k * d[0] - s * d[1], x[1].d = s * d[0] + k * d[1], x[2].d = d[2];
      } else if (l.kind == Kind::kFloating) {
        const Quad i = x[3].v, j = x[4].v, k = x[5].v, w = x[6].v, h = 0.5;
        const Quad turned[4] = {i, j, k, w};
        const Vec<Quad> p = turn_quaternion(turned) * Vec<Quad>(Quad(d[0]), Quad(d[1]), Quad(d[2]));
        for (int e = 0; e < 3; ++e) x[e].d = p[e];
        x[3].d = h * (w * d[3] + j * d[5] - k * d[4]), x[4].d = h * (w * d[4] + k * d[3] - i * d[5]);
        x[5].d = h * (w * d[5] + i * d[4] - j * d[3]), x[6].d = -h * (i * d[3] + j * d[4] + k * d[5]);
      } else {
        x[0].d = d[0];
      }
    }
    first_q += t.nq, first_v += t.nv;
  }
  return q;
}

std::vector<Dual> constant(const Column& x) { return {x.begin(), x.end()}; }
Column slopes(const std::vector<Dual>& x) {
  Column d;
  for (const Dual& y : x) d.push_back(y.d);
  return d;
}
Column minus(Column x, const Column& y) {
  for (std::size_t k = 0; k < x.size(); ++k) x[k] -= y[k];
  return x;
}

}  // namespace

// With r1 = M a - J^T f - b1 and r2 = J a + a0 at the solution's a and f, rho = r2:
//   N^T (M da + dr1) = 0,  J da = -(part of dr2 in J's range) - (J^T)^+ d(J^T) rho,
//   J^T df = M da + dr1,   (I - J J^+) df = (I - J J^+) dJ y,  J y = f.
Slopes Reference::along(int rank, const Direction& direction) {
  const Solved& s = solved(rank);
  State<Dual> x = state_of<Dual>(case_);
  x.q = moved_along(case_, direction.q), x.a = constant(s.answer.a);
  for (int k = 0; k < nv_; ++k) x.v[k].d = direction.v[k];
  for (std::size_t k = 0; k < direction.w.size(); ++k) x.w[k].d = direction.w[k];
  const Bodies<Dual> bodies = move_all(case_, x);
  Column dr1 = slopes(forces_at(case_, x, bodies, s.answer.f, true)), dr2 = slopes(rows_at(case_, bodies, false));
  for (int k = 0; k < nv_; ++k) dr1[k] -= direction.tau[k];
  Slopes out;
  const Column none(rows_, Quad(0));
  const bool dependent = case_.damping == 0 && rank < rows_;
  if (dependent) {
    Column rho = minus(times(J_, s.answer.a), b2_);
    State<Dual> still{x.q, std::vector<Dual>(nv_), {}, {}};
    const Bodies<Dual> at_rest = move_all(case_, still);
    // forces of the links without motion and gravity: -J^T rho
    const Column turned = slopes(forces_at(case_, still, at_rest, rho, false));
    const Column push = s.factor.least_force(turned);  // (J^T)^+ (-dJ^T rho)
    for (int k = 0; k < rows_; ++k) dr2[k] -= push[k];
  }
  Column b1 = dr1, b2 = dr2;
  for (Quad& y : b1) y = -y;
  for (Quad& y : b2) y = -y;
  s.factor.solve(b1, b2, out.a, out.f);
  if (dependent) {
    const Column y = s.factor.least_motion(s.answer.f);
    const State<Dual> going{x.q, constant(y), {}, {}};
    const Column more = s.factor.off_range(slopes(rows_at(case_, move_all(case_, going), true)));
    for (int k = 0; k < rows_; ++k) out.f[k] += more[k];
  }
  return out;
}

std::optional<std::vector<double>> Reference::quasi_static(double& spread) const {
  Case still = case_;
  std::vector<int> actuated;
  int first = 0;
  for (Tree& t : still.trees) {
    std::fill(t.v.begin(), t.v.end(), 0.0);
    for (int k = t.free(); k < t.nv; ++k) actuated.push_back(first + k);
    first += t.nv;
  }
  const State<Quad> now = state_of<Quad>(still);
  const Column h = forces_at(still, now, move_all(still, now), Column(rows_, Quad(0)), true);
  const int nu = static_cast<int>(actuated.size());
  Matrix rows(nu + rows_, nv_);  // [S; J]
  for (int k = 0; k < nu; ++k) rows(k, actuated[k]) = 1;
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < nv_; ++j) rows(nu + i, j) = J_(i, j);
  Matrix columns(nv_, nu + rows_);
  for (int i = 0; i < rows.rows; ++i)
    for (int j = 0; j < nv_; ++j) columns(j, i) = rows(i, j);
  const Qr qr(columns, nv_, true);
  std::set<int> ranks;
  count_pivots(qr, ranks);
  if (ranks.size() != 1 || nu == 0) return std::nullopt;
  const int rank = *ranks.begin();
  spread = rank == 0 ? 1 : static_cast<double>(qr.left[0] / qr.left[rank - 1]);
  const Column x = SaddlePoint(Matrix(nv_, nv_), rows, Quad(0), rank).least_force(h);
  return std::vector<double>(x.begin(), x.begin() + nu);
}

bool Reference::impact(int rank, Column& v, Column& impulse) const {
  const SaddlePoint factor(M_, J_, Quad(case_.damping), rank);
  if (!factor.regular()) return false;
  const Column before = all_v<Quad>(case_);
  factor.solve(times(M_, before), Column(rows_, Quad(0)), v, impulse);
  return true;
}

Case blurred(const Case& c, std::uint64_t seed) {
  std::mt19937_64 bits(seed);
  const auto blur = [&](auto& list) {
    for (double& x : list) {
      const double of_eps = static_cast<double>(bits() >> 11) * 0x1p-52 - 1;  // in [-1, 1)
      x += x * 2 * of_eps * std::numeric_limits<double>::epsilon();
    }
  };
  const auto blur_one = [&](double& x) {
    std::array<double, 1> list = {x};
    blur(list), x = list[0];
  };
  Case out = c;
  blur(out.gravity);
  for (Tree& t : out.trees) {
    blur(t.xyz), blur(t.rpy), blur(t.q), blur(t.v), blur(t.u);
    for (Link& l : t.links) {
      blur(l.xyz), blur(l.rpy), blur(l.axis), blur(l.com), blur(l.inertia);
      blur_one(l.mass), blur_one(l.armature);
    }
  }
  for (Hold& h : out.holds) blur(h.offset), blur(h.place), blur(h.axis), blur(h.turned), blur(h.place_turned);
  for (Tree& t : out.trees)
    for (Link& l : t.links) blur_one(l.stiffness), blur_one(l.rest), blur_one(l.damping);
  for (ExternalWrench& p : out.wrenches) blur(p.offset), blur(p.force), blur(p.torque);
  for (Spring& s : out.springs)
    blur(s.offset), blur(s.place), blur_one(s.stiffness), blur_one(s.length), blur_one(s.damping);
  return out;
}

void place_where_they_are(Case& c) {
  const State<Quad> now{all_q<Quad>(c), std::vector<Quad>(c.nv(), Quad(0)), {}, {}};
  const Bodies<Quad> bodies = move_all(c, now);
  for (Hold& h : c.holds) {
    const Touch<Quad> t = touch<Quad>(c, h, bodies);
    const Body<Quad> on = h.to_tree < 0 ? Body<Quad>() : bodies[h.to_tree][h.to_link];
    const Vec<Quad> p = back(on.R, t.p - on.p);
    Rot<Quad> R;
    for (int j = 0; j < 3; ++j) R.c[j] = back(on.R, t.R.c[j]);
    // the quaternion is divided by its largest entry
    const Quad d[4] = {1 + R(0, 0) - R(1, 1) - R(2, 2), 1 - R(0, 0) + R(1, 1) - R(2, 2),
                       1 - R(0, 0) - R(1, 1) + R(2, 2), 1 + R(0, 0) + R(1, 1) + R(2, 2)};
    const int k = static_cast<int>(std::max_element(d, d + 4) - d);
    const Quad xy = R(0, 1) + R(1, 0), xz = R(0, 2) + R(2, 0), yz = R(1, 2) + R(2, 1);
    const Quad xw = R(2, 1) - R(1, 2), yw = R(0, 2) - R(2, 0), zw = R(1, 0) - R(0, 1);
    const Quad of[4][4] = {{d[0], xy, xz, xw}, {xy, d[1], yz, yw}, {xz, yz, d[2], zw}, {xw, yw, zw, d[3]}};
    for (int i = 0; i < 4; ++i) h.place_turned[i] = static_cast<double>(of[k][i] / (2 * sqrtq(d[k])));
    for (int i = 0; i < 3; ++i) h.place[i] = static_cast<double>(p[i]);
  }
}

}  // namespace manycontact::attack
