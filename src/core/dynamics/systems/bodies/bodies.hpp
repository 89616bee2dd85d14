#pragma once
// An island solved by sparse-bodies (kkt/bodies): whole, or subtree by subtree where constrained bodies cut its trees.

#include "../../lanes/lanes.hpp"
#include "../../lanes/subtrees.hpp"
#include "../system.hpp"
#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/kkt/bodies/dependent_rows.hpp"

namespace manycontact {

/// A body whose rows determine its acceleration: the subtree below is solved independently of its own, not after it.
struct HeldBody {
  Vec6<double> a;
  BodyHold hold;
  int row[6];  // numbers of its rows among the scene's forces
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

  /// The whole system and its solution at the current state, where subtrees were solved. False where that has no sound
  /// pivots, or rows depend on others: then derivatives are left to the whole K.
  bool make_current(const Scene&, const SceneData&);

  IslandWork& owner;
  std::vector<BodyKinematics<double>> kin;  // one entry per robot of the island; set by solve
  // subtree by subtree, where constrained bodies cut the trees; subtrees of one shape share a Shape
  const BodySubtrees* subtrees;
  struct Slot {
    const BodySubtree* subtree = nullptr;  // the current one
    BodySystem system;
    BodySolve solution;
    std::vector<int> row;  // one entry per row: its number among the scene's forces
  };
  struct Shape {
    Shape(std::shared_ptr<const BodyPattern> pattern, const simd::Level* level);
    std::shared_ptr<const BodyPattern> pattern;
    BodyLdl ldl;                                 // factor of a subtree alone
    std::unique_ptr<lanes::SubtreeBatch> lanes;  // null: its subtrees are solved alone
    std::vector<Slot> slots;                     // one per subtree of a SIMD batch
    std::size_t filled = 0;
    std::vector<lanes::SubtreeBatch::Subtree> side_by_side;  // one per slot that is filled
  };
  std::vector<Shape> shapes;
  std::vector<HeldBody> held;          // one entry per cut: the constrained body
  std::vector<Vec6<double>> reaction;  // one entry per cut: reaction of the subtree below
  // the system as a whole
  std::uint64_t state = 0;  // the state that factor and solution belong to
  bool sound = false;       // and whether they can be used
  BodyFactor factor;
  BodySolve solution;
  BodyDependence dependence;

  // set by jvp, vjp; made when first needed
  std::vector<ContactData<double>> contacts;  // one entry per contact of the island, at the solution
  std::vector<BodyVariation> body;            // one entry per node
  BodySolve products;
};

namespace internal {

/// Report of the systems solved: the worst and the largest values of all.
struct BodyAnswer {
  sparse::Refinement refinement;
  int nonzeros = 0;
  double r[2] = {0, 0}, scale[2] = {0, 0};  // the largest of dynamics rows, contact rows
  void add(int factor_nonzeros, const BodyResidual& left, const sparse::Refinement& refinement);
};

/// Subtree by subtree; false where the island is one subtree, or one has no sound solution.
bool solve_by_subtrees(const Scene& scene, SceneData& data, BodiesSystem& system, BodyAnswer& answer);

/// The pieces of both: a robot's node, a contact's rows, in equations numbered from node `at`, coordinate `dof` and row
/// `first` on.
void evaluate_node(const Scene& scene, const SceneData& data, BodiesSystem& bodies, std::size_t robot, int joint,
                   int at, int dof, BodySystem& system, BodyVectors& b);
void evaluate_rows(const Scene& scene, const SceneData& data, const BodiesSystem& bodies, std::size_t contact,
                   int first, BodySystem& system, BodyVectors& b);
/// Before the first node: where the bases are; no joint-space terms are known.
void begin_evaluation(const Scene& scene, const SceneData& data, BodiesSystem& bodies);
/// After the last: x of `solve`, refined. kNone: it is sound.
Reason factorize_and_solve(const BodySystem& system, BodyLdl& ldl, BodyDependence& work, BodySolve& solve,
                           sparse::Refinement& refinement);

/// Kinematics of an attachment's robot; nullptr where its body cannot move.
const BodyKinematics<double>* kinematics_at(const BodiesSystem& bodies, const Attachment& at);
/// bodies.contacts, about the bodies that the contacts are on.
void evaluate_rows_at_solution(const Scene& scene, BodiesSystem& bodies);
/// x <- K x, in the island's order, by a recursion.
void multiply_bodies(const BodySystem& system, double* x);

}  // namespace internal

}  // namespace manycontact
