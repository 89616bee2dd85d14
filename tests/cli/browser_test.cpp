// The page of a view is opened in headless Chromium, if that is installed: no error in the console, the right bodies,
// and it plays.

#include "cli/page.hpp"

namespace manycontact::cli {
namespace {

class Browser : public Program {
 protected:
  void SetUp() override {
    if (std::system("chromium --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "chromium is not installed";
    if (run({"view", model("arm_pushes_box.xml"), "--out", path("try.html")}).status != 0)
      GTEST_SKIP() << "this build has no three.js";
  }
  // Returns the document after half a second of the page's own time, or a picture of it.
  std::string chromium(const std::string& action, const std::string& page) const {
    const std::string command =
        "timeout 200 chromium --headless --no-sandbox --disable-gpu --use-angle=swiftshader "
        "--enable-unsafe-swiftshader --disable-dev-shm-usage --hide-scrollbars --window-size=400,500 "
        "--host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr --virtual-time-budget=500 --user-data-dir='" +
        path("profile") + "' " + action + " 'file://" + page + "' > '" + path("dom.html") + "' 2> '" + path("log.txt") +
        "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << read_text(path("log.txt"));
    for (const std::string& line : lines_of(read_text(path("log.txt"))))
      if (line.find(":CONSOLE:") != std::string::npos && line.find("GL Driver Message") == std::string::npos)
        ADD_FAILURE() << line;
    return read_text(path("dom.html"));
  }
  // Returns what the page recorded: data-<name> of its body.
  static std::string data(const std::string& dom, const std::string& name) {
    const std::string key = " data-" + name + "=\"";
    const std::size_t at = dom.find(key);
    if (at == std::string::npos) return "";
    return dom.substr(at + key.size(), dom.find('"', at + key.size()) - at - key.size());
  }
};

TEST_F(Browser, ShowsTheBodiesAndPlays) {
  ASSERT_EQ(run({"simulate", model("two_humanoids_carry_beam.xml"), "--time", "0.1", "--step", "1e-3", "--passive",
                 "--out", path("t.csv"), "--view", path("v.html")})
                .status,
            0);
  const std::string dom = chromium("--dump-dom", path("v.html") + "#play");
  EXPECT_EQ(data(dom, "error"), "");
  EXPECT_EQ(data(dom, "robots"), "3");
  EXPECT_EQ(data(dom, "bodies"), "67");
  EXPECT_EQ(data(dom, "shapes"), "67");
  EXPECT_EQ(data(dom, "contacts"), "8");
  EXPECT_EQ(data(dom, "islands"), "1");
  EXPECT_EQ(data(dom, "frames"), "6");
  EXPECT_GT(std::atoi(data(dom, "frame").c_str()), 0);  // it played
  EXPECT_GT(std::atoi(data(dom, "triangles").c_str()), 5000);

  chromium("--screenshot='" + path("v.png") + "'", path("v.html") + "#t=0.05");
  const std::string png = read_text(path("v.png"));
  EXPECT_TRUE(png.starts_with("\x89PNG"));
  EXPECT_GT(png.size(), 20000u);  // an empty picture has 2 kB
}

// The camera shows where the motion goes, not only where it begins.
TEST_F(Browser, FitsTheWholeMotion) {
  const std::string falls = scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 9\"/>");
  ASSERT_EQ(run({"view", falls, "--out", path("still.html")}).status, 0);
  ASSERT_EQ(run({"simulate", falls, "--time", "1", "--step", "1e-2", "--out", path("t.csv"), "--view", path("v.html")})
                .status,
            0);
  const double near = std::stod(data(chromium("--dump-dom", path("still.html")), "distance"));
  const double far = std::stod(data(chromium("--dump-dom", path("v.html")), "distance"));
  EXPECT_LT(near, 4);
  EXPECT_GT(far, 7);  // half of 4.9 m over the tangent of half of 35 degrees
}

}  // namespace
}  // namespace manycontact::cli
