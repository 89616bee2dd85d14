#pragma once
// What `./run bench` writes of the runs: charts, tables, a page.

#include <string>
#include <utility>
#include <vector>

#include "../results.hpp"

namespace manycontact::bench {

/// What a program computes otherwise than ours does; empty for ours.
std::string otherwise(const std::string& program);

/// One line of a chart, by (x, y); colour: of its program, dashes: which of its tasks.
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

/// Time per robot, per link, over contacts; memory; ratios to ours. Figures without a line are left out.
std::vector<Figure> figures(const std::vector<Run>& runs);
/// Draws base.svg and base.png. Throws std::runtime_error.
void draw(const Figure& figure, const std::vector<Run>& runs, const std::string& base);

/// Markdown. Times of a robot in us, and in units of plain ldl_numeric on its K.
std::string table_of_robots(const std::vector<Run>& runs);
std::string table_of_parts(const Run& ours);
/// Of a robot without contacts: times of each algorithm by program, in us.
std::string table_of_bodies(const std::vector<Run>& runs);
/// Exponents fitted to time over robots and over links, beside theory.
std::string table_of_exponents(const std::vector<Run>& runs);
/// Times of the portable build over those of the native one; empty where only one was run.
std::string table_of_builds(const std::vector<Run>& runs);

void write_page(const std::vector<Run>& runs, const std::vector<Figure>& drawn, const std::string& path);

}  // namespace manycontact::bench
