#pragma once
// Derivatives of robots side by side: dynamics/differentiate.cpp for all lanes at once, but for the triangular solves,
// which take one robot after the other.

#include <functional>
#include <numeric>

#include "../derivative_columns.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "side_by_side.hpp"

namespace manycontact::lanes {

template <class S>
void SideBySide<S>::differentiate(const DerivativeJob& job, std::span<const Island* const> islands,
                                  std::span<const Panel> panels) {
  const Island& first = *islands.front();
  linearise(job, islands);
  derivative_terms(job.scene, first);
  find_reach(job, panels.front().ld);
  right_sides(job, panels.front().ld);
  Mask plain = S(0) <= S(0);
  if (std::any_of(panels.begin(), panels.end(), [](const Panel& panel) { return panel.refine; })) {
    S wanted(0);
    for (std::size_t l = 0; l < panels.size(); ++l) wanted.set(static_cast<int>(l), panels[l].refine);
    plain = select(wanted > S(0), select(accurate_unrefined(), S(1), S(0)), S(1)) > S(0);
  }
  solve_panels(panels, plain, job.past_caches);
  for (std::size_t l = 0; l < panels.size(); ++l)
    if (!plain[static_cast<int>(l)]) solve_refined(static_cast<int>(l), panels[l]);
}

/// Contact forces on the bodies, and the terms of -dr.
template <class S>
void SideBySide<S>::derivative_terms(const Scene& scene, const Island& island) {
  std::fill(fext_.begin(), fext_.end(), Vec6<S>(Vec6<S>::Zero()));
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    add_force<S>(contact, contacts_[k], contacts_[k].W.transpose() * contact_f_[k], fext_);
  }
  rnea_derivatives<S>(*model_, kin_, Yc_, fext_, rnea_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const bool between = contact.B.robot >= 0;
    contact_derivatives<S>(contact, supports_[k], kin_, between ? &kin_ : nullptr, rnea_, between ? &rnea_ : nullptr,
                           contact_f_[k], contacts_[k], contact_terms_[k]);
  }
}

/// Chunks of columns, each of parts that reach much the same rows; memory, and what never changes of right-hand sides.
template <class S>
void SideBySide<S>::find_reach(const DerivativeJob& job, int ld) {
  const int size = pattern_->size(), parts = ld / kPart;
  if (request_ == job.request && !chunks_.empty() && place_.size() == static_cast<std::size_t>(size) * ld) return;
  chunks_.clear();  // so that they are not taken for found, should memory run out
  std::vector<std::vector<char>> reach(parts, std::vector<char>(size, 0)), reached;
  const auto set = [&](int row, int column) { reach[column / kPart][pattern_->iperm[row]] = 1; };
  for (const auto& [i, j, of_tree] : places_) {
    if (job.request.q) set(i, job.q_first + j);
    if (job.request.v) set(i, job.v_first + j);
  }
  for (int i = 0; job.request.u && i < torques(job); ++i) set(torque(job, i), job.u_first + i);
  reached = reach;
  for (std::vector<char>& rows : reached) sparse::ldl_scheduled_reach(pattern_->schedule(), rows.data());

  std::vector<Chunk> chunks;
  reach_.clear(), reached_.clear();
  place_.assign(static_cast<std::size_t>(size) * ld, -1);
  std::size_t count = 0;
  std::vector<char> taken(parts, 0);
  const auto differ = [&](int a, int b) {  // rows that one of two parts reaches alone
    return std::inner_product(reached[a].begin(), reached[a].end(), reached[b].begin(), 0, std::plus<>(),
                              std::not_equal_to<>());
  };
  for (int a = 0; a < parts; ++a) {
    if (taken[a]) continue;
    Chunk chunk{{a * kPart}, 1, count};
    for (; chunk.parts < kParts; ++chunk.parts) {
      int best = -1;
      for (int b = a + 1; b < parts; ++b)
        if (!taken[b] && (best < 0 || differ(a, b) < differ(a, best))) best = b;
      if (best < 0) break;
      taken[best] = 1;
      chunk.first[chunk.parts] = best * kPart;
      std::transform(reach[a].begin(), reach[a].end(), reach[best].begin(), reach[a].begin(), std::bit_or<>());
    }
    for (int k = 0; k < size; ++k)
      for (int c = 0; reach[a][k] && c < chunk.parts * kPart; ++c)
        place_[pattern_->perm[k] * ld + chunk.first[c / kPart] + c % kPart] = static_cast<int>(count++);
    chunks.push_back(chunk);
    reach_.insert(reach_.end(), reach[a].begin(), reach[a].end());
    sparse::ldl_scheduled_reach(pattern_->schedule(), reach[a].data());
    reached_.insert(reached_.end(), reach[a].begin(), reach[a].end());
  }
  B_.assign(count, S(0));
  if (W > 1) Bx_.assign(W * count, 0);
  pieces_.resize(parts);
  std::size_t at = 0;  // in the answer
  for (Chunk& chunk : chunks) {
    chunk.answer = at;
    const int columns = chunk.parts * kPart;
    for (int k = 0; k < chunk.parts; ++k) pieces_[chunk.first[k] / kPart] = {at + k * kPart, columns};
    at += static_cast<std::size_t>(columns) * size;
  }
  work_.resize(std::max(work_.size(), at + 8));  // from a cache line on
  for (int i = 0; job.request.u && i < torques(job); ++i) B_[place_[torque(job, i) * ld + job.u_first + i]] = S(1);
  unset_.clear();
  for (const auto& [i, j, of_tree] : places_) {
    if (!of_tree && job.request.q) unset_.push_back(place_[i * ld + job.q_first + j]);
    if (!of_tree && job.request.v) unset_.push_back(place_[i * ld + job.v_first + j]);
  }
  chunks_ = std::move(chunks);
  request_ = job.request;
}

/// B = [-dr/dq -dr/dv S], S selecting the torques, which is there already.
template <class S>
void SideBySide<S>::right_sides(const DerivativeJob& job, int ld) {
  const Placed B{B_.data(), place_.data(), ld};
  for (int k : unset_) B_[k] = S(0);
  const auto rows = [&](std::size_t k, int first) { return B.block(model_->nv + row_offset_[k], first); };
  if (job.request.q) {
    const Placed top = B.block(0, job.q_first);
    internal::robot_columns<S>(*model_, rnea_.dq_lower.data(), rnea_.dq_upper.data(), top);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      internal::contact_columns<S>(contacts_[k], contact_terms_[k].dx_dq, columns_[k], rows(k, job.q_first));
      internal::turning_columns<S>(contacts_[k], contact_terms_[k], 0, rows(k, job.q_first));
      internal::force_columns<S>(contacts_[k], contact_terms_[k], columns_[k], 0, 0, top);
    }
  }
  if (job.request.v) {
    internal::robot_columns<S>(*model_, rnea_.dv_lower.data(), rnea_.dv_upper.data(), B.block(0, job.v_first));
    for (std::size_t k = 0; k < contacts_.size(); ++k)
      internal::contact_columns<S>(contacts_[k], contact_terms_[k].dx_dv, columns_[k], rows(k, job.v_first));
  }
}

/// Lanes in which every column of every panel has a backward error of no more than kRefinePanel as it comes from the
/// factor: |dK|_1 / |K|_1 of sparse::ldl_rounding.
template <class S>
typename S::Mask SideBySide<S>::accurate_unrefined() {
  sparse::ldl_row_sums(pattern_->K, numbers(K_.data()), pattern_->ldl, numbers(L_.data()), numbers(D_.data()),
                       numbers(r_.data()), numbers(scale_.data()));
  S of_factor(0), of_K(0);
  for (std::size_t k = 0; k < r_.size(); ++k) {
    of_factor = larger(r_[k], of_factor);
    of_K = larger(scale_[k], of_K);
  }
  return S(rounding_) * of_factor <= S(tolerance::kRefinePanel) * of_K;
}

/// [da; df] = K^-1 B of the lanes that are plain, one after the other: what one needs stays in the first cache.
template <class S>
void SideBySide<S>::solve_panels(std::span<const Panel> panels, Mask plain, bool past_caches) {
  for (std::size_t k = 0; k < D_.size(); ++k) correction_[k] = S(1) / D_[k];
  sparse::ldl_pack(pattern_->schedule(), L_.data(), packed_.data());
  spread_lanes(L_.data(), L_.size(), Lx_.data(), L_.size());
  spread_lanes(packed_.data(), packed_.size(), packed_x_.data(), packed_.size());
  spread_lanes(correction_.data(), D_.size(), inverse_.data(), D_.size());
  if (W > 1) spread_lanes(B_.data(), B_.size(), Bx_.data(), B_.size());
  for (std::size_t l = 0; l < panels.size(); ++l) {
    if (!plain[static_cast<int>(l)]) continue;
    for (std::size_t c = 0; c < chunks_.size(); ++c) solve_chunk(c, l);
    // Many panels are not in the caches: they are written from one end to the other.
    if (past_caches)
      write(panels[l], [](const auto& piece, double* to) { piece.stream(to); });
    else
      write(panels[l], [](const auto& piece, double* to) { piece.store(to); });
  }
  if (past_caches) sparse::kernel::finish_streams();
}

/// What the chunks left in work_, to X, which starts at a cache line and whose rows are multiples of it.
template <class S>
template <class Put>
void SideBySide<S>::write(const Panel& panel, Put&& put) {
  const double* x = answer();
  double* to = panel.X;
  for (int i = 0; i < pattern_->size(); ++i) {
    const int k = pattern_->iperm[i];
    const double sign = i < model_->nv ? 1 : -1;
    for (const Piece& piece : pieces_) {
      put(sparse::kernel::Tile<double, kPart>::load(x + piece.at + k * piece.stride).times(sign), to);
      to += kPart;
    }
  }
}

template <class S>
template <int N>
void SideBySide<S>::solve_chunk(std::size_t chunk, std::size_t lane) {
  if (chunks_[chunk].parts * kPart == N)
    solve_columns<N>(chunk, lane);
  else if constexpr (N > kPart)
    solve_chunk<N - kPart>(chunk, lane);
}

template <class S>
template <int N>
void SideBySide<S>::solve_columns(std::size_t chunk, std::size_t lane) {
  using Row = sparse::kernel::Tile<double, N>;
  const std::size_t size = D_.size();
  const char *reach = reach_.data() + chunk * size, *reached = reached_.data() + chunk * size;
  const double zeros[N] = {};
  const double* b =
      (W == 1 ? reinterpret_cast<const double*>(B_.data()) : Bx_.data() + lane * B_.size()) + chunks_[chunk].at;
  double* x = answer() + chunks_[chunk].answer;
  for (std::size_t k = 0; k < size; ++k) {
    Row::load(reach[k] ? b : zeros).store(x + k * N);
    if (reach[k]) b += N;
  }
  sparse::kernel::solve_columns<N>(pattern_->schedule(), Lx_.data() + lane * L_.size(),
                                   packed_x_.data() + lane * packed_.size(), inverse_.data() + lane * size, reached, x,
                                   [](int, const Row&) {});
}

/// X + K^-1 (B - K X) of one lane, X = K^-1 B.
template <class S>
void SideBySide<S>::solve_refined(int lane, const Panel& panel) {
  const auto take = [lane](const S* from, std::size_t count, double* to) {
    for (std::size_t k = 0; k < count; ++k) to[k] = from[k][lane];
  };
  take(D_.data(), D_.size(), Dx_.data());
  take(K_.data(), K_.size(), Kx_.data());
  for (std::size_t k = 0; k < place_.size(); ++k) panel.X[k] = place_[k] < 0 ? 0 : B_[place_[k]][lane];
  std::fill(nonzero_.begin(), nonzero_.end(), 1);
  sparse::panel_kernels().solve_refined(pattern_->schedule(), pattern_->K, Kx_.data(), Lx_.data() + lane * L_.size(),
                                        Dx_.data(), pattern_->perm.data(), panel.X, panel.ld, 0, panel.ld,
                                        nonzero_.data(), work_.data());
  for (std::size_t k = static_cast<std::size_t>(model_->nv) * panel.ld; k < place_.size(); ++k)
    panel.X[k] = -panel.X[k];
}

}  // namespace manycontact::lanes
