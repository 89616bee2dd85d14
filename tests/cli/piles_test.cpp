// The program handles piles: many boxes on each other by the corners of their faces, whose contacts form pairs.

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

class Piles : public Program {
 protected:
  // Returns a tower of crates, each on its own four lower corners; `attributes` are those of the scene's contacts.
  std::string tower(int boxes, const std::string& attributes = "") const {
    std::string text;
    for (int k = 0; k < boxes; ++k) {
      const std::string n = std::to_string(k);
      text += "<robot name=\"b" + n + "\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 " +
              std::to_string(0.2 + 0.4 * k) + "\"/>\n";
      for (int corner = 1; corner <= 4; ++corner) {
        const std::string c = std::to_string(corner);
        text += "<contact name=\"c" + n + "_" + c + "\" type=\"3d\" frame=\"b" + n + "/bottom_" + c + "\"" +
                (k > 0 ? " to=\"b" + std::to_string(k - 1) + "/top_" + c + "\"" : "") + "/>\n";
      }
    }
    return scene(text, attributes);
  }
  void expect_runs(const std::vector<std::string>& words) const {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 0) << words[0] << ": " << outcome.err;
    EXPECT_EQ(outcome.err, "") << words[0];
  }
};

// 60 boxes are too many for the dense comparison; the table of forces must not rely on it.
TEST_F(Piles, TowersAreSolvedInspectedAndDifferentiated) {
  for (const char* damping : {"", "damping=\"1e-8\""}) {
    const std::string file = tower(60, damping);
    expect_runs({"solve", file});
    expect_runs({"solve", file, "--json", path("answer.json")});
    expect_runs({"solve", file, "--derivatives"});
    expect_runs({"inspect", file});
  }
}

// The simulation's own data meet the pairs in another order than the data that follow its configuration.
TEST_F(Piles, TowersAreSimulated) {
  for (const char* damping : {"", "damping=\"1e-8\""})
    for (const char* integrator : {"semi-implicit-euler", "rk4"})
      expect_runs({"simulate", tower(16, damping), "--time", "0.003", "--step", "0.001", "--integrator", integrator,
                   "--out", path("motion.csv"), "--forces", path("forces.csv"), "--json", path("motion.json")});
}

// Rows that depend only within pairs need no dense rank, whatever their number: 1,440 rows of 720 coordinates and more.
TEST_F(Piles, RanksOfLargeTowersAreTold) {
  const Outcome outcome = run({"inspect", tower(400)});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "2400");
  expect_lacks(outcome.out, "the rank was left out");
}

}  // namespace
}  // namespace manycontact::cli
