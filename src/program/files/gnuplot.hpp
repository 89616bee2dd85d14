#pragma once
// Gnuplot, run as a program of its own.

#include <string>

namespace manycontact::cli {

bool gnuplot_available();
inline constexpr const char* kNoGnuplot = "gnuplot is not installed (Debian: gnuplot-nox), no charts are drawn";

/// A text in gnuplot's single quotes, in which it runs no shell commands.
std::string quoted(const std::string& text);

/// Draws `script`, what follows gnuplot's `set terminal` and `set output`, into base.svg and base.png of `width` by
/// `height` pixels. Throws InputError when these cannot be written, std::runtime_error when gnuplot fails.
void draw(const std::string& script, int width, int height, const std::string& base);

}  // namespace manycontact::cli
