#pragma once
// A robot's block of the island's K. Its border are the rows of contacts that couple robots. They come last and are not
// eliminated here (systems/robots/interface.hpp). A BlockPlan contains them as contacts with the world.

#include <algorithm>

#include "manycontact/kkt/shape.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

/// An array for the body of a coupling contact on one robot: the origin of the body's tree frame in the world; the
/// body's placement oMi, velocity v and acceleration a; and the motion columns of the coordinates that move the body.
struct JoinedEnd {
  static std::size_t size(std::size_t coordinates) { return 30 + 6 * coordinates; }
};
/// A JoinedEnd with further columns for derivatives: Psid, Psidd, Sv (detail/algorithm/rnea_derivatives.hpp).
struct MovingEnd {
  static std::size_t size(std::size_t coordinates) { return 30 + 24 * coordinates; }
};
/// EndForce, an array that overwrites a MovingEnd: the contact's force on the body, in the tree frame; the robot's
/// columns of ContactData::Jl; the columns of JoinTerms' D_A or D_B for the robot's own coordinates, row-major.

/// A contact's frame that is fixed to the world or to a robot's base: `frame` is relative to `origin`, in world axes.
/// The origin is that of the contact's frame in the world, or that of the base.
template <class S>
struct StandingEnd {
  SE3<S> frame;
  Vec3<S> origin;
};
inline StandingEnd<double> standing_end(const Scene& scene, const Attachment& at) {
  if (at.robot < 0) return {{at.placement.R, Vec3<double>::Zero()}, at.placement.p};
  const SE3<double>& base = scene.robots[at.robot].base;
  return {{base.R * at.placement.R, base.R * at.placement.p}, base.p};
}

struct BlockPlan {  // constant data shared by robots of one structure with contacts of one shape
  Scene scene;  // one such robot and its contacts: first the contacts on it alone, then the coupling contacts
  Island island;
  int alone = 0;                              // number of contacts on the robot alone
  std::shared_ptr<const KktPattern> pattern;  // pattern of K and the border
  std::shared_ptr<const KktPattern> inner;    // pattern of K_r, without the border, in the order of `pattern`
  sparse::LdlSchedule bordered;               // elimination of all columns but the border's; empty without a border
  std::vector<ContactSupport> supports;

  const std::shared_ptr<const Model>& model() const { return scene.robots.front().model; }
  int border() const { return pattern->size() - inner->size(); }  // rows of the coupling contacts
  const sparse::LdlSchedule& schedule() const { return border() > 0 ? bordered : pattern->schedule(); }

  std::size_t joins() const { return supports.size() - static_cast<std::size_t>(alone); }
  template <class End>
  std::size_t size_of_ends(std::size_t count) const {  // numbers in the first `count` ends
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k) size += End::size(supports[alone + k].a.size());
    return size;
  }
  std::size_t joins_size() const { return size_of_ends<JoinedEnd>(joins()); }
  std::size_t ends_size() const { return size_of_ends<MovingEnd>(joins()); }

  /// Number of entries of K and b. JoinedEnds follow them in memory, until `factor` overwrites these with L, D, x, w.
  std::size_t kept_size() const { return static_cast<std::size_t>(pattern->K.nonzeros() + pattern->size()); }
  std::size_t memory_size() const { return waiting_at() + waiting_size(); }
  std::size_t waiting_at() const {  // offset of the memory of WaitingRows
    const auto factor = static_cast<std::size_t>(pattern->ldl.nonzeros() + 3 * pattern->size());
    return kept_size() + std::max(factor, joins_size());
  }
  std::size_t waiting_size() const {
    const std::size_t most = most_waiting(), of_J = rows() - pattern->nv;
    return 2 + (4 + 2 * most) * static_cast<std::size_t>(rows()) + most + (most * (2 * of_J + 3) + 3) / 2;
  }
  std::size_t most_waiting() const {
    return std::min(tolerance::kMostWaitingInBatch, static_cast<std::size_t>(rows() - pattern->nv));
  }
  int rows() const { return inner->size(); }                       // number of eliminated rows
  int factor_nonzeros() const { return pattern->ldl.Lp[rows()]; }  // entries of L below its diagonal
};

/// Derivative terms of a contact that couples robots A and B, in consecutive arrays; r2 are its rows of J a + a0.
/// Column-major: J (rows x cols), W (rows x 6), -dr2/dq, -dr2/dv (rows x cols). Row-major and padded to 8 columns: D_A,
/// D_B (6 x cols), the change with q of the force on A or B, in A's axes, relative to a force fixed to the body.
struct JoinTerms {
  double* J;
  int rows, cols;
  static int padded(int cols) { return (cols + 7) / 8 * 8; }
  static std::size_t size(int rows, int cols) {
    return static_cast<std::size_t>(3 * rows * cols + 6 * rows + 12 * padded(cols));
  }
  double* W() const { return J + rows * cols; }
  double* dq() const { return W() + 6 * rows; }
  double* dv() const { return dq() + rows * cols; }
  double* D_B() const { return dv() + rows * cols + 6 * padded(cols); }
};

/// A robot's parts of its m border rows (of coupling contacts), in consecutive arrays. G: its columns of these rows.
struct Border {
  double* S = nullptr;  // upper triangle, by columns, of the Schur complement
  int m = 0;
  static std::size_t size(int m) { return static_cast<std::size_t>(m) * (m + 1) / 2 + 5 * m; }
  double* terms() const { return S + m * (m + 1) / 2; }  // per diagonal entry of S, sum of its terms' magnitudes
  double* b() const { return terms() + m; }              // contribution to the right-hand side of S y
  double* y() const { return b() + m; }                  // input: the solution, or its last step, in the border rows
  double* r() const { return y() + m; }                  // -G x, the contribution to the residual
  double* scale() const { return r() + m; }              // |G| |x|
};

}  // namespace manycontact::lanes
