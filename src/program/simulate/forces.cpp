// Contact forces over time, a row per state that is written.

#include "manycontact/analysis/names.hpp"
#include "simulate.hpp"

namespace manycontact::cli {

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
