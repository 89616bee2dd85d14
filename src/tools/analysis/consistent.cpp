#include "manycontact/analysis/consistent.hpp"

#include <algorithm>
#include <stdexcept>

#include "at_rest.hpp"
#include "levenberg_marquardt.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/model/suggestion.hpp"
#include "moved_most.hpp"

namespace manycontact {

namespace {

constexpr int kMostTries = 400;
constexpr internal::Damping kClosingDamping = {0, 1e-8, 1e4};  // damping: floor, least and most [1/kg]
constexpr double kExact = 1e-14;  // placement errors below this, relative to 1 m + max |q|, are rounding errors

// Returns q with small changes in all coordinates of the robots that have active contacts.
Eigen::VectorXd aside(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q) {
  const Eigen::VectorXd all = internal::kAside * internal::mixed(scene.nv, 0);
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(scene.nv);
  for (std::size_t c = 0; c < active.size(); ++c)
    for (const int r : {scene.contacts[c].A.robot, scene.contacts[c].B.robot}) {
      if (!active[c] || r < 0) continue;
      const int first = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
      dq.segment(first, n) = all.segment(first, n);
    }
  return integrate(scene, q, dq);
}

// Moves q until the placement errors of the contacts vanish or are at a minimum. Returns the number of steps.
int close_positions(const Scene& scene, const std::vector<char>& active, internal::AtRest& rest, Eigen::VectorXd& q) {
  int steps = 0;
  bool is_aside = false;
  const auto exact = [](const Eigen::VectorXd& x, const Eigen::VectorXd& e) {
    return !(e.norm() > kExact * (1 + x.cwiseAbs().maxCoeff()));
  };
  const auto descend = [&](Eigen::VectorXd& from) {
    steps += internal::levenberg_marquardt(
                 kClosingDamping, kMostTries, from, [&](const Eigen::VectorXd& x) { return rest.errors(x); },
                 [&](const Eigen::VectorXd& x, const Eigen::VectorXd& e, double damping, Eigen::VectorXd& dq) {
                   const bool answered = rest.least_motion(x, -e, dq, damping);
                   const double length = dq.size() ? dq.cwiseAbs().maxCoeff() : 0;
                   if (is_aside && length > internal::kReach) dq *= internal::kReach / length;
                   return answered && dq.allFinite();
                 },
                 [&](const Eigen::VectorXd& x, const Eigen::VectorXd& dq) { return integrate(scene, x, dq); }, exact)
                 .steps;
  };
  internal::off_saddles(
      q, descend,
      [&](const Eigen::VectorXd& x) {
        is_aside = true;
        return aside(scene, active, x);
      },
      [&](const Eigen::VectorXd& x) { return placement_errors(scene, x, active).empty() ? 0 : rest.errors(x).norm(); });
  return steps;
}

double size_of(const PlacementError& e) { return std::max(e.position, e.angle); }
double size_of(const VelocityError& e) { return std::max(e.linear, e.angular); }

// Returns "contact 'pin', the worst of 3, stays out of place by 0.1 m" for what = "out of place".
template <class Error>
std::string worst_in_words(const Scene& scene, const std::vector<Error>& list, const std::string& what) {
  const Error& worst = *std::ranges::max_element(list, {}, [](const Error& e) { return size_of(e); });
  const std::string of = list.size() == 1 ? "" : ", the worst of " + std::to_string(list.size()) + ",";
  return "contact " + quote(scene.contacts[worst.contact].name) + of + " stays " + what + " by " + in_words(worst);
}

}  // namespace

ConsistentState make_consistent(const Scene& scene, const std::vector<char>& active, const ConstVectorRef& q,
                                const ConstVectorRef& v, const Options& options) {
  if (active.size() != scene.contacts.size() || q.size() != scene.nq || v.size() != scene.nv)
    throw std::invalid_argument(
        "make_consistent: active, q or v has a wrong size, expected a flag per contact, nq and nv numbers");
  expect_configuration("make_consistent", "q", q, scene);
  expect_numbers("make_consistent", "v", v, scene.nv);
  ConsistentState out{q, v, Status::kOk, 0, {}, {}};
  internal::AtRest rest(scene, active, options);
  if (rest.rows() == 0) return out;
  out.steps = close_positions(scene, active, rest, out.q);
  const Eigen::VectorXd Jv = rest.velocities(out.q, out.v);
  Eigen::VectorXd dv;
  if (!Jv.isZero(0) && rest.least_motion(out.q, -Jv, dv) && dv.allFinite()) out.v += dv;
  out.status = rest.worst();
  out.misplaced = placement_errors(scene, out.q, active);
  out.moving = velocity_errors(scene, out.q, out.v, active);
  return out;
}

ConsistentState make_consistent(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                const Options& options) {
  return make_consistent(scene, active_contacts(scene), q, v, options);
}

void make_consistent(SceneFile& file) {
  if (file.consistent_line == 0) return;
  const Scene& scene = file.scene;
  const ConsistentState found = make_consistent(scene, file.q, file.v);
  const auto refuse = [&](const std::string& what) {
    throw InputError(
        file.path, file.consistent_line,
        "consistent=\"true\" is set, but " + what + ", expected contacts that can be satisfied near this q and v");
  };
  if (found.status == Status::kFailed)
    refuse("a robot's inertia matrix is singular near this q, so that no nearest state exists");
  if (!found.misplaced.empty()) refuse(worst_in_words(scene, found.misplaced, "out of place"));
  if (!found.moving.empty()) refuse(worst_in_words(scene, found.moving, "moving"));
  const std::vector<std::string> names = velocity_names(scene);
  const std::string moved = internal::moved_most("q", names, difference(scene, file.q, found.q)) +
                            internal::moved_most("v", names, found.v - file.v);
  file.q = found.q;
  file.v = found.v;
  if (moved.empty()) return;
  file.findings.push_back({"consistent", scene.name, "q and v were made consistent with the contacts" + moved,
                           file.path, file.consistent_line});
}

}  // namespace manycontact
