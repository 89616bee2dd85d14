#pragma once
// Robots of an island, each cut out of it: the contacts that join it to others are contacts with the world there, and
// their rows, its border, are the last of K and are not eliminated. Side by side as in lanes.hpp; dynamics/cut.hpp has
// the method.

#include <algorithm>

#include "lanes.hpp"

namespace manycontact::lanes {

/// Constant; shared by robots of one model with alike contacts.
struct CutRobot {
  Scene scene;     // of this robot and its contacts: first those on it alone, then those that join it
  Island island;   // all of it
  int alone = 0;   // contacts on it alone
  int border = 0;  // rows of the others
  KktPattern pattern;
  sparse::LdlSchedule schedule;  // of all columns but the border's
  std::vector<ContactSupport> supports;

  std::size_t joins_size() const {  // of CutRobots::Robot::joins
    std::size_t size = 0;
    for (std::size_t k = static_cast<std::size_t>(alone); k < supports.size(); ++k)
      size += ContactTerms::JoinedEnd::size(supports[k].a.size());
    return size;
  }
  /// Numbers of a robot from step to step: K and b; behind them its joins, and from `factor` on L, D, x, w in their
  /// place.
  std::size_t kept_size() const { return static_cast<std::size_t>(pattern.K.nonzeros() + pattern.size()); }
  std::size_t memory_size() const {
    const auto factor = static_cast<std::size_t>(pattern.ldl.nonzeros() + 3 * pattern.size());
    return kept_size() + std::max(factor, joins_size());
  }
  int rows() const { return pattern.size() - border; }            // that are eliminated
  int factor_nonzeros() const { return pattern.ldl.Lp[rows()]; }  // of L, without its diagonal
};

/// A robot's numbers of its m border rows, one array after the other.
struct Border {
  double* S;  // the upper triangle by columns of what its elimination leaves of K
  int m;
  static std::size_t size(int m) { return static_cast<std::size_t>(m) * (m + 1) / 2 + 5 * m; }
  double* terms() const { return S + m * (m + 1) / 2; }  // of the diagonal: sums of sizes
  double* b() const { return terms() + m; }              // of the right-hand side
  double* y() const { return b() + m; }                  // the answer in these rows
  double* r() const { return y() + m; }                  // -G x: the robot's part of the residual
  double* scale() const { return r() + m; }              // |G| |x|
};

class CutRobots {
 public:
  /// Of robots side by side. next: of those whose turn it is after these, which is asked for meanwhile.
  struct Memory {
    double* at;
    const double* next;
  };
  struct Robot {
    int number;           // of the scene
    const int* contacts;  // on it alone, of the scene
    double* joins;  // per contact that joins it: its body as JoinedEnd has it, then the columns of J on this robot;
                    // until `factor`
    Border border;
    // by the steps
    bool sound;                   // where not, another way has to answer
    double smallest_row, motion;  // evaluate: of the contacts on it alone, as SideBySide::believable_rows
    double terms, diagonal;       // factor: the largest of the pivots' and of K's
    double r[2], scale[2];        // correct: the largest of dynamics rows, contact rows
    double error;                 // correct: componentwise backward error; NaN where any is
  };

  virtual ~CutRobots() = default;
  /// Memory for robots side by side.
  virtual void widen() = 0;
  /// How many robots the memory of one is for, or of several: CutRobot::memory_size of each, at a cache line's border.
  virtual std::size_t width(bool one) const = 0;
  // robots, in all steps: one, or after `widen` as many as fit side by side, their contacts alike (`alike`).
  /// The robots' own part of K x = b, and the ends of contacts that join them.
  virtual void evaluate(const Job& job, std::span<Robot> robots, Memory memory) = 0;
  /// The factor; x = 0, and b's part of the border.
  virtual void factor(std::span<Robot> robots, Memory memory) = 0;
  /// After factor, another right-hand side: b = [a; -f] of the robots and the contacts on them alone.
  virtual void load(const Job& job, std::span<const Robot> robots, double* memory) = 0;
  /// x += K^-1 r with the border's answer y, r = b - K x, and r's part of the border.
  virtual void correct(std::span<Robot> robots, Memory memory) = 0;
  /// Accelerations, and forces of the contacts on the robots alone.
  virtual void store(const Job& job, std::span<const Robot> robots, double* memory) = 0;
};

}  // namespace manycontact::lanes
