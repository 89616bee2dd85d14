#pragma once
// Collects findings about a scene and its solution, and writes them as text and as JSON.

#include <algorithm>
#include <limits>

#include "../files/json_file.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/rank_changes.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

// Nearly dependent rows with their names, because the indices in f change if other contacts become active.
struct NearlyDependent {
  NearDependent found;
  std::vector<std::string> rows;
  std::string coordinate;
  std::string text;  // such as "loop[3], loop[4]: ..."
};

struct Findings {
  std::vector<Finding> files;          // findings about the robots' files
  std::vector<Unbalanced> unbalanced;  // robots that the requested quasi-static torques do not keep at rest
  std::vector<PlacementError> misplaced;
  std::vector<VelocityError> moving;
  std::vector<Violation> violations;
  std::vector<LimitPassed> limits;
  std::vector<Contradiction> contradictions;
  std::vector<MasslessJoint> massless;
  std::vector<RankChange> rank_changes;
  std::vector<TurningRows> turning;
  std::vector<NearlyDependent> near_dependent;
  std::vector<std::string> velocity_names;  // names of all velocity coordinates; empty if there are no rank_changes
  std::vector<std::string> close_rows;      // descriptions of islands whose rank decision is not reliable
  double rank_gap = std::numeric_limits<double>::infinity();  // smallest rank_gap of all islands; infinite if unknown

  bool empty() const {
    return files.empty() && unbalanced.empty() && misplaced.empty() && moving.empty() && violations.empty() &&
           limits.empty() && contradictions.empty() && massless.empty() && turning.empty() && near_dependent.empty() &&
           close_rows.empty() && std::ranges::none_of(rank_changes, &RankChange::singular);
  }
};

/// Returns the findings of a scene that was solved at its own state.
Findings find(const SceneFile& file, const SceneData& data);
/// Adds near_dependent, close_rows and rank_gap of a solution at q. Rows that were added before are not repeated.
void find_near_dependent(const Scene& scene, const Eigen::VectorXd& q, const SceneData& data, Findings& to);

std::string in_words(const Scene& scene, const LimitPassed& limit);  // such as "r0/knee: position 3.2, beyond 2.5"
/// Returns a text such as "left slips by 30 N more than mu 0.6 allows; mu 0.82 would be sufficient".
std::string in_words(const Scene& scene, const Violation& violation);

/// Returns a text such as "foot slides across its rows, which turn with A: ...".
std::string in_words(const Scene& scene, const TurningRows& rows);

/// Returns a text such as "left, right: rank 3 of 4 rows here, more at neighbouring configurations, where contacts
/// constrain r/knee too; ...".
std::string in_words(const Scene& scene, const std::vector<std::string>& velocity_names, const RankChange& change);

/// Prints "To look at" with a line per kind of finding, the worst kind first, or nothing if there are no findings.
void print_findings(std::ostream& out, const Scene& scene, const Findings& findings);

/// Returns an object such as {"contact": "left", "kind": "slips", "by": 30, "unit": "N"}, with "needs_mu" if it slips.
Json json_of(const Scene& scene, const Violation& violation);
Json json_of(const Scene& scene, const TurningRows& rows);  // such as {"contact": "left", "rate": 2.3}
/// Returns an object such as {"joint": "r0/knee", "quantity": "position", "value": 3.2, "limit": 2.5}.
Json json_of(const Scene& scene, const LimitPassed& limit);
/// Adds the keys violations, placement_errors, velocity_errors, limits_passed, contradictions, massless_joints,
/// rank_changes, near_dependent and turning_rows, which are lists. The key `findings` lists all of them as text:
/// {"kind": "limits", "name": "r0/knee", "text": "..."}, with "file" and "line" if a robot's file is the cause.
void add_findings(const Scene& scene, const Findings& findings, Json& to);

}  // namespace manycontact::cli
