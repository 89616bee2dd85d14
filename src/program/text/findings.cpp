#include "findings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "manycontact/analysis/names.hpp"
#include "manycontact/dynamics/views.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostIslands = 2, kMostLimits = 6, kMostWeightless = 8, kMostPlaces = 4, kMostTexts = 4;

std::string joint_name(const Scene& scene, const LimitPassed& limit) {
  const Robot& robot = scene.robots[limit.robot];
  return robot.name + "/" + dof_name(*robot.model, limit.dof);
}

// "left, right", and the worst apart when there are several.
template <class List, class Size, class Say>
void print_contacts(std::ostream& out, const Scene& scene, const List& list, const std::string& title, Size&& size,
                    Say&& say) {
  if (list.empty()) return;
  std::vector<int> contacts;
  for (const auto& item : list) contacts.push_back(item.contact);
  std::sort(contacts.begin(), contacts.end());
  const auto worst =
      std::max_element(list.begin(), list.end(), [&](const auto& a, const auto& b) { return size(a) < size(b); });
  const std::string names = contact_names(scene, contacts), name = scene.contacts[worst->contact].name;
  wrap(out, list.size() == 1 ? name + " " + say(*worst) : names + "; most of all " + name + " " + say(*worst), 2,
       title + ": ");
}

std::string amount(const Scene& scene, const Violation& v) {
  const Contact& contact = scene.contacts[v.contact];
  const std::string by = "by " + number(v.by) + " " + unit_of(v.kind);
  switch (v.kind) {
    case ViolationKind::kPulls:
      return by;
    case ViolationKind::kSlips:
      return by + " more than mu " + number(*contact.mu) + " allows" +
             (std::isfinite(v.needs) ? "; mu " + number(v.needs) + " would be sufficient" : "");
    case ViolationKind::kTips:
      return by + " outside its box";
    case ViolationKind::kTurns:
      break;
  }
  return by + " beyond the limit of friction";
}

void print_limits(std::ostream& out, const Scene& scene, std::vector<LimitPassed> limits) {
  const auto share = [](const LimitPassed& l) {
    return l.limit == 0 ? std::abs(l.value) : std::abs((l.value - l.limit) / l.limit);
  };
  std::stable_sort(limits.begin(), limits.end(),
                   [&](const LimitPassed& a, const LimitPassed& b) { return share(a) > share(b); });
  std::vector<std::string> texts;
  for (const LimitPassed& limit : limits) {
    texts.push_back(in_words(scene, limit));
    if (texts.size() > kMostLimits + 1) break;
  }
  const std::size_t shown = limits.size() <= kMostLimits + 1 ? limits.size() : kMostLimits;
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) text += (k ? "; " : "") + texts[k];
  if (shown < limits.size()) text += "; and " + std::to_string(limits.size() - shown) + " more";
  if (!text.empty()) wrap(out, text, 2, "beyond limits: ");
}

std::string contradicted_by(const Contradiction& c) {
  return "by " + text::two_sizes(c.linear, "m/s^2", c.angular, "rad/s^2", 1e-8 * std::max(c.linear, c.angular));
}

// "r/knee (arm.urdf:12)"
std::string place(const Finding& finding) {
  return finding.name + " (" + std::filesystem::path(finding.file).filename().string() + ":" +
         std::to_string(finding.line) + ")";
}

// Returns a line for each text, with the places that it is about; of each kind a few.
void print_files(std::ostream& out, const std::vector<Finding>& findings) {
  std::map<std::string, std::vector<std::string>> texts;   // by kind, each once
  std::map<std::string, std::vector<std::string>> places;  // by kind and text
  std::vector<std::string> kinds;                          // as they are met
  for (const Finding& f : findings) {
    if (!texts.count(f.kind)) kinds.push_back(f.kind);
    auto& said_of = places[f.kind + ":" + f.text];
    if (said_of.empty()) texts[f.kind].push_back(f.text);
    said_of.push_back(place(f));
  }
  for (const std::string& kind : kinds) {
    const auto& all = texts.at(kind);
    const std::size_t shown = all.size() <= kMostTexts + 1 ? all.size() : kMostTexts;
    for (std::size_t k = 0; k < shown; ++k)
      wrap(out, join(places.at(kind + ":" + all[k]), kMostPlaces) + ": " + all[k], 2, kind + ": ");
    if (shown < all.size())
      wrap(out, "and " + std::to_string(all.size() - shown) + " more such; the JSON of `solve` has all", 2,
           kind + ": ");
  }
}

void print_massless(std::ostream& out, const std::vector<MasslessJoint>& list) {
  std::map<std::string, std::vector<std::string>> joints;  // by reason
  for (const MasslessJoint& w : list) joints[w.why].push_back(w.joint);
  for (const auto& [why, names] : joints)
    wrap(out, join(names, kMostWeightless) + ": " + why, 2, "joints without inertia: ");
}

// The first of a list that has an item an island, or a robot.
void print_some(std::ostream& out, const std::vector<std::string>& list, const std::string& title,
                const std::string& items = "islands") {
  const std::size_t shown = list.size() <= kMostIslands + 1 ? list.size() : kMostIslands;
  for (std::size_t k = 0; k < shown; ++k) wrap(out, list[k], 2, title);
  if (shown < list.size()) wrap(out, "and in " + std::to_string(list.size() - shown) + " more " + items, 2, title);
}

// "loop[3], loop[4]: ..."
std::string only_just(const Findings& f, const NearDependent& n) {
  std::vector<std::string> rows;
  for (const int row : n.rows) rows.push_back(f.force_names[static_cast<std::size_t>(row)]);
  const std::string count_of = ": ";
  std::string text = join(rows, kMostPlaces) + count_of + "the other rows leave " + scientific(n.left) + " of " +
                     (rows.size() == 1 ? "it" : "the least of them");
  if (std::isfinite(n.times) && n.times > 1) text += ", forces are " + number(n.times) + " times the loads";
  const double rounding = 1e-9 * std::abs(n.without);
  text += "; without, " + f.velocity_names[static_cast<std::size_t>(n.coordinate)] + " would accelerate by " +
          number(n.without) + " instead of " + number(std::abs(n.acceleration) > rounding ? n.acceleration : 0);
  return text +
         ". Rounded numbers in a file cause this: `inspect` recommends other contacts, and tolerance=\"...\" of the "
         "scene sets its accuracy";
}

// The islands' rank gaps: the least, and in words those where one row could as well be dropped as another kept; and
// the islands of which rows only just count.
void find_gaps(const SceneFile& file, const SceneData& data, Findings& f) {
  const std::vector<RankGap> gaps = rank_gaps(file.scene, data);
  const auto counts = [](const RankGap& gap) { return gap.known && gap.kept >= 0; };
  const auto close = [&](const RankGap& gap) { return counts(gap) && gap.dropped >= 0 && gap.gap() < kCloseGap; };
  for (const RankGap& gap : gaps)
    if (counts(gap)) f.rank_gap = std::min(f.rank_gap, gap.gap());
  if (std::any_of(gaps.begin(), gaps.end(),
                  [&](const RankGap& gap) { return counts(gap) && gap.least_kept < kOnlyJust; }))
    f.near_dependent = near_dependent(file.scene, file.q, data);
  if (f.near_dependent.empty() && std::none_of(gaps.begin(), gaps.end(), close)) return;
  f.force_names = force_names(file.scene, data);
  f.velocity_names = velocity_names(file.scene);
  for (const NearDependent& n : f.near_dependent) f.only_just.push_back(only_just(f, n));
  const auto name = [&f](int row) { return f.force_names[static_cast<std::size_t>(row)]; };
  for (const RankGap& gap : gaps)
    if (close(gap))
      f.close_rows.push_back("of " + name(gap.kept) + ", which is accepted, the preceding rows leave " +
                             scientific(gap.least_kept) + " of its norm, of " + name(gap.dropped) +
                             ", which is rejected, " + scientific(gap.most_dropped));
}

}  // namespace

Findings find(const SceneFile& file, const SceneData& data) {
  Findings f;
  f.files = file.findings;
  f.misplaced = placement_errors(file.scene, data.active, file.q);
  f.moving = velocity_errors(file.scene, data.active, file.q, file.v);
  f.violations = violations(file.scene, file.q, data.f, data.f_offset);
  f.limits = limits_passed(file.scene, file.q, file.v, file.u);
  f.contradictions = contradictions(file.scene, data);
  f.massless = massless_joints(file.scene, data, file.q);
  f.rank_changes = rank_changes(file.scene, file.q, data);
  if (!f.rank_changes.empty()) f.velocity_names = velocity_names(file.scene);
  find_gaps(file, data, f);
  return f;
}

std::string in_words(const Scene& scene, const LimitPassed& limit) {
  return joint_name(scene, limit) + ": " + to_string(limit.quantity) + " " + number(limit.value, 4) + ", limit " +
         number(limit.limit, 4);
}

std::string in_words(const Scene& scene, const Violation& v) {
  return scene.contacts[v.contact].name + " " + to_string(v.kind) + " " + amount(scene, v);
}

std::string in_words(const Scene& scene, const std::vector<std::string>& velocity_names, const RankChange& c) {
  std::string text = contact_names(scene, c.contacts) + ": rank " + std::to_string(c.rank) + " of " +
                     std::to_string(c.rows) + " rows here, more at neighbouring configurations";
  if (c.coordinate >= 0)
    text +=
        ", where contacts constrain " + velocity_names[static_cast<std::size_t>(c.coordinate)] + " too, most of all";
  return text + (c.singular ? "; a singular configuration: accelerations are valid here only, derivatives do not exist"
                            : "; rows are dependent only while they are satisfied: derivatives exist along motions "
                              "that satisfy them, not across");
}

void print_findings(std::ostream& out, const Scene& scene, const Findings& f) {
  if (f.empty()) return;
  out << "\nWarnings\n";
  print_files(out, f.files);
  std::vector<std::string> unbalanced;
  for (const Unbalanced& x : f.unbalanced) unbalanced.push_back(name_of(scene, x) + ": " + in_words(x));
  print_some(out, unbalanced, "rest: ", "robots");
  print_contacts(
      out, scene, f.misplaced, "out of place", [](const PlacementError& e) { return std::max(e.position, e.angle); },
      [&](const PlacementError& e) {
        const Contact& c = scene.contacts[e.contact];
        return "by " + in_words(e) + (c.alpha == 0 ? ", which nothing corrects: its gains are zero" : "");
      });
  print_contacts(
      out, scene, f.moving, "moves although constrained",
      [](const VelocityError& e) { return std::max(e.linear, e.angular); },
      [&](const VelocityError& e) {
        const Contact& c = scene.contacts[e.contact];
        return "by " + in_words(e) + (c.beta == 0 ? ", which nothing corrects: its gains are zero" : "") +
               "; consistent=\"true\" of the scene makes velocities consistent";
      });
  for (const ViolationKind kind :
       {ViolationKind::kPulls, ViolationKind::kSlips, ViolationKind::kTips, ViolationKind::kTurns}) {
    std::vector<Violation> alike;
    for (const Violation& v : f.violations)
      if (v.kind == kind) alike.push_back(v);
    print_contacts(
        out, scene, alike, to_string(kind), [](const Violation& v) { return v.by; },
        [&](const Violation& v) { return amount(scene, v); });
  }
  print_limits(out, scene, f.limits);
  print_contacts(
      out, scene, f.contradictions, "contradicted",
      [](const Contradiction& c) { return std::max(c.linear, c.angular); }, contradicted_by);
  print_massless(out, f.massless);
  std::vector<std::string> changes;
  for (const RankChange& c : f.rank_changes)
    if (c.singular) changes.push_back(in_words(scene, f.velocity_names, c));
  print_some(out, changes, "rank changes: ");
  print_some(out, f.only_just, "nearly dependent: ");
  print_some(out, f.close_rows, "nearly dependent: ");
}

Json json_of(const Scene& scene, const Violation& v) {
  Json out = {{"contact", scene.contacts[v.contact].name},
              {"kind", to_string(v.kind)},
              {"by", v.by},
              {"unit", unit_of(v.kind)}};
  if (v.kind == ViolationKind::kSlips) out["needs_mu"] = v.needs;
  return out;
}

Json json_of(const Scene& scene, const LimitPassed& limit) {
  return {{"joint", joint_name(scene, limit)},
          {"quantity", to_string(limit.quantity)},
          {"value", limit.value},
          {"limit", limit.limit}};
}

namespace {

// All findings in words.
Json all_in_words(const Scene& scene, const Findings& f) {
  Json list = Json::array();
  const auto say = [&list](const std::string& kind, const std::string& name, const std::string& text) {
    list.push_back({{"kind", kind}, {"name", name}, {"text", text}});
  };
  for (const Finding& x : f.files) {
    say(x.kind, x.name, x.text);
    list.back()["file"] = x.file;
    list.back()["line"] = x.line;
  }
  for (const Unbalanced& x : f.unbalanced) say("rest", name_of(scene, x), in_words(x));
  for (const PlacementError& e : f.misplaced)
    say("place", scene.contacts[e.contact].name, "out of place by " + in_words(e));
  for (const VelocityError& e : f.moving)
    say("velocity", scene.contacts[e.contact].name, "moves although constrained by " + in_words(e));
  for (const Violation& v : f.violations) say(to_string(v.kind), scene.contacts[v.contact].name, in_words(scene, v));
  for (const LimitPassed& x : f.limits) say("beyond_limit", joint_name(scene, x), in_words(scene, x));
  for (const Contradiction& c : f.contradictions)
    say("contradicted", scene.contacts[c.contact].name, "contradicted " + contradicted_by(c));
  for (const MasslessJoint& w : f.massless) say("no_inertia", w.joint, w.why);
  for (const RankChange& c : f.rank_changes)
    if (c.singular) say("rank_changes", contact_names(scene, c.contacts), in_words(scene, f.velocity_names, c));
  for (std::size_t k = 0; k < f.near_dependent.size(); ++k)
    say("near_dependent", f.force_names[static_cast<std::size_t>(f.near_dependent[k].rows[0])], f.only_just[k]);
  for (const std::string& text : f.close_rows) say("near_dependent", "", text);
  return list;
}

}  // namespace

void add_findings(const Scene& scene, const Findings& f, Json& to) {
  for (const char* key : {"violations", "placement_errors", "velocity_errors", "limits_passed", "contradictions"})
    to[key] = Json::array();
  for (const Violation& v : f.violations) to["violations"].push_back(json_of(scene, v));
  for (const PlacementError& e : f.misplaced)
    to["placement_errors"].push_back(
        {{"contact", scene.contacts[e.contact].name}, {"position", e.position}, {"angle", e.angle}});
  for (const VelocityError& e : f.moving)
    to["velocity_errors"].push_back(
        {{"contact", scene.contacts[e.contact].name}, {"linear", e.linear}, {"angular", e.angular}});
  for (const LimitPassed& limit : f.limits) to["limits_passed"].push_back(json_of(scene, limit));
  for (const Contradiction& c : f.contradictions)
    to["contradictions"].push_back(
        {{"contact", scene.contacts[c.contact].name}, {"linear", c.linear}, {"angular", c.angular}});
  to["rank_changes"] = Json::array();
  for (const RankChange& c : f.rank_changes) {
    Json names = Json::array();
    for (const int contact : c.contacts) names.push_back(scene.contacts[contact].name);
    to["rank_changes"].push_back(
        {{"contacts", names},
         {"singular", c.singular},
         {"rank", c.rank},
         {"rows", c.rows},
         {"coordinate",
          c.coordinate < 0 ? Json(nullptr) : Json(f.velocity_names[static_cast<std::size_t>(c.coordinate)])}});
  }
  to["near_dependent"] = Json::array();
  for (const NearDependent& n : f.near_dependent) {
    Json rows = Json::array();
    for (const int row : n.rows) rows.push_back(f.force_names[static_cast<std::size_t>(row)]);
    to["near_dependent"].push_back({{"rows", rows},
                                    {"left", n.left},
                                    {"times_loads", std::isfinite(n.times) ? Json(n.times) : Json(nullptr)},
                                    {"coordinate", f.velocity_names[static_cast<std::size_t>(n.coordinate)]},
                                    {"acceleration", n.acceleration},
                                    {"without", n.without}});
  }
  to["massless_joints"] = Json::array();
  for (const MasslessJoint& w : f.massless) to["massless_joints"].push_back(w.joint);
  to["findings"] = all_in_words(scene, f);
}

}  // namespace manycontact::cli
