// The charts of `manycontact stability`, drawn by gnuplot.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "../files/gnuplot.hpp"
#include "../text/table.hpp"
#include "stability.hpp"

namespace manycontact::cli {

namespace {

// The axis of constraint violations. Above it a row of marks per gains shows the runs that lost the contacts.
constexpr double kTop = 1, kBottom = 1e-16;
constexpr const char* kCurveColours[] = {"#555555", "#1f77b4", "#2ca02c", "#d62728", "#000000", "#9467bd"};

const char* title(Integrator integrator) { return integrator == Integrator::kRk4 ? "RK4" : "semi-implicit Euler"; }

std::string legend(const GainsChoice& choice) {
  if (choice.recommended) return "recommended for the step";
  if (choice.name == "none") return "no gains";
  std::ostringstream text;
  text << "α = " << choice.gains.alpha << "/s², β = " << choice.gains.beta << "/s";
  return text.str();
}

double mark_height(std::size_t choice) { return kTop * std::pow(10, 0.4 * static_cast<double>(choice + 1)); }

// Writes two data blocks of the block-th `size` runs: h and violation of those that kept the contacts, h and the
// mark of the others.
void drift_blocks(const Stability& s, std::size_t block, std::size_t size, std::ostream& out) {
  std::ostringstream drift, lost;
  for (std::size_t k = block * size; k < (block + 1) * size; ++k) {
    const DriftPoint& p = s.drift[k];
    const bool kept = p.stopped == StepStatus::kOk && p.largest.position_drift < kTop;
    if (kept)
      drift << p.h << " " << std::max(p.largest.position_drift, kBottom) << "\n";
    else
      drift << "\n", lost << p.h << " " << mark_height(block % s.choices.size()) << "\n";
  }
  out << "$drift" << block << " << EOD\n"
      << "NaN NaN\n\n"
      << drift.str() << "EOD\n";
  out << "$lost" << block << " << EOD\n"
      << "NaN NaN\n"
      << lost.str() << "EOD\n";
}

// Lines at the largest stable steps, in the colours of their curves.
void limit_lines(const Stability& s, Integrator integrator, double lowest, double top, std::ostream& out) {
  for (std::size_t c = 0; c < s.choices.size(); ++c) {
    if (s.choices[c].recommended) continue;
    const double h = largest_stable_step(integrator, s.choices[c].gains);
    if (h > 0.1 || h < 5e-4) continue;
    out << "set arrow from " << h << "," << lowest << " to " << h << "," << top << " nohead dt 3 lc rgb '"
        << kCurveColours[c] << "'\n";
  }
}

}  // namespace

void draw_drift(const Stability& s, const std::string& base) {
  const std::size_t choices = s.choices.size(), sizes = s.drift.size() / (2 * choices);
  double least = 1;
  for (const DriftPoint& p : s.drift) least = std::min(least, std::max(p.largest.position_drift, kBottom));
  const double lowest = std::pow(10, std::floor(std::log10(least)));
  std::ostringstream out;
  for (std::size_t b = 0; b < 2 * choices; ++b) drift_blocks(s, b, sizes, out);
  const double top = mark_height(choices);
  out << "set multiplot layout 1,2 title "
      << quoted(s.scene + ": drift of the contacts in " + number(s.drift_time) + " s, without torques")
      << " noenhanced margins 0.08,0.98,0.24,0.87 spacing 0.06\n"
      << "set logscale xy\nset format x '10^{%T}'\nset format y '10^{%T}'\nset grid lt 1 lw 1 lc rgb '#dddddd'\n"
      << "set xrange [2e-4:0.13]\nset yrange [" << lowest << ":" << top << "]\nset xlabel 'step (s)'\n"
      << "set ytics " << lowest << ",10,1\nset label \"beyond 1\\nor stopped\" at 2.2e-4," << mark_height(choices / 2)
      << " left\n";
  for (std::size_t i = 0; i < 2; ++i) {
    out << "unset arrow\nset arrow from graph 0, first " << kTop << " to graph 1, first " << kTop
        << " nohead lc rgb 'black'\n";
    limit_lines(s, kIntegrators[i], lowest, top, out);
    out << "set title '" << title(kIntegrators[i]) << "'\n"
        << "set ylabel '" << (i == 0 ? "largest position drift (m, rad)" : "") << "'\n"
        << (i == 0 ? "set key at screen 0.5,0.02 center bottom Left reverse maxrows 2 samplen 2 noenhanced\n"
                   : "unset key\n")
        << "plot ";
    for (std::size_t c = 0; c < choices; ++c) {
      const std::size_t b = i * choices + c;
      out << "$drift" << b << " with linespoints lw " << (s.choices[c].recommended ? 3 : 2) << " pt 7 ps 0.5 lc rgb '"
          << kCurveColours[c] << "' title " << quoted(legend(s.choices[c])) << ", $lost" << b
          << " with points pt 2 ps 1 lw 2 lc rgb '" << kCurveColours[c] << "' notitle, ";
    }
    out << "NaN with lines dt 3 lc rgb '#555555' title 'predicted limit of gains'\n";
  }
  out << "unset multiplot\n";
  draw(out.str(), 1100, 640, base);
}

void draw_energy(const Stability& s, const std::string& base) {
  std::ostringstream out;
  double kinetic = 0, h = 0;
  long steps = 2;  // an axis has a length
  for (std::size_t k = 0; k < s.energy.size(); ++k) {
    const EnergyRun& run = s.energy[k];
    out << "$run" << k << " << EOD\n";
    for (const EnergyRow& row : run.rows)
      if (row.error > 0) out << row.step << " " << row.error << "\n";
    out << (run.rows.empty() || run.rows.back().error == 0 ? "NaN NaN\n" : "") << "EOD\n";
    if (run.stopped == StepStatus::kOk) kinetic = std::max(kinetic, run.kinetic);
    h = run.h;
    steps = std::max(steps, run.steps);
  }
  out << "set title "
      << quoted(s.scene + ": energy error without torques, step " + number(h) + " s; largest kinetic energy " +
                number(kinetic) + " J")
      << " noenhanced\n"
      << "set logscale xy\nset format x '10^{%T}'\nset format y '10^{%T}'\nset grid lt 1 lw 1 lc rgb '#dddddd'\n"
      << "set xrange [1:" << steps << "]\nset xlabel 'steps' offset 0,0.6\nset ylabel 'largest |E − E(0)| so far (J)'\n"
      << "set key outside below Left reverse maxrows 2 samplen 3 noenhanced\nplot ";
  for (std::size_t k = 0; k < s.energy.size(); ++k) {
    const EnergyRun& run = s.energy[k];
    const bool rk4 = run.integrator == Integrator::kRk4, bare = run.gains == "none";
    const std::string end =
        run.stopped == StepStatus::kOk ? "" : " (stopped after " + std::to_string(run.steps) + " steps)";
    out << (k ? ", " : "") << "$run" << k << " with lines lw 2 dt " << (bare ? 2 : 1) << " lc rgb '"
        << (rk4 ? "#1f77b4" : "#d62728") << "' title "
        << quoted(std::string(title(run.integrator)) + (bare ? ", no gains" : ", recommended gains") + end);
  }
  out << "\n";
  draw(out.str(), 900, 600, base);
}

}  // namespace manycontact::cli
