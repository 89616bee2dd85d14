// manycontact_roofline prints a table: operations and bytes of solves and derivatives, relative to the machine's peaks.

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../../src/program/text/choice.hpp"
#include "../scenes.hpp"
#include "../settings.hpp"
#include "counts.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "peaks.hpp"

namespace manycontact::bench {

namespace {

double heap() {
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
}

// Returns the median time of calls during `seconds`, at least three; `begin` runs before each and is not timed.
double median_time(double seconds, const std::function<void()>& begin, const std::function<void()>& run) {
  std::vector<double> times;
  for (double sum = 0; times.size() < 3 || sum < seconds; sum += times.back()) {
    begin();
    const double start = processor_time();
    run();
    times.push_back(processor_time() - start);
  }
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

// Counts over all islands: rows of K, entries of its upper triangle, entries of L below the diagonal, operations of L.
struct Factor {
  double rows = 0, entries = 0, below = 0, operations = 0;
  /// Return the operations for L D L^T x = b, and for r = b - K x with its scale.
  double solve() const { return 4 * below + rows; }
  double residual() const { return 8 * entries; }
};

Factor factor_of(const Scene& scene, const SceneData& data) {
  Factor out;
  for (std::size_t i = 0; i < island_count(data); ++i) {
    IslandShape& shape = *shape_of(data, i);
    const auto counts = shape.counts(chosen_method(data, i).order);
    out.rows += shape.island().size();
    out.entries += 0.5 * (cli::nonzeros_of_K(shape, scene.damping) + shape.island().size());
    out.below += counts.nonzeros;
    out.operations += counts.flops;
  }
  return out;
}

std::string percent(double part, double whole, const char* beyond) {
  if (!(whole > 0)) return "";
  char text[16];
  std::snprintf(text, sizeof text, "%.2g", 100 * part / whole);
  return part > whole ? beyond : text;
}

// One row of the table: operations and bytes of the workspace, and how to measure the time.
struct Entry {
  std::string what;
  double operations = 0, bytes = 0;
  std::function<double()> time;
  double least = 1e9;
};

// Prints a row. If a rate exceeds the memory's peak, the bytes come from the caches.
void print(const Peaks& peaks, const Entry& e) {
  std::printf("| %s | %.3g | %.3g | %.3g | %.2g | %.2g | %s | %s |\n", e.what.c_str(), 1e6 * e.least,
              1e-6 * e.operations, 1e-6 * e.bytes, e.operations / e.bytes, 1e-9 * e.operations / e.least,
              percent(e.operations / e.least, peaks.flops, "above").c_str(),
              percent(e.bytes / e.least, peaks.memory, "in caches").c_str());
}

struct Work {
  explicit Work(Posed scene) : s(std::move(scene)), data(s.scene) {}
  void solve() { (void)manycontact::solve(s.scene, s.q, s.v, s.u, data); }
  void product() { vjp(s.scene, data, s.v, data.f, wq, wv, wu); }
  void derive() { (void)differentiate(s.scene, data); }
  Posed s;
  SceneData data;
  Eigen::VectorXd wq = s.v, wv = s.v, wu = s.u;
};

// Returns the number of columns of right-hand sides, as a mean over islands.
double columns_of(const SceneData& data) {
  double columns = 0;
  for (const IslandDerivatives& of : derivatives(data).islands) columns += of.cols;
  return columns / static_cast<double>(island_count(data));
}

// Adds a scene's solve, vjp and, on request, derivatives. `alike`: a small similar scene, whose operations are counted.
void add(std::vector<Entry>& entries, const std::string& name, Posed scene, const Posed& alike, bool all_derivatives) {
  const double scale = double(scene.scene.nrobots()) / alike.scene.nrobots();
  const Operations each = count_operations(alike.scene, alike.q, alike.v, 2 * alike.v);
  const double before = heap();
  const auto w = std::make_shared<Work>(std::move(scene));
  w->solve();
  const double of_solve = heap() - before;
  const Factor K = factor_of(w->s.scene, w->data);
  const int steps = w->data.report.refinement_steps / std::max(1, static_cast<int>(island_count(w->data)));
  entries.push_back(
      {name + ", solve", scale * each.motion + K.operations + (1 + steps) * (K.solve() + K.residual()), of_solve, [w] {
         return median_time(
             0.2, [] {}, [&] { w->solve(); });
       }});
  w->product();
  entries.push_back({name + ", vjp", scale * each.product + K.solve() + K.residual(), heap() - before, [w] {
                       return median_time(
                           0.2, [&] { w->solve(); }, [&] { w->product(); });
                     }});
  if (!all_derivatives) return;
  w->derive();
  entries.push_back(
      {name + ", derivatives", scale * each.derivatives + columns_of(w->data) * K.solve(), heap() - before, [w] {
         return median_time(
             0.2, [&] { w->solve(); }, [&] { w->derive(); });
       }});
}

}  // namespace

}  // namespace manycontact::bench

int main(int argc, char** argv) {
  using namespace manycontact::bench;
  constexpr int kRounds = 3;  // the least medians and the largest peaks of these are used
  settings() = parse(argc, argv);
  std::vector<Entry> entries;
  const Posed one = robots(1), four = robots(4, true);
  add(entries, "1 robot", one, one, true);
  add(entries, "256 robots", robots(256), one, true);
  add(entries, "ring of 1,024", robots(settings().quick ? 64 : 1024, true), four, false);
  Peaks peaks;
  for (int round = 0; round < kRounds; ++round) {
    const Peaks now = measure_peaks();
    peaks = {now.instructions, std::max(peaks.flops, now.flops), std::max(peaks.memory, now.memory)};
    for (Entry& e : entries) e.least = std::min(e.least, e.time());
  }
  std::printf("Peaks of one core: %.1f Gflop/s (%s, fused multiply-adds), %.1f GB/s (triad).\n\n", 1e-9 * peaks.flops,
              peaks.instructions.c_str(), 1e-9 * peaks.memory);
  std::puts(
      "| | us | Mflop | MB | flop/byte | Gflop/s | % of peak | % of bandwidth |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|");
  for (const Entry& e : entries) print(peaks, e);
}
