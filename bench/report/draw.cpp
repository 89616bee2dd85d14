// Gnuplot draws figures: panels in a row, a key below each, and below all the differences between programs.

#include <sstream>

#include "../../src/program/files/gnuplot.hpp"
#include "report.hpp"

namespace manycontact::bench {

namespace {

constexpr int kWidth = 640, kAlone = 900, kHeight = 680;  // pixels, of a panel
constexpr int kPoints[] = {7, 5, 9, 13, 11};

// The colours are Okabe and Ito's; ours is black.
const char* colour(const std::string& program) {
  if (program == "MuJoCo") return "#E69F00";
  if (program == "Simbody") return "#009E73";
  if (program == "DART") return "#CC79A7";
  if (program == "Pinocchio") return "#0072B2";
  if (program == "Crocoddyl") return "#D55E00";
  return "black";
}

void write_panel(std::ostream& out, const Panel& p, double left, double right) {
  out << "set lmargin at screen " << left << "\nset rmargin at screen " << right
      << "\nset tmargin at screen 0.88\nset bmargin at screen 0.38\nset key at screen " << left
      << ", screen 0.27 left top Left reverse vertical maxrows 5 samplen 3 font ',9'\nset title "
      << cli::quoted(p.title) << "\nset xlabel " << cli::quoted(p.x) << "\nset ylabel " << cli::quoted(p.y)
      << " offset 0.5,0\n";
  std::string plots;
  for (std::size_t k = 0; k < p.lines.size(); ++k) {
    const Line& line = p.lines[k];
    out << "$line" << k << " << EOD\n";
    for (const auto& [x, y] : line.points) out << x << " " << y << "\n";
    out << "EOD\n";
    const bool ours = line.run->program == "manycontact";
    std::ostringstream look;
    look << "$line" << k << " using 1:2 with linespoints lw " << (ours ? 2.5 : 1.5) << " dt " << line.task + 1 << " pt "
         << kPoints[line.task % 5] << " ps 0.8 lc rgb '" << colour(line.run->program) << "' title "
         << cli::quoted(line.label);
    plots += (plots.empty() ? "plot " : ", ") + look.str();
  }
  out << (plots.empty() ? "plot NaN notitle" : plots) << "\n";
}

}  // namespace

void draw(const Figure& figure, const std::vector<Run>& runs, const std::string& base) {
  const double n = static_cast<double>(figure.panels.size());
  std::ostringstream out;
  out << "set termoption noenhanced\nset multiplot\nset logscale xy\nset border 3\nset tics nomirror\n"
      << "set grid lc rgb '#e4e4e4'\nset label 1 " << cli::quoted(figure.title)
      << " at screen 0.02, screen 0.965 font ',14'\n";
  double height = 0.095;
  int label = 2;
  for (const Run& run : runs)
    if (const std::string text = otherwise(run.program); !text.empty()) {
      out << "set label " << label++ << " " << cli::quoted(text) << " at screen 0.02, screen " << height
          << " tc rgb '#555555' font ',9'\n";
      height -= 0.023;
    }
  for (std::size_t k = 0; k < figure.panels.size(); ++k) {
    const double left = (static_cast<double>(k) + 0.14) / n, right = (static_cast<double>(k) + 0.96) / n;
    write_panel(out, figure.panels[k], left, right);
    out << "unset label\n";
  }
  out << "unset multiplot\n";
  cli::draw(out.str(), figure.panels.size() == 1 ? kAlone : static_cast<int>(n * kWidth), kHeight, base);
}

}  // namespace manycontact::bench
