#include "batch.hpp"

#include <cstdlib>
#include <iostream>
#include <memory>

#include "../command/command.hpp"
#include "../command/progress.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "npy.hpp"
#include "part.hpp"

namespace manycontact::cli {

namespace {

constexpr int kStatuses = 5;

/// The data of a run in one process. part: the islands of this process, or the scene if processes split the states.
struct BatchRun {
  ScenePart part;
  std::string name;
  bool islands = false;
  std::unique_ptr<NpyInput> states;
  std::vector<NpyOutput> out;  // file with rows [a f status], and file of derivatives if requested
  std::unique_ptr<BatchData> data;
  std::int64_t count = 0, block = 0;  // numbers of states: in all, per block

  bool derivatives() const { return out.size() > 1; }
  int in_size() const { return part.nq + part.nv + part.nu; }
  int out_size() const { return part.nv + part.nf + 1; }
  std::int64_t derivative_rows() const { return part.nv + part.nf; }
  std::int64_t derivative_cols() const { return 2 * std::int64_t{part.nv} + part.nu; }
};

/// One block of states. `in` and `out` refer to coordinates of the whole scene, the other members to those of the part.
struct StateBlock {
  BatchMatrix in, out, q, v, u, a, f, d;
  std::vector<Status> status;
  std::vector<double> row;  // one row of the file of derivatives

  void resize(const BatchRun& run, std::int64_t n) {
    const Scene& scene = run.part.scene;
    const std::int64_t nf = run.part.own_nf;
    in.resize(n, run.in_size());
    out.setZero(n, run.out_size());
    q.resize(n, scene.nq);
    v.resize(n, scene.nv);
    u.resize(n, scene.nu);
    a.resize(n, scene.nv);
    f.resize(n, nf);
    if (run.derivatives()) d.resize(n, (scene.nv + nf) * (2 * std::int64_t{scene.nv} + scene.nu));
    status.resize(n);
    row.resize(run.derivative_cols());
  }
};

std::string derivatives_path(const std::string& out) {
  const std::string suffix = ".npy";
  return (out.ends_with(suffix) ? out.substr(0, out.size() - suffix.size()) : out) + ".derivatives.npy";
}

// Returns the number of states per block: 1 to 4096 states in at most 64 MB. If several processes split the states,
// there are at least four blocks per process.
std::int64_t block_size(const BatchRun& run, int processes) {
  const Scene& scene = run.part.scene;
  std::int64_t numbers = 2 * (std::int64_t{run.in_size()} + run.out_size());
  if (run.derivatives())
    numbers += (std::int64_t{scene.nv} + run.part.own_nf) * (2 * std::int64_t{scene.nv} + scene.nu);
  constexpr std::int64_t kBytes = 64 << 20, kMost = 4096;
  const std::int64_t block = std::clamp(kBytes / (8 * numbers), std::int64_t{1}, kMost);
  if (run.islands || processes == 1) return block;
  const std::int64_t shares = 4 * std::int64_t{processes};
  return std::clamp((run.count + shares - 1) / shares, std::int64_t{1}, block);
}

BatchRun set_up(const Arguments& arguments, const Communicator& communicator) {
  const std::string path = scene_operand(arguments), states = arguments.required("--states"),
                    out = arguments.required("--out");
  const int threads = arguments.integer("--threads", 1, kMostThreads, communicator.size() > 1 ? 1 : 0);
  const Options options = solver_options(arguments);
  BatchRun run;
  run.islands = arguments.has("--islands");
  if (run.islands && options.method == Method::kDenseSchur)
    throw UsageError(
        "--islands splits the scene, but method dense-schur solves the scene as one system: omit one of them");
  check_files(arguments, {path, states}, {"--out"});
  if (arguments.has("--derivatives")) check_unread("--derivatives", derivatives_path(out), {path, states});
  const SceneFile file = load_scene(path);
  check_files(arguments, file.files, {"--out"});
  if (arguments.has("--derivatives")) check_unread("--derivatives", derivatives_path(out), file.files);
  run.name = file.scene.name;
  run.part = run.islands ? part_of(file.scene, communicator.rank(), communicator.size()) : part_of(file.scene, 0, 1);
  run.states = std::make_unique<NpyInput>(states);
  const std::vector<std::int64_t>& shape = run.states->shape();
  if (shape.size() != 2 || shape[1] != run.in_size())
    throw InputError(states, 1,
                     "has shape (" + std::to_string(shape[0]) + ", " + std::to_string(shape[1]) +
                         (shape.size() > 2 ? ", " + std::to_string(shape[2]) : "") + "), expected (states, " +
                         std::to_string(run.in_size()) + "): q has " + std::to_string(run.part.nq) + " numbers, v " +
                         std::to_string(run.part.nv) + " and u " + std::to_string(run.part.nu) + " in " + path);
  run.count = shape[0];
  run.out.emplace_back(out, std::vector<std::int64_t>{run.count, run.out_size()});
  if (arguments.has("--derivatives"))
    run.out.emplace_back(derivatives_path(out),
                         std::vector<std::int64_t>{run.count, run.derivative_rows(), run.derivative_cols()});
  run.block = block_size(run, communicator.size());
  run.data = std::make_unique<BatchData>(run.part.scene, threads, options);
  return run;
}

// Writes the part's derivatives at the states first, first+1, ... into the rows of the whole scene's file.
void write_derivatives(BatchRun& run, std::int64_t first, StateBlock& b) {
  const Scene& own = run.part.scene;
  NpyOutput& file = run.out[1];
  const std::int64_t rows = run.derivative_rows(), cols = run.derivative_cols();
  if (b.d.cols() == rows * cols) {  // the part is the whole scene
    file.write(first * rows * cols, b.d.size(), b.d.data());
    return;
  }
  const std::int64_t own_cols = 2 * std::int64_t{own.nv} + own.nu;
  const auto write_rows = [&](const double* D, std::int64_t state, const std::vector<Segment>& segments,
                              int whole_first, int own_first) {
    for (const Segment& s : segments)
      for (int k = 0; k < s.count; ++k) {
        const double* from = D + (own_first + s.own + k) * own_cols;
        std::ranges::fill(b.row, 0.0);
        put(run.part.v, from, b.row.data());
        put(run.part.v, from + own.nv, b.row.data() + run.part.nv);
        put(run.part.u, from + 2 * std::int64_t{own.nv}, b.row.data() + 2 * std::int64_t{run.part.nv});
        file.write((state * rows + whole_first + s.whole + k) * cols, cols, b.row.data());
      }
  };
  for (Eigen::Index k = 0; k < b.d.rows(); ++k) {
    write_rows(b.d.row(k).data(), first + k, run.part.v, 0, 0);
    write_rows(b.d.row(k).data(), first + k, run.part.f, run.part.nv, own.nv);
  }
}

void work_on(BatchRun& run, std::int64_t first, std::int64_t n, StateBlock& b) {
  b.resize(run, n);
  run.states->read(first * run.in_size(), b.in.size(), b.in.data());
  for (std::int64_t k = 0; k < n; ++k) {
    const double* row = b.in.row(k).data();
    take(run.part.q, row, b.q.row(k).data());
    take(run.part.v, row + run.part.nq, b.v.row(k).data());
    take(run.part.u, row + run.part.nq + run.part.nv, b.u.row(k).data());
  }
  const BatchStates states{b.q, b.v, b.u};
  if (run.derivatives()) {
    differentiate_batch(run.part.scene, states, *run.data, b.a, b.f, b.d, b.status);
    write_derivatives(run, first, b);
  } else {
    solve_batch(run.part.scene, states, *run.data, b.a, b.f, b.status);
  }
  for (std::int64_t k = 0; k < n; ++k) {
    put(run.part.v, b.a.row(k).data(), b.out.row(k).data());
    put(run.part.f, b.f.row(k).data(), b.out.row(k).data() + run.part.nv);
  }
}

// Computes the blocks and returns the number of states per status. If processes split the states, each computes every
// size()-th block. If they split the islands, each computes all blocks, and rank 0 writes the output.
std::vector<std::int64_t> work(BatchRun& run, Communicator& communicator) {
  std::vector<std::int64_t> counts(kStatuses, 0);
  StateBlock b;
  std::vector<int> status;
  Progress progress("states", static_cast<double>(run.count));
  const std::int64_t blocks = (run.count + run.block - 1) / run.block;
  const bool writes = !run.islands || communicator.rank() == 0;
  for (std::int64_t k = run.islands ? 0 : communicator.rank(); k < blocks; k += run.islands ? 1 : communicator.size()) {
    const std::int64_t first = k * run.block, n = std::min(run.block, run.count - first);
    work_on(run, first, n, b);
    status.assign(n, 0);
    for (std::int64_t i = 0; i < n; ++i) status[i] = static_cast<int>(b.status[i]);
    if (run.islands) {
      communicator.collect(b.out.data(), b.out.size());
      communicator.largest(status);
    }
    if (writes) {
      for (std::int64_t i = 0; i < n; ++i) b.out(i, run.out_size() - 1) = status[i], ++counts[status[i]];
      run.out[0].write(first * run.out_size(), b.out.size(), b.out.data());
    }
    if (communicator.rank() == 0) progress.update(static_cast<double>(first + n));
  }
  return counts;
}

void print_summary(const BatchRun& run, const std::vector<std::int64_t>& counts) {
  std::vector<std::string> parts;
  for (int k = 0; k < kStatuses; ++k)
    if (counts[k] > 0) parts.push_back(std::to_string(counts[k]) + " " + to_string(static_cast<Status>(k)));
  std::cout << printable(run.name) << ": " << run.count << (run.count == 1 ? " state" : " states")
            << (parts.empty() ? "" : ": ") << join(parts, parts.size()) << "\n";
}

}  // namespace

int run_batch(const Arguments& arguments) {
  Communicator communicator;
  return run_batch(arguments, communicator);
}

int run_batch(const Arguments& arguments, Communicator& communicator) {
  BatchRun run;
  // Runs a part of this function that may fail in some of the processes only. Then all processes end.
  const auto together = [&communicator](auto&& step) {
    std::exception_ptr error;
    try {
      step();
    } catch (...) {
      error = std::current_exception();
    }
    communicator.agree(error);
  };
  together([&] { run = set_up(arguments, communicator); });
  together([&] {
    for (NpyOutput& out : run.out)
      if (communicator.rank() == 0) out.create();
  });
  communicator.begin();
  for (NpyOutput& out : run.out) {
    const std::string name = communicator.told(communicator.rank() == 0 ? out.temporary() : "");
    if (communicator.rank() > 0) out.join(name);
  }
  std::vector<std::int64_t> counts = work(run, communicator);
  for (NpyOutput& out : run.out) out.finish();
  communicator.sum(counts);  // also waits for all processes
  // The file of solutions comes last, so that the file of derivatives is complete if it exists.
  if (communicator.rank() == 0)
    for (auto out = run.out.rbegin(); out != run.out.rend(); ++out) out->publish();
  communicator.end();
  if (communicator.rank() == 0) print_summary(run, counts);
  int worst = 0;
  for (int k = 0; k < kStatuses; ++k)
    if (counts[k] > 0) worst = k;
  return worst <= static_cast<int>(Status::kInconsistent) ? kExitOk : kExitUnsound;
}

bool under_mpirun() { return std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE"); }

}  // namespace manycontact::cli
