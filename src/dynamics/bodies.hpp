#pragma once
// An island solved by sparse-bodies: what it needs beside and in place of the joint-space K.

#include "lanes/parts.hpp"
#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/kkt/bodies/factor.hpp"
#include "workspace.hpp"

namespace manycontact {

/// A body whose rows say how it accelerates: what hangs below is solved beside its own part, not after it.
struct HeldBody {
  Vec6<double> a;
  BodyHold hold;
  int row[6];  // of its rows among the scene's forces
};

struct BodyForm {
  /// level: of the instructions for parts in lanes, nullptr: parts stand alone.
  BodyForm(const std::shared_ptr<IslandShape>& shape, const lanes::Level* level);

  // by solve
  std::vector<BodyKinematics<double>> kin;  // per robot of the island
  // part by part, where held bodies cut the trees; alike parts share what they are solved by
  const BodyParts* parts;
  struct Slot {
    const BodyPart* part = nullptr;  // the one at hand
    BodySystem system;
    BodySolve solution;
    std::vector<int> row;  // per row: its number among the scene's forces
  };
  struct Shape {
    Shape(std::shared_ptr<const BodyPattern> pattern, const lanes::Level* level);
    std::shared_ptr<const BodyPattern> pattern;
    BodyLdl ldl;                          // of a part alone
    std::unique_ptr<lanes::Parts> lanes;  // null: its parts stand alone
    std::vector<Slot> slots;              // as many as stand side by side
    std::size_t filled = 0;
    std::vector<lanes::Parts::Part> side_by_side;  // one per slot that is filled
  };
  std::vector<Shape> shapes;
  std::vector<HeldBody> held;      // per cut
  std::vector<Vec6<double>> pull;  // per cut: of what hangs below
  bool in_parts = false;           // the last solve went so: all below is another's until `complete_bodies`
  // as a whole
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

/// As solve_by_bodies, part by part. False where the island is one part, or one has no sound answer.
bool solve_in_parts(const Scene& scene, SceneData& data, IslandWork& d, IslandReport& report);

/// The whole system with its solution, where parts answered the last solve. Where that has no sound pivots the joint
/// space has, or d.factor is null.
void complete_bodies(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread);

/// The pieces of both: a robot's node, a contact's rows, in equations numbered from node `at`, coordinate `dof` and row
/// `first` on.
void evaluate_node(const Scene& scene, const SceneData& data, const IslandWork& d, std::size_t robot, int joint, int at,
                   int dof, BodySystem& system, BodyVectors& b);
void evaluate_rows(const Scene& scene, const SceneData& data, const IslandWork& d, std::size_t contact, int first,
                   BodySystem& system, BodyVectors& b);
/// Before the first node: where the bases are; no joint-space terms are known.
void begin_evaluation(const Scene& scene, const SceneData& data, IslandWork& d);
/// After the last: x of `solve`, refined. kNone: it is sound.
Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodySolve& solve, sparse::Refinement& refinement);

/// What is reported of systems solved: the worst and the largest of all.
struct BodyAnswer {
  sparse::Refinement refinement;
  int nonzeros = 0;
  double dynamics = 0, dynamics_scale = 0, contact = 0, contact_scale = 0;
  void add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& refinement);
};
/// d.factor and the report of an answer.
void report_bodies(const Scene& scene, const BodyAnswer& answer, IslandWork& d, IslandReport& report);

/// Evaluates, factorizes and solves; d.factor, data.a, data.f and the report are the answer's. False where there is
/// none, report.reason says why.
bool solve_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, IslandReport& report);

/// Of an attachment's robot; nullptr where its body cannot move.
const BodyKinematics<double>* kinematics_at(const BodyForm& form, const Island& island, const Attachment& at);

/// Memory for the joint-space K of an island, the first time. Throws std::length_error beyond 2^31 entries.
void make_joint_space(const Scene& scene, Workspace& work, IslandWork& d);
/// Throws std::length_error, in the name of `function`, where that has more than kMostJointSpace numbers. instead: what
/// to ask for.
void check_joint_space(const IslandWork& d, const char* function, const char* instead);
/// Joint-space terms of an island at the last solve, where sparse-bodies answered that without them. Throws as
/// check_joint_space.
void joint_space_terms(const Scene& scene, const SceneData& data, IslandWork& d, const char* function);

/// report.error_acceleration and error_forces, as estimate_errors has them.
void bound_by_bodies(const Scene& scene, const SceneData& data, IslandWork& d, IslandReport& report);
/// x <- K x, in the island's order, by a recursion.
void multiply_bodies(const BodySystem& system, double* x);

void jvp_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, const ConstVector& dq, const ConstVector& dv,
                   const ConstVector& du, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df);
void vjp_by_bodies(const Scene& scene, SceneData& data, IslandWork& d, const ConstVector& wa, const ConstVector& wf,
                   Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu);

}  // namespace internal

}  // namespace manycontact
