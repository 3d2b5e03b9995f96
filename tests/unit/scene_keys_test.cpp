// The scene's schema: every key works in a file and as an option of the same name, and stands in docs/scene.md with an example.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "commands/options.hpp"
#include "frontend/scene_check.hpp"
#include "frontend/scene_plan.hpp"
#include "frontend/scene_reader.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/aliases.hpp"
#include "passes/build_tree.hpp"

namespace dalembert {
namespace {

// A value unlike the default, for the robot below.
struct Example {
  const char* key;
  const char* file;         // in a scene file
  const char* option;       // on the command line
  const char* beside = "";  // what a scene has to say besides
};
const Example examples[] = {
    {"base", "fixed", "fixed"},
    {"gravity", "[1, 0, -3]", "1,0,-3"},
    {"outputs", "[bias]", "bias"},
    {"functions", "{balance: [mass_matrix, momentum_matrix, l2]}", "balance=mass_matrix,momentum_matrix,l2"},
    {"coriolis", "christoffel", "christoffel"},
    {"forward_dynamics", "factorization", "factorization"},
    {"locked", "{b: 0.25}", "b=0.25"},
    {"cut", "[l3]", "l3"},
    {"joints", "{b: {helical: 0.01}}", "{b: {helical: 0.01}}"},
    {"mimic", "{b: {of: a, multiplier: -2}}", "{b: {of: a, multiplier: -2}}"},
    {"jacobians", "[l2, l3]", "l2,l3"},
    {"frames", "{l2: [pose, jacobian_mixed], sole: {link: l3, at: [0.1, 0, -0.02, 0, 0.3, 0], outputs: [pose]}}",
     "{l2: [pose, jacobian_mixed], sole: {link: l3, at: [0.1, 0, -0.02, 0, 0.3, 0], outputs: [pose]}}"},
    {"payloads", "[l3]", "l3"},
    {"wrenches", "{l2: world, l3: link}", "l2=world,l3=link"},
    {"contacts", "{l3: point, l2: {type: weld}}", "{l3: point, l2: weld}"},
    {"loops", "{rod: {links: [l1, l3], type: pin}}", "{rod: {links: [l1, l3], type: pin}}"},
    {"passive", "[b]", "b"},
    {"armature", "{a: 0.5, c: 0.25}", "a=0.5,c=0.25"},
    {"damping", "urdf", "urdf"},
    {"friction", "{a: 2}", "a=2"},
    {"stiffness", "{a: {k: 30, rest: 0}}", "a=30"},
    {"elastic", "{b: {k: 500, inertia: 0.1}}", "{b: {k: 500, inertia: 0.1}}"},
    {"massless", "lock", "lock"},
    {"inertia", "repair", "repair"},
    {"rates_zero", "true", "true"},
    {"scalar", "float", "float"},
    {"parallel", "tasks", "tasks"},
    {"plan", "{evaluate: {form: straight, order: newest_first}}", "{evaluate: {form: straight, order: newest_first}}"},
    {"batch", "true", "true"},
    {"rollouts", "[linearly_implicit]", "linearly_implicit",
     "batch: true\nmassless: lock\nfunctions: {step: [forward_dynamics]}\n"},
};

// Three joints in a row, with damping; then one that moves no mass. The second link's inertia is no body's.
std::string robot_text() {
  std::string text =
      "<robot name='r'><link name='tip'/><joint type='continuous' name='d'><parent link='l3'/><child link='tip'/>"
      "<axis xyz='0 1 0'/></joint>";
  for (int i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    text += "<link name='l" + n +
            "'><inertial><origin xyz='0.1 0.02 0.3'/><mass value='2'/>"
            "<inertia ixx='0.1' ixy='0.01' ixz='0.02' iyy='0.12' iyz='0.03' izz='" +
            (i == 1 ? "0.3" : "0.14") + "'/></inertial></link>";
    if (i > 0)
      text += std::string("<joint type='continuous' name='") + "abc"[i - 1] + "'><origin xyz='0 0.1 0.4'/><parent link='l" +
              std::to_string(i - 1) + "'/><child link='l" + n + "'/><axis xyz='0 1 0'/><dynamics damping='0.3'/></joint>";
  }
  return text + "</robot>";
}

// The files generated for a document, without the command line in their banners.
std::vector<backend::OutputFile> code_of(const frontend::SceneDocument& document) {
  Diagnostics warnings;
  Model model;
  model.description = frontend::read_urdf_text("r.urdf", robot_text(), warnings);
  model.name = "r";
  apply_scene(model, document, warnings);
  if (model.scene.linearly_implicit) return compile(model);       // of what nothing holds
  model.scene.outputs.push_back(ir::Quantity::forward_dynamics);  // which some keys are about
  if (!model.scene.any_constraint()) model.scene.contacts.push_back({"held", "l2"});
  model.tree.constraint_rows = model.scene.constraint_rows();
  model.scene.outputs.push_back(ir::Quantity::constrained_inverse_dynamics);
  return compile(model);
}

bool same(const std::vector<backend::OutputFile>& a, const std::vector<backend::OutputFile>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.name == y.name && x.text == y.text; });
}

TEST(SceneKeys, EachHasAnExampleHere) {
  std::vector<std::string> keys;
  for (const Example& example : examples) keys.emplace_back(example.key);
  EXPECT_EQ(keys, frontend::scene_keys());
}

TEST(SceneKeys, EachIsAnOptionThatDoesWhatTheFileDoes) {
  for (const Example& example : examples) {
    SCOPED_TRACE(example.key);
    const std::string beside = example.beside;
    const std::vector<backend::OutputFile> without = code_of(frontend::read_scene_text("r.yaml", beside, {}));
    CLI::App app;
    SharedOptions options(app);
    app.parse(std::vector<std::string>{example.option, std::string("--") + example.key, "r.urdf"});  // last word first
    const Request request = options.request();
    ASSERT_EQ(request.settings.size(), 1u);
    const auto by_option = code_of(frontend::read_scene_text("r.yaml", beside, request.settings));
    const auto by_file = code_of(frontend::read_scene_text("r.yaml", beside + example.key + ": " + example.file + "\n", {}));
    EXPECT_TRUE(same(by_option, by_file));
    EXPECT_FALSE(same(by_option, without)) << "the key has no effect";
  }
}

ir::Scene scene_of(const std::string& text) {
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", robot_text(), warnings);
  return frontend::check_scene(frontend::read_scene_text("r.yaml", text, {}), robot, warnings);
}

TEST(SceneJoints, ThatFloatInTheFileTurnAboutTheAxisThatItGives) {
  const auto axis_with = [](const std::string& axis) -> Eigen::Vector3d {
    Diagnostics warnings;
    const std::string text =
        "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><joint name='turn' type='continuous'>"
        "<parent link='a'/><child link='b'/><axis xyz='1 0 0'/></joint>"
        "<joint name='free' type='floating'><parent link='b'/><child link='c'/>" +
        axis + "</joint></robot>";
    const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", text, warnings);
    EXPECT_TRUE(warnings.empty()) << warnings.front().message;
    frontend::check_scene(frontend::read_scene_text("r.yaml", "base: fixed\njoints: {free: spherical}\n", {}), robot, warnings);
    frontend::check_scene(frontend::read_scene_text("r.yaml", "base: fixed\njoints: {free: planar}\n", {}), robot, warnings);
    return std::find_if(robot.joints.begin(), robot.joints.end(), [](const ir::Joint& j) { return j.name == "free"; })->axis;
  };
  EXPECT_EQ(axis_with("<axis xyz='0 0 2'/>"), Eigen::Vector3d::UnitZ());
  for (const char* none : {"", "<axis/>", "<axis xyz='0 0 0'/>", "<axis xyz='z'/>"})
    EXPECT_THROW(axis_with(none), InputError) << none;
}

TEST(SceneFrames, AreNamedInFunctionsAsTheyAreAskedForUnderFrames) {
  using ir::LinkQuantity;
  const std::string frames = "frames: {l2: [twist], sole: {link: l3, at: [0, 0, 1], outputs: [pose, jacobian_mixed]}}\n";
  const auto asked = [&](const std::string& items) {
    return scene_of(frames + "functions: {reach: " + items + "}\n").functions.front().of_links;
  };
  using All = std::vector<ir::LinkOutput>;
  const All of_sole{{LinkQuantity::pose, "sole"}, {LinkQuantity::jacobian_mixed, "sole"}};
  EXPECT_EQ(asked("[bias, sole]"), of_sole);
  EXPECT_EQ(asked("sole"), of_sole);
  EXPECT_EQ(asked("[l2, pose_sole]"), (All{{LinkQuantity::twist, "l2"}, {LinkQuantity::pose, "sole"}}));
  EXPECT_EQ(asked("{sole: twist, l3: [pose]}"), (All{{LinkQuantity::twist, "sole"}, {LinkQuantity::pose, "l3"}}));
  EXPECT_EQ(asked("[bias, {sole: [local_world_aligned]}, {heel: {link: l3, at: [0, 1, 0], outputs: [pose]}}]"),
            (All{{LinkQuantity::jacobian_mixed, "sole"}, {LinkQuantity::pose, "heel"}}));
  // jacobian_world of a frame tool and jacobian of a frame world_tool have one name: `frames` says whose it is.
  const std::string alike =
      "frames: {tool: {link: l3, outputs: [%]}, world_tool: {link: l2, outputs: []}}\nfunctions: {f: jacobian_world_tool}\n";
  const auto with = [&](const std::string& outputs) { return std::string(alike).replace(alike.find('%'), 1, outputs); };
  EXPECT_EQ(scene_of(with("jacobian_world")).functions.front().of_links, (All{{LinkQuantity::jacobian_world, "tool"}}));
  EXPECT_THROW(scene_of(with("pose")), InputError);
  // What `frames` says nothing of has what a link in a list has.
  EXPECT_EQ(asked("l1"), (All{{LinkQuantity::pose, "l1"},
                              {LinkQuantity::twist, "l1"},
                              {LinkQuantity::jacobian, "l1"},
                              {LinkQuantity::acceleration_bias, "l1"}}));
}

TEST(SceneFrames, OfAnOptionReplaceThoseOfTheFile) {
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", robot_text(), warnings);
  const frontend::SceneDocument document = frontend::read_scene_text(
      "r.yaml", "frames: {sole: {link: l3, at: [0, 0, 1]}}\nfunctions: {f: [{heel: {link: l3, at: [0, 1, 0]}}]}\n",
      {{"frames", "{toe: {link: l2, at: [1, 0, 0, 0, 0, 0.5], outputs: []}}"}, {"functions", "f=toe"}});
  const ir::Scene scene = frontend::check_scene(document, robot, warnings);
  EXPECT_EQ(scene.placed, (std::vector<ir::Frame>{{"toe", "l2", {1, 0, 0}, {0, 0, 0.5}}}));
  EXPECT_TRUE(scene.frames.empty());
  EXPECT_EQ(scene.functions.front().of_links.size(), 4u);
}

// The blocks of docs/scene.md between ```yaml and ```.
std::vector<std::string> documented_scenes() {
  std::ifstream file(DOCS "/scene.md");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::vector<std::string> blocks;
  for (size_t at = text.find("```yaml\n"); at != text.npos; at = text.find("```yaml\n", at + 1))
    blocks.push_back(text.substr(at + 8, text.find("```", at + 8) - at - 8));
  return blocks;
}

TEST(SceneKeys, EachStandsInTheDocumentationWithAnExampleThatMahruTakes) {
  std::set<std::string> shown;
  for (const std::string& block : documented_scenes()) {
    SCOPED_TRACE(block);
    const frontend::SceneDocument document = frontend::read_scene_text("docs/scene.md", block, {});
    shown.insert(document.given.begin(), document.given.end());
    Diagnostics warnings;
    const ir::RobotDescription mahru = frontend::read_urdf(MAHRU, warnings);
    const ir::Scene scene = frontend::check_scene(document, mahru, warnings);
    EXPECT_GT(passes::build_tree(mahru, scene, warnings).nv(), 0);
  }
  const std::vector<std::string>& keys = frontend::scene_keys();
  EXPECT_EQ(shown, std::set<std::string>(keys.begin(), keys.end()));

  std::ifstream file(DOCS "/scene.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(file, line) && (rows.empty() || !line.empty());)  // the first table is of keys
    if (line.starts_with("| `")) rows.push_back(line.substr(3, line.find('`', 3) - 3));
  EXPECT_EQ(rows, keys);
}

// A scene file, and what it becomes with the plan below.
struct PlanCase {
  const char *name, *before, *after;
};
const PlanCase plan_cases[] = {
    {"no text", "", "plan:\n  evaluate: {form: straight, order: newest_first}\n"},
    {"none", "base: fixed  # arm\n", "base: fixed  # arm\nplan:\n  evaluate: {form: straight, order: newest_first}\n"},
    {"without an end of line", "base: fixed", "base: fixed\nplan:\n  evaluate: {form: straight, order: newest_first}\n"},
    {"in a line", "plan: {evaluate: {form: rolled}}  # old\n\n# of the arm\nbase:   fixed\n",
     "plan:\n  evaluate: {form: straight, order: newest_first}\n\n# of the arm\nbase:   fixed\n"},
    {"in lines", "base: fixed\nplan:\n  evaluate:\n    form: rolled\n  # a comment of it\n\nlocked: {a: 0.1}\n",
     "base: fixed\nplan:\n  evaluate: {form: straight, order: newest_first}\n\nlocked: {a: 0.1}\n"},
    {"Windows' lines", "base: fixed\r\nplan: {}\r\nscalar: float\r\n",
     "base: fixed\r\nplan:\r\n  evaluate: {form: straight, order: newest_first}\r\nscalar: float\r\n"},
    {"a mark",
     "\xEF\xBB\xBF"
     "base: fixed\n",
     "\xEF\xBB\xBF"
     "base: fixed\nplan:\n  evaluate: {form: straight, order: newest_first}\n"},
};
const frontend::ScenePlan some_plan{{"evaluate", {ir::Form::straight, std::nullopt, ir::Order::newest_first}}};

TEST(ScenePlan, IsPutIntoAFileOfWhichNothingElseChanges) {
  for (const PlanCase& c : plan_cases) {
    SCOPED_TRACE(c.name);
    EXPECT_EQ(frontend::with_plan("s.yaml", c.before, some_plan), c.after);
    EXPECT_EQ(frontend::with_plan("s.yaml", c.after, some_plan), c.after) << "once more";
  }
}

TEST(ScenePlan, IsNotPutWhereAFileLeavesNoPlace) {
  for (const char* text : {"{base: fixed}\n", "{base: fixed, plan: {}}\n", "base: fixed\n...\n",
                           "\xFF\xFE"
                           "b\0:\0 \0",
                           "outputs: [mass_matrix,\n  bias\n", "# caf\xE9\nbase: fixed\n"}) {
    SCOPED_TRACE(text);
    try {
      frontend::with_plan("s.yaml", text, some_plan);
      ADD_FAILURE() << "it was put";
    } catch (const InputError& error) {
      EXPECT_EQ(error.diagnostics().front().file, "s.yaml");
      EXPECT_NE(error.diagnostics().front().remedy.find("plan:\n  evaluate: {form: straight, order: newest_first}\n"),
                std::string::npos)
          << "what to paste is not said";
    }
  }
}

// A row per quantity: "| `crba`, `joint_space_inertia` | `mass_matrix` |".
TEST(SceneKeys, TheFieldsNamesStandInTheDocumentation) {
  std::ifstream file(DOCS "/scene.md");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  for (const auto* aliases : {&ir::quantity_aliases(), &ir::link_quantity_aliases()})
    for (const ir::Alias& alias : *aliases) {
      const std::string ours = fmt::format("| `{}` |", alias.name), theirs = fmt::format("`{}`", alias.alias);
      EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
        return line.ends_with(ours) && line.find(theirs) < line.find(ours);
      })) << alias.alias;
    }
}

}  // namespace
}  // namespace dalembert
