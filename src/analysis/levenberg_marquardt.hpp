#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace manycontact::internal {

/// Of Levenberg and Marquardt's method: where a step does not bring |e| down it is tried again with ten times the
/// damping, no less than `least` and no more than `most`; after one that does, with a tenth. `floor`: the damping below
/// `least`, 0 or that.
struct Damping {
  double floor = 0, least = 0, most = 0;
};

struct Descent {
  int steps = 0;  // taken
  int tries = 0;
};

constexpr double kProgress = 1e-10;  // of |e|: less is none

/// Moves q to a least |e|. errors(q): e; step(q, e, damping, dq): fills dq, or false where there is none; move(q, dq):
/// the next q; ends(q, e): nothing is left of e, or what is left is for others.
template <class Errors, class Step, class Move, class Ends>
Descent levenberg_marquardt(const Damping& damping, int most_tries, Eigen::VectorXd& q, Errors&& errors, Step&& step,
                            Move&& move, Ends&& ends) {
  Descent done;
  Eigen::VectorXd e = errors(q), dq;
  double mu = damping.floor;
  while (done.tries < most_tries && mu <= damping.most && !ends(q, e)) {
    if (!step(q, e, mu, dq)) break;
    ++done.tries;
    const Eigen::VectorXd next = move(q, dq), then = errors(next);
    if (!(then.norm() < (1 - kProgress) * e.norm())) {
      mu = std::max(damping.least, 10 * mu);
      continue;
    }
    q = next;
    e = then;
    mu = mu > damping.least ? mu / 10 : damping.floor;
    ++done.steps;
  }
  return done;
}

constexpr double kAside = 1e-3;  // m, rad: no posture that is told from another
constexpr double kReach = 1;     // m, rad: the longest step from there, where J is nearly singular

/// descend(q), which ends where |e| is stationary: at a minimum, or at a saddle, as straight knees and elbows are. So
/// it is called again from aside(q), near by, as long as that leaves less of e. size(q): |e|, 0 where nothing is left.
template <class Descend, class Aside, class Size>
void off_saddles(Eigen::VectorXd& q, Descend&& descend, Aside&& aside, Size&& size) {
  descend(q);
  for (double left = size(q); left > 0;) {
    Eigen::VectorXd next = aside(q);
    if (next == q) break;
    descend(next);
    const double then = size(next);
    if (!(then < left)) break;
    const bool same = then > (1 - kAside) * left;  // the same minimum, nearer
    left = then;
    q = next;
    if (same) break;
  }
}

}  // namespace manycontact::internal
