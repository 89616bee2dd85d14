#include <fstream>
#include <stdexcept>

#include "../../src/program/text/table.hpp"
#include "report.hpp"

namespace manycontact::bench {

namespace {

void write_machine(std::ostream& out, const std::vector<Run>& runs) {
  const Run& run = runs.at(0);
  const auto at = [&](const char* key) {
    const auto found = run.machine.find(key);
    return found == run.machine.end() ? std::string("unknown") : found->second;
  };
  out << at("processor") << ", " << at("cores") << " cores, one used; instructions " << at("instructions") << "; "
      << at("compiler") << ", `" << at("flags") << "`; " << at("date") << ", load " << at("load")
      << " at the start. Feet " << at("feet") << ".\n";
  for (const Run& r : runs) out << r.program << " " << r.version << (&r == &runs.back() ? ".\n" : ", ");
  out << "manycontact chooses its instructions when it starts; a peer has those of its build, all of this processor in one "
         "that is native.\n";
}

void write_differences(std::ostream& out, const std::vector<Run>& runs) {
  out << "\n## Differences between the programs\n\n"
         "Every program is given the same bodies, state and torques, and contacts without position\n"
         "and velocity errors (`J v = 0`). "
         "\"Differs\" is the largest difference of its accelerations from ours, relative to our largest.\n\n";
  for (const Run& run : runs) {
    const std::string text = otherwise(run.program);
    if (text.empty()) continue;
    out << "* " << text << ".";
    for (const std::string& task : tasks(run, "separate")) {
      const std::vector<Point> points = series(run, "separate", task);
      out << " `" << task << "` differs " << cli::scientific(points.front().result->difference) << " for "
          << points.front().size << " robot";
      if (points.size() > 1)
        out << ", " << cli::scientific(points.back().result->difference) << " for " << points.back().size;
      out << ".";
    }
    out << "\n";
  }
  out << "* Separate robots may also be given to a program one after the other; each then takes the time of one "
         "robot.\n"
         "* Scenes that a program cannot represent, or that take over half a second a call, are left out.\n";
}

}  // namespace

void write_page(const std::vector<Run>& runs, const std::vector<Figure>& drawn, const std::string& path) {
  std::ofstream out(path);
  out << "# How fast: " << runs.at(0).robot << "\n\nWritten by `./run bench`"
      << "; all numbers are in [results.csv](results.csv) and [results.json](results.json).\n";
  write_machine(out, runs);
  out << "\nTimes are the least of three means, in us; in brackets in units of SuiteSparse's plain `ldl_numeric` on "
         "the K\n"
         "of one robot, in the same run.\n\n"
      << table_of_robots(runs);
  for (const Figure& f : drawn) out << "\n![" << f.title << "](" << f.file << ".png)\n";
  write_differences(out, runs);
  out << "\n## Parts of a solve\n\n"
         "Each part is repeated in a loop of its own: `derivatives` many times after one solve. In the first table "
         "each\n"
         "call of the derivatives follows a new solve, whose time is not counted, so the two times differ.\n\n"
      << table_of_parts(runs.at(0));
  const std::string one = table_of_one(runs);
  if (!one.empty())
    out << "\n## One robot\n\n"
           "Contacts are left out, but in `FDDP`: an iteration of `SolverFDDP` over 20 nodes with both feet fixed, which one\n"
           "source computes with both libraries (`bench/programs/fddp.hpp`). Pinocchio's `crba` fills one triangle.\n\n"
        << one;
  out << "\n## Growth\n\n"
         "The theory counts the numbers of the result: a derivative block of an island has about n^2. In a chain the\n"
         "factor of the joint-space matrix is dense as well, and solves with it for all columns grow with n^3; few "
         "sizes\n"
         "are measured.\n\n"
      << table_of_exponents(runs);
  if (!out.flush()) throw std::runtime_error(path + " cannot be written");
}

}  // namespace manycontact::bench
