// Runs the benchmarks of one program and writes a line for each, and a JSON file of all.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include "claims.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "programs/program.hpp"
#include "settings.hpp"

namespace manycontact::bench {

namespace {

// Prints one line per benchmark, with the least time of its repetitions.
class KeepLeast : public benchmark::BenchmarkReporter {
 public:
  explicit KeepLeast(bench::Run& kept) : run_(kept) {}

  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    Result least;
    std::string label;
    for (const Run& r : runs) {
      if (r.run_type == Run::RT_Aggregate) continue;
      const double time = r.run_name.time_type.empty() ? r.GetAdjustedCPUTime() : r.GetAdjustedRealTime();
      const double us = 1e6 * time / benchmark::GetTimeUnitMultiplier(r.time_unit);
      if (!least.name.empty() && us >= least.us) continue;
      benchmark::BenchmarkName full = r.run_name;
      if (full.time_type == "manual_time") full.time_type.clear();
      least = {full.str(), us};
      label = r.report_label;
      for (const auto& [name, value] : r.counters) {
        if (name == "bytes") least.bytes = value;
        if (name == "difference") least.difference = value;
        if (name == "skipped") least.us = 0;
      }
    }
    if (least.name.empty()) return;  // only an aggregate
    if (least.us > 0) run_.results.push_back(least);
    print(least, label);
  }

 private:
  void print(const Result& r, const std::string& label) const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
    std::printf("%4.0f s  %-12s %-44s", passed.count(), run_.program.c_str(), r.name.c_str());
    if (r.us > 0)
      std::printf("%14.2f us", r.us);
    else
      std::printf("       left out");
    if (r.difference >= 0) std::printf("   differs %.0e", r.difference);
    std::printf("%s%s\n", label.empty() ? "" : "   ", label.c_str());
    std::fflush(stdout);
  }

  bench::Run& run_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string date() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text;
}

std::string load_average() {
  std::ifstream in("/proc/loadavg");
  std::string one_minute;
  in >> one_minute;
  return one_minute;
}

std::string levels() {
  std::string all;
  for (const SimdLevel lanes : available_simd_levels()) all += (all.empty() ? "" : " ") + to_string(lanes);
  return all;
}

std::map<std::string, std::string> machine() {
  return {{"processor", processor()},
          {"cores", std::to_string(std::thread::hardware_concurrency())},
          {"instructions", program().name == "manycontact" ? levels() : ""},
          {"compiler", MANYCONTACT_COMPILER},
          {"flags", MANYCONTACT_FLAGS},
          {"feet", robot_frames()},
          {"date", date()},
          {"load", load_average()}};
}

// Sets Google Benchmark's options: ours first, since those of the command line take precedence.
void initialize(int argc, char** argv) {
  static std::vector<std::string> words;  // Google Benchmark writes argv[0] into its files, later
  words = {argv[0], "--benchmark_repetitions=3", "--benchmark_min_time=0.1"};
  if (settings().quick)
    words = {argv[0], "--benchmark_repetitions=2", "--benchmark_min_time=0.03",
             "--benchmark_filter=^(parts|sweep|lanes/[a-z0-9]+/256)/"};
  words.insert(words.end(), argv + 1, argv + argc);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) std::exit(2);
}

}  // namespace

}  // namespace manycontact::bench

int main(int argc, char** argv) try {
  using namespace manycontact::bench;
  settings() = parse(argc, argv);
  if (!settings().scene.empty()) return run_on_scene(), 0;
  initialize(argc, argv);
  register_all();
  const std::string native = std::string(MANYCONTACT_FLAGS).ends_with("-march=native") ? " native" : "";
  Run run{program().name + native, program().version, robot_name(), machine(), {}};
  KeepLeast reporter(run);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  print_claims(run);
  if (!settings().out.empty()) write_runs({run}, settings().out);
} catch (const std::exception& e) {
  std::cerr << "bench: " << e.what() << "\n";
  return 2;
}
