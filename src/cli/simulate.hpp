#pragma once
// What `manycontact simulate` and `manycontact stability` share.

#include <fstream>
#include <functional>
#include <string>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact::cli {

/// The same gains for every contact.
void set_gains(Scene& scene, const Gains& gains);

/// A file written row by row, "-" is standard output. Throws InputError when it cannot be.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path, const std::string& option);
  CsvFile& operator<<(double x);              // shortest that reads back to the same bits
  CsvFile& operator<<(const std::string& x);  // quoted where it must be
  void end_row();
  void close();

 private:
  std::string path_, option_, row_;
  std::ofstream file_;
  std::ostream* out_;
  void check();
};

/// t, q, v, drift, energy, momentum: the header, then a row per state.
void write_trajectory_header(const Scene& scene, CsvFile& csv);
void write_trajectory_row(const SimulationData& sim, const Invariants& at, CsvFile& csv);

/// Draws `script` (what follows gnuplot's `set terminal`) into folder/name.svg and folder/name.png by gnuplot run in
/// `folder`; the script is left there as name.gp. False when gnuplot is missing or fails; `why` then says so.
bool draw_chart(const std::string& folder, const std::string& name, int width, int height, const std::string& script,
                std::string& why);

}  // namespace manycontact::cli
