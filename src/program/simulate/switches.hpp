#pragma once
// Contacts that are switched on and off at given times: the option --switch.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/switch.hpp"

namespace manycontact::cli {

class Switches {
 public:
  /// Parses "0.2 left off, 0.5 left on": times, contacts (or copies, by the name in the file), and `off`, `on` or
  /// `here` (on, with B' at the placement that frame A has at this time). Throws UsageError.
  Switches(const std::string& text, const SceneFile& file);

  struct Event {
    double t = 0;
    std::string contact;
    int first = 0, count = 1;  // contacts
    enum What { kOff, kOn, kHere } what = kOff;
  };

  /// An impact of contacts that closed, and the change of motion.
  struct ImpactEvent {
    double t = 0;
    std::string contacts;
    VelocityJump jump;
    std::vector<PlacementError> away;  // errors of contacts closed by `on` out of place
  };
  const std::vector<ImpactEvent>& blows() const { return blows_; }

  /// Lists the switches not done yet in the option's syntax, "5 left off, 7 right on"; empty if all are done.
  std::string not_reached() const;

  /// Makes the switches due at the state's time, at most `tolerance` early. Returns false if an impact's solve failed.
  [[nodiscard]] bool apply(Scene& scene, SimulationData& sim, double tolerance);

 private:
  std::vector<Event> events_;  // sorted by time
  std::size_t done_ = 0;
  std::vector<ImpactEvent> blows_;
};

}  // namespace manycontact::cli
