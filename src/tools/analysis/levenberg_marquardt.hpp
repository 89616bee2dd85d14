#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace manycontact::internal {

/// Levenberg-Marquardt parameters. A failed step multiplies the damping by ten, within `least` and `most`. A successful
/// step divides the damping by ten; if the result is below `least`, it is set to `floor` (0 or `least`).
struct Damping {
  double floor = 0, least = 0, most = 0;
};

struct Descent {
  int steps = 0;  // steps taken
  int tries = 0;
};

constexpr double kProgress = 1e-10;  // least relative decrease of |e| for which a step counts as successful

/// Moves q to a minimum of |e|. errors(q) returns e. step(q, e, damping, dq) computes the step dq, or returns false if
/// there is no step. move(q, dq) returns the next q. ends(q, e) returns whether to stop.
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

constexpr double kAside = 1e-3;  // size of the step off a saddle [m, rad], and least relative decrease of |e| after it
constexpr double kReach = 1;     // longest step of a search from near a saddle, where J is nearly singular [m, rad]

/// Minimises |e|, and leaves saddles such as a straight knee. descend(q) moves q until |e| is stationary. As long as
/// |e| decreases, descend is called again from aside(q), a point near q. size(q) returns |e|, or 0 if q is accepted.
template <class Descend, class Aside, class Size>
void off_saddles(Eigen::VectorXd& q, Descend&& descend, Aside&& aside, Size&& size) {
  descend(q);
  for (double left = size(q); left > 0;) {
    Eigen::VectorXd next = aside(q);
    if (next == q) break;
    descend(next);
    const double then = size(next);
    if (!(then < left)) break;
    const bool same = then > (1 - kAside) * left;  // the same minimum, only more accurately
    left = then;
    q = next;
    if (same) break;
  }
}

}  // namespace manycontact::internal
