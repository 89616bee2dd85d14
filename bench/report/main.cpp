// manycontact_bench_report DIR OURS.json RUN.json...: writes results, charts and a page into DIR, and prints tables.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>

#include "program/files/python.hpp"
#include "report.hpp"

int main(int argc, char** argv) try {
  using namespace manycontact;
  using namespace manycontact::bench;
  if (argc < 3) {
    std::cerr << "usage: manycontact_bench_report DIR RUN.json...\n";
    return 2;
  }
  const std::string dir = std::string(argv[1]) + "/";
  std::filesystem::create_directories(dir);
  std::vector<Run> runs;
  for (int k = 2; k < argc; ++k)
    for (Run& run : read_runs(argv[k])) runs.push_back(std::move(run));
  write_runs(runs, dir + "results.json");
  write_csv(runs, dir + "results.csv");
  std::vector<Figure> drawn;
  if (const cli::Python python = cli::find_python(); python.draws) {
    drawn = figures(runs);
    write_figures(drawn, runs, dir + "figures.json");
    cli::run_python(python, MANYCONTACT_SOURCE_DIR "/bench/report/draw.py", {dir, dir + "figures.json"});
    std::filesystem::remove(dir + "figures.json");
  } else {
    std::cerr << cli::kNoCharts << "\n";
  }
  write_page(runs, drawn, dir + "README.md");
  std::cout << "\n" << table_of_robots(runs) << "\n" << table_of_exponents(runs);
} catch (const std::exception& e) {
  std::cerr << "bench: " << e.what() << "\n";
  return 2;
}
