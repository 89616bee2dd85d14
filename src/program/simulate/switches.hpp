#pragma once
// Contacts that come and go at given times: the option --switch.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/switch.hpp"

namespace manycontact::cli {

class Switches {
 public:
  /// Parses "0.2 left off, 0.5 left on": times, contacts (or copies, by the name in the file), and `off`, `on` or
  /// `here` (on, fixed where frame A is then). Throws UsageError.
  Switches(const std::string& text, const SceneFile& file);

  struct Event {
    double t = 0;
    std::string contact;
    int first = 0, count = 1;  // contacts
    enum What { kOff, kOn, kHere } what = kOff;
  };

  /// The effect on the motion of contacts that closed.
  struct ImpactEvent {
    double t = 0;
    std::string contacts;
    VelocityJump jump;
    std::vector<PlacementError> away;  // contacts closed by `on` whose frames are not in their place
  };
  const std::vector<ImpactEvent>& blows() const { return blows_; }

  /// "5 left off, 7 right on": the switches not done yet, as the option has them; empty where all are.
  std::string not_reached() const;

  /// Does what is due at the state's time, `tolerance` early at most. False when an impact could not be solved.
  [[nodiscard]] bool apply(Scene& scene, SimulationData& sim, double tolerance);

 private:
  std::vector<Event> events_;  // sorted by time
  std::size_t done_ = 0;
  std::vector<ImpactEvent> blows_;
};

}  // namespace manycontact::cli
