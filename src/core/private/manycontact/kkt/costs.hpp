#pragma once
// Coefficients of predicted costs, for `auto` and for threads, in multiply-adds of CHOLMOD's simplicial factor
// (kPredictedSecond on a core of 2020). `./run bench --fit` measures and fits all costs, and prints this file.

namespace manycontact::costs {

inline constexpr double kPredictedSecond = 0.2e-9;  // duration of the unit of cost [s]

// sparse-ldl: costs of factor, solve and refinement, per row of K, entry of L, multiply-add, supernode, and index range
// that a supernode updates. Index ranges are short in the order contacts-early (kLdlShortRange).
inline constexpr double kLdlRow = 17, kLdlEntry = 20, kLdlFlop = 0.18;
inline constexpr double kLdlBlock = 215, kLdlRange = 0.65, kLdlShortRange = 2.2;

// Costs of computing kinematics, M, J and K: per row of K, per contact, and added per contact outside SIMD batches.
inline constexpr double kTermsRow = 310, kTermsContact = 730, kTermsContactAlone = 670;

// sparse-cholmod: costs per call, row of K, entry of L, and multiply-add.
inline constexpr double kCholmodCall = 8000, kCholmodRow = 50, kCholmodEntry = 26, kCholmodFlop = 1;

// sparse-bodies: costs per body, joint with several coordinates, contact row, squared number of rows that are open (not
// yet eliminated) at a body, update of an open row, and multiply-add at the base. kBodyAlike: factor on the cost of
// subtrees of one shape, which SIMD batches solve.
inline constexpr double kBody = 1180, kBodyJoint = 3900, kBodyRow = 1100, kBodyOpen = 10, kBodyUpdate = 0.5,
                        kBodyBase = 1.0 / 12, kBodyAlike = 0.5;
inline constexpr double kBodyEliminated = 0.5;  // rows that one coordinate is likely to eliminate

// dense: costs per call and per multiply-add.
inline constexpr double kDenseCall = 8000, kDenseFlop = 0.22;

// Costs of derivatives, of products with derivatives, and of one pass over an island's robots, as multiples of a solve.
inline constexpr double kDerivatives = 6, kProducts = 1, kWalk = 0.25;

// Factors on the cost of derivatives robot by robot. Dense products are faster per multiply-add than sparse solves, but
// panels are written and read once more. A panel with dependent rows is always refined, and projected five times.
inline constexpr double kPanelProduct = 0.4, kPanelsOnceMore = 1.3, kPanelDropping = 2.5;

// A SIMD batch of n robots costs 1 + kTogether n times as much as one robot (measured for 8 and 2 robots).
inline constexpr double kTogether = 0.15;

// Least work [s] for which another thread is used; waking a thread takes microseconds.
inline constexpr double kWorthAThread = 3e-5;

// Memory of an island's shape, kernels and factors in bytes, per entry of K and L, and per row of K.
inline constexpr int kBytesOfEntry = 64, kBytesOfRow = 2000;

}  // namespace manycontact::costs
