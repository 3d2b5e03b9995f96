#include "frontend/urdf_outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <unordered_map>

#include "frontend/numbers.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/urdf_elements.hpp"
#include "frontend/xml_document.hpp"

namespace dalembert::frontend {

namespace {

[[noreturn]] void refuse(const std::string& file, std::string element, std::string message, std::string remedy) {
  throw InputError({Severity::error, file, std::move(element), std::move(message), std::move(remedy)});
}

// Whether xacro would find a macro, here or in another file. No deeper than xml_depth.
bool has_macros(const TiXmlElement& element, bool outermost = true) {
  for (const TiXmlElement* e = element.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string_view tag = e->Value();
    if (tag == "xacro:macro" || tag == "xacro:include" || (outermost && tag == "include")) return true;
    if (has_macros(*e, false)) return true;
  }
  return false;
}

class OutlineReader {
 public:
  OutlineReader(const std::string& file, Diagnostics& warnings)
      : file_(file), warnings_(warnings), read_(file, errors_, warnings) {}

  UrdfOutline outline(const std::string& text) {
    TiXmlDocument document;
    const TiXmlElement& robot = root(document, text);
    UrdfOutline outline;
    outline.robot = robot_name(robot);
    read_.enter(fmt::format("robot '{}'", outline.robot));
    read_.has_macros(has_macros(robot));
    read_.only_attributes(robot, {"name", "version", "xmlns"});
    read_.only_children(robot, {},
                        {"link", "joint", "material", "transmission", "gazebo", "sensor", "mujoco", "plugin", "ros2_control"});

    std::unordered_map<std::string, int> lines;
    for (const TiXmlElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
      if (const std::optional<std::string> name = this->name(*e, "link", lines))
        outline.links.push_back(read_link(read_, *e, *name));
    lines.clear();
    for (const TiXmlElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      if (const std::optional<std::string> name = this->name(*e, "joint", lines))
        outline.joints.push_back(read_joint(read_, *e, *name));
    if (outline.links.empty()) {  // nothing but definitions
      read_.enter(fmt::format("robot '{}'", outline.robot));
      for (const TiXmlElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement())
        if (std::string_view(e->Value()).starts_with("xacro:") && !read_.is_lost_call(e->Value()))
          read_.note_xacro(*e, fmt::format("<{}>", e->Value()));
    }
    if (const std::optional<Diagnostic> xacro = read_.unexpanded_xacro()) throw InputError(*xacro);
    if (!errors_.empty()) throw InputError(errors_);
    if (outline.links.empty())
      refuse(file_, fmt::format("robot '{}'", outline.robot), "there are no links", "add at least one <link>");
    declare_world(outline);
    return outline;
  }

 private:
  // The <robot> element of a document that is XML.
  const TiXmlElement& root(TiXmlDocument& document, const std::string& text) {
    if (trimmed(text).empty()) refuse(file_, "", "the file is empty", "name a URDF file");
    const std::string utf8 = without_zeros_behind_robot(as_utf8(text));
    const size_t end = parse_xml(document, file_, utf8);
    if (!document.RootElement() && has_declarations_in_doctype(utf8))
      refuse(file_, "<!DOCTYPE>", "declarations inside of it cannot be read",
             "remove them, or have xmllint --noent put in what their entities stand for");
    if (document.Error() && !document.RootElement())
      refuse(file_, "", "this is not XML", "a URDF is an XML file whose root is <robot>");
    if (document.Error())
      refuse(file_, document.ErrorRow() > 0 ? fmt::format("line {}, column {}", document.ErrorRow(), document.ErrorCol()) : "",
             fmt::format("this is not well-formed XML: {}", document.ErrorDesc()), "close the tag or quote opened there");
    if (const TiXmlElement* robot = document.FirstChildElement("robot")) {
      check_beside(*robot, document);
      if (end < utf8.size())
        warn_of_outside(1 + std::count(utf8.begin(), utf8.begin() + static_cast<std::ptrdiff_t>(end), '\n'),
                        fmt::format("the text '{}'", excerpt(std::string_view(utf8).substr(end))));
      return *robot;
    }
    if (!document.RootElement()) refuse(file_, "", "this is not XML", "a URDF is an XML file whose root is <robot>");
    const bool sdf = document.RootElement()->ValueStr() == "sdf";
    refuse(file_, fmt::format("<{}> (line {})", document.RootElement()->Value(), document.RootElement()->Row()),
           "there is no <robot> element",
           sdf ? "call an SDF .sdf; where xacro prints it, expand it first: xacro FILE > robot.sdf"
               : "a URDF's root is <robot>; convert other formats such as MJCF to URDF first");
  }

  // TinyXML takes the first '>' for the end of DOCTYPE.
  static bool has_declarations_in_doctype(const std::string& text) {
    const size_t begin = text.find("<!DOCTYPE"), end = text.find('>', begin == text.npos ? 0 : begin);
    return begin != text.npos && text.find('[', begin) < end;
  }

  // Some writers end the file with the zero that ended their string. A zero elsewhere is refused: TinyXML stops there.
  std::string without_zeros_behind_robot(std::string text) {
    const size_t first = text.find('\0'), end = text.rfind("</robot");
    if (first == text.npos || end == text.npos || first < end) return text;
    const auto zeros = std::erase(text, '\0');
    warnings_.push_back(
        {Severity::warning, file_,
         fmt::format("line {}", 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(first), '\n')),
         zeros == 1 ? "a zero byte behind </robot> is ignored"
                    : fmt::format("{} zero bytes behind </robot> are ignored", zeros),
         "save the file as text"});
    return text;
  }

  // Elements outside of <robot> may be what the robot lacks; text and end tags are nothing.
  void check_beside(const TiXmlElement& robot, const TiXmlDocument& document) {
    for (const TiXmlNode* node = document.FirstChild(); node; node = node->NextSibling()) {
      if (node == &robot) continue;
      const std::string place = fmt::format("<{}> (line {})", node->Value(), node->Row());
      if (node->ToElement() && node->ValueStr() == "robot")
        refuse(file_, place, fmt::format("there is another <robot> in line {}", robot.Row()), "keep one robot in this file");
      if (node->ToElement()) refuse(file_, place, "it stands outside of <robot>", "move it into <robot>, or remove it");
      if (node->ToUnknown() && node->ValueStr().starts_with('/'))
        warn_of_outside(node->Row(), fmt::format("<{}>", node->Value()));
      if (node->ToText()) warn_of_outside(node->Row(), fmt::format("the text '{}'", excerpt(node->Value())));
    }
  }
  void warn_of_outside(std::ptrdiff_t line, const std::string& what) {
    warnings_.push_back(
        {Severity::warning, file_, fmt::format("line {}", line), what + " outside of <robot> is ignored", "remove it"});
  }

  std::string robot_name(const TiXmlElement& robot) {
    const char* attribute = robot.Attribute("name");
    if (std::string name(trimmed(attribute ? attribute : "")); !name.empty()) return name;
    const std::string stem = std::filesystem::path(file_).stem().string();
    const std::string name = stem.empty() ? "robot" : stem;
    read_.enter(fmt::format("robot '{}'", name));
    read_.warning(robot, "<robot> has no name; the file's is taken", "write <robot name=\"...\">");
    return name;
  }

  // The name of a link or joint, when it has one; an error when it is taken. `lines`: where the names met so far are.
  std::optional<std::string> name(const TiXmlElement& element, const char* kind, std::unordered_map<std::string, int>& lines) {
    read_.enter(fmt::format("{} number {}", kind, ++met_[kind]));
    const std::optional<std::string> name = read_.required(element, "name", fmt::format("write <{} name=\"...\">", kind));
    if (!name) return std::nullopt;
    read_.enter(fmt::format("{} '{}'", kind, *name));
    const auto [first, is_new] = lines.emplace(*name, element.Row());
    if (!is_new)
      read_.error(element, fmt::format("the name is already taken by the {} of line {}", kind, first->second),
                  "rename one of them");
    return name;
  }

  // Many files hang their robot on a link `world` that only the simulator knows.
  void declare_world(UrdfOutline& outline) {
    const auto on_world =
        std::find_if(outline.joints.begin(), outline.joints.end(), [](const JointOutline& j) { return j.parent == "world"; });
    if (on_world == outline.joints.end() ||
        std::any_of(outline.links.begin(), outline.links.end(), [](const LinkOutline& link) { return link.name == "world"; }))
      return;
    warnings_.push_back({Severity::warning, file_, place(*on_world), "its parent link 'world' does not exist; it is added",
                         "write <link name=\"world\"/>"});
    outline.links.insert(outline.links.begin(), LinkOutline{"world", on_world->line, std::nullopt});
  }

  std::string file_;
  Diagnostics errors_;
  Diagnostics& warnings_;
  ElementReader read_;
  std::map<std::string_view, int> met_;  // of each kind, with a name or without
};

}  // namespace

UrdfOutline read_outline(const std::string& file, const std::string& text, Diagnostics& warnings) {
  return OutlineReader(file, warnings).outline(text);
}

}  // namespace dalembert::frontend
