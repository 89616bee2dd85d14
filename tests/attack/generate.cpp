// Makes random scenes, hostile along the given dimensions. The same seed makes the same scene everywhere.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "case.hpp"
#include "reference.hpp"

namespace manycontact::attack {

namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double uniform(double low = 0, double high = 1) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }
  double normal(double size = 1) {
    const double r = std::sqrt(-2 * std::log(1 - uniform()));
    return size * r * std::cos(2 * std::numbers::pi * uniform());
  }
  int below(int n) { return std::min(n - 1, static_cast<int>(uniform(0, n))); }
  bool chance(double p) { return uniform() < p; }
  double power(double least, double most) { return std::pow(10, uniform(least, most)); }
  template <class T>
  const T& of(const std::vector<T>& list) {
    return list[below(static_cast<int>(list.size()))];
  }
  Numbers vector(double size = 1) { return {normal(size), normal(size), normal(size)}; }
  std::array<double, 4> quaternion() {
    std::array<double, 4> q = {normal(), normal(), normal(), normal()};
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& x : q) x /= n;
    return q;
  }
  Numbers coordinate_axis() {
    Numbers a = {0, 0, 0};
    a[below(3)] = 1;
    return a;
  }

 private:
  std::mt19937_64 bits_;
};

Numbers scaled(Numbers x, double by) { return {x[0] * by, x[1] * by, x[2] * by}; }
Numbers sum(const Numbers& x, const Numbers& y) { return {x[0] + y[0], x[1] + y[1], x[2] + y[2]}; }

// Returns the inertia of a box of random sides, in axes along them.
std::array<double, 6> box_inertia(Random& r, double mass) {
  const double x = r.uniform(0.05, 0.4), y = r.uniform(0.05, 0.4), z = r.uniform(0.05, 0.4), m = mass / 12;
  return {m * (y * y + z * z), 0, 0, m * (x * x + z * z), 0, m * (x * x + y * y)};
}

struct Makes {  // makes one scene
  Random r;
  std::set<std::string> dimensions;
  bool has(const char* name) const { return dimensions.count(name) > 0; }

  Case make();
  Tree tree(int joints);
  void weigh(Tree& t);
  void state(Tree& t);
  void near_aligned(Tree& t);
  Hold hold(const Case& c);
  Hold copy_of(const Hold& h);
  void herd(Case& c);
  void pile(Case& c);
  void reverse(Tree& t);
  void spring_joints(Tree& t);
  ExternalWrench push(const Case& c);
  Spring spring(const Case& c);
  void rescale(Case& c, double length, double mass, bool last_alone);
};

Tree Makes::tree(int joints) {
  Tree t;
  t.floating = r.chance(0.5);
  const bool plain = has("exact");
  if (!t.floating) t.xyz = r.vector(), t.rpy = plain ? Numbers{} : r.vector();
  std::vector<Kind> kinds = {Kind::kRevolute};
  if (has("joint"))
    kinds = {Kind::kRevolute, Kind::kPrismatic, Kind::kPlanar, Kind::kFixed};
  else if (r.chance(0.3))
    kinds = {Kind::kRevolute, Kind::kPrismatic};
  for (int i = 0; i <= joints; ++i) {
    Link l;
    l.name = "l" + std::to_string(i);
    l.joint = "j" + std::to_string(100 + i);
    l.parent = i == 0 ? -1 : has("chain") || r.chance(0.7) ? i - 1 : r.below(i);
    l.kind = i == 0 ? Kind::kFixed : r.of(kinds);
    l.xyz = r.vector(0.3), l.rpy = plain ? Numbers{} : r.vector();
    l.axis = plain || l.kind == Kind::kPlanar || r.chance(0.3) ? r.coordinate_axis() : r.vector();
    if (l.kind == Kind::kPlanar) l.axis = {0, 0, 1};
    if (i == 0) l.xyz = l.rpy = {};
    l.mass = r.uniform(0.3, 2);
    l.com = r.vector(0.15), l.com_rpy = plain ? Numbers{} : r.vector();
    l.inertia = box_inertia(r, l.mass);
    t.links.push_back(l);
  }
  weigh(t);
  if (has("root")) reverse(t);
  if (has("joint_spring") || has("damper")) spring_joints(t);
  for (Link& l : t.links)
    if (has("lock") && l.parent >= 0 && nv_of(l.kind) == 1 && r.chance(0.4)) l.locked = r.normal();
  number_coordinates(t);
  state(t);
  if (has("posture")) near_aligned(t);
  return t;
}

void Makes::weigh(Tree& t) {
  const auto times = [](Link& l, double mass, double inertia) {
    l.mass *= mass;
    for (double& x : l.inertia) x *= inertia;
  };
  const double spread = r.of(std::vector<double>{1.5, 3, 4.5, 6});
  for (Link& l : t.links) {
    if (has("mass") && r.chance(0.7)) {
      const double s = r.power(-spread, spread);
      times(l, s, s);
    }
    if (has("massless") && r.chance(0.4)) {
      const double s = std::pow(10, -6.0 - r.below(11));
      const int way = r.below(4);
      times(l, way == 0 ? 0 : way == 2 ? s : 1, way < 2 ? 0 : s);
    }
    if (has("armature") && nv_of(l.kind) == 1 && r.chance(0.6)) l.armature = r.power(-16, 2);
  }
}

void Makes::state(Tree& t) {
  t.q.assign(t.nq, 0), t.v.assign(t.nv, 0), t.u.assign(t.nv - t.free(), 0);
  for (const Link& l : t.links) {
    if (!l.moves()) continue;
    for (int k = 0; k < nq_of(l.kind); ++k) t.q[l.iq + k] = r.normal();
    if (l.kind != Kind::kFloating) continue;
    const auto turned = r.quaternion();
    std::copy(turned.begin(), turned.end(), t.q.begin() + l.iq + 3);
  }
  const double speed = has("fast") ? r.power(1, 3) : 1, force = has("force") ? r.power(-1, 3) : 1;
  for (double& x : t.v) x = has("still") ? 0 : r.normal(speed);
  for (double& x : t.u) x = r.normal(force);
}

// Puts most hinges in line, or nearly: stretched and folded arms.
void Makes::near_aligned(Tree& t) {
  const double off = r.chance(0.2) ? 0 : std::pow(10, -1.0 - r.below(16));
  for (Link& l : t.links) {
    if (l.parent < 0 || l.kind != Kind::kRevolute || l.locked || r.chance(0.3)) continue;
    if (r.chance(0.8)) l.axis = {0, 1, 0};
    l.xyz = {0.3, 0, 0}, l.rpy = {};
    t.q[l.iq] = off * r.normal() + (r.chance(0.1) ? std::numbers::pi : 0);
  }
}

// Gives the file another root: a link that only joints with one coordinate connect with the old root.
void Makes::reverse(Tree& t) {
  int at = r.below(static_cast<int>(t.links.size()));
  const auto passes = [&](int i) { return nv_of(t.links[i].kind) <= 1; };
  for (int i = at; i > 0; i = t.links[i].parent)
    if (!passes(i)) at = t.links[i].parent;
  for (int i = at; i > 0; i = t.links[i].parent) t.links[i].reversed = true;
}

void Makes::spring_joints(Tree& t) {
  for (Link& l : t.links) {
    if (l.parent < 0 || nv_of(l.kind) != 1) continue;
    if (has("joint_spring") && r.chance(0.6)) l.stiffness = r.power(-3, 6), l.rest = r.normal();
    if (has("damper") && r.chance(0.6)) l.damping = r.power(-3, 4);
  }
}

ExternalWrench Makes::push(const Case& c) {
  ExternalWrench p;
  p.tree = r.below(static_cast<int>(c.trees.size()));
  p.link = r.below(static_cast<int>(c.trees[p.tree].links.size()));
  if (r.chance(0.7)) p.offset = r.vector(0.2);
  const double size = r.of(std::vector<double>{1e-6, 1, 10, 1000, 1e6});
  if (r.chance(0.8)) p.force = r.vector(size);
  if (r.chance(0.8)) p.torque = r.vector(size);
  p.world = r.chance(0.5);
  return p;
}

Spring Makes::spring(const Case& c) {
  Spring s;
  const int trees = static_cast<int>(c.trees.size());
  const auto link_of = [&](int tree) { return r.below(static_cast<int>(c.trees[tree].links.size())); };
  s.tree = r.below(trees), s.link = link_of(s.tree);
  if (r.chance(0.7)) s.offset = r.vector(0.2);
  if (r.chance(0.6))
    s.to_tree = r.below(trees), s.to_link = link_of(s.to_tree), s.place = r.vector(0.2);
  else
    s.place = r.vector();
  s.stiffness = r.chance(0.1) ? 0 : r.power(-3, 8);
  s.length = r.of(std::vector<double>{0, 0.3, 1});
  if (r.chance(0.5)) s.damping = r.power(-2, 4);
  return s;
}

Hold Makes::hold(const Case& c) {
  Hold h;
  const int trees = static_cast<int>(c.trees.size());
  const auto link_of = [&](int tree) { return r.below(static_cast<int>(c.trees[tree].links.size())); };
  h.rows = r.of(std::vector<int>{1, 2, 3, 5, 6});
  h.tree = r.below(trees), h.link = link_of(h.tree);
  if (!c.trees[h.tree].floating && r.chance(0.5)) h.link = static_cast<int>(c.trees[h.tree].links.size()) - 1;
  if (has("pairs") && r.chance(0.7)) h.to_tree = r.below(trees), h.to_link = link_of(h.to_tree);
  const double lever = has("lever") ? r.power(1, 8) : 0.2;
  if (r.chance(0.7)) h.offset = r.vector(lever);
  if (!has("exact") && r.chance(0.5)) h.turned = r.quaternion();
  if (has("drift")) h.place = r.vector(), h.place_turned = r.quaternion();
  h.frame = r.of(std::vector<std::string>{"local", "world", "local_world_aligned"});
  h.axis = has("exact") ? r.coordinate_axis() : r.vector();
  if (has("gains"))
    h.alpha = r.power(0, 6), h.beta = r.power(0, 3);
  else if (r.chance(0.3))
    h.alpha = 25, h.beta = 10;
  return h;
}

// Returns another contact that depends on `h`, exactly or nearly.
Hold Makes::copy_of(const Hold& h) {
  Hold c = h;
  const double off = has("near") ? std::pow(10, -1.0 - r.below(16)) : 0;
  if (off > 0)
    c.offset = sum(c.offset, r.vector(off));
  else if (r.chance(0.5))
    c.offset = sum(c.offset, r.vector(0.1));
  if (r.chance(0.5)) c.rows = r.of(std::vector<int>{1, 2, 3, 5, 6});
  if (r.chance(0.3)) c.frame = r.of(std::vector<std::string>{"local", "world"});
  if (off > 0 && r.chance(0.5)) c.axis = sum(c.axis, r.vector(off));
  return c;
}

// Rescales lengths and masses to other units; with `last_alone` one tree is in mm, the others are in m.
void Makes::rescale(Case& c, double length, double mass, bool last_alone) {
  const std::size_t first = last_alone ? c.trees.size() - 1 : 0;
  for (std::size_t k = first; k < c.trees.size(); ++k) {
    Tree& t = c.trees[k];
    t.xyz = scaled(t.xyz, length);
    for (Link& l : t.links) {
      l.xyz = scaled(l.xyz, length), l.com = scaled(l.com, length);
      l.mass *= mass;
      for (double& x : l.inertia) x *= mass * length * length;
      const int lengths = !l.moves() ? 0 : l.kind == Kind::kFloating ? 3 : l.kind == Kind::kPlanar ? 2 : 0;
      const double inertia = l.kind == Kind::kPrismatic ? mass : mass * length * length;
      l.armature *= inertia, l.stiffness *= inertia, l.damping *= inertia;
      if (l.kind == Kind::kPrismatic) l.rest *= length;
      for (int i = 0; i < lengths + (l.moves() && l.kind == Kind::kPrismatic); ++i)
        t.q[l.iq + i] *= length, t.v[l.iv + i] *= length;
    }
    for (double& x : t.u) x *= mass * length * length;
  }
  for (Hold& h : c.holds)
    if (h.tree >= static_cast<int>(first)) h.offset = scaled(h.offset, length), h.place = scaled(h.place, length);
  for (ExternalWrench& p : c.wrenches) {
    if (p.tree < static_cast<int>(first)) continue;
    p.offset = scaled(p.offset, length), p.force = scaled(p.force, mass * length);
    p.torque = scaled(p.torque, mass * length * length);
  }
  for (Spring& s : c.springs) {
    if (s.tree < static_cast<int>(first)) continue;
    s.offset = scaled(s.offset, length), s.place = scaled(s.place, length), s.length *= length;
    s.stiffness *= mass, s.damping *= mass;
  }
  if (!last_alone) c.gravity = scaled(c.gravity, length);
}

// Adds robots of one file or two, in different states, most of them with similar contacts.
void Makes::herd(Case& c) {
  for (int kinds = 1 + r.below(2); kinds > 0; --kinds) {
    const Tree one = tree(1 + r.below(3));
    const Case alone{"", {}, 0, {one}, {}, {}, {}};
    const Hold held = hold(alone);
    const bool holds = r.chance(0.7);
    for (int copies = kinds == 1 ? 2 + r.below(5) : 1 + r.below(2); copies > 0; --copies) {
      Tree t = one;
      state(t);
      if (!t.floating) t.xyz = r.vector(), t.rpy = has("exact") ? Numbers{} : r.vector();
      const int tree = static_cast<int>(c.trees.size());
      c.trees.push_back(t);
      if (!holds || r.chance(0.1)) continue;
      c.holds.push_back(held);
      c.holds.back().tree = tree;
      if (held.to_tree >= 0) c.holds.back().to_tree = tree;
      if (r.chance(0.5)) c.holds.back().offset = r.vector(0.2);
    }
  }
  // springs couple some of them in a chain, others are separate
  const int trees = static_cast<int>(c.trees.size());
  for (int k = has("spring") ? r.below(trees) : 0; k > 0; --k) {
    Spring s = spring(c);
    s.tree = k, s.link = static_cast<int>(c.trees[k].links.size()) - 1;
    s.to_tree = k - 1, s.to_link = static_cast<int>(c.trees[k - 1].links.size()) - 1;
    s.stiffness = r.power(0, 4), s.place = r.vector(0.2);
    c.springs.push_back(s);
  }
}

// Adds free boxes in rows, each row on the one below, with up to four points or a weld between the faces that touch.
void Makes::pile(Case& c) {
  constexpr double kHalf = 0.5;
  const bool pyramid = r.chance(0.5), tilted = !has("exact") && r.chance(0.5);
  const int bottom = pyramid ? 2 + r.below(2) : 1 + r.below(2), rows = pyramid ? bottom : 2 + r.below(3);
  const auto rests = [&](int tree, int on, double from, double to) {
    const int points = 1 + r.below(4);
    const bool welded = r.chance(0.2);
    for (int k = 0; k < (welded ? 1 : points); ++k) {
      Hold h;
      h.tree = tree, h.to_tree = on;
      h.rows = welded ? 6 : r.chance(0.8) ? 3 : 1;
      h.offset = {k % 2 ? to : from, k < 2 ? kHalf : -kHalf, -kHalf};
      h.frame = r.chance(0.8) ? "local" : "local_world_aligned";
      if (has("gains")) h.alpha = r.power(0, 6), h.beta = r.power(0, 3);
      c.holds.push_back(h);
    }
  };
  std::vector<int> below;
  for (int row = 0; row < rows; ++row) {
    const int boxes = pyramid ? bottom - row : bottom;
    std::vector<int> own;
    for (int i = 0; i < boxes; ++i) {
      own.push_back(static_cast<int>(c.trees.size()));
      Tree t = tree(0);
      t.floating = true, t.xyz = t.rpy = {};
      number_coordinates(t);
      state(t);
      const double x = 2 * kHalf * i + (pyramid ? kHalf * row : 0);
      const std::vector<double> at = {x, 0, 2 * kHalf * row + kHalf, 0, 0, 0, 1};
      if (!tilted) std::copy(at.begin(), at.end(), t.q.begin());
      c.trees.push_back(t);
      if (row == 0) rests(own.back(), -1, -kHalf, kHalf);
      for (int k = 0; row > 0 && k < (pyramid ? 2 : 1); ++k)
        rests(own.back(), below[i + k], pyramid && k == 1 ? 0 : -kHalf, pyramid && k == 0 ? 0 : kHalf);
      if (i > 0 && r.chance(0.3)) rests(own.back(), own[i - 1], -kHalf, -kHalf);
    }
    below = own;
  }
}

Case Makes::make() {
  Case c;
  const int trees = has("multi") || has("pairs") || has("mixed") ? 1 + r.below(3) : 1;
  if (has("herd"))
    herd(c);
  else if (has("pile"))
    pile(c);
  else
    for (int k = 0; k < trees; ++k) c.trees.push_back(tree(1 + r.below(trees > 1 ? 4 : 5)));
  if (r.chance(0.3)) c.gravity = r.vector(9.81);
  if (has("gravity")) c.gravity = scaled(c.gravity, r.power(2, 8));
  if (has("weightless")) c.gravity = {};
  const int holds = has("herd") || has("pile") ? r.below(2) : has("many") ? 4 + r.below(5) : 1 + r.below(3);
  for (int k = 0; k < holds; ++k) {
    c.holds.push_back(hold(c));
    if ((has("redundant") || has("near")) && r.chance(0.8)) c.holds.push_back(copy_of(c.holds.back()));
  }
  if (has("damping")) c.damping = r.of(std::vector<double>{1e-14, 1e-12, 1e-9, 1e-6, 1e-3, 1});
  for (int n = has("push") ? 1 + r.below(3) : 0; n > 0; --n) c.wrenches.push_back(push(c));
  for (int n = !has("spring") ? 0 : has("herd") ? r.below(3) : 1 + r.below(3); n > 0; --n)
    c.springs.push_back(spring(c));
  drop_refused(c);
  if (has("units"))
    rescale(c, r.of(std::vector<double>{1e-3, 1e3, 1e-6, 1e6}), r.of(std::vector<double>{1e-3, 1, 1e3}), false);
  if (has("mixed")) rescale(c, r.of(std::vector<double>{1e-3, 1e-4, 1e3}), 1, true);
  if (!has("drift")) place_where_they_are(c);
  return c;
}

std::uint64_t mixed(std::uint64_t seed) {  // splitmix64: seeds that are neighbours give unrelated numbers
  seed += 0x9e3779b97f4a7c15u;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
  return seed ^ (seed >> 31);
}

}  // namespace

Case random_case(std::uint64_t seed, const std::vector<std::string>& dimensions) {
  Makes makes{Random(mixed(seed)), {dimensions.begin(), dimensions.end()}};
  Case c = makes.make();
  c.name = "seed " + std::to_string(seed) + ":";
  for (const std::string& d : dimensions) c.name += " " + d;
  return c;
}

std::vector<std::string> draw_dimensions(std::uint64_t seed, const std::vector<std::string>& from) {
  Random r(mixed(~seed));
  std::set<std::string> drawn;
  for (int n = r.below(4); n > 0 && !from.empty(); --n) drawn.insert(r.of(from));
  return {drawn.begin(), drawn.end()};
}

Case random_posture(std::uint64_t seed, const Tree& robot, const std::vector<std::string>& frames, int rows,
                    double velocity) {
  Random r(mixed(seed));
  Case c;
  c.name = robot.urdf + " seed " + std::to_string(seed) + " rows " + std::to_string(rows);
  c.trees = {robot};
  Tree& t = c.trees[0];
  for (const Link& l : t.links) {
    if (!l.moves()) continue;
    for (int k = 0; k < nq_of(l.kind); ++k) t.q[l.iq + k] = r.normal(0.3);
    if (l.kind != Kind::kFloating) continue;
    const std::array<double, 4> turned = {r.normal(0.2), r.normal(0.2), r.normal(0.2), 1};
    const double n = std::hypot(std::hypot(turned[0], turned[1]), std::hypot(turned[2], turned[3]));
    for (int k = 0; k < 4; ++k) t.q[l.iq + 3 + k] = turned[k] / n;
  }
  for (double& x : t.v) x = r.normal(velocity);
  for (const std::string& frame : frames) {
    Hold h;
    h.rows = rows;
    const auto link = std::find_if(t.links.begin(), t.links.end(), [&](const Link& l) { return l.name == frame; });
    h.link = static_cast<int>(link - t.links.begin());
    if (link != t.links.end()) c.holds.push_back(h);
  }
  place_where_they_are(c);
  return c;
}

}  // namespace manycontact::attack
