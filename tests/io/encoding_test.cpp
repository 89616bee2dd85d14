// Bytes that become names are decoded as the file declares, or refused with their line.

#include <gtest/gtest.h>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

using namespace std::string_literals;

class Encoding : public testing::Test {
 protected:
  // Returns a robot with one joint of that name on line 3, in a file that begins with `head`.
  static std::string robot(const std::string& head, const std::string& joint) {
    return head + "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>\n\n<joint name=\"" + joint +
           "\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>\n";
  }
  // Returns the joint's name, or "LINE: MESSAGE" of the refusal.
  std::string read(const std::string& bytes) const {
    try {
      return load_urdf(folder_.write("robot.urdf", bytes)).joints.at(0).name;
    } catch (const InputError& error) {
      return std::to_string(error.line) + ": " + error.message;
    }
  }
  static std::string declared(const std::string& encoding) {
    return "<?xml version=\"1.0\" encoding=\"" + encoding + "\"?>";
  }
  // Encodes ASCII and characters up to U+00FF given as Latin-1.
  static std::string utf16(const std::string& latin1, bool big) {
    std::string out = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : latin1) out += big ? std::string{'\0', c} : std::string{c, '\0'};
    return out;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Encoding, Declared) {
  const std::string kUe = "gelenk_\xC3\xBC";  // u umlaut, in UTF-8
  EXPECT_EQ(read(robot("", kUe)), kUe);
  EXPECT_EQ(read(robot("\xEF\xBB\xBF", kUe)), kUe);
  EXPECT_EQ(read(robot("\xEF\xBB\xBF" + declared("UTF-8"), kUe)), kUe);
  EXPECT_EQ(read(robot(declared("utf-8"), kUe)), kUe);
  for (const char* name : {"ISO-8859-1", "iso-8859-1", "latin1", "ISO_8859-1", "Windows-1252", "cp1252", "ISO-8859-15"})
    EXPECT_EQ(read(robot(declared(name), "gelenk_\xFC")), kUe) << name;
  EXPECT_EQ(read(robot("<?xml version='1.0' encoding='ISO-8859-1' standalone='yes'?>\n", "gelenk_\xFC")), kUe);
  EXPECT_EQ(read(robot(declared("windows-1252"), "x\x80")), "x\xE2\x82\xAC");  // the euro sign
  EXPECT_EQ(read(robot(declared("iso-8859-15"), "x\xA4")), "x\xE2\x82\xAC");
  for (const bool big : {true, false}) {
    EXPECT_EQ(read(utf16(robot(declared("UTF-16"), "gelenk_\xFC"), big)), kUe);
    EXPECT_EQ(read(utf16(robot("", "gelenk_\xFC"), big)), kUe);
  }
  EXPECT_EQ(read(robot(declared("US-ASCII"), "knee")), "knee");
  EXPECT_EQ(read(robot("", "gelenk_&#252;")), kUe);
  EXPECT_EQ(read(robot("", "gelenk_&#xFC;")), kUe);
  EXPECT_EQ(read(robot("", "&#x1F600;")), "\xF0\x9F\x98\x80");
}

TEST_F(Encoding, Refused) {
  EXPECT_EQ(read(robot(declared("EBCDIC-CP-US"), "x")).find("1: declares the encoding 'EBCDIC-CP-US', expected UTF-8"),
            0u);
  EXPECT_EQ(read(robot(declared("UTF-16"), "x")).find("1: declares the encoding 'UTF-16' without a byte order mark"),
            0u);
  for (const char* bytes :
       {"\xFC", "\xC3", "\xC0\xAF", "\xED\xA0\x80", "\xF8\x88\x80\x80\x80", "\xF4\x90\x80\x80", "\x80"})
    EXPECT_EQ(read(robot("", "x"s + bytes)).find("3: contains the "), 0u) << read(robot("", "x"s + bytes));
  EXPECT_EQ(read(robot(declared("ascii"), "\xFC")).find("3: contains the byte 0xfc"), 0u);
  EXPECT_EQ(read(robot("", "x\x01y")).find("3: contains the character 0x1"), 0u);
  for (const char* reference : {"&#0;", "&#xD800;", "&#55296;", "&#xDFFF;", "&#1;", "&#xFFFE;", "&#x110000;",
                                "&#99999999999999999999;", "&#;", "&#x;", "&#-1;", "&#xZZ;"}) {
    const std::string said = read(robot("", "x"s + reference));
    EXPECT_EQ(said.find("3: refers to '"s + reference + "', which is no character of XML"), 0u) << said;
  }
}

// The content of a comment is not read.
TEST_F(Encoding, CommentsMayHoldAnything) {
  EXPECT_EQ(read(robot("<!-- \xFClmotor &#0; &#xD800; \x01 -->", "x")), "x");
  EXPECT_EQ(read(robot("<!--\n\n-->", "\xFC")).find("5: contains the byte 0xfc"), 0u);  // lines go on
}

TEST_F(Encoding, OfScenes) {
  (void)folder_.write("robot.urdf", robot("", "x"));
  const auto scene = [&](const std::string& head, const std::string& name) {
    try {
      return read_scene(folder_.write("scene.xml",
                                      head + "<scene>\n<robot name=\"" + name + "\" urdf=\"robot.urdf\"/></scene>"))
          .scene.robots.at(0)
          .name;
    } catch (const InputError& error) {
      return std::to_string(error.line) + ": " + error.message;
    }
  };
  EXPECT_EQ(scene(declared("ISO-8859-1"), "\xE9"), "\xC3\xA9");
  EXPECT_EQ(scene("\xEF\xBB\xBF", "x"), "x");
  // text that is already decoded, as Python's, is UTF-8 whatever it declares
  const std::string text = declared("ISO-8859-1") + "<scene><robot name=\"\xC3\xA9\" urdf=\"robot.urdf\"/></scene>";
  EXPECT_EQ(read_scene_text(text, (folder_ / "scene.xml").string()).scene.robots.at(0).name, "\xC3\xA9");
  EXPECT_EQ(scene("", "&#xD800;").find("2: refers to"), 0u);
  EXPECT_EQ(scene("", "&#0;x").find("2: refers to"), 0u);
}

TEST_F(Encoding, SharedReports) {
  const std::string reports = std::string(MANYCONTACT_SHARED_DIR) + "/reports/";
  if (!std::filesystem::exists(reports)) GTEST_SKIP() << reports << " is not here";
  const SceneFile file = read_scene(reports + "latin1/latin1_joint.xml");
  EXPECT_EQ(file.scene.robots.at(0).model->joints.at(0).name, "gelenk_\xC3\xBC");
  for (const char* scene : {"load/08-character-references/surrogate.xml", "load/08-character-references/zero.xml"})
    EXPECT_THROW((void)read_scene(reports + scene), InputError) << scene;
}

}  // namespace
}  // namespace manycontact
