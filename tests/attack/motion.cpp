#include "motion.hpp"

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact::attack {

namespace {

// Returns a body that moves with `b`, with its origin displaced by d.
template <class T>
Body<T> shifted(Body<T> b, const Vec<T>& d) {
  b.acceleration = b.acceleration + cross(b.turning, d) + cross(b.w, cross(b.w, d));
  b.v = b.v + cross(b.w, d);
  b.p = b.p + d;
  return b;
}

// Adds the relative motion of a joint to its parent's: linear velocity u and angular velocity w in the world's axes,
// and their rates of change as seen from the parent, which rotates with w0.
template <class T>
void add_motion(Body<T>& b, const Vec<T>& u, const Vec<T>& w, const Vec<T>& du, const Vec<T>& dw) {
  const Vec<T> w0 = b.w;
  b.acceleration = b.acceleration + T(2.0) * cross(w0, u) + du;
  b.turning = b.turning + cross(w0, w) + dw;
  b.v = b.v + u;
  b.w = b.w + w;
}

// Adds d(R u), seen from the parent, of joints with velocity in the child's axes and relative rotation R already in b.
template <class T>
void add_own_motion(Body<T>& b, const Vec<T>& u, const Vec<T>& w, const Vec<T>& du, const Vec<T>& dw) {
  add_motion(b, b.R * u, b.R * w, b.R * (du + cross(w, u)), b.R * dw);
}

// Moves from the link that carries a joint traversed backwards (b) to the other link.
template <class T>
Body<T> carried_backwards(const Link& l, Body<T> b, const T* q, const T* v, const T* a) {
  if (l.kind != Kind::kFixed) {
    const T o(0.0), rate = l.locked ? o : v[l.iv], change = l.locked || !a ? o : a[l.iv];
    const T at = l.locked ? T(*l.locked) : q[l.iq];
    const Vec<T> own = unit(Vec<T>(l.axis)), axis = b.R * own;
    if (l.kind == Kind::kRevolute) {
      b.R = b.R * turn(own, -at);
      add_motion(b, Vec<T>(), -rate * axis, Vec<T>(), -change * axis);
    } else {
      b = shifted(b, -at * axis);
      add_motion(b, -rate * axis, Vec<T>(), -change * axis, Vec<T>());
    }
  }
  const Rot<T> placed = turn_rpy<T>(l.rpy);
  Rot<T> R;
  for (int j = 0; j < 3; ++j) R.c[j] = {placed(j, 0), placed(j, 1), placed(j, 2)};
  b.R = b.R * R;
  return shifted(b, b.R * (T(-1.0) * Vec<T>(l.xyz)));
}

template <class T>
Body<T> carried(const Link& l, Body<T> b, const T* q, const T* v, const T* a) {
  if (l.reversed) return carried_backwards(l, b, q, v, a);
  b = shifted(b, b.R * Vec<T>(l.xyz));
  b.R = b.R * turn_rpy<T>(l.rpy);
  if (l.kind == Kind::kFixed) return b;
  const T o(0.0);
  const auto rate = [&](int k) { return l.locked ? o : v[l.iv + k]; };
  const auto change = [&](int k) { return l.locked || !a ? o : a[l.iv + k]; };
  const auto at = [&](int k) { return l.locked ? T(*l.locked) : q[l.iq + k]; };
  if (l.kind == Kind::kRevolute || l.kind == Kind::kPrismatic) {
    const Vec<T> own = unit(Vec<T>(l.axis)), axis = b.R * own;
    if (l.kind == Kind::kRevolute) {
      b.R = b.R * turn(own, at(0));
      add_motion(b, Vec<T>(), rate(0) * axis, Vec<T>(), change(0) * axis);
    } else {
      b = shifted(b, at(0) * axis);
      add_motion(b, rate(0) * axis, Vec<T>(), change(0) * axis, Vec<T>());
    }
  } else if (l.kind == Kind::kPlanar) {
    b = shifted(b, b.R * Vec<T>(at(0), at(1), o));
    b.R = b.R * turn(Vec<T>(o, o, T(1.0)), at(2));
    add_own_motion(b, {rate(0), rate(1), o}, {o, o, rate(2)}, {change(0), change(1), o}, {o, o, change(2)});
  } else {
    b = shifted(b, b.R * Vec<T>(at(0), at(1), at(2)));
    const T turned[4] = {at(3), at(4), at(5), at(6)};
    b.R = b.R * turn_quaternion(turned);
    add_own_motion(b, {rate(0), rate(1), rate(2)}, {rate(3), rate(4), rate(5)}, {change(0), change(1), change(2)},
                   {change(3), change(4), change(5)});
  }
  return b;
}

// Returns the force and the moment about the origin that cause the motion of a rigid body.
template <class T>
Wrench<T> inertial(const Link& l, const Body<T>& b, const Vec<T>& gravity) {
  const Body<T> c = shifted(b, b.R * Vec<T>(l.com));
  const Rot<T> R = b.R * turn_rpy<T>(l.com_rpy);
  const auto& I = l.inertia;
  const auto times_I = [&](const Vec<T>& x) {
    const Vec<T> y = back(R, x);
    return R * Vec<T>(T(I[0]) * y[0] + T(I[1]) * y[1] + T(I[2]) * y[2],
                      T(I[1]) * y[0] + T(I[3]) * y[1] + T(I[4]) * y[2],
                      T(I[2]) * y[0] + T(I[4]) * y[1] + T(I[5]) * y[2]);
  };
  const Vec<T> force = T(l.mass) * (c.acceleration - gravity);
  return {force, cross(c.p - b.p, force) + times_I(b.turning) + cross(b.w, times_I(b.w))};
}

}  // namespace

template <class T>
std::vector<Body<T>> move(const Tree& tree, const T* q, const T* v, const T* a) {
  std::vector<Body<T>> bodies;
  for (const Link& l : tree.links) {
    Body<T> from;
    if (l.parent >= 0)
      from = bodies[l.parent];
    else if (!tree.floating)
      from.p = Vec<T>(tree.xyz), from.R = turn_rpy<T>(tree.rpy);
    bodies.push_back(carried(l, from, q, v, a));
  }
  return bodies;
}

template <class T>
Body<T> point_of(const Body<T>& link, const Numbers& offset) {
  return shifted(link, link.R * Vec<T>(offset));
}

template <class T>
std::vector<T> joint_forces(const Tree& tree, const std::vector<Body<T>>& bodies, const Vec<T>& gravity, const T* a,
                            std::vector<Wrench<T>> on) {
  std::vector<T> tau(tree.nv, T(0.0));
  std::vector<Wrench<T>> through(bodies.size());
  for (std::size_t i = bodies.size(); i-- > 0;) {
    const Link& l = tree.links[i];
    const Body<T>& b = bodies[i];
    const Wrench<T> own = inertial(l, b, gravity);
    Wrench<T>& sum = through[i];
    sum.force = sum.force + own.force - on[i].force;
    sum.moment = sum.moment + own.moment - on[i].moment;
    if (l.moves()) {
      const Vec<T> f = back(b.R, sum.force), m = back(b.R, sum.moment);
      T* t = tau.data() + l.iv;
      if (l.reversed) {  // about its parent's origin and axes
        const Body<T>& from = bodies[l.parent];
        const Vec<T> about = l.kind == Kind::kRevolute ? sum.moment + cross(b.p - from.p, sum.force) : sum.force;
        t[0] = -dot(from.R * unit(Vec<T>(l.axis)), about);
      } else if (l.kind == Kind::kRevolute || l.kind == Kind::kPrismatic)
        t[0] = dot(unit(Vec<T>(l.axis)), l.kind == Kind::kRevolute ? m : f);  // the joint rotates about its own axis
      else if (l.kind == Kind::kPlanar)
        t[0] = f[0], t[1] = f[1], t[2] = m[2];
      else
        for (int k = 0; k < 3; ++k) t[k] = f[k], t[3 + k] = m[k];
      for (int k = 0; a && k < nv_of(l.kind); ++k) t[k] = t[k] + T(l.armature) * a[l.iv + k];
    }
    if (l.parent < 0) continue;
    Wrench<T>& below = through[l.parent];
    below.force = below.force + sum.force;
    below.moment = below.moment + sum.moment + cross(b.p - bodies[l.parent].p, sum.force);
  }
  return tau;
}

namespace {

// Returns the logarithm of the placement (R, p), its linear and angular part.
template <class T>
std::array<Vec<T>, 2> logarithm(const Rot<T>& R, const Vec<T>& p) {
  const T half(0.5);
  const Vec<T> z(half * (R(2, 1) - R(1, 2)), half * (R(0, 2) - R(2, 0)), half * (R(1, 0) - R(0, 1)));  // sin n
  const T s2 = dot(z, z), c = half * (R(0, 0) + R(1, 1) + R(2, 2) - T(1.0));
  Vec<T> w;
  T of_square;  // 1/t^2 - (1 + cos t) / (2 t sin t)
  if (value(s2) < Quad(1e-8) && value(c) > 0) {
    const T by = T(1.0) + s2 * (T(1.0) / T(6.0) +
                                s2 * (T(3.0) / T(40.0) + s2 * (T(5.0) / T(112.0) + s2 * (T(35.0) / T(1152.0)))));
    w = by * z;
    const T t2 = dot(w, w);
    of_square = T(1.0) / T(12.0) + t2 * (T(1.0) / T(720.0) + t2 * (T(1.0) / T(30240.0) + t2 * (T(1.0) / T(1209600.0))));
  } else {
    const T s = root(s2), t = angle(s, c);
    w = (t / s) * z;
    of_square = T(1.0) / (t * t) - (T(1.0) + c) / (T(2.0) * t * s);
  }
  const Vec<T> wp = cross(w, p);
  return {p - half * wp + of_square * cross(w, wp), w};
}

template <class T>
std::vector<std::array<Vec<T>, 2>> rows_of(const Hold& h, const Rot<T>& R) {
  const bool world = h.frame != "local" && h.rows != 5;
  const auto own = [&](const Vec<T>& x) { return world ? back(R, x) : x; };
  const Vec<T> none, axis = unit(Vec<T>(h.axis));
  std::vector<std::array<Vec<T>, 2>> rows;
  if (h.rows == 1) return {{own(axis), none}};
  for (int i = 0; i < 3; ++i) {
    Vec<T> e;
    e[i] = T(1.0);
    if (h.rows != 2 || i != 1) rows.push_back({own(e), none});
  }
  if (h.rows == 5) {  // the choice of two directions across the axis is a convention, taken from the library
    const auto two = manycontact::across(Vec3<double>(h.axis[0], h.axis[1], h.axis[2]).normalized());
    for (int i = 0; i < 2; ++i) rows.push_back({none, Vec<T>(T(two(i, 0)), T(two(i, 1)), T(two(i, 2)))});
  }
  for (int i = 0; h.rows == 6 && i < 3; ++i) rows.push_back({none, rows[i][0]});
  return rows;
}

}  // namespace

template <class T>
Touch<T> touch(const Case& c, const Hold& h, const std::vector<std::vector<Body<T>>>& bodies) {
  (void)c;
  const auto placed = [](const Body<T>& link, const Numbers& p, const std::array<double, 4>& turned) {
    Body<T> b = shifted(link, link.R * Vec<T>(p));
    const T q[4] = {T(turned[0]), T(turned[1]), T(turned[2]), T(turned[3])};
    b.R = b.R * turn_quaternion(q);
    return b;
  };
  const Body<T> A = placed(bodies[h.tree][h.link], h.offset, h.turned);
  const Body<T> carrier = h.to_tree < 0 ? Body<T>() : bodies[h.to_tree][h.to_link];
  const Body<T> B = placed(carrier, h.place, h.place_turned), P = shifted(carrier, A.p - carrier.p);
  Touch<T> t;
  t.R = A.R, t.p = A.p;
  const Vec<T> v = A.v - P.v, w = A.w - P.w;
  // d/dt of R_A^T (v_A - v_P), where P is the point of B's body at A, not a point fixed to that body
  const Vec<T> dv = A.acceleration - P.acceleration - cross(P.w, v) - cross(A.w, v);
  const Vec<T> dw = A.turning - P.turning - cross(A.w, w);
  t.v = back(A.R, v), t.w = back(A.R, w);
  t.linear = back(A.R, dv), t.angular = back(A.R, dw);
  if (h.rows < 6) t.linear = t.linear + cross(t.w, t.v);
  t.linear = t.linear + T(h.beta) * t.v, t.angular = t.angular + T(h.beta) * t.w;
  t.rows = rows_of(h, A.R);
  if (h.alpha == 0) return t;
  const T alpha(h.alpha);
  if (h.rows == 6) {
    Rot<T> G;
    for (int j = 0; j < 3; ++j) G.c[j] = back(B.R, A.R.c[j]);
    const auto [linear, angular] = logarithm(G, back(B.R, A.p - B.p));
    t.linear = t.linear + alpha * linear, t.angular = t.angular + alpha * angular;
    return t;
  }
  t.linear = t.linear + alpha * back(A.R, A.p - B.p);
  if (h.rows == 5) {
    const Vec<T> n = unit(Vec<T>(h.axis));
    t.angular = t.angular + alpha * cross(back(A.R, B.R * n), n);
  }
  return t;
}

#define MANYCONTACT_ATTACK_INSTANTIATE(T)                                                                 \
  template std::vector<Body<T>> move(const Tree&, const T*, const T*, const T*);                          \
  template Body<T> point_of(const Body<T>&, const Numbers&);                                              \
  template std::vector<T> joint_forces(const Tree&, const std::vector<Body<T>>&, const Vec<T>&, const T*, \
                                       std::vector<Wrench<T>>);                                           \
  template Touch<T> touch(const Case&, const Hold&, const std::vector<std::vector<Body<T>>>&);
MANYCONTACT_ATTACK_INSTANTIATE(Quad)
MANYCONTACT_ATTACK_INSTANTIATE(Dual)

}  // namespace manycontact::attack
