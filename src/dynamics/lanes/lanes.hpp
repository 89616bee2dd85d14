#pragma once
// Robots of one model in SIMD lanes: 2, 4 or 8 islands of one robot each, solved side by side by the same instructions.
// The kernels are compiled for several levels of instructions and chosen when the program runs. A robot's numbers do
// not depend on its lane, nor on who stands beside it.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "manycontact/dynamics/derivatives.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/kkt/shape.hpp"

namespace manycontact::lanes {

/// What is solved, and where the answers go, in the scene's coordinates. serial: of the solution, in all jobs.
struct Job {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *tau;
  const std::vector<int>& f_offset;  // per contact
  const double* wanted;              // of the rows, as f; nullptr: zero
  double *a, *f;                     // the islands' parts are written where the answer is sound
};

/// Derivatives of one island at the answer: X as IslandDerivatives has it, laid out for `request`.
struct Panel {
  double* X;
  int ld;       // a multiple of 8
  bool refine;  // once, unless the factor bounds the error of every column
};
/// What is differentiated: the solution, and where q, v, u begin among the columns.
struct DerivativeJob {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
  DerivativeRequest request;
  int q_first, v_first, u_first;
  bool past_caches;  // panels, together more than these hold, are not to go through them
};

/// A product with the derivatives at a solution: in and out in the scene's coordinates. jvp: dq, dv, du to da, df;
/// vjp: wa, wf to wq, wv, wu.
struct ProductJob {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
  const double* in[3];
  double* out[3];
};

/// Of one island. Where it is not sound, nothing else is known: another way has to answer.
struct Answer {
  bool sound = false;
  int refinement_steps = 0;
  double residual_dynamics = 0, residual_contact = 0, backward_error = 0;  // as IslandReport has them
  // Of derivatives by the same factor (dynamics/solve_panel.cpp): whether nothing has to judge them, and whether they
  // are refined once.
  bool panel_is_safe = false, refine_panel = false;
};

/// Solves islands of one shape whose robots have one model. Between calls it holds the terms of the islands last met:
/// where the next call is about the same ones at the same solution, kinematics and factor are taken from there.
class Kernel {
 public:
  virtual ~Kernel() = default;
  /// Memory for islands side by side, from then on: one that stands alone needs none. The arguments of Level::make.
  virtual void widen(const Scene& scene, const Island& island, const IslandSupport& support,
                     std::shared_ptr<const KktPattern> pattern) = 0;
  /// islands: one, or after `widen` as many as fit side by side, alike to the first (`alike`). By LDL of K in the
  /// pattern's order.
  virtual void solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) = 0;
  /// The islands' derivatives, of answers that were sound and whose panels are safe. One layout of X for all.
  virtual void differentiate(const DerivativeJob& job, std::span<const Island* const> islands,
                             std::span<const Panel> panels) = 0;
  /// Products with these derivatives, refined once (dynamics/jvp.cpp).
  virtual void jvp(const ProductJob& job, std::span<const Island* const> islands) = 0;
  virtual void vjp(const ProductJob& job, std::span<const Island* const> islands) = 0;
};

/// Motions, bias and inertia of robots of one model, side by side, into arrays as RobotData has them: of robots of an
/// island that is too large to stand in a lane itself.
class RobotTerms {
 public:
  static constexpr std::size_t kArrays = 10;
  template <class S>
  using Arrays = std::array<S*, kArrays>;
  using Counts = std::array<int, kArrays>;
  template <class S>
  static Arrays<S> arrays_of(Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, S* M, S* h) {
    static_assert(sizeof(SE3<S>) == 12 * sizeof(S) && sizeof(Inertia<S>) == 13 * sizeof(S) &&
                  sizeof(WorldPoint<S>) == 6 * sizeof(S));
    return {kin.origins.front().p.data(),
            kin.oMi.front().R.data(),
            kin.J.data(),
            &kin.Y.front().m,
            kin.v.front().data(),
            kin.a.front().data(),
            kin.a_base.data(),
            &Yc.front().m,
            M,
            h};
  }
  static Counts counts_of(const Model& model) {
    const int n = model.njoints();
    const int trees = static_cast<int>(model.trees.size());
    return {6 * trees, 12 * n, 6 * model.nv, 13 * n, 6 * n, 6 * n, 6, 13 * n, model.M_begin[model.nv], model.nv};
  }
  struct Robot {
    const double *q, *v;
    const double* base;  // placement: R by columns, p
    Arrays<double> out;
    bool sound;  // by evaluate; where not, another way has to answer
  };

  virtual ~RobotTerms() = default;
  /// Memory for robots side by side.
  virtual void widen() = 0;
  /// robots: one, or after `widen` as many as fit side by side.
  virtual void evaluate(const Vec3<double>& gravity, std::span<Robot> robots) = 0;
};

/// Rows of contacts alike, side by side, into arrays as ContactData has them.
class ContactTerms {
 public:
  static constexpr std::size_t kArrays = 14;
  template <class S>
  using Arrays = std::array<S*, kArrays>;
  using Counts = std::array<int, kArrays>;
  template <class S>
  static Arrays<S> arrays_of(ContactData<S>& d) {
    return {d.aMA.R.data(), d.bMA.R.data(), d.G.R.data(), d.vA.data(), d.vB.data(), d.aA.data(), d.aB.data(),
            d.nu.data(),    d.nudot.data(), d.x.data(),   d.Jl.data(), d.W.data(),  d.J.data(),  d.a0.data()};
  }
  static Counts counts_of(int rows, int cols) {
    return {12, 12, 12, 6, 6, 6, 6, 6, 6, 6, 6 * cols, 6 * rows, rows * cols, rows};
  }
  /// Of a robot after evaluation, as Kinematics has them.
  struct Body {
    const double *origin, *oMi, *v, *a, *J;
  };
  struct Rows {
    Body A, B;
    const double *placement_A, *placement_B;  // of the contact's frames on their bodies, or in the world
    Arrays<double> out;
  };

  /// The same of a contact that joins two robots, where no more is wanted than its rows.
  struct JoinedEnd {  // one array: origin, oMi, v and a of the body, the columns of J that move it
    static std::size_t size(std::size_t coordinates) { return 30 + 6 * coordinates; }
  };
  struct JoiningRows {
    const Contact* contact;
    double *A, *B;  // JoinedEnd; then the columns of the contact's J on that robot
    double* a0;
    double smallest_row, motion;  // of J, and what its rows are picked from
  };

  virtual ~ContactTerms() = default;
  /// Memory for contacts side by side. The arguments of Level::make_contacts.
  virtual void widen(const Scene& scene, const Contact& contact, const ContactSupport& support) = 0;
  /// rows: one, or after `widen` as many as fit side by side, alike to `contact` but for placements (`alike_rows`).
  virtual void evaluate(const Vec3<double>& gravity, const Contact& contact, std::span<const Rows> rows) = 0;
  virtual void evaluate(const Vec3<double>& gravity, std::span<JoiningRows> rows) = 0;
};

struct CutRobot;  // lanes/cut.hpp
class CutRobots;
struct PartPlan;  // lanes/parts.hpp
class Parts;

/// A level of instructions that kernels were compiled for.
struct Level {
  const char* name;
  int width;  // islands side by side
  /// island: any of the kernel's, in its scene.
  std::unique_ptr<Kernel> (*make)(const Scene& scene, const Island& island, const IslandSupport& support,
                                  std::shared_ptr<const KktPattern> pattern);
  std::unique_ptr<RobotTerms> (*make_robots)(std::shared_ptr<const Model> model);
  /// contact: any of the kernel's, in its scene, for which `moves_at_both_ends`.
  std::unique_ptr<ContactTerms> (*make_contacts)(const Scene& scene, const Contact& contact,
                                                 const ContactSupport& support);
  std::unique_ptr<CutRobots> (*make_cut)(std::shared_ptr<const CutRobot> robot);
  std::unique_ptr<Parts> (*make_parts)(std::shared_ptr<const PartPlan> plan);
};

/// The one that options ask for; nullptr: none, or it does not run here.
const Level* level_of(Lanes lanes);

/// Whether an island can stand in a lane: one robot that is not large, contacts on moving bodies of its.
bool fits(const Scene& scene, const Island& island);
/// Whether A is on a moving body, and B on one or in the world.
bool moves_at_both_ends(const Contact& contact);
/// Whether contacts of one type on the same joints can be evaluated side by side: alike but for placements.
bool alike_rows(const Contact& x, const Contact& y);
/// Whether robots of one model with contacts of one shape on them can stand side by side: these are alike but for B's
/// placement in the world.
bool alike(const Scene& scene, std::span<const int> contacts_x, std::span<const int> contacts_y);

}  // namespace manycontact::lanes
