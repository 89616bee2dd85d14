#pragma once
// Functions of DifferentialActionModelContactFwdDynamics that copy between contact models, data and the solved scene.

#include "manycontact/action/contact_fwddyn.hpp"

namespace manycontact::internal {

/// Returns the robots' models with the given armature (nv). Models that already have this armature are not copied.
std::vector<std::shared_ptr<const Model>> models_with_armature(const Scene& scene, const Eigen::VectorXd& armature);

/// Writes the contact models' references, gains and status into the scene and the solution. Returns false if new
/// SceneData are needed because the structure of the rows has changed.
bool update_contacts(const ContactModelMultiple& contacts, Scene& scene, SceneData& solution);
/// Returns whether the data were made for the current frames of the contact models, and not only for the same bodies.
bool on_same_frames(const ContactModelMultiple& contacts, const ContactDataMultiple& data);

/// Sets the rows and columns of the islands, and the sparsity patterns of Fx and Fu.
void lay_out_islands(const ActuationModelAbstract& actuation, DifferentialActionDataContactFwdDynamics& data);
void lay_out_contacts(const ContactModelMultiple& contacts, DataCollector& m);

void fill_contacts(DataCollector& m);  // computes Jc, a0 and f of each active contact
/// Computes da0_dx of each active contact and, with `forces`, sets the views df_dx and df_du.
void fill_contact_derivatives(bool forces, DataCollector& m);
/// Copies the panels of the islands to Fx and Fu, in dense or sparse storage.
void fill_dynamics(DifferentialActionDataContactFwdDynamics& data);

// The content of u: torques of actuated coordinates, torques of all coordinates, or controls of a general tau(x, u).
enum class Actuation { kActuated, kAll, kCustom };
Actuation kind(const ActuationModelAbstract& actuation, const Scene& scene);
inline bool by_all_torques(const ActuationModelAbstract& actuation, const Scene& scene) {
  return kind(actuation, scene) != Actuation::kActuated;
}
/// Computes m.custom for a custom actuation: derivatives w.r.t. x and u, from those w.r.t. torques and of tau(x, u).
void apply_actuation(const ActuationModelAbstract& actuation, DataCollector& m);

}  // namespace manycontact::internal
