// Matrix Market files: https://math.nist.gov/MatrixMarket/formats.html

#include <cstdio>

#include "../files/output_file.hpp"
#include "export.hpp"

namespace manycontact::cli {

namespace {

constexpr int kQuadDigits = 33;  // digits that follow the first: they restore a number of quadruple precision

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

template <class S>
void write_array(const std::string& path, const MatX<S>& x, const std::vector<std::string>& comments) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  begin(out, "array real general", comments);
  out << x.rows() << " " << x.cols() << "\n";
  for (const S& value : x.reshaped()) out << text_of(value) << "\n";
  file.close();
}

}  // namespace

void write_symmetric(const std::string& path, const Eigen::SparseMatrix<double>& K,
                     const std::vector<std::string>& comments) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  begin(out, "coordinate real symmetric", comments);
  const Eigen::SparseMatrix<double> lower = K.triangularView<Eigen::Lower>();
  out << K.rows() << " " << K.cols() << " " << lower.nonZeros() << "\n";
  for (int j = 0; j < lower.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, j); it; ++it)
      out << it.row() + 1 << " " << j + 1 << " " << text_of(it.value()) << "\n";
  file.close();
}

void write_sparse(const std::string& path, const Eigen::MatrixXd& b, const std::vector<std::string>& comments) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  begin(out, "coordinate real general", comments);
  out << b.rows() << " " << b.cols() << " " << (b.array() != 0).count() << "\n";
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    for (Eigen::Index i = 0; i < b.rows(); ++i)
      if (b(i, j) != 0) out << i + 1 << " " << j + 1 << " " << text_of(b(i, j)) << "\n";
  file.close();
}

void write_dense(const std::string& path, const Eigen::MatrixXd& b, const std::vector<std::string>& comments) {
  write_array<double>(path, b, comments);
}

void write_dense(const std::string& path, const MatX<Quad>& x, const std::vector<std::string>& comments) {
  write_array<Quad>(path, x, comments);
}

}  // namespace manycontact::cli
