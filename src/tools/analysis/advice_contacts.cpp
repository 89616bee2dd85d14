#include <algorithm>
#include <stdexcept>

#include "manycontact/analysis/advice.hpp"
#include "manycontact/analysis/text.hpp"

namespace manycontact {

using text::count;
using text::join;

namespace {

constexpr std::size_t kMostItems = 40;

// Returns " (63 more identical islands)" for more = 63 and what = "island", or "" if `more` is 0.
std::string and_more(std::size_t more, const std::string& what) {
  return more == 0 ? "" : " (" + count(more, "more identical " + what) + ")";
}

struct Subject {  // the islands of one kind, represented by the first island of the kind
  const Scene& scene;
  const Island& island;
  const IslandKind& kind;
};

// Returns whether one of `contacts` has nearly dependent rows, so that advice on these contacts would be unreliable.
bool any_only_just(const IslandRanks& ranks, const std::vector<int>& contacts) {
  return std::ranges::any_of(ranks.lighter, [&](const Lighter& l) {
    return l.only_just > 0 && std::ranges::find(contacts, l.contact) != contacts.end();
  });
}

void advise_rows(const Subject& x, std::vector<std::string>& advice) {
  const IslandRanks& ranks = x.kind.ranks;
  if (!ranks.known || ranks.rank == x.island.nc) return;
  const RowSelection s = select_rows(x.scene, x.island, ranks);
  const long n = static_cast<long>(s.redundant.size());
  std::string text = "the " + std::to_string(x.island.nc) + " contact rows of " +
                     robot_names(x.scene, x.island.robots) + " have rank " + std::to_string(ranks.rank);
  if (n != x.island.nc - ranks.rank) {
    advice.push_back(text + "; rows are nearly dependent, so that the tolerance decides which rows are redundant");
    return;
  }
  text += "; " + count(n, "row") + (n == 1 ? " is" : " are") +
          " redundant, since the preceding rows impose the same constraint: " + join(s.redundant, kMostItems) +
          and_more(x.kind.islands.size() - 1, "island");
  advice.push_back(text);
  if (any_only_just(ranks, x.island.contacts)) return;  // nearly dependent rows make the advice unreliable
  text = "the remaining rows impose the same constraint: " + join(s.kept, kMostItems);
  if (!s.dropped.empty()) text += "; to be dropped: " + join(s.dropped, kMostItems);
  if (x.scene.damping > 0)
    text += " (the damping acts on every row, so that removing rows changes the solution in the order of the damping)";
  advice.push_back(text);
}

struct Replacement {  // a contact that could replace all contacts between two bodies
  std::string text;   // the advice; empty if there is none
  int rows = -1;      // number of rows after the replacement; -1: no single contact can replace the contacts
};

Replacement replacement(const Scene& scene, const BodyPair& p) {
  const std::string start =
      contact_names(scene, p.contacts) + ", " + count(p.rows, "row") + " of rank " + std::to_string(p.rank) + ": ";
  const std::string frame = "`" + p.place_A + "`" + (p.B.joint < 0 ? "" : " to `" + p.place_B + "`");
  switch (p.holds) {
    case Holds::kOneContact:
      return {start + "`" + scene.contacts[p.alone].name + "` alone imposes the same constraint",
              scene.contacts[p.alone].rows()};
    case Holds::kSixD:
      return {start + "one 6D contact on " + frame + " imposes the same constraint", 6};
    case Holds::kThreeD:
      return {start + "one 3D contact on " + frame + ", at their common point, imposes the same constraint", 3};
    case Holds::kLine:
      return {start +
              "points on a line constrain five motions, all but the rotation about the line, and no single "
              "contact type imposes this constraint"};
    case Holds::kEach:
      return {"", p.rows};
    case Holds::kFewerRows:
      break;
  }
  return {};
}

// Recommends one contact instead of all contacts between two bodies, and reports the number of rows that remain.
void advise_pairs(const Subject& x, std::vector<std::string>& advice) {
  const IslandRanks& ranks = x.kind.ranks;
  for (const auto& alike : alike_pairs(x.scene, ranks.pairs)) {
    const std::string text = replacement(x.scene, ranks.pairs[alike.front()]).text;
    if (!text.empty() && !any_only_just(ranks, ranks.pairs[alike.front()].contacts))
      advice.push_back(text + and_more(alike.size() * x.kind.islands.size() - 1, "group"));
  }
  if (!ranks.known || any_only_just(ranks, x.island.contacts)) return;
  int rows = 0, sum = 0;
  bool all = true;
  for (const BodyPair& p : ranks.pairs) {
    const int needed = replacement(x.scene, p).rows;
    all = all && needed >= 0;
    rows += needed;
    sum += p.rank;
  }
  if (all && rows == ranks.rank && rows < x.island.nc)
    advice.push_back("after this change, " + count(rows, "row") + " replace " + std::to_string(x.island.nc) +
                     ", and all are linearly independent");
  if (sum > ranks.rank)
    advice.push_back("the contact groups of " + robot_names(x.scene, x.island.robots) +
                     " are coupled through the robots: the ranks of the groups add up to " + std::to_string(sum) +
                     ", but the rank of all rows is " + std::to_string(ranks.rank));
}

void advise_lighter(const Subject& x, std::vector<std::string>& advice) {
  for (const Lighter& l : x.kind.ranks.lighter) {
    const Contact& contact = x.scene.contacts[l.contact];
    std::string text = contact.name + " (" + to_string(contact.type) + ", " + count(contact.rows(), "row") +
                       ") has rank " + std::to_string(l.rank) +
                       (l.only_just > 0 ? ", in addition to " + count(l.only_just, "nearly dependent row") : "") +
                       ": at this configuration the bodies cannot move in the other directions";
    if (l.rank == 0) text += ", and the contact imposes no constraint";
    if (!l.type.empty()) text += "; " + l.type + " at the same frame imposes the same constraint";
    advice.push_back(text + and_more(x.kind.islands.size() - 1, "island"));
  }
}

}  // namespace

std::vector<std::string> advise_on_contacts(const Scene& scene, const SceneData& data,
                                            const std::vector<IslandKind>& kinds) {
  if (data.serial == 0) throw std::logic_error("advise_on_contacts: there is no solution, call solve first");
  std::vector<std::string> advice;
  for (const IslandKind& kind : kinds) {
    const Subject subject{scene, solved_island(data, static_cast<std::size_t>(kind.islands.front())), kind};
    advise_rows(subject, advice);
    advise_pairs(subject, advice);
    advise_lighter(subject, advice);
  }
  return advice;
}

}  // namespace manycontact
