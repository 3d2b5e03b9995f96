// What a URDF may be as a text: TinyXML's traps and our limits, each refused by name.
#include <gtest/gtest.h>
#include <tinyxml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "diagnostics.hpp"
#include "frontend/nearest.hpp"
#include "frontend/urdf_reader.hpp"
#include "frontend/xml_document.hpp"
#include "frontend/xml_extent.hpp"
#include "pipeline.hpp"

namespace dalembert::frontend {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string refusal(const std::string& text) {
  return refusal_of([&] {
    TiXmlDocument document;
    parse_xml(document, "r.urdf", text);
  });
}

// What TinyXML has made of the text.
int depth(const TiXmlNode& node) {
  int deepest = 0;
  for (const TiXmlNode* child = node.FirstChild(); child; child = child->NextSibling())
    deepest = std::max(deepest, depth(*child));
  return deepest + (node.ToElement() ? 1 : 0);
}
int tinyxml_depth(const std::string& text) {
  TiXmlDocument document;
  document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  return depth(document);
}

TEST(Xml, DepthIsThatOfTinyXml) {
  for (const std::string text : {"<a/>",
                                 "<a><b/><c><d/></c></a>",
                                 "<a><b x='/>'/><c><d/></c></a>",
                                 "<a><!-- <b><c> --><d/></a>",
                                 "<a><![CDATA[<b><c>]]><d/></a>",
                                 "<?xml version='1.0>'?><a><b/></a>",
                                 "<?xml version='</a>'?><a><b/></a>",
                                 "<?xml other='>'?><a/>",
                                 "<a>&#60;b&#x3e;<b/></a>",
                                 "<!DOCTYPE a><a><b/></a>",
                                 "<a><b x=1/></a>",
                                 "<a><b x=1 y=2></b></a>",
                                 "<a b='\"'><c d=\"'>\"/></a>",
                                 "<a></a><b><c/></b>",
                                 "\xef\xbb\xbf<a>\xef\xbb\xbf<b/></a>",
                                 "<a><\xc3\xa4/></a>",
                                 "<a>\xc3\xa4<b/></a>",
                                 "<a b='\xf0\x9f\xa4\x96'><b/></a>",
                                 "<a><b></a></b></a>",
                                 "<a><b</a>",
                                 "<a><b c/></a>",
                                 "x<a/>",
                                 "<a><?xml version='1'?><b/></a>"})
    EXPECT_EQ(xml_extent(text).depth, tinyxml_depth(text)) << text;
}

TEST(Xml, NestingIsLimited) {
  EXPECT_EQ(refusal(repeated("<a>", 100)), "");
  const std::string message =
      "r.urdf: error: elements are nested 101 deep; no more than 100 are allowed; close elements before the next begins; a "
      "robot's links and joints stand side by side";
  EXPECT_EQ(refusal(repeated("<a>", 101)), message);
  EXPECT_EQ(refusal(repeated("<a b='/>'>", 101)), message);
  EXPECT_EQ(refusal(repeated("<a><!-- </a> -->", 101)), message);
  EXPECT_EQ(refusal(repeated("<a><![CDATA[</a>]]>", 101)), message);
  EXPECT_EQ(refusal(repeated("<a><?xml version='></a>'?>", 101)), message);
  EXPECT_NE(refusal(repeated("<a>", 1'000'000)), "");
}

// TinyXML takes everything up to the semicolon for one character.
TEST(Xml, MalformedReferencesHideNothing) {
  const std::string message =
      "error: a character reference is malformed; write it like &#38; or &#x26;, and '&' itself as &amp;";
  EXPECT_EQ(refusal("<a>\n&#x</a>x41;</a>"), "r.urdf: line 2: " + message);
  for (const char* text : {"<a b='&#x</a>x41;'/>", "<a>&#</a>#1;", "<a>&#1</a>#1;", "<a>&#;", "<a>&#x;", "<a>&#12", "<a>&#"})
    EXPECT_EQ(refusal(text), "r.urdf: line 1: " + message) << text;
  EXPECT_EQ(refusal("<a b='&#38;'>&#x26; &amp; & &x;</a>"), "");
}

// TinyXML ends a value at the first, and drops the others.
TEST(Xml, ReferencesToNoCharacterAreRefused) {
  for (const char* reference : {"&#0;", "&#x0;", "&#000;", "&#1114112;", "&#x110000;", "&#4294967296;"})
    EXPECT_EQ(refusal(std::string("<a\nb='1") + reference + "5'/>"),
              std::string("r.urdf: line 2: error: ") + reference + " is no character; leave it out");
  EXPECT_EQ(refusal("<a b='&#18446744073709551616;'/>"),  // 2^64
            "r.urdf: line 1: error: &#184467440737095516 is no character; leave it out");
  EXPECT_EQ(refusal("<a b='&#1;&#x10FFFF;'/>"), "");
}

TEST(Xml, TextThatTinyXmlWouldReadBeyondOrNotAtAll) {
  EXPECT_EQ(refusal("<a>\xf0"), "r.urdf: line 1: error: the text ends inside a character; save the file as text in UTF-8");
  EXPECT_EQ(refusal("<a b='\xe2\x82"),
            "r.urdf: line 1: error: the text ends inside a character; save the file as text in UTF-8");
  EXPECT_EQ(refusal(std::string("<a/>\n\0<b/>", 10)),
            "r.urdf: line 2: error: byte 0 is no character; save the file as text in UTF-8");
}

TEST(Xml, AttributesNodesAndBytesAreLimited) {
  std::string attributes;
  for (int i = 0; i < xml_attributes; ++i) attributes += " a" + std::to_string(i) + "=''";
  const std::string remedy = "; leave out what is not needed: the dynamics read links, joints and inertias";
  EXPECT_EQ(refusal("<a" + attributes + "/>"), "");
  EXPECT_EQ(refusal("<a" + attributes + " b=''/>"),
            "r.urdf: error: an element has 101 attributes; no more than 100 are allowed" + remedy);
  EXPECT_EQ(refusal("<a>" + repeated("<b/>", xml_nodes)),
            "r.urdf: error: there are 8000001 elements, attributes and texts; no more than 8000000 are allowed" + remedy);
  EXPECT_EQ(refusal(std::string(xml_bytes + 1, ' ')), "r.urdf: error: the file is longer than 64 MiB" + remedy);
}

std::string links(int count, const std::string& name = "l") {
  std::string text;
  for (int i = 0; i < count; ++i) text += "<link name='" + name + std::to_string(i) + "'/>";
  return text;
}
std::string joint(const std::string& name, const char* type, const std::string& parent, const std::string& child) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><axis xyz='0 0 1'/></joint>";
}
std::string read(const std::string& elements) {
  return refusal_of([&] {
    Diagnostics warnings;
    read_urdf_text("r.urdf", "<robot name='r'>" + elements + "</robot>", warnings);
  });
}

TEST(Robot, LinksAreLimited) {
  EXPECT_EQ(read(links(100'001)),
            "r.urdf: robot 'r': error: there are 100001 links; no more than 100000 are allowed; leave out "
            "links that neither move nor have a mass");
}

TEST(Robot, TheHundredthErrorIsTheLast) {
  std::string joints;
  for (int i = 0; i < 20'000; ++i) joints += joint("j" + std::to_string(i), "fixed", "unknown", "l1");
  const std::string errors = read(links(20'000) + joints);
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 100);
  EXPECT_NE(errors.find("error: these are the first 100 errors; correct them to see others"), std::string::npos);
}

// a_b, a-b, a.b, … : 2^14 links that become the same identifier.
TEST(Robot, NamesThatBecomeEqualInCppAreToldApartInLinearTime) {
  std::string text = "<robot name='r'>", first;
  for (int i = 0; i < 1 << 14; ++i) {
    std::string name;
    for (int k = 0; k < 14; ++k) name += std::string(1, static_cast<char>('a' + k)) + ((i >> k) & 1 ? "-" : "_");
    text += "<link name='" + name + "'/>";
    if (first.empty()) first = name;
    else text += joint("j" + std::to_string(i), "fixed", first, name);
  }
  Diagnostics warnings;
  const ir::RobotDescription robot = read_urdf_text("r.urdf", text + "</robot>", warnings);
  EXPECT_EQ(robot.links[1].name, "a-b_c_d_e_f_g_h_i_j_k_l_m_n__");
  EXPECT_EQ(robot.links[2].name, "a_b-c_d_e_f_g_h_i_j_k_l_m_n__2");
  EXPECT_EQ(robot.links.back().name, "a-b-c-d-e-f-g-h-i-j-k-l-m-n-_16383");
}

TEST(Robot, MovingJointsAreLimited) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "moving_joints.urdf";
  const auto model_of = [&](int joints) {
    std::ofstream urdf(file);
    urdf << "<robot name='r'>";
    for (int i = 0; i <= joints; ++i)
      urdf << "<link name='l" << i
           << "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
    for (int i = 0; i < joints; ++i)
      urdf << joint("j" + std::to_string(i), "continuous", "l" + std::to_string(i), "l" + std::to_string(i + 1));
    urdf << "</robot>";
    urdf.close();
    Diagnostics warnings;
    Request request;
    request.robot = file.string();
    return read_model(request, warnings);
  };
  EXPECT_EQ(model_of(2000).tree.joints(), 2000);
  EXPECT_EQ(refusal_of([&] { model_of(2001); }),
            file.string() +
                ": robot 'r': error: 2001 joints move; no more than 2000 are supported; make joints fixed, or lock "
                "or cut them in the scene");
}

TEST(Suggestion, LongNamesAreNotCompared) {
  const std::string name(200, 'a');
  EXPECT_EQ(suggestion(name + "b", {name}), "choose from " + name);
  EXPECT_EQ(suggestion(name.substr(1) + "b", {name}), "did you mean '" + name + "'?");
}

}  // namespace
}  // namespace dalembert::frontend
