#pragma once
// Measurements are one Run per program, stored as JSON and as CSV.

#include <map>
#include <string>
#include <vector>

namespace manycontact::bench {

struct Result {
  std::string name;        // sweep/SCENE/SIZE/TASK, parts/TASK, ...
  double us = 0;           // least of the repetitions' means
  double bytes = 0;        // heap memory after the first call; 0: not measured
  double difference = -1;  // largest deviation of accelerations from ours, relative to ours; negative: not compared
};

struct Run {
  std::string program, version, robot;
  std::map<std::string, std::string> machine;  // processor, compiler, flags, date, ...
  std::vector<Result> results;
};

/// Returns the result called `name`, or null.
const Result* find(const Run& run, const std::string& name);

/// Throw std::runtime_error, read_runs also for a file that is not a list of runs.
void write_runs(const std::vector<Run>& runs, const std::string& path);
std::vector<Run> read_runs(const std::string& path);
void write_csv(const std::vector<Run>& runs, const std::string& path);

/// Time over size of one task on one kind of scene, ascending in size.
struct Point {
  int size;
  const Result* result;
};
std::vector<Point> series(const Run& run, const std::string& scene, const std::string& task);
/// Returns the tasks that a run has on a kind of scene, in the order measured.
std::vector<std::string> tasks(const Run& run, const std::string& scene);

}  // namespace manycontact::bench
