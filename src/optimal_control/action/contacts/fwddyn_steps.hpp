#pragma once
// Steps of DifferentialActionModelContactFwdDynamics: between its parts and the scene that is solved.

#include "manycontact/action/contact_fwddyn.hpp"

namespace manycontact::internal {

/// The scene's models with other armatures; models whose armature stays are shared as they are.
std::vector<std::shared_ptr<const Model>> models_with_armature(const Scene& scene, const Eigen::VectorXd& armature);

/// Writes the contact models' references, gains and status into the scene and the solution. False when something has
/// changed that may not under data in use (dynamics/data.hpp): new data are needed.
bool update_contacts(const ContactModelMultiple& contacts, Scene& scene, SceneData& solution);
/// False when a contact model has been given another frame, on the same body perhaps.
bool on_same_frames(const ContactModelMultiple& contacts, const ContactDataMultiple& data);

/// Offsets of the islands' rows and columns; workspace for Fx and Fu.
void lay_out_islands(const ActuationModelAbstract& actuation, DifferentialActionDataContactFwdDynamics& data);
/// Sizes of the contacts' data.
void lay_out_contacts(const ContactModelMultiple& contacts, DataCollector& m);

/// Jc, a0, f of each contact.
void fill_contacts(DataCollector& m);
/// da0_dx of each contact and, with `forces`, views on df_dx, df_du.
void fill_contact_derivatives(bool forces, DataCollector& m);
/// Fills Fx, Fu and their sparse counterparts from the islands' panels.
void fill_dynamics(DifferentialActionDataContactFwdDynamics& data);

/// How the controls act on the scene.
enum class Actuation { kActuated, kAll, kCustom };  // u: all but floating bases, all coordinates, any function
Actuation kind(const ActuationModelAbstract& actuation, const Scene& scene);
inline bool by_all_torques(const ActuationModelAbstract& actuation, const Scene& scene) {
  return kind(actuation, scene) != Actuation::kActuated;
}
/// Sets m.custom of a custom actuation: derivatives with respect to x and u, from those with respect to the torques.
void apply_actuation(const ActuationModelAbstract& actuation, DataCollector& m);

}  // namespace manycontact::internal
