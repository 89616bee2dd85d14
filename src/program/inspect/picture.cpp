// `inspect --picture`: the pattern of K in the scene's order, and of its factor L in the order of elimination.

#include <algorithm>

#include "../files/output_file.hpp"
#include "../files/svg.hpp"
#include "../text/table.hpp"
#include "inspect.hpp"

namespace manycontact::cli {

namespace {

enum Colour { kInertia, kContact, kFill, kDamping, kColours };
const std::vector<std::string> kFills{"#2864b4", "#e08214", "#a3a8ae", "#2a9d5c"};

constexpr double kSide = 460, kTop = 96, kLeft = 150, kGap = 130, kStrip = 7, kBottom = 92;
constexpr double kRight = kLeft + kSide + kGap;  // left edge of L
constexpr double kWidth = kRight + kSide + 40, kHeight = kTop + kSide + kBottom;
constexpr double kLabelHeight = 12;

// A block of rows with its name.
struct Block {
  std::string name;
  int first = 0, size = 0;
};

// Rows of an island's K in the scene: the robots' velocities, then the active contacts' rows.
std::vector<int> rows_in_scene(const Scene& scene, const SceneData& data, const Island& island) {
  std::vector<int> rows(static_cast<std::size_t>(island.size()));
  const auto place = [&rows](int in_scene, int in_island, int count) {
    for (int i = 0; i < count; ++i) rows[static_cast<std::size_t>(in_island + i)] = in_scene + i;
  };
  each_velocity_block(scene, island, place);
  each_force_block(scene, data.f_offset, island,
                   [&](int f, int row, int count) { place(scene.nv + f, island.nv + row, count); });
  return rows;
}

// Both triangles; contact rows have a diagonal only where the damping puts one.
long fill_K(const Inspection& x, PatternGrid& grid) {
  long nonzeros = 0;
  for (std::size_t island = 0; island < island_count(x.data); ++island) {
    const KktPattern& p = x.pattern(island);
    const SceneData& solved = data_solved(x.data);
    const std::vector<int> at = rows_in_scene(scene_solved(x.file.scene, x.data), solved, island_of(solved, island));
    for (int col = 0; col < p.size(); ++col)
      for (int k = p.K.p[col]; k < p.K.p[col + 1]; ++k) {
        const int i = p.perm[p.K.i[k]], j = p.perm[col];
        const bool damping = i >= p.nv && j >= p.nv;
        if (damping && x.file.scene.damping == 0) continue;
        const int colour = damping ? kDamping : i >= p.nv || j >= p.nv ? kContact : kInertia;
        grid.add(at[i], at[j], colour);
        if (i != j) grid.add(at[j], at[i], colour);
        nonzeros += i == j ? 1 : 2;
      }
  }
  return nonzeros;
}

// Islands one after the other, each in its order; what is not in K is fill.
long fill_L(const Inspection& x, PatternGrid& grid, std::vector<char>& is_contact) {
  long nonzeros = 0;
  int offset = 0;
  for (std::size_t island = 0; island < island_count(x.data); ++island) {
    const KktPattern& p = x.pattern(island);
    for (int col = 0; col < p.size(); ++col) {
      const bool contact_col = p.perm[col] >= p.nv;
      is_contact.push_back(contact_col);
      grid.add(offset + col, offset + col, contact_col ? (x.file.scene.damping > 0 ? kDamping : kFill) : kInertia);
      for (int k = p.ldl.Lp[col]; k < p.ldl.Lp[col + 1]; ++k) {
        const int row = p.ldl.Li[k];
        const bool mixed = (p.perm[row] >= p.nv) != contact_col;
        grid.add(offset + row, offset + col, p.K.slot(col, row) < 0 ? kFill : mixed ? kContact : kInertia);
      }
    }
    nonzeros += p.ldl.nonzeros() + p.size();
    offset += p.size();
  }
  return nonzeros;
}

std::vector<Block> robot_blocks(const Inspection& x) {
  std::vector<Block> blocks;
  for (const RobotGroup& group : x.file.robot_groups) {
    if (group.count == 0) continue;
    const Robot& robot = x.file.scene.robots[group.first];
    const double height = kSide * robot.model->nv / std::max(1, x.file.scene.nv);
    if (height >= kLabelHeight || group.count == 1)
      for (int k = 0; k < group.count; ++k)
        blocks.push_back(
            {x.file.scene.robots[group.first + k].name, robot.idx_v + k * robot.model->nv, robot.model->nv});
    else
      blocks.push_back({group_name(group), robot.idx_v, group.count * robot.model->nv});
  }
  return blocks;
}

std::vector<Block> contact_blocks(const Inspection& x) {
  std::vector<Block> blocks;
  for (const ContactGroup& group : x.file.contact_groups) {
    Block block{group.copied && group.count > 1 ? group.name + " x" + std::to_string(group.count) : group.name, -1, 0};
    for (int c = group.first; c < group.first + group.count; ++c) {
      if (x.data.f_offset[c] < 0) continue;
      if (block.first < 0) block.first = x.file.scene.nv + x.data.f_offset[c];
      block.size += x.file.scene.contacts[c].rows();
    }
    if (block.size > 0) blocks.push_back(block);
  }
  return blocks;
}

// Names left of the panel, if there is enough space, and lines between the blocks.
void draw_blocks(std::ostream& svg, const std::vector<Block>& blocks, int n) {
  constexpr int kLongest = 20;
  std::vector<std::string> names;
  for (const Block& b : blocks) names.push_back(b.name);
  names = shortened(names, kLongest);
  double below = -1;  // lower end of the last name
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Block& b = blocks[k];
    const double top = kTop + kSide * b.first / n, height = kSide * b.size / n, middle = top + height / 2;
    if (b.first > 0 && height >= 4) {
      draw_line(svg, kLeft, top, kLeft + kSide, top);
      draw_line(svg, kLeft + kSide * b.first / n, kTop, kLeft + kSide * b.first / n, kTop + kSide);
    }
    if (middle - kLabelHeight / 2 < below) continue;
    below = middle + kLabelHeight / 2;
    draw_text(svg, kLeft - kStrip - 6, middle + 4, names[k], "end", 11);
  }
}

// A strip next to a panel that shows which rows are velocities and which are contact rows.
void draw_strip(std::ostream& svg, double left, const std::vector<char>& is_contact) {
  const double n = static_cast<double>(is_contact.size());
  for (std::size_t i = 0; i < is_contact.size();) {
    std::size_t end = i;
    while (end < is_contact.size() && is_contact[end] == is_contact[i]) ++end;
    const double top = kTop + kSide * double(i) / n, height = kSide * double(end - i) / n;
    if (height >= 0.2)
      svg << "<rect x=\"" << number(left - kStrip - 2, 6) << "\" y=\"" << number(top, 6) << "\" width=\"" << kStrip
          << "\" height=\"" << number(height, 6) << "\" fill=\"" << kFills[is_contact[i] ? kContact : kInertia]
          << "\"/>\n";
    i = end;
  }
}

void draw_axes(std::ostream& svg, double left, int n, const std::string& title, const std::string& size,
               const std::string& row, const std::string& column) {
  draw_text(svg, left + kSide / 2, kTop - 38, title, "middle", 14);
  draw_text(svg, left + kSide / 2, kTop - 22, size, "middle", 12);
  draw_text(svg, left, kTop - 5, "1", "start", 10);
  draw_text(svg, left + kSide, kTop - 5, std::to_string(n), "end", 10);
  draw_text(svg, left + kSide + 4, kTop + kSide, std::to_string(n), "start", 10);
  draw_text(svg, left + kSide / 2, kTop + kSide + 16, column, "middle", 11);
  svg << "<text transform=\"translate(" << number(left + kSide + 14, 6) << " " << number(kTop + kSide / 2, 6)
      << ") rotate(90)\" text-anchor=\"middle\" font-size=\"11\">" << escaped(row) << "</text>\n";
}

void draw_legend(std::ostream& svg, const Inspection& x, int cells, int n) {
  double y = kTop + kSide + 44;
  double left = kLeft;
  const auto entry = [&](int colour, const std::string& text) {
    draw_box(svg, left, y - 10, 12, 12, kFills[static_cast<std::size_t>(colour)]);
    draw_text(svg, left + 18, y, text, "start", 12);
    left += 32 + 6.6 * static_cast<double>(text.size());
  };
  entry(kInertia, "inertia M: robots' velocities");
  entry(kContact, "contact rows J");
  entry(kFill, "fill: in L, not in K");
  if (x.file.scene.damping > 0) entry(kDamping, "damping -delta");
  if (cells < n)
    draw_text(svg, kLeft, y += 22,
              "a cell represents " + number(double(n) / cells) +
                  " rows and columns, in the colour of most "
                  "of its entries; empty where all are zero",
              "start", 11);
}

// "contacts-early order" or, when islands differ, "each island in its order".
std::string order_text(const Inspection& x) {
  const Order first = choice_of(x.data, 0).order;
  bool same = true;
  for (std::size_t i = 1; i < island_count(x.data); ++i) same = same && choice_of(x.data, i).order == first;
  return same ? to_string(first) + " order" : "each island in the order chosen for it";
}

void draw(std::ostream& svg, const Inspection& x) {
  const Scene& scene = x.file.scene;
  const int n = scene.nv + static_cast<int>(data_solved(x.data).f.size());
  svg << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 "
      << kWidth << " " << kHeight << "\" width=\"" << kWidth << "\" height=\"" << kHeight
      << "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" fill=\"#1f2730\">\n";
  svg << "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  draw_text(svg, kWidth / 2, 30,
            "Scene " + scene.name + ": " + count(scene.nv, "velocity") + ", " + count(x.data.f.size(), "contact row") +
                ", " + count(static_cast<long>(island_count(x.data)), "island"),
            "middle", 17);
  if (n > 0) {
    PatternGrid K(n, kColours), L(n, kColours);
    std::vector<char> rows_K(static_cast<std::size_t>(n), 1), rows_L;
    std::fill(rows_K.begin(), rows_K.begin() + scene.nv, 0);
    const long nonzeros_K = fill_K(x, K), nonzeros_L = fill_L(x, L, rows_L);
    draw_box(svg, kLeft, kTop, kSide, kSide, "#ffffff");
    draw_box(svg, kRight, kTop, kSide, kSide, "#ffffff");
    std::vector<Block> blocks = robot_blocks(x);
    const std::vector<Block> contacts = contact_blocks(x);
    blocks.insert(blocks.end(), contacts.begin(), contacts.end());
    draw_blocks(svg, blocks, n);
    K.draw(svg, kLeft, kTop, kSide, kFills);
    L.draw(svg, kRight, kTop, kSide, kFills);
    draw_strip(svg, kLeft, rows_K);
    draw_strip(svg, kRight, rows_L);
    const std::string size = "n = " + std::to_string(n) + ", ";
    draw_axes(svg, kLeft, n, "K = [M J'; J -delta I]", size + count(nonzeros_K, "non-zero") + " in both triangles",
              "row", "column: robots, then contacts");
    draw_axes(svg, kRight, n, "L of P K P' = L D L', " + order_text(x), size + count(nonzeros_L, "non-zero"), "row",
              "column, as eliminated");
    draw_legend(svg, x, K.cells(), n);
  }
  svg << "</svg>\n";
}

}  // namespace

void write_picture(const Inspection& inspection, const std::string& path) {
  OutputFile svg(path, "--picture");
  draw(svg.stream(), inspection);
  svg.close();
}

}  // namespace manycontact::cli
