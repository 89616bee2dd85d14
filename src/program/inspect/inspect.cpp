#include "inspect.hpp"

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
#include <malloc.h>
#define MANYCONTACT_HEAP
#endif

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "../command/command.hpp"
#include "../text/choice.hpp"
#include "../text/findings.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/advice.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"

namespace manycontact::cli {

const KktPattern& Inspection::pattern(std::size_t island) const {
  return *shape_of(data, island)->pattern(chosen_method(data, island).order);
}

std::string Inspection::name(const IslandKind& kind) const {
  std::vector<const Island*> islands;
  for (int i : kind.islands) islands.push_back(&solved_island(data, static_cast<std::size_t>(i)));
  return islands_name(file, islands);
}

namespace {

constexpr std::size_t kMostKinds = 8, kMostPairs = 24;

/// Returns the number of bytes in use on the heap, or 0 if the system does not report it.
double heap() {
#ifdef MANYCONTACT_HEAP
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
#else
  return 0;
#endif
}

std::string rank_text(const IslandRanks& ranks) { return ranks.known ? std::to_string(ranks.rank) : "?"; }

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

// Prints the predicted costs of the methods for an island's shape, relative to the cheapest of sparse-ldl and cholmod.
void print_costs(std::ostream& out, IslandShape& shape, const Options& options, const Choice& choice) {
  const PredictedCosts costs = predict_costs(shape);
  const double least = std::min({*std::ranges::min_element(costs.ldl), *std::ranges::min_element(costs.cholmod)});
  const auto relative = [least](double cost) { return number(cost / least); };
  if (is_deep(shape)) {  // the pattern of K is not computed for deep islands
    wrap(out,
         "the trees are too deep for a comparison of elimination orders: sparse-ldl costs " + relative(least) +
             " or more, sparse-bodies costs " + number(costs.bodies / (costs.terms + least)),
         4);
    wrap(out, "auto chooses " + why_chosen(choice, costs, options), 4);
    return;
  }
  Table table("order<|L: non-zeros|sparse-ldl|sparse-cholmod");
  for (Order order : kOrders) {
    const auto k = static_cast<std::size_t>(order);
    const double nonzeros = shape.counts(order).nonzeros + shape.island().size();
    table.add(
        {to_string(order), std::to_string(std::llround(nonzeros)), relative(costs.ldl[k]), relative(costs.cholmod[k])});
  }
  table.print(out, 4);
  wrap(out, "the method dense, which has no order, costs " + relative(costs.dense), 4);
  wrap(out, "auto chooses " + why_chosen(choice, costs, options), 4);
}

Inspection inspect_scene(const SceneFile& file) {
  const double before = heap();
  Inspection x{file, SceneData(file.scene), {}};
  (void)solve(file.scene, file.q, file.v, file.u, x.data);
  x.bytes = heap() - before;
  x.kinds = find_kinds(file.scene, x.data);
  return x;
}

void print_islands(std::ostream& out, const Inspection& x) {
  out << "\n"
         "Islands: robots coupled by contacts, one system each; rank of the constraint rows at the scene's q\n";
  Table table("islands|robots<34|velocities|rows|rank|K: n|non-zeros", kMostKinds, "kinds of island");
  for (const IslandKind& kind : x.kinds) {
    const Island& island = x.island(kind);
    table.add({std::to_string(kind.islands.size()), x.name(kind), std::to_string(island.nv), std::to_string(island.nc),
               rank_text(kind.ranks), std::to_string(solved_island(data_solved(x.data), x.first(kind)).size()),
               std::to_string(std::llround(nonzeros_of_K(*shape_of(x.data, x.first(kind)), x.file.scene.damping)))});
  }
  table.print(out);
  for (const IslandKind& kind : x.kinds)
    if (!kind.ranks.known)
      wrap(out, "the rank was not computed, because the island is too large", 2, x.name(kind) + ": ");
  const std::vector<std::string> off = inactive(x);
  if (!off.empty()) wrap(out, join(off), 2, "contacts not active: ");
}

void print_contact_groups(std::ostream& out, const Inspection& x) {
  const Scene& scene = x.file.scene;
  Table table("groups|between<22|and<22|contacts<22|types<14|rows|rank", kMostPairs, "kinds of group");
  for (const IslandKind& kind : x.kinds)
    for (const auto& alike : alike_pairs(scene, kind.ranks.pairs)) {
      const BodyPair& p = kind.ranks.pairs[alike.front()];
      table.add({std::to_string(alike.size() * kind.islands.size()), p.place_A, p.place_B,
                 contact_names(scene, p.contacts), types_of(scene, p.contacts), std::to_string(p.rows),
                 std::to_string(p.rank)});
    }
  if (table.empty()) return;
  out << "\nContact groups: all contacts between the same two bodies; of identical groups the first is shown\n";
  table.print(out);
}

void print_memory(std::ostream& out, const Inspection& x) {
  const Scene& scene = x.file.scene;
  double derivatives = 0;  // number of entries of [da; df] of all islands, with columns of q, v, u
  for (const IslandKind& kind : x.kinds) {
    const Island& island = x.island(kind);
    double columns = 2.0 * island.nv;
    for (int r : island.robots) columns += scene.robots[r].model->nu();
    derivatives += static_cast<double>(kind.islands.size()) * island.size() * columns * sizeof(double);
  }
  if (x.bytes <= 0 || scene.robots.empty()) return;
  const double robots = static_cast<double>(scene.robots.size());
  out << "\nMemory per robot: " << number(x.bytes / robots / 1e3) << " kB to solve, and "
      << number(derivatives / robots / 1e3) << " kB for all derivatives\n";
}

void print_costs(std::ostream& out, const Inspection& x) {
  if (x.kinds.empty()) return;
  out << "\nCost of one solve, predicted, relative to the cheapest sparse method; non-zeros of L in each order\n";
  for (std::size_t k = 0; k < x.kinds.size() && k < kMostKinds; ++k) {
    const IslandKind& kind = x.kinds[k];
    const std::size_t i = x.first(kind);
    if (k > 0) out << "\n";
    wrap(out, x.name(kind), 2);
    print_costs(out, *shape_of(x.data, i), x.data.options, chosen_method(x.data, i));
    wrap(out,
         "solve tries these methods until one is accurate: " + ways_of(scene_solved(x.file.scene, x.data), x.data, i),
         4);
    const std::string changed = why_changed(chosen_method(x.data, i), x.data.report.islands[i]);
    if (!changed.empty()) wrap(out, "at the scene's state, " + changed, 4);
  }
  print_more(out, x.kinds.size(), kMostKinds, "kinds of island");
}

void print_advice(std::ostream& out, const Inspection& x) {
  std::vector<std::string> advice = advise_on_contacts(x.file.scene, x.data, x.kinds);
  const std::vector<std::string> bodies = advise_on_bodies(x.file.scene, x.data);
  advice.insert(advice.end(), bodies.begin(), bodies.end());
  out << "\nAdvice\n";
  if (advice.empty()) out << "  none: all constraint rows are independent, and no robot can be omitted\n";
  for (const std::string& item : advice) wrap(out, item, 2, "- ");
}

}  // namespace

int run_inspect(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  check_files(arguments, {path}, {"--picture"});
  const SceneFile file = load_scene(path);
  check_files(arguments, file.files, {"--picture"});
  const auto picture = arguments.value("--picture");
  const Python python = picture ? find_python() : Python();
  if (picture && python.path.empty())
    throw std::runtime_error("--picture needs python3, which is not installed (Debian: python3)");
  const Inspection inspection = inspect_scene(file);
  if (picture) write_picture(inspection, python, *picture);
  if (is_standard_output(arguments, {"--picture"})) return kExitOk;
  print_heading(std::cout, file, inspection.data);
  print_notes(std::cout, file);
  print_joints(std::cout, file);
  print_contacts(std::cout, file);
  print_applied_forces(std::cout, file);
  print_islands(std::cout, inspection);
  print_contact_groups(std::cout, inspection);
  print_costs(std::cout, inspection);
  print_memory(std::cout, inspection);
  print_findings(std::cout, file.scene, find(file, inspection.data));
  print_advice(std::cout, inspection);
  return kExitOk;
}

}  // namespace manycontact::cli
