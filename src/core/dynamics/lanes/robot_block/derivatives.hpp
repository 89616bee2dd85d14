#pragma once
// RobotBlock: derivatives K^-1 B of single-robot islands, B = -dr/d(q, v, u). r is the residual of the equations of
// motion and of contact rows. For coupled robots K_r^-1 [E, B_r], with B_r for the robot alone, and unit forces E on
// the bodies of coupling contacts (systems/robots/derivatives.hpp).

#include <functional>
#include <numeric>

#include "../../derivatives/columns.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "robot_block.hpp"

namespace manycontact::lanes {

template <class S>
void RobotBlock<S>::differentiate(const DerivativeJob& job, Robots robots, double* memory,
                                  std::span<const Panel> panels) {
  linearise(job, robots, memory);
  derivative_terms(job.scene, robots);
  find_reach(job);
  right_sides(job, robots);
  for (std::size_t l = 0; l < panels.size(); ++l)
    for (const Sampled& sample : panels[l].sampled)
      for (int i = 0; i < rows_; ++i) {
        const int place = place_[i * job.columns + sample.column];
        sample.b[i] = place < 0 ? 0 : B_[place][static_cast<int>(l)];
      }
  const S* L = inner_L();
  S refined(0), projected(1);  // flags: to refine; with redundant rows (so flagged: surplus elements)
  for (std::size_t l = 0; l < panels.size(); ++l) {
    const int lane = static_cast<int>(l);
    projected.set(lane, rows_wait() && waiting_.elements()[lane]);
    refined.set(lane, panels[l].refine && projected[lane] == 0);
  }
  if ((refined > S(0)).any()) refined = select(accurate_unrefined(L), S(0), refined);
  if (const Mask plain = refined + projected <= S(0); plain.any()) solve_panels(L, panels, plain, nullptr, job);
  for (std::size_t l = 0; l < panels.size(); ++l)
    if (refined[static_cast<int>(l)] > 0) solve_refined(L, static_cast<int>(l), panels[l], job.columns);
  if (!rows_wait()) return;
  least_norm_columns(job, robots);
  solve_panels(L, panels, projected > S(0), &waiting_, job);
}

template <class S>
void RobotBlock<S>::move_ends(const DerivativeJob& job, Robots robots) {  // sets Robot::ends, one per coupling contact
  linearise(job, robots, nullptr);
  rnea_derivatives<S>(*model_, robot_.kin, robot_.Yc, {}, rnea_);  // sets Psid, Psidd and Sv
  collect_ends({&robot_.kin.J, &rnea_.Psid, &rnea_.Psidd, &rnea_.Sv});
  double* memory[kMostInBatch];
  store_arrays(joins_.data(), static_cast<int>(plan_->ends_size()),
               side_by_side(robots, memory, [](const Robot& r) { return r.ends; }));
}

/// Computes the contact forces on bodies, and the derivatives of the inverse dynamics and of the contact rows.
template <class S>
void RobotBlock<S>::derivative_terms(const Scene& scene, Robots robots) {
  add_forces(scene, robots, fext_);
  const double* from[kMostInBatch];
  std::size_t next = 0;
  for (std::size_t k = contacts_.size(); k < plan_->supports.size(); ++k) {
    Vec6<S> F;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) -> const double* { return r.ends + next; }), 6,
                F.data());
    fext_[contact(k).A.joint] += F;
    next += MovingEnd::size(plan_->supports[k].a.size());
  }
  rnea_derivatives<S>(*model_, robot_.kin, robot_.Yc, fext_, rnea_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const bool between = moves(c.B);
    contact_derivatives<S>(c, plan_->supports[k], robot_.kin, between ? &robot_.kin : nullptr, rnea_,
                           between ? &rnea_ : nullptr, contact_f_[k], contacts_[k], contact_terms_[k]);
  }
}

/// Finds nonzero rows of -dr/dq per coordinate: ancestors, descendants, and contacts on bodies that it moves.
template <class S>
void RobotBlock<S>::find_places() {
  const int nv = model_->nv;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> places;
  places.setZero(rows_, nv);
  for (int i = 0; i < nv; ++i)
    for (int j = i; j >= 0; j = model_->dof_parent[j]) places(i, j) = places(j, i) = true;
  const auto of_tree = places;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const ContactDerivativesOf<S>& terms = contact_terms_[k];
    for (const std::vector<int>* chain : {&terms.chain_a, &terms.chain_b})
      for (int i : *chain) {
        places.col(i).segment(nv + plan_->island.row_offset[k], contacts_[k].a0.size()).setOnes();
        // the force on B is fixed in A, so that it changes with A's motion
        for (const std::vector<int>* other : {&terms.chain_a, &terms.chain_b})
          for (int j : *other) places(j, i) = true;
      }
  }
  for (int i = 0; i < places.rows(); ++i)
    for (int j = 0; j < nv; ++j)
      if (places(i, j)) places_.push_back({i, j, of_tree(i, j)});
}

/// Finds the rows that each column of the right-hand sides may fill, and forms the chunks of columns to solve together.
template <class S>
void RobotBlock<S>::find_reach(const DerivativeJob& job) {
  const int size = rows_, ld = job.columns;
  if (request_ == job.request && !chunks_.empty() && place_.size() == static_cast<std::size_t>(size) * ld) return;
  chunks_.clear();  // so that chunks are formed again if an allocation throws
  std::vector<std::vector<char>> reach(ld / kPart, std::vector<char>(size, 0));
  const auto set = [&](int row, int column) { reach[column / kPart][inner_.iperm[row]] = 1; };
  for (std::size_t k = 0; k < plan_->joins(); ++k)
    for (int i : plan_->supports[contacts_.size() + k].a)
      for (int c = 0; c < 6; ++c) set(i, static_cast<int>(6 * k) + c);
  for (const auto& [i, j, of_tree] : places_) {
    if (job.request.q) set(i, job.q_first + j);
    if (job.request.v) set(i, job.v_first + j);
  }
  for (int i = 0; job.request.u && i < torques(job); ++i) set(torque(job, i), job.u_first + i);
  correction_.resize(static_cast<std::size_t>(size) * kColumns);
  rate_.resize(static_cast<std::size_t>(size) * model_->nv);
  waiting_.reserve(kColumns);
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

/// Forms bands of columns whose solutions fit in the L2 cache and, in each band, chunks of parts (kPart columns) with
/// similar nonzero rows. Allocates B and X. reach: flags each part's nonzero rows, in the pattern's order.
template <class S>
auto RobotBlock<S>::form_chunks(std::span<const std::vector<char>> reach, int ld) -> std::vector<Chunk> {
  constexpr std::size_t kBand = 1 << 19;  // bytes of a band's solutions
  constexpr int kWhole = std::lcm(8, kColumns);
  const std::size_t size = static_cast<std::size_t>(rows_);
  const int parts = ld / kPart,
            wide = std::max(static_cast<int>(kBand / (size * sizeof(Number))), kWhole) / kWhole * kWhole / kPart;
  std::vector<std::vector<char>> reached(reach.begin(), reach.end());
  for (std::vector<char>& rows : reached) sparse::ldl_scheduled_reach(inner_schedule_, rows.data());
  std::vector<int> order(parts);  // parts without nonzero rows come last
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return a / wide != b / wide ? a / wide < b / wide : reached[a] > reached[b]; });

  std::vector<Chunk> chunks;
  bands_.clear(), reach_.clear(), reached_.clear();
  place_.assign(size * ld, -1);
  pieces_.resize(parts);
  std::size_t count = 0, at = 0, most = 0;  // sizes: of right-hand sides, of this band, of the largest band
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
          place_[inner_.perm[k] * ld + chunk.first[c / kPart] + c % kPart] = static_cast<int>(count);
    for (int k = 0; k < chunk.parts; ++k) pieces_[chunk.first[k] / kPart] = {at + k * kPart, columns};
    most = std::max(most, at += columns * size);
    chunks.push_back(chunk);
    bands_.back().end = std::min((band + 1) * wide, parts);
    bands_.back().chunk_end = chunks.size();
    reach_.insert(reach_.end(), rows.begin(), rows.end());
    sparse::ldl_scheduled_reach(inner_schedule_, rows.data());
    reached_.insert(reached_.end(), rows.begin(), rows.end());
  }
  B_.assign(count, S(0));
  work_.resize(std::max(work_.size(), W * most + 8));  // 8 more for the alignment to a cache line
  return chunks;
}

/// Computes the right-hand sides B = [E, -dr/dq, -dr/dv, S]. S, which selects actuated coordinates, is constant.
template <class S>
void RobotBlock<S>::right_sides(const DerivativeJob& job, Robots robots) {
  const Indexed B{B_.data(), place_.data(), job.columns};
  for (int k : unset_) B_[k] = S(0);
  const double* from[kMostInBatch];
  std::size_t next = 6;  // offset of J_l in an EndForce: 6 numbers of the force come first
  for (std::size_t k = 0; k < plan_->joins(); ++k) {
    const std::vector<int>& columns = plan_->supports[contacts_.size() + k].a;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) -> const double* { return r.ends + next; }),
                static_cast<int>(6 * columns.size()), joins_.data());
    const S* x = joins_.data();
    for (int i : columns)
      for (int c = 0; c < 6; ++c) B(i, static_cast<int>(6 * k) + c) = *x++;
    next += MovingEnd::size(columns.size());
  }
  const auto rows = [&](std::size_t k, int first) { return B.block(model_->nv + plan_->island.row_offset[k], first); };
  if (job.request.q) {
    const Indexed top = B.block(0, job.q_first);
    internal::robot_columns<S>(*model_, rnea_.dq_lower.data(), rnea_.dq_upper.data(), top);
    next = 6;
    for (std::size_t k = 0; k < plan_->joins(); ++k) {  // adds E D for the robot's own coordinates
      const std::vector<int>& columns = plan_->supports[contacts_.size() + k].a;
      const int count = static_cast<int>(columns.size());
      load_arrays(side_by_side(robots, from, [&](const Robot& r) -> const double* { return r.ends + next; }),
                  12 * count, joins_.data());
      const S *E = joins_.data(), *D = E + 6 * count;
      for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
          S sum(0);
          for (int e = 0; e < 6; ++e) sum += E[6 * i + e] * D[e * count + j];
          top(columns[i], columns[j]) += sum;
        }
      next += MovingEnd::size(columns.size());
    }
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      internal::contact_columns<S>(contacts_[k], contact_terms_[k].dx_dq, columns_[k], rows(k, job.q_first));
      internal::turning_columns<S>(contacts_[k], contact_terms_[k], 0, rows(k, job.q_first));
      internal::force_columns<S>(contacts_[k], contact_terms_[k], columns_[k], 0, 0, top);
    }
  }
  if (job.request.v) {
    const Indexed top = B.block(0, job.v_first);
    internal::robot_columns<S>(*model_, rnea_.dv_lower.data(), rnea_.dv_upper.data(), top);
    for (std::size_t i = 0; i < slope_.size(); ++i) top(static_cast<int>(i), static_cast<int>(i)) -= slope_[i];
    for (std::size_t k = 0; k < contacts_.size(); ++k)
      internal::contact_columns<S>(contacts_[k], contact_terms_[k].dx_dv, columns_[k], rows(k, job.v_first));
  }
}

/// Returns elements that need no refinement: rounding errors |dK|_1 / |K|_1 (ldl_rounding) are at most kRefinePanel.
template <class S>
typename S::Mask RobotBlock<S>::accurate_unrefined(const S* L) {
  sparse::ldl_row_sums(inner_.K, as_scalar(n_.K), inner_.ldl, as_scalar(L), as_scalar(n_.D), as_scalar(r_.data()),
                       as_scalar(scale_.data()));
  S of_factor(0), of_K(0);
  for (int k = 0; k < rows_; ++k) {
    of_factor = larger(r_[k], of_factor);
    of_K = larger(scale_[k], of_K);
  }
  return S(rounding_) * of_factor <= S(tolerance::kRefinePanel) * of_K;
}

template <class S>
const S* RobotBlock<S>::inner_L() {  // L without the border's rows, the last entries of each column
  if (plan_->border() == 0) return n_.L;
  for (int j = 0; j < rows_; ++j)
    std::copy_n(n_.L + pattern_.ldl.Lp[j], inner_.ldl.Lp[j + 1] - inner_.ldl.Lp[j], inner_L_.data() + inner_.ldl.Lp[j]);
  return inner_L_.data();
}

/// Writes [da; df], from K^-1 B = [da; -df], into the panels of the elements `of`. waiting: redundant rows, or nullptr.
template <class S>
void RobotBlock<S>::solve_panels(const S* L, std::span<const Panel> panels, Mask of, WaitingRows<S>* waiting,
                                 const DerivativeJob& job) {
  for (int k = 0; k < rows_; ++k) inverse_[k] = S(1) / n_.D[k];
  sparse::ldl_pack(inner_schedule_, L, packed_.data());
  for (const Band& band : bands_) {
    for (std::size_t c = band.chunk; c < band.chunk_end; ++c) solve_chunk(L, c, waiting);
    // Non-temporal stores do not evict the caches' content.
    if (job.non_temporal)
      write(band, panels, of, [](const auto& piece, double* to) { piece.stream(to); });
    else
      write(band, panels, of, [](const auto& piece, double* to) { piece.store(to); });
  }
  if (job.non_temporal) sparse::kernel::finish_streams();
}

/// Copies the solutions of a band from work_ to the panels. put(piece, to): stores a piece of a row, aligned.
template <class S>
template <class Put>
void RobotBlock<S>::write(const Band& band, std::span<const Panel> panels, Mask of, Put&& put) {
  using Row = sparse::kernel::Tile<double, W == 1 ? kPart : W>;  // piece of a row of one panel
  const Number* x = answer();
  double* to[W] = {};
  std::ptrdiff_t ld[W] = {};
  for (std::size_t l = 0; l < panels.size(); ++l)
    if (of[static_cast<int>(l)]) to[l] = panels[l].X, ld[l] = panels[l].ld;
  for (int i = 0; i < rows_; ++i) {  // to[l]: row i of robot l's panel
    const int k = inner_.iperm[i];
    const double sign = i < model_->nv ? 1 : -1;
    if constexpr (W == 1) {
      for (int j = band.first; j < band.end; ++j)
        put(Row::load(x + pieces_[j].at + k * pieces_[j].stride).times(sign), *to + j * kPart);
    } else {
      const S* x_k = x + k * kColumns;
      for (int j = band.first; j < band.end; j += W) {
        S block[W];
#pragma GCC unroll 8
        for (int c = 0; c < W; ++c) block[c] = S(sign) * x_k[pieces_[j + c].at];
        transpose(block);
#pragma GCC unroll 8
        for (int l = 0; l < W; ++l)
          if (to[l]) put(Row::load(reinterpret_cast<const double*>(block + l)), to[l] + j);
      }
    }
    for (int l = 0; l < W; ++l) to[l] += ld[l];
  }
}

template <class S>
template <int N>
void RobotBlock<S>::solve_chunk(const S* L, std::size_t chunk, WaitingRows<S>* waiting) {
  if (chunks_[chunk].columns() == N)
    solve_columns<N>(L, chunk, waiting);
  else if constexpr (W == 1 && N > kPart)
    solve_chunk<N - kPart>(L, chunk, waiting);
}

template <class S>
template <int N>
void RobotBlock<S>::solve_columns(const S* L, std::size_t chunk, WaitingRows<S>* waiting) {
  using Row = sparse::kernel::Tile<Number, N>;
  constexpr int kInRegisters = W == 1 ? N : kOfPanel.in_registers;
  const std::size_t size = static_cast<std::size_t>(rows_);
  const char* reached = reached_.data() + chunk * size;
  Number* x = answer() + chunks_[chunk].answer;
  if (std::find(reached, reached + size, 1) == reached + size) {  // a chunk of padding columns only
    std::fill_n(x, size * N, Number(0));
    return;
  }
  const auto apply_inverse = [&](const char* rows, Number* X) {
    if (waiting) waiting->template project_out<N>(X), waiting->template before_solve<N>(X);
    sparse::kernel::solve_columns<N, kInRegisters>(inner_schedule_, as_scalar(L), as_scalar(packed_.data()),
                                                   as_scalar(inverse_.data()), rows, X, [](int, const auto&) {});
    if (waiting) waiting->template after_solve<N>(X), waiting->template project_out<N>(X);
  };
  if (waiting) std::fill_n(x, size * N, Number(0)), std::fill(nonzero_.begin(), nonzero_.end(), 1);
  load_chunk<N>(chunk, x);
  apply_inverse(waiting ? nonzero_.data() : reached, x);
  if (!waiting) return;
  // The projection of large entries leaves rounding errors in small entries, which X += K^+ (B - K X) corrects.
  Number* r = as_scalar(correction_.data());
  std::fill_n(r, size * N, Number(0));
  load_chunk<N>(chunk, r);
  subtract_product<N>(x, r);
  apply_inverse(nonzero_.data(), r);
  for (std::size_t k = 0; k < size; ++k) {
    Row row = Row::load(x + k * N);
    row.add(Number(1), r + k * N);
    row.store(x + k * N);
  }
  subtract_least_norm_columns<N>(chunk, x);
}

/// Loads a chunk's right-hand sides into x, except blocks of rows where L^-1 B is zero in all columns.
template <class S>
template <int N>
void RobotBlock<S>::load_chunk(std::size_t chunk, Number* x) const {
  using Row = sparse::kernel::Tile<Number, N>;
  const char *reach = reach_.data() + chunk * rows_, *reached = reached_.data() + chunk * rows_;
  const Number* b = as_scalar(B_.data()) + chunks_[chunk].at;
  const sparse::LdlSchedule& schedule = inner_schedule_;
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
}

template <class S>
template <int N>
void RobotBlock<S>::subtract_product(const Number* X, Number* R) const {  // R -= K X, N columns of each
  using Row = sparse::kernel::Tile<Number, N>;
  const sparse::UpperCsc& K = pattern_.K;
  const Number* values = as_scalar(n_.K);
  for (int k = 0; k < rows_; ++k) {
    const Row x = Row::load(X + std::ptrdiff_t{k} * N);
    Row r = Row::load(R + std::ptrdiff_t{k} * N);
    for (int p = K.p[k]; p < K.p[k + 1]; ++p) {
      const std::ptrdiff_t i = K.i[p];
      if (i == k) {
        r.subtract(values[p], x);
        continue;
      }
      r.subtract(values[p], Row::load(X + i * N));
      Row above = Row::load(R + i * N);
      above.subtract(values[p], x);
      above.store(R + i * N);
    }
    r.store(R + std::ptrdiff_t{k} * N);
  }
}

/// Computes D = d(J y)/dq into rate_, at constant y with J y = f (products.hpp).
template <class S>
void RobotBlock<S>::least_norm_columns(const DerivativeJob& job, Robots robots) {
  if (!job.request.q) return;
  motion_of_forces();
  std::fill(rate_.begin(), rate_.end(), S(0));
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    jacobian_rate(job.scene, robots, k).of_motion(y_, [&](int j, const Vec6<S>& dnu) {
      for (Eigen::Index i = 0; i < contacts_[k].W.rows(); ++i)
        rate_[rows_of(k)[i] * model_->nv + j] += contacts_[k].W.row(i).dot(dnu);
    });
}

/// Sets df += P D for a chunk's columns of X = [da; -df], where P projects on the null space of J^T, and D is rate_.
template <class S>
template <int N>
void RobotBlock<S>::subtract_least_norm_columns(std::size_t chunk, Number* X) {
  const int nv = model_->nv;
  const Chunk& of = chunks_[chunk];
  if (!request_.q) return;
  Number *D = as_scalar(correction_.data()), *rate = as_scalar(rate_.data());
  std::fill_n(D, std::ptrdiff_t{rows_} * N, Number(0));
  bool any = false;
  for (int c = 0; c < of.parts * kPart; ++c) {
    const int j = of.first[c / kPart] + c % kPart - static_cast<int>(6 * plan_->joins());
    if (j < 0 || j >= nv) continue;
    any = true;
    for (int k = 0; k < rows_; ++k) D[std::ptrdiff_t{k} * N + c] = rate[std::ptrdiff_t{k} * nv + j];
  }
  if (any) waiting_.template subtract_null_component<N>(D, X);
}

/// Computes X = K^-1 B of one robot, refined once: X + K^-1 (B - K X).
template <class S>
void RobotBlock<S>::solve_refined(const S* L, int lane, const Panel& panel, int columns) {
  const auto take = [lane](const S* from, std::vector<double>& to) {
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[k][lane];
  };
  take(n_.D, Dx_);
  take(n_.K, Kx_);
  take(L, Lx_);
  const auto at = [&](int i) { return panel.X + static_cast<std::ptrdiff_t>(i) * panel.ld; };
  const int* place = place_.data();
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < columns; ++j, ++place) at(i)[j] = *place < 0 ? 0 : B_[*place][lane];
  std::fill(nonzero_.begin(), nonzero_.end(), 1);
  sparse::panel_kernels().solve_refined(inner_schedule_, inner_.K, Kx_.data(), Lx_.data(), Dx_.data(),
                                        inner_.perm.data(), panel.X, panel.ld, 0, columns, nonzero_.data(),
                                        work_.data());
  for (int i = model_->nv; i < rows_; ++i)
    for (int j = 0; j < columns; ++j) at(i)[j] = -at(i)[j];
}

}  // namespace manycontact::lanes
