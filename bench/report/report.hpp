#pragma once
// The charts, tables and page that `./run bench` writes from the runs.

#include <string>
#include <utility>
#include <vector>

#include "../results.hpp"

namespace manycontact::bench {

/// Returns what a program computes differently from ours; empty for ours.
std::string otherwise(const std::string& program);

/// One line of a chart, through (x, y). Its colour shows the program, its dashes the task.
struct Line {
  std::string label;
  const Run* run;
  int task;
  std::vector<std::pair<double, double>> points;
};

struct Panel {
  std::string title, x, y;
  std::vector<Line> lines;
};

struct Figure {
  std::string file, title;
  std::vector<Panel> panels;
};

/// Returns figures of time per robot, per link, over contacts; memory; ratios to ours. Empty figures are left out.
std::vector<Figure> figures(const std::vector<Run>& runs);
/// Writes the figures, and what the programs compute differently, as JSON for draw.py. Throws std::runtime_error.
void write_figures(const std::vector<Figure>& figures, const std::vector<Run>& runs, const std::string& path);

/// Return Markdown. Times of a robot are in us, and in units of plain ldl_numeric on its K.
std::string table_of_robots(const std::vector<Run>& runs);
std::string table_of_parts(const Run& ours);
/// Returns times of each algorithm of one robot by program, in us.
std::string table_of_one(const std::vector<Run>& runs);
/// Returns exponents fitted to time over robots and over links, next to theory.
std::string table_of_exponents(const std::vector<Run>& runs);

void write_page(const std::vector<Run>& runs, const std::vector<Figure>& drawn, const std::string& path);

}  // namespace manycontact::bench
