// What a scene may be as a text: yaml-cpp's traps and our limits, each refused with its place.
#include "frontend/yaml_text.hpp"

#include <gtest/gtest.h>

#include "frontend/scene_check.hpp"
#include "frontend/scene_reader.hpp"

namespace dalembert::frontend {
namespace {

// "line:column: message; remedy", or "" when the text can be read.
std::string refusal(const std::string& text) {
  try {
    read_yaml(text);
    return "";
  } catch (const YamlError& error) {
    return std::to_string(error.line) + ":" + std::to_string(error.column) + ": " + error.what() + "; " + error.remedy;
  }
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

// Each would make YAML::LoadAll run for ever: a token that begins no value stands where a document should.
TEST(YamlText, ADocumentThatReadsNothingEndsTheReading) {
  EXPECT_EQ(refusal(", b"), "1:1: a value was expected; ");
  EXPECT_EQ(refusal("!t ,"), "1:4: a value was expected; ");
  EXPECT_EQ(refusal("&a ,"), "1:4: a value was expected; ");
  EXPECT_EQ(refusal("'a'\n, b"), "2:1: a value was expected; ");
  EXPECT_EQ(refusal("---\n,"), "2:1: a value was expected; ");
  EXPECT_EQ(refusal("a: 1\n...\n,"), "3:1: a value was expected; ");
}

TEST(YamlText, ControlCharactersAreRefused) {  // yaml-cpp takes 4 for the end of its input
  EXPECT_EQ(refusal("a: 1\nb\4: 2"), "2:2: byte 4 is a control character; save the file as text in UTF-8");
  EXPECT_EQ(refusal(std::string("a\0b", 3)), "1:2: byte 0 is a control character; save the file as text in UTF-8");
  EXPECT_EQ(refusal("a:\tb\r\nc: d\n"), "");
}

TEST(YamlText, EmptyDocumentsAreNone) {
  EXPECT_FALSE(read_yaml(""));
  EXPECT_FALSE(read_yaml("# nothing\n---\n...\n---\n~\n"));
  EXPECT_TRUE(read_yaml("---\n---\na: 1\n---\n")->is_map());
  EXPECT_EQ(refusal("a: 1\n---\nb: 2"),
            "3:1: a second document begins here; a scene is one document: remove the line '---' and what is not needed");
}

TEST(YamlText, DepthIsLimited) {
  const std::string message = "lists and maps are nested more than 16 deep; a scene needs six levels";
  EXPECT_EQ(refusal(repeated("[", 16) + "a" + repeated("]", 16)), "");
  EXPECT_EQ(refusal(repeated("[", 17) + "a" + repeated("]", 17)), "1:17: " + message);
  EXPECT_EQ(refusal(repeated("- ", 100'000)), "1:33: " + message);
  EXPECT_EQ(refusal(repeated("? ", 100'000)), "1:33: " + message);
  for (const char* unclosed : {"[", "{a: ", "[? ", "{'a':"})
    EXPECT_NE(refusal(repeated(unclosed, 100'000)).find(message), std::string::npos) << unclosed;
}

TEST(YamlText, SizeIsLimited) {
  EXPECT_EQ(refusal(std::string(yaml_bytes, ' ')), "");
  EXPECT_EQ(refusal(std::string(yaml_bytes + 1, ' ')), "1:1: the text is longer than 4 MiB; leave out what is not needed");
}

TEST(YamlText, ValuesAreCountedWithWhatAliasesRepeat) {
  const std::string message = "there are more than 200000 values; leave out what is not needed";
  EXPECT_EQ(refusal("[" + repeated("a,", yaml_values - 1) + "]"), "");
  EXPECT_EQ(refusal("[" + repeated("a,", yaml_values) + "]"), "1:" + std::to_string(2 * yaml_values) + ": " + message);
  std::string laughs = "a: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i)
    laughs += "b: &a" + std::to_string(i) + " [" + repeated("*a" + std::to_string(i - 1) + ",", 9) + "]\n";
  EXPECT_NE(refusal(laughs).find(message), std::string::npos) << refusal(laughs);
  const std::string copies = "a: &a '" + std::string(1'000'000, 'x') + "'\nb: [" + repeated("*a,", 1000) + "]";
  EXPECT_NE(refusal(copies).find(message), std::string::npos) << refusal(copies);
}

TEST(YamlText, AnAliasRepeatsAValueThatIsComplete) {
  const YamlNode root = read_yaml("a: &x {b: [1, 2]}\nc: *x\n").value();
  EXPECT_EQ(root.entries.at(1).value.entries.at(0).value.items.at(1).scalar, "2");
  EXPECT_EQ(refusal("&a [b, *a]"), "1:8: the alias stands inside the value it repeats; write the value out");
}

TEST(YamlText, ASceneOfAThousandJointsIsFarFromTheLimits) {
  std::string map = "{";
  for (int i = 0; i < 1000; ++i) map += "a_joint_with_a_rather_long_name_" + std::to_string(i) + ": 0.123456789012345,\n";
  map += "}\n";
  const std::string text = "locked: " + map + "armature: " + map + "damping: " + map + "friction: " + map;
  EXPECT_LT(10 * text.size(), yaml_bytes);
  EXPECT_EQ(read_scene_text("scene.yaml", text, {}).scene.friction.size(), 1000u);
}

TEST(YamlText, LinksAskedForAreLimited) {
  for (const std::string key : {"jacobians", "payloads"}) {
    std::string text = key + ": [";
    ir::RobotDescription robot;
    robot.root = 0;
    robot.children.resize(1001);
    for (int i = 0; i <= 1000; ++i) {
      text += "l" + std::to_string(i) + ", ";
      robot.links.push_back({.name = "l" + std::to_string(i)});
    }
    Diagnostics warnings;
    EXPECT_NO_THROW(check_scene(read_scene_text("s.yaml", text.substr(0, text.rfind("l1000")) + "]", {}), robot, warnings));
    try {
      check_scene(read_scene_text("s.yaml", text + "]", {}), robot, warnings);
      ADD_FAILURE() << key;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), "s.yaml: line 1, column 1: key '" + key +
                                  "': error: there are 1001 links; no more than 1000 are supported; name fewer of them");
    }
  }
}

}  // namespace
}  // namespace dalembert::frontend
