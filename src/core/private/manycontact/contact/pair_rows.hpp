#pragma once
// Constraint rows of all contacts between the same two bodies, reduced to a basis of their span.
//
// In A's body frame the relative motion nu of two bodies has six numbers. Contact m's rows are W_m X_m nu, where X_m
// transforms nu to its own frame. These are constant, so the rows of all contacts are
//
//     S J = B nu,    B = [S_m W_m X_m] (n x 6),    B = Q R,   Q^T Q = 1,   R (r x 6), r <= 6 the rank of B.
//
// S weighs angular rows by Scene::moment_length. The pair's rows R nu, with a0 = Q^T S a0_all, replace all; the forces
// of least norm |S^-1 f| are f = S Q y. (1 - Q Q^T) S a0_all is the inconsistency of the contacts for any motion.

#include <memory>
#include <span>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

using SharedPairNumbers = std::shared_ptr<const PairNumbers<double>>;

/// Strict order of numbers in which equal ones are equivalent. Compares R, Q and A, which determine the rest.
struct PairNumbersLess {
  bool operator()(const SharedPairNumbers& a, const SharedPairNumbers& b) const;
};

struct PairRows {
  std::vector<int> contacts;     // numbers in the scene, ascending
  std::vector<Contact> members;  // properties that rows need: type, axis, gains, placements
  SharedPairNumbers numbers;     // shared by all pairs of a reduction with equal numbers
  std::vector<SE3<double>> B;    // one entry per member: its B' in the pair's B'
  std::vector<double> unit;      // S, one number per row of all members
  std::vector<char> spans;       // one flag per row of all members: among the first `rank` that span all
  int kind = 0;                  // equal for pairs with members of the same types, in order, and the same rank
};

/// Returns the property besides joints for which contact kernels are compiled: the type, or a pair's kind.
inline int kind_of(const Contact& contact) {
  return contact.pair ? contact.pair->kind : static_cast<int>(contact.type);
}

/// Whether a contact's rows are constant in A's axes.
inline bool has_constant_rows(const Contact& contact) { return contact.reference_frame == ReferenceFrame::kLocal; }

/// Returns the contact that replaces these contacts between the same two bodies, which have constant rows. Its `pair`
/// is null if their rows are independent, or if their geometry leaves the rank doubtful.
Contact pair_of(const Scene& scene, std::span<const int> contacts);
/// Updates a contact by pair_of and its PairRows with what may change under data in use: gains, and B's placement.
void refresh_pair(const Scene& scene, PairRows& rows, Contact& pair);

}  // namespace manycontact
