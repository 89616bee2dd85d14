#pragma once
// All numeric thresholds of the modules sparse, rank, kkt and dynamics. They have no unit unless the comment gives one.
// eps = 2.2e-16. K = [M J^T; J -delta I] is an island's matrix, N a basis of the null space of J^T, and a0 the bias in
// J a + a0 = 0. A dependent row is J_k = sum z_j J_j over kept rows j. Coefficients of costs are in kkt/costs.hpp.

#include <cstddef>
#include <limits>

namespace manycontact::tolerance {

// ---- pivots and rank ------------------------------------------------------------------------------------------

/// Least sound pivot d_k of A = L D L^T relative to its terms: |d_k| / (|A_kk| + sum l_kj^2 |d_j|). Rounding errors of
/// n terms reach n eps, 1e-13 to 1e-12 for n of 1e3 to 1e4, and errors of earlier pivots add to them. The limit is ten
/// times that error. If a row of J has a smaller pivot, less than sqrt(1e-11) = 3e-6 of its length is orthogonal to the
/// rows before it.
inline constexpr double kPivotLeft = 1e-11;

/// Least length of a row of J, or of its part orthogonal to other rows, relative to the largest motion of its contact
/// (motion_scale [J's units], detail/contact/rows.hpp). Smaller lengths are rounding errors. kPivotLeft is equal but
/// compares squares of lengths.
inline constexpr double kRank = 1e-11;

/// Rounding error of a sum of six to eight products of 2 eps each, in eps of the scalar in use (double or quadruple).
inline constexpr int kRounding = 16;

/// Least sound pivot of a damped K, relative to eps (of the scalar in use) times the pivot's terms. At this limit the
/// pivot's rounding error, kRounding eps, changes forces by 1 %. Smaller pivots give the status regularised, as
/// rounding hides the damping.
inline constexpr int kDampingRounding = 100 * kRounding;

/// sparse-bodies: least ratio of a contact row's pivot E_kk to the pivot that the row would have if its body were free,
/// sum_j G_kj^2 / P_jj (symbols: kkt/bodies/ldl.hpp). Each row is eliminated at the first body, from the leaves on,
/// where the ratio is larger. P then grows by at most the inverse ratio, which costs later rows digits in loops of
/// thousands of links. A larger threshold costs time.
inline constexpr double kRowMoves = 5e-2;
/// Rounding error of a pivot of K relative to the pivot's terms, 450 eps. Small earlier pivots enlarge it
/// (rank/pivots.hpp). In sparse-bodies it is multiplied by the squared growth of P (least_left in
/// kkt/bodies/factorize.cpp), and rows with smaller pivots are redundant.
inline constexpr double kRowRounding = 1e-13;

/// sparse-bodies: an entry of J is certainly nonzero if it exceeds this fraction of the magnitudes of the products of
/// which it is the sum. No other entry of its row is checked then.
inline constexpr double kPlainlyMoves = 1e-3;

/// sparse-bodies: least part of a row that is orthogonal to the rows before it on the same constrained body, relative
/// to the row's length. Above this limit, one Gram-Schmidt pass makes the rows orthogonal to 1e-14. If a row is below
/// the limit, the body is not projected (BodyHold in kkt/bodies/ldl.hpp).
inline constexpr double kHeldApart = 1e-2;
/// sparse-bodies: factor on the children's inertia in the directions of the rows that constrain a body (BodyHold in
/// kkt/bodies/ldl.hpp). Any factor gives the same solution; a positive factor gives a sound pivot to a body without
/// inertia of its own.
inline constexpr double kHeldKept = 1e-2;

// ---- pairs of bodies ------------------------------------------------------------------------------------------

/// Limits on pivots of a column-pivoted QR of the rows between two bodies, relative to the largest pivot. Pivots above
/// kPairIndependent count for the rank; pivots below kPairDependent are rounding errors of 12 to 100 rows. Points 1e-6
/// m apart, or 1e6 m from other points, give pivots between the limits. The rows are then not replaced by a basis,
/// which would lose the digits in which nearly equal rows differ; the factorization of K finds the rank.
inline constexpr double kPairIndependent = 1e-5, kPairDependent = 1e-13;

/// Largest relative velocity or displacement at which two bodies move as one, as a fraction of the velocities or moment
/// arms whose difference it is. Damped contacts between two such bodies are consistent to first order.
inline constexpr double kMovesAsOne = 1e-13;

// ---- dependent rows -------------------------------------------------------------------------------------------

/// Largest residual J_k - sum z_j J_j of a dependent row k, relative to J's entries. The sum's rounding error is below
/// 1e-14 for the 30 terms of kLargestEntry; the margin is for errors of J. An independent row whose pivot is kPivotLeft
/// leaves 3e-6. For residuals between kRowLeft and 3e-6 the dense reference solver decides.
inline constexpr double kRowLeft = 1e-13;

/// Largest coefficient z_j of a dependent row sum z_j J_j. The error of the projector on N grows as z_j^2 eps, and
/// 30^2 eps = 2e-13 is below the allowed 1e-12. For larger z_j the null vectors are orthonormalised.
inline constexpr double kLargestEntry = 30;

/// Dropped rows are exchanged with kept rows until no coefficient z_j is larger than this. Each exchange multiplies the
/// determinant of the dropped rows of N by more than this factor, so that the exchanges end.
inline constexpr double kExchanged = 2;

/// Coefficients z_j below this are rounding errors; the coefficient of the dropped row itself is 1.
inline constexpr double kNullEntry = 1e-15;

/// A column n of the null space basis N is refined while |J^T n| exceeds this fraction of J's entries, at most
/// kNullColumnSteps times. It is accepted up to the fraction kRowLeft, which is ten times as large.
inline constexpr double kNullColumn = 1e-14;
inline constexpr int kNullColumnSteps = 2;

/// Damping that replaces the diagonal entry of a dropped row, so that the factor keeps its pattern. The row's squared
/// entries divided by this damping vanish.
inline constexpr double kDroppedDamping = 1e200;

/// Largest number of waiting rows (rows of J without a sound pivot) of one robot in a SIMD batch. Each such row adds a
/// dense column to N.
inline constexpr std::size_t kMostWaitingInBatch = 64;

/// Least number of coordinates of an island in which sparse-bodies drops dependent rows itself. For smaller islands a
/// factor of the whole K takes no longer, and derivatives can use that factor, too.
inline constexpr int kFewCoordinates = 100;

/// sparse-bodies: number of joints, from a row's body towards the base, at which the row's entries are checked one by
/// one. If none is certainly nonzero, the row is compared with a basis of all motions of the body reached.
inline constexpr int kManyJoints = 64;

/// sparse-bodies: largest numbers of rows and of balance equations in the dense system from which a null vector of rows
/// along a chain is computed (Balance in kkt/bodies/dependent_rows.cpp).
inline constexpr int kBalancedRows = 24, kBalanceEquations = 64;

/// Largest number of entries of a cluster of columns of N whose rows are exchanged or whose columns are
/// orthonormalised. Each such step passes over all entries.
inline constexpr std::size_t kMostExchanged = 1 << 20;

/// Rows made dependent within a tolerance (within_tolerance.cpp). kMostDrift is the largest tolerance or constraint
/// violation, relative to the largest moment arm. kNextPivot is the ratio of a tried pivot threshold to the one before.
inline constexpr double kMostDrift = 1e-2, kNextPivot = 1e-2;
/// Rows made dependent within a tolerance (within_tolerance.cpp): largest number of reweighting steps of a column of N.
/// Three suffice to reduce entries in rows outside the dependence from 1e-2 to below kRank. kLeastWeight is the least
/// weight of a coordinate, relative to its initial weight.
inline constexpr int kReweighted = 4;
inline constexpr double kLeastWeight = 1e-10;

// ---- large islands -----------------------------------------------------------------------------------------------

/// Largest number of rows of J for which the dense solver checks doubtful solutions of other methods. It takes 30 ms
/// for 300 rows, 170 ms for 600.
inline constexpr int kFewRows = 300;
/// Largest number of rows of K for which the dense solver is used after all other methods failed. For 3000 rows it
/// takes 2 s, and 72 MB per matrix.
inline constexpr int kDenseSize = 3000;
/// Largest number of rows of K for which a factor of K computes the derivatives of islands that sparse-bodies solved.
/// sparse-bodies takes 4 to 70 times as long, column by column. For a larger K, the dense solver would take even longer
/// if that factor is not sound.
inline constexpr int kDifferentiatedByMatrix = 1500;
/// Number of rows of K below which columns of derivatives may be solved one by one, which is many times slower in
/// larger islands.
inline constexpr int kOneByOne = 400;
/// Largest number of rows of K for which |K^-1|_1 is computed from all columns of K^-1, and not estimated.
inline constexpr int kSmallInverse = 64;
/// Largest number of rows of a sparse-bodies subtree that is solved in a SIMD batch. The cost is quadratic in the rows.
inline constexpr int kLargestSubtree = 64;
/// sparse-bodies: largest number of rows with both ends in a node's subtree that are not yet eliminated at the node. A
/// body has only six directions of motion.
inline constexpr int kMostOpen = 6;
/// sparse-bodies: upper limit of the rounding error of a row's pivot relative to its terms, as least_left
/// (kkt/bodies/factorize.cpp) estimates it from the growth of P.
inline constexpr double kMostKept = 1e-5;
/// An island is overdetermined if it has at least kOverdetermined rows of J, and more than kTimesOverdetermined rows
/// per coordinate. `auto` solves it by the dense method, at a cost linear in the rows. From kTooFull rows on, the dense
/// method also replaces sparse methods with an elimination order, whose factor is full among the rows of one body.
inline constexpr int kOverdetermined = 300, kTimesOverdetermined = 4, kTooFull = 5000;

// ---- the proximal factor ----------------------------------------------------------------------------------------

/// Damping delta relative to the largest diagonal entry of J M^-1 J^T: 1000 times the rounding error of the pivots. On
/// walls of 3600 boxes, redundant rows then have pivots below 4e-10, others above 3e-8; 1e-10 would mix them.
inline constexpr double kProximal = 1e-12;
/// The pivot of a dependent row is delta (1 + |z|^2), with the row's coefficients z. It is usually below
/// kPivotOfDependent delta; pivots of other rows are usually above kPivotOfOthers delta. If a pivot is between these
/// limits, K is factorized again with delta times kStiffer. On uneven walls both kinds of rows have pivots of 1e6
/// delta.
inline constexpr double kPivotOfDependent = 1e2, kPivotOfOthers = 1e7, kStiffer = 10;
/// A pivot of K is proportional to a power of delta. Rounding errors change its exponent by up to kExponentRounding eps
/// times the pivot's terms over the pivot. The sum of all exponents may differ from an integer by kExponentsLeft.
inline constexpr double kExponentRounding = 100, kExponentsLeft = 0.2;
/// One application of E (kkt/factor/proximal.hpp) must multiply the part of a vector outside the null space by at most
/// this, usually by 1e-3; otherwise rows are only nearly dependent. If the pivots were not compared with those of a
/// second delta, the limit is 1 / (2 kPivotOfDependent). E is applied less than kMostApplications times.
inline constexpr double kSlowest = 0.5;
inline constexpr int kMostApplications = 12;
/// A row is in no null vector if its entries in projected random vectors are below 1000 times their rounding error.
inline constexpr double kInNullSpace = 1e-11;
/// A projection ends when the null-space part of the vector, relative to the vector, is below kProjected, or after
/// kProjections passes.
inline constexpr double kProjected = 1e-11;
inline constexpr int kProjections = 6;
/// Projected random vectors are accepted as null vectors if J^T times the vectors stops decreasing below this, at
/// rounding errors. If the projection wrongly kept an eigenvector of J M^-1 J^T, sqrt(delta) = 1e-6 would remain.
inline constexpr double kMostLeft = 1e-11;
/// Largest number of proximal steps. Each step reduces the error by a factor of 1e3 or more, but by less near a
/// singular configuration.
inline constexpr int kProximalSteps = 30;
/// Contacts are inconsistent if proximal steps leave a residual above this fraction of delta f in their rows.
/// Inconsistent rows leave all of delta f; in consistent rows, rounding errors leave 1e-4 of delta f.
inline constexpr double kProximalAgree = 1e-2;

/// J^T times a random null vector is a rounding error if it is below this many eps times the growth of K's entries.
inline constexpr double kGrown = 30;

// ---- refinement -----------------------------------------------------------------------------------------------

/// Backward error at which refinement stops: a few eps, the rounding error of the residual itself.
inline constexpr double kRefined = 1e-15;
inline constexpr int kRefinementSteps = 5;  // each step at least halves the error; two steps are usual

/// Largest accepted backward error of a solution, whose own error may then be max(1e-12, 100 eps cond(K)). The same
/// limit applies to eps times the growth of K's entries, an error that may appear in derivatives and not in the solve.
inline constexpr double kConverged = 1e-12;

/// Largest growth of K's entries (kkt/factor/pivots.hpp) for which one refinement step of derivatives suffices: the
/// step squares the error, 1e6 eps, to below eps. If the growth is larger, panels of derivatives are judged by their
/// own residuals.
inline constexpr double kMostGrowth = 1e6;

/// Panels of derivatives are refined once unless the backward error of the unrefined solve, or the factor's bound for
/// every column, is at most this. Derivatives may have errors of 1000 eps cond(K) = 2.2e-13 cond(K); an unrefined solve
/// within the limit uses less than a quarter of this.
inline constexpr double kRefinePanel = 5e-14;

/// Refinement of derivatives that are judged by their own residuals stops at this normwise residual, half of the 1000
/// eps allowed; residuals up to kConverged are accepted. Derivatives robot by robot are accepted up to this
/// componentwise backward error.
inline constexpr double kPanelRefined = 1e-13;
inline constexpr int kPanelSteps = 3;  // largest number of solves, the first solve included

/// Residuals below this have lost digits by underflow (normal numbers end at 2e-308) and are meaningless.
inline constexpr double kVanishing = 1e-290;

/// Quadruple precision: normwise residual at which a solution counts as exact, 1e4 times the eps of float128 (2e-30),
/// and largest number of refinement steps. A step reduces the error by at least a factor of 2, usually by 10 digits,
/// and 30 digits are 100 factors of 2. If the steps reduce the error too slowly, the dense solver in quadruple
/// precision is used.
inline constexpr int kTruthRounding = 10000;  // unit: eps of the scalar
inline constexpr int kTruthSteps = 60;

/// Largest relative change of x by a correction after which the magnitudes |K| |x| need not be computed again.
inline constexpr double kSameSize = 1e-6;

// ---- single precision -----------------------------------------------------------------------------------------------

/// In single precision, thresholds of one pivot or row (kPivotLeft, kRank) are multiplied by kSingleLeft and become
/// 1e-5, 100 eps of floats. In products of two pivots, which must exceed kRowRounding, each pivot is divided by
/// kSinglePassedOn, so that the limit becomes 1e-7.
inline constexpr double kSingleLeft = 1e6, kSinglePassedOn = 1e3;
/// Single precision: largest accepted change of accelerations and forces by rounding errors, relative to the largest
/// acceleration and force, so that two digits are left. The estimate gives the rounding errors of terms random signs.
inline constexpr double kWorthless = 1e-2;

/// Single precision: if the largest term of a robot's rows, in their units, is below this, terms may have underflowed.
inline constexpr double kSmallestTerm = 1e-25;

/// Single precision: least 1 + trace(R) of an orientation error R, which is then 0.01 rad or more from half a
/// revolution. R is accurate to 1e-6, so that nearer to half a revolution the direction of the error may be reversed.
inline constexpr double kHalfTurn = 1e-4;

// ---- judging solutions ----------------------------------------------------------------------------------------

/// Contacts are inconsistent (mathematics.md) if |J a + a0| > 1e-8 (| |J| |a| | + |a0|), in maximum norms. There are
/// two exceptions, kLoadRounding and kDriftRounding.
inline constexpr double kContradiction = 1e-8;

/// A row of J waits, i.e. is not eliminated with the other rows, if its pivot is below kWaits kPivotLeft = 1e-6 of the
/// pivot's terms. The factor of the other rows then loses at most six digits, which refinement recovers.
inline constexpr double kWaits = 1e5;
/// Least sound pivot of a waiting row in the Schur complement of the waiting rows (rank/waiting_rows.hpp), relative to
/// the pivot's terms. Dependent rows leave 1e-16 times 1e6, for the six digits that the factor may lose. Independent
/// rows left over 1e-7 in all scenes tried.
inline constexpr double kJoins = 1e-9;
/// Largest number of waiting rows in islands of more than kFewRows rows of J. Each waiting row adds a column to N or to
/// the dense Schur complement. With more waiting rows the proximal factor is cheaper.
inline constexpr int kMostWaiting = 24;

/// Rounding errors of accelerations that gravity or torques cause and contacts cancel. kLoadRounding is relative to
/// gravity. Without gravity, kTorqueRounding is relative to the torques' acceleration of each robot's largest inertia.
inline constexpr double kLoadRounding = 1e-12, kTorqueRounding = 1e-15;
/// Contacts are consistent if each row's residual is at most this fraction of the largest term of the row's bias a0
/// (bias_acceleration_terms, [m/s^2] or [rad/s^2]): 500 eps, the rounding error of chains of hundreds of joints.
inline constexpr double kDriftRounding = 1e-13;
/// Derivatives include a term for inconsistent contacts if the residual exceeds this fraction of a0's terms (20 eps).
inline constexpr double kDriftNoise = 4e-15;

/// Least ratio of the smallest to the largest row size at which inconsistent rows are solved in the least-squares sense
/// by normal equations, which square the ratio and lose eight digits. Below it the dense reference solver is used.
inline constexpr double kGradedRows = 1e-4;

/// Largest accepted deviation of a floating base's quaternion from unit length: scene files may have only 7 digits.
inline constexpr double kQuaternion = 1e-6;

/// Hager's and Higham's estimate of a 1-norm is a lower bound. The norm is nearly always below this times the estimate.
inline constexpr double kNormEstimate = 3;
/// Error bounds take the rounding error of each term of a row as kBoundRounding eps, plus one eps for each joint
/// between the base and the row.
inline constexpr int kBoundRounding = 12;

/// Largest sound ratio of the terms of an equation of K x = b to the equation's diagonal entry (inertia or damping)
/// times the largest solution. Above it, rounding errors of the terms (kBoundRounding eps) may change the solution by 1
/// %, and error bounds are checked.
inline constexpr double kInDoubt = 0.01 / (kBoundRounding * std::numeric_limits<double>::epsilon());

/// Least force relative to which residuals of a solution are judged, as a fraction of the largest load.
inline constexpr double kLeastLoad = 1e-3;

/// If the backward error exceeds kConverged, residuals are judged relative to at least this fraction of what the terms
/// of their row could be (backward_error_of_data in fallbacks.cpp), so that two digits may cancel.
inline constexpr double kPartOfData = 1e-2;

// ---- the precision `extended` ---------------------------------------------------------------------------------
// Thresholds of refinement in double-double, whose own rounding is about 2^-104.

/// Refinement has converged if the last correction of each robot's accelerations and each contact's forces, relative to
/// these, is at most kExtendedConverged, an eighth of double's rounding. For solutions that vanish, kExtendedVanishing
/// is relative to the loads.
inline constexpr double kExtendedConverged = 0x1p-56, kExtendedVanishing = 0x1p-80;
/// A correction above kExtendedSlow times the previous correction ends refinement, since only rounding errors in
/// double-double remain. Refinement has converged if this correction is below kExtendedStopped relative to the
/// solution, or below kExtendedStoppedVanishing relative to the loads.
inline constexpr double kExtendedSlow = 0.8;
inline constexpr double kExtendedStopped = 0x1p-52, kExtendedStoppedVanishing = 0x1p-60;
/// Least squares leave a residual that may be far larger than the terms of the solution. The residual's last change
/// must be at most kExtendedDigits of the residual, or kExtendedDigitsVanishing of the loads. If refinement stops
/// early, it must be at most kExtendedDigitsStopped of the residual.
inline constexpr double kExtendedDigits = 0x1p-96, kExtendedDigitsVanishing = 0x1p-110,
                        kExtendedDigitsStopped = 0x1p-85;
/// Rows are exactly dependent if forces n exist with J^T n at most this fraction of the terms of J^T n. Rows that are
/// dependent only up to the rounding of the state to double leave 2^-53.
inline constexpr double kExtendedDependent = 0x1p-75;
/// Largest number of refinement steps, enough for condition numbers at which each step gains half a binary digit.
inline constexpr int kExtendedSteps = 60;
/// Numbers of a scene (placements, inertias, quaternions) are rounded when they are read. The resulting error of a
/// solution is at most kReadRounding times the solution, plus kReadShare times the error bound from |K^-1|. That bound
/// takes kBoundRounding = 12 eps of each term; for reading, 4 eps suffice. With 1 eps, the median of bound over error
/// would be 78 in place of 311, but 6 of 42,000 random scenes would have errors up to 2.5 times the bound. In the
/// precision `extended`, errors are relative to the scene as it was read: kExtendedShare is 2^-104 / 2^-53 times 32,
/// for the constants of sums and products in double-double.
inline constexpr double kReadRounding = 0x1p-48, kReadShare = 1.0 / 3, kExtendedShare = 0x1p-46;

// ---- choosing -------------------------------------------------------------------------------------------------

/// An elimination order other than the current one is chosen if its predicted cost is below this fraction of the
/// current order's. The margin covers errors of the prediction. The first order, leaf-to-root, is the most accurate
/// one.
inline constexpr double kCheaper = 0.9;

/// The order contacts-early eliminates a contact after coordinates that move it in all directions of its rows: the last
/// pivot of a QR of these coordinates' columns of J, relative to the rows' lengths, must exceed this. The second value
/// is used if its order is cheaper.
inline constexpr double kDistinct[] = {1e-2, 1e-3};

/// At most 1 / kZeros of a relaxed supernode's entries are zeros. Columns with fewer than kShort entries get no zeros.
inline constexpr int kZeros = 12, kShort = 16;

}  // namespace manycontact::tolerance
