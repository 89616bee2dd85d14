#pragma once
// Derivatives of robots side by side: dynamics/differentiate.cpp for all lanes at once.

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
  if (plain.any()) solve_panels(panels, plain, job.past_caches);
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
  rnea_derivatives<S>(*model_, robot_.kin, robot_.Yc, fext_, rnea_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const bool between = contact.B.robot >= 0;
    contact_derivatives<S>(contact, supports_[k], robot_.kin, between ? &robot_.kin : nullptr, rnea_,
                           between ? &rnea_ : nullptr, contact_f_[k], contacts_[k], contact_terms_[k]);
  }
}

/// What never changes of right-hand sides, and in which chunks of columns they are solved.
template <class S>
void SideBySide<S>::find_reach(const DerivativeJob& job, int ld) {
  const int size = pattern_->size();
  if (request_ == job.request && !chunks_.empty() && place_.size() == static_cast<std::size_t>(size) * ld) return;
  chunks_.clear();  // so that they are not taken for found, should memory run out
  std::vector<std::vector<char>> reach(ld / kPart, std::vector<char>(size, 0));
  const auto set = [&](int row, int column) { reach[column / kPart][pattern_->iperm[row]] = 1; };
  for (const auto& [i, j, of_tree] : places_) {
    if (job.request.q) set(i, job.q_first + j);
    if (job.request.v) set(i, job.v_first + j);
  }
  for (int i = 0; job.request.u && i < torques(job); ++i) set(torque(job, i), job.u_first + i);
  std::vector<Chunk> chunks = form_chunks(reach, ld);
  for (int i = 0; job.request.u && i < torques(job); ++i) B_[place_[torque(job, i) * ld + job.u_first + i]] = S(1);
  unset_.clear();
  for (const auto& [i, j, of_tree] : places_) {
    if (!of_tree && job.request.q) unset_.push_back(place_[i * ld + job.q_first + j]);
    if (!of_tree && job.request.v) unset_.push_back(place_[i * ld + job.v_first + j]);
  }
  chunks_ = std::move(chunks);
  request_ = job.request;
}

/// Bands of columns whose answers stay in the second cache; in each, chunks of parts that reach much the same rows.
/// reach: of each part, in the pattern's order. Memory, and where right-hand sides and answers stand in it.
template <class S>
auto SideBySide<S>::form_chunks(std::span<const std::vector<char>> reach, int ld) -> std::vector<Chunk> {
  constexpr std::size_t kBand = 1 << 19;  // bytes
  constexpr int kWhole = std::lcm(8, kColumns);
  const std::size_t size = D_.size();
  const int parts = ld / kPart,
            wide = std::max(static_cast<int>(kBand / (size * sizeof(Number))), kWhole) / kWhole * kWhole / kPart;
  std::vector<std::vector<char>> reached(reach.begin(), reach.end());
  for (std::vector<char>& rows : reached) sparse::ldl_scheduled_reach(pattern_->schedule(), rows.data());
  std::vector<int> order(parts);  // those that reach nothing come last
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return a / wide != b / wide ? a / wide < b / wide : reached[a] > reached[b]; });

  std::vector<Chunk> chunks;
  bands_.clear(), reach_.clear(), reached_.clear();
  place_.assign(size * ld, -1);
  pieces_.resize(parts);
  std::size_t count = 0, at = 0, most = 0;  // of right-hand sides; of the band's answers, of any band's
  for (int next = 0; next < parts;) {
    const int band = order[next] / wide;
    if (static_cast<std::size_t>(band) == bands_.size()) bands_.push_back({band * wide, 0, chunks.size(), 0}), at = 0;
    Chunk chunk{{}, 0, count, at};
    std::vector<char> rows(size, 0);
    for (; chunk.parts < kParts && next < parts && order[next] / wide == band; ++chunk.parts, ++next) {
      const std::vector<char>& of_part = reach[order[next]];
      chunk.first[chunk.parts] = order[next] * kPart;
      std::transform(rows.begin(), rows.end(), of_part.begin(), rows.begin(), std::bit_or<>());
    }
    const int columns = chunk.columns();
    for (std::size_t k = 0; k < size; ++k)
      for (int c = 0; rows[k] && c < columns; ++c, ++count)
        if (c < chunk.parts * kPart)
          place_[pattern_->perm[k] * ld + chunk.first[c / kPart] + c % kPart] = static_cast<int>(count);
    for (int k = 0; k < chunk.parts; ++k) pieces_[chunk.first[k] / kPart] = {at + k * kPart, columns};
    most = std::max(most, at += columns * size);
    chunks.push_back(chunk);
    bands_.back().end = std::min((band + 1) * wide, parts);
    bands_.back().chunk_end = chunks.size();
    reach_.insert(reach_.end(), rows.begin(), rows.end());
    sparse::ldl_scheduled_reach(pattern_->schedule(), rows.data());
    reached_.insert(reached_.end(), rows.begin(), rows.end());
  }
  B_.assign(count, S(0));
  work_.resize(std::max(work_.size(), W * most + 8));  // from a cache line on
  return chunks;
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
    const Placed top = B.block(0, job.v_first);
    internal::robot_columns<S>(*model_, rnea_.dv_lower.data(), rnea_.dv_upper.data(), top);
    for (std::size_t i = 0; i < slope_.size(); ++i) top(static_cast<int>(i), static_cast<int>(i)) -= slope_[i];
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

/// [da; df] = K^-1 B, into the panels of the lanes that are plain.
template <class S>
void SideBySide<S>::solve_panels(std::span<const Panel> panels, Mask plain, bool past_caches) {
  for (std::size_t k = 0; k < D_.size(); ++k) correction_[k] = S(1) / D_[k];
  sparse::ldl_pack(pattern_->schedule(), L_.data(), packed_.data());
  for (const Band& band : bands_) {
    for (std::size_t c = band.chunk; c < band.chunk_end; ++c) solve_chunk(c);
    // Many panels are not in the caches: they are written from one end to the other.
    if (past_caches)
      write(band, panels, plain, [](const auto& piece, double* to) { piece.stream(to); });
    else
      write(band, panels, plain, [](const auto& piece, double* to) { piece.store(to); });
  }
  if (past_caches) sparse::kernel::finish_streams();
}

/// What the chunks of a band left in work_, to the panels, which start at a cache line and whose rows are multiples of
/// it.
template <class S>
template <class Put>
void SideBySide<S>::write(const Band& band, std::span<const Panel> panels, Mask plain, Put&& put) {
  using Row = sparse::kernel::Tile<double, W == 1 ? kPart : W>;  // of one panel
  const Number* x = answer();
  const int ld = panels.front().ld;
  double* to[W] = {};
  for (std::size_t l = 0; l < panels.size(); ++l)
    if (plain[static_cast<int>(l)]) to[l] = panels[l].X;
  for (int i = 0; i < pattern_->size(); ++i) {
    const int k = pattern_->iperm[i];
    const double sign = i < model_->nv ? 1 : -1;
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(i) * ld;
    if constexpr (W == 1) {
      for (int j = band.first; j < band.end; ++j)
        put(Row::load(x + pieces_[j].at + k * pieces_[j].stride).times(sign), *to + row + j * kPart);
    } else {
      const S* x_k = x + k * kColumns;
      for (int j = band.first; j < band.end; j += W) {
        S block[W];
#pragma GCC unroll 8
        for (int c = 0; c < W; ++c) block[c] = S(sign) * x_k[pieces_[j + c].at];
        transpose(block);
#pragma GCC unroll 8
        for (int l = 0; l < W; ++l)
          if (to[l]) put(Row::load(reinterpret_cast<const double*>(block + l)), to[l] + row + j);
      }
    }
  }
}

template <class S>
template <int N>
void SideBySide<S>::solve_chunk(std::size_t chunk) {
  if (chunks_[chunk].columns() == N)
    solve_columns<N>(chunk);
  else if constexpr (W == 1 && N > kPart)
    solve_chunk<N - kPart>(chunk);
}

template <class S>
template <int N>
void SideBySide<S>::solve_columns(std::size_t chunk) {
  using Row = sparse::kernel::Tile<Number, N>;
  constexpr int kInRegisters = W == 1 ? N : kOfPanel.in_registers;
  const std::size_t size = D_.size();
  const char *reach = reach_.data() + chunk * size, *reached = reached_.data() + chunk * size;
  const Number* b = numbers(B_.data()) + chunks_[chunk].at;
  Number* x = answer() + chunks_[chunk].answer;
  if (std::find(reached, reached + size, 1) == reached + size) {  // none but columns that fill up the last chunk
    std::fill_n(x, size * N, Number(0));
    return;
  }
  const sparse::LdlSchedule& schedule = pattern_->schedule();
  for (int block = 0; block < schedule.blocks(); ++block) {
    const int end = schedule.block[block + 1];
    if (!reached[end - 1]) continue;
    for (int k = schedule.block[block]; k < end; ++k) {
      if (reach[k])
        Row::load(b).store(x + k * N), b += N;
      else
        Row::all(Number(0)).store(x + k * N);
    }
  }
  sparse::kernel::solve_columns<N, kInRegisters>(schedule, numbers(L_.data()), numbers(packed_.data()),
                                                 numbers(correction_.data()), reached, x, [](int, const auto&) {});
}

/// X + K^-1 (B - K X) of one lane, X = K^-1 B.
template <class S>
void SideBySide<S>::solve_refined(int lane, const Panel& panel) {
  const auto take = [lane](const S* from, std::size_t count, double* to) {
    for (std::size_t k = 0; k < count; ++k) to[k] = from[k][lane];
  };
  take(D_.data(), D_.size(), Dx_.data());
  take(K_.data(), K_.size(), Kx_.data());
  take(L_.data(), L_.size(), Lx_.data());
  for (std::size_t k = 0; k < place_.size(); ++k) panel.X[k] = place_[k] < 0 ? 0 : B_[place_[k]][lane];
  std::fill(nonzero_.begin(), nonzero_.end(), 1);
  sparse::panel_kernels().solve_refined(pattern_->schedule(), pattern_->K, Kx_.data(), Lx_.data(), Dx_.data(),
                                        pattern_->perm.data(), panel.X, panel.ld, 0, panel.ld, nonzero_.data(),
                                        work_.data());
  for (std::size_t k = static_cast<std::size_t>(model_->nv) * panel.ld; k < place_.size(); ++k)
    panel.X[k] = -panel.X[k];
}

}  // namespace manycontact::lanes
