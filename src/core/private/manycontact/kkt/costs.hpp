#pragma once
// Coefficients of predicted costs, for `auto` and threads. The unit, kPredictedSecond, is a multiply-add of CHOLMOD's
// simplicial factor on a core of 2020. `./run bench --fit` measures, fits relative errors, and prints this file.

namespace manycontact::costs {

inline constexpr double kPredictedSecond = 0.2e-9;  // s

// sparse-ldl: factor, solve and refinement, per row of K, entry of L, multiply-add, supernode, and index range that a
// supernode updates (shorter if contacts are ordered among the joints).
inline constexpr double kLdlRow = 17, kLdlEntry = 20, kLdlFlop = 0.18;
inline constexpr double kLdlBlock = 215, kLdlRange = 0.65, kLdlShortRange = 2.2;

// Kinematics, M, J and K, per row of K and per contact; contacts of islands too large for SIMD batches cost more.
inline constexpr double kTermsRow = 310, kTermsContact = 730, kTermsContactAlone = 670;

// sparse-cholmod, per call, row, entry, multiply-add.
inline constexpr double kCholmodCall = 8000, kCholmodRow = 50, kCholmodEntry = 26, kCholmodFlop = 1;

// sparse-bodies: per body with its joint (more with several coordinates), contact row, open row squared, update of an
// open row, multiply-add at the base. Subtrees of one shape share a SIMD batch.
inline constexpr double kBody = 1180, kBodyJoint = 3900, kBodyRow = 1100, kBodyOpen = 10, kBodyUpdate = 0.5,
                        kBodyBase = 1.0 / 12, kBodyAlike = 0.5;
inline constexpr double kBodyEliminated = 0.5;  // complete rows to which a coordinate is likely to give pivots

// dense: per call, multiply-add.
inline constexpr double kDenseCall = 8000, kDenseFlop = 0.22;

// Derivatives, products, and one iteration over an island's robots, in units of a solve.
inline constexpr double kDerivatives = 6, kProducts = 1, kWalk = 0.25;

// Derivatives robot by robot, in multiply-adds of a panel: products run faster than sparse solves, and panels are
// filled and read once more. A panel of dependent rows is always refined, and projected five times.
inline constexpr double kPanelProduct = 0.4, kPanelsOnceMore = 1.3, kPanelDropping = 2.5;

// A SIMD batch of n robots costs 1 + kTogether n times one robot (measured with 8 and with 2 robots).
inline constexpr double kTogether = 0.15;

// Work [s] for which waking a thread pays off; that takes microseconds.
inline constexpr double kWorthAThread = 3e-5;

// Bytes of an island's shape, kernels and factors, per entry of K and L and per row.
inline constexpr int kBytesOfEntry = 64, kBytesOfRow = 2000;

}  // namespace manycontact::costs
