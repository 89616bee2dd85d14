// usage: attack SECONDS FIRST_SEED FOLDER [--auto] [DIMENSION...] runs random cases for SECONDS from FIRST_SEED on.
// Keeps shrunk faults in FOLDER, one folder each, and exits with 1 if there are any. --auto: only the method auto.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "attack/judge.hpp"
#include "support/folder.hpp"
#include "support/methods.hpp"

namespace manycontact::attack {
namespace {

struct Tally {
  int cases = 0, judged = 0, faulty = 0;
  std::map<std::string, int> faults;
};

// Keeps the smallest case of a fault, with the finding and the command to reproduce it.
void keep(const Case& c, const Finding& finding, const std::string& folder) {
  test::TemporaryFolder scratch;
  const std::size_t in = finding.method.find(" in ");  // the name of a precision follows; judgements cover all of them
  std::vector<Method> methods;
  if (const auto method = method_from_string(finding.method)) methods.push_back(*method);
  const auto same = [&](const Case& smaller) {
    for (const Finding& f : judge(smaller, scratch.path().string(), methods).findings)
      if (f.fault == finding.fault) return true;
    return false;
  };
  const Case small = shrunk(c, same);
  const std::string scene = write_case(small, folder);
  std::ofstream(folder + "/finding.txt") << c.name << "\n"
                                         << to_string(finding.fault) << ": " << finding.text << "\n"
                                         << "manycontact solve " << scene << " --derivatives"
                                         << (in != std::string::npos  ? " --precision " + finding.method.substr(in + 4)
                                             : finding.method.empty() ? ""
                                                                      : " --method " + finding.method)
                                         << "\n";
}

int attack(double seconds, std::uint64_t first, const std::string& folder, std::vector<std::string> dimensions) {
  const bool only_auto = std::erase(dimensions, "--auto") > 0;
  const std::vector<Method> methods = only_auto ? std::vector{Method::kAuto} : test::methods();
  test::TemporaryFolder scratch;
  Tally tally;
  std::map<std::string, int> kept;
  const auto start = std::chrono::steady_clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (std::uint64_t seed = first; spent() < seconds; ++seed) {
    const Case c = random_case(seed, dimensions.empty() ? draw_dimensions(seed, kDimensions) : dimensions);
    const Judgement j = judge(c, scratch.path().string(), methods);
    ++tally.cases, tally.judged += j.judged, tally.faulty += !j.findings.empty();
    for (const Finding& f : j.findings) {
      ++tally.faults[to_string(f.fault)];
      std::printf("%s: %s %s: %s\n", c.name.c_str(), f.method.c_str(), to_string(f.fault).c_str(), f.text.c_str());
    }
    constexpr int kKept = 5;  // cases kept per kind of fault
    if (!j.findings.empty() && kept[to_string(j.findings.front().fault)]++ < kKept)
      keep(c, j.findings.front(), folder + "/" + to_string(j.findings.front().fault) + "-" + std::to_string(seed));
  }
  std::printf("%d cases, %d of them judged, %d with a fault", tally.cases, tally.judged, tally.faulty);
  for (const auto& [name, count] : tally.faults) std::printf("; %s %d", name.c_str(), count);
  std::printf("\n");
  return tally.faulty > 0;
}

}  // namespace
}  // namespace manycontact::attack

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: attack SECONDS FIRST_SEED FOLDER [--auto] [DIMENSION...]\n");
    return 2;
  }
  return manycontact::attack::attack(std::atof(argv[1]), std::strtoull(argv[2], nullptr, 10), argv[3],
                                     {argv + 4, argv + argc});
}
