#include "gnuplot.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "manycontact/io/input_error.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

void check_writable(const std::string& path) {
  if (!std::ofstream(path, std::ios::app)) throw InputError(path, 1, "cannot be written");
}

}  // namespace

bool gnuplot_available() { return std::system("command -v gnuplot >/dev/null 2>&1") == 0; }

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (char c : printable(text)) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

void draw(const std::string& script, int width, int height, const std::string& base) {
  const std::string size = " size " + std::to_string(width) + "," + std::to_string(height);
  const std::string look = size + " font 'DejaVu Sans,12' background rgb 'white'\n";
  std::string text = "set encoding utf8\n";
  for (const std::string kind : {"svg", "png"}) {
    check_writable(base + "." + kind);
    if (kind == "svg")
      text += "set terminal svg" + look;
    else  // a gnuplot without cairo draws plainer
      text += "if (!strstrt(GPVAL_TERMINALS, 'pngcairo')) set terminal png" + size +
              "\nif (strstrt(GPVAL_TERMINALS, 'pngcairo')) set terminal pngcairo" + look;
    text += "set output " + quoted(base + "." + kind) + "\n" + script + "unset output\nreset\n";
  }
  std::FILE* pipe = popen("gnuplot 2>/dev/null", "w");
  if (!pipe) throw std::runtime_error("gnuplot cannot be started");
  const bool written = std::fwrite(text.data(), 1, text.size(), pipe) == text.size();
  if (pclose(pipe) != 0 || !written) throw std::runtime_error("gnuplot could not draw " + base + ".svg");
}

}  // namespace manycontact::cli
