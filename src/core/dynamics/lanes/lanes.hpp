#pragma once
// SIMD batches of 2, 4 or 8 robots of one structure (Model::structure). Kernels are compiled for several instruction
// levels; one is chosen at run time. A robot's results do not depend on its place in the batch or the other robots.

#include <algorithm>
#include <array>
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

/// Inputs of a solve, and where its solution is written, in the scene's coordinates. serial: number of the solution.
struct Job {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *tau;
  const std::vector<int>& f_offset;               // one entry per contact
  const double* prescribed;                       // prescribed accelerations of the rows, ordered as f; nullptr: 0
  double *a, *f;                                  // written for robots whose solution is sound
  const std::vector<int>* left_offset = nullptr;  // one entry per contact; used for pairs
  double* left = nullptr;                         // ContactData::left of pairs on single robots
  const StartOfStep* start = nullptr;             // start of a step of single-robot islands; v is zero then
};

/// Right-hand side of a robot's panel that is copied out: a column, and the destination of its rows.
struct Sampled {
  int column;
  double* b;
};
/// One robot's columns K_r^-1 [E, B_r], with rows of f, not -f. For a single-robot island: IslandDerivatives::X.
struct Panel {
  double* X;
  int ld;                            // leading dimension of X, a multiple of 8
  bool refine;                       // refine once, unless the factor bounds the error of every column
  std::span<const Sampled> sampled;  // columns of coupled robots
};
/// The solution, in the scene's coordinates.
struct Solution {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
};

/// Inputs of derivatives: the solution, the number of columns, and the first columns of q, v, u. E comes before them:
/// six columns per coupling contact, of forces on the robot's body.
struct DerivativeJob : Solution {
  DerivativeRequest request;
  int q_first, v_first, u_first, columns;  // columns: a multiple of 8
  bool non_temporal;                       // whether panels, together larger than the caches, bypass them
};

/// A product with derivatives, in the scene's coordinates: jvp dq, dv, dtau -> da, df; vjp wa, wf -> wq, wv, wtau.
struct ProductJob : Solution {
  std::array<const double*, 3> in;
  std::array<double*, 3> out;
};

/// Result of one island. If it is not sound, the other members are undefined and another system must solve the island.
struct Answer {
  bool sound = false;
  int refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, contact_terms = 0, backward_error = 0;  // members of IslandReport
  // Whether derivatives and products need no check (systems/matrix/panel.cpp); whether derivatives need refinement.
  bool panel_is_safe = false, refine_panel = false;
  std::span<const int> dependent;             // dependent rows, in the order of the plan's K
  rank::Contradiction<double> contradiction;  // set if any row is dependent
};

/// Steps for robots of one plan: one, or up to a full SIMD batch with contacts identical except for placements
/// (`alike`).
class RobotBlocks {
 public:
  struct Robot {
    int number;
    const int* contacts;  // contacts on it alone, as numbered in the scene
    // Members of coupled robots only.
    double* joins = nullptr;  // one JoinedEnd per coupling contact, later J's columns on this robot; valid until factor
    double* ends = nullptr;   // one MovingEnd per coupling contact, later EndForce in its place
    const double *x = nullptr, *b = nullptr;  // input of check, in the order of the plan's island
    Border border = {};
    // Members that the steps set.
    bool sound = false;                              // false: another system must solve
    double motion = 0;                               // evaluate: motion scale of the contacts on it alone
    double terms = 0, diagonal = 0;                  // factor: the largest pivot term and diagonal entry of K
    std::span<const int> dependent = {};             // factor: dependent rows, in the order of the plan's K
    double r[2] = {}, scale[2] = {};                 // correct, check: the largest of dynamics rows and of contact rows
    double error = 0;                                // correct, check: componentwise backward error, or NaN
    rank::Contradiction<double> contradiction = {};  // finish
  };
  /// Memory of a batch's robots. next: memory of the following batch, which is prefetched.
  struct Memory {
    double* at;
    const double* next;
  };

  virtual ~RobotBlocks() = default;

  // Solves single-robot islands by LDL of K in the plan's order. The terms of the last robots are kept between calls,
  // and reused by a call for the same robots at the same solution.
  virtual void solve(const Job& job, std::span<Robot> robots, std::span<Answer> answers) = 0;

  // Steps for coupled robots, whose terms are in the caller's memory: BlockPlan::memory_size numbers per robot of the
  // batch, aligned to a cache line.
  /// Evaluates the robots' own part of K x = b, and the ends of coupling contacts.
  virtual void evaluate(const Job& job, std::span<Robot> robots, Memory memory) = 0;
  /// Factorizes K, sets x = 0, and computes b's contribution to the border.
  virtual void factor(std::span<Robot> robots, Memory memory) = 0;
  /// Sets x += K^-1 r, given the border's solution y, then r = b - K x and r's contribution to the border.
  virtual void correct(std::span<Robot> robots, Memory memory) = 0;
  /// Writes accelerations, and the forces of contacts on the robots alone.
  virtual void store(const Job& job, std::span<Robot> robots, double* memory) = 0;

  /// Computes derivatives: of single-robot islands with Answer::panel_is_safe, or the columns K_r^-1 [E, B_r] of
  /// coupled robots.
  virtual void differentiate(const DerivativeJob& job, std::span<Robot> robots, double* memory,
                             std::span<const Panel> panels) = 0;
  /// Compute products with these derivatives, refined once (systems/matrix/matrix.cpp).
  virtual void jvp(const ProductJob& job, std::span<Robot> robots) = 0;
  virtual void vjp(const ProductJob& job, std::span<Robot> robots) = 0;

  // More steps for coupled robots.
  /// Sets another right-hand side b = [a; -f] of the robots and the contacts on them alone. Call it after factor.
  virtual void load(const Job& job, std::span<Robot> robots, double* memory) = 0;
  /// Computes r = b - K x of given columns and the border's solution y; overwrites the results of load and correct.
  virtual void check(std::span<Robot> robots, Memory memory) = 0;
  /// Adds the inconsistency of redundant rows to r and scale. Call it after the last correction.
  virtual void finish(std::span<Robot> robots, Memory memory) = 0;
  virtual void move_ends(const DerivativeJob& job, std::span<Robot> robots) = 0;
};

/// Evaluates contacts of one kind that couple two robots: one, or up to a full SIMD batch.
class InterfaceContacts {
 public:
  struct Rows {
    const Contact* contact;
    double *A, *B;  // input JoinedEnd; the columns of the contact's J on that robot replace it
    double* a0;
    double* left;                 // a pair's ContactData::left
    double smallest_row, motion;  // the smallest row of J, and the motion scale of its rows
  };
  /// Input and output of derivatives at the solution.
  struct Derivatives {
    const Contact* contact;
    double *A, *B;    // input MovingEnd; EndForce replaces it
    const double* f;  // the contact's force
    double* terms;    // JoinTerms
  };

  virtual ~InterfaceContacts() = default;
  // The contacts of a call are identical except for placements (`alike_rows`).
  virtual void evaluate(const Vec3<double>& gravity, std::span<Rows> rows) = 0;
  virtual void differentiate(const Vec3<double>& gravity, std::span<const Derivatives> rows) = 0;
};

struct SubtreePlan;  // lanes/subtrees.hpp
class SubtreeBatch;

/// Solves single-robot islands in single precision; sound only with two correct digits (tolerance::kWorthless).
class SingleBlocks {
 public:
  virtual ~SingleBlocks() = default;
  virtual void solve(const Job& job, std::span<RobotBlocks::Robot> robots, std::span<Answer> answers) = 0;
};
struct SingleLevel {
  int width;  // robots per batch: twice as many as in doubles
  std::unique_ptr<SingleBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
};

/// The kernels of an instruction level, for SIMD batches or for one robot or contact at a time.
struct Level {
  int width;
  std::unique_ptr<RobotBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
  /// contact: any contact of the kernel's kind, in its scene.
  std::unique_ptr<InterfaceContacts> (*make_contacts)(const Scene& scene, const Contact& contact,
                                                      const ContactSupport& support);
  /// Returns nullptr if the level is not for SIMD batches.
  std::unique_ptr<SubtreeBatch> (*make_subtrees)(const std::shared_ptr<const SubtreePlan>& plan);
  const SingleLevel& single;
};

/// A thread's kernels: for one item and, if requested, for a SIMD batch.
template <class Kernel>
struct OneOrBatch {
  std::unique_ptr<Kernel> one, batch;
  Kernel& of(std::size_t count) const { return count == 1 ? *one : *batch; }
  /// Creates the kernels for up to `count` items at a time. of(level): creates one.
  template <class Of>
  void make(std::size_t count, const simd::Level& level, Of&& of) {
    if (!one) one = of(level.one_robot);
    if (count > 1 && !batch) batch = of(level.robots);
  }
};

/// Returns the level that options request; nullptr if they request none or this machine cannot run it.
const simd::Level* level_of(SimdLevel lanes);

/// Whether contacts of one type on the same joints can share a SIMD batch: they are identical except for placements.
bool alike_rows(const Contact& x, const Contact& y);
/// Whether robots of one structure can share a SIMD batch: contacts are identical except for placements of ends.
bool alike(const Scene& scene, std::span<const int> contacts_x, std::span<const int> contacts_y);

}  // namespace manycontact::lanes
