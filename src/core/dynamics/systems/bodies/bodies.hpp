#pragma once
// Solves an island by sparse-bodies (kkt/bodies): whole, or by the subtrees between constrained bodies.

#include "../../lanes/lanes.hpp"
#include "../../lanes/subtrees.hpp"
#include "../system.hpp"
#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/kkt/bodies/dependent_rows.hpp"

namespace manycontact {

/// A body whose rows determine its acceleration, so that the subtree below can be solved independently.
struct HeldBody {
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

  /// Solves the whole system at the current state. False without sound pivots, or with dependent rows.
  bool make_current(const Scene&, const SceneData&);

  IslandWork& owner;
  std::vector<BodyKinematics<double>> kin;  // one entry per robot of the island; set by solve
  // subtrees between constrained bodies; those of one shape share a Shape
  const BodySubtrees* subtrees;
  struct Slot {
    const BodySubtree* subtree = nullptr;
    BodySystem system;
    BodySolve solution;
    std::vector<int> row;  // number of each row among the scene's forces
  };
  struct Shape {
    Shape(std::shared_ptr<const BodyPattern> pattern, const simd::Level* level);
    std::shared_ptr<const BodyPattern> pattern;
    BodyLdl ldl;                                 // factor of a subtree alone
    std::unique_ptr<lanes::SubtreeBatch> lanes;  // null: subtrees are solved one by one
    std::vector<Slot> slots;                     // one per subtree of a SIMD batch
    std::size_t filled = 0;
    std::vector<lanes::SubtreeBatch::Subtree> side_by_side;  // one per filled slot
  };
  std::vector<Shape> shapes;
  std::vector<HeldBody> held;          // one per cut: the constrained body
  std::vector<Vec6<double>> reaction;  // one per cut: reaction of the subtree below
  // the whole system
  std::uint64_t state = 0;  // the state that factor and solution belong to
  bool sound = false;       // whether these can be used
  BodyFactor factor;
  BodySolve solution;
  BodyDependence dependence;

  // set by jvp, vjp; allocated at the first call
  std::vector<ContactData<double>> contacts;  // one per contact of the island, at the solution
  std::vector<BodyVariation> body;
  BodySolve products;
};

namespace internal {

/// Report values over all systems solved: the worst or largest.
struct BodyAnswer {
  sparse::Refinement refinement;
  int nonzeros = 0;
  double r[2] = {0, 0}, scale[2] = {0, 0};  // the largest: dynamics rows, contact rows
  void add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& refinement);
};

/// Solves subtree by subtree; false if the island is one subtree, or if any has no sound solution.
bool solve_by_subtrees(const Scene& scene, SceneData& data, BodiesSystem& system, BodyAnswer& answer);

/// Evaluate a robot's node or a contact's rows, numbered from node `at`, coordinate `dof` and row `first`.
void evaluate_node(const Scene& scene, const SceneData& data, BodiesSystem& bodies, std::size_t robot, int joint,
                   int at, int dof, BodySystem& system, BodyVectors& b);
void evaluate_rows(const Scene& scene, const SceneData& data, const BodiesSystem& bodies, std::size_t contact,
                   int first, BodySystem& system, BodyVectors& b);
/// Places the bases and marks joint-space terms as unknown. Call it before the first evaluate_node.
void begin_evaluation(const Scene& scene, const SceneData& data, BodiesSystem& bodies);
/// Computes x of `solve`, refined, after all nodes and rows. kNone: it is sound.
Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodyDependence& work, BodySolve& solve,
                           sparse::Refinement& refinement);

/// Returns the kinematics of an attachment's robot; nullptr if its body is fixed.
const BodyKinematics<double>* kinematics_at(const BodiesSystem& bodies, const Attachment& at);
/// Evaluates bodies.contacts at the solution, relative to the contacts' bodies.
void evaluate_rows_at_solution(const Scene& scene, BodiesSystem& bodies);
/// Overwrites x, in the island's order, with K x, by a recursion over the bodies.
void multiply_bodies(const BodySystem& system, double* x);

}  // namespace internal

}  // namespace manycontact
