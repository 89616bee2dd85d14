#pragma once
// The rows of all contacts between the same two bodies, reduced to those that span them.
//
// Seen from A's body, the relative motion nu of two bodies has six numbers. The rows of contact m between them are
// W_m X_m nu, where X_m takes nu to the contact's own frame. All are constant, so that the rows of all contacts are
//
//     S J = B nu,    B = [S_m W_m X_m] (n x 6),    B = Q R,   Q^T Q = 1,   R (r x 6), r <= 6 the rank of B.
//
// S weighs rows that turn by Scene::moment_length. The pair's rows R nu, with a0 = Q^T S a0_all, take the place of all.
// With their forces y the forces of all are f = S Q y: the ones of least norm |S^-1 f|, since Q is orthonormal.
// (1 - Q Q^T) S a0_all is the inconsistency of the pair's contacts, whatever the bodies do.

#include <memory>
#include <span>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

using SharedPairNumbers = std::shared_ptr<const PairNumbers<double>>;

/// A strict order of numbers, in which equal ones are equivalent. It compares R, Q and A, which determine the others.
struct PairNumbersLess {
  bool operator()(const SharedPairNumbers& a, const SharedPairNumbers& b) const;
};

struct PairRows {
  std::vector<int> contacts;     // numbers in the scene, ascending
  std::vector<Contact> members;  // properties that the rows of each need: type, axis, gains, placements
  SharedPairNumbers numbers;     // one object for all pairs of a reduction with equal numbers
  std::vector<SE3<double>> B;    // one entry per member: its B' in the pair's B'
  std::vector<double> unit;      // S, one number per row of all members
  std::vector<char> spans;       // a flag per row of all members: it is one of the first that span all, `rank` of them
  int kind = 0;                  // equal for pairs whose members are of the same types, in order, and of one rank
};

/// The properties other than joints for which kernels of contacts are compiled: the type, or a pair's kind.
inline int kind_of(const Contact& contact) {
  return contact.pair ? contact.pair->kind : static_cast<int>(contact.type);
}

/// Whether a contact's rows are constant on the relative motion of its bodies, seen from A's: those in A's axes.
inline bool has_constant_rows(const Contact& contact) { return contact.reference_frame == ReferenceFrame::kLocal; }

/// Returns the contact that replaces these contacts of the scene, which are between the same two bodies and have
/// constant rows. Its `pair` is empty if their rows are independent, or if the rank cannot be determined reliably from
/// their geometry.
Contact pair_of(const Scene& scene, std::span<const int> contacts);
/// Takes what may change under data in use into a contact by pair_of and its PairRows: gains, and where B' is.
void refresh_pair(const Scene& scene, PairRows& rows, Contact& pair);

}  // namespace manycontact
