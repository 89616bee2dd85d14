#include <chrono>
#include <span>

#include "in_use.hpp"
#include "manycontact/dynamics/batch.hpp"

namespace manycontact::python {

namespace {

struct Rows {  // A matrix with one row per state. A state with numbers that are not finite gets the status kFailed.
  Doubles array;
  ConstBatchRows part(Eigen::Index first, Eigen::Index count) const {
    const Eigen::Index cols = array.shape(1);
    return Eigen::Map<const BatchMatrix, 0, Eigen::OuterStride<>>(array.data() + first * cols, count, cols,
                                                                  Eigen::OuterStride<>(cols));
  }
};

Rows rows_of(const char* function, const char* name, py::handle source, Eigen::Index states = -1) {
  Rows rows{as_doubles(source)};
  const std::string what = std::string(function) + ": " + name;
  if (!rows.array || rows.array.ndim() != 2) throw py::value_error(what + " has to be a matrix, one state per row");
  if (states >= 0 && rows.array.shape(0) != states)
    throw py::value_error(what + " has " + std::to_string(rows.array.shape(0)) + " rows, Q has " +
                          std::to_string(states));
  return rows;
}

struct NewRows {
  NewRows(Eigen::Index rows, Eigen::Index cols) : array({rows, cols}) {}
  BatchRows part(Eigen::Index first, Eigen::Index count) {
    const Eigen::Index cols = array.shape(1);
    return Eigen::Map<BatchMatrix, 0, Eigen::OuterStride<>>(array.mutable_data() + first * cols, count, cols,
                                                            Eigen::OuterStride<>(cols));
  }
  py::array_t<double> array;
};

constexpr Eigen::Index kFirstChunk = 256;
constexpr auto kShort = std::chrono::milliseconds(50), kLong = std::chrono::milliseconds(200);

// Calls work(first, count) for chunks of states that take about 0.1 s each, and handles Ctrl-C between the chunks.
// Throws ValueError while another thread uses the batch.
template <class Work>
void run_batch(const BatchData& batch, Eigen::Index states, Work&& work) {
  const InUse turn(batch, "BatchData");
  const py::gil_scoped_release unlocked;
  Eigen::Index chunk = kFirstChunk, first = 0;
  do {
    const Eigen::Index count = std::min(chunk, states - first);
    const auto start = std::chrono::steady_clock::now();
    work(first, count);
    const auto took = std::chrono::steady_clock::now() - start;
    if (took < kShort) chunk *= 2;
    if (took > kLong) chunk = std::max<Eigen::Index>(chunk / 2, 1);
    first += count;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  } while (first < states);
}

using Numbers = py::array_t<double>;
using Worth = py::array_t<std::int8_t>;
struct Solutions {
  Numbers a, f, derivatives;
  Worth status;
};

Solutions batch_of_solutions(const Scene& scene, py::handle q, py::handle v, py::handle u, BatchData& batch,
                             bool derivatives) {
  const char* name = derivatives ? "differentiate_batch" : "solve_batch";
  const Rows Q = rows_of(name, "Q", q);
  const Eigen::Index n = Q.array.shape(0), nf = force_rows(scene, batch), rows = scene.nv + nf;
  const Rows V = rows_of(name, "V", v, n), U = rows_of(name, "U", u, n);
  NewRows A(n, scene.nv), F(n, nf), D(n, derivatives ? rows * (2 * scene.nv + scene.nu) : 0);
  std::vector<Status> status(static_cast<std::size_t>(n));
  run_batch(batch, n, [&](Eigen::Index k, Eigen::Index count) {
    const BatchStates states{Q.part(k, count), V.part(k, count), U.part(k, count)};
    const auto worth = std::span(status).subspan(static_cast<std::size_t>(k), static_cast<std::size_t>(count));
    if (derivatives)
      differentiate_batch(scene, states, batch, A.part(k, count), F.part(k, count), D.part(k, count), worth);
    else
      solve_batch(scene, states, batch, A.part(k, count), F.part(k, count), worth);
  });
  if (derivatives) D.array = D.array.reshape({n, rows, Eigen::Index(2 * scene.nv + scene.nu)});
  return {A.array, F.array, D.array, numbers_of(status)};
}

struct Products {
  Numbers q, v, u, w;
  Worth status;
};

Products batch_of_products(const Scene& scene, py::handle q, py::handle v, py::handle u, py::handle wa, py::handle wf,
                           BatchData& batch) {
  const char* name = "vjp_batch";
  const Rows Q = rows_of(name, "Q", q);
  const Eigen::Index n = Q.array.shape(0);
  const Rows V = rows_of(name, "V", v, n), U = rows_of(name, "U", u, n);
  const Rows WA = rows_of(name, "WA", wa, n), WF = rows_of(name, "WF", wf, n);
  NewRows WQ(n, scene.nv), WV(n, scene.nv), WU(n, scene.nu),
      WW(n, static_cast<Eigen::Index>(6 * scene.wrenches.size()));
  std::vector<Status> status(static_cast<std::size_t>(n));
  run_batch(batch, n, [&](Eigen::Index k, Eigen::Index count) {
    vjp_batch(scene, {Q.part(k, count), V.part(k, count), U.part(k, count)}, WA.part(k, count), WF.part(k, count),
              batch, WQ.part(k, count), WV.part(k, count), WU.part(k, count), WW.part(k, count),
              std::span(status).subspan(static_cast<std::size_t>(k), static_cast<std::size_t>(count)));
  });
  return {WQ.array, WV.array, WU.array, WW.array, numbers_of(status)};
}

void add_batch_data(py::module_& m) {
  using Batch = std::shared_ptr<BatchData>;
  shared<BatchData>(m)
      .def(py::init([](const Scene& scene, int threads, const Options& options) {
        return std::make_shared<BatchData>(scene, checked_threads(threads), options);
      }))
      .handle<Batch>(
          "options", [](const Batch& b) -> const Options& { return b->options; },
          [](const Batch& b, const Options& options) { b->options = options; })
      .property(
          "active", [](py::object self) { return flags_view(self.cast<BatchData&>().active, self); },
          [](BatchData& b, py::handle values) { set_flags("BatchData.active", values, b.active); }, "wrenches",
          [](py::object self) { return wrenches_view(self.cast<BatchData&>().wrenches, self); },
          [](BatchData& b, py::handle values) { set_wrenches("BatchData.wrenches", values, b.wrenches); });
}

void add_batch_functions(py::module_& m) {
  def(m, "solve_batch", [](const Scene& scene, py::object Q, py::object V, py::object U, BatchData& batch) {
    const Solutions s = batch_of_solutions(scene, Q, V, U, batch, false);
    return std::make_tuple(s.a, s.f, s.status);
  });
  def(m, "differentiate_batch", [](const Scene& scene, py::object Q, py::object V, py::object U, BatchData& batch) {
    const Solutions s = batch_of_solutions(scene, Q, V, U, batch, true);
    return std::make_tuple(s.a, s.f, s.derivatives, s.status);
  });
  def(m, "vjp_batch",
      [](const Scene& scene, py::object Q, py::object V, py::object U, py::object WA, py::object WF, BatchData& batch) {
        const Products p = batch_of_products(scene, Q, V, U, WA, WF, batch);
        return std::make_tuple(p.q, p.v, p.u, p.status);
      });
  def(m, "vjp_batch_with_wrenches",
      [](const Scene& scene, py::object Q, py::object V, py::object U, py::object WA, py::object WF, BatchData& batch) {
        const Products p = batch_of_products(scene, Q, V, U, WA, WF, batch);
        return std::make_tuple(p.q, p.v, p.u, p.w, p.status);
      });
}

}  // namespace

void add_batches(py::module_& m) {
  add_batch_data(m);
  add_batch_functions(m);
}

}  // namespace manycontact::python
