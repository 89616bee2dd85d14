#pragma once
// A robot as a block of its island's K, bordered by the rows of contacts that couple it to other robots. In the block
// these are contacts with the world; their rows come last and are not eliminated (systems/robots/interface.hpp).

#include <algorithm>

#include "manycontact/kkt/shape.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

/// A robot's array for a coupling contact: origin, oMi, v, a of the contact's body, and the columns of J that move it.
struct JoinedEnd {
  static std::size_t size(std::size_t coordinates) { return 30 + 6 * coordinates; }
};
/// Its array for derivatives: JoinedEnd, then Psid, Psidd, Sv of these columns (detail/algorithm/rnea_derivatives.hpp).
struct MovingEnd {
  static std::size_t size(std::size_t coordinates) { return 30 + 24 * coordinates; }
};
/// Results overwrite a MovingEnd (EndForce): the contact's force on the body, in the tree frame; the columns of J_l;
/// and, row-major, D of the robot's own coordinates (JoinTerms).

/// The end of a contact that is fixed to the world or to a base. `frame` is relative to `origin`, in world axes; the
/// origin is the contact's own in the world, and the base's otherwise.
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

/// Constant data shared by robots of one structure with contacts of one shape.
struct BlockPlan {
  Scene scene;  // one such robot and its contacts: first those on it alone, then those that couple it
  Island island;
  int alone = 0;                              // number of contacts on it alone
  std::shared_ptr<const KktPattern> pattern;  // pattern of all rows
  std::shared_ptr<const KktPattern> inner;    // pattern without the border, in the same order
  sparse::LdlSchedule bordered;               // schedule of all columns but the border's, if there is one
  std::vector<ContactSupport> supports;

  const std::shared_ptr<const Model>& model() const { return scene.robots.front().model; }
  int border() const { return pattern->size() - inner->size(); }  // rows of the coupling contacts
  const sparse::LdlSchedule& schedule() const { return border() > 0 ? bordered : pattern->schedule(); }

  std::size_t joins() const { return supports.size() - static_cast<std::size_t>(alone); }
  /// Return the sizes of Robot::joins and of Robot::ends.
  template <class End>
  std::size_t size_of_ends(std::size_t count) const {  // the first `count` ends
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k) size += End::size(supports[alone + k].a.size());
    return size;
  }
  std::size_t joins_size() const { return size_of_ends<JoinedEnd>(joins()); }
  std::size_t ends_size() const { return size_of_ends<MovingEnd>(joins()); }

  /// Size of K and b, which all steps keep. The joins are behind them, until `factor` writes L, D, x, w there.
  std::size_t kept_size() const { return static_cast<std::size_t>(pattern->K.nonzeros() + pattern->size()); }
  std::size_t memory_size() const { return waiting_at() + waiting_size(); }
  /// Offset of the memory of WaitingRows, and its size.
  std::size_t waiting_at() const {
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
  int rows() const { return inner->size(); }                       // eliminated rows
  int factor_nonzeros() const { return pattern->ldl.Lp[rows()]; }  // entries of L below its diagonal
};

/// Derivative terms of a contact that couples two robots, in consecutive arrays. Column-major: J and W (rows x cols,
/// rows x 6), -dr2/dq and -dr2/dv (rows x cols). Row-major, padded to multiples of eight: D_A and D_B (6 x cols), the
/// derivative of the contact's force on A and B in A's axes, relative to a force fixed to the body.
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

/// A robot's part of its m border rows, in consecutive arrays.
struct Border {
  double* S = nullptr;  // upper triangle, by columns, of the Schur complement
  int m = 0;
  static std::size_t size(int m) { return static_cast<std::size_t>(m) * (m + 1) / 2 + 5 * m; }
  double* terms() const { return S + m * (m + 1) / 2; }  // sums of the magnitudes of terms of S's diagonal
  double* b() const { return terms() + m; }              // right-hand side
  double* y() const { return b() + m; }                  // the solution in these rows
  double* r() const { return y() + m; }                  // -G x: the robot's part of the residual
  double* scale() const { return r() + m; }              // |G| |x|
};

}  // namespace manycontact::lanes
