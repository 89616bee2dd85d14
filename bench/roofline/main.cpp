// manycontact_roofline: operations and bytes of a solve and of derivatives, beside the machine's peaks of the same run.
// Prints a Markdown table.

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <vector>

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

using Clock = std::chrono::steady_clock;

double heap() {
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
}

double least_time(double seconds, const std::function<void()>& begin, const std::function<void()>& run) {
  double least = 1e9, sum = 0;
  for (int k = 0; k < 5 || sum < seconds; ++k) {
    begin();
    const Clock::time_point start = Clock::now();
    run();
    const double time = std::chrono::duration<double>(Clock::now() - start).count();
    least = std::min(least, time);
    sum += time;
  }
  return least;
}

// What K costs, of all islands: rows, entries of the upper triangle of K and below L's diagonal, operations of L's.
struct Factor {
  double rows = 0, entries = 0, below = 0, operations = 0;
  /// of L D L^T x = b, and of r = b - K x with its scale
  double solve() const { return 4 * below + rows; }
  double residual() const { return 8 * entries; }
};

Factor factor_of(const Scene& scene, const SceneData& data) {
  Factor out;
  for (std::size_t i = 0; i < island_count(data); ++i) {
    IslandShape& shape = *shape_of(data, i);
    const auto counts = shape.counts(choice_of(data, i).order);
    out.rows += shape.island().size();
    out.entries += 0.5 * (nonzeros_of_K(shape, scene.damping) + shape.island().size());
    out.below += counts.nonzeros;
    out.operations += counts.flops;
  }
  return out;
}

void print(const Peaks& peaks, const std::string& what, double time, double operations, double bytes) {
  const double reach = std::min(peaks.flops, operations / bytes * peaks.memory);
  std::printf("| %s | %.3g | %.3g | %.3g | %.3g | %.3g | %.2g | %.2g | %.2g |\n", what.c_str(), 1e6 * time,
              1e-6 * operations, 1e-6 * bytes, operations / bytes, 1e-9 * operations / time,
              100 * operations / time / peaks.flops, 100 * bytes / time / peaks.memory,
              100 * operations / time / reach);
}

// A scene of `count` robots; `alike`: a small one of the same kind, of which operations are counted.
void measure(const Peaks& peaks, const std::string& name, const Posed& s, const Posed& alike, bool all_derivatives) {
  const double scale = double(s.scene.nrobots()) / alike.scene.nrobots();
  const Operations each = count_operations(alike.scene, alike.q, alike.v, 2 * alike.v);
  const double before = heap();
  SceneData data(s.scene);
  const auto run = [&] { (void)solve(s.scene, s.q, s.v, s.u, data); };
  run();
  const double bytes = heap() - before;
  const Factor K = factor_of(s.scene, data);
  const int steps = data.report.refinement_steps / std::max(1, static_cast<int>(island_count(data)));
  print(peaks, name + ", solve", least_time(1, [] {}, run),
        scale * each.motion + K.operations + (1 + steps) * (K.solve() + K.residual()), bytes);

  Eigen::VectorXd wa = s.v, wf = data.f, wq = s.v, wv = s.v, wu = s.u;
  const auto product = [&] { vjp(s.scene, data, wa, wf, wq, wv, wu); };
  product();
  const double of_product = heap() - before;
  print(peaks, name + ", vjp", least_time(1, run, product), scale * each.product + K.solve() + K.residual(), of_product);
  if (!all_derivatives) return;
  const auto derive = [&] { (void)differentiate(s.scene, data); };
  derive();
  const double of_all = heap() - before;
  double columns = 0;  // of right-hand sides, weighed by their islands' shares
  for (std::size_t i = 0; i < island_count(data); ++i) columns += derivatives(data).islands[i].cols;
  columns /= static_cast<double>(island_count(data));
  print(peaks, name + ", derivatives", least_time(1, run, derive), scale * each.derivatives + columns * K.solve(), of_all);
}

}  // namespace

}  // namespace manycontact::bench

int main(int argc, char** argv) {
  using namespace manycontact::bench;
  settings() = parse(argc, argv);
  const Peaks peaks = measure_peaks();
  std::printf("Peaks of one core: %.1f Gflop/s (%s, fused multiply-adds), %.1f GB/s (triad).\n\n", 1e-9 * peaks.flops,
              peaks.instructions.c_str(), 1e-9 * peaks.memory);
  std::puts("| | us | Mflop | MB | flop/byte | Gflop/s | % of flop peak | % of bandwidth | % of roofline |\n"
            "|---|--:|--:|--:|--:|--:|--:|--:|--:|");
  const Posed one = robots(1), four = robots(4, true);
  measure(peaks, "1 robot", one, one, true);
  measure(peaks, "256 robots", robots(256), one, true);
  measure(peaks, "ring of 1,024", robots(settings().quick ? 64 : 1024, true), four, false);
}
