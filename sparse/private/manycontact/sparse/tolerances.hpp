#pragma once
// All numeric thresholds of the modules sparse, rank, kkt and dynamics. They have no unit unless the comment gives one.
// eps = 2.2e-16. K = [M J^T; J -delta I] is an island's matrix, N a basis of the null space of J^T, and a0 the bias in
// J a + a0 = 0. A dependent row is J_k = sum z_j J_j over kept rows j. Coefficients of costs are in kkt/costs.hpp.

#include <cstddef>
#include <limits>

namespace manycontact::tolerance {

// ---- pivots and rank ------------------------------------------------------------------------------------------

/// Least sound pivot d_k of A = L D L^T relative to its terms |A_kk| + sum l_kj^2 |d_j|: ten times the rounding errors
/// of 1e4 terms (n eps) and of earlier pivots. A row of J below it has less than sqrt(1e-11) = 3e-6 of its length
/// orthogonal to the rows before.
inline constexpr double kPivotLeft = 1e-11;

/// Least length of a row of J, or of its part orthogonal to other rows, relative to its contact's largest motion
/// (motion_scale, detail/contact/rows.hpp). Smaller lengths are rounding errors.
inline constexpr double kRank = 1e-11;

/// Rounding error of a sum of six to eight products, 2 eps for each, in eps of the scalar in use (double or quadruple).
inline constexpr int kRounding = 16;

/// Least sound pivot of a damped K, in eps of the scalar in use times the pivot's terms: its rounding error changes
/// forces by 1 %. Below it rounding hides the damping, and the status is regularised.
inline constexpr int kDampingRounding = 100 * kRounding;

/// sparse-bodies: least ratio of a row's pivot E_kk to its pivot if its body were free, sum_j G_kj^2 / P_jj
/// (kkt/bodies/ldl.hpp). A row is eliminated at the first body, from the leaves on, with a larger ratio. This enlarges
/// the body's articulated inertia P at most by the inverse ratio, which costs digits in loops of thousands of links. A
/// larger threshold costs time.
inline constexpr double kRowMoves = 5e-2;
/// Rounding error of a pivot of K relative to its terms, 450 eps, before small earlier pivots enlarge it
/// (rank/pivots.hpp). least_left in kkt/bodies/factorize.cpp multiplies it by the squared growth of P.
inline constexpr double kRowRounding = 1e-13;

/// sparse-bodies: an entry of J is a sum of products. It is certainly nonzero above this fraction of the sum of their
/// magnitudes.
inline constexpr double kPlainlyMoves = 1e-3;

/// sparse-bodies: least part of a row orthogonal to the rows before it on a constrained body, relative to its length.
/// One Gram-Schmidt pass then is accurate to 1e-14. Below it, the children's inertia along the rows is not removed
/// (BodyHold in kkt/bodies/ldl.hpp).
inline constexpr double kHeldApart = 1e-2;
/// sparse-bodies: share that BodyHold keeps of the children's inertia along the rows that constrain a body. It does not
/// change the solution; if it is positive, bodies without inertia have a sound pivot.
inline constexpr double kHeldKept = 1e-2;

// ---- pairs of bodies ------------------------------------------------------------------------------------------

/// Limits on pivots of a column-pivoted QR of the rows between two bodies, relative to the largest. Those above
/// kPairIndependent count for the rank; those below kPairDependent are rounding errors of up to 100 rows. Between them
/// (points 1e-6 m apart, or 1e6 m from others) the rows are kept, and the factorization of K finds the rank.
inline constexpr double kPairIndependent = 1e-5, kPairDependent = 1e-13;

/// Largest relative velocity or displacement of two bodies that move as one, relative to the terms of the difference.
inline constexpr double kMovesAsOne = 1e-13;

// ---- dependent rows -------------------------------------------------------------------------------------------

/// Largest residual J_k - sum z_j J_j of a dependent row k, relative to J's entries: ten times the rounding error of
/// the sum if the largest z_j is kLargestEntry. The residuals of independent rows are above 3e-6; between the two
/// values, the dense reference solver decides.
inline constexpr double kRowLeft = 1e-13;

/// Largest coefficient z_j for which N is not orthonormalised: its projector's error z_j^2 eps is 2e-13 then.
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

/// Damping of a dropped row, which so stays in K's pattern without effect: its squared entries divided by this vanish.
inline constexpr double kDroppedDamping = 1e200;

/// Largest number of waiting rows (kWaits) of one robot in a SIMD batch. Each adds a dense column to N.
inline constexpr std::size_t kMostWaitingInBatch = 64;

/// Least number of coordinates of an island in which sparse-bodies drops rows; below it a factor of K takes no longer.
inline constexpr int kFewCoordinates = 100;

/// sparse-bodies: number of joints, from a row's body towards the base, at which the row's entries are checked one by
/// one. If none is certainly nonzero, the row is compared with a basis of all motions of the body reached.
inline constexpr int kManyJoints = 64;

/// sparse-bodies: largest numbers of rows and of balance equations in the dense system from which a null vector of rows
/// along a chain is computed (Balance in kkt/bodies/dependent_rows.cpp).
inline constexpr int kBalancedRows = 24, kBalanceEquations = 64;

/// Largest number of entries of a cluster (columns of N that share rows) in which dropped rows are exchanged, or whose
/// columns are orthonormalised. Each step of either passes over all entries.
inline constexpr std::size_t kMostExchanged = 1 << 20;

/// Rows made dependent within a tolerance (within_tolerance.cpp). kMostDrift is the largest tolerance or constraint
/// violation, relative to the largest moment arm. kNextPivot is the ratio of a tried pivot threshold to the one before.
inline constexpr double kMostDrift = 1e-2, kNextPivot = 1e-2;
/// within_tolerance.cpp: largest number of reweighting steps of a column of N (three reduce entries outside a
/// dependence from 1e-2 to below kRank), and least weight of a coordinate relative to its initial weight.
inline constexpr int kReweighted = 4;
inline constexpr double kLeastWeight = 1e-10;

// ---- large islands -----------------------------------------------------------------------------------------------

/// Largest number of J's rows for which the dense solver checks doubtful solutions: 30 ms for 300 rows, 170 for 600.
inline constexpr int kFewRows = 300;
/// Largest number of K's rows for which the dense solver is the last resort: 2 s, 72 MB per matrix for 3000 rows.
inline constexpr int kDenseSize = 3000;
/// Largest number of K's rows for which a factor of K differentiates islands that sparse-bodies solved. Derivatives by
/// sparse-bodies take 4 to 70 times as long. For a larger K whose factor is not sound, the dense solver would take even
/// longer.
inline constexpr int kDifferentiatedByMatrix = 1500;
/// Number of K's rows below which derivatives may be solved column by column: many times slower in larger islands.
inline constexpr int kOneByOne = 400;
/// Largest number of rows of K for which |K^-1|_1 is computed from all columns of K^-1, and not estimated.
inline constexpr int kSmallInverse = 64;
/// Largest number of rows of a sparse-bodies subtree in a SIMD batch. The cost is quadratic in the rows.
inline constexpr int kLargestSubtree = 64;
/// sparse-bodies: largest number of uneliminated rows of J with both ends in a body's subtree; a body has six motions.
inline constexpr int kMostOpen = 6;
/// sparse-bodies: upper limit of least_left (kkt/bodies/factorize.cpp), a pivot's rounding error relative to its terms.
inline constexpr double kMostKept = 1e-5;
/// An island is overdetermined if it has at least kOverdetermined rows of J, and more than kTimesOverdetermined rows
/// per coordinate. `auto` solves it by the dense method, at a cost linear in the rows. From kTooFull rows on, the dense
/// method also replaces sparse methods with an elimination order, whose factor is full among the rows of one body.
inline constexpr int kOverdetermined = 300, kTimesOverdetermined = 4, kTooFull = 5000;

// ---- the proximal factor ----------------------------------------------------------------------------------------

/// Damping delta relative to the largest diagonal entry of J M^-1 J^T: 1000 times the rounding error of the pivots. On
/// walls of 3600 boxes, redundant rows then have pivots below 4e-10, others above 3e-8; 1e-10 would mix them.
inline constexpr double kProximal = 1e-12;
/// A dependent row's pivot is delta (1 + |z|^2), usually below kPivotOfDependent delta; others are usually above
/// kPivotOfOthers delta. Between these limits (on uneven walls both reach 1e6 delta), K is factorized again with delta
/// times kStiffer.
inline constexpr double kPivotOfDependent = 1e2, kPivotOfOthers = 1e7, kStiffer = 10;
/// A pivot of K is proportional to a power of delta. Rounding errors change its exponent by up to kExponentRounding eps
/// times the pivot's terms over the pivot. The sum of all exponents may differ from an integer by kExponentsLeft.
inline constexpr double kExponentRounding = 100, kExponentsLeft = 0.2;
/// One application of E = delta (J M^-1 J^T + delta)^-1 must reduce the part of a vector outside the null space to this
/// fraction of it, usually to 1e-3. Otherwise rows are only nearly dependent. If K was not factorized with a second
/// delta, the limit is 1 / (2 kPivotOfDependent).
inline constexpr double kSlowest = 0.5;
inline constexpr int kMostApplications = 12;
/// A row is in no null vector if its entries in projected random vectors are below 1000 times their rounding error.
inline constexpr double kInNullSpace = 1e-11;
/// Subtraction of a vector's null-space part ends when the part left is below kProjected of the vector's largest entry,
/// or after kProjections passes.
inline constexpr double kProjected = 1e-11;
inline constexpr int kProjections = 6;
/// Projected random vectors are accepted as null vectors if J^T times the vectors stops decreasing below this, at
/// rounding errors. If the projection wrongly kept an eigenvector of J M^-1 J^T, sqrt(delta) = 1e-6 would remain.
inline constexpr double kMostLeft = 1e-11;
/// Largest number of proximal steps. Each divides the error by 1e3 or more, but by less near a singular configuration.
inline constexpr int kProximalSteps = 30;
/// Contacts are inconsistent if, after proximal steps, the largest residual of their rows exceeds this fraction of
/// delta times the largest force. Rounding leaves 1e-4.
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

/// Largest growth of K's entries (kkt/factor/pivots.hpp) for which one refinement step of derivatives suffices: it
/// squares the error of 1e6 eps. Above it, panels of derivatives are judged by their own residuals.
inline constexpr double kMostGrowth = 1e6;

/// Panels of derivatives are refined unless the backward error of the unrefined solve, or its bound for every column,
/// is at most this: less than a quarter of the error that derivatives may have, 1000 eps cond(K).
inline constexpr double kRefinePanel = 5e-14;

/// Refinement of derivatives that are judged by their own residuals stops at this normwise residual, half of the 1000
/// eps allowed; residuals up to kConverged are accepted. Derivatives robot by robot are accepted up to this
/// componentwise backward error.
inline constexpr double kPanelRefined = 1e-13;
inline constexpr int kPanelSteps = 3;  // largest number of solves of a panel or column of derivatives, with the first

inline constexpr double kVanishing = 1e-290;  // residuals and pivots below it have lost digits by underflow

/// Quadruple precision: normwise residual of a solution that counts as exact, 1e4 eps of float128, and largest number
/// of refinement steps. A step divides the error by at least 2, usually by 1e10; 30 digits are 100 factors of 2. If the
/// steps do not suffice, the dense solver in quadruple precision is used.
inline constexpr int kTruthRounding = 10000;  // unit: eps of the scalar
inline constexpr int kTruthSteps = 60;

/// Largest relative change of x by a correction after which the magnitudes |K| |x| need not be computed again.
inline constexpr double kSameSize = 1e-6;

// ---- single precision -----------------------------------------------------------------------------------------------

/// In single precision, kPivotLeft and kRank are multiplied by kSingleLeft and become 1e-5, 100 eps of floats. In
/// products of two pivots, which must exceed kRowRounding, each is divided by kSinglePassedOn: the limit becomes 1e-7.
inline constexpr double kSingleLeft = 1e6, kSinglePassedOn = 1e3;
/// Single precision: largest relative change of accelerations and forces by rounding errors; two digits are left.
inline constexpr double kWorthless = 1e-2;

/// Single precision: if the largest term of a robot's equations K x = b is below this (SI units), terms may have
/// underflowed.
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
/// Least sound pivot of a waiting row in the Schur complement (rank/waiting_rows.hpp), relative to its terms. Dependent
/// rows leave 1e-16 times the 1e6 that the factor may lose; independent rows left over 1e-7 in all scenes tried.
inline constexpr double kJoins = 1e-9;
/// Largest number of waiting rows in islands with more than kFewRows rows of J; above it, proximal steps are used.
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
/// Rounding error, in eps, of a term of K x = b in error bounds; those in joint space add one per joint of a chain.
inline constexpr int kBoundRounding = 12;

/// Largest sound ratio of the terms of an equation of K x = b to its diagonal entry (inertia or damping) times the
/// largest solution. Above it, the terms' rounding may change the solution by 1 %, and error bounds are checked.
inline constexpr double kInDoubt = 0.01 / (kBoundRounding * std::numeric_limits<double>::epsilon());

/// Least force relative to which residuals of a solution are judged, as a fraction of the largest load.
inline constexpr double kLeastLoad = 1e-3;

/// If the backward error exceeds kConverged, a residual is judged relative to at least this fraction of the terms that
/// its row would have if |M_jk| were sqrt(M_jj M_kk) and J_jk the size of row j. Thus two digits may cancel.
inline constexpr double kPartOfData = 1e-2;

// ---- the precision `extended` ---------------------------------------------------------------------------------
// Thresholds of refinement in double-double, whose own rounding is about 2^-104.

/// Refinement has converged if the last correction, relative to each robot's accelerations and each contact's forces,
/// is at most kExtendedConverged (double's rounding / 8) or, if they vanish, kExtendedVanishing of the loads.
inline constexpr double kExtendedConverged = 0x1p-56, kExtendedVanishing = 0x1p-80;
/// A correction above kExtendedSlow times the previous one ends refinement: only rounding remains. It has converged if
/// this correction is below kExtendedStopped of the solution or kExtendedStoppedVanishing of the loads.
inline constexpr double kExtendedSlow = 0.8;
inline constexpr double kExtendedStopped = 0x1p-52, kExtendedStoppedVanishing = 0x1p-60;
/// Least squares leave a residual that may far exceed the solution's terms. Its last change must be at most
/// kExtendedDigits of it, or kExtendedDigitsVanishing of the loads; at an early stop, kExtendedDigitsStopped of it.
inline constexpr double kExtendedDigits = 0x1p-96, kExtendedDigitsVanishing = 0x1p-110,
                        kExtendedDigitsStopped = 0x1p-85;
/// Rows are exactly dependent if forces n exist with J^T n at most this fraction of the terms of J^T n. Rows that are
/// dependent only up to the rounding of the state to double leave 2^-53.
inline constexpr double kExtendedDependent = 0x1p-75;
/// Largest number of refinement steps, enough for condition numbers at which each step gains half a binary digit.
inline constexpr int kExtendedSteps = 60;
/// Numbers of a scene are rounded to double when read. This changes a solution by at most kReadRounding of it plus
/// kReadShare of the error bound from |K^-1|, i.e. 4 of the kBoundRounding = 12 eps of each term. (With 1 eps, 6 of
/// 42,000 random scenes would have errors up to 2.5 times the bound.) In precision `extended`, errors are relative to
/// the scene as read: kExtendedShare is 2^-104 / 2^-53 times 32, for the constants of double-double.
inline constexpr double kReadRounding = 0x1p-48, kReadShare = 1.0 / 3, kExtendedShare = 0x1p-46;

// ---- elimination orders and supernodes ------------------------------------------------------------------------

/// Another elimination order is chosen if its predicted cost is below this fraction of the current order's, a margin
/// for errors of the prediction. The first order, leaf-to-root, is the most accurate.
inline constexpr double kCheaper = 0.9;

/// contacts-early eliminates a contact after coordinates that move it in all directions of its rows: the last pivot of
/// a QR of their columns of J, relative to the rows' lengths, exceeds this. Of the orders with either value, the
/// cheapest is taken.
inline constexpr double kDistinct[] = {1e-2, 1e-3};

/// At most 1 / kZeros of a relaxed supernode's entries are zeros. Columns with fewer than kShort entries get no zeros.
inline constexpr int kZeros = 12, kShort = 16;

}  // namespace manycontact::tolerance
