// Plans robots in SIMD batches: patterns, offsets and predicted cost, independent of the state.

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

#include "../../internal.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/kkt/choose.hpp"
#include "manycontact/kkt/costs.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "robots.hpp"

namespace manycontact::internal {

namespace {

// A robot with `contacts` on it alone and `joins`, which couple it to other robots. inner: pattern of K_r.
struct Block {
  const Scene& scene;
  int robot;
  std::span<const int> contacts, joins;
  std::shared_ptr<const KktPattern> inner;
};

std::shared_ptr<const lanes::BlockPlan> make_plan(const Block& block, Order order) {
  auto plan = std::make_shared<lanes::BlockPlan>();
  plan->scene.robots = {block.scene.robots[block.robot]};
  const auto on_first = [](Attachment at) {
    at.robot = std::min(at.robot, 0);
    return at;
  };
  for (int c : block.contacts) {
    Contact contact = block.scene.contacts[c];
    contact.A = on_first(contact.A), contact.B = on_first(contact.B);
    plan->scene.contacts.push_back(std::move(contact));
  }
  plan->alone = static_cast<int>(block.contacts.size());
  for (int c : block.joins) {
    Contact contact = block.scene.contacts[c];
    contact.A = on_first(end_on(contact, block.robot)), contact.B = {};
    plan->scene.contacts.push_back(std::move(contact));
  }
  plan->island = whole_scene(plan->scene, std::vector<char>(plan->scene.contacts.size(), 1));
  const IslandSupport support = island_support(plan->scene, plan->island);
  plan->supports = support.contacts;
  plan->pattern = plan->inner = block.inner;
  if (block.joins.empty()) return plan;
  std::vector<int> perm = block.inner->perm;
  for (int i = block.inner->size(); i < plan->island.size(); ++i) perm.push_back(i);
  KktPattern bordered = analyze(plan->scene, plan->island, support, natural_pattern(plan->scene, plan->island, support),
                                order, std::move(perm));
  sparse::relax_supernodes(block.inner->ldl, bordered.ldl);
  plan->pattern = std::make_shared<const KktPattern>(std::move(bordered));
  plan->bordered = sparse::compile_ldl(plan->pattern->K, plan->pattern->ldl, plan->rows());
  return plan;
}

double cost_ldl(int rows, double nonzeros, double flops) {
  return predicted_cost_ldl(rows, {.nonzeros = nonzeros, .flops = flops});
}
double cost_ldl(const sparse::LdlSymbolic& L) { return cost_ldl(L.n, L.nonzeros(), L.flops); }

// Returns the group with the block's structure, joint friction, types and joints of contacts, and elimination order.
BlockGroup& group_of(Workspace& w, const Block& block, Order order) {
  const Scene& scene = block.scene;
  const Model& model = *scene.robots[block.robot].model;
  std::vector<int> key{static_cast<int>(order), has_friction(model), static_cast<int>(block.contacts.size())};
  for (int c : block.contacts) {
    const Contact& contact = scene.contacts[c];
    key.insert(key.end(), {kind_of(contact), contact.A.joint, moves(contact.B) ? contact.B.joint : -1});
  }
  for (int c : block.joins) {
    const Contact& contact = scene.contacts[c];
    key.insert(key.end(), {kind_of(contact), end_on(contact, block.robot).joint});
  }
  key.insert(key.end(), block.inner->perm.begin(), block.inner->perm.end());
  BlockGroup& group = w.lanes.groups[{model.structure.get(), std::move(key)}];
  if (group.plan) return group;
  group.plan = make_plan(block, order);
  const Scene& own = group.plan->scene;
  group.seconds = costs::kPredictedSecond * (predicted_cost_of_terms(group.plan->pattern->size(), own.contacts.size()) +
                                             cost_ldl(group.plan->pattern->ldl));
  return group;
}

// Creates the group's kernels for batches of up to `count` robots.
void make_kernels(Workspace& w, BlockGroup& group, std::size_t count) {
  const auto make = [&](auto& kernels, auto of_level) {
    if (kernels.size() < w.threads.size()) kernels.resize(w.threads.size());
    for (auto& kernel : kernels) kernel.make(count, *w.lanes.level, of_level);
  };
  make(group.kernels, [&](const lanes::Level& level) { return level.make(group.plan); });
  // No single precision with pairs: the test for their inconsistency assumes rounding errors of doubles.
  const auto is_pair = [](const Contact& c) { return c.pair != nullptr; };
  if (w.options.precision == Precision::kSingle && std::ranges::none_of(group.plan->scene.contacts, is_pair))
    make(group.single, [&](const lanes::Level& level) { return level.single.make(group.plan); });
}

// Returns the group of a single-robot island; nullptr if SIMD batches cannot solve it, e.g. because it is too large.
BlockGroup* group_of_alone(Workspace& w, const IslandWork& d) {
  if (d.choice.method != Method::kSparseLdl || d.island.nv == 0 || d.island.size() > kLargestInLanes) return nullptr;
  const std::shared_ptr<const KktPattern>& pattern = d.shape->pattern(d.choice.order);
  if (!pattern->schedule().compiled()) return nullptr;
  return &group_of(w, {d.shape->scene(), 0, d.shape->island().contacts, {}, pattern}, d.choice.order);
}

bool can_be_joined(const IslandWork& d, const Options& options) {
  return !options.order && d.choice.method == Method::kSparseLdl &&
         std::all_of(d.shape->scene().robots.begin(), d.shape->scene().robots.end(),
                     [](const Robot& robot) { return robot.model->nv <= kLargestInLanes; });
}

bool before(const Contact& x, const Contact& y) {  // an order in which contacts for one SIMD batch are adjacent
  const auto numbers = [](const Contact& c) {
    return std::array<double, 6>{
        static_cast<double>(c.reference_frame), c.alpha, c.beta, c.axis[0], c.axis[1], c.axis[2]};
  };
  const auto a = numbers(x), b = numbers(y);
  return std::memcmp(a.data(), b.data(), sizeof a) < 0;  // bitwise, which also orders NaN
}

InterfaceContactGroup& group_of(const Scene& scene, Workspace& w, int c) {
  const Contact& contact = scene.contacts[c];
  const auto structure = [&](const Attachment& at) { return scene.robots[at.robot].model->structure.get(); };
  InterfaceContactGroup& group =
      w.lanes
          .contacts[{structure(contact.A), structure(contact.B), kind_of(contact), contact.A.joint, contact.B.joint}];
  if (group.kernels.size() >= w.threads.size() && group.kernels.back().batch) return group;
  const ContactSupport support = contact_support(scene, contact);
  group.kernels.resize(w.threads.size());
  for (auto& kernel : group.kernels)
    kernel.make(w.lanes.level->robots.width, *w.lanes.level,
                [&](const lanes::Level& level) { return level.make_contacts(scene, contact, support); });
  return group;
}

double cost_joined(const RobotsSystem& system, int width) {
  double cost = cost_ldl(system.interface->rows(), system.interface->schedule.nonzeros(), system.interface->flops);
  for (std::size_t k = 0; k < system.order.size();) {
    const BlockGroup* group = system.robots[system.order[k]].group;
    std::size_t count = 1;
    while (count < static_cast<std::size_t>(width) && k + count < system.order.size() &&
           system.robots[system.order[k + count]].group == group)
      ++count;
    cost += (count == 1 ? 1 : together(width)) * cost_ldl(group->plan->pattern->ldl);
    k += count;
  }
  return cost;
}

double seconds_joined(const RobotsSystem& system, int width) {
  double seconds = costs::kPredictedSecond * cost_joined(system, width);
  const double of_one = together(width) / width;
  for (const RobotsSystem::OfRobot& r : system.robots) {
    const lanes::BlockPlan& plan = *r.group->plan;
    seconds +=
        costs::kPredictedSecond * of_one * predicted_cost_of_terms(plan.pattern->size(), plan.scene.contacts.size());
  }
  return seconds;
}

double cost_of_choice(const IslandWork& d) {  // predicted cost of factorizing the island's whole K
  return predicted_cost_ldl(d.shape->island().size(), d.shape->counts(d.choice.order));
}

// Whether solving robot by robot may be cheaper than factorizing K; a quick test without the pattern of S.
bool may_be_cheaper(const IslandWork& d) {
  int rows = 0;
  for (const Contact& contact : d.shape->scene().contacts)
    if (joins_two(contact)) rows += contact.rows();
  return d.choice.method == Method::kSparseLdl &&
         predicted_cost_ldl(rows, least_interface_counts(*d.shape)) < tolerance::kCheaper * cost_of_choice(d);
}

// Returns an island that consists of one robot of the shape's scene and of the contacts on this robot alone.
Island alone(const IslandShape& shape, const Interface& interface, std::size_t robot) {
  Island out;
  out.robots = {shape.island().robots[robot]};
  for (int c : interface.robots[robot].contacts) out.contacts.push_back(shape.island().contacts[c]);
  number_island(shape.scene(), out);
  return out;
}

// Returns nullptr if the island's robots or interface rows do not fit SIMD batches.
std::unique_ptr<RobotsSystem> join_robots(Workspace& w, IslandWork& d, Order order) {
  if (!can_be_joined(d, w.options)) return nullptr;
  auto out = std::make_unique<RobotsSystem>(d);
  out->within = order;
  out->interface = std::make_shared<const Interface>(*d.shape);
  const Interface& interface = *out->interface;
  bool fits = interface.schedule.compiled();
  for (std::size_t k = 0; k < d.island.robots.size() && fits; ++k) {
    const Interface::OfRobot& r = interface.robots[k];
    const std::shared_ptr<const KktPattern> inner =
        w.shapes.find(d.shape->scene(), alone(*d.shape, interface, k))->pattern(order);
    BlockGroup& group = group_of(w, {d.shape->scene(), static_cast<int>(k), r.contacts, r.joins, inner}, order);
    fits = group.plan->schedule().compiled() && inner->schedule().compiled() &&
           group.plan->pattern->size() <= kLargestInLanes;
    out->robots.push_back({&group});
    out->order.push_back(static_cast<int>(k));
  }
  d.joinable = fits;
  if (!fits) return nullptr;
  std::sort(out->order.begin(), out->order.end(), [&out](int x, int y) {
    const BlockGroup *a = out->robots[x].group, *b = out->robots[y].group;
    return std::less<>()(a, b) || (a == b && x < y);
  });
  for (std::size_t k = 0; k < out->robots.size(); ++k) out->robots[out->order[k]].member = static_cast<int>(k);
  out->seconds = seconds_joined(*out, w.lanes.level->robots.width);
  out->solves = d.choice.method == Method::kSparseLdl &&
                cost_joined(*out, w.lanes.level->robots.width) < tolerance::kCheaper * cost_of_choice(d);
  return out;
}

// Plans the robots in the chosen elimination order. Replaces contacts-early by leaf-to-root if this is predicted
// cheaper than factorizing K, too: entries of factors then grow less, so that derivatives robot by robot are accurate,
// in a quarter of the time of those by K. For hubs, i.e. robots coupled by more rows than they have coordinates, this
// does not pay.
std::unique_ptr<RobotsSystem> join_robots(Workspace& w, IslandWork& d) {
  std::unique_ptr<RobotsSystem> robots = join_robots(w, d, d.choice.order);
  if (!robots || !robots->solves || d.choice.order != Order::kContactsEarly) return robots;
  for (std::size_t k = 0; k < robots->robots.size(); ++k)
    if (static_cast<int>(robots->interface->robots[k].interface_rows.size()) > d.shape->scene().robots[k].model->nv)
      return robots;
  std::unique_ptr<RobotsSystem> other = join_robots(w, d, Order::kLeafToRoot);
  d.joinable = true;
  return other && other->solves ? std::move(other) : std::move(robots);
}

void take_memory(RobotsSystem& system) {
  const std::size_t rows = system.interface->row.size(), robots = system.robots.size();
  system.Sx.resize(system.interface->S.nonzeros());
  system.L.resize(system.interface->schedule.nonzeros());
  for (std::vector<double>* x :
       {&system.D, &system.terms, &system.b, &system.y, &system.r, &system.scale, &system.step})
    x->resize(rows);
  system.members.resize(robots);
  system.batches.reserve(robots);
  system.contact_batches.reserve(rows);
}

// Assigns the scene's contacts to the island's couplings and robots.
void bind_island(const Scene& scene, Workspace& w, const IslandWork& d, RobotsSystem& system) {
  const Interface& interface = *system.interface;
  const auto among = [&](int robot, std::size_t contact) {
    const std::vector<int>& joins = interface.robots[robot].joins;
    return static_cast<int>(std::find(joins.begin(), joins.end(), static_cast<int>(contact)) - joins.begin());
  };
  system.contacts.clear();
  for (std::size_t c = 0, row = 0; c < d.island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[d.island.contacts[c]];
    if (!joins_two(contact)) continue;
    const int a = local_robot(d.island, contact.A.robot), b = local_robot(d.island, contact.B.robot);
    system.contacts.push_back({&group_of(scene, w, d.island.contacts[c]), d.island.contacts[c], static_cast<int>(c),
                               static_cast<int>(row), contact.rows(), a, b, among(a, c), among(b, c), 0, 0});
    row += contact.rows();
  }
  for (std::size_t k = 0; k < system.robots.size(); ++k) {
    system.robots[k].contacts.clear();
    for (int c : interface.robots[k].contacts) system.robots[k].contacts.push_back(d.island.contacts[c]);
  }
  std::sort(system.contacts.begin(), system.contacts.end(), [&](const auto& x, const auto& y) {
    if (x.group != y.group) return std::less<>()(x.group, y.group);
    const Contact &c = scene.contacts[x.contact], &e = scene.contacts[y.contact];
    return before(c, e) || (x.contact < y.contact && !before(e, c));
  });
  for (std::size_t k = 0; k < system.robots.size(); ++k)
    system.robots[k].couplings.resize(interface.robots[k].joins.size());
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const RobotsSystem::Coupling& coupling = system.contacts[i];
    system.robots[coupling.A].couplings[coupling.among_A] = system.robots[coupling.B].couplings[coupling.among_B] =
        static_cast<int>(i);
  }
}

void use_robots(const Scene& scene, Workspace& w, IslandWork& d, std::unique_ptr<RobotsSystem> system) {
  if (system) {
    for (const RobotsSystem::OfRobot& r : system->robots) make_kernels(w, *r.group, w.lanes.level->robots.width);
    take_memory(*system);
    bind_island(scene, w, d, *system);
  }
  d.robots = std::move(system);
}

}  // namespace

void forget_unused_groups(Workspace& w) {
  std::set<const BlockGroup*> used;
  const auto keep = [&used](const IslandWork& d) {
    used.insert(d.alone.group);
    if (!d.robots) return;
    for (const RobotsSystem::OfRobot& r : d.robots->robots) used.insert(r.group);
  };
  for (const auto& d : w.islands) keep(*d);
  w.pool.each(keep);
  std::erase_if(w.lanes.groups, [&used](const auto& item) { return !used.contains(&item.second); });
}

void plan_robots(const Scene& scene, Workspace& w, IslandWork& d) {
  if (!w.lanes.level) return;
  if (d.island.robots.size() == 1) {
    d.alone.group = group_of_alone(w, d);
  } else if (may_be_cheaper(d)) {
    std::unique_ptr<RobotsSystem> robots = join_robots(w, d);
    if (robots && robots->solves) use_robots(scene, w, d, std::move(robots));
  }
}

void bind_robots(const Scene& scene, Workspace& w, IslandWork& d) {
  if (d.robots) bind_island(scene, w, d, *d.robots);
}

int batch_width(const Workspace& w) {
  if (!w.lanes.level) return 1;
  return w.options.precision == Precision::kSingle ? w.lanes.level->robots.single.width : w.lanes.level->robots.width;
}

void group_robots_alone(Workspace& w) {
  InLanes& in = w.lanes;
  for (auto& [key, group] : in.groups) group.islands.clear();
  if (!in.level) return;
  in.islands.reserve(w.islands.size());
  in.robots.reserve(w.islands.size());
  in.batches.reserve(w.islands.size());
  for (ThreadWork& thread : w.threads) {
    thread.answers.resize(batch_width(w));
    thread.panels.reserve(in.level->robots.width);
    thread.interface_contacts.reserve(in.level->robots.width);
    thread.interface_derivatives.reserve(in.level->robots.width);
  }
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    BlockGroup* group = w.islands[i]->alone.group;
    if (!group) continue;
    group->islands.push_back(static_cast<int>(i));
    make_kernels(w, *group, group->islands.size());
  }
}

void make_robots(const Scene& scene, Workspace& w, IslandWork& d) {
  if (w.lanes.level && !d.robots && d.joinable && d.island.robots.size() > 1)
    use_robots(scene, w, d, join_robots(w, d));
}

}  // namespace manycontact::internal
