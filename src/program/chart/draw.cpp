// The picture: three panels, error over time, and a legend below them, drawn by gnuplot.

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "../files/gnuplot.hpp"
#include "../text/table.hpp"
#include "chart.hpp"

namespace manycontact::cli {

namespace {

constexpr int kWidth = 1560, kHeight = 700;    // pixels
constexpr double kLeast = 1e-17, kMost = 1e9;  // errors beyond are drawn there
constexpr double kBand = 0.13;                 // of a panel's height: for failures
const char* const kPanelTitles[] = {"Accelerations", "Contact forces", "Derivatives"};

// Okabe and Ito's colours, then Tol's; auto is black.
const char* const kColours[] = {"#CC79A7", "#E69F00", "#0072B2", "#56B4E9", "#009E73",
                                "#D55E00", "#882255", "#999933", "#44AA99", "#AA4499"};
// gnuplot's point types, filled and open: circle where there is no order; triangle, square, diamond, ...
constexpr int kFilled[] = {7, 9, 5, 13, 11, 15}, kOpen[] = {6, 8, 4, 12, 10, 14};

const char* colour_of(Method method) {
  std::size_t k = 0;
  for (Method m : kMethods) {
    if (m == Method::kAuto) continue;
    if (m == method) return kColours[k % std::size(kColours)];
    ++k;
  }
  return "black";
}

int point_of(const std::optional<Order>& order, bool open) {
  std::size_t k = 0;
  if (order)
    for (Order o : kOrders)
      if (++k; o == *order) break;
  return (open ? kOpen : kFilled)[k % std::size(kFilled)];
}

std::string style_of(Method method, const std::optional<Order>& order, bool guessed) {
  std::ostringstream out;
  if (method == Method::kAuto)
    out << "pt 6 ps 2.4 lw " << (guessed ? 1 : 2.5) << " lc rgb 'black'";
  else
    out << "pt " << point_of(order, guessed) << " ps " << (guessed ? 1.2 : 1.4) << " lw 1.5 lc rgb '"
        << colour_of(method) << "'";
  return out.str();
}

// Ranges of a panel, as powers of ten; the band of failures is above `top`.
struct Frame {
  double left = -0.15, right = 0.5, bottom = -15, top = -10, end = -10;
  bool band = false;
  double fastest = 0;

  double y(double error) const { return std::clamp(error, kLeast, kMost); }
  double in_band(double fraction) const { return std::pow(10, top + (end - top) * (0.15 + 0.7 * fraction)); }
};

// Such a row can only be drawn at the edge: there is no solution, or no reference.
bool at_edge(const ChartRow& row, int panel) {
  return row.outcome != Outcome::kAnswered || !panel_time(row, panel) || !panel_error(row, panel);
}

Frame frame_of(const Chart& chart, int panel) {
  Frame f;
  const ChartRow* fastest = chart.fastest(panel == 2);
  f.fastest = fastest ? *panel_time(*fastest, panel) : 0;
  double low = 1, high = -17, right = 0;
  for (const ChartRow& row : chart.rows) {
    const auto time = panel_time(row, panel);
    if (time && f.fastest > 0) {
      right = std::max(right, std::log10(*time / f.fastest));
      f.left = std::min(f.left, std::log10(*time / f.fastest) - 0.1);
    }
    f.band = f.band || at_edge(row, panel);
    if (at_edge(row, panel)) continue;
    const double error = std::log10(f.y(*panel_error(row, panel)));
    low = std::min(low, error);
    high = std::max(high, error);
  }
  if (low > high) low = -16, high = -10;
  f.bottom = std::floor(low - 0.3);
  f.top = f.end = std::max(std::ceil(high + 0.3), f.bottom + 3);
  if (f.band) f.end = f.top + kBand / (1 - kBand) * (f.top - f.bottom);
  right = std::max(right, 0.3);
  f.right = right + 0.24 * (right - f.left);  // space for the names of the dampings
  return f;
}

void write_tics(std::ostream& out, const Frame& f) {
  out << "set xtics nomirror (";
  const char* comma = "";
  const bool fine = f.right - f.left < 2.2;
  for (int k = -3; k < 9; ++k)
    for (int m : {1, 2, 5}) {
      const double x = k + std::log10(m);
      if ((m > 1 && !fine) || x < f.left || x > f.right) continue;
      out << comma << quoted(number(std::pow(10, x), 2)) << " " << std::pow(10, x);
      comma = ", ";
    }
  out << ")\nset ytics nomirror (";
  comma = "";
  const int step = f.top - f.bottom > 8 ? 2 : 1;
  for (int k = static_cast<int>(f.bottom); k <= f.top; k += step, comma = ", ")
    out << comma << "'1e" << k << "' 1e" << k;
  out << ")\n";
}

// Names the dampings where their errors lie, at the right; close ones share a line.
void write_levels(std::ostream& out, const Chart& chart, int panel, const Frame& f) {
  std::map<std::string, std::vector<double>> errors;
  for (const ChartRow& row : chart.rows)
    if (!at_edge(row, panel))
      errors[row.guessed ? row.regularisation() : "as given"].push_back(std::log10(f.y(*panel_error(row, panel))));
  std::vector<std::pair<double, std::string>> levels;
  for (auto& [name, e] : errors) {
    std::sort(e.begin(), e.end());
    levels.emplace_back(e[e.size() / 2], name);
  }
  std::stable_sort(levels.begin(), levels.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const double apart = 0.045 * (f.end - f.bottom);
  for (std::size_t k = 0; k < levels.size();) {
    std::string text = levels[k].second;
    double sum = levels[k].first;
    std::size_t n = 1;
    for (; k + n < levels.size() && levels[k + n].first - levels[k + n - 1].first < apart; ++n) {
      text += ", " + levels[k + n].second;
      sum += levels[k + n].first;
    }
    out << "set label " << quoted(text) << " at graph 0.985, first " << std::pow(10, sum / static_cast<double>(n))
        << " right offset 0,0.55 tc rgb '#555555' font ',10'\n";
    k += n;
  }
}

using Style = std::string;

// Points of one look, as a data block each.
std::map<std::pair<int, Style>, std::string> points_of(const Chart& chart, int panel, const Frame& f) {
  std::map<std::pair<int, Style>, std::string> out;  // by layer and look
  int untimed = 0;                                   // drawn in the band, from the right edge on
  for (std::size_t k = 0; k < chart.rows.size(); ++k) {
    const ChartRow& row = chart.rows[k];
    const bool edge = at_edge(row, panel);
    const auto time = panel_time(row, panel);
    const double x =
        time && f.fastest > 0 ? *time / f.fastest : std::pow(10, f.right - 0.02 * (1 + untimed++) * (f.right - f.left));
    const double y = edge ? f.in_band(static_cast<double>(k % 7) / 6) : f.y(*panel_error(row, panel));
    const int layer = (row.method == Method::kAuto ? 2 : 0) + (row.guessed ? 0 : 1);
    std::ostringstream line;
    line << x << " " << y << "\n";
    out[{layer, style_of(row.method, row.order, row.guessed)}] += line.str();
  }
  return out;
}

// From above the fastest, along the front, to the right edge.
std::string front_line(const Chart& chart, int panel, const Frame& f) {
  std::ostringstream out;
  double last = 0;
  for (std::size_t k : panel_front(chart, panel)) {
    const double x = *panel_time(chart.rows[k], panel) / f.fastest;
    if (last == 0) out << x << " " << std::pow(10, f.top) << "\n";
    last = f.y(*panel_error(chart.rows[k], panel));
    out << x << " " << last << "\n";
  }
  if (last > 0) out << std::pow(10, f.right) << " " << last << "\n";
  return out.str();
}

void write_panel(std::ostream& out, const Chart& chart, int panel) {
  const Frame f = frame_of(chart, panel);
  const double left = 0.052 + 0.322 * panel;
  out << "unset label\nunset object\nunset arrow\n"
      << "set lmargin at screen " << left << "\nset rmargin at screen " << left + 0.272
      << "\nset tmargin at screen 0.865\nset bmargin at screen 0.325\n"
      << "set logscale xy\nset border 3\nset grid lc rgb '#e4e4e4'\n"
      << "set xrange [" << std::pow(10, f.left) << ":" << std::pow(10, f.right) << "]\n"
      << "set yrange [" << std::pow(10, f.bottom) << ":" << std::pow(10, f.end) << "]\n"
      << "set label " << quoted(kPanelTitles[panel]) << " at graph 0, graph 1.045 left font ',13'\n";
  const std::string what = panel == 2 ? "time of solve and derivatives" : "time of one solve";
  out << "set xlabel " << quoted(what + " / fastest" + (f.fastest > 0 ? "  (1 = " + number(f.fastest) + " us)" : ""))
      << "\n"
      << "set ylabel " << (panel == 0 ? "'relative error, maximum norm' offset 1.2,0" : "''") << "\n";
  write_tics(out, f);
  const double allowed = chart.allowed * (panel == 2 ? 10 : 1);
  if (std::log10(allowed) > f.bottom && std::log10(allowed) < f.top)
    out << "set arrow from graph 0, first " << allowed << " to graph 1, first " << allowed
        << " nohead dt 2 lw 1.2 lc rgb '#777777'\n";
  if (f.band)
    out << "set object rectangle from graph 0, first " << std::pow(10, f.top)
        << " to graph 1, graph 1 behind fc rgb '#f3e9e9' fs solid noborder\n"
        << "set label 'failed, skipped or unknown' at graph 0.985, graph 1.035 right tc rgb '#993333' font ',10'\n";
  write_levels(out, chart, panel, f);

  const std::string front = front_line(chart, panel, f);
  std::string plots;
  int n = 0;
  const auto add = [&](const std::string& data, const std::string& with) {
    const std::string name = "$panel" + std::to_string(panel) + "_" + std::to_string(n++);
    out << name << " << EOD\n" << data << "EOD\n";
    plots += (plots.empty() ? "plot " : ", ") + name + " using 1:2 with " + with + " notitle";
  };
  if (!front.empty()) add(front, "steps lw 2 lc rgb '#bbbbbb'");
  for (const auto& [look, data] : points_of(chart, panel, f)) add(data, "points " + look.second);
  out << plots << "\n";
}

void write_legend(std::ostream& out) {
  out << "unset label\nunset object\nunset arrow\nunset logscale\nunset border\nunset tics\nunset grid\n"
         "unset xlabel\nunset ylabel\nset lmargin at screen 0.02\nset rmargin at screen 0.99\n"
         "set tmargin at screen 0.215\nset bmargin at screen 0.01\nset xrange [0:1]\nset yrange [0:4]\n";
  std::string plots;
  int n = 0;
  const auto entry = [&](double x, double y, const std::string& text, const std::string& with) {
    out << "set label " << quoted(text) << " at " << x + 0.014 << ", " << y << "\n";
    const std::string name = "$legend" + std::to_string(n++);
    if (with.starts_with("lines"))
      out << name << " << EOD\n" << x - 0.012 << " " << y << "\n" << x + 0.008 << " " << y << "\nEOD\n";
    else
      out << name << " << EOD\n" << x << " " << y << "\nEOD\n";
    plots += (plots.empty() ? "plot " : ", ") + name + " using 1:2 with " + with + " notitle";
  };
  const auto heading = [&](double y, const char* text) {
    out << "set label '" << text << "' at 0, " << y << " tc rgb '#555555'\n";
  };
  heading(3.4, "method");
  const double apart = std::min(0.14, 0.88 / static_cast<double>(std::size(kMethods)));
  double x = 0.12;
  for (Method m : kMethods) {
    const std::string look =
        m == Method::kAuto ? style_of(m, {}, false) : "pt 7 ps 1.6 lc rgb '" + std::string(colour_of(m)) + "'";
    entry(x, 3.4, to_string(m), "points " + look);
    x += apart;
  }
  heading(2.4, "order");
  x = 0.12;
  const auto shape = [&](const std::optional<Order>& o) {
    entry(x, 2.4, o ? to_string(*o) : "none to choose",
          "points pt " + std::to_string(point_of(o, false)) + " ps 1.5 lc rgb '#666666'");
    x += 0.14;
  };
  shape({});
  for (Order o : kOrders) shape(o);
  heading(1.4, "damping");
  entry(0.12, 1.4, "as given in the scene", "points pt 7 ps 1.4 lc rgb '#666666'");
  entry(0.30, 1.4, "guessed, its value at the right; the error is against the scene as given",
        "points pt 6 ps 1.2 lw 1.5 lc rgb '#666666'");
  heading(0.4, "lines");
  entry(0.12, 0.4, "Pareto front of the panel", "lines lw 2 lc rgb '#bbbbbb'");
  entry(0.30, 0.4, "largest error allowed: max(1e-12, 100 eps cond K), derivatives ten times that",
        "lines dt 2 lw 1.2 lc rgb '#777777'");
  out << plots << "\n";
}

std::string script(const Chart& chart) {
  std::ostringstream out;
  out << "set termoption noenhanced\nset multiplot\nset label " << quoted(chart.scene)
      << " at screen 0.02, screen 0.965 font ',15'\n"
      << "set label " << quoted(chart.title + "; condition of K " + scientific(chart.condition))
      << " at screen 0.02, screen 0.925 tc rgb '#555555'\n"
      << "set border 0\nunset tics\nset xrange [0:1]\nset yrange [0:1]\nplot NaN notitle\nset tics nomirror\n";
  for (int panel = 0; panel < 3; ++panel) write_panel(out, chart, panel);
  write_legend(out);
  out << "unset multiplot\n";
  return out.str();
}

}  // namespace

void draw(const Chart& chart, const std::string& base) { draw(script(chart), kWidth, kHeight, base); }

}  // namespace manycontact::cli
