#pragma once
// Derivatives of accelerations and contact forces, as blocks per island (robots coupled by contacts or springs).

#include <cstdint>
#include <vector>

#include "manycontact/detail/dynamics/aligned_panel.hpp"

namespace manycontact {

/// Selects the variables to differentiate with respect to. Columns that are not requested cost nothing.
struct DerivativeRequest {
  bool q = true, v = true, u = true;
  bool forces = true;     // whether to compute dforces_*; the blocks da_* are always computed
  bool tau = false;       // whether da_du, dforces_du are with respect to the torques of all velocity coordinates: nv
                          // columns instead of nu
  bool wrenches = false;  // whether to compute da_dw, dforces_dw
  bool operator==(const DerivativeRequest&) const = default;
};

/// Identifies the solution at which derivatives were computed, to detect a later solve.
struct Stamp {
  const std::uint64_t* now = nullptr;  // number of the current solution of the data
  std::uint64_t serial = 0;            // number of the solution at which derivatives were computed
  /// Returns whether no later solve has replaced the solution.
  bool current() const { return now && serial != 0 && *now == serial; }
};

/// The blocks of one island. They are views of one row-major panel X with rows [a; f] and columns [q | v | u], in the
/// island's order: robots ascending, contacts ascending. Derivatives with respect to q are on the tangent space. Units
/// are the quotients of those in `solve`. The views throw std::logic_error if the scene was solved again, or its
/// contacts were switched, since the blocks were computed.
struct IslandDerivatives {
  using Panel = AlignedPanel::Matrix;
  AlignedPanel X;           // use the views instead; the row stride is a multiple of 8, padded by zero columns
  AlignedPanel W;           // rows as X, columns [w]: with respect to the external wrenches, if requested
  std::vector<int> wrenches;  // numbers of the external wrenches on the island's robots, ascending
  int nv = 0, nc = 0, nu = 0;
  int q_first = 0, v_first = 0, u_first = 0, cols = 0;
  DerivativeRequest request;
  std::vector<int> u_offset;  // the first torque column of each robot of the island, then the number of torque columns
  Stamp stamp;

  auto da_dq() const { return block(0, q_first, nv, request.q ? nv : 0); }        // nv x nv
  auto da_dv() const { return block(0, v_first, nv, request.v ? nv : 0); }        // nv x nv
  auto da_du() const { return block(0, u_first, nv, request.u ? nu : 0); }        // nv x nu
  auto dforces_dq() const { return block(nv, q_first, nc, request.q ? nv : 0); }  // nc x nv
  auto dforces_dv() const { return block(nv, v_first, nc, request.v ? nv : 0); }  // nc x nv
  auto dforces_du() const { return block(nv, u_first, nc, request.u ? nu : 0); }  // nc x nu
  // Derivatives with respect to [force; torque] of each of `wrenches`, in the wrench's own axes: 6 columns per wrench.
  auto da_dw() const { return block(W, 0, 0, nv, of_wrenches()); }        // nv x 6 `wrenches`
  auto dforces_dw() const { return block(W, nv, 0, nc, of_wrenches()); }  // nc x 6 `wrenches`
  /// Throws std::logic_error unless these are derivatives of the current solution.
  void check() const;

 private:
  Eigen::Block<const AlignedPanel::View> block(int row, int col, int rows, int columns) const {
    return block(X, row, col, rows, columns);
  }
  Eigen::Block<const AlignedPanel::View> block(const AlignedPanel& of, int row, int col, int rows, int columns) const {
    check();
    return of.block(row, col, rows, columns);
  }
  int of_wrenches() const { return request.wrenches ? 6 * static_cast<int>(wrenches.size()) : 0; }
};

/// The result of `differentiate`: one entry per island, in the order of report.islands. `solved_island` lists the
/// robots and contacts of an entry.
struct DerivativeData {
  std::vector<IslandDerivatives> islands;
};

}  // namespace manycontact
