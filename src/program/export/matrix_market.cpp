// Format: https://math.nist.gov/MatrixMarket/formats.html

#include <cstdio>

#include "../files/output_file.hpp"
#include "export.hpp"

namespace manycontact::cli {

namespace {

constexpr int kQuadDigits = 33;  // digits after the first that restore a quadruple-precision number

std::string text_of(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string text_of(const Quad& x) { return x.str(kQuadDigits, std::ios_base::scientific); }

void begin(std::ostream& out, const std::string& kind, const std::vector<std::string>& comments) {
  out << "%%MatrixMarket matrix " << kind << "\n";
  for (const std::string& line : comments) out << "% " << line << "\n";
}

}  // namespace

void write_sparse(const std::string& path, const Eigen::SparseMatrix<double>& A, bool symmetric,
                  const std::vector<std::string>& comments) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  begin(out, symmetric ? "coordinate real symmetric" : "coordinate real general", comments);
  Eigen::SparseMatrix<double> entries = A;
  if (symmetric) entries = A.triangularView<Eigen::Lower>();
  out << A.rows() << " " << A.cols() << " " << entries.nonZeros() << "\n";
  for (int j = 0; j < entries.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(entries, j); it; ++it)
      out << it.row() + 1 << " " << j + 1 << " " << text_of(it.value()) << "\n";
  file.close();
}

template <class S>
void write_dense(const std::string& path, const MatX<S>& x, const std::vector<std::string>& comments) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  begin(out, "array real general", comments);
  out << x.rows() << " " << x.cols() << "\n";
  for (const S& value : x.reshaped()) out << text_of(value) << "\n";
  file.close();
}
template void write_dense(const std::string&, const MatX<double>&, const std::vector<std::string>&);
template void write_dense(const std::string&, const MatX<Quad>&, const std::vector<std::string>&);

}  // namespace manycontact::cli
