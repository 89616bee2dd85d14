#pragma once
// Every numeric threshold of the modules sparse, rank, kkt and dynamics that affects a solution, the choice of a
// method, or memory. All are relative, so without unit, unless the comment gives one; eps = 2.2e-16. The coefficients
// of predicted costs are in kkt/costs.hpp.

#include <cstddef>
#include <limits>

namespace manycontact::tolerance {

// ---- pivots and rank ------------------------------------------------------------------------------------------

/// Pivot relative to the terms it is computed from: |d| / (|A_kk| + sum l_kj^2 |d_j|). Rounding errors of the terms
/// leave n eps in the worst case, 1e-13 to 1e-12 for n of 1e3 to 1e4, and earlier pivots pass their errors on. Below
/// ten times that, a pivot cannot be distinguished from zero: its row of J has less than sqrt(1e-11) = 3e-6 of its
/// length orthogonal to the rows before it.
inline constexpr double kPivotLeft = 1e-11;

/// Row of J relative to the largest motion of its contact that it is computed from (motion_scale [J's units],
/// detail/contact/rows.hpp): smaller rows, or parts of rows orthogonal to the others, are rounding errors. It has the
/// same margin over rounding errors as kPivotLeft; here lengths are compared, not squares.
inline constexpr double kRank = 1e-11;

/// Units of eps of the scalar in use (double, quadruple): the error of a sum of six to eight products of 2 eps each.
inline constexpr int kRounding = 16;

/// Pivots of a damped K, in the same units: below this, the damping counts as lost (status regularised). A pivot of c
/// eps of its terms gives the forces a relative error of 1/c, which is below 1 % above this.
inline constexpr int kDampingRounding = 100 * kRounding;

/// sparse-bodies: pivot of a contact row relative to its pivot if its body were free: E_kk / sum_j (G_kj^2 / P_jj). A
/// row is eliminated at the first body where its pivot exceeds this; the body's inertia then grows by at most the
/// inverse. More growth loses later rows' digits: loops along thousands of links need a large value; waiting is slow.
inline constexpr double kRowMoves = 5e-2;
/// Rounding error of such a pivot relative to all that joints contributed, times its growth (factorize_bodies): 450
/// eps. Rows with smaller pivots, or pivots below kPivotLeft, are redundant.
inline constexpr double kRowRounding = 1e-13;

/// sparse-bodies: entry of J relative to the magnitudes of the products it sums: above this, the row certainly moves
/// that coordinate, and no other entry needs a check.
inline constexpr double kPlainlyMoves = 1e-3;

/// sparse-bodies: part of a row orthogonal to the rows before it on the same constrained body, relative to its length:
/// below this, that body's rows remain rows of K. Above it, one Gram-Schmidt pass makes them orthogonal to 1e-14.
inline constexpr double kHeldApart = 1e-2;
/// Part of the children's inertia that is kept along the rows of a constrained body. Any value solves the system; this
/// one gives a pivot to a body without inertia of its own.
inline constexpr double kHeldKept = 1e-2;

// ---- pairs of bodies ------------------------------------------------------------------------------------------

/// Pivots of a column-pivoted QR of the rows between two bodies, relative to the largest. Independent rows leave more
/// than the first, dependent ones less than the second, the rounding error of 12 to 100 rows. Points 1e-6 m apart, or
/// 1e6 m away from other points, are between the two. The factorization then decides: a basis of all rows would lose
/// the digits by which these differ.
inline constexpr double kPairIndependent = 1e-5, kPairDependent = 1e-13;

/// Relative velocities and displacements of two bodies, relative to the velocities and moment arms they are differences
/// of: below this, the bodies move as one, and damped contacts between them are consistent to first order.
inline constexpr double kMovesAsOne = 1e-13;

// ---- dependent rows -------------------------------------------------------------------------------------------

/// Residual J_k - sum z_j J_j of a dependent row k, relative to J's entries: the sum's own rounding error, below 1e-14
/// for the 30 terms of kLargestEntry, with a margin for the errors of J. An independent row whose pivot is kPivotLeft
/// leaves 3e-6, seven orders more; in between the dense reference solver decides.
inline constexpr double kRowLeft = 1e-13;

/// Largest coefficient z_j of a dependent row sum z_j J_j: the projector's error grows by its square, in units of eps,
/// and 30^2 eps = 2e-13 is below the allowed 1e-12. For larger z_j the null vectors are orthonormalised.
inline constexpr double kLargestEntry = 30;

/// Dropped and kept rows are exchanged until no z_j is larger than this. Each exchange multiplies the determinant of
/// N's dropped rows by more than this, so that exchanges end.
inline constexpr double kExchanged = 2;

/// Coefficients z_j below this (the dropped row's own is 1) are rounding errors.
inline constexpr double kNullEntry = 1e-15;

/// A column of the null space is refined while it leaves more than this of J's entries: a tenth of kRowLeft, the limit
/// for accepting it.
inline constexpr double kNullColumn = 1e-14;
inline constexpr int kNullColumnSteps = 2;

/// Damping of a row dropped from a factor whose pattern remains: any entry's square divided by it vanishes.
inline constexpr double kDroppedDamping = 1e200;

/// Most waiting rows of one robot in a SIMD batch: each has a column of its null space, which is dense there.
inline constexpr std::size_t kMostWaitingInBatch = 64;

/// Number of coordinates of an island from which on sparse-bodies drops rows itself. For smaller islands a factor of
/// the whole K takes no longer, and serves derivatives, too.
inline constexpr int kFewCoordinates = 100;

/// Joints along a chain after which a row that has moved none of them is compared with a basis of its body's motions.
inline constexpr int kManyJoints = 64;

/// Most rows, and equations of their balance, for which sparse-bodies searches a null vector along a chain (dense).
inline constexpr int kBalancedRows = 24, kBalanceEquations = 64;

/// Most entries of N for which dropped rows are exchanged, or columns orthonormalised: each step passes over all.
inline constexpr std::size_t kMostExchanged = 1 << 20;

/// Closed loops: neither the tolerance nor the constraint violation may exceed the first part of the largest moment
/// arm. The second is the factor from one tried pivot threshold to the next.
inline constexpr double kMostDrift = 1e-2, kNextPivot = 1e-2;
/// Entries of N for rows without a part in a dependence are 1e-2 at most. Reweighted least squares bring them below
/// kRank in three steps. The least weight, relative to the usual one, is for a column with entries of such rows only.
inline constexpr int kReweighted = 4;
inline constexpr double kLeastWeight = 1e-10;

// ---- large islands -----------------------------------------------------------------------------------------------

/// Most rows of J for which the dense solver confirms doubtful solutions of others: 300 take 30 ms, 600 take 170 ms.
inline constexpr int kFewRows = 300;
/// Most rows of K for which the dense solver is used after all others have failed: 3000 take 2 s and 72 MB a matrix.
inline constexpr int kDenseSize = 3000;
/// Most rows of K for which a factor of K differentiates islands solved by sparse-bodies, which would solve column by
/// column, 4 to 70 times as long if K's factor is sound. Otherwise the dense solver of a larger K takes longer.
inline constexpr int kDifferentiatedByMatrix = 1500;
/// Rows of K below which columns of derivatives may be solved one by one, in larger islands many times slower.
inline constexpr int kOneByOne = 400;
/// Rows of K below which |K^-1|_1 is computed from all columns of K^-1, and not estimated.
inline constexpr int kSmallInverse = 64;
/// Largest number of rows of a subtree of sparse-bodies in a SIMD batch. For more rows the quadratic cost dominates.
inline constexpr int kLargestSubtree = 64;
/// sparse-bodies: most complete rows that remain open above a node: a body has six directions, more rows are dependent.
inline constexpr int kMostOpen = 6;
/// sparse-bodies: upper bound of the part that the pivot of an open row must keep there, however large the growth.
inline constexpr double kMostKept = 1e-5;
/// Islands with this many rows of J, and this many times their coordinates, are overdetermined: `auto` uses the dense
/// method, whose cost is linear in the rows. From kTooFull rows on, so do the sparse methods with an order, whose
/// factor is full among the rows of one body.
inline constexpr int kOverdetermined = 300, kTimesOverdetermined = 4, kTooFull = 5000;

// ---- the proximal factor ----------------------------------------------------------------------------------------

/// delta relative to the largest diagonal entry of J M^-1 J^T: a thousand times the rounding error of its pivots.
/// Pivots of redundant rows are then below 4e-10 on walls of 3,600 boxes, others above 3e-8; 1e-10 would mix them.
inline constexpr double kProximal = 1e-12;
/// Pivots of dependent rows are delta (1 + |z|^2), with their coefficients z, usually below the first number times
/// delta; pivots of other rows are usually above the second. If one is between, K is factorized again with delta times
/// kStiffer. On uneven walls both kinds of rows have pivots of 1e6 delta.
inline constexpr double kPivotOfDependent = 1e2, kPivotOfOthers = 1e7, kStiffer = 10;
/// A pivot's rounding error changes its exponent by up to this many eps of its terms, relative to the pivot. The sum of
/// the exponents of all pivots may differ from an integer by the second number.
inline constexpr double kExponentRounding = 100, kExponentsLeft = 0.2;
/// Factor by which a projection reduces the component of the smallest eigenvalue of J M^-1 J^T, usually below 1e-3.
/// From 1/2 on rows count as nearly dependent, or from 1 / (2 kPivotOfDependent) on if pivots were not compared.
inline constexpr double kSlowest = 0.5;
inline constexpr int kMostApplications = 12;
/// Entries of projected random vectors, below which a row is in no null vector: a thousand times their rounding error.
inline constexpr double kInNullSpace = 1e-11;
/// Null-space component, relative to the vector, at which projection stops; the largest number of projections.
inline constexpr double kProjected = 1e-11;
inline constexpr int kProjections = 6;
/// J^T times projected random vectors may stop decreasing here, at rounding errors. An eigenvector of J M^-1 J^T that
/// the projection keeps would leave sqrt(delta), 1e-6.
inline constexpr double kMostLeft = 1e-11;
/// Each proximal step reduces the error by a factor of 1e3 or more; near a singular configuration by less.
inline constexpr int kProximalSteps = 30;
/// Contacts are inconsistent if steps leave more than this part of delta f in their rows. Inconsistent rows leave all
/// of it; otherwise rounding errors leave 1e-4 of it.
inline constexpr double kProximalAgree = 1e-2;

/// J^T times random vectors of the null space is a rounding error up to this many eps times the growth of K's entries.
inline constexpr double kGrown = 30;

// ---- refinement -----------------------------------------------------------------------------------------------

/// Backward error at which refinement stops: a few eps, the rounding error of the residual itself.
inline constexpr double kRefined = 1e-15;
inline constexpr int kRefinementSteps = 5;  // the error halves at least; two are usual

/// Backward error up to which a solution is accepted: errors of max(1e-12, 100 eps cond(K)) are allowed everywhere. eps
/// times the growth of K's entries counts as such an error: derivatives may show it though the solve did not.
inline constexpr double kConverged = 1e-12;

/// Growth of K's entries that costs a third of the digits: one refinement step squares that error to below eps. Beyond,
/// panels are judged by their own residuals.
inline constexpr double kMostGrowth = 1e6;

/// Backward error above which panels of derivatives are refined once. It is that of the unrefined solve or, if larger,
/// the factor's bound for every column. Derivatives are allowed 1000 eps cond(K) = 2.2e-13 cond(K), of which an
/// unrefined solve then takes less than a quarter.
inline constexpr double kRefinePanel = 5e-14;

/// dense-schur, derivatives: normwise residuals at which refinement stops, half of the 1000 eps allowed; up to
/// kConverged they are accepted. Derivatives robot by robot: componentwise backward errors that are accepted.
inline constexpr double kPanelRefined = 1e-13;
inline constexpr int kPanelSteps = 3;  // the first is the solve itself

/// Numbers below this have lost digits by underflow (normal ones end at 2e-308): such residuals are meaningless.
inline constexpr double kVanishing = 1e-290;

/// Quadruple precision: normwise residual of a solution that counts as exact, 1e4 times float128's eps = 2e-30. Each
/// step gains at least a factor of 2, usually 10 digits, and 30 digits are 100 factors of 2. A factor that gains less
/// than a factor of 4 a step is replaced by the dense solver in quadruple precision.
inline constexpr int kTruthRounding = 10000;  // units of eps of the scalar
inline constexpr int kTruthSteps = 60;

/// Relative correction of x below which |K| |x| need not be computed again.
inline constexpr double kSameSize = 1e-6;

// ---- single precision -----------------------------------------------------------------------------------------------

/// Factors on thresholds in floats: of a pivot or row (kPivotLeft, kRank), which become 1e-5, 100 eps of floats; and
/// of each of two pivots (kRowRounding), whose product must exceed 1e-7. Larger pivots are judged by their effect.
inline constexpr double kSingleLeft = 1e6, kSinglePassedOn = 1e3;
/// Largest change by rounding errors, relative to the largest acceleration and force, for a solution in single
/// precision to be accepted: two digits are left. The rounding errors of all terms are taken with random signs.
inline constexpr double kWorthless = 1e-2;

/// Largest term of a robot's rows, in their units, below which its floats may have underflowed (at 1e-38).
inline constexpr double kSmallestTerm = 1e-25;

/// 1 + trace of the rotation of an orientation error: floats are accurate to 1e-6, and below this (0.01 rad from half a
/// turn) they may take the opposite direction of rotation.
inline constexpr double kHalfTurn = 1e-4;

// ---- judging solutions ----------------------------------------------------------------------------------------

/// Contacts are inconsistent (mathematics.md) if |J a + a0| > 1e-8 (| |J| |a| | + |a0|), in maximum norms, with the two
/// exceptions below (kLoadRounding, kDriftRounding).
inline constexpr double kContradiction = 1e-8;

/// A row of J waits if its pivot is below this many times kPivotLeft, 1e-6 of its terms. The other rows' factor then
/// loses at most six digits, which refinement recovers.
inline constexpr double kWaits = 1e5;
/// Pivot of a waiting row in -S, relative to its terms, from which on the row is independent. Dependent rows leave
/// 1e-16 times the six digits that the factor may have lost; others left 1e-7 and more in all scenes that were tried.
inline constexpr double kJoins = 1e-9;
/// Most waiting rows in islands of more than kFewRows rows: each has a column of N, or one of S, which is dense.
/// Beyond, the proximal factor is cheaper.
inline constexpr int kMostWaiting = 24;

/// Rounding errors of accelerations that loads cause and contacts cancel: some thousand eps of gravity, or, without
/// gravity, a few eps of the accelerations of each robot's largest inertia by torques.
inline constexpr double kLoadRounding = 1e-12, kTorqueRounding = 1e-15;
/// Contacts are consistent if the residual of every row is at most this part of the largest term of its a0
/// (bias_acceleration_terms, [m/s^2] or [rad/s^2]): 500 eps, the rounding error of chains of up to hundreds of joints.
inline constexpr double kDriftRounding = 1e-13;
/// Derivatives include a term of the inconsistency if the residual exceeds this part, 20 eps, of these terms.
inline constexpr double kDriftNoise = 4e-15;

/// Smallest relative to largest row, of rows that are inconsistent in least squares: normal equations of the kept rows
/// square this ratio, and lose eight digits. Such islands are left to the dense reference solver.
inline constexpr double kGradedRows = 1e-4;

/// Largest deviation of a floating base's quaternion from unit length that is accepted: files may have 7 digits.
inline constexpr double kQuaternion = 1e-6;

/// Hager's and Higham's estimate of a 1-norm is a lower bound, nearly always within this factor.
inline constexpr double kNormEstimate = 3;
/// Error bounds, in eps of everything a row was computed from: this number plus that of the joints below the base that
/// its terms pass through.
inline constexpr int kBoundRounding = 12;

/// Terms of one equation relative to its own inertia or damping times the solution. Above this, their rounding errors
/// (kBoundRounding eps) may change the solution by 1 %, and its error bounds are checked.
inline constexpr double kInDoubt = 0.01 / (kBoundRounding * std::numeric_limits<double>::epsilon());

/// The forces that a damped solution is compared with are at least this part of the largest load.
inline constexpr double kLeastLoad = 1e-3;

/// If a backward error is above kConverged, rows are compared with this part of their data, against two lost digits.
inline constexpr double kPartOfData = 1e-2;

// ---- the precision `extended` ---------------------------------------------------------------------------------
// Solutions are refined in double-double, whose own rounding is about 2^-104.

/// Refinement has converged when the last correction of each robot's accelerations and each contact's forces is at most
/// this part of them (an eighth of double's rounding), or this part of the loads, which bounds solutions that vanish.
inline constexpr double kExtendedConverged = 0x1p-56, kExtendedVanishing = 0x1p-80;
/// A correction of more than kExtendedSlow times the one before ends refinement, since only rounding errors in
/// double-double are left. It has converged if the correction is at most these parts, the last digits of double.
inline constexpr double kExtendedSlow = 0.8;
inline constexpr double kExtendedStopped = 0x1p-52, kExtendedStoppedVanishing = 0x1p-60;
/// Least squares leave a residual of the right-hand side that may be far larger than the terms of the solution. Its
/// last change must be at most this part of it, or of the loads, or the third part where refinement stops.
inline constexpr double kExtendedDigits = 0x1p-96, kExtendedDigitsVanishing = 0x1p-110,
                        kExtendedDigitsStopped = 0x1p-85;
/// Rows are exactly dependent if forces n exist with J^T n at most this part of its terms. The rounding of a state to
/// double leaves 2^-53.
inline constexpr double kExtendedDependent = 0x1p-75;
/// Steps of refinement, enough up to a condition where each gains half a binary digit.
inline constexpr int kExtendedSteps = 60;
/// Numbers of a scene (placements, inertias, quaternions) are rounded when they are read. The error of a solution that
/// follows from this is at most kReadRounding of it and kReadShare of the bound by |K^-1|, which counts kBoundRounding
/// eps of each term: four of these. With 1/12, the median of bound over error would be 78 in place of 311, but 6 of
/// 42,000 random scenes exceeded their bound by up to 2.5 times. The precision `extended` is judged by the scene as
/// read: its share is 2^-104 / 2^-53, and 32 for the constants of sums and products in double-double.
inline constexpr double kReadRounding = 0x1p-48, kReadShare = 1.0 / 3, kExtendedShare = 0x1p-46;

// ---- choosing -------------------------------------------------------------------------------------------------

/// Another order is chosen if its predicted cost is below this part of the present one's: predictions are not more
/// exact, and leaf-to-root is the most accurate order.
inline constexpr double kCheaper = 0.9;

/// The last pivot of a QR decomposition of some of J's columns, relative to the length of J's rows, that is required of
/// the coordinates before a contact that is eliminated early. The second is chosen if the order is then cheaper.
inline constexpr double kDistinct[] = {1e-2, 1e-3};

/// At most 1 / kZeros of a relaxed supernode are structural zeros; columns with fewer than kShort entries stay as is.
inline constexpr int kZeros = 12, kShort = 16;

}  // namespace manycontact::tolerance
