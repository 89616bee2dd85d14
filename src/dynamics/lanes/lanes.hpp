#pragma once
// Robots of one model in SIMD lanes: 2, 4 or 8 islands of one robot each, solved side by side by the same instructions.
// The kernels are compiled for several levels of instructions and chosen when the program runs. A robot's numbers do
// not depend on its lane, nor on who stands beside it.

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
  double *a, *f;                     // the islands' parts are written where the answer is sound
};

/// Derivatives of one island at the answer: X as IslandDerivatives has it, laid out for `request`.
struct Panel {
  double* X;
  int ld;       // a multiple of 8
  bool refine;  // once
};
/// What is differentiated: the solution, and where q, v, u begin among the columns.
struct DerivativeJob {
  const Scene& scene;
  std::uint64_t serial;
  const double *q, *v, *a, *f;
  const std::vector<int>& f_offset;
  DerivativeRequest request;
  int q_first, v_first, u_first;
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

/// A level of instructions that kernels were compiled for.
struct Level {
  const char* name;
  int width;  // islands side by side
  /// island: any of the kernel's, in its scene.
  std::unique_ptr<Kernel> (*make)(const Scene& scene, const Island& island, const IslandSupport& support,
                                  std::shared_ptr<const KktPattern> pattern);
};

/// All levels of this build that run here, the widest first.
std::span<const Level* const> levels();
/// The one that options ask for; nullptr: none, or it does not run here.
const Level* level_of(Lanes lanes);

/// Whether an island can stand in a lane: one robot that is not large, contacts on moving bodies of its.
bool fits(const Scene& scene, const Island& island);
/// Whether two islands of one shape and model can stand side by side: their contacts are alike but for B's placement in
/// the world.
bool alike(const Scene& scene, const Island& x, const Island& y);

}  // namespace manycontact::lanes
