#pragma once
// Solves an island by sparse-bodies (kkt/bodies), as a whole or subtree by subtree. A cut is a body with six
// independent rows that determine its acceleration; the subtree below a cut can be solved separately.

#include "../../lanes/lanes.hpp"
#include "../../lanes/subtrees.hpp"
#include "../system.hpp"
#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/kkt/bodies/dependent_rows.hpp"

namespace manycontact {

struct HeldBody {  // a cut's constrained body: its acceleration, factor of its six rows, and their numbers in data.f
  Vec6<double> a;
  BodyHold hold;
  int row[6];
};

class BodiesSystem final : public IslandSystem {
 public:
  /// level: instruction level for subtrees in SIMD batches; nullptr: each subtree is solved alone.
  BodiesSystem(IslandWork& island, const simd::Level* level);

  bool solve(const Scene&, SceneData&, ThreadWork&, IslandReport&) override;
  bool differentiate(const Scene&, SceneData&, ThreadWork&, IslandDerivatives&) override;
  bool jvp(const Scene&, SceneData&, ThreadWork&, const TangentProduct&) override;
  bool vjp(const Scene&, SceneData&, ThreadWork&, const AdjointProduct&) override;
  bool invert(const Scene&, SceneData&, ThreadWork&, ProductWork&) override;
  bool bound_errors(const Scene&, SceneData&, IslandReport&) override;
  bool estimate_condition(const Scene&, SceneData&, IslandReport&) override;

  bool make_current(const Scene&, const SceneData&);  // solves the whole island; false if pivots fail, or rows depend

  IslandWork& owner;
  std::vector<BodyKinematics<double>> kin;  // one entry per robot of the island; set by solve
  // subtrees between cuts; subtrees of one shape share a Shape
  const BodySubtrees* subtrees;
  struct Slot {
    const BodySubtree* subtree = nullptr;
    BodySystem system;
    BodySolve solution;
    std::vector<int> row;  // index in data.f of each contact row of the subtree
  };
  struct Shape {
    Shape(std::shared_ptr<const BodyPattern> pattern, const simd::Level* level);
    std::shared_ptr<const BodyPattern> pattern;
    BodyLdl ldl;                                 // factor of a subtree that is solved without a SIMD batch
    std::unique_ptr<lanes::SubtreeBatch> lanes;  // nullptr: no SIMD batches
    std::vector<Slot> slots;                     // subtrees that are solved together, as many as fill a SIMD batch
    std::size_t filled = 0;
    std::vector<lanes::SubtreeBatch::Subtree> side_by_side;  // one per filled slot
  };
  std::vector<Shape> shapes;
  std::vector<HeldBody> held;          // one per cut: the constrained body
  std::vector<Vec6<double>> reaction;  // one per cut: force of the subtree below on the constrained body
  // the whole island's system, not by subtrees
  std::uint64_t state = 0;  // the state (Workspace::state) of `factor` and `solution`
  bool sound = false;       // whether `factor` and `solution` can be used
  BodyFactor factor;
  BodySolve solution;
  BodyDependence dependence;

  // set by jvp, vjp; allocated at the first call
  std::vector<ContactData<double>> contacts;  // one per contact of the island: rows at the solution's accelerations
  std::vector<BodyVariation> body;
  BodySolve products;
};

namespace internal {

struct BodyAnswer {  // values for the report of an island: worst or largest over all subtrees solved
  sparse::Refinement refinement;
  int nonzeros = 0;
  double r[2] = {0, 0}, scale[2] = {0, 0};  // largest residual, terms: [0] dynamics, [1] contact rows
  void add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& refinement);
};

/// Solves subtree by subtree. Returns false if the island is one subtree, or if a subtree has no sound solution.
bool solve_by_subtrees(const Scene& scene, SceneData& data, BodiesSystem& system, BodyAnswer& answer);

/// Evaluate the equations of one body (node `at` of `system`, with coordinates from `dof` on) or of one contact (rows
/// of `system` from `first` on).
void evaluate_node(const Scene& scene, const SceneData& data, BodiesSystem& bodies, std::size_t robot, int joint,
                   int at, int dof, BodySystem& system, BodyVectors& b);
void evaluate_rows(const Scene& scene, const SceneData& data, const BodiesSystem& bodies, std::size_t contact,
                   int first, BodySystem& system, BodyVectors& b);
/// Sets the placements of the robots' bases and marks their joint-space terms as not evaluated. Call it before the
/// first evaluate_node.
void begin_evaluation(const Scene& scene, const SceneData& data, BodiesSystem& bodies);
/// Computes solve.x with refinement, once all nodes and rows are evaluated. Returns kNone if solve.x is sound.
Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodyDependence& work, BodySolve& solve,
                           sparse::Refinement& refinement);

const BodyKinematics<double>* kinematics_at(const BodiesSystem& bodies, const Attachment& at);  // nullptr if fixed
void evaluate_rows_at_solution(const Scene& scene, BodiesSystem& bodies);  // bodies.contacts, in body frames
void multiply_bodies(const BodySystem& system, double* x);  // x = K x, in the island's order, by recursion over bodies

}  // namespace internal

}  // namespace manycontact
