#pragma once
// An island solved by sparse-bodies: what it needs beside and in place of the joint-space K.

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/kkt/bodies/factor.hpp"
#include "workspace.hpp"

namespace manycontact {

struct BodyForm {
  explicit BodyForm(const std::shared_ptr<IslandShape>& shape);

  // by solve
  std::vector<BodyKinematics<double>> kin;  // per robot of the island
  BodyFactor factor;
  BodySolve solution;

  // by jvp, vjp; made when first needed
  std::vector<ContactData<double>> contacts;  // per contact of the island, at the solution
  std::vector<BodyVariation> body;            // per node
  BodySolve products;
};

namespace internal {

/// Whether sparse-bodies is this island's method, and whether it answered the last solve.
inline bool has_bodies(const IslandWork& d) { return d.bodies != nullptr; }
inline bool by_bodies(const IslandWork& d) { return d.bodies && d.factor == &d.bodies->factor; }

/// Evaluates, factorizes and solves; d.factor, data.a, data.f and the report are the answer's. False where there is
/// none, report.reason says why.
bool solve_by_bodies(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data,
                     FactorScratch& scratch, IslandWork& d, IslandReport& report);

/// Of an attachment's robot; nullptr where its body cannot move.
const BodyKinematics<double>* kinematics_at(const BodyForm& form, const Island& island, const Attachment& at);

/// Memory for the joint-space K of an island, the first time. Throws std::length_error beyond 2^31 entries.
void make_joint_space(const Scene& scene, Workspace& work, IslandWork& d);
/// Joint-space terms of an island at the last solve, where sparse-bodies answered that without them. Throws
/// std::length_error, in the name of `function`, where they are more than kMostJointSpace.
void joint_space_terms(const Scene& scene, const SceneData& data, IslandWork& d, const char* function);

/// report.error_acceleration and error_forces, as estimate_errors has them.
void bound_by_bodies(const Scene& scene, const Workspace& work, IslandWork& d, IslandReport& report);
/// x <- K x, in the island's order, by a recursion.
void multiply_bodies(const BodySystem& system, double* x);

void jvp_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, const ConstVector& dq, const ConstVector& dv,
                   const ConstVector& du, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df);
void vjp_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, const ConstVector& wa, const ConstVector& wf,
                   Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu);

}  // namespace internal

}  // namespace manycontact
