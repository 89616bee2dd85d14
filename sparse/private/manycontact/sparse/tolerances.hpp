#pragma once
// Every numeric threshold of the modules sparse, rank, kkt and dynamics that decides a solution, a way to it or the
// memory for it. All are relative, so without unit, unless the comment gives one; eps = 2.2e-16. "Used by" names the
// functions that compare with it. The coefficients of predicted costs are in kkt/costs.hpp.

#include <cstddef>
#include <limits>

namespace manycontact::tolerance {

// ---- pivots and rank ------------------------------------------------------------------------------------------

/// Pivot relative to the terms it is computed from: |d| / (|A_kk| + sum l_kj^2 |d_j|). Rounding errors of the terms
/// leave n eps in the worst case, 1e-13 to 1e-12 for n of 1e3 to 1e4, and earlier pivots pass theirs on; below ten
/// times that a small number cannot be distinguished from zero. Geometrically: a row of J that keeps less than
/// sqrt(1e-11) = 3e-6 of its length has no other direction than those before it.
/// Used by: the judges of LDL, CHOLMOD, dense-schur and the inertia's own LDL;
/// least_pivots (times kWaits: as a row that may depend on others, until the null space confirms it).
inline constexpr double kPivotLeft = 1e-11;

/// Row of J relative to the largest motion its contact is picked from (motion_scale [J's units],
/// detail/contact/rows.hpp): smaller rows, or parts of rows orthogonal to the others, are rounding errors. It has the
/// same margin over rounding errors as kPivotLeft, and for the same reason; here lengths are compared, not squares.
/// Used by: the dense reference solver's rank; rows of J that vanish; least_pivots; least_norm_solution;
/// analysis/ranks.
inline constexpr double kRank = 1e-11;

/// Units of eps of the scalar in use (double or quadruple precision): the error of a sum of six to eight products, each
/// with an error of 2 eps.
/// Used by: pivots of the dense reference solver, and its condition estimate (16 eps cond < 1); coordinates without
/// inertia. The articulated-body algorithm (module algorithm, which does not see this file) has the same number.
inline constexpr int kRounding = 16;

/// Pivots of a damped K, in the same units: below, the damping counts as lost (regularised). A pivot that is c eps of
/// its terms leaves 1/c of the forces, so these are good to 1 % or better above it.
/// Used by: LU of the dense reference solver.
inline constexpr int kDampingRounding = 100 * kRounding;

/// Pivot of a contact row relative to its pivot if its body were free: E_kk / sum_j (G_kj^2 / P_jj). A row is
/// eliminated once joints below have given it that much; the body's inertia then grows by at most the inverse. The more
/// it grows, the less is left of the rows after, so loops along a chain of thousands of links want rows to wait for
/// more joints; rows that wait cost time. Used by: the factor of sparse-bodies.
inline constexpr double kRowMoves = 5e-2;
/// Rounding error of such a pivot relative to all that joints gave it, times its growth (factorize_bodies): 450 eps.
/// Where less is left, and anywhere below kPivotLeft, rows are redundant. Used by: the same; and for errors that small
/// pivots pass on, by PassedOn of all factors, and in SIMD batches (checks.hpp).
inline constexpr double kRowRounding = 1e-13;

/// Entry of J relative to the sizes of the products it is a sum of: above, its row plainly moves that coordinate, and
/// no other needs a check.
/// Used by: rows of J that vanish, in sparse-bodies.
inline constexpr double kPlainlyMoves = 1e-3;

/// Part of a row orthogonal to the rows before it on the same constrained body, relative to its length: below, that
/// body's rows are left in the system like any others. Orthogonal to 1e-14 by one pass of Gram and Schmidt.
/// Used by: constrained bodies of sparse-bodies.
inline constexpr double kHeldApart = 1e-2;
/// Part of the children's inertia that is kept along a constrained body's rows, where any number solves the system:
/// enough for a body without inertia of its own to have a pivot.
inline constexpr double kHeldKept = 1e-2;

// ---- pairs of bodies ------------------------------------------------------------------------------------------

/// Pivots of a column-pivoted QR of the rows between two bodies, relative to the largest: rows that span the others
/// keep more than the first. Rows that depend on them leave less than the second, the rounding error of 12 to 100 rows.
/// Points 1e-6 m apart, or 1e6 m away from other points, are between the two. The factorization then decides, as for
/// rows of a configuration: a basis of all rows would lose the digits by which these differ.
/// Used by: contact/pair_rows.hpp.
inline constexpr double kPairIndependent = 1e-5, kPairDependent = 1e-13;

/// Relative velocities and displacements of two bodies, relative to the velocities and moment arms they are differences
/// of: below, the bodies move as one, and damped contacts between them are consistent to first order.
/// Used by: dynamics/reduction/derivatives.cpp.
inline constexpr double kMovesAsOne = 1e-13;

// ---- dependent rows -------------------------------------------------------------------------------------------

/// Residual J_k - sum z_j J_j relative to J's entries when row k depends on the rows kept: the sum's own rounding
/// error, below 1e-14 for the 30 terms of kLargestEntry, with a margin for J's own. A row that is independent but kept
/// only kPivotLeft leaves 3e-6, seven orders more; in between the dense reference solver decides.
/// Used by: DependentRows::accepted.
inline constexpr double kRowLeft = 1e-13;

/// Largest coefficient z_j: the projector's error grows by its square, in units of eps, and 30^2 eps = 2e-13 stays
/// below the 1e-12 that any value is allowed. Larger ones mean rows kept that are much smaller than those dropped: then
/// the columns are made orthonormal. Used by: DependentRows::accepted, make_projector, WithinTolerance.
inline constexpr double kLargestEntry = 30;

/// Rows are exchanged until no entry is larger than this: each exchange makes the dropped rows' share of
/// the null space as many times larger, so that there is an end. Used by: exchange_rows.
inline constexpr double kExchanged = 2;

/// Coefficients z_j are zero below this (relative to 1, the entry of the dropped row): a few eps, left by substitution.
/// Used by: find_null_space.
inline constexpr double kNullEntry = 1e-15;

/// A column of the null space is refined while it leaves more than this of J's entries: a tenth of kRowLeft, so that
/// no column fails there for want of a refinement.
/// Used by: find_null_space.
inline constexpr double kNullColumn = 1e-14;
inline constexpr int kNullColumnSteps = 2;

/// The damping of a row that is dropped from a factor without changing its pattern: 1 / kDroppedDamping times any entry
/// squared is zero relative to any other. Used by: WithinTolerance.
inline constexpr double kDroppedDamping = 1e200;

/// Rows that wait in one element of a SIMD batch, at most: their null space is dense there, of as many columns. Used by:
/// BlockPlan.
inline constexpr std::size_t kMostWaitingInBatch = 64;

/// An order of contacts on a hub in which a few wait for longer is taken where it costs less than this part of the
/// other. Used by: contacts_early_order.
inline constexpr double kFarCheaper = 0.5;

/// Coordinates of an island from which sparse-bodies drops rows by itself: with fewer the whole K takes as long, and
/// keeps its factor for derivatives. Used by: BodiesSystem.
inline constexpr int kFewCoordinates = 100;

/// Joints along a chain after which a row that has not moved any is judged by a basis of its body's motions.
/// Used by: rows of J that vanish, in sparse-bodies.
inline constexpr int kManyJoints = 64;

/// Rows, and equations of their balance, of which sparse-bodies looks for a null vector along a chain: the
/// decomposition is dense, and on the stack. Used by: kkt/bodies/dependent_rows.cpp.
inline constexpr int kBalancedRows = 24, kBalanceEquations = 64;

/// Entries of N within which dropped rows are exchanged, or columns made orthonormal: each turn passes over all of them.
/// Used by: exchange_rows, make_projector.
inline constexpr std::size_t kMostExchanged = 1 << 20;

/// Closed loops: neither the tolerance nor the drift is more than the first part of the largest moment arm. From one
/// try to the next a row of J may keep the second part of its length. Used by: WithinTolerance.
inline constexpr double kMostDrift = 1e-2, kNextPivot = 1e-2;
/// Entries of N for rows without a part in a dependence are 1e-2 at most. Weighted least squares take them below kRank
/// in three steps; the least weight, relative to the usual one, is that of a column which only such rows have.
/// Used by: WithinTolerance.
inline constexpr int kReweighted = 4;
inline constexpr double kLeastWeight = 1e-10;

// ---- large islands -----------------------------------------------------------------------------------------------

/// Rows of J up to which the dense solver confirms doubtful solutions of others: 300 rows take 30 ms, 600 rows 170 ms.
/// Used by: the ways to solve the whole K, as all in this part.
inline constexpr int kFewRows = 300;
/// Rows of K up to which the dense solver is used after all others have refused: 3000 take 2 s and 72 MB a matrix.
inline constexpr int kDenseSize = 3000;
/// Rows of K up to which it differentiates islands solved by sparse-bodies: bodies solve for columns one by one, which
/// takes 4 to 70 times as long where K's factor is sound. Where it is not, the dense solver of a larger K would take
/// longer. Used by: differentiate.
inline constexpr int kDifferentiatedByMatrix = 1500;
/// Rows of K below which columns of derivatives may be solved for one by one: beyond, that takes many times as long as
/// a panel. Used by: solve_panel.
inline constexpr int kOneByOne = 400;
/// Rows of K below which all columns of its inverse are summed up; beyond, the norm is estimated.
/// Used by: inverse_norm.
inline constexpr int kSmallInverse = 64;
/// Largest number of rows of a subtree of sparse-bodies in a SIMD batch. For more rows the quadratic cost dominates.
/// Used by: lanes/subtree_plan.cpp.
inline constexpr int kLargestSubtree = 64;
/// Complete rows that stay open above a node: its body has six directions, so that more would depend on each other.
/// Used by: the factor of sparse-bodies.
inline constexpr int kMostOpen = 6;
/// The most that a row's pivot must keep there, however much rounding has grown. Used by: the same.
inline constexpr double kMostKept = 1e-5;
/// Islands of this many rows of J, and this many times their coordinates, are overdetermined: `auto` takes the dense
/// method, whose cost is linear in the rows. From kTooFull rows on the sparse methods with an order do so, too: among
/// rows of one body their factor is full. Used by: kkt/overdetermined.hpp.
inline constexpr int kOverdetermined = 300, kTimesOverdetermined = 4, kTooFull = 5000;

// ---- the proximal factor ----------------------------------------------------------------------------------------

/// delta relative to the largest diagonal entry of J M^-1 J^T: a thousand times the rounding error of its pivots. Those
/// of redundant rows are then below 4e-10 on walls of 3,600 boxes, others above 3e-8; at 1e-10 the two meet there.
/// Used by: ProximalFactor, as all in this part.
inline constexpr double kProximal = 1e-12;
/// Pivots of dependent rows are delta (1 + |z|^2), with their coefficients z, usually below the first number times
/// delta; pivots of other rows are usually above the second. Where one lies between, K is factorized again with
/// kStiffer delta. On uneven walls both kinds of rows have pivots of 1e6 delta.
inline constexpr double kPivotOfDependent = 1e2, kPivotOfOthers = 1e7, kStiffer = 10;
/// Rounding of a pivot changes its exponent by up to this many eps of its terms, relative to the pivot. The sum of the
/// exponents in all pivots may differ from an integer by the second number.
inline constexpr double kExponentRounding = 100, kExponentsLeft = 0.2;
/// The projection's factor for the smallest eigenvalue of J M^-1 J^T, which is usually below 1e-3: from 1/2 on rows
/// count as nearly dependent, and from 1 / (2 kPivotOfDependent) on where pivots are not compared.
inline constexpr double kSlowest = 0.5;
inline constexpr int kMostApplications = 12;
/// Entries of random vectors' projections, below which a row is in no null vector: a thousand times their rounding.
inline constexpr double kInNullSpace = 1e-11;
/// Part of a null space, relative to all, that no further projection takes out; and how many are made for it.
inline constexpr double kProjected = 1e-11;
inline constexpr int kProjections = 6;
/// J^T times the projections of random vectors may stop falling here, by rounding: an eigenvector of J M^-1 J^T that
/// the projection keeps leaves sqrt(delta), 1e-6.
inline constexpr double kMostLeft = 1e-11;
/// Proximal steps gain a factor of 1e3 and more each; near a singular configuration less.
inline constexpr int kProximalSteps = 30;
/// Contacts are inconsistent where steps leave more than this of delta f in their rows: they leave all of it then, and
/// rounding errors of 1e-4 of it otherwise.
inline constexpr double kProximalAgree = 1e-2;

/// J^T times random vectors of the null space leaves rounding: this many eps times the growth of K's entries.
inline constexpr double kGrown = 30;

// ---- refinement -----------------------------------------------------------------------------------------------

/// Backward error at which refinement has nothing left to gain: a few eps, rounding of the residual itself.
/// Used by: refinement of a solve, of least_norm_solution.
inline constexpr double kRefined = 1e-15;
inline constexpr int kRefinementSteps = 5;  // the error halves at least; two are usual

/// Backward error up to which a solution is accepted: errors of max(1e-12, 100 eps cond(K)) are allowed everywhere.
/// Growth of K's entries during elimination counts as such an error, eps times it: a right-hand side of derivatives may
/// show it that the solve's own did not.
/// Used by: all solves after refinement, panels of derivatives (normwise), least_norm_solution.
inline constexpr double kConverged = 1e-12;

/// Growth of K's entries, a third of the digits: one refinement brings its square, which is below eps. Beyond, panels
/// are judged by their own residuals, and contacts-early is given up for contacts that
/// wait for more (of a hub: ten of them count as one).
/// Used by: solve_panel, contacts_early_order.
inline constexpr double kMostGrowth = 1e6;

/// Backward error above which panels of derivatives are refined once, be it that of the unrefined solve or, where that
/// is more, the bound that the factor gives for every column: derivatives are allowed 1000 eps cond(K) = 2.2e-13
/// cond(K), of which an unrefined solve then takes less than a quarter. Used by: solve_panel, SIMD batches.
inline constexpr double kRefinePanel = 5e-14;

/// dense-schur, derivatives: normwise residuals at which refinement stops, half of the 1000 eps allowed; up to
/// kConverged they are accepted. Derivatives robot by robot: componentwise backward errors that are accepted.
inline constexpr double kPanelRefined = 1e-13;
inline constexpr int kPanelSteps = 3;  // the first is the solve itself

/// Numbers below this have lost relative digits by underflow (the smallest normal number is 2e-308): such a residual of
/// a column is meaningless. Used by: refine_panel.
inline constexpr double kVanishing = 1e-290;

/// Quadruple precision: normwise residual of a solution that counts as truth, 1e4 of float128's eps = 2e-30.
/// Steps: each gains at least a factor 2, and 30 digits are 100 factors; usual are 10 digits a step. A factor that
/// gains less than a factor 4 a step is left to the dense truth. Used by: refine_truth.
inline constexpr int kTruthRounding = 10000;  // units of eps of the scalar
inline constexpr int kTruthSteps = 60;

/// A correction of x by less than this part leaves |K| |x| as it is. Used by: SIMD batches, which then need no sizes.
inline constexpr double kSameSize = 1e-6;

// ---- single precision -----------------------------------------------------------------------------------------------

/// Factors: what floats have to leave more than doubles of a pivot or a row (kPivotLeft, kRank), and of two pivots in
/// turn (kRowRounding): 1e-5, 100 eps of floats, and 1e-7. Pivots that leave more are judged by their effect.
/// Used by: SIMD batches of floats.
inline constexpr double kSingleLeft = 1e6, kSinglePassedOn = 1e3;
/// Largest change by rounding errors, relative to the largest acceleration and force, for a solution in single
/// precision to be useful: two digits are left. The change is that of rounding errors of all terms with signs without
/// pattern.
inline constexpr double kWorthless = 1e-2;

/// The largest term of a robot's rows, in its units: below, floats may have lost it to underflow, which begins at
/// 1e-38. Used by: the same.
inline constexpr double kSmallestTerm = 1e-25;

/// 1 + the trace of a rotation that an orientation is off by: floats know it to 1e-6, and below this, which is 0.01 rad
/// from half a turn, they may take the other way round. Used by: the same.
inline constexpr double kHalfTurn = 1e-4;

// ---- judging answers ------------------------------------------------------------------------------------------

/// Contacts are inconsistent (mathematics.md): |J a + a0| > 1e-8 (| |J| |a| | + |a0|), maximum norms ...
/// Used by: `inconsistent`, in all methods.
inline constexpr double kContradiction = 1e-8;

/// A row of J waits below this many times kPivotLeft: 1e-6 of the terms of its pivot, so that the other rows' factor
/// loses no more than six digits, which refinement brings back. Used by: LdlFactor, SIMD batches.
inline constexpr double kWaits = 1e5;
/// Pivot of a waiting row in -S, relative to the row's terms. Rows that depend leave 1e-16, times the six digits that
/// the factor may have lost; rows that were badly placed left 1e-7 and more in all scenes that were tried.
inline constexpr double kJoins = 1e-9;
/// Rows that may wait in islands of more than kFewRows: each has a column of N, or one of S, which is dense. Beyond,
/// the proximal factor is cheaper. Used by: LdlFactor.
inline constexpr int kMostWaiting = 24;

/// Rounding errors of accelerations that loads cause and contacts cancel: relative to gravity some thousand eps,
/// without gravity a few eps of those of each robot's largest inertia by torques. Used by: the judge of contradictions.
inline constexpr double kLoadRounding = 1e-12, kTorqueRounding = 1e-15;
/// ... unless of every row it is rounding of the largest term that its a0 is computed from (bias_acceleration_terms,
/// [m/s^2] or [rad/s^2]): 500 eps, of chains of up to hundreds of joints.
inline constexpr double kDriftRounding = 1e-13;
/// Derivatives have the term of what is left sooner, from 20 eps on: of rounding it is rounding, too.
inline constexpr double kDriftNoise = 4e-15;

/// The smallest relative to the largest row, of rows that are inconsistent in least squares: normal equations of the
/// rows kept square that, and lose eight digits.
/// Used by: dependent rows, which leave such islands to the dense reference solver.
inline constexpr double kGradedRows = 1e-4;

/// Deviation of a floating base's quaternion from unit length, as files with 7 digits have it. Beyond, solving refuses.
/// Used by: check_input; module io refuses the same.
inline constexpr double kQuaternion = 1e-6;

/// Hager's and Higham's estimate of a 1-norm is a lower bound, nearly always within this factor.
/// Used by: estimate_errors.
inline constexpr double kNormEstimate = 3;
/// Error bounds, in eps of everything a row was computed from: 12 and the joints below the base that its terms pass
/// through.
/// Used by: estimate_errors.
inline constexpr int kBoundRounding = 12;

/// Terms of one equation relative to its own inertia or damping times the solution: above, their rounding errors
/// (kBoundRounding eps) may change a hundredth of it, and its bounds are checked.
/// Used by: solves of the whole K, and of damped islands in SIMD batches, which leave the check to it.
inline constexpr double kInDoubt = 0.01 / (kBoundRounding * std::numeric_limits<double>::epsilon());

/// The forces that a damped solution is compared with are at least this part of the largest load.
/// Used by: plainly_damped of SIMD batches and of robots that contacts join; proximal steps.
inline constexpr double kLeastLoad = 1e-3;

/// If a backward error is above kConverged, rows are compared with this part of the data they are computed from: two
/// digits less are not accepted. Used by: backward_error_of_data.
inline constexpr double kPartOfData = 1e-2;

// ---- the precision `extended` ---------------------------------------------------------------------------------
// Used by: dynamics/extended, which refines solutions in double-double, whose own rounding is about 2^-104.

/// Refinement has converged when the last correction of each robot's accelerations and each contact's forces is at most
/// this part of them (an eighth of double's rounding), or this part of the loads, which bounds solutions that vanish.
inline constexpr double kExtendedConverged = 0x1p-56, kExtendedVanishing = 0x1p-80;
/// A correction of more than kExtendedSlow times the one before ends refinement. Rounding in double-double stops it: it
/// has converged if its corrections are at most these parts, which leave the last digits of double.
inline constexpr double kExtendedSlow = 0.8;
inline constexpr double kExtendedStopped = 0x1p-52, kExtendedStoppedVanishing = 0x1p-60;
/// Least squares leave a part of the right-hand side that may be far larger than the terms of the solution. All its
/// digits count: the last change is at most this part of it, or of the loads, or this part where it stops.
inline constexpr double kExtendedDigits = 0x1p-96, kExtendedDigitsVanishing = 0x1p-110,
                        kExtendedDigitsStopped = 0x1p-85;
/// Rows depend exactly if forces exist with J^T n of at most this part of its terms. Rounding of a state in double
/// leaves 2^-53.
inline constexpr double kExtendedDependent = 0x1p-75;
/// Steps of refinement, enough up to a condition where each gains half a binary digit.
inline constexpr int kExtendedSteps = 60;
/// Numbers of a scene (placements, inertias, quaternions) are rounded when they are read. The error of a solution that
/// follows from this is at most kReadRounding of it and kReadShare of the bound by |K^-1|, which counts kBoundRounding
/// eps of each term: four of these. With 1/12, the median of bound over error would be 78 in place of 311, but 6 of
/// 42,000 random scenes exceeded their bound by up to 2.5 times. The precision `extended` is judged by the scene as
/// read: its share is 2^-104 / 2^-53, and 32 for the constants of sums and products in double-double.
/// Used by: estimate_errors.
inline constexpr double kReadRounding = 0x1p-48, kReadShare = 1.0 / 3, kExtendedShare = 0x1p-46;

// ---- choosing -------------------------------------------------------------------------------------------------

/// Another order is taken when its predicted cost is below this part of the present one's: predictions are no better,
/// and leaf-to-root is the sounder one.
/// Used by: the choice of orders.
inline constexpr double kCheaper = 0.9;

/// Part of the length of J's rows that a QR decomposition of some of J's columns must have left in its last pivot, for
/// these coordinates to give a contact that is eliminated early its pivots. If they do not, more is required.
/// Used by: the order contacts-early.
inline constexpr double kDistinct = 1e-3;
/// The values required then, the last one whatever its result.
inline constexpr double kMoreDistinct[] = {kDistinct, 3e-2, 1e-1};
/// Orders of more than this many times the predicted cost of another are not tested: requiring more makes an order a
/// few times dearer, and thousands of times where a hub then comes before its contacts.
inline constexpr double kFarDearer = 100;
/// An island with so many contacts has some on a hub that are ill-placed in each configuration tested. These wait, for
/// kWaitDistinct, where the order then costs less than kFarCheaper; ten contacts may add the growth of one.
inline constexpr std::size_t kManyContacts = 100;
inline constexpr double kWaitDistinct = 3 * kDistinct, kGrowTogether = 10;

/// Zeros by structure in a supernode of L, at most 1 / kZeros of its entries, and columns of so few entries that they
/// are left alone. Used by: relaxed_supernodes.
inline constexpr int kZeros = 12, kShort = 16;

}  // namespace manycontact::tolerance
