#pragma once
// Contacts that the option --switch switches on and off at given times.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/switch.hpp"

namespace manycontact::cli {

class Switches {
 public:
  /// Parses a list such as "0.2 left off, 0.5 left on". An item consists of a time, a contact (or an element with
  /// copies), and `off`, `on` or `here`, which is `on` with B' at the placement that frame A has at this time. Throws
  /// UsageError.
  Switches(const std::string& text, const SceneFile& file);

  struct Event {
    double t = 0;
    std::string contact;
    int first = 0, count = 1;  // index of the first contact, and number of contacts
    enum What { kOff, kOn, kHere } what = kOff;
  };

  struct ImpactEvent {  // an impact of contacts that closed, with the change of velocity
    double t = 0;
    std::string contacts;
    VelocityJump jump;
    std::vector<PlacementError> away;  // placement errors of the contacts that `on` closed
  };
  const std::vector<ImpactEvent>& blows() const { return blows_; }

  /// Lists the switches that are not made yet in the option's syntax, "5 left off, 7 right on", or returns "".
  std::string not_reached() const;

  /// Makes the switches that are due at the state's time or at most `tolerance` [s] later. Returns false if the solve
  /// of an impact failed.
  [[nodiscard]] bool apply(Scene& scene, SimulationData& sim, double tolerance);

 private:
  std::vector<Event> events_;  // sorted by time
  std::size_t done_ = 0;
  std::vector<ImpactEvent> blows_;
};

}  // namespace manycontact::cli
