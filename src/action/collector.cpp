#include "manycontact/action/collector.hpp"

namespace manycontact {

namespace {
// Costs look at what a solve leaves, which robots in lanes do not.
Options robot_by_robot(Options options) {
  options.lanes = Lanes::kOff;
  return options;
}
}  // namespace

DataCollector::DataCollector(const Scene& s, const Options& options, std::shared_ptr<ActuationDataAbstract> act)
    : scene(s),
      solution(scene, robot_by_robot(options)),
      actuation(std::move(act)),
      contacts(std::make_shared<ContactDataMultiple>()) {
  prepare();
}

void DataCollector::prepare() {
  manycontact::prepare(scene, solution);
  for (std::size_t i = 0; i < island_count(solution); ++i) {
    if (choice_of(solution, i).method != Method::kSparseBodies) continue;
    solution.options.method = Method::kSparseLdl;
    manycontact::prepare(scene, solution);
    return;
  }
}

PanelView DataCollector::panel(std::size_t i) const {
  if (!custom.empty()) {
    (void)derivatives(solution);  // as for those that are the solution's own
    const RowMajorMatrix& X = custom[i];
    return PanelView(X.data(), X.rows(), X.cols(), Eigen::OuterStride<>(X.cols()));
  }
  const IslandDerivatives& d = derivatives(solution).islands[i];
  return PanelView(d.X.data(), d.X.rows(), d.cols, Eigen::OuterStride<>(d.X.cols()));
}

const ContactDataAbstract& DataCollector::contact_on(FrameIndex frame, const std::string& who,
                                                     const std::string& wanted) const {
  const ContactDataAbstract* found = nullptr;
  std::string names;
  int count = 0;
  for (const auto& [name, contact] : contacts->contacts) {
    if (contact->frame != frame || (!wanted.empty() && name != wanted)) continue;
    found = contact.get();
    names += (count++ ? ", " : "") + name;
  }
  require(count == 1, who,
          count == 0 ? "frame " + std::to_string(frame) + " has no contact" + (wanted.empty() ? "" : " " + wanted) +
                           ", one is expected"
                     : "frame " + std::to_string(frame) + " has several contacts (" + names + "), one is expected");
  return *found;
}

}  // namespace manycontact
