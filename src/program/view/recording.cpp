#include <cmath>
#include <limits>

#include "manycontact/analysis/unique_forces.hpp"
#include "manycontact/contact/normal.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "page.hpp"
#include "view.hpp"

namespace manycontact::cli {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

void append(const Vec3<double>& x, std::vector<float>& list) {
  for (const double each : x) list.push_back(static_cast<float>(each));
}

void record_bodies(Recording& r) {
  for (const Kinematics<double>& kin : r.room.kin)
    for (std::size_t i = 0; i < kin.oMi.size(); ++i) {
      const SE3<double>& oMi = kin.oMi[i];
      append(kin.origin(static_cast<int>(i)) + oMi.p, r.positions);
      for (const double x : quaternion_of_rotation<double>(oMi.R))
        r.quaternions.push_back(static_cast<std::int16_t>(std::lround(32767 * x)));
    }
}

SE3<double> placement_of(const Attachment& at, const Recording& r) {
  if (at.robot < 0) return at.placement;
  const auto robot = static_cast<std::size_t>(at.robot);
  return frame_placement<double>(r.room.kin[robot], r.scene->robots[robot].base, at.joint, at.placement);
}

// Returns the placement of the frame that B is attached to, without B's offset, or B' if this frame is not known.
SE3<double> frame_of(const Attachment& at, const Recording& r) {
  if (at.robot < 0 || at.frame.empty()) return placement_of(at, r);
  const Model& model = *r.scene->robots[at.robot].model;
  const int frame = model.find_frame(at.frame);
  if (frame < 0) return placement_of(at, r);
  Attachment bare = at;
  bare.placement = model.frames[frame].placement;
  return placement_of(bare, r);
}

void record_contact(const Contact& contact, const std::optional<Vec3<double>>& force, Recording& r) {
  const SE3<double> oMA = placement_of(contact.A, r);
  const Mat3<double> axes = contact.reference_frame == ReferenceFrame::kLocal ? oMA.R : Mat3<double>::Identity();
  append(oMA.p, r.points);
  append(placement_of(contact.B, r).p, r.held);
  append(frame_of(contact.B, r).p, r.held);
  append(contact_normal(contact, oMA.R, contact.normal ? placement_of(contact.B, r).R : Mat3<double>()), r.normals);
  append(force ? Vec3<double>(axes * *force) : Vec3<double>::Constant(kUnknown), r.forces);
}

// Returns one flag per row of f: whether the row depends on other rows.
std::vector<char> dependent_rows(const Report& report, Eigen::Index rows) {
  std::vector<char> out(static_cast<std::size_t>(rows));
  for (const IslandReport& island : report.islands)
    for (const int row : island.dependent_rows) out[row] = 1;
  return out;
}

void record_contacts(const ViewState& state, Recording& r) {
  const std::vector<char> dependent = dependent_rows(r.dynamics.report, r.dynamics.f.size());
  const std::vector<char> unique = unique_forces(*r.scene, state.q, r.dynamics);
  for (std::size_t c = 0; c < r.scene->contacts.size(); ++c) {
    const Contact& contact = r.scene->contacts[c];
    const int first = r.dynamics.f_offset[c];
    std::uint8_t flags = state.active[c] ? Recording::kActive : 0;
    for (int k = 0; first >= 0 && k < contact.rows(); ++k) {
      if (dependent[first + k]) flags |= Recording::kRedundant;
      const bool known = std::isfinite(r.dynamics.f[first + k]);
      // Only rows of the linear force count, because moments are not drawn.
      if (k < 3 && known && !unique[first + k]) flags |= Recording::kShared;
    }
    std::optional<Vec3<double>> force;
    if (state.forces && state.active[c]) force = linear_force(contact, (*state.forces)[c].data());
    if (state.u && first >= 0) force = linear_force(contact, r.dynamics.f.data() + first);
    record_contact(contact, force, r);
    r.flags.push_back(flags);
  }
}

void record_forces(Recording& r) {
  for (std::size_t k = 0; k < r.scene->wrenches.size(); ++k) {
    const ExternalWrench& push = r.scene->wrenches[k];
    const SE3<double> at = placement_of(push.at, r);
    const Vec3<double> force = r.dynamics.wrenches[k].head<3>();
    append(at.p, r.wrenches);
    append(push.reference_frame == ReferenceFrame::kLocal ? Vec3<double>(at.R * force) : force, r.wrenches);
  }
  for (const Spring& spring : r.scene->springs)
    for (const Attachment* end : {&spring.A, &spring.B}) append(placement_of(*end, r).p, r.springs);
}

// Records each robot's island as the number of the first robot of the island, so that its colour does not change
// if other islands change.
void record_islands(Recording& r) {
  std::vector<std::int32_t> first(island_count(r.dynamics), -1);
  for (int robot = 0; robot < r.scene->nrobots(); ++robot) {
    std::int32_t& name = first[island_with_robot(r.dynamics, robot)];
    if (name < 0) name = robot;
    r.islands.push_back(name);
  }
}

void record(const ViewState& state, Recording& r) {
  r.dynamics.active = state.active;
  if (state.wrenches) r.dynamics.wrenches = *state.wrenches;
  const Eigen::VectorXd u = state.u.value_or(Eigen::VectorXd::Zero(r.scene->nu));
  // If an island failed, its forces are NaN, which means unknown.
  (void)solve(*r.scene, state.q, state.v, u, r.dynamics);
  const Invariants at = invariants(*r.scene, state.active, state.q, state.v, r.room);
  const Eigen::Vector2d drift = state.drift.value_or(Eigen::Vector2d(at.violation_position, at.violation_velocity));
  r.t.push_back(state.t);
  r.kinetic.push_back(static_cast<float>(at.kinetic));
  r.potential.push_back(static_cast<float>(at.potential));
  r.violation_position.push_back(static_cast<float>(drift[0]));
  r.violation_velocity.push_back(static_cast<float>(drift[1]));
  record_bodies(r);
  record_contacts(state, r);
  record_forces(r);
  record_islands(r);
}

}  // namespace

Recording::Recording(const Scene& scene_, double rate_) : scene(&scene_), rate(rate_), dynamics(scene_), room(scene_) {
  for (const Contact& contact : scene_.contacts) friction.push_back(contact.mu.value_or(0));
  check_page_parts();
}

void add_state(const ViewState& state, Recording& recording) {
  const bool due = recording.t.empty() || (state.t - recording.t.back()) * recording.rate > 1 - 1e-6;
  if (due) {
    record(state, recording);
    recording.pending.reset();
  } else {
    recording.pending = state;
  }
}

void finish(Recording& recording) {
  if (recording.pending) record(*recording.pending, recording);
  recording.pending.reset();
}

}  // namespace manycontact::cli
