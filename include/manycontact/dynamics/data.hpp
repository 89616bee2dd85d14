#pragma once
// The variable part of a scene: everything `solve` computes and keeps. One per thread; the Scene stays constant.

#include <map>
#include <memory>
#include <optional>

#include "manycontact/algorithm/crba.hpp"
#include "manycontact/dynamics/derivative_data.hpp"
#include "manycontact/dynamics/report.hpp"
#include "manycontact/kkt/dense.hpp"
#include "manycontact/kkt/schur.hpp"
#include "manycontact/kkt/system.hpp"
#include "manycontact/sparse/cholmod.hpp"
#include "manycontact/sparse/dependent_rows.hpp"

namespace manycontact {

/// One robot's kinematics and dynamics terms, in its tree frame.
struct RobotData {
  explicit RobotData(const Model& model);
  Kinematics<double> kin;           // by evaluate: at q, v, with kin.a the bias accelerations
  std::vector<Inertia<double>> Yc;  // by evaluate: composite inertias
  std::vector<Vec6<double>> f;      // scratch of inverse_dynamics
  std::vector<double> M;            // by evaluate: packed inertia (algorithm/crba.hpp)
  Eigen::VectorXd h;                // by evaluate: nv, Coriolis, centrifugal, gravity
};

/// Which factor of the island's K is at hand.
enum class Factor { kNone, kLdl, kDependent, kCholmod, kSupernodal, kDense, kDenseSchur };

/// One island's system and its factor.
struct IslandData {
  Island island;
  IslandSupport support;
  std::vector<std::span<const double>> M, J;  // views of the robots' M and the contacts' J
  KktSystem system;
  Method method = Method::kSparseLdl;              // chosen at set-up
  std::shared_ptr<const KktPattern> chosen, safe;  // the order chosen, and leaf-to-root

  Factor factor = Factor::kNone;           // by solve
  double first_error = 0;                  // backward error before refinement
  std::vector<double> Lx, D;               // kLdl, kDependent
  sparse::DependentRows rows;              // kDependent: rows of J dropped, leaf-to-root order
  bool was_dependent = false;              // the last solve found rows dependent
  std::optional<sparse::Cholmod> cholmod;  // kCholmod: of K; kSupernodal: of S
  const KktPattern* cholmod_pattern = nullptr;
  std::shared_ptr<const SchurPattern> schur_pattern;  // kSupernodal
  SchurData schur;
  std::unique_ptr<DenseKkt<double>> dense;  // kDense
};

/// The whole scene as one dense system: the baseline.
struct DenseSchurData {
  Eigen::MatrixXd M, J, Z, S;  // nv x nv, nc x nv, L^-1 J^T, J M^-1 J^T + delta I
  // of something from the start: Eigen leaves a part of an empty one undefined, and moving that is undefined as well
  Eigen::LLT<Eigen::MatrixXd> llt_M{Eigen::MatrixXd::Identity(1, 1)}, llt_S = llt_M;
  bool refined = false;  // the factors alone lost digits
  Eigen::MatrixXd Kinv;  // by differentiate
  Eigen::VectorXd y, f;
};

struct SceneData {
  SceneData(const Scene& scene, const Options& options = {});

  // what the caller may change before a solve
  Options options;
  std::vector<char> active;  // one per contact

  // by solve
  bool solved = false;        // all of this is of the islands below
  Eigen::VectorXd v, tau;     // nv: the velocity and the torques solved at
  Eigen::VectorXd a;          // nv: accelerations
  Eigen::VectorXd f;          // rows of the active contacts, in the scene's order: forces on A in the contact's axes
  std::vector<int> f_offset;  // per contact: its first row in f, -1 when not active
  Report report;

  std::vector<RobotData> robots;
  std::vector<ContactSupport> supports;       // per contact of the scene
  std::vector<ContactData<double>> contacts;  // per contact of the scene
  std::vector<IslandData> islands;            // of the active set prepared last
  std::vector<char> islands_active;           // that set
  Options islands_options;                    // what they were prepared for
  std::vector<int> robot_island;              // per robot
  DenseSchurData dense_schur;
  std::unique_ptr<DerivativeData> derivatives;  // by differentiate
  std::unique_ptr<ProductData> products;        // by jvp and vjp
  sparse::LdlWorkspace ldl_work;
  // Patterns seen before, by shape and order: a contact set that returns is not analysed again.
  std::map<std::pair<std::vector<long>, Order>, std::shared_ptr<const KktPattern>> patterns;
};

/// Finds the islands of data.active and sets up their systems, unless they are set up already. `solve` calls it.
void prepare(const Scene& scene, SceneData& data);

/// "left[0]" for each row of f. After prepare or solve.
std::vector<std::string> force_names(const Scene& scene, const SceneData& data);

}  // namespace manycontact
