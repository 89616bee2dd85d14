#pragma once
// The coefficients of predicted costs, from which `auto` chooses methods and orders and knows what is worth a thread.
// The unit is kPredictedSecond: a multiply-add of CHOLMOD's simplicial factor on a core of 2020. They are fitted to
// measured times by least squares of relative errors: `./run bench --fit` measures, fits and prints this file again.

namespace manycontact::costs {

inline constexpr double kPredictedSecond = 0.2e-9;  // s

// sparse-ldl: factor, solve and refinement, per row of K, entry of L, multiply-add; per supernode, and per index range
// that a supernode updates, whose ranges are shorter where contacts are among the joints.
inline constexpr double kLdlRow = 17, kLdlEntry = 20, kLdlFlop = 0.18;
inline constexpr double kLdlBlock = 215, kLdlRange = 0.65, kLdlShortRange = 2.2;

// Kinematics, M, J and K, per row of K and contact; of islands too large for a SIMD batch each contact costs more.
inline constexpr double kTermsRow = 310, kTermsContact = 730, kTermsContactAlone = 670;

// sparse-cholmod, per call, row, entry, multiply-add.
inline constexpr double kCholmodCall = 8000, kCholmodRow = 50, kCholmodEntry = 26, kCholmodFlop = 1;

// sparse-bodies: per body with its joint, more where that has several coordinates, contact row, open row squared,
// update of an open row, multiply-add at the base. Subtrees of one shape share a SIMD batch.
inline constexpr double kBody = 1180, kBodyJoint = 3900, kBodyRow = 1100, kBodyOpen = 10, kBodyUpdate = 0.5,
                        kBodyBase = 1.0 / 12, kBodyAlike = 0.5;
inline constexpr double kBodyEliminated = 0.5;  // complete rows that a coordinate is likely to give their pivots

// dense: per call, multiply-add.
inline constexpr double kDenseCall = 8000, kDenseFlop = 0.22;

// Derivatives, products, and one walk of a solve or product through an island's robots, in units of a solve.
inline constexpr double kDerivatives = 6, kProducts = 1, kWalk = 0.25;

// Derivatives robot by robot, in units of multiply-adds of a panel: a product runs faster than a sparse solve; panels
// are filled and read once more. A panel of dependent rows is always refined, and projected five times.
inline constexpr double kPanelProduct = 0.4, kPanelsOnceMore = 1.3, kPanelDropping = 2.5;

// A SIMD batch of n robots costs 1 + kTogether n of one alone (measured with 8 and with 2 robots).
inline constexpr double kTogether = 0.15;

// Work that is worth waking a thread for, in seconds: it takes microseconds.
inline constexpr double kWorthAThread = 3e-5;

// Bytes of an island's shape, kernels and factors, per entry of K and L and per row.
inline constexpr int kBytesOfEntry = 64, kBytesOfRow = 2000;

}  // namespace manycontact::costs
