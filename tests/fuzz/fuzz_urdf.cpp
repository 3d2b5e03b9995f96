// Bytes as a URDF: read, checked with several scenes, and made a tree.
#include <algorithm>
#include <cstdint>
#include <string>

#include "frontend/scene_reader.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/urdf_reader.hpp"
#include "frontend/xml_document.hpp"
#include "frontend/xml_extent.hpp"
#include "pipeline.hpp"
#include "require.hpp"
#include "time_limit.hpp"

namespace {

using namespace dalembert;

const std::vector<frontend::SceneDocument>& scenes() {
  static const std::vector<frontend::SceneDocument> scenes = [] {
    std::vector<frontend::SceneDocument> all;
    for (const char* text : {"", "{base: fixed, damping: urdf, friction: urdf, massless: lock, inertia: repair}",
                             "{base: floating, mimic: urdf, inertia: accept}"})
      all.push_back(frontend::read_scene_text("scene.yaml", text, {}));
    return all;
  }();
  return scenes;
}

int depth(const TiXmlNode& node) {
  int deepest = 0;
  for (const TiXmlNode* child = node.FirstChild(); child; child = child->NextSibling())
    deepest = std::max(deepest, depth(*child));
  return deepest + (node.ToElement() ? 1 : 0);
}

// TinyXML never goes deeper than xml_extent says, or its recursion would not be bounded.
void check_extent(const std::string& text) {
  TiXmlDocument document;
  try {
    frontend::parse_xml(document, "fuzz.urdf", frontend::as_utf8(text));
    fuzz::require(depth(document) <= frontend::xml_extent(frontend::as_utf8(text)).depth, "xml_extent is as deep as TinyXML");
  } catch (const InputError& error) {
    fuzz::check_diagnostics(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::TimeLimit limit;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (size % 8 == 0) check_extent(text);
  try {
    Diagnostics warnings;
    Model model;
    model.description = frontend::read_urdf_text("fuzz.urdf", text, warnings);
    for (const frontend::SceneDocument& scene : scenes()) try {
        apply_scene(model, scene, warnings);
        fuzz::check_tree(model.tree);
      } catch (const InputError& error) {
        fuzz::check_diagnostics(error);
      }
  } catch (const InputError& error) {
    fuzz::check_diagnostics(error);
  }
  return 0;
}
