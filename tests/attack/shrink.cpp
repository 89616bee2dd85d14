#include "shrink.hpp"

#include <algorithm>

namespace manycontact::attack {

namespace {

double one_digit(double x) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", x);
  return std::atof(text);
}

// Removes the last link if nothing is attached to it.
bool drop_last_link(Case& c, int tree) {
  Tree& t = c.trees[tree];
  const int last = static_cast<int>(t.links.size()) - 1;
  if (last == 0 || !t.urdf.empty()) return false;
  for (const Hold& h : c.holds)
    if ((h.tree == tree && h.link == last) || (h.to_tree == tree && h.to_link == last)) return false;
  for (const ExternalWrench& p : c.wrenches)
    if (p.tree == tree && p.link == last) return false;
  for (const Spring& s : c.springs)
    if ((s.tree == tree && s.link == last) || (s.to_tree == tree && s.to_link == last)) return false;
  if (t.links[last].reversed) return false;  // the file's root
  if (const Link& l = t.links[last]; l.moves()) {
    const auto cut = [](std::vector<double>& x, int first, int count) {
      x.erase(x.begin() + first, x.begin() + first + count);
    };
    cut(t.q, l.iq, nq_of(l.kind)), cut(t.v, l.iv, nv_of(l.kind)), cut(t.u, l.iv - t.free(), nv_of(l.kind));
  }
  t.links.pop_back();
  number_coordinates(t);
  return true;
}

// Removes the last robot if nothing else refers to it.
bool drop_last_tree(Case& c) {
  const int last = static_cast<int>(c.trees.size()) - 1;
  const auto is_on = [last](const auto& x) { return x.tree == last || x.to_tree == last; };
  if (last == 0 || std::any_of(c.holds.begin(), c.holds.end(), is_on) ||
      std::any_of(c.springs.begin(), c.springs.end(), is_on) ||
      std::any_of(c.wrenches.begin(), c.wrenches.end(), [last](const ExternalWrench& p) { return p.tree == last; }))
    return false;
  c.trees.pop_back();
  return true;
}

}  // namespace

std::vector<Case> smaller_cases(const Case& c) {
  std::vector<Case> list;
  const auto with = [&](auto&& change) {
    Case smaller = c;
    if (change(smaller)) list.push_back(std::move(smaller));
  };
  const auto put = [](auto& to, const auto& value) {
    if (to == value) return false;
    to = value;
    return true;
  };
  for (std::size_t k = 0; k < c.holds.size(); ++k) {
    with([&](Case& s) { return s.holds.erase(s.holds.begin() + static_cast<std::ptrdiff_t>(k)), true; });
    with([&](Case& s) { return put(s.holds[k].alpha, 0.0) + put(s.holds[k].beta, 0.0) > 0; });
    with([&](Case& s) { return put(s.holds[k].offset, Numbers{}); });
    with([&](Case& s) { return put(s.holds[k].turned, std::array<double, 4>{0, 0, 0, 1}); });
    with([&](Case& s) { return put(s.holds[k].frame, std::string("local")); });
    with([&](Case& s) { return put(s.holds[k].axis, Numbers{0, 0, 1}); });
    for (int rows : {1, 2, 3, 5}) with([&](Case& s) { return rows < s.holds[k].rows && put(s.holds[k].rows, rows); });
  }
  for (std::size_t k = 0; k < c.wrenches.size(); ++k) {
    with([&](Case& s) { return s.wrenches.erase(s.wrenches.begin() + static_cast<std::ptrdiff_t>(k)), true; });
    with([&](Case& s) { return put(s.wrenches[k].offset, Numbers{}); });
    with([&](Case& s) { return put(s.wrenches[k].force, Numbers{}); });
    with([&](Case& s) { return put(s.wrenches[k].torque, Numbers{}); });
  }
  for (std::size_t k = 0; k < c.springs.size(); ++k) {
    with([&](Case& s) { return s.springs.erase(s.springs.begin() + static_cast<std::ptrdiff_t>(k)), true; });
    with([&](Case& s) { return put(s.springs[k].offset, Numbers{}); });
    with([&](Case& s) { return put(s.springs[k].damping, 0.0); });
    with([&](Case& s) { return put(s.springs[k].length, 0.0); });
  }
  with([](Case& s) { return drop_last_tree(s); });
  for (std::size_t k = 0; k < c.trees.size(); ++k) {
    with([&](Case& s) { return drop_last_link(s, static_cast<int>(k)); });
    with([&](Case& s) { return put(s.trees[k].v, std::vector<double>(c.trees[k].v.size(), 0.0)); });
    with([&](Case& s) { return put(s.trees[k].u, std::vector<double>(c.trees[k].u.size(), 0.0)); });
    with([&](Case& s) { return put(s.trees[k].rpy, Numbers{}) + put(s.trees[k].xyz, Numbers{}) > 0; });
    for (std::size_t i = 0; i < c.trees[k].links.size() && c.trees[k].urdf.empty(); ++i) {
      with([&](Case& s) { return put(s.trees[k].links[i].rpy, Numbers{}); });
      with([&](Case& s) { return put(s.trees[k].links[i].com_rpy, Numbers{}); });
      with([&](Case& s) { return put(s.trees[k].links[i].com, Numbers{}); });
      with([&](Case& s) { return put(s.trees[k].links[i].armature, 0.0); });
      with([&](Case& s) { return put(s.trees[k].links[i].stiffness, 0.0); });
      with([&](Case& s) { return put(s.trees[k].links[i].damping, 0.0); });
      with([&](Case& s) {
        bool changed = false;
        Link& l = s.trees[k].links[i];
        for (auto* x : {&l.xyz, &l.axis})
          for (double& e : *x) changed = put(e, one_digit(e)) || changed;
        return changed;
      });
      with([&](Case& s) {
        Link& l = s.trees[k].links[i];
        bool changed = put(l.mass, one_digit(l.mass));
        for (double& e : l.inertia) changed = put(e, one_digit(e)) || changed;
        return changed;
      });
    }
  }
  with([&](Case& s) { return put(s.gravity, Numbers{0, 0, -9.81}); });
  return list;
}

}  // namespace manycontact::attack
