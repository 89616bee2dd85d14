#pragma once
#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

// Products with the derivatives of (a, f) = solve(q, v, u) at the last solve, through solves with its factor and tree
// recursions; no derivative matrix is formed, the cost is that of a few solves. (Islands with dependent contact rows
// are the exception: theirs are formed.) q on the tangent space. NaN are the results of failed islands, and of deep
// trees that were solved in parts where the whole tree's factor is not sound. Throw std::invalid_argument on a wrong
// size or data of another scene, std::logic_error before a solve and when contacts were switched after it.

/// da = da/dq dq + da/dv dv + da/du du, df likewise. dq, dv, da: scene.nv; du: scene.nu; df: data.f.size().
void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df);

/// wq = (da/dq)^T wa + (df/dq)^T wf, wv, wu likewise.
void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu);

/// The same with the wrenches of pushes, in the axes that these are stated in: dw, ww have 6 numbers each.
void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         const ConstVector& dw, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df);
void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu,
         Eigen::Ref<Eigen::VectorXd> ww);

}  // namespace manycontact
