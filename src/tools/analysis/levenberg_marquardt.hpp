#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace manycontact::internal {

/// Parameters of Levenberg and Marquardt's method. If a step does not reduce |e|, it is repeated with ten times the
/// damping, within `least` and `most`. After a step that does, the damping is a tenth. `floor` is the damping below
/// `least`: 0 or `least`.
struct Damping {
  double floor = 0, least = 0, most = 0;
};

struct Descent {
  int steps = 0;  // steps taken
  int tries = 0;
};

constexpr double kProgress = 1e-10;  // relative to |e|: a smaller decrease is no progress

/// Moves q to a minimum of |e|. `errors(q)` returns e. `step(q, e, damping, dq)` fills dq, or returns false if there is
/// no step. `move(q, dq)` returns the next q. `ends(q, e)` returns whether e is small enough, or the rest of it is left
/// to others.
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

constexpr double kAside = 1e-3;  // m, rad: smaller steps do not change a configuration noticeably
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
