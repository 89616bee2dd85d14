// Input that is too large or expands gives a result, or an error of one line, in little time and memory.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

class Limits : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }
  std::string refusal(const std::string& scene) const {
    try {
      (void)read_scene(write("scene.xml", scene));
      return "accepted";
    } catch (const InputError& error) {
      EXPECT_LT(std::string(error.what()).size(), 1000u);
      return error.message;
    }
  }
  std::string box(const std::string& attributes) const {
    return "<robot name=\"b\" urdf=\"" MANYCONTACT_SOURCE_DIR "/models/box.urdf\" base=\"floating\" " + attributes +
           "/>";
  }

  test::TemporaryFolder folder_;
};

TEST_F(Limits, DeepXml) {
  std::string deep = "<scene>";
  for (int i = 0; i < 1000000; ++i) deep += "<a>";
  EXPECT_NE(refusal(deep).find("depth"), std::string::npos);
  std::string urdf = "<robot name=\"r\">";
  for (int i = 0; i < 1000000; ++i) urdf += "<visual>";
  EXPECT_THROW((void)load_urdf(write("deep.urdf", urdf)), InputError);
}

// tinyxml2 knows only XML's own entities: a reference to another stays as written, and does not expand.
TEST_F(Limits, EntityBomb) {
  std::string bomb = "<!DOCTYPE s [<!ENTITY a0 \"aaaaaaaaaa\">";
  for (int i = 1; i < 30; ++i) {
    bomb += "<!ENTITY a" + std::to_string(i) + " \"";
    for (int k = 0; k < 10; ++k) bomb += "&a" + std::to_string(i - 1) + ";";
    bomb += "\">";
  }
  const std::string scene = write("scene.xml", bomb + "]><scene name=\"&a29;\">" + box("") + "</scene>");
  EXPECT_EQ(read_scene(scene).scene.name, "&a29;");
}

TEST_F(Limits, Copies) {
  for (const char* copies : {"1e9", "1000001", "99999999999999999999", "-1", "0", "1e400", "nan"})
    EXPECT_NE(refusal("<scene>" + box(std::string("copies=\"") + copies + "\" arrange=\"grid\"") + "</scene>")
                  .find("from 1 to 1000000"),
              std::string::npos)
        << copies;
}

TEST_F(Limits, HugeNumbers) {
  for (const char* attribute : {"xyz=\"1e400 0 0\"", "rpy=\"0 inf 0\"", "armature=\"1e309\""})
    EXPECT_NE(refusal("<scene>" + box(attribute) + "</scene>"), "accepted") << attribute;
  const std::string digits(1000000, '9');
  EXPECT_NE(refusal("<scene damping=\"" + digits + "\"/>").find("too large"), std::string::npos);
  EXPECT_NE(refusal("<scene damping=\"0." + digits + "\" " + digits + "=\"1\"/>"), "accepted");
  EXPECT_NE(refusal("<scene " + std::string(1000000, 'a') + "=\"1\"/>"), "accepted");
}

TEST_F(Limits, FilesThatDoNotEnd) {
  const auto refused = [&](const std::string& urdf) {
    return refusal("<scene><robot name=\"r\" urdf=\"" + urdf + "\"/></scene>").find("is not a file") !=
           std::string::npos;
  };
  EXPECT_TRUE(refused("/dev/zero"));
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_TRUE(refused("pipe"));  // nobody writes to it: reading would not return
  const std::string task = write("task.xml", "<task scene=\"pipe\" step=\"1\"/>");
  EXPECT_THROW((void)read_task(task), InputError);
}

// Links need no recursion: a chain is as deep as it is long.
TEST_F(Limits, LongChain) {
  constexpr int kLinks = 30000;
  std::string urdf = "<robot name=\"chain\"><link name=\"l0\"/>";
  for (int i = 1; i <= kLinks; ++i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    urdf += "<link name=\"l" + n + "\"/><joint name=\"j" + n + "\" type=\"continuous\"><parent link=\"l" + before +
            "\"/><child link=\"l" + n + "\"/></joint>\n";
  }
  EXPECT_EQ(load_urdf(write("chain.urdf", urdf + "</robot>")).nv, kLinks);
}

// Many contact rows of one body are dense: they are left to the dense method, which is linear in their number.
TEST_F(Limits, ManyContactsOfOneBody) {
  constexpr int kContacts = 30000;
  std::string scene = "<scene>" + box("");
  for (int i = 0; i < kContacts; ++i)
    scene += "<contact name=\"c" + std::to_string(i) + "\" type=\"3d\" frame=\"b/bottom_1\"/>\n";
  const SceneFile file = read_scene(write("scene.xml", scene + "</scene>"));
  ASSERT_EQ(file.scene.contacts.size(), static_cast<std::size_t>(kContacts));
  SceneData data(file.scene);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.rank, 3);  // all of them are at one point
}

}  // namespace
}  // namespace manycontact
