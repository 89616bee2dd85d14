#include "findings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "manycontact/analysis/names.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostIslands = 2, kMostLimits = 6, kMostWeightless = 8, kMostPlaces = 4, kMostTexts = 4;

std::string joint_name(const Scene& scene, const LimitPassed& limit) {
  const Robot& robot = scene.robots[limit.robot];
  return robot.name + "/" + dof_name(*robot.model, limit.dof);
}

// Prints the contacts of the findings in `list`, such as "left, right". If there are several, also prints the worst.
template <class List, class Size, class Say>
void print_contacts(std::ostream& out, const Scene& scene, const List& list, const std::string& title, Size&& size,
                    Say&& say) {
  if (list.empty()) return;
  std::vector<int> contacts;
  for (const auto& item : list) contacts.push_back(item.contact);
  std::ranges::sort(contacts);
  const auto worst = std::ranges::max_element(list, {}, size);
  const std::string names = contact_names(scene, contacts), name = scene.contacts[worst->contact].name;
  wrap(out, list.size() == 1 ? name + " " + say(*worst) : names + "; most of all " + name + " " + say(*worst), 2,
       title + ": ");
}

std::string amount(const Scene& scene, const Violation& v) {
  const std::string by = "by " + number(v.by) + " " + unit_of(v.kind);
  if (v.kind == ViolationKind::kTips) return by + " outside its box";
  if (v.kind == ViolationKind::kTurns) return by + " beyond the limit of friction";
  if (v.kind == ViolationKind::kPulls) return by;
  return by + " more than mu " + number(*scene.contacts[v.contact].mu) + " allows" +
         (std::isfinite(v.needs) ? "; mu " + number(v.needs) + " would be sufficient" : "");
}

void print_limits(std::ostream& out, const Scene& scene, std::vector<LimitPassed> limits) {
  const auto share = [](const LimitPassed& l) {
    return l.limit == 0 ? std::abs(l.value) : std::abs((l.value - l.limit) / l.limit);
  };
  std::ranges::stable_sort(limits, std::ranges::greater(), share);
  std::vector<std::string> texts;
  for (const LimitPassed& limit : limits) texts.push_back(in_words(scene, limit));
  if (!texts.empty()) wrap(out, join(texts, kMostLimits, "; ", "; and "), 2, "beyond limits: ");
}

std::string contradicted_by(const Contradiction& c) {
  return "by " + text::two_sizes(c.linear, "m/s^2", c.angular, "rad/s^2", 1e-8 * std::max(c.linear, c.angular));
}

// Returns name and place of a finding, such as "r/knee (arm.urdf:12)".
std::string place(const Finding& finding) {
  return finding.name + " (" + std::filesystem::path(finding.file).filename().string() + ":" +
         std::to_string(finding.line) + ")";
}

// Prints the findings about robots' files by kind, only a few texts of each kind. A text is printed once, with the
// names and lines to which it refers.
void print_files(std::ostream& out, const std::vector<Finding>& findings) {
  std::map<std::string, std::vector<std::string>> texts;   // key: kind; each text once
  std::map<std::string, std::vector<std::string>> places;  // key: kind and text
  std::vector<std::string> kinds;                          // each kind once, in the order of first occurrence
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
      wrap(out,
           "there are " + std::to_string(all.size() - shown) + " more such findings; the JSON of `solve` lists all", 2,
           kind + ": ");
  }
}

void print_massless(std::ostream& out, const std::vector<MasslessJoint>& list) {
  std::map<std::string, std::vector<std::string>> joints;  // key: reason
  for (const MasslessJoint& w : list) joints[w.why].push_back(w.joint);
  for (const auto& [why, names] : joints)
    wrap(out, join(names, kMostWeightless) + ": " + why, 2, "joints without inertia: ");
}

// Prints the first entries of a list that has one entry per island or robot.
void print_some(std::ostream& out, const std::vector<std::string>& list, const std::string& title,
                const std::string& items = "islands") {
  const std::size_t shown = list.size() <= kMostIslands + 1 ? list.size() : kMostIslands;
  for (std::size_t k = 0; k < shown; ++k) wrap(out, list[k], 2, title);
  if (shown < list.size()) wrap(out, "and in " + std::to_string(list.size() - shown) + " more " + items, 2, title);
}

}  // namespace

void find_near_dependent(const Scene& scene, const Eigen::VectorXd& q, const SceneData& data, Findings& to) {
  const std::vector<RankGap> gaps = rank_gaps(scene, data);
  const auto counts = [](const RankGap& gap) { return gap.known && gap.kept >= 0; };
  const auto close = [&](const RankGap& gap) { return counts(gap) && gap.dropped >= 0 && gap.gap() < kCloseGap; };
  for (const RankGap& gap : gaps)
    if (counts(gap)) to.rank_gap = std::min(to.rank_gap, gap.gap());
  const bool near =
      std::ranges::any_of(gaps, [&](const RankGap& gap) { return counts(gap) && gap.least_kept < kOnlyJust; });
  if (!near && std::ranges::none_of(gaps, close)) return;
  const std::vector<std::string> forces = force_names(scene, data);
  const auto name = [&forces](int row) { return forces[row]; };
  for (NearDependent& n : near ? near_dependent(scene, q, data) : std::vector<NearDependent>()) {
    NearlyDependent entry{std::move(n), {}, {}, {}};
    for (const int row : entry.found.rows) entry.rows.push_back(name(row));
    if (std::ranges::any_of(to.near_dependent, [&](const NearlyDependent& known) { return known.rows == entry.rows; }))
      continue;
    entry.coordinate = velocity_names(scene)[entry.found.coordinate];
    entry.text = join(entry.rows, kMostPlaces) + ": " + in_words(scene, entry.found);
    to.near_dependent.push_back(std::move(entry));
  }
  for (const RankGap& gap : gaps)
    if (close(gap))
      to.close_rows.push_back("row " + name(gap.kept) + " is accepted, although only " + scientific(gap.least_kept) +
                              " of its norm is orthogonal to the rows accepted before; row " + name(gap.dropped) +
                              " is rejected with " + scientific(gap.most_dropped));
}

Findings find(const SceneFile& file, const SceneData& data) {
  Findings f;
  f.files = file.findings;
  f.misplaced = placement_errors(file.scene, file.q, data.active);
  f.moving = velocity_errors(file.scene, file.q, file.v, data.active);
  f.violations = violations(file.scene, file.q, data.f, data.f_offset);
  f.limits = limits_passed(file.scene, file.q, file.v, file.u);
  f.contradictions = contradictions(file.scene, data);
  f.massless = massless_joints(file.scene, data, file.q);
  f.rank_changes = rank_changes(file.scene, file.q, data);
  if (!f.rank_changes.empty()) f.velocity_names = velocity_names(file.scene);
  f.turning = turning_rows(file.scene, file.q, file.v, data.active);
  find_near_dependent(file.scene, file.q, data, f);
  return f;
}

std::string in_words(const Scene& scene, const LimitPassed& limit) {
  return joint_name(scene, limit) + ": " + to_string(limit.quantity) + " " + number(limit.value, 4) + ", limit " +
         number(limit.limit, 4);
}

std::string in_words(const Scene& scene, const Violation& v) {
  return scene.contacts[v.contact].name + " " + to_string(v.kind) + " " + amount(scene, v);
}

std::string in_words(const Scene& scene, const TurningRows& rows) {
  const Contact& contact = scene.contacts[rows.contact];
  const bool local = contact.reference_frame == ReferenceFrame::kLocal;
  return contact.name + " slides across its rows, which rotate " + (local ? "with A" : "relative to B'") +
         ": `solve` changes the velocity along the rows by " + number(rows.rate) +
         " m/s^2 (Crocoddyl's formula), `simulate` keeps this velocity constant" +
         (contact.alpha != 0 ? " and does not correct placement errors along the rows" : "") +
         (local && contact.B.robot < 0 ? "; with reference_frame=\"world\" the rows do not rotate" : "");
}

std::string in_words(const Scene& scene, const std::vector<std::string>& velocity_names, const RankChange& c) {
  std::string text = "the rank of the rows of " + contact_names(scene, c.contacts) + " is " + std::to_string(c.rank) +
                     " of " + std::to_string(c.rows) + " at this configuration, and larger at neighbouring ones";
  if (c.coordinate >= 0) text += ", where contacts also constrain " + velocity_names[c.coordinate] + ", most of all";
  return text + (c.singular
                     ? "; the configuration is singular: accelerations are valid only here, and derivatives do "
                       "not exist"
                     : "; the rows are dependent only while the constraints are satisfied: derivatives exist along "
                       "motions that satisfy the constraints, but not across these motions");
}

void print_findings(std::ostream& out, const Scene& scene, const Findings& f) {
  if (f.empty()) return;
  out << "\nWarnings\n";
  print_files(out, f.files);
  const auto in_words_of = [](const auto& list, auto&& say) {
    std::vector<std::string> texts;
    for (const auto& x : list)
      if (std::string text = say(x); !text.empty()) texts.push_back(std::move(text));
    return texts;
  };
  print_some(out, in_words_of(f.unbalanced, [&](const auto& x) { return name_of(scene, x) + ": " + in_words(x); }),
             "rest: ", "robots");
  print_contacts(
      out, scene, f.misplaced, "out of place", [](const PlacementError& e) { return std::max(e.position, e.angle); },
      [&](const PlacementError& e) {
        const Contact& c = scene.contacts[e.contact];
        return "by " + in_words(e) + (c.alpha == 0 ? "; the error is not corrected, because alpha is 0" : "");
      });
  print_contacts(
      out, scene, f.moving, "moves although constrained",
      [](const VelocityError& e) { return std::max(e.linear, e.angular); },
      [&](const VelocityError& e) {
        const Contact& c = scene.contacts[e.contact];
        return "by " + in_words(e) + (c.beta == 0 ? "; the velocity is not corrected, because beta is 0" : "") +
               "; consistent=\"true\" in the scene makes velocities consistent";
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
  print_some(out, in_words_of(f.turning, [&](const auto& x) { return in_words(scene, x); }), "rows that rotate: ");
  print_some(out,
             in_words_of(f.rank_changes,
                         [&](const RankChange& c) { return c.singular ? in_words(scene, f.velocity_names, c) : ""; }),
             "rank changes: ");
  print_some(out, in_words_of(f.near_dependent, [](const auto& n) { return n.text; }), "nearly dependent: ");
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

Json json_of(const Scene& scene, const TurningRows& rows) {
  return {{"contact", scene.contacts[rows.contact].name}, {"rate", rows.rate}};
}

Json json_of(const Scene& scene, const LimitPassed& limit) {
  return {{"joint", joint_name(scene, limit)},
          {"quantity", to_string(limit.quantity)},
          {"value", limit.value},
          {"limit", limit.limit}};
}

void add_findings(const Scene& scene, const Findings& f, Json& to) {
  for (const char* key : {"violations", "placement_errors", "velocity_errors", "limits_passed", "contradictions",
                          "rank_changes", "turning_rows", "near_dependent", "massless_joints", "findings"})
    to[key] = Json::array();
  const auto say = [&to](const std::string& kind, const std::string& name, const std::string& text) {
    to["findings"].push_back({{"kind", kind}, {"name", name}, {"text", text}});
  };
  const auto contact_name = [&scene](const auto& x) { return scene.contacts[x.contact].name; };
  for (const Finding& x : f.files) {
    say(x.kind, x.name, x.text);
    to["findings"].back().update({{"file", x.file}, {"line", x.line}});
  }
  for (const Unbalanced& x : f.unbalanced) say("rest", name_of(scene, x), in_words(x));
  for (const PlacementError& e : f.misplaced) {
    to["placement_errors"].push_back({{"contact", contact_name(e)}, {"position", e.position}, {"angle", e.angle}});
    say("place", contact_name(e), "out of place by " + in_words(e));
  }
  for (const VelocityError& e : f.moving) {
    to["velocity_errors"].push_back({{"contact", contact_name(e)}, {"linear", e.linear}, {"angular", e.angular}});
    say("velocity", contact_name(e), "moves by " + in_words(e) + ", although constrained");
  }
  for (const Violation& v : f.violations) {
    to["violations"].push_back(json_of(scene, v));
    say(to_string(v.kind), contact_name(v), in_words(scene, v));
  }
  for (const LimitPassed& x : f.limits) {
    to["limits_passed"].push_back(json_of(scene, x));
    say("beyond_limit", joint_name(scene, x), in_words(scene, x));
  }
  for (const Contradiction& c : f.contradictions) {
    to["contradictions"].push_back({{"contact", contact_name(c)}, {"linear", c.linear}, {"angular", c.angular}});
    say("contradicted", contact_name(c), "contradicted " + contradicted_by(c));
  }
  for (const MasslessJoint& w : f.massless) {
    to["massless_joints"].push_back(w.joint);
    say("no_inertia", w.joint, w.why);
  }
  for (const RankChange& c : f.rank_changes) {
    Json names = Json::array();
    for (const int contact : c.contacts) names.push_back(scene.contacts[contact].name);
    to["rank_changes"].push_back(
        {{"contacts", names},
         {"singular", c.singular},
         {"rank", c.rank},
         {"rows", c.rows},
         {"coordinate", c.coordinate < 0 ? Json(nullptr) : Json(f.velocity_names[c.coordinate])}});
    if (c.singular) say("rank_changes", contact_names(scene, c.contacts), in_words(scene, f.velocity_names, c));
  }
  for (const TurningRows& x : f.turning) {
    to["turning_rows"].push_back(json_of(scene, x));
    say("turning_rows", contact_name(x), in_words(scene, x));
  }
  for (const NearlyDependent& n : f.near_dependent) {
    to["near_dependent"].push_back({{"rows", n.rows},
                                    {"left", n.found.left},
                                    {"times_loads", n.found.times},
                                    {"coordinate", n.coordinate},
                                    {"acceleration", n.found.acceleration},
                                    {"without", n.found.without}});
    say("near_dependent", n.rows.front(), n.text);
  }
  for (const std::string& text : f.close_rows) say("near_dependent", "", text);
}

}  // namespace manycontact::cli
