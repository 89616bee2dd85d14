// Runs the benchmarks, then prints the ratios that claims are judged by: times of one run on one machine, divided.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <string>

namespace {

// Prints as usual and keeps each benchmark's time: its median over repetitions where there are several.
class KeepTimes : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const bool median = run.aggregate_name == "median";
      if (run.run_type == Run::RT_Aggregate && !median) continue;
      std::string name = run.run_name.str();
      if (!median && times.count(name) && run.repetitions > 1) continue;
      const bool real = name.ends_with("/real_time");  // of several threads
      times[name] = (real ? run.GetAdjustedRealTime() : run.GetAdjustedCPUTime()) /
                    benchmark::GetTimeUnitMultiplier(run.time_unit);
    }
  }
  std::map<std::string, double> times;  // seconds
};

struct Claim {
  const char *what, *numerator, *denominator;
  double divide_by;  // robots
  const char* wanted;
};

constexpr Claim kClaims[] = {
    {"talos: scheduled LDL / ldl_numeric", "parts/talos/ldl_scheduled", "parts/talos/ldl_numeric", 1, "<= 0.5"},
    {"talos: RNEA / ldl_numeric", "parts/talos/rnea", "parts/talos/ldl_numeric", 1, "<= 1.3"},
    {"talos: ABA / ldl_numeric", "parts/talos/aba", "parts/talos/ldl_numeric", 1, "<= 3"},
    {"talos: sparse-ldl solve / ldl_numeric", "parts/talos/solve", "parts/talos/ldl_numeric", 1, "<= 1.9"},
    {"talos: RNEA derivatives / ldl_numeric", "parts/talos/rnea_derivatives", "parts/talos/ldl_numeric", 1, "<= 4.5"},
    {"talos: all derivatives after a solve / ldl_numeric", "parts/talos/derivatives", "parts/talos/ldl_numeric", 1,
     "<= 3.6"},
    {"16 separate: dense-schur / sparse-ldl", "solve/separate/16/dense-schur", "solve/separate/16/sparse-ldl", 1,
     ">= 10"},
    {"16 separate: dense-schur / Eigen's factors and solves", "solve/separate/16/dense-schur", "eigen/separate/16", 1,
     "<= 1.3"},
    {"sparse-ldl per robot, 256 / 1 separate", "solve/separate/256/sparse-ldl", "solve/separate/1/sparse-ldl", 256,
     "<= 1.3"},
    {"16 separate: derivatives, dense-schur / sparse-ldl", "derivatives/separate/16/dense-schur",
     "derivatives/separate/16/sparse-ldl", 1, ">= 20"},
    {"derivatives per robot, 256 / 1 separate", "derivatives/separate/256/sparse-ldl",
     "derivatives/separate/1/sparse-ldl", 256, "<= 1.3"},
    {"feet on corners: redundant / damped by 1e-6", "redundant/feet_on_corners/undamped",
     "redundant/feet_on_corners/damped", 1, "<= 1.5"},
    {"anymal's loop: redundant / damped by 1e-6", "redundant/anymal_loop/undamped", "redundant/anymal_loop/damped", 1,
     "<= 1.5"},
    {"talos: action model's calc / ldl_numeric", "action/calc/1", "parts/talos/ldl_numeric", 1, "18.0 / 3.7 Crocoddyl"},
    {"talos: action model's calcDiff / ldl_numeric", "action/calcDiff/1", "parts/talos/ldl_numeric", 1,
     "55.9 / 3.7 Crocoddyl"},
    {"herd of 256: solve after a contact was switched / solve", "switch/herd/256/one contact", "switch/herd/256/steady",
     1, "<= 1.2"},
    {"16 separate: vjp / solve", "vjp/separate/16", "solve/separate/16/auto", 1, "<= 3"},
    {"256 in lanes (avx2): solve per robot / ldl_numeric", "lanes/avx2/256/solve", "parts/talos/ldl_numeric", 256,
     "<= 0.6"},
    {"256 in lanes (avx2): derivatives per robot / ldl_numeric", "lanes/avx2/256/derivatives",
     "parts/talos/ldl_numeric", 256, "<= 1.4"},
    {"256 in lanes (avx512): solve per robot / ldl_numeric", "lanes/avx512/256/solve", "parts/talos/ldl_numeric", 256,
     "<= 0.6"},
    {"256 in lanes (avx512): derivatives per robot / ldl_numeric", "lanes/avx512/256/derivatives",
     "parts/talos/ldl_numeric", 256, "<= 1.4"},
    {"1,024 / 16 in lanes (avx2): solve per robot", "lanes/avx2/1024/solve", "lanes/avx2/16/solve", 64, "<= 1.15"},
    {"1,024 / 16 in lanes (avx2): derivatives per robot", "lanes/avx2/1024/derivatives", "lanes/avx2/16/derivatives",
     64, "<= 1.15"},
    {"64 states, solve: two threads / one", "batch/solve/separate/1/threads:2/real_time",
     "batch/solve/separate/1/threads:1/real_time", 1, "<= 0.55"},
    {"64 states, derivatives: two threads / one", "batch/differentiate/separate/1/threads:2/real_time",
     "batch/differentiate/separate/1/threads:1/real_time", 1, "<= 0.55"},
    {"64 states, vjp: two threads / one", "batch/vjp/separate/1/threads:2/real_time",
     "batch/vjp/separate/1/threads:1/real_time", 1, "<= 0.55"},
};

void print_claims(const std::map<std::string, double>& times) {
  std::printf("\n%-56s %10s   %s\n", "ratio", "measured", "wanted");
  for (const Claim& c : kClaims) {
    const auto a = times.find(c.numerator), b = times.find(c.denominator);
    if (a == times.end() || b == times.end()) continue;
    std::printf("%-56s %10.2f   %s\n", c.what, a->second / b->second / c.divide_by, c.wanted);
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  KeepTimes reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  print_claims(reporter.times);
}
