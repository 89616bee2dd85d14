#pragma once
// Robots of one model and contacts alike, in islands of several robots: their terms are evaluated in lanes, private to
// floor dynamics.

#include <map>

#include "lanes.hpp"

namespace manycontact {

struct Workspace;

namespace lanes {

/// Groups stay when their members are gone, for contact sets to come.
struct TermGroups {
  struct Robots {
    std::vector<std::unique_ptr<RobotTerms>> kernels;  // one per thread
    std::vector<int> members;                          // of the scene, ascending
  };
  /// What the kernel of a contact is made for.
  struct ContactKey {
    const Model *A, *B;  // B: nullptr in the world
    bool one_robot;
    ContactType type;
    int joint_A, joint_B;
    auto operator<=>(const ContactKey&) const = default;
  };
  struct Contacts {
    std::vector<std::unique_ptr<ContactTerms>> kernels;  // one per thread
    std::vector<int> members;
  };
  /// Members first ... first+count-1 of a group, which stand side by side.
  template <class Members>
  struct SideBySide {
    const Members* group;
    int first, count;
    std::span<const int> members() const {
      return std::span(group->members).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
    }
  };
  std::map<std::shared_ptr<const Model>, Robots> robots;
  std::map<ContactKey, Contacts> contacts;
  std::vector<int> other_contacts;                    // of these islands: one by one
  std::vector<SideBySide<Robots>> robot_batches;      // all robots
  std::vector<SideBySide<Contacts>> contact_batches;  // scratch of a solve: all contacts but the others
};

/// Whether a contact comes before another in its group: like ones stand together, in any order of the scene.
bool before(const Contact& x, const Contact& y);

/// Sorts the robots and contacts of the islands at hand into groups. Allocates nothing for a contact set met before.
void regroup_terms(const Scene& scene, Workspace& work);

/// That of a contact of these islands which moves at both ends.
TermGroups::Contacts& group_of(const Scene& scene, Workspace& work, int contact);

}  // namespace lanes
}  // namespace manycontact
