#include "manycontact/analysis/names.hpp"
#include "simulate.hpp"

namespace manycontact::cli {

void set_gains(Scene& scene, const Gains& gains) {
  for (Contact& contact : scene.contacts) contact.alpha = gains.alpha, contact.beta = gains.beta;
}

void write_trajectory_header(const Scene& scene, CsvFile& csv) {
  csv << "t";
  for (const std::string& name : configuration_names(scene)) csv << "q:" + name;
  for (const std::string& name : velocity_names(scene)) csv << "v:" + name;
  csv << "violation_position"
      << "violation_velocity"
      << "energy";
  for (int k = 0; k < 6; ++k) csv << "momentum[" + std::to_string(k) + "]";
  csv.end_row();
}

void write_trajectory_row(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Invariants& at,
                          CsvFile& csv) {
  csv << t;
  for (double x : q) csv << x;
  for (double x : v) csv << x;
  csv << at.violation_position << at.violation_velocity << at.energy();
  for (double x : at.momentum) csv << x;
  csv.end_row();
}

void write_forces_header(const Scene& scene, CsvFile& csv) {
  csv << "t";
  for (const Contact& contact : scene.contacts)
    for (int k = 0; k < contact.rows(); ++k) csv << "f:" + row_name(contact, k);
  csv.end_row();
}

void write_forces_row(double t, const Scene& scene, const SimulationData& sim, CsvFile& csv) {
  csv << t;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    for (int k = 0; k < scene.contacts[c].rows(); ++k) csv << (sim.f_offset[c] < 0 ? 0.0 : sim.f[sim.f_offset[c] + k]);
  csv.end_row();
}

}  // namespace manycontact::cli
