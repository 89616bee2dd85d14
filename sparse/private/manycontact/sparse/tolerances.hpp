#pragma once
// Every numeric threshold of the modules sparse, rank, kkt and dynamics, without unit unless the comment gives one.
// eps = 2.2e-16. K = [M J^T; J -delta I] is an island's matrix, N a basis of the null space of J^T, and a0 the bias in
// J a + a0 = 0. A dependent row is J_k = sum z_j J_j over kept rows j. Coefficients of costs are in kkt/costs.hpp.

#include <cstddef>
#include <limits>

namespace manycontact::tolerance {

// ---- pivots and rank ------------------------------------------------------------------------------------------

/// Least sound pivot d_k relative to the terms it is computed from: |d_k| / (|A_kk| + sum l_kj^2 |d_j|). Rounding
/// errors of n terms reach n eps, 1e-13 to 1e-12 for n of 1e3 to 1e4, and errors of earlier pivots add to them. The
/// limit is ten times that error. A row of J with a smaller pivot has less than sqrt(1e-11) = 3e-6 of its length
/// orthogonal to the rows before it.
inline constexpr double kPivotLeft = 1e-11;

/// Least length of a row of J, or of its part orthogonal to other rows, relative to the largest motion of its contact
/// (motion_scale [J's units], detail/contact/rows.hpp). Anything smaller is a rounding error. The margin over rounding
/// errors is that of kPivotLeft, which compares squares of lengths; this threshold compares lengths.
inline constexpr double kRank = 1e-11;

/// Rounding error of a sum of six to eight products of 2 eps each, in eps of the scalar in use (double or quadruple).
inline constexpr int kRounding = 16;

/// Least pivot of a damped K, in eps of the scalar in use times the pivot's terms. Smaller pivots give the status
/// regularised: rounding hides the damping. A pivot of c eps gives forces a relative error of 1/c, here below 1 %.
inline constexpr int kDampingRounding = 100 * kRounding;

/// sparse-bodies: least ratio of a contact row's pivot E_kk to its pivot on a free body, sum_j (G_kj^2 / P_jj); for G,
/// P see kkt/bodies/ldl.hpp. Rows are eliminated at the first body where the ratio is larger; P then grows by at most
/// the inverse ratio. Growth costs later rows digits, in loops of thousands of links. A larger threshold costs time.
inline constexpr double kRowMoves = 5e-2;
/// sparse-bodies: rounding error of a pivot E_kk, 450 eps, relative to the joints' terms of E_kk times the growth of P
/// squared (least_left in kkt/bodies/factorize.cpp). Rows with smaller pivots are redundant.
inline constexpr double kRowRounding = 1e-13;

/// sparse-bodies: least entry of J relative to the magnitudes of the products it sums. If an entry is larger, its row
/// certainly moves the entry's coordinate, and no other entry of the row is checked.
inline constexpr double kPlainlyMoves = 1e-3;

/// sparse-bodies: part of a row orthogonal to the rows before it on the same constrained body, relative to its length.
/// Below this, the body's rows remain rows of K. Above this, one Gram-Schmidt pass makes the rows orthogonal to 1e-14.
inline constexpr double kHeldApart = 1e-2;
/// sparse-bodies: factor on the children's inertia along the rows that constrain a body. Any value solves the system;
/// this value gives a pivot to a body without inertia of its own.
inline constexpr double kHeldKept = 1e-2;

// ---- pairs of bodies ------------------------------------------------------------------------------------------

/// Limits on pivots of a column-pivoted QR of the rows between two bodies, relative to the largest pivot. Independent
/// rows leave more than the first, dependent rows less than the second, the rounding error of 12 to 100 rows. Points
/// 1e-6 m apart, or 1e6 m from other points, give pivots between the limits. The factorization of K then finds the
/// rank: a basis of all these rows would lose the digits in which nearly equal rows differ.
inline constexpr double kPairIndependent = 1e-5, kPairDependent = 1e-13;

/// Relative velocity or displacement of two bodies, divided by the velocities and moment arms whose difference it is.
/// Below this the bodies move as one body, and damped contacts between the two are consistent to first order.
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

/// Damping on the diagonal of a dropped row if the factor's pattern is kept: squares of entries divided by it vanish.
inline constexpr double kDroppedDamping = 1e200;

/// Most waiting rows (rows of J with a doubtful pivot) of one robot in a SIMD batch: each adds a dense column to N.
inline constexpr std::size_t kMostWaitingInBatch = 64;

/// Least number of coordinates of an island in which sparse-bodies drops dependent rows itself. For smaller islands a
/// factor of the whole K takes no longer, and derivatives can use that factor, too.
inline constexpr int kFewCoordinates = 100;

/// sparse-bodies: a row that moves none of this many joints towards the base is compared with a basis of body motions.
inline constexpr int kManyJoints = 64;

/// Largest dense problem of sparse-bodies in its search for a null vector along a chain: rows, and balance equations.
inline constexpr int kBalancedRows = 24, kBalanceEquations = 64;

/// Most entries of N for which rows are exchanged or columns orthonormalised: each such step passes over all entries.
inline constexpr std::size_t kMostExchanged = 1 << 20;

/// Closed loops: kMostDrift is the largest tolerance, and the largest constraint violation, relative to the largest
/// moment arm. kNextPivot is the ratio of one tried pivot threshold to the one before.
inline constexpr double kMostDrift = 1e-2, kNextPivot = 1e-2;
/// Closed loops: most reweighting steps. Three suffice to bring entries of N for rows outside a dependence from 1e-2
/// below kRank. kLeastWeight, relative to the usual weight, is for columns with entries in such rows only.
inline constexpr int kReweighted = 4;
inline constexpr double kLeastWeight = 1e-10;

// ---- large islands -----------------------------------------------------------------------------------------------

/// Most rows of J for which the dense solver checks doubtful solutions of other methods: 300 take 30 ms, 600 170 ms.
inline constexpr int kFewRows = 300;
/// Most rows of K for which the dense solver is used after all other methods failed: 3000 take 2 s and 72 MB a matrix.
inline constexpr int kDenseSize = 3000;
/// Most rows of K for which a factor of K differentiates islands that sparse-bodies solved: sparse-bodies solves column
/// by column, 4 to 70 times as long. For a larger K, the dense solver would take longer if that factor is not sound.
inline constexpr int kDifferentiatedByMatrix = 1500;
/// Rows of K below which columns of derivatives may be solved one by one; in larger islands that is many times slower.
inline constexpr int kOneByOne = 400;
/// Rows of K below which |K^-1|_1 is computed from all columns of K^-1, and not estimated.
inline constexpr int kSmallInverse = 64;
/// Largest number of rows of a sparse-bodies subtree that is solved in a SIMD batch. The cost is quadratic in the rows.
inline constexpr int kLargestSubtree = 64;
/// sparse-bodies: most rows with both ends below a node that stay open there: a body has only six directions.
inline constexpr int kMostOpen = 6;
/// sparse-bodies: upper limit of the least sound part of a row's pivot (least_left, kkt/bodies/factorize.cpp).
inline constexpr double kMostKept = 1e-5;
/// Islands with at least kOverdetermined rows of J, and kTimesOverdetermined times their coordinates, are
/// overdetermined. `auto` solves them by the dense method, at a cost linear in the rows. From kTooFull rows on, so do
/// the sparse methods with an order, whose factor is full among the rows of one body.
inline constexpr int kOverdetermined = 300, kTimesOverdetermined = 4, kTooFull = 5000;

// ---- the proximal factor ----------------------------------------------------------------------------------------

/// Damping delta relative to the largest diagonal entry of J M^-1 J^T: 1000 times the rounding error of the pivots. On
/// walls of 3600 boxes, redundant rows then have pivots below 4e-10, others above 3e-8; 1e-10 would mix them.
inline constexpr double kProximal = 1e-12;
/// The pivot of a dependent row is delta (1 + |z|^2), z its coefficients: usually below kPivotOfDependent delta. Pivots
/// of other rows are usually above kPivotOfOthers delta. If a pivot is between these limits, K is factorized again with
/// delta times kStiffer. On uneven walls both kinds of rows have pivots of 1e6 delta.
inline constexpr double kPivotOfDependent = 1e2, kPivotOfOthers = 1e7, kStiffer = 10;
/// A pivot of K is proportional to a power of delta. Rounding changes this exponent by up to kExponentRounding eps of
/// the pivot's terms, relative to the pivot. The sum of all exponents may differ from an integer by kExponentsLeft.
inline constexpr double kExponentRounding = 100, kExponentsLeft = 0.2;
/// Largest factor by which E (kkt/factor/proximal.hpp) may reduce the part of a vector outside the null space, usually
/// 1e-3. Above this, rows are nearly dependent. If pivots were not compared, it is 1 / (2 kPivotOfDependent).
inline constexpr double kSlowest = 0.5;
inline constexpr int kMostApplications = 12;
/// Entry of projected random vectors below which a row is in no null vector: 1000 times the entry's rounding error.
inline constexpr double kInNullSpace = 1e-11;
/// Projections stop when the null-space part of a vector, relative to the vector, is below this; or after kProjections.
inline constexpr double kProjected = 1e-11;
inline constexpr int kProjections = 6;
/// J^T times projected random vectors may stop decreasing below this, at rounding errors. If the projection wrongly
/// kept an eigenvector of J M^-1 J^T, sqrt(delta) = 1e-6 would remain.
inline constexpr double kMostLeft = 1e-11;
/// Most proximal steps. Each reduces the error by a factor of 1e3 or more, but by less near a singular configuration.
inline constexpr int kProximalSteps = 30;
/// Contacts are inconsistent if proximal steps leave a residual above this part of delta f in their rows. Inconsistent
/// rows leave all of delta f; otherwise rounding errors leave 1e-4 of it.
inline constexpr double kProximalAgree = 1e-2;

/// J^T times a random null vector is a rounding error if it is below this many eps times the growth of K's entries.
inline constexpr double kGrown = 30;

// ---- refinement -----------------------------------------------------------------------------------------------

/// Backward error at which refinement stops: a few eps, the rounding error of the residual itself.
inline constexpr double kRefined = 1e-15;
inline constexpr int kRefinementSteps = 5;  // each step at least halves the error; two steps are usual

/// Backward error up to which a solution is accepted; the solution's error may be max(1e-12, 100 eps cond(K)). The same
/// limit applies to eps times the growth of K's entries, which may appear in derivatives and not in the solve.
inline constexpr double kConverged = 1e-12;

/// Largest growth of K's entries that costs a third of the digits: one refinement step squares this error to below eps.
/// For larger growth, panels of derivatives are judged by their own residuals.
inline constexpr double kMostGrowth = 1e6;

/// Backward error above which panels of derivatives are refined once: the error of the unrefined solve or, if larger,
/// the factor's bound for every column. Derivatives may have errors of 1000 eps cond(K) = 2.2e-13 cond(K); an unrefined
/// solve takes less than a quarter of this.
inline constexpr double kRefinePanel = 5e-14;

/// Derivatives by dense-schur: refinement stops at this normwise residual, half of the 1000 eps allowed; residuals up
/// to kConverged are accepted. Derivatives robot by robot: this componentwise backward error is accepted.
inline constexpr double kPanelRefined = 1e-13;
inline constexpr int kPanelSteps = 3;  // most solves, the first solve included

/// Residuals below this have lost digits by underflow (normal numbers end at 2e-308) and are meaningless.
inline constexpr double kVanishing = 1e-290;

/// Quadruple precision: normwise residual of an exact solution, 1e4 times the eps of float128 (2e-30), and most
/// refinement steps. A step gains at least a factor of 2, usually 10 digits, and 30 digits are 100 factors of 2. A
/// factor that gains less than a factor of 4 a step is replaced by the dense solver in quadruple precision.
inline constexpr int kTruthRounding = 10000;  // unit: eps of the scalar
inline constexpr int kTruthSteps = 60;

/// Relative change of x by a correction, below which the magnitudes |K| |x| need not be computed again.
inline constexpr double kSameSize = 1e-6;

// ---- single precision -----------------------------------------------------------------------------------------------

/// Single precision multiplies thresholds of a pivot or row (kPivotLeft, kRank) by kSingleLeft, to 1e-5, 100 eps of
/// floats. Each of two pivots is divided by kSinglePassedOn: the limit of their product, kRowRounding, becomes 1e-7.
inline constexpr double kSingleLeft = 1e6, kSinglePassedOn = 1e3;
/// Largest relative change of the largest acceleration and force by rounding errors that is accepted in single
/// precision, so that two digits are left. The estimate takes the rounding errors of all terms with random signs.
inline constexpr double kWorthless = 1e-2;

/// Largest term of a robot's rows, in their units, below which single-precision terms may have underflowed (1e-38).
inline constexpr double kSmallestTerm = 1e-25;

/// Least 1 + trace of an orientation error's rotation in single precision, 0.01 rad from half a revolution. Floats are
/// accurate to 1e-6: nearer to half a revolution, the direction of the error may be reversed.
inline constexpr double kHalfTurn = 1e-4;

// ---- judging solutions ----------------------------------------------------------------------------------------

/// Contacts are inconsistent (mathematics.md) if |J a + a0| > 1e-8 (| |J| |a| | + |a0|), in maximum norms. There are
/// two exceptions, kLoadRounding and kDriftRounding.
inline constexpr double kContradiction = 1e-8;

/// A row of J waits, so is not yet factorized, if its pivot is below this times kPivotLeft, 1e-6 of its terms. The
/// factor of the other rows then loses at most six digits, which refinement recovers.
inline constexpr double kWaits = 1e5;
/// Least sound pivot of a waiting row in its Schur complement -S, relative to the pivot's terms. Dependent rows leave
/// 1e-16 times the six digits that the factor may lose; independent rows left over 1e-7 in all scenes tried.
inline constexpr double kJoins = 1e-9;
/// Most waiting rows in islands of more than kFewRows rows. Each adds a column to N, or to S, which is dense. With more
/// waiting rows the proximal factor is cheaper.
inline constexpr int kMostWaiting = 24;

/// Rounding errors of accelerations that loads cause and contacts cancel. kLoadRounding is relative to gravity. Without
/// gravity, kTorqueRounding is relative to the acceleration of each robot's largest inertia by the torques.
inline constexpr double kLoadRounding = 1e-12, kTorqueRounding = 1e-15;
/// Contacts are consistent if each row's residual is at most this part of the largest term of the row's bias a0
/// (bias_acceleration_terms, [m/s^2] or [rad/s^2]): 500 eps, the rounding error of chains of hundreds of joints.
inline constexpr double kDriftRounding = 1e-13;
/// Derivatives include a term for inconsistent contacts if the residual exceeds this part of the terms of a0 (20 eps).
inline constexpr double kDriftNoise = 4e-15;

/// Least ratio of the smallest to the largest row. If rows inconsistent in least squares have a smaller ratio, the
/// dense reference solver is used: normal equations square the ratio, and lose eight digits.
inline constexpr double kGradedRows = 1e-4;

/// Largest accepted deviation of a floating base's quaternion from unit length: scene files may have only 7 digits.
inline constexpr double kQuaternion = 1e-6;

/// Hager's and Higham's estimate of a 1-norm is a lower bound. The norm is nearly always below this times the estimate.
inline constexpr double kNormEstimate = 3;
/// Error bounds count this number of eps of all terms of a row, plus one for each joint that the terms pass through
/// between the base and the row.
inline constexpr int kBoundRounding = 12;

/// Largest sound ratio of an equation's terms to its own inertia or damping times the solution. Above this, rounding
/// errors of the terms (kBoundRounding eps) may change the solution by 1 %, and error bounds are checked.
inline constexpr double kInDoubt = 0.01 / (kBoundRounding * std::numeric_limits<double>::epsilon());

/// Least force that a damped solution is compared with, as a part of the largest load.
inline constexpr double kLeastLoad = 1e-3;

/// Least scale of a row's residual, as a part of the row's data, if the backward error exceeds kConverged: two digits.
inline constexpr double kPartOfData = 1e-2;

// ---- the precision `extended` ---------------------------------------------------------------------------------
// Thresholds of refinement in double-double, whose own rounding is about 2^-104.

/// Refinement has converged if the last correction of each robot's accelerations and each contact's forces is at most
/// this part of them, an eighth of double's rounding. For solutions that vanish, the second limit is relative to loads.
inline constexpr double kExtendedConverged = 0x1p-56, kExtendedVanishing = 0x1p-80;
/// A correction above kExtendedSlow times the previous correction ends refinement: only rounding errors in
/// double-double remain. Refinement has then converged if the correction is below the next two limits.
inline constexpr double kExtendedSlow = 0.8;
inline constexpr double kExtendedStopped = 0x1p-52, kExtendedStoppedVanishing = 0x1p-60;
/// Least squares leave a residual that may be far larger than the terms of the solution. Its last change must be at
/// most the first part of the residual, or the second part of the loads; or the third part, if refinement stops.
inline constexpr double kExtendedDigits = 0x1p-96, kExtendedDigitsVanishing = 0x1p-110,
                        kExtendedDigitsStopped = 0x1p-85;
/// Rows are exactly dependent if forces n exist with J^T n at most this part of the terms of J^T n. The rounding of a
/// state to double leaves 2^-53.
inline constexpr double kExtendedDependent = 0x1p-75;
/// Most steps of refinement, enough for condition numbers at which each step gains half a binary digit.
inline constexpr int kExtendedSteps = 60;
/// Numbers of a scene (placements, inertias, quaternions) are rounded when they are read. The resulting error of a
/// solution is at most kReadRounding of it, plus kReadShare times the bound by |K^-1|: the bound counts kBoundRounding
/// = 12 eps of each term, and 4 suffice. With 1/12, the median of bound over error would be 78 in place of 311, but 6
/// of 42,000 random scenes would exceed their bound by up to 2.5 times. The precision `extended` is judged by the scene
/// as read: kExtendedShare is 2^-104 / 2^-53 times 32, for the constants of sums and products in double-double.
inline constexpr double kReadRounding = 0x1p-48, kReadShare = 1.0 / 3, kExtendedShare = 0x1p-46;

// ---- choosing -------------------------------------------------------------------------------------------------

/// Another elimination order replaces the present one if its predicted cost is below this part of the present cost. The
/// margin covers errors of the prediction; leaf-to-root is the most accurate order.
inline constexpr double kCheaper = 0.9;

/// Contacts are eliminated early after coordinates that move them in all directions: the least last pivot of a QR of
/// the coordinates' columns of J, relative to the rows' lengths. The second value is used if its order is cheaper.
inline constexpr double kDistinct[] = {1e-2, 1e-3};

/// At most 1 / kZeros of a relaxed supernode's entries are zeros. Columns with fewer than kShort entries get no zeros.
inline constexpr int kZeros = 12, kShort = 16;

}  // namespace manycontact::tolerance
