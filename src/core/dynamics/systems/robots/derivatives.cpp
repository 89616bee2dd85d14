#include "derivatives.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "../../internal.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace internal {

namespace {

using OfRobot = RobotsDerivatives::OfRobot;
using Columns = std::vector<RobotsDerivatives::Columns>;
using Member = RobotsSystem::Robot;
using Kernel = lanes::RobotBlocks;
using Memory = lanes::RobotBlocks::Memory;

bool has_own(const Columns& columns, int first, int cols) {
  return std::any_of(columns.begin(), columns.end(), [&](const RobotsDerivatives::Columns& c) {
    return c.in_X < first + cols && first < c.in_X + c.count;
  });
}

// Flags rows of S that substitution fills in columns first ... first+cols-1. columns_of(r): where B_r is nonzero.
template <class ColumnsOf>
void find_reach(const Interface& interface, const RobotsDerivatives& by, ColumnsOf&& columns_of, int first, int cols,
                std::vector<char>& nonzero) {
  std::fill(nonzero.begin(), nonzero.end(), 0);
  for (std::size_t k = 0; k < by.robots.size(); ++k)
    if (has_own(columns_of(by.robots[k]), first, cols))
      for (int row : interface.robots[k].interface_rows) nonzero[interface.place[row]] = 1;
  sparse::ldl_scheduled_reach(interface.schedule, nonzero.data());
}

const Columns& columns_in_X(const OfRobot& r) { return r.columns; }
const Columns& columns_in_sample(const OfRobot& r) { return r.sampled; }

// Zeros the interface rows of X whose right-hand sides may be nonzero.
void clear_rhs(const Interface& interface, const RobotsDerivatives& by, std::vector<char>& nonzero, AlignedPanel& X) {
  const int ld = static_cast<int>(X.cols());
  for (int first = 0; first < ld; first += RobotsDerivatives::kChunk) {
    const int cols = std::min(RobotsDerivatives::kChunk, ld - first);
    find_reach(interface, by, columns_in_X, first, cols, nonzero);
    for (std::size_t k = 0; k < nonzero.size(); ++k)
      if (nonzero[k]) std::fill_n(&X(by.eliminated[k], first), cols, 0.0);
  }
}

lanes::JoinTerms terms_of(const RobotsSystem& system, const RobotsSystem::Coupling& coupling) {
  RobotsDerivatives& by = *system.derivatives;
  return {by.terms.data() + by.at[coupling.number], coupling.rows,
          static_cast<int>(system.owner.shape->support().columns[coupling.number].size())};
}

// Computes each coupling contact's JoinTerms from its bodies' MovingEnds, and the contact's rows of B.
void differentiate_interface(const Scene& scene, const SceneData& data, RobotsSystem& system, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  RobotsDerivatives& by = *system.derivatives;
  const auto end = [&](int robot, int among) {
    return by.robots[robot].ends.data() +
           system.robots[robot].group->plan->size_of_ends<lanes::MovingEnd>(static_cast<std::size_t>(among));
  };
  each_item(
      w, system.contact_batches.size(), are_worth_threads(w, costs::kDerivatives * system.seconds),
      [&](std::size_t k, ThreadWork& thread) {
        const RobotsSystem::ContactBatch& batch = system.contact_batches[k];
        const auto couplings = std::span(system.contacts).subspan(batch.first, batch.count);
        thread.interface_derivatives.clear();
        for (const RobotsSystem::Coupling& coupling : couplings)
          thread.interface_derivatives.push_back(
              {&scene.contacts[coupling.contact], end(coupling.A, coupling.among_A), end(coupling.B, coupling.among_B),
               data.f.data() + data.f_offset[coupling.contact], terms_of(system, coupling).J});
        batch.group->kernels[thread.number]
            .of(thread.interface_derivatives.size())
            .differentiate(scene.gravity, thread.interface_derivatives);
        for (const RobotsSystem::Coupling& coupling : couplings) {
          const lanes::JoinTerms terms = terms_of(system, coupling);
          const std::vector<int>& columns = system.owner.shape->support().columns[coupling.number];
          for (int i = 0; i < coupling.rows; ++i) {
            double* row = &out.X(system.interface->row[coupling.row + i], 0);
            for (int c = 0; c < terms.cols; ++c) {
              if (out.request.q) row[out.q_first + columns[c]] = terms.dq()[c * terms.rows + i];
              if (out.request.v) row[out.v_first + columns[c]] = terms.dv()[c * terms.rows + i];
            }
          }
        }
      });
}

struct End {  // the end, on one robot, of a contact that couples two robots
  const RobotsSystem::Coupling& coupling;
  lanes::JoinTerms terms;
  int among;       // index of the contact in the robot's coupling contacts
  int row;         // first row in G_r
  bool B;          // whether this is the contact's end B, not A
  int first, end;  // range of those columns of the contact's J that belong to this robot
};
template <class Use>
void each_end(const RobotsSystem& system, std::size_t k, Use&& use) {  // calls use(end) per coupling contact of robot k
  int row = 0, among = 0;
  for (int i : system.robots[k].couplings) {
    const RobotsSystem::Coupling& coupling = system.contacts[i];
    const lanes::JoinTerms terms = terms_of(system, coupling);
    const bool B = coupling.A != static_cast<int>(k);
    const int of_A = static_cast<int>(system.owner.shape->support().contacts[coupling.number].a.size());
    use(End{coupling, terms, among++, row, B, B ? of_A : 0, B ? terms.cols : of_A});
    row += coupling.rows;
  }
}

int place_in_panel(const OfRobot& r, int column) {  // the index in the robot's panel of a column of X, or -1
  for (const RobotsDerivatives::Columns& c : r.columns)
    if (c.in_X <= column && column < c.in_X + c.count) return c.in_P + column - c.in_X;
  return -1;
}

// Completes a robot's panel P = K_r^-1 [E_r, own columns] by K_r^-1 E_r D_r; computes T, G, H (derivatives.hpp).
void finish_robot(const RobotsSystem& system, std::size_t k, const IslandDerivatives& out,
                  RobotsDerivatives::Buffers& buffers) {
  const sparse::PanelKernels& kernels = sparse::panel_kernels();
  OfRobot& r = system.derivatives->robots[k];
  const int size = r.size(), ldT = sparse::padded(size), ldG = r.padded(), o = system.owner.island.dof_offset[k];
  for (int i = 0; i < size; ++i) std::fill(&r.P(i, 0) + r.own, &r.P(i, 0) + r.ld, 0.0);
  std::fill(r.G.begin(), r.G.end(), 0.0);
  each_end(system, k, [&](const End& e) {
    const std::vector<int>& columns = system.owner.shape->support().columns[e.coupling.number];
    for (int i = 0; i < size; ++i)
      for (int c = 0; c < 6; ++c) buffers.E[c * ldT + i] = r.P(i, 6 * e.among + c);
    kernels.product(e.terms.W(), e.terms.rows, buffers.E.data(), 6, e.terms.rows, size, ldT, r.T.data() + e.row * ldT);
    for (int c = e.first; c < e.end; ++c)
      std::copy_n(e.terms.J + c * e.terms.rows, e.terms.rows, r.G.data() + (columns[c] - o) * ldG + e.row);
    if (!out.request.q || !e.B) return;  // the force on A depends on the motion of A alone
    const int ldD = lanes::JoinTerms::padded(e.terms.cols);
    kernels.product(buffers.E.data(), ldT, e.terms.D_B(), 6, size, e.first, ldD, buffers.ED.data());
    for (int c = 0; c < e.first; ++c) {  // A's coordinates
      const int column = place_in_panel(r, out.q_first + columns[c]);
      for (int i = 0; i < size; ++i) r.P(i, column) += buffers.ED[i * ldD + c];
    }
  });
  kernels.product(r.G.data(), ldG, r.P.data(), r.nv, ldG, r.ld, r.ld, r.H.data());
}

// Adds E_r D_r to the sampled columns of B_r, which so far are derivatives of robot r's own terms.
void finish_sample(const RobotsSystem& system, std::size_t k, const IslandDerivatives& out) {
  OfRobot& r = system.derivatives->robots[k];
  if (!out.request.q) return;
  std::size_t next = 6;  // offset in r.ends; in each EndForce, columns of ContactData::Jl follow 6 numbers of force
  each_end(system, k, [&](const End& e) {
    const std::vector<int>& columns = system.owner.shape->support().columns[e.coupling.number];
    const Eigen::Map<const Mat6X<double>> E(r.ends.data() + next, 6, e.end - e.first);
    next += lanes::MovingEnd::size(static_cast<std::size_t>(E.cols()));
    const int ldD = lanes::JoinTerms::padded(e.terms.cols);
    for (std::size_t s = 0; s < r.sampled.size(); ++s)
      for (int c = 0; c < e.first && e.B; ++c) {
        if (out.q_first + columns[c] != system.derivatives->sample.column[r.sampled[s].in_X]) continue;
        for (int j = 0; j < E.cols(); ++j)
          for (int i = 0; i < 6; ++i)
            r.B[s * r.size() + columns[e.first + j] - system.owner.island.dof_offset[k]] +=
                E(i, j) * e.terms.D_B()[i * ldD + c];
      }
  });
}

// Subtracts sum_r G_r K_r^-1 B_r from the interface rows of B, in X; the result is -S Y.
void interface_rhs(const RobotsDerivatives& by, AlignedPanel& X) {
  for (const OfRobot& r : by.robots)
    for (std::size_t i = 0; i < r.join.size(); ++i) {
      const double* h = r.H.data() + i * r.ld;
      double* x = &X(r.join[i], 0);
      for (const RobotsDerivatives::Columns& c : r.columns)
        for (int j = 0; j < c.count; ++j) x[c.in_X + j] -= h[c.in_P + j];
    }
}

// Adds K_r^-1 B_r to columns first ... first+cols-1 of [da; df], in the robot's rows.
void add_own(const OfRobot& r, const Columns& columns, int first, int cols, double* X, std::ptrdiff_t ld) {
  for (const RobotsDerivatives::Columns& c : columns) {
    const int begin = std::max(c.in_X, first), end = std::min(c.in_X + c.count, first + cols);
    for (int i = 0; begin < end && i < r.size(); ++i) {
      const double* p = &r.P(i, 0) + c.in_P - c.in_X;
      double* x = X + r.row[i] * ld;
      for (int j = begin; j < end; ++j) x[j] += p[j];
    }
  }
}

// Computes columns of [da; df]: interface rows -Y, robot rows K_r^-1 B_r - T_r Y. columns_of(r): where B_r is nonzero.
template <class ColumnsOf>
void answer(const RobotsSystem& system, const RobotsDerivatives& by, ColumnsOf&& columns_of, int first, int cols,
            double* X, int ld, bool non_temporal, RobotsDerivatives::Buffers& buffers) {
  const sparse::PanelKernels& kernels = sparse::panel_kernels();
  find_reach(*system.interface, by, columns_of, first, cols, buffers.nonzero);
  kernels.solve(system.interface->schedule, system.L.data(), by.D.data(), by.eliminated.data(), X, ld, first, cols,
                buffers.nonzero.data(), buffers.work.data());
  for (const OfRobot& r : by.robots) {
    const Columns& columns = columns_of(r);
    const bool own = has_own(columns, first, cols);
    kernels.product_of_rows(r.T.data(), sparse::padded(r.size()), X + first, r.join.data(),
                            static_cast<int>(r.join.size()), X + first, r.row.data(), r.size(), cols, ld,
                            non_temporal && !own);
    if (own) add_own(r, columns, first, cols, X, ld);
  }
}

// Prepares column s of the sample for lanes::RobotBlocks::check.
void begin_check(const RobotsDerivatives& by, OfRobot& r, int s, Member& member) {
  const AlignedPanel& X = by.sample.X;
  member.x = r.x.data(), member.b = r.x.data() + r.size();
  for (int i = 0; i < r.size(); ++i) r.x[i] = (i < r.nv ? 1 : -1) * X(r.row[i], s);
  for (std::size_t i = 0; i < r.join.size(); ++i) member.border.y()[i] = -X(r.join[i], s);
  for (std::size_t j = 0; j < r.sampled.size(); ++j)
    if (r.sampled[j].in_X == s) member.b = r.B.data() + j * r.size();
}

// Whether each sampled column solves K X = B with a componentwise backward error up to half the limit for derivatives.
bool sample_is_good(const Scene& scene, Workspace& w, RobotsSystem& system, const AlignedPanel& X) {
  RobotsDerivatives& by = *system.derivatives;
  RobotsDerivatives::Sample& sample = by.sample;
  const std::vector<int>& interface_row = system.interface->row;
  for (int row : interface_row) std::fill_n(&sample.X(row, 0), sample.X.cols(), 0.0);
  for (const OfRobot& r : by.robots)
    for (const RobotsDerivatives::Columns& c : r.sampled)
      for (int row : r.join) sample.X(row, c.in_X) = X(row, sample.column[c.in_X]);
  const int ld = static_cast<int>(sample.X.cols());
  answer(system, by, columns_in_sample, 0, ld, sample.X.data(), ld, false, by.buffers.front());
  each_batch(w, system, costs::kDerivatives, [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork&) {
    for (int s = 0; s < static_cast<int>(sample.column.size()); ++s) {
      for (Member& member : robots)
        begin_check(by, by.robots[system.order[&member - system.members.data()]], s, member);
      kernel.check(robots, memory);
      for (Member& member : robots) {
        OfRobot& r = by.robots[system.order[&member - system.members.data()]];
        std::copy_n(member.border.r(), 2 * r.join.size(), r.left.data() + 2 * s * r.join.size());  // residual and scale
        r.error = s == 0 ? member.error : sparse::larger_or_nan(r.error, member.error);
      }
    }
  });
  double error = 0;
  for (const OfRobot& r : by.robots) error = sparse::larger_or_nan(error, r.error);
  sample.robots_error = error;
  for (std::size_t s = 0; s < sample.column.size(); ++s) {
    for (std::size_t k = 0; k < by.robots.size(); ++k)
      std::copy_n(by.robots[k].left.data() + 2 * s * by.robots[k].join.size(), 2 * by.robots[k].join.size(),
                  system.member(k).border.r());
    for (std::size_t k = 0; k < interface_row.size(); ++k) {
      system.y[k] = -sample.X(interface_row[k], s);
      system.b[k] = sample.b[s * interface_row.size() + k];
    }
    error = sparse::larger_or_nan(error, interface_error(scene.damping, system));
  }
  return error <= tolerance::kPanelRefined;
}

// Computes all robots' panels and, in X, -S Y for `answer`. Returns whether the sampled columns are accurate.
bool solve_robots(const Scene& scene, SceneData& data, RobotsSystem& system, bool refined, IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  RobotsDerivatives& by = *system.derivatives;
  by.sample.robots_error = std::numeric_limits<double>::infinity();  // not known
  clear_rhs(*system.interface, by, by.buffers.front().nonzero, out.X);
  const auto job_of = [&](const OfRobot& r) {
    return lanes::DerivativeJob{solution_of(scene, data), out.request, r.q_first, r.v_first, r.u_first, r.own, false};
  };
  for (std::size_t k = 0; k < by.robots.size(); ++k) system.member(k).ends = by.robots[k].ends.data();
  each_batch(w, system, costs::kDerivatives, [&](Kernel& kernel, std::span<Member> robots, Memory, ThreadWork&) {
    kernel.move_ends(job_of(by.robots.front()), robots);
  });
  differentiate_interface(scene, data, system, out);
  std::fill(by.sample.b.begin(), by.sample.b.end(), 0.0);
  for (std::size_t k = 0; k < by.robots.size(); ++k)
    for (const RobotsDerivatives::Columns& c : by.robots[k].sampled)
      for (int row : system.interface->robots[k].interface_rows)
        by.sample.b[c.in_X * system.b.size() + row] = out.X(system.interface->row[row], by.sample.column[c.in_X]);
  each_batch(w, system, costs::kDerivatives,
             [&](Kernel& kernel, std::span<Member> robots, Memory memory, ThreadWork& thread) {
               const auto number = [&](std::size_t l) { return system.order[&robots[l] - system.members.data()]; };
               thread.panels.clear();
               for (std::size_t l = 0; l < robots.size(); ++l) {
                 OfRobot& r = by.robots[number(l)];
                 std::fill(r.B.begin(), r.B.end(), 0.0);
                 thread.panels.push_back({r.P.data(), r.ld, refined, r.copied});
               }
               kernel.differentiate(job_of(by.robots[number(0)]), robots, memory.at, thread.panels);
               for (std::size_t l = 0; l < robots.size(); ++l) {
                 finish_robot(system, number(l), out, by.buffers[thread.number]);
                 finish_sample(system, number(l), out);
               }
             });
  std::transform(system.D.begin(), system.D.end(), by.D.begin(), std::negate<>());  // D of S, as the factor is of -S
  interface_rhs(by, out.X);
  return sample_is_good(scene, w, system, out.X);
}

// Computes the robots' factors at the current state if another system solved the island.
bool make_current(const Scene& scene, SceneData& data, RobotsSystem& system) {
  if (system.state == data.workspace->state) return true;
  system.first_error = system.owner.matrix.first_error;
  return system.factorize(scene, data) && !system.rows_depend();
}

}  // namespace

bool differentiates_by_robots(const IslandWork& d) {
  if (!d.robots || !d.robots->derivatives || !d.robots->derivatives->has_room) return false;
  if (!d.robots->derivatives->cheaper[d.deficient]) return false;
  if (d.deficient && d.robots->contradiction) return false;
  if (d.robots->solves) return d.answered_by(d.robots.get());
  return d.answered_by(&d.matrix) && !d.matrix.deficient() && d.matrix.factor != d.matrix.dense.get();
}

}  // namespace internal

bool RobotsSystem::differentiate(const Scene& scene, SceneData& data, ThreadWork&, IslandDerivatives& out) {
  using namespace internal;
  Workspace& w = *data.workspace;
  if (!make_current(scene, data, *this)) return false;
  if (!(growth() * std::numeric_limits<double>::epsilon() <= tolerance::kConverged)) return false;
  const bool refined = first_error > tolerance::kRefinePanel;
  if (!solve_robots(scene, data, *this, refined, out) &&
      (refined || derivatives->sample.robots_error <= tolerance::kPanelRefined ||
       !solve_robots(scene, data, *this, true, out)))
    return false;

  AlignedPanel& X = out.X;
  const int ld = static_cast<int>(X.cols());
  const bool non_temporal = sizeof(double) * X.size() > kCacheBytes;
  each_item(w, (ld + RobotsDerivatives::kChunk - 1) / RobotsDerivatives::kChunk,
            are_worth_threads(w, costs::kDerivatives * seconds), [&](std::size_t chunk, ThreadWork& thread) {
              const int first = static_cast<int>(chunk) * RobotsDerivatives::kChunk,
                        cols = std::min(RobotsDerivatives::kChunk, ld - first);
              answer(*this, *derivatives, columns_in_X, first, cols, X.data(), ld, non_temporal,
                     derivatives->buffers[thread.number]);
            });
  return true;
}

}  // namespace manycontact
