#pragma once
// Copies numbers between arrays, one per robot or contact, and packs S = Pack<W> with W elements, one per array.

#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "block.hpp"
#include "manycontact/contact/pair_rows.hpp"
#include "manycontact/detail/spatial/pack.hpp"

namespace manycontact::lanes {

template <class Kernel, class Work, class... Arguments>
std::unique_ptr<Kernel> make_kernel(Arguments... arguments) {  // a kernel for one item per element of Work's packs
  return std::make_unique<Work>(arguments...);
}

/// Casts packs of one element to plain numbers, for which sparse kernels process several rows of a column at a time.
template <class E>
E* as_scalar(Pack<1, E>* x) {
  return x ? &x->v : nullptr;
}
template <class E>
const E* as_scalar(const Pack<1, E>* x) {
  return x ? &x->v : nullptr;
}
template <int W, class E>
Pack<W, E>* as_scalar(Pack<W, E>* x) {
  return x;
}
template <int W, class E>
const Pack<W, E>* as_scalar(const Pack<W, E>* x) {
  return x;
}

inline constexpr int kMostInBatch = 16;  // the largest number of robots in a SIMD batch: 16 floats in 512 bits

/// Returns a pack of floats with the elements of `a`, then the elements of `b`.
template <int H, std::size_t... I>
Pack<2 * H, float> narrowed(const Pack<H>& a, const Pack<H>& b, std::index_sequence<I...>) {
  typedef float Half __attribute__((vector_size(sizeof(float) * H)));
  const Half x = __builtin_convertvector(a.v, Half), y = __builtin_convertvector(b.v, Half);
  return Pack<2 * H, float>::of(__builtin_shufflevector(x, y, I...));
}

/// Sets element l of to[k] to from[l][k] for k < count, rounded if E is float. Surplus elements repeat the last array.
template <int W, class E>
[[gnu::noinline]] void load_arrays(std::span<const double* const> from, int count, Pack<W, E>* to) {
  const auto lane = [&](int l) { return from[std::min<std::size_t>(l, from.size() - 1)]; };
  int k = 0;
  if constexpr (std::is_same_v<E, double>) {
    for (; k + W <= count; k += W) {
      for (int l = 0; l < W; ++l) to[k + l] = Pack<W>::load(lane(l) + k);
      transpose(to + k);
    }
  } else if constexpr (W > 1) {
    constexpr int H = W / 2;
    for (; k + H <= count; k += H) {
      Pack<H> halves[2][H];
      for (int l = 0; l < W; ++l) halves[l / H][l % H] = Pack<H>::load(lane(l) + k);
      transpose(halves[0]), transpose(halves[1]);
      for (int i = 0; i < H; ++i) to[k + i] = narrowed(halves[0][i], halves[1][i], std::make_index_sequence<W>());
    }
  }
  for (int l = 0; l < W; ++l)
    for (int i = k; i < count; ++i) to[i].set(l, lane(l)[i]);
}

/// Sets to[l][k] to element l of from[k] for k < count.
template <int W, class E>
[[gnu::noinline]] void store_arrays(const Pack<W, E>* from, int count, std::span<double* const> to) {
  int k = 0;
  if constexpr (std::is_same_v<E, double>)
    for (; k + W <= count; k += W) {
      Pack<W> block[W];
      for (int i = 0; i < W; ++i) block[i] = from[k + i];
      transpose(block);
      for (std::size_t l = 0; l < to.size(); ++l) block[l].store(to[l] + k);
    }
  for (std::size_t l = 0; l < to.size(); ++l)
    for (int i = k; i < count; ++i) to[l][i] = from[i][static_cast<int>(l)];
}

/// Stores the pointers at(item) of all items in `memory`, and returns them.
template <class P, int N, class Item, class At>
std::span<P const> side_by_side(std::span<Item> items, P (&memory)[N], At&& at) {
  for (std::size_t l = 0; l < items.size(); ++l) memory[l] = at(items[l]);
  return {memory, items.size()};
}

/// Loads pair_B and the PairNumbers of the items' contacts, which all have Contact::pair. PairNumbers that all items
/// share with the last call (`common`) are not loaded again. Sets `common` to those that all items share, or nullptr.
template <class S, class Item, class Of>
void load_pair(std::span<Item> items, Of&& contact_data, ContactData<S>& to, const PairNumbers<double>*& common) {
  const double* from[kMostInBatch];
  const auto load = [&](auto&& numbers, S* at, Eigen::Index count) {
    load_arrays(
        side_by_side(items, from, [&](auto& item) -> const double* { return numbers(*contact_data(item).pair); }),
        static_cast<int>(count), at);
  };
  for (std::size_t m = 0; m < to.pair_B.size(); ++m)
    load([m](const PairRows& pair) { return pair.B[m].R.data(); }, to.pair_B[m].R.data(), 12);
  const PairNumbers<double>* const first = contact_data(items.front()).pair->numbers.get();
  const bool alike =
      std::ranges::all_of(items, [&](auto& item) { return contact_data(item).pair->numbers.get() == first; });
  if (alike && common == first) return;
  common = alike ? first : nullptr;
  PairNumbers<S>& own = *to.pair;
  load([](const PairRows& pair) { return pair.numbers->Q.data(); }, own.Q.data(), own.Q.size());
  load([](const PairRows& pair) { return pair.numbers->R.data(); }, own.R.data(), own.R.size());
  load([](const PairRows& pair) { return pair.numbers->R_right.data(); }, own.R_right.data(), own.R_right.size());
  load([](const PairRows& pair) { return pair.numbers->terms.data(); }, own.terms.data(), own.terms.size());
  for (std::size_t m = 0; m < own.A.size(); ++m)
    load([m](const PairRows& pair) { return pair.numbers->A[m].R.data(); }, own.A[m].R.data(), 12);
}

template <class S>
S smallest_row(const ContactData<S>& rows) {  // the least over J's rows of the row's largest |entry|
  S smallest(std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < rows.J.rows(); ++i) {
    S size(0);
    for (Eigen::Index j = 0; j < rows.J.cols(); ++j) size = larger(abs(rows.J(i, j)), size);
    smallest = -larger(-size, -smallest);
  }
  return smallest;
}

template <class S>
const WorldPoint<S>& origin_at(const Kinematics<S>& kin, int joint) {  // origin of the tree frame of the joint's body
  return kin.origins[kin.tree_of[joint]];
}
template <class S>
S* origin_numbers(Kinematics<S>& kin, int joint) {
  return kin.origins[kin.tree_of[joint]].p.data();
}

template <class S>
struct PlacedEnd {  // a contact's frame in its body's tree frame, and the tree frame's origin in the world
  SE3<S> frame;
  WorldPoint<S> origin;
};
template <class S>
PlacedEnd<S> placed_end(const Attachment& at, const Kinematics<S>& kin, const SE3<S>& on_body,
                        const StandingEnd<S>& standing) {
  if (moves(at)) return {kin.oMi[at.joint] * on_body, origin_at<S>(kin, at.joint)};
  return {standing.frame, {standing.origin}};
}

/// Evaluates a contact's rows. on_A, on_B: positions of the contact's frames on bodies A and B; zero if fixed.
template <class S>
void rows_between(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                  const Kinematics<S>& kinA, const PlacedEnd<S>& A, const Vec3<S>& on_A, const Kinematics<S>& kinB,
                  const PlacedEnd<S>& B, const Vec3<S>& on_B, ContactData<S>& rows) {
  rows.on_A = on_A, rows.on_B = on_B;
  contact_rows_between<S>(gravity, contact, support, kinA, A.frame, moves(contact.B) ? &kinB : nullptr, B.frame,
                          A.origin.seen_from(B.origin), rows);
}

}  // namespace manycontact::lanes
