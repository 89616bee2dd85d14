#pragma once
// SIMD batches of 2, 4 or 8 robots of one structure (Model::structure). Their kernels are compiled for several
// instruction levels. A robot's results depend neither on its place in the batch nor on the other robots. Contacts
// between two robots couple them; systems/robots/interface.hpp defines K_r, G_r and S of coupled robots.

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

struct Job {  // inputs and outputs of a solve in the scene's coordinates; serial: identifies the solution
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *tau;
  const std::vector<int>& f_offset;               // one entry per contact
  const double* prescribed;                       // prescribed accelerations of contact rows, in f's order; nullptr: 0
  double *a, *f;                                  // written for robots whose solution is sound
  const std::vector<int>* left_offset = nullptr;  // one offset in `left` per contact; for Contact::pair
  double* left = nullptr;                         // output for contacts with Contact::pair on single robots: their left
  const StartOfStep* start = nullptr;             // start of a simulation step (single-robot islands); v is zero then
};

struct Sampled {  // a column of right-hand sides that is copied to b, to check its solution
  int column;
  double* b;
};
/// Derivatives of one robot, with forces f instead of -f: IslandDerivatives::X of a single-robot island, or
/// K_r^-1 [E, B_r] of a coupled robot (systems/robots/derivatives.hpp).
struct Panel {
  double* X;
  int ld;                            // leading dimension of X, a multiple of 8
  bool refine;                       // whether to refine once, unless the factor bounds the error of every column
  std::span<const Sampled> sampled;  // columns that are copied to check solutions; for coupled robots
};
struct Solution {  // the solution at which derivatives are computed, in the scene's coordinates
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
};

/// Inputs of derivatives. Columns of a panel: first E, six unit forces on the robot's body per coupling contact; then
/// those with respect to q, v and u of the robot, from q_first, v_first, u_first on.
struct DerivativeJob : Solution {
  DerivativeRequest request;
  int q_first, v_first, u_first, columns;  // columns: number of columns, a multiple of 8
  bool non_temporal;                       // whether panels are written past the caches, as together they do not fit
};

/// Vectors of a product, in the scene's coordinates. jvp: dq, dv, dtau -> da, df; vjp: wa, wf -> wq, wv, wtau.
struct ProductJob : Solution {
  std::array<const double*, 3> in;
  std::array<double*, 3> out;
};

/// Result of one island. If not `sound`, the other members are undefined and another system must solve the island.
struct Answer {
  bool sound = false;
  int refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, contact_terms = 0, backward_error = 0;  // see IslandReport
  // panel_is_safe: derivatives and products by this factor need no check. refine_panel: derivatives need refinement.
  bool panel_is_safe = false, refine_panel = false;
  std::span<const int> dependent;             // dependent rows, in the order of the plan's K
  rank::Contradiction<double> contradiction;  // set if any row is dependent
};

class RobotBlocks {  // steps of a solve for robots of one plan: one robot, or a SIMD batch whose contacts are `alike`
 public:
  struct Robot {
    int number;           // number of the robot in the scene
    const int* contacts;  // contacts on the robot alone, as numbered in the scene
    // Members that only coupled robots use.
    double* joins = nullptr;  // one JoinedEnd per coupling contact; overwritten by J's columns, lost in `factor`
    double* ends = nullptr;   // one MovingEnd per coupling contact, later EndForce in its place
    const double *x = nullptr, *b = nullptr;  // solution, right-hand side for `check`, in the plan island's order
    Border border = {};
    // Results; each comment names the steps (functions below) that set the member.
    bool sound = false;                              // false: another system must solve
    double motion = 0;                               // evaluate: size by which J of `contacts` is judged
    double terms = 0, diagonal = 0;                  // factor: the largest pivot term and diagonal entry of K
    std::span<const int> dependent = {};             // factor: dependent rows, in the order of the plan's K
    double r[2] = {}, scale[2] = {};                 // correct, check: largest of [0] dynamics rows, [1] contact rows
    double error = 0;                                // correct, check: componentwise backward error, or NaN
    rank::Contradiction<double> contradiction = {};  // finish: inconsistency of the dependent rows
  };
  struct Memory {  // memory of the current batch of robots, and of the next batch, which is prefetched
    double* at;
    const double* next;
  };

  virtual ~RobotBlocks() = default;

  // Solves single-robot islands by LDL of K in the plan's order. Keeps terms and factor for derivatives and products.
  virtual void solve(const Job& job, std::span<Robot> robots, std::span<Answer> answers) = 0;

  // Steps for coupled robots. `memory` has BlockPlan::memory_size numbers per robot of the batch, aligned to a cache
  // line. In these comments K x = b are the rows of K_r, and the border are the rows of G_r.
  /// Evaluates K and b without the coupling contacts, and the JoinedEnds of the coupling contacts.
  virtual void evaluate(const Job& job, std::span<Robot> robots, Memory memory) = 0;
  /// Factorizes K, sets x = 0, and computes each robot's part of S and of the border's right-hand side.
  virtual void factor(std::span<Robot> robots, Memory memory) = 0;
  /// Sets x += K^-1 (r - G^T y), y the step in the border; then r = b - K x, and parts of the border's residual.
  virtual void correct(std::span<Robot> robots, Memory memory) = 0;
  /// Writes job.a, and job.f of contacts on single robots.
  virtual void store(const Job& job, std::span<Robot> robots, double* memory) = 0;

  /// Computes panels: derivatives of single-robot islands with panel_is_safe, or K_r^-1 [E, B_r] of coupled robots.
  virtual void differentiate(const DerivativeJob& job, std::span<Robot> robots, double* memory,
                             std::span<const Panel> panels) = 0;
  /// Compute products with the derivatives of single-robot islands, by a solve that is refined once.
  virtual void jvp(const ProductJob& job, std::span<Robot> robots) = 0;
  virtual void vjp(const ProductJob& job, std::span<Robot> robots) = 0;

  // More steps for coupled robots.
  /// Sets another right-hand side: b = [job.a; -job.f], without rows of coupling contacts. Call it after factor.
  virtual void load(const Job& job, std::span<Robot> robots, double* memory) = 0;
  /// Computes r = b - K x - G^T y for given Robot::x, Robot::b and border y; overwrites results of load and correct.
  virtual void check(std::span<Robot> robots, Memory memory) = 0;
  /// Adds the inconsistency of redundant rows to r, and computes Robot::contradiction. Call it after the last correct.
  virtual void finish(std::span<Robot> robots, Memory memory) = 0;
  virtual void move_ends(const DerivativeJob& job, std::span<Robot> robots) = 0;  // computes MovingEnds: Robot::ends
};

/// Evaluates contacts of one kind that couple two robots, one contact or a SIMD batch of contacts.
class InterfaceContacts {
 public:
  struct Rows {
    const Contact* contact;
    double *A, *B;                // JoinedEnd of either body; the columns of J of that body's robot overwrite it
    double* a0;                   // output: a0, one entry per row
    double* left;                 // output for a pair: ContactData::left
    double smallest_row, motion;  // output: size of J's smallest row, and size by which it is judged
  };
  struct Derivatives {  // input and output of derivatives at the solution
    const Contact* contact;
    double *A, *B;    // MovingEnd of either body; EndForce overwrites it
    const double* f;  // the contact's force, one entry per row
    double* terms;    // output: JoinTerms
  };

  virtual ~InterfaceContacts() = default;
  // All contacts of a call must satisfy alike_rows.
  virtual void evaluate(const Vec3<double>& gravity, std::span<Rows> rows) = 0;
  virtual void differentiate(const Vec3<double>& gravity, std::span<const Derivatives> rows) = 0;
};

struct SubtreePlan;  // lanes/subtrees.hpp
class SubtreeBatch;

class SingleBlocks {  // solves single-robot islands in single precision; sound answers have two or more correct digits
 public:
  virtual ~SingleBlocks() = default;
  virtual void solve(const Job& job, std::span<RobotBlocks::Robot> robots, std::span<Answer> answers) = 0;
};
struct SingleLevel {
  int width;  // robots per batch: twice as many as in doubles
  std::unique_ptr<SingleBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
};

struct Level {  // kernels of an instruction level, for SIMD batches, or for one robot or contact at a time
  int width;
  std::unique_ptr<RobotBlocks> (*make)(const std::shared_ptr<const BlockPlan>& plan);
  /// contact: any contact of the kind that the kernel is to evaluate; scene: the contact's scene.
  std::unique_ptr<InterfaceContacts> (*make_contacts)(const Scene& scene, const Contact& contact,
                                                      const ContactSupport& support);
  /// Returns nullptr if the level is not for SIMD batches.
  std::unique_ptr<SubtreeBatch> (*make_subtrees)(const std::shared_ptr<const SubtreePlan>& plan);
  const SingleLevel& single;
};

template <class Kernel>
struct OneOrBatch {  // a thread's kernels, for one item (robot or contact) and, if requested, for a SIMD batch
  std::unique_ptr<Kernel> one, batch;
  Kernel& of(std::size_t count) const { return count == 1 ? *one : *batch; }
  /// Creates the kernels for up to `count` items at a time. of(level): creates a kernel of this level.
  template <class Of>
  void make(std::size_t count, const simd::Level& level, Of&& of) {
    if (!one) one = of(level.one_robot);
    if (count > 1 && !batch) batch = of(level.robots);
  }
};

const simd::Level* level_of(SimdLevel lanes);  // nullptr if off, or if the processor lacks the level

/// Whether contacts of one type on the same joints can share a SIMD batch: they differ at most in placements.
bool alike_rows(const Contact& x, const Contact& y);
/// Whether robots of one structure can share a SIMD batch: their contacts differ at most in placements of ends.
bool alike(const Scene& scene, std::span<const int> contacts_x, std::span<const int> contacts_y);

}  // namespace manycontact::lanes
