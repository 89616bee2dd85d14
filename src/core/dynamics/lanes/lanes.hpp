#pragma once
// SIMD batches of robots of one structure (Model::structure): the same instructions work on 2, 4 or 8 of them. The
// kernels are compiled for several levels of instructions and chosen when the program runs. A robot's numbers do not
// depend on its place in the batch, nor on the other robots there.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "block.hpp"
#include "manycontact/dynamics/derivatives.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/solve_step.hpp"
#include "manycontact/rank/contradiction.hpp"
#include "simd/levels.hpp"

namespace manycontact::lanes {

/// Inputs of a solve and places of its solution, in the scene's coordinates. serial: of the solution, in all jobs.
struct Job {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *tau;
  const std::vector<int>& f_offset;               // one entry per contact
  const double* prescribed;                       // prescribed accelerations of the rows, as f; nullptr: zero
  double *a, *f;                                  // the robots' parts are written where the solution is sound
  const std::vector<int>* left_offset = nullptr;  // one entry per contact; used for pairs
  double* left = nullptr;                         // ContactData::left of pairs on single robots
  const StartOfStep* start = nullptr;             // start of a step of robots alone; v is zero then
};

/// Right-hand sides of a robot's panel that are copied out: a column, and where its rows go.
struct Sampled {
  int column;
  double* b;
};
/// One robot's columns K_r^-1 [E, B_r], forces with their own sign. A robot alone has no E: its columns are the
/// derivatives of its island at the solution, X as IslandDerivatives has it.
struct Panel {
  double* X;
  int ld;                            // leading dimension of X, a multiple of 8
  bool refine;                       // once, unless the factor bounds the error of every column
  std::span<const Sampled> sampled;  // columns of robots joined to others
};
/// The solution, in the scene's coordinates.
struct Solution {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
};

/// Inputs of derivatives: the solution, the number of columns, and where those of q, v, u begin. E: six columns per
/// contact that joins the robot, of forces on its body, before all others.
struct DerivativeJob : Solution {
  DerivativeRequest request;
  int q_first, v_first, u_first, columns;  // columns: a multiple of 8
  bool non_temporal;                       // panels, together larger than the caches, bypass them
};

/// A product with the derivatives at a solution: in and out in the scene's coordinates. jvp: dq, dv, dtau (nv) to da,
/// df; vjp: wa, wf to wq, wv, wtau.
struct ProductJob : Solution {
  std::array<const double*, 3> in;
  std::array<double*, 3> out;
};

/// Result of one island. If it is not sound, the other members are undefined and another system has to solve the
/// island.
struct Answer {
  bool sound = false;
  int refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, contact_terms = 0, backward_error = 0;  // report's values
  // derivatives by the same factor (systems/matrix/panel.cpp): whether they need no check, and whether they are refined
  // once; whether products need no check
  bool panel_is_safe = false, refine_panel = false;
  std::span<const int> dependent;             // rows that depend on others, in the order of the plan's K
  rank::Contradiction<double> contradiction;  // set where there are any
};

/// Steps of a solve of robots of one plan and of what comes after it. A call takes one robot, or of the kernel for a
/// SIMD batch as many as fit, with contacts that are identical except for placements (`alike`).
class RobotBlocks {
 public:
  struct Robot {
    int number;           // number in the scene
    const int* contacts;  // contacts on it alone, numbers in the scene
    // only for robots joined to others
    double* joins = nullptr;  // one per contact that joins it: JoinedEnd, then J's columns on this robot; until factor
    double* ends = nullptr;   // ends for derivatives: MovingEnd, then EndForce
    const double *x = nullptr, *b = nullptr;  // input of check: columns of a panel, rows as the plan's island has them
    Border border = {};
    // set by the steps
    bool sound = false;                              // false: another system has to solve
    double motion = 0;                               // evaluate: of the contacts on it alone
    double terms = 0, diagonal = 0;                  // factor: the largest of the pivots' and of K's
    std::span<const int> dependent = {};             // factor: rows that depend on others, in the order of the plan's K
    double r[2] = {}, scale[2] = {};                 // correct, check: the largest of dynamics rows, contact rows
    double error = 0;                                // correct, check: componentwise backward error; NaN where any is
    rank::Contradiction<double> contradiction = {};  // finish
  };
  /// Memory of the robots of a batch. next: that of the batch after this one, which is prefetched meanwhile.
  struct Memory {
    double* at;
    const double* next;
  };

  virtual ~RobotBlocks() = default;

  // Robots alone: islands of their own, solved by LDL of K in the plan's order. Between calls the numbers of those last
  // met stay: where the next call is about the same ones at the same solution, they are taken from there.
  virtual void solve(const Job& job, std::span<Robot> robots, std::span<Answer> answers) = 0;

  // Robots joined to others, whose numbers are in memory of the caller's.
  // Memory of one, or for as many as fit where there are several: BlockPlan::memory_size of each, at a cache line's
  // border.
  /// The robots' own part of K x = b, and the ends of contacts that join them.
  virtual void evaluate(const Job& job, std::span<Robot> robots, Memory memory) = 0;
  /// Factorizes K. Then x = 0, and b's contribution to the border is computed.
  virtual void factor(std::span<Robot> robots, Memory memory) = 0;
  /// x += K^-1 r, given the border's solution y. Then r = b - K x is computed, with r's contribution to the border.
  virtual void correct(std::span<Robot> robots, Memory memory) = 0;
  /// Accelerations, and forces of the contacts on the robots alone.
  virtual void store(const Job& job, std::span<Robot> robots, double* memory) = 0;

  /// The islands' derivatives, of solutions that were sound and whose panels are safe; or, with their memory, of robots
  /// joined to others the columns of their own part.
  virtual void differentiate(const DerivativeJob& job, std::span<Robot> robots, double* memory,
                             std::span<const Panel> panels) = 0;
  /// Products with these derivatives, refined once (systems/matrix/matrix.cpp).
  virtual void jvp(const ProductJob& job, std::span<Robot> robots) = 0;
  virtual void vjp(const ProductJob& job, std::span<Robot> robots) = 0;

  // Robots coupled to others, as above.
  /// Call it after factor. Sets another right-hand side: b = [a; -f] of the robots and the contacts on them alone.
  virtual void load(const Job& job, std::span<Robot> robots, double* memory) = 0;
  /// r = b - K x of columns given with the border's solution y; this overwrites the results of load and correct.
  virtual void check(std::span<Robot> robots, Memory memory) = 0;
  /// After the last correction, if any robot has redundant rows: adds their inconsistency to r and scale.
  virtual void finish(std::span<Robot> robots, Memory memory) = 0;
  /// Computes MovingEnd of each contact that couples the robots to others, at the solution.
  virtual void move_ends(const DerivativeJob& job, std::span<Robot> robots) = 0;
};

/// Contacts of one kind that couple two robots: one, or as many as fit in a SIMD batch.
class InterfaceContacts {
 public:
  struct Rows {
    const Contact* contact;
    double *A, *B;  // JoinedEnd; then the columns of the contact's J on that robot
    double* a0;
    double* left;                 // a pair's ContactData::left
    double smallest_row, motion;  // sizes of J and of the motions its rows are picked from
  };
  /// And of derivatives at the solution.
  struct Derivatives {
    const Contact* contact;
    double *A, *B;    // MovingEnd; then EndForce
    const double* f;  // the contact's force
    double* terms;    // JoinTerms
  };

  virtual ~InterfaceContacts() = default;
  // identical except for placements (`alike_rows`)
  virtual void evaluate(const Vec3<double>& gravity, std::span<Rows> rows) = 0;
  virtual void differentiate(const Vec3<double>& gravity, std::span<const Derivatives> rows) = 0;
};

struct SubtreePlan;  // lanes/subtrees.hpp
class SubtreeBatch;

/// Solves single-robot islands in single precision. If the condition number leaves fewer than two correct digits
/// (tolerance::kWorthless), the solution is not sound.
class SingleBlocks {
 public:
  virtual ~SingleBlocks() = default;
  virtual void solve(const Job& job, std::span<RobotBlocks::Robot> robots, std::span<Answer> answers) = 0;
};
struct SingleLevel {
  int width;  // robots of a batch: twice those of doubles
  std::unique_ptr<SingleBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
};

/// The kernels of a level of instructions for SIMD batches, or those for one robot or contact at a time.
struct Level {
  int width;  // robots in a SIMD batch, or 1
  std::unique_ptr<RobotBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
  /// contact: any of the kernel's, in its scene.
  std::unique_ptr<InterfaceContacts> (*make_contacts)(const Scene& scene, const Contact& contact,
                                                      const ContactSupport& support);
  /// For batches alone.
  std::unique_ptr<SubtreeBatch> (*make_subtrees)(const std::shared_ptr<const SubtreePlan>& plan);
  const SingleLevel& single;
};

/// A thread's kernels: for one item, and for as many as fit in a SIMD batch, if that was asked for.
template <class Kernel>
struct OneOrBatch {
  std::unique_ptr<Kernel> one, batch;
  Kernel& of(std::size_t count) const { return count == 1 ? *one : *batch; }
  /// For up to so many items at a time. of(level): a new kernel of it.
  template <class Of>
  void make(std::size_t count, const simd::Level& level, Of&& of) {
    if (!one) one = of(level.one_robot);
    if (count > 1 && !batch) batch = of(level.robots);
  }
};

/// The one that options ask for; nullptr: none, or it does not run here.
const simd::Level* level_of(SimdLevel lanes);

/// Whether contacts of one type on the same joints can share a SIMD batch: they are identical except for placements.
bool alike_rows(const Contact& x, const Contact& y);
/// Whether robots of one structure with contacts of one shape on them can share a SIMD batch: the contacts are
/// identical except for the placements of their ends, on bodies or in the world.
bool alike(const Scene& scene, std::span<const int> contacts_x, std::span<const int> contacts_y);

}  // namespace manycontact::lanes
