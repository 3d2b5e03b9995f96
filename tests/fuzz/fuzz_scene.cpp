// Bytes as a scene for a small robot. Lines "--key value" at the beginning are options, the rest is the file.
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "frontend/scene_reader.hpp"
#include "frontend/urdf_reader.hpp"
#include "pipeline.hpp"
#include "require.hpp"
#include "time_limit.hpp"

namespace {

using namespace dalembert;

Model model() {
  std::string text = "<robot name='r'>";
  for (const char* link : {"base", "upper", "fore", "hand", "finger", "thumb", "tool"})
    text += "<link name='" + std::string(link) +
            "'><inertial><origin xyz='0.1 0 0.2'/><mass value='1'/>"
            "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
  const auto joint = [&](const char* name, const char* type, const char* parent, const char* child, const char* more) {
    text += "<joint name='" + std::string(name) + "' type='" + type + "'><origin xyz='0 0 0.3' rpy='0.1 0 0'/><parent link='" +
            parent + "'/><child link='" + child + "'/><axis xyz='0 1 0'/>" + more + "</joint>";
  };
  joint("shoulder", "continuous", "base", "upper", "<dynamics damping='0.2' friction='0.1'/>");
  joint("elbow", "revolute", "upper", "fore", "");
  joint("wrist", "revolute", "fore", "hand", "<dynamics damping='0.1'/>");
  joint("grip", "prismatic", "hand", "finger", "");
  joint("close", "prismatic", "hand", "thumb", "<mimic joint='grip' multiplier='-1' offset='0.01'/>");
  joint("weld", "fixed", "upper", "tool", "");
  Diagnostics warnings;
  Model model;
  model.description = frontend::read_urdf_text("r.urdf", text + "</robot>", warnings);
  return model;
}

// Takes the first line away when it is an option the command line knows.
bool take_setting(std::string_view& text, std::vector<frontend::Setting>& settings) {
  if (!text.starts_with("--")) return false;
  const std::string_view line = text.substr(2, text.find('\n') - 2);
  const std::string key(line.substr(0, line.find(' ')));
  const std::vector<std::string>& keys = frontend::scene_keys();
  if (key.size() >= line.size() || std::find(keys.begin(), keys.end(), key) == keys.end()) return false;
  settings.push_back({key, std::string(line.substr(key.size() + 1))});
  text.remove_prefix(std::min(text.size(), line.size() + 3));
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::TimeLimit limit;
  std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<frontend::Setting> settings;
  while (take_setting(text, settings)) continue;
  try {
    Diagnostics warnings;
    const frontend::SceneDocument document = frontend::read_scene_text("scene.yaml", std::string(text), settings);
    static Model robot = model();
    apply_scene(robot, document, warnings);
    fuzz::check_tree(robot.tree);
  } catch (const InputError& error) {
    fuzz::check_diagnostics(error);
  }
  return 0;
}
