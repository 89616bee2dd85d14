// Runs one task of a program on a scene file, for bench/collection/chart.py.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "manycontact/analysis/load_scene.hpp"
#include "programs/program.hpp"
#include "settings.hpp"

namespace manycontact::bench {

namespace {

constexpr double kLong = 2e5;  // us of repeats, of which there are at least kLeast
constexpr int kLeast = 5;

double median_time(Loaded& loaded) {
  std::vector<double> times;
  for (double sum = 0; sum < kLong || times.size() < kLeast; sum += times.back()) {
    loaded.begin();
    const auto start = std::chrono::steady_clock::now();
    loaded.run();
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return times[times.size() / 2];
}

// Returns a feature of the scene that peers are not given, or nothing.
std::string beyond_peers(const Scene& scene) {
  if (!scene.wrenches.empty() || !scene.springs.empty() || !scene.joint_springs.empty()) return "wrenches or springs";
  if (scene.damping != 0) return "a damping";
  for (const Contact& c : scene.contacts)
    if (c.alpha != 0 || c.beta != 0) return "gains";
  for (const Robot& r : scene.robots)
    if (r.model->armature.any() || r.model->damping.any() || r.model->friction.any())
      return "armature or joint friction";
  return {};
}

}  // namespace

Task task_of(const std::string& words) {
  std::istringstream stream(words);
  Task task;
  std::getline(stream, task.name, ':');
  for (std::string dial; std::getline(stream, dial, ':');) task.dials.push_back(std::stod(dial));
  return task;
}

void run_on_scene() {
  SceneFile file = load_scene(settings().scene);
  const Posed scene{std::move(file.scene), file.q, file.v, file.u};
  std::string why = program().refuses(scene, task_of(settings().task).name);
  if (why.empty() && program().name != "manycontact") why = beyond_peers(scene.scene);
  if (!why.empty()) throw std::runtime_error(program().name + ": " + why);
  const std::unique_ptr<Loaded> loaded = program().load(scene, settings().task);
  const double time = median_time(*loaded);
  std::ofstream out(settings().out);
  out.precision(17);
  out << loaded->accelerations() << "\n";
  std::cout << time << "\n";
}

}  // namespace manycontact::bench
