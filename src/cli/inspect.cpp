#include "inspect.hpp"

#include <iostream>
#include <map>

#include "command.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostKinds = 8, kMostPairs = 24;

int run_inspect(const Arguments& arguments) {
  const SceneFile file = load_scene(scene_operand(arguments));
  const Inspection inspection = inspect_scene(file);
  if (const auto picture = arguments.value("--picture")) write_picture(inspection, *picture);
  print_heading(std::cout, file, inspection.data);
  print_notes(std::cout, file, true);
  print_islands(std::cout, inspection);
  print_contact_groups(std::cout, inspection);
  print_costs(std::cout, inspection);
  print_advice(std::cout, inspection);
  return kExitOk;
}

std::string rank_text(const IslandRanks& ranks) { return ranks.known ? std::to_string(ranks.rank) : "?"; }

void print_more(std::ostream& out, std::size_t all, std::size_t shown, const std::string& what) {
  if (shown < all) out << "  ... and " << all - shown << " more " << what << "\n";
}

// Names of the contacts of a scene that are switched off.
std::vector<std::string> inactive(const Inspection& x) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < x.data.f_offset.size(); ++c)
    if (x.data.f_offset[c] < 0) names.push_back(x.file.scene.contacts[c].name);
  return names;
}

std::string types_of(const Scene& scene, const std::vector<int>& contacts) {
  std::map<std::string, int> counts;
  for (int c : contacts) ++counts[to_string(scene.contacts[c].type)];
  std::vector<std::string> parts;
  for (const auto& [type, n] : counts) parts.push_back((n > 1 ? std::to_string(n) + " x " : "") + type);
  return join(parts);
}

}  // namespace

std::string Inspection::name(const IslandKind& kind) const {
  std::vector<const Island*> islands;
  for (int i : kind.islands) islands.push_back(&data.islands[i].island);
  return islands_name(file, islands);
}

Inspection inspect_scene(const SceneFile& file) {
  Inspection x{file, SceneData(file.scene), {}};
  (void)solve(file.scene, file.q, file.v, file.u, x.data);
  std::map<std::vector<long>, std::size_t> seen;
  std::map<std::vector<long>, IslandCosts> costs;  // by shape
  for (std::size_t i = 0; i < x.data.islands.size(); ++i) {
    const IslandData& d = x.data.islands[i];
    const IslandReport& r = x.data.report.islands[i];
    IslandRanks ranks = find_ranks(file.scene, x.data, d);
    std::vector<long> key = shape_key(file.scene, d.island, d.support);
    if (!costs.contains(key)) costs.emplace(key, predict_costs(file.scene, d));
    const IslandCosts& cost = costs.at(key);
    const std::vector<long> rank_key = ranks.key();
    key.insert(key.end(), rank_key.begin(), rank_key.end());
    key.insert(key.end(), {long(r.status), long(r.method), long(r.reason), long(r.changed_order)});
    const auto [at, fresh] = seen.emplace(key, x.kinds.size());
    if (fresh) x.kinds.push_back({{}, std::move(ranks), cost});
    x.kinds[at->second].islands.push_back(static_cast<int>(i));
  }
  return x;
}

void print_islands(std::ostream& out, const Inspection& x) {
  out << "\nIslands: robots joined by contacts, one system each; rank of the contact rows at the scene's q\n";
  Table table({{"islands"}, {"robots", Table::kLeft, 34}, {"velocities"}, {"rows"}, {"rank"}, {"K: n"}, {"non-zeros"}});
  for (std::size_t k = 0; k < x.kinds.size() && k < kMostKinds; ++k) {
    const Island& island = x.island(x.kinds[k]).island;
    table.add({std::to_string(x.kinds[k].islands.size()), x.name(x.kinds[k]), std::to_string(island.nv),
               std::to_string(island.nc), rank_text(x.kinds[k].ranks), std::to_string(island.size()),
               std::to_string(x.kinds[k].costs.K_nonzeros)});
  }
  table.print(out);
  print_more(out, x.kinds.size(), kMostKinds, "kinds of island");
  for (const IslandKind& kind : x.kinds)
    if (!kind.ranks.known) wrap(out, "the rank was left out, the island is too large", 2, x.name(kind) + ": ");
  const std::vector<std::string> off = inactive(x);
  if (!off.empty()) wrap(out, join(off), 2, "contacts not active: ");
}

std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs) {
  const auto model = [&](const Body& b) { return b.robot < 0 ? nullptr : scene.robots[b.robot].model.get(); };
  std::map<std::vector<long>, std::size_t> seen;
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair& p = pairs[i];
    std::vector<long> key{
        reinterpret_cast<long>(model(p.A)), p.A.joint, reinterpret_cast<long>(model(p.B)), p.B.joint, p.rank,
        static_cast<long>(p.holds)};
    for (int c : p.contacts) key.push_back(static_cast<long>(scene.contacts[c].type));
    const auto [at, fresh] = seen.emplace(key, out.size());
    if (fresh) out.emplace_back();
    out[at->second].push_back(i);
  }
  return out;
}

void print_contact_groups(std::ostream& out, const Inspection& x) {
  const Scene& scene = x.file.scene;
  Table table({{"groups"},
               {"between", Table::kLeft, 22},
               {"and", Table::kLeft, 22},
               {"contacts", Table::kLeft, 22},
               {"types", Table::kLeft, 14},
               {"rows"},
               {"rank"}});
  std::size_t all = 0;
  for (const IslandKind& kind : x.kinds)
    for (const auto& alike : alike_pairs(scene, kind.ranks.pairs)) {
      const BodyPair& p = kind.ranks.pairs[alike.front()];
      if (++all > kMostPairs) continue;
      table.add({std::to_string(alike.size() * kind.islands.size()), frame_name(scene, p.A, p.point_A),
                 frame_name(scene, p.B, p.point_B), contact_names(scene, p.contacts), types_of(scene, p.contacts),
                 std::to_string(p.rows), std::to_string(p.rank)});
    }
  if (table.empty()) return;
  out << "\nContact groups: all contacts between the same two bodies; the first of those that are alike\n";
  table.print(out);
  print_more(out, all, kMostPairs, "kinds of group");
}

void print_costs(std::ostream& out, const Inspection& x) {
  if (x.kinds.empty()) return;
  out << "\nCost of one solve, predicted [us]; non-zeros of L in each order of elimination\n";
  for (std::size_t k = 0; k < x.kinds.size() && k < kMostKinds; ++k) {
    const IslandKind& kind = x.kinds[k];
    Table table({{"order", Table::kLeft}, {"L: non-zeros"}, {"sparse-ldl"}, {"sparse-cholmod"}});
    for (const OrderCost& o : kind.costs.orders)
      table.add({to_string(o.order), std::to_string(o.nonzeros), number(o.ldl), number(o.cholmod)});
    std::string others = "dense " + number(kind.costs.dense);
    if (kind.costs.supernodal) others = "sparse-supernodal " + number(*kind.costs.supernodal) + ", " + others;
    if (k > 0) out << "\n";
    wrap(out, x.name(kind), 2);
    table.print(out, 4);
    wrap(out, "in orders of their own: " + others, 4);
    const int i = kind.islands.front();
    wrap(out, "auto chooses " + why_chosen(x.data.options, x.data.islands[i], kind.costs), 4);
    const std::string changed = why_changed(x.data.islands[i], x.data.report.islands[i]);
    if (!changed.empty()) wrap(out, "at the scene's state " + changed, 4);
  }
  print_more(out, x.kinds.size(), kMostKinds, "kinds of island");
}

void print_advice(std::ostream& out, const Inspection& x) {
  std::vector<std::string> advice = contact_advice(x);
  const std::vector<std::string> bodies = body_advice(x);
  advice.insert(advice.end(), bodies.begin(), bodies.end());
  out << "\nAdvice\n";
  if (advice.empty()) out << "  none: every contact row counts, nothing stands idle\n";
  for (const std::string& item : advice) wrap(out, item, 2, "- ");
}

const Command& inspect_command() {
  static const Command command{
      "inspect",
      "SCENE",
      "What is modelled and what is not, islands, ranks of the contacts, predicted costs, advice.",
      {{"--picture", "FILE.svg", "also draw the patterns of K and of its factor L"}},
      "Exit status: 0; 2 bad usage or bad input.\n",
      run_inspect};
  return command;
}

}  // namespace manycontact::cli
