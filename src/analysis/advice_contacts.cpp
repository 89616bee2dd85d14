// Advice on contacts: only what follows from ranks at the scene's configuration.

#include <algorithm>

#include "inspect.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostNames = 40;

// " (63 more islands alike)", empty when there is none.
std::string and_more(std::size_t more, const std::string& what) {
  return more == 0 ? "" : " (" + count(static_cast<long>(more), what) + " more alike)";
}

// What is left of a contact when only some of its rows are kept.
std::string kept_as(const Contact& contact, const std::vector<int>& rows) {
  std::vector<std::string> names;
  for (int r : rows) names.push_back(contact.name + "[" + std::to_string(r) + "]");
  const bool linear = contact.type == ContactType::k3D || contact.type == ContactType::k6D;
  if (linear && rows.size() == 1 && rows[0] < 3) return contact.name + " as 1d along " + "xyz"[rows[0]];
  if (contact.type == ContactType::k2D) return contact.name + " as 1d along " + (rows[0] == 0 ? "x" : "z");
  if (linear && rows == std::vector<int>{0, 2}) return contact.name + " as 2d (x and z)";
  if (linear && rows == std::vector<int>{0, 1, 2}) return contact.name + " as 3d";
  return join(names);
}

struct Selection {
  std::vector<std::string> redundant, kept, dropped;
};

// Rows kept in order while the rank grows.
Selection select(const Scene& scene, const Island& island, const std::vector<char>& redundant) {
  Selection s;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    std::vector<int> rows;
    for (int i = 0; i < contact.rows(); ++i)
      if (redundant[static_cast<std::size_t>(island.row_offset[c] + i)])
        s.redundant.push_back(contact.name + "[" + std::to_string(i) + "]");
      else
        rows.push_back(i);
    if (rows.empty())
      s.dropped.push_back(contact.name);
    else
      s.kept.push_back(static_cast<int>(rows.size()) == contact.rows() ? contact.name : kept_as(contact, rows));
  }
  return s;
}

// Redundant rows by name, and what is left without them.
void advise_rows(const Inspection& x, const IslandKind& kind, std::vector<std::string>& advice) {
  const Island& island = x.island(kind).island;
  if (!kind.ranks.known || kind.ranks.rank == island.nc) return;
  const Selection s = select(x.file.scene, island, kind.ranks.redundant);
  const long n = static_cast<long>(s.redundant.size());
  std::string text = "the " + std::to_string(island.nc) + " contact rows of " + robot_names(x.file, island.robots) +
                     " have rank " + std::to_string(kind.ranks.rank);
  if (n != island.nc - kind.ranks.rank) {
    advice.push_back(text + "; which rows are redundant hangs on the tolerance: they are nearly dependent");
    return;
  }
  text += "; " + count(n, "row") + (n == 1 ? " is" : " are") +
          " redundant, since the rows before hold the same: " + join(s.redundant, kMostNames) +
          and_more(kind.islands.size() - 1, "island");
  advice.push_back(text);
  text = "the rows that are left hold the same: " + join(s.kept, kMostNames);
  if (!s.dropped.empty()) text += "; to be dropped: " + join(s.dropped, kMostNames);
  if (x.file.scene.damping > 0) text += " (the damping acts on every row: without some, the answer moves by as much)";
  advice.push_back(text);
}

std::string advice_on(const Scene& scene, const BodyPair& p) {
  const std::string contacts = contact_names(scene, p.contacts);
  const std::string rows = count(p.rows, "row") + " of rank " + std::to_string(p.rank);
  const std::string frame = "`" + frame_name(scene, p.A, p.point_A) + "`" +
                            (p.B.joint < 0 ? "" : " to `" + frame_name(scene, p.B, p.point_B) + "`");
  const std::string start = contacts + ", " + rows + ": ";
  switch (p.holds) {
    case Holds::kOneContact:
      return start + "`" + scene.contacts[p.alone].name + "` alone holds the same";
    case Holds::kSixD:
      return start + "one 6D contact on " + frame + " holds the same";
    case Holds::kThreeD:
      return start + "one 3D contact on " + frame + ", at their common point, holds the same";
    case Holds::kLine:
      return start + "points on a line hold five motions, all but the turn about the line, and no single type does";
    case Holds::kEach:
    case Holds::kFewerRows:
      break;
  }
  return "";
}

// Rows of a pair once the advice is followed, -1 when no contact type takes the place of the rows.
int rows_needed(const Scene& scene, const BodyPair& p) {
  switch (p.holds) {
    case Holds::kEach:
      return p.rows;
    case Holds::kOneContact:
      return scene.contacts[p.alone].rows();
    case Holds::kSixD:
      return 6;
    case Holds::kThreeD:
      return 3;
    case Holds::kLine:
    case Holds::kFewerRows:
      return -1;
  }
  return -1;
}

// One contact that does for all between the same two bodies; and what that would leave.
void advise_pairs(const Inspection& x, const IslandKind& kind, std::vector<std::string>& advice) {
  const Scene& scene = x.file.scene;
  for (const auto& alike : alike_pairs(scene, kind.ranks.pairs)) {
    const std::string text = advice_on(scene, kind.ranks.pairs[alike.front()]);
    if (!text.empty()) advice.push_back(text + and_more(alike.size() * kind.islands.size() - 1, "group"));
  }
  if (!kind.ranks.known) return;
  const Island& island = x.island(kind).island;
  int rows = 0, ranks = 0;
  bool all = true;
  for (const BodyPair& p : kind.ranks.pairs) {
    const int needed = rows_needed(scene, p);
    all = all && needed >= 0;
    rows += needed;
    ranks += p.rank;
  }
  if (all && rows == kind.ranks.rank && rows < island.nc)
    advice.push_back("so simplified, " + count(rows, "row") + " hold what " + std::to_string(island.nc) +
                     " do, and every one counts");
  if (ranks > kind.ranks.rank)
    advice.push_back("the contact groups of " + robot_names(x.file, island.robots) +
                     " hold each other through the robots: their ranks add up to " + std::to_string(ranks) +
                     ", together they have " + std::to_string(kind.ranks.rank));
}

// Contacts that hold more directions than their robots can move in.
void advise_lighter(const Inspection& x, const IslandKind& kind, std::vector<std::string>& advice) {
  for (const Lighter& l : kind.ranks.lighter) {
    const Contact& contact = x.file.scene.contacts[l.contact];
    std::string text = contact.name + " (" + to_string(contact.type) + ", " + count(contact.rows(), "row") +
                       ") has rank " + std::to_string(l.rank) +
                       ": at this configuration its bodies cannot move in the other directions";
    if (l.rank == 0) text += ", it holds nothing";
    if (!l.type.empty()) text += "; " + l.type + " at the same frame holds the same there";
    advice.push_back(text + and_more(kind.islands.size() - 1, "island"));
  }
}

}  // namespace

std::vector<std::string> contact_advice(const Inspection& x) {
  std::vector<std::string> advice;
  for (const IslandKind& kind : x.kinds) {
    advise_rows(x, kind, advice);
    advise_pairs(x, kind, advice);
    advise_lighter(x, kind, advice);
  }
  return advice;
}

}  // namespace manycontact::cli
