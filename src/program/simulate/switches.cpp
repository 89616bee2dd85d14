#include "switches.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "../command/arguments.hpp"
#include "../text/table.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::cli {

namespace {

const std::vector<std::string> kWhats{"off", "on", "here"};

[[noreturn]] void refuse(const std::string& item) {
  throw UsageError("option --switch has '" + item +
                   "', expected items like '0.2 left off', with off, on or here, separated by commas");
}

void find_contacts(const SceneFile& file, Switches::Event& event) {
  const auto one = file.scene.contact_index.find(event.contact);
  if (one != file.scene.contact_index.end()) {
    event.first = one->second;
    return;
  }
  std::vector<std::string> names;
  for (const ContactGroup& group : file.contact_groups) {
    names.push_back(group.name);
    if (group.name != event.contact) continue;
    event.first = group.first;
    event.count = group.count;
    return;
  }
  throw UsageError("option --switch: there is no contact '" + event.contact + "', " + suggestion(event.contact, names));
}

Switches::Event read(const std::string& item, const SceneFile& file) {
  std::istringstream stream(item);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  if (words.size() < 3) refuse(item);
  Switches::Event event;
  const std::string& t = words.front();
  const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), event.t);
  if (error != std::errc() || end != t.data() + t.size() || !std::isfinite(event.t) || event.t < 0) refuse(item);
  const auto what = std::ranges::find(kWhats, words.back());
  if (what == kWhats.end()) refuse(item);
  event.what = static_cast<Switches::Event::What>(what - kWhats.begin());
  event.contact = words[1];
  for (std::size_t k = 2; k + 1 < words.size(); ++k) event.contact += " " + words[k];
  find_contacts(file, event);
  return event;
}

}  // namespace

Switches::Switches(const std::string& text, const SceneFile& file) {
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) events_.push_back(read(item, file));
  std::ranges::stable_sort(events_, {}, &Event::t);
}

std::string Switches::not_reached() const {
  std::vector<std::string> list;
  for (std::size_t k = done_; k < events_.size(); ++k)
    list.push_back(number(events_[k].t, 4) + " " + events_[k].contact + " " + kWhats[events_[k].what]);
  return list.empty() ? "" : join(list, 4);
}

bool Switches::apply(Scene& scene, SimulationData& sim, double tolerance) {
  std::vector<char> active = sim.dynamics.active;
  std::vector<const Event*> closing;
  std::vector<char> on(active.size());  // flags of the contacts that due events switch on
  std::set<const Event*> held;          // events `on` or `here` whose contacts are already active
  bool any = false;
  for (; done_ < events_.size() && events_[done_].t <= sim.time() + tolerance; ++done_) {
    const Event& event = events_[done_];
    any = true;
    if (event.what != Event::kOff) closing.push_back(&event);
    if (event.what != Event::kOff && active[event.first]) held.insert(&event);
    for (int c = event.first; c < event.first + event.count; ++c) {
      active[c] = event.what != Event::kOff;
      on[c] = event.what == Event::kOn;
      sim.dynamics.active[c] = false;  // a contact that was active closes again, with an impact
      if (event.what == Event::kHere) resolve_reference(scene, sim.q, true, true, scene.contacts[c]);
    }
  }
  if (!any) return true;
  const double t = sim.time();
  const VelocityJump jump = switch_contacts(scene, active, sim);
  std::vector<std::string> closed;
  for (const Event* event : closing)
    // The contact is not active if a later event of the same time switches it off again.
    if (active[event->first]) closed.push_back(event->contact + (held.contains(event) ? " (on before)" : ""));
  if (!closed.empty()) blows_.push_back({t, join(closed, 4), jump, placement_errors(scene, sim.q, on)});
  return jump.status != Status::kFailed;
}

}  // namespace manycontact::cli
