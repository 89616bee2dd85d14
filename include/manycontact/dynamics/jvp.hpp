#pragma once
#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

// Products with the derivatives of (a, f) = solve(q, v, u) at the last solve, by solves with the last factor and by
// tree recursions. No derivative matrix is formed. Derivatives with respect to q are on the tangent space.

/// Computes da = da/dq dq + da/dv dv + da/du du and df = df/dq dq + df/dv dv + df/du du. Sizes: dq, dv, da have
/// scene.nv entries, du has scene.nu, df has data.f.size(). The cost is 0.7 to 3 times that of a solve. The results are
/// NaN for failed islands, and for deep trees for which the factor of the whole tree is not accurate. Throws
/// std::invalid_argument for a wrong size or data of another scene. Throws std::logic_error before a solve, and if
/// contacts were switched after the last solve. Thread-safe for distinct data.
void jvp(const Scene& scene, SceneData& data, const ConstVectorRef& dq, const ConstVectorRef& dv,
         const ConstVectorRef& du, VectorRef da, VectorRef df);

/// Computes wq = (da/dq)^T wa + (df/dq)^T wf, wv = (da/dv)^T wa + (df/dv)^T wf and wu = (da/du)^T wa + (df/du)^T wf.
/// Sizes: wa, wq, wv have scene.nv entries, wf has data.f.size(), wu has scene.nu. The cost is 0.7 to 3 times that of a
/// solve. Throws as jvp does, and returns NaN in the same cases. Thread-safe for distinct data.
void vjp(const Scene& scene, SceneData& data, const ConstVectorRef& wa, const ConstVectorRef& wf, VectorRef wq,
         VectorRef wv, VectorRef wu);

/// These overloads of jvp and vjp include the external wrenches: dw and ww have 6 entries per wrench of the scene, in
/// the wrench's own axes (`ExternalWrench::reference_frame`).
void jvp(const Scene& scene, SceneData& data, const ConstVectorRef& dq, const ConstVectorRef& dv,
         const ConstVectorRef& du, const ConstVectorRef& dw, VectorRef da, VectorRef df);
void vjp(const Scene& scene, SceneData& data, const ConstVectorRef& wa, const ConstVectorRef& wf, VectorRef wq,
         VectorRef wv, VectorRef wu, VectorRef ww);

}  // namespace manycontact
