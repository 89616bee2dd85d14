#include "gnuplot.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "../text/table.hpp"
#include "manycontact/io/input_error.hpp"
#include "output_file.hpp"

namespace manycontact::cli {

namespace {

// Whether gnuplot's output, SVG or PNG, is complete. Gnuplot does not report a full disk.
bool is_whole(const std::string& path) {
  constexpr std::streamoff kEnd = 16;
  std::ifstream file(path, std::ios::binary);
  std::string end(kEnd, '\0');
  file.seekg(-kEnd, std::ios::end).read(end.data(), kEnd);
  return end.find("</svg>") != std::string::npos || end.find("IEND") != std::string::npos;
}

}  // namespace

bool gnuplot_available() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/gnuplot").c_str(), X_OK) == 0) return true;
  return false;
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (char c : printable(text)) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

void draw(const std::string& script, int width, int height, const std::string& base) {
  const std::string size = " size " + std::to_string(width) + "," + std::to_string(height);
  const std::string look = size + " font 'DejaVu Sans,12' background rgb 'white'\n";
  std::string text = "set encoding utf8\n";
  std::deque<OutputFile> pictures;
  for (const std::string kind : {"svg", "png"}) {
    const OutputFile& picture = pictures.emplace_back(base + "." + kind);
    if (kind == "svg")
      text += "set terminal svg" + look;
    else  // a gnuplot without cairo draws plainer
      text += "if (!strstrt(GPVAL_TERMINALS, 'pngcairo')) set terminal png" + size +
              "\nif (strstrt(GPVAL_TERMINALS, 'pngcairo')) set terminal pngcairo" + look;
    text += "set output " + quoted(picture.temporary().empty() ? picture.path() : picture.temporary()) + "\n" + script +
            "unset output\nreset\n";
  }
  std::FILE* pipe = popen("gnuplot 2>/dev/null", "w");
  if (!pipe) throw std::runtime_error(std::string("gnuplot cannot be started: ") + std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), pipe) == text.size();
  if (pclose(pipe) != 0 || !written) throw std::runtime_error("gnuplot could not draw " + base + ".svg");
  for (OutputFile& picture : pictures) {
    if (!picture.temporary().empty() && !is_whole(picture.temporary()))
      throw InputError(picture.path(), 1, "cannot be written whole, expected a disk with space for it");
    picture.close();
  }
}

}  // namespace manycontact::cli
