// Derivatives robot by robot: the numbers.

#include "joined_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "../../steps.hpp"
#include "each_batch.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

namespace {

using OfRobot = JoinedDerivatives::OfRobot;
using Columns = std::vector<JoinedDerivatives::Columns>;
using Member = JoinedRobots::Robot;
using Kernel = lanes::RobotBlocks;
using Memory = lanes::RobotBlocks::Memory;

bool has_own(const Columns& columns, int first, int cols) {
  return std::any_of(columns.begin(), columns.end(), [&](const JoinedDerivatives::Columns& c) {
    return c.in_X < first + cols && first < c.in_X + c.count;
  });
}

// Flags the joining rows, in the order of S, that right-hand sides in these columns reach. columns_of(r): in the panel.
template <class ColumnsOf>
void find_reach(const Joining& joining, const JoinedDerivatives& by, ColumnsOf&& columns_of, int first, int cols,
                std::vector<char>& nonzero) {
  std::fill(nonzero.begin(), nonzero.end(), 0);
  for (std::size_t k = 0; k < by.robots.size(); ++k)
    if (has_own(columns_of(by.robots[k]), first, cols))
      for (int row : joining.robots[k].joining) nonzero[joining.place[row]] = 1;
  sparse::ldl_scheduled_reach(joining.schedule, nonzero.data());
}

const Columns& columns_in_X(const OfRobot& r) { return r.columns; }
const Columns& columns_in_sample(const OfRobot& r) { return r.sampled; }

// Zeros in the joining rows, wherever right-hand sides reach.
void clear_rhs(const Joining& joining, const JoinedDerivatives& by, std::vector<char>& nonzero, AlignedPanel& X) {
  const int ld = static_cast<int>(X.cols());
  for (int first = 0; first < ld; first += JoinedDerivatives::kChunk) {
    const int cols = std::min(JoinedDerivatives::kChunk, ld - first);
    find_reach(joining, by, columns_in_X, first, cols, nonzero);
    for (std::size_t k = 0; k < nonzero.size(); ++k)
      if (nonzero[k]) std::fill_n(&X(by.eliminated[k], first), cols, 0.0);
  }
}

lanes::JoinTerms terms_of(const IslandWork& d, const JoinedRobots::Joint& joint) {
  JoinedDerivatives& by = *d.by_robots;
  return {by.terms.data() + by.at[joint.number], joint.rows,
          static_cast<int>(d.shape->support().columns[joint.number].size())};
}

// The terms of contacts that join robots, from where these move; and their rows of B.
void differentiate_joining(const Scene& scene, const SceneData& data, IslandWork& d, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  JoinedRobots& joined = *d.joined;
  JoinedDerivatives& by = *d.by_robots;
  const auto end = [&](int robot, int among) {
    return by.robots[robot].ends.data() +
           joined.robots[robot].group->plan->size_of_ends<lanes::MovingEnd>(static_cast<std::size_t>(among));
  };
  each_item(w, joined.contact_batches.size(), [&](std::size_t k, ThreadWork& thread) {
    const JoinedRobots::ContactBatch& batch = joined.contact_batches[k];
    const auto joints = std::span(joined.contacts).subspan(batch.first, batch.count);
    thread.joining_derivatives.clear();
    for (const JoinedRobots::Joint& joint : joints)
      thread.joining_derivatives.push_back({&scene.contacts[joint.contact], end(joint.A, joint.among_A),
                                            end(joint.B, joint.among_B), data.f.data() + data.f_offset[joint.contact],
                                            terms_of(d, joint).J});
    batch.group->kernels[thread.number]->differentiate(scene.gravity, thread.joining_derivatives);
    for (const JoinedRobots::Joint& joint : joints) {
      const lanes::JoinTerms terms = terms_of(d, joint);
      const std::vector<int>& columns = d.shape->support().columns[joint.number];
      for (int i = 0; i < joint.rows; ++i) {
        double* row = &out.X(joined.joining->row[joint.row + i], 0);
        for (int c = 0; c < terms.cols; ++c) {
          if (out.request.q) row[out.q_first + columns[c]] = terms.dq()[c * terms.rows + i];
          if (out.request.v) row[out.v_first + columns[c]] = terms.dv()[c * terms.rows + i];
        }
      }
    }
  });
}

// A robot's end of a contact that joins it.
struct End {
  const JoinedRobots::Joint& joint;
  lanes::JoinTerms terms;
  int among;       // of the robot's joins
  int row;         // the first in G_r
  bool B;          // of the contact
  int first, end;  // of the contact's columns: those on this robot
};
// use(end) for each of robot k, in the order of its joins.
template <class Use>
void each_end(const IslandWork& d, std::size_t k, Use&& use) {
  int row = 0, among = 0;
  for (int i : d.joined->robots[k].joints) {
    const JoinedRobots::Joint& joint = d.joined->contacts[i];
    const lanes::JoinTerms terms = terms_of(d, joint);
    const bool B = joint.A != static_cast<int>(k);
    const int of_A = static_cast<int>(d.shape->support().contacts[joint.number].a.size());
    use(End{joint, terms, among++, row, B, B ? of_A : 0, B ? terms.cols : of_A});
    row += joint.rows;
  }
}

// Where a column of X stands in a robot's panel.
int place_in_panel(const OfRobot& r, int column) {
  for (const JoinedDerivatives::Columns& c : r.columns)
    if (c.in_X <= column && column < c.in_X + c.count) return c.in_P + column - c.in_X;
  return -1;
}

// A robot's panel, in which the lanes left K_r^-1 [E_r, own columns]: adds K_r^-1 E_r D_r; then T, G, H = G_r P.
void finish_robot(const IslandWork& d, std::size_t k, const IslandDerivatives& out,
                  JoinedDerivatives::Buffers& buffers) {
  const sparse::PanelKernels& kernels = sparse::panel_kernels();
  OfRobot& r = d.by_robots->robots[k];
  const int size = r.size(), ldT = sparse::padded(size), ldG = r.padded(), o = d.island.dof_offset[k];
  for (int i = 0; i < size; ++i) std::fill(&r.P(i, 0) + r.own, &r.P(i, 0) + r.ld, 0.0);
  std::fill(r.G.begin(), r.G.end(), 0.0);
  each_end(d, k, [&](const End& e) {
    const std::vector<int>& columns = d.shape->support().columns[e.joint.number];
    for (int i = 0; i < size; ++i)
      for (int c = 0; c < 6; ++c) buffers.E[c * ldT + i] = r.P(i, 6 * e.among + c);
    kernels.product(e.terms.W(), e.terms.rows, buffers.E.data(), 6, e.terms.rows, size, ldT, r.T.data() + e.row * ldT);
    for (int c = e.first; c < e.end; ++c)
      std::copy_n(e.terms.J + c * e.terms.rows, e.terms.rows, r.G.data() + (columns[c] - o) * ldG + e.row);
    if (!out.request.q || !e.B) return;  // a force on A is moved by A alone
    const int ldD = lanes::JoinTerms::padded(e.terms.cols);
    kernels.product(buffers.E.data(), ldT, e.terms.D(true), 6, size, e.first, ldD, buffers.ED.data());
    for (int c = 0; c < e.first; ++c) {  // A's coordinates
      const int column = place_in_panel(r, out.q_first + columns[c]);
      for (int i = 0; i < size; ++i) r.P(i, column) += buffers.ED[i * ldD + c];
    }
  });
  kernels.product(r.G.data(), ldG, r.P.data(), r.nv, ldG, r.ld, r.ld, r.H.data());
}

// E_r D_r in the sampled columns of B_r, of which the lanes left the robot's own.
void finish_sample(const IslandWork& d, std::size_t k, const IslandDerivatives& out) {
  OfRobot& r = d.by_robots->robots[k];
  if (!out.request.q) return;
  std::size_t next = 6;  // J_l of an end, behind the force
  each_end(d, k, [&](const End& e) {
    const std::vector<int>& columns = d.shape->support().columns[e.joint.number];
    const Eigen::Map<const Mat6X<double>> E(r.ends.data() + next, 6, e.end - e.first);
    next += lanes::MovingEnd::size(static_cast<std::size_t>(E.cols()));
    const int ldD = lanes::JoinTerms::padded(e.terms.cols);
    for (std::size_t s = 0; s < r.sampled.size(); ++s)
      for (int c = 0; c < e.first && e.B; ++c) {
        if (out.q_first + columns[c] != d.by_robots->sample.column[r.sampled[s].in_X]) continue;
        for (int j = 0; j < E.cols(); ++j)
          for (int i = 0; i < 6; ++i)
            r.B[s * r.size() + columns[e.first + j] - d.island.dof_offset[k]] += E(i, j) * e.terms.D(e.B)[i * ldD + c];
      }
  });
}

// -S Y into the joining rows, which hold B: B_joining - sum_r G_r K_r^-1 B_r.
void joining_rhs(const JoinedDerivatives& by, AlignedPanel& X) {
  for (const OfRobot& r : by.robots)
    for (std::size_t i = 0; i < r.join.size(); ++i) {
      const double* h = r.H.data() + i * r.ld;
      double* x = &X(r.join[i], 0);
      for (const JoinedDerivatives::Columns& c : r.columns)
        for (int j = 0; j < c.count; ++j) x[c.in_X + j] -= h[c.in_P + j];
    }
}

// Adds K_r^-1 B_r to columns first ... first+cols-1 of a robot's rows of [da; df].
void add_own(const OfRobot& r, const Columns& columns, int first, int cols, double* X, std::ptrdiff_t ld) {
  for (const JoinedDerivatives::Columns& c : columns) {
    const int begin = std::max(c.in_X, first), end = std::min(c.in_X + c.count, first + cols);
    for (int i = 0; begin < end && i < r.size(); ++i) {
      const double* p = &r.P(i, 0) + c.in_P - c.in_X;
      double* x = X + r.row[i] * ld;
      for (int j = begin; j < end; ++j) x[j] += p[j];
    }
  }
}

// Columns first ... first+cols-1 of [da; df] from what joining_rhs left in the joining rows: -Y there, and
// K_r^-1 B_r - T_r Y in each robot's, K_r^-1 B_r where columns_of(r) says.
template <class ColumnsOf>
void answer(const JoinedRobots& joined, const JoinedDerivatives& by, ColumnsOf&& columns_of, int first, int cols,
            double* X, int ld, bool past_caches, JoinedDerivatives::Buffers& buffers) {
  const sparse::PanelKernels& kernels = sparse::panel_kernels();
  find_reach(*joined.joining, by, columns_of, first, cols, buffers.nonzero);
  kernels.solve(joined.joining->schedule, joined.L.data(), by.D.data(), by.eliminated.data(), X, ld, first, cols,
                buffers.nonzero.data(), buffers.work.data());
  for (const OfRobot& r : by.robots) {
    const Columns& columns = columns_of(r);
    const bool own = has_own(columns, first, cols);
    kernels.product_of_rows(r.T.data(), sparse::padded(r.size()), X + first, r.join.data(),
                            static_cast<int>(r.join.size()), X + first, r.row.data(), r.size(), cols, ld,
                            past_caches && !own);
    if (own) add_own(r, columns, first, cols, X, ld);
  }
}

// Column s of the sample for lanes::RobotBlocks::check.
void begin_check(const JoinedDerivatives& by, OfRobot& r, int s, Member& member) {
  const AlignedPanel& X = by.sample.X;
  member.x = r.x.data(), member.b = r.x.data() + r.size();
  for (int i = 0; i < r.size(); ++i) r.x[i] = (i < r.nv ? 1 : -1) * X(r.row[i], s);
  for (std::size_t i = 0; i < r.join.size(); ++i) member.border.y()[i] = -X(r.join[i], s);
  for (std::size_t j = 0; j < r.sampled.size(); ++j)
    if (r.sampled[j].in_X == s) member.b = r.B.data() + j * r.size();
}

// Whether every column of the sample has a componentwise backward error, with the island's K, of no more than half of
// what derivatives are allowed.
bool sample_is_good(const Scene& scene, Workspace& w, IslandWork& d, const AlignedPanel& X) {
  JoinedRobots& joined = *d.joined;
  JoinedDerivatives& by = *d.by_robots;
  JoinedDerivatives::Sample& sample = by.sample;
  const std::vector<int>& joining_row = joined.joining->row;
  for (int row : joining_row) std::fill_n(&sample.X(row, 0), sample.X.cols(), 0.0);
  for (const OfRobot& r : by.robots)
    for (const JoinedDerivatives::Columns& c : r.sampled)
      for (int row : r.join) sample.X(row, c.in_X) = X(row, sample.column[c.in_X]);
  const int ld = static_cast<int>(sample.X.cols());
  answer(joined, by, columns_in_sample, 0, ld, sample.X.data(), ld, false, by.buffers.front());
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    for (int s = 0; s < static_cast<int>(sample.column.size()); ++s) {
      for (Member& member : robots)
        begin_check(by, by.robots[joined.order[&member - joined.members.data()]], s, member);
      kernel.check(robots, memory);
      for (Member& member : robots) {
        OfRobot& r = by.robots[joined.order[&member - joined.members.data()]];
        std::copy_n(member.border.r(), 2 * r.join.size(), r.left.data() + 2 * s * r.join.size());  // and scale
        r.error = s == 0 ? member.error : sparse::larger_or_nan(r.error, member.error);
      }
    }
  });
  double error = 0;
  for (const OfRobot& r : by.robots) error = sparse::larger_or_nan(error, r.error);
  for (std::size_t s = 0; s < sample.column.size(); ++s) {
    for (std::size_t k = 0; k < by.robots.size(); ++k)
      std::copy_n(by.robots[k].left.data() + 2 * s * by.robots[k].join.size(), 2 * by.robots[k].join.size(),
                  joined.member(k).border.r());
    for (std::size_t k = 0; k < joining_row.size(); ++k) {
      joined.y[k] = -sample.X(joining_row[k], s);
      joined.b[k] = sample.b[s * joining_row.size() + k];
    }
    error = sparse::larger_or_nan(error, joining_error(scene.damping, joined));
  }
  return error <= tolerance::kPanelRefined;
}

// -S once more and its factor, from the T_r that answers take: where the island was solved otherwise, and no product
// goes by the one that is there. False where its pivots are not sound.
bool factor_joining_again(double damping, JoinedRobots& joined, const JoinedDerivatives& by) {
  const Joining& joining = *joined.joining;
  std::fill(joined.Sx.begin(), joined.Sx.end(), 0.0);
  for (int k = 0; k < joining.rows(); ++k) joined.Sx[joining.S.p[k + 1] - 1] = -damping;
  for (std::size_t k = 0; k < by.robots.size(); ++k) {
    const OfRobot& r = by.robots[k];
    const int ldG = r.padded(), ldT = sparse::padded(r.size());
    const int* slot = joining.robots[k].slot.data();
    for (std::size_t j = 0; j < r.join.size(); ++j)
      for (std::size_t i = 0; i <= j; ++i, ++slot)
        for (int v = 0; v < r.nv; ++v) joined.Sx[*slot] -= r.G[v * ldG + i] * r.T[j * ldT + v];
  }
  sparse::panel_kernels().factor(joining.schedule, joined.Sx.data(), joined.L.data(), joined.D.data(),
                                 joined.terms.data());
  return std::all_of(joined.D.begin(), joined.D.end(), [](double d) { return d < 0 && std::isfinite(d); }) &&
         sparse::smallest_pivot_ratio(joining.rows(), joined.D.data(), joined.terms.data()) >= tolerance::kPivotLeft;
}

// What answers need of each robot and of the joining rows, from right-hand sides in X; whether that is sound.
bool solve_robots(const Scene& scene, SceneData& data, IslandWork& d, bool refined, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  JoinedRobots& joined = *d.joined;
  JoinedDerivatives& by = *d.by_robots;
  clear_rhs(*joined.joining, by, by.buffers.front().nonzero, out.X);
  const auto job_of = [&](const OfRobot& r) {
    return lanes::DerivativeJob{scene,         data.serial,   w.q.data(),  data.v.data(), data.a.data(),
                                data.f.data(), data.f_offset, out.request, r.q_first,     r.v_first,
                                r.u_first,     r.own,         false};
  };
  for (std::size_t k = 0; k < by.robots.size(); ++k) joined.member(k).ends = by.robots[k].ends.data();
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory, ThreadWork&) {
    kernel.move_ends(job_of(by.robots.front()), robots);
  });
  differentiate_joining(scene, data, d, out);
  std::fill(by.sample.b.begin(), by.sample.b.end(), 0.0);
  for (std::size_t k = 0; k < by.robots.size(); ++k)
    for (const JoinedDerivatives::Columns& c : by.robots[k].sampled)
      for (int row : joined.joining->robots[k].joining)
        by.sample.b[c.in_X * joined.b.size() + row] = out.X(joined.joining->row[row], by.sample.column[c.in_X]);
  each_batch(w, joined, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork& thread) {
    const auto number = [&](std::size_t l) { return joined.order[&robots[l] - joined.members.data()]; };
    thread.panels.clear();
    for (std::size_t l = 0; l < robots.size(); ++l) {
      OfRobot& r = by.robots[number(l)];
      std::fill(r.B.begin(), r.B.end(), 0.0);
      thread.panels.push_back({r.P.data(), r.ld, refined, r.copied});
    }
    kernel.differentiate(job_of(by.robots[number(0)]), robots, memory.at, thread.panels);
    for (std::size_t l = 0; l < robots.size(); ++l) {
      finish_robot(d, number(l), out, by.buffers[thread.number]);
      finish_sample(d, number(l), out);
    }
  });
  if (!joined.solves && !factor_joining_again(scene.damping, joined, by)) return false;
  std::transform(joined.D.begin(), joined.D.end(), by.D.begin(), std::negate<>());  // of S, not -S
  joining_rhs(by, out.X);
  return sample_is_good(scene, w, d, out.X);
}

// The factors of an island that was solved otherwise.
bool factorize_for_derivatives(const Scene& scene, SceneData& data, IslandWork& d) {
  const Workspace& w = *data.workspace;
  ++d.factorizations;
  const lanes::Job job{scene,         data.serial, w.q.data(), data.v.data(), data.tau.data(),
                       data.f_offset, nullptr,     nullptr,    nullptr};
  if (!factorize_joined(job, data, d)) return false;
  d.joined->serial = data.serial;
  return true;
}

}  // namespace

bool differentiate_by_robots(const Scene& scene, SceneData& data, IslandWork& d, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  if (!goes_by_robots(data, d)) return false;
  if (d.joined->serial != data.serial && !factorize_for_derivatives(scene, data, d)) return false;
  JoinedDerivatives& by = *d.by_robots;
  if (!(growth_of(*d.joined) * std::numeric_limits<double>::epsilon() <= tolerance::kConverged)) return false;
  const bool refined = d.first_error > tolerance::kRefinePanel;
  if (!solve_robots(scene, data, d, refined, out) && (refined || !solve_robots(scene, data, d, true, out)))
    return false;

  AlignedPanel& X = out.X;
  const int ld = static_cast<int>(X.cols());
  const bool past_caches = sizeof(double) * X.size() > kCached;
  each_item(w, (ld + JoinedDerivatives::kChunk - 1) / JoinedDerivatives::kChunk,
            [&](std::size_t chunk, ThreadWork& thread) {
              const int first = static_cast<int>(chunk) * JoinedDerivatives::kChunk,
                        cols = std::min(JoinedDerivatives::kChunk, ld - first);
              answer(*d.joined, by, columns_in_X, first, cols, X.data(), ld, past_caches, by.buffers[thread.number]);
            });
  return true;
}

}  // namespace manycontact::internal
