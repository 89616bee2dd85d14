// What is known of an island cut into robots before any number is: patterns, places, predicted cost.

#include "cut.hpp"

#include <algorithm>

#include "manycontact/kkt/choose.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"

namespace manycontact::internal {

namespace {

constexpr int kLargestCut = 400;  // rows of a robot's K: as of those that stand in lanes

// Of robot k of a shape's scene.
std::shared_ptr<const lanes::CutRobot> cut_robot(const IslandShape& shape, const Joining& joining, std::size_t k,
                                                 const std::vector<int>& order_alone, Order order) {
  const Scene& scene = shape.scene();
  const Joining::OfRobot& r = joining.robots[k];
  auto cut = std::make_shared<lanes::CutRobot>();
  cut->scene.robots = {scene.robots[k]};
  const auto on_first = [](Attachment at) {
    at.robot = std::min(at.robot, 0);
    return at;
  };
  for (int c : r.contacts) {
    Contact contact = scene.contacts[c];
    contact.A = on_first(contact.A), contact.B = on_first(contact.B);
    cut->scene.contacts.push_back(std::move(contact));
  }
  for (int c : r.joins) {
    Contact contact = scene.contacts[c];
    contact.A = on_first(end_on(contact, static_cast<int>(k))), contact.B = {};
    cut->scene.contacts.push_back(std::move(contact));
  }
  cut->alone = static_cast<int>(r.contacts.size());
  cut->border = static_cast<int>(r.joining.size());
  cut->island = whole_scene(cut->scene, std::vector<char>(cut->scene.contacts.size(), 1));
  const IslandSupport support = island_support(cut->scene, cut->island);
  std::vector<int> perm = order_alone;
  for (int i = cut->island.size() - cut->border; i < cut->island.size(); ++i) perm.push_back(i);
  cut->pattern = analyze(cut->scene, cut->island, support, order, std::move(perm));
  cut->schedule = sparse::compile_ldl(cut->pattern.K, cut->pattern.ldl, cut->rows());
  cut->supports = support.contacts;
  return cut;
}

// What the pattern of robot k depends on: its model, its contacts' types and joints, and the order of elimination.
CutGroup& group_of(Workspace& w, IslandWork& d, const Joining& joining, std::size_t k) {
  const Scene& scene = d.shape->scene();
  const Order order = d.choice.order;
  const std::vector<int>& perm = w.shapes.find(scene, alone(*d.shape, joining, k))->pattern(order)->perm;
  std::vector<int> key{static_cast<int>(order), static_cast<int>(joining.robots[k].contacts.size())};
  for (int c : joining.robots[k].contacts) {
    const Contact& contact = scene.contacts[c];
    key.insert(key.end(),
               {static_cast<int>(contact.type), contact.A.joint, contact.B.robot < 0 ? -1 : contact.B.joint});
  }
  for (int c : joining.robots[k].joins) {
    const Contact& contact = scene.contacts[c];
    key.insert(key.end(), {static_cast<int>(contact.type), end_on(contact, static_cast<int>(k)).joint});
  }
  key.insert(key.end(), perm.begin(), perm.end());
  CutGroup& group = w.cut_groups[{scene.robots[k].model.get(), std::move(key)}];
  if (!group.robot) group.robot = cut_robot(*d.shape, joining, k, perm, order);
  return group;
}

bool can_be_cut(const Scene& scene, const IslandWork& d, const Options& options) {
  return d.terms_in_lanes && !options.order && d.choice.method == Method::kSparseLdl &&
         std::all_of(d.island.contacts.begin(), d.island.contacts.end(),
                     [&](int c) { return lanes::moves_at_both_ends(scene.contacts[c]); });
}

// As predicted_cost_ldl. Robots side by side cost as much as `together` of them alone (measured, on 8 lanes and on 2).
double cost_cut(const CutIsland& cut, int width) {
  const double together = 1 + 0.15 * width;
  double cost = 17.0 * cut.joining->rows() + 7.0 * cut.joining->symbolic.nonzeros() + cut.joining->symbolic.flops;
  for (std::size_t k = 0; k < cut.order.size();) {
    const CutGroup* group = cut.robots[cut.order[k]].group;
    std::size_t count = 1;
    while (count < static_cast<std::size_t>(width) && k + count < cut.order.size() &&
           cut.robots[cut.order[k + count]].group == group)
      ++count;
    cost += (count == 1 ? 1 : together) * predicted_cost_ldl(group->robot->pattern);
    k += count;
  }
  return cost;
}

std::unique_ptr<CutIsland> cut_island(const Scene& scene, Workspace& w, IslandWork& d) {
  if (!can_be_cut(scene, d, w.options)) return nullptr;
  auto cut = std::make_unique<CutIsland>();
  cut->joining = joining_of(d);
  bool fits = cut->joining->schedule.compiled;
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    CutGroup& group = group_of(w, d, *cut->joining, k);
    fits = fits && group.robot->schedule.compiled && group.robot->pattern.size() <= kLargestCut;
    cut->robots.push_back({&group, {}, 0});
    cut->order.push_back(static_cast<int>(k));
  }
  std::stable_sort(cut->order.begin(), cut->order.end(),
                   [&](int x, int y) { return std::less<>()(cut->robots[x].group, cut->robots[y].group); });
  const double cost = predicted_cost_ldl(*d.shape->pattern(d.choice.order));
  if (!fits || !(cost_cut(*cut, w.lanes.level->width) < tolerance::kCheaper * cost)) return nullptr;
  return cut;
}

void take_memory(CutIsland& cut) {
  const std::size_t rows = cut.joining->row.size(), robots = cut.robots.size();
  cut.Sx.resize(cut.joining->S.nonzeros());
  cut.L.resize(cut.joining->symbolic.nonzeros());
  for (std::vector<double>* x : {&cut.D, &cut.terms, &cut.b, &cut.y, &cut.r, &cut.scale, &cut.step}) x->resize(rows);
  cut.members.resize(robots);
  for (std::size_t k = 0; k < robots; ++k) cut.robots[cut.order[k]].member = static_cast<int>(k);
  cut.batches.reserve(robots);
  cut.contact_batches.reserve(cut.joining->row.size());
}

// Where a contact of the island stands among a robot's joins.
std::size_t place_among(const Joining& joining, const CutIsland& cut, int robot, std::size_t contact) {
  const lanes::CutRobot& of = *cut.robots[robot].group->robot;
  std::size_t at = 0;
  for (std::size_t k = 0; joining.robots[robot].joins[k] != static_cast<int>(contact); ++k)
    at += lanes::ContactTerms::JoinedEnd::size(of.supports[of.alone + k].a.size());
  return at;
}

// Which of the scene's contacts they are.
void settle_cut(const Scene& scene, Workspace& w, const IslandWork& d, CutIsland& cut) {
  const Joining& joining = *cut.joining;
  cut.contacts.clear();
  for (std::size_t c = 0, row = 0; c < d.island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[d.island.contacts[c]];
    if (!joins_two(contact)) continue;
    const int a = local_robot(d.island, contact.A.robot), b = local_robot(d.island, contact.B.robot);
    cut.contacts.push_back({&lanes::group_of(scene, w, d.island.contacts[c]), d.island.contacts[c],
                            static_cast<int>(row), contact.rows(), a, b, place_among(joining, cut, a, c),
                            place_among(joining, cut, b, c), 0, 0});
    row += contact.rows();
  }
  for (std::size_t k = 0; k < cut.robots.size(); ++k) {
    cut.robots[k].contacts.clear();
    for (int c : joining.robots[k].contacts) cut.robots[k].contacts.push_back(d.island.contacts[c]);
  }
  std::sort(cut.contacts.begin(), cut.contacts.end(), [&](const auto& x, const auto& y) {
    if (x.group != y.group) return std::less<>()(x.group, y.group);
    const Contact &c = scene.contacts[x.contact], &e = scene.contacts[y.contact];
    return lanes::before(c, e) || (x.contact < y.contact && !lanes::before(e, c));
  });
}

void make_kernels(Workspace& w, CutIsland& cut) {
  for (const CutIsland::OfRobot& r : cut.robots) {
    while (r.group->kernels.size() < w.threads.size()) {
      std::unique_ptr<lanes::CutRobots> kernel = w.lanes.level->make_cut(r.group->robot);
      kernel->widen();
      r.group->kernels.push_back(std::move(kernel));
    }
  }
}

}  // namespace

void prepare_cut(const Scene& scene, Workspace& w) {
  if (!w.lanes.level) return;
  for (const std::unique_ptr<IslandWork>& d : w.islands) {
    if (d->island.robots.size() < 2) continue;
    if (!d->cut_considered) {
      d->cut = cut_island(scene, w, *d);
      if (d->cut) {
        make_kernels(w, *d->cut);
        take_memory(*d->cut);
      }
      d->cut_considered = true;
    }
    if (d->cut) settle_cut(scene, w, *d, *d->cut);
  }
}

}  // namespace manycontact::internal
