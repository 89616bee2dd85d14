#include "memory.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include "manycontact/task/parts.hpp"

namespace manycontact::task {

namespace {

// Returns the number of available bytes according to /proc/meminfo, or of all memory, but at most the process's limit.
double available() {
  double out = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  for (double kB = 0; file >> key >> kB; std::getline(file, unit))
    if (key == "MemAvailable:") out = std::min(out, 1024 * kB);
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    out = std::min(out, static_cast<double>(limit.rlim_cur));
  return out;
}

// Returns the number of bytes in use, or 0 if the C library does not report it.
double in_use() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0;
#endif
}

// Returns the number of bytes that solvers store for a node of n states and m controls: Vxx, Qxx, Qxu, Quu, K, vectors.
double solver_bytes(double n, double m) { return 8 * (2 * n * n + 2 * n * m + 2 * m * m + 12 * (n + m)); }

double solver_bytes(const ActionModelAbstract& model) {
  const auto* whole = dynamic_cast<const ActionModelParts*>(&model);
  if (!whole || whole->get_couplings())
    return solver_bytes(static_cast<double>(model.get_state()->get_ndx()), static_cast<double>(model.get_nu()));
  double out = 0;
  for (const ActionPart& part : whole->get_parts()) out += solver_bytes(*part.model);
  return out;
}

std::string gigabytes(double bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2g GB", bytes / 1e9);
  return text;
}

}  // namespace

void require_memory(const TaskFile& task, const ShootingProblem::Models& running) {
  std::map<const ActionModelAbstract*, double> counts;
  for (const auto& model : running) ++counts[model.get()];
  double bytes = 0;
  for (const auto& model : running) {
    const auto kind = counts.find(model.get());
    if (kind == counts.end()) continue;
    const double before = in_use();
    const auto data = model->createData();
    bytes += kind->second * (std::max(0.0, in_use() - before) + solver_bytes(*model));
    counts.erase(kind);
  }
  const double there = available();
  if (bytes < there) return;
  const auto longest = std::max_element(task.phases.begin(), task.phases.end(),
                                        [](const TaskPhase& a, const TaskPhase& b) { return a.nodes < b.nodes; });
  throw InputError(task.path, longest->line,
                   std::to_string(task.nodes()) + " nodes would take about " + gigabytes(bytes) + " of memory, " +
                       gigabytes(there) + " are available; expected fewer nodes or a solver for decoupled subproblems");
}

bool dense_parts_fit(const TaskFile& task) {
  double bytes = 0;
  for (const std::vector<int>& robots : separate_robots(task)) {
    const ActionPart at = coordinates_of(task.scene.scene, robots);
    const double n = static_cast<double>(at.dx.size()), m = static_cast<double>(at.u.size());
    bytes += task.nodes() * (solver_bytes(n, m) + 8 * (6 * n * n + 6 * n * m));
  }
  return bytes < 0.5 * available();
}

}  // namespace manycontact::task
