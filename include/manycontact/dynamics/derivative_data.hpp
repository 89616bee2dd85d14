#pragma once
// Derivatives of accelerations and contact forces, as blocks per island.

#include <Eigen/SparseCore>

#include "manycontact/contact/derivatives.hpp"
#include "manycontact/contact/products.hpp"
#include "manycontact/kkt/island.hpp"

namespace manycontact {

/// What to compute. Columns that are not asked for cost nothing.
struct DerivativeRequest {
  bool q = true, v = true, u = true;
  bool forces = true;  // dforces_*; da_* always
  bool tau = false;    // da_du, dforces_du are with respect to torques on all velocity coordinates: nv columns, not nu
  bool operator==(const DerivativeRequest&) const = default;
};

/// One island's blocks, views into one row-major panel X with rows [a; f] and columns [q | v | u], all in the island's
/// order: robots ascending, contacts ascending. q on the tangent space.
struct IslandDerivatives {
  using Panel = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Panel X;  // row stride a multiple of 8; columns past the last are zero
  int nv = 0, nc = 0, nu = 0;
  int q_first = 0, v_first = 0, u_first = 0, cols = 0;
  DerivativeRequest request;
  std::vector<int> u_offset;  // per robot of the island: its first torque, and the total

  auto da_dq() const { return X.block(0, q_first, nv, request.q ? nv : 0); }
  auto da_dv() const { return X.block(0, v_first, nv, request.v ? nv : 0); }
  auto da_du() const { return X.block(0, u_first, nv, request.u ? nu : 0); }
  auto dforces_dq() const { return X.block(nv, q_first, nc, request.q ? nv : 0); }
  auto dforces_dv() const { return X.block(nv, v_first, nc, request.v ? nv : 0); }
  auto dforces_du() const { return X.block(nv, u_first, nc, request.u ? nu : 0); }
};

/// Workspace of an island with dependent contact rows, allocated when it is first differentiated.
struct DependentDerivatives {
  std::vector<Kinematics<double>> kin;  // per robot of the island, moving with y
  Eigen::VectorXd f, x, y;              // nc, size, nv
  IslandDerivatives::Panel D, kept;     // nc x nv, size x nv
  IslandDerivatives with_rho;           // nv columns
};

/// Everything `differentiate` computes and keeps.
struct DerivativeData {
  DerivativeData(const Scene& scene, const std::vector<ContactSupport>& supports);
  /// Gives the robots of each island places in the pool.
  void assign_slots(const Scene& scene, const std::vector<std::vector<int>>& islands);

  /// Terms of one robot, needed while its island is differentiated; islands take turns, so that they stay in the cache.
  struct Terms {
    RneaDerivatives rnea;
    std::vector<Vec6<double>> fext;  // per joint: contact forces, tree frame
  };
  std::vector<Terms> pool;
  std::vector<int> slot;  // per robot: its place in the pool
  Terms& of(int robot) { return pool[slot[robot]]; }

  std::vector<ContactData<double>> rows;     // per contact, at the solution's accelerations
  std::vector<ContactDerivatives> contacts;  // per contact
  std::vector<IslandDerivatives> islands;
  std::vector<DependentDerivatives> dependent;  // per island
  std::vector<char> nonzero;                    // scratch of the panel solve
  Eigen::VectorXd rhs;                          // scratch of refinement: room for the largest panel
};

/// Workspace of jvp and vjp.
struct ProductData {
  ProductData(const Scene& scene, const std::vector<ContactSupport>& supports);

  struct OfRobot {
    std::vector<BodyVariation> body;               // njoints: tangents, or adjoints
    std::vector<Vec6<double>> u;                   // njoints: virtual velocities
    std::vector<Vec6<double>> fext, dfext, f, df;  // njoints
    std::vector<double> w;                         // nv: change of the torques, or the vector behind u
  };
  std::vector<OfRobot> robots;
  std::vector<ContactData<double>> rows;  // per contact, at the solution's accelerations
  struct Dense {
    IslandDerivatives D;
    Eigen::VectorXd rows, columns;  // of D.X: what it gives, what it is applied to; or the other way round
  };
  std::vector<Dense> dense;            // per island: all its derivatives, where contact rows are dependent
  std::vector<double> b, x, r, scale;  // of an island's system, in place of the solve's, which its error bound needs
};

}  // namespace manycontact
