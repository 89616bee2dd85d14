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

/// Moves q to a least |e|. errors(q): e; step(q, e, damping, dq): fills dq, or false where there is none; move(q, dq):
/// the next q; exact(q, e): nothing is left of e.
template <class Errors, class Step, class Move, class Exact>
Descent levenberg_marquardt(const Damping& damping, int most_tries, Eigen::VectorXd& q, Errors&& errors, Step&& step,
                            Move&& move, Exact&& exact) {
  constexpr double kProgress = 1e-10;  // of |e|: less is none
  Descent done;
  Eigen::VectorXd e = errors(q), dq;
  double mu = damping.floor;
  while (done.tries < most_tries && mu <= damping.most && !exact(q, e)) {
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

}  // namespace manycontact::internal
