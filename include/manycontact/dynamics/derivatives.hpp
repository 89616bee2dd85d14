#pragma once
// Derivatives of accelerations and contact forces, as blocks per island.

#include <cstdint>
#include <vector>

#include "manycontact/dynamics/aligned_panel.hpp"

namespace manycontact {

/// What to compute. Columns that are not asked for cost nothing.
struct DerivativeRequest {
  bool q = true, v = true, u = true;
  bool forces = true;   // dforces_*; da_* always
  bool tau = false;     // da_du, dforces_du are with respect to torques on all velocity coordinates: nv columns, not nu
  bool pushes = false;  // da_dw, dforces_dw
  bool operator==(const DerivativeRequest&) const = default;
};

/// Which solution something was computed from, and which is at hand now.
struct Stamp {
  const std::uint64_t* now = nullptr;
  std::uint64_t serial = 0;
  bool current() const { return now && serial != 0 && *now == serial; }  // of the one at hand
};

/// One island's blocks, views into one row-major panel X with rows [a; f] and columns [q | v | u], all in the island's
/// order: robots ascending, contacts ascending. q on the tangent space. The views throw std::logic_error when the scene
/// was solved again, or its contacts were switched, since they were computed.
struct IslandDerivatives {
  using Panel = AlignedPanel::Matrix;
  AlignedPanel X;           // row stride a multiple of 8; columns past the last are zero. Read it through the views
  AlignedPanel W;           // the same by the wrenches of pushes, columns [w], where they were asked for
  std::vector<int> pushes;  // on the island's robots, ascending
  int nv = 0, nc = 0, nu = 0;
  int q_first = 0, v_first = 0, u_first = 0, cols = 0;
  DerivativeRequest request;
  std::vector<int> u_offset;  // per robot of the island: its first torque, and the total
  Stamp stamp;

  auto da_dq() const { return block(0, q_first, nv, request.q ? nv : 0); }        // nv x nv
  auto da_dv() const { return block(0, v_first, nv, request.v ? nv : 0); }        // nv x nv
  auto da_du() const { return block(0, u_first, nv, request.u ? nu : 0); }        // nv x nu
  auto dforces_dq() const { return block(nv, q_first, nc, request.q ? nv : 0); }  // nc x nv
  auto dforces_dv() const { return block(nv, v_first, nc, request.v ? nv : 0); }  // nc x nv
  auto dforces_du() const { return block(nv, u_first, nc, request.u ? nu : 0); }  // nc x nu
  // by [force; torque] of each of `pushes`, in the axes that it is stated in: 6 columns each
  auto da_dw() const { return block(W, 0, 0, nv, of_pushes()); }        // nv x 6 pushes
  auto dforces_dw() const { return block(W, nv, 0, nc, of_pushes()); }  // nc x 6 pushes
  /// Throws std::logic_error unless these are derivatives of the solution at hand.
  void check() const;

 private:
  Eigen::Block<const AlignedPanel::View> block(int row, int col, int rows, int columns) const {
    return block(X, row, col, rows, columns);
  }
  Eigen::Block<const AlignedPanel::View> block(const AlignedPanel& of, int row, int col, int rows, int columns) const {
    check();
    return of.block(row, col, rows, columns);
  }
  int of_pushes() const { return request.pushes ? 6 * static_cast<int>(pushes.size()) : 0; }
};

/// By differentiate: one entry per island, as report.islands has them.
struct DerivativeData {
  std::vector<IslandDerivatives> islands;
};

}  // namespace manycontact
