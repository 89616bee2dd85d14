#pragma once
// Pairs: all contacts between the same two bodies, whose constraint rows are reduced to a basis of their span.
//
// In A's body frame the relative motion nu of two bodies has six numbers. The rows of contact m are W_m X_m nu, where
// X_m transforms nu to the contact's frame. W_m and X_m are constant, so the rows of all contacts are
//
//     S J = B nu,    B = [S_m W_m X_m] (n x 6),    B = Q R,   Q^T Q = 1,   R (r x 6), r <= 6 the rank of B.
//
// The diagonal S multiplies angular rows by Scene::moment_length. The pair has the rows R nu and the bias a0 = Q^T S
// a0_all in place of all contacts' rows and their biases a0_all. Forces y of the pair give contact forces f = S Q y of
// least norm |S^-1 f|. (1 - Q Q^T) S a0_all is the inconsistency of the contacts.

#include <memory>
#include <span>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

using SharedPairNumbers = std::shared_ptr<const PairNumbers<double>>;

/// A strict order of pair numbers, by R, Q and A, which determine the other members. Equal objects are equivalent.
struct PairNumbersLess {
  bool operator()(const SharedPairNumbers& a, const SharedPairNumbers& b) const;
};

struct PairRows {
  std::vector<int> contacts;     // numbers of the contacts in the scene, ascending
  std::vector<Contact> members;  // the contacts, with the properties that rows need: type, axis, gains, placements
  SharedPairNumbers numbers;     // shared by all pairs of a reduction with equal numbers
  std::vector<SE3<double>> B;    // one entry per member: placement of its B' in the pair's B'
  std::vector<double> unit;      // S: weights of the rows of all members, one number per row
  std::vector<char> spans;       // one flag per row of all members: one of the first `rank` independent rows
  int kind = 0;                  // equal for pairs with members of the same types, in the same order, and the same rank
};

/// Returns the number of the contact's type in keys of structures: PairRows::kind for a pair.
inline int kind_of(const Contact& contact) {
  return contact.pair ? contact.pair->kind : static_cast<int>(contact.type);
}

/// Whether a contact's rows are constant in A's axes.
inline bool has_constant_rows(const Contact& contact) { return contact.reference_frame == ReferenceFrame::kLocal; }

/// Returns the contact that replaces these contacts between the same two bodies, whose rows must be constant in A's
/// axes (has_constant_rows). Its `pair` is null if the rows are independent or their rank is doubtful.
Contact pair_of(const Scene& scene, std::span<const int> contacts);
/// Updates a pair's contact and PairRows with values that may change between solves: gains, and B's placement.
void refresh_pair(const Scene& scene, PairRows& rows, Contact& pair);

}  // namespace manycontact
