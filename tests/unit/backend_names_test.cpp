// The backend knows no quantity and no role by name: whatever the registry and the algorithms call them, none stands in its
// sources.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "frontend/urdf_reader.hpp"
#include "ir/quantity.hpp"
#include "passes/build_tree.hpp"
#include "passes/normalise.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert {
namespace {

std::map<std::string, std::string> sources() {
  std::map<std::string, std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(BACKEND)) {
    std::ifstream file(entry.path());
    texts[entry.path().filename().string()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return texts;
}

TEST(Backend, KnowsNoQuantityByName) {
  const auto texts = sources();
  ASSERT_GT(texts.size(), 10u) << BACKEND;
  for (const ir::QuantityRow& row : ir::quantities()) {
    // "gravity" and "bias" are words of their own, and gravity_vector is an input: as names they are quoted or in the
    // workspace.
    const std::regex name("\"" + std::string(row.name) + "\"|workspace\\." + row.name + "\\b");
    for (const auto& [file, text] : texts) EXPECT_FALSE(std::regex_search(text, name)) << file << ": " << row.name;
  }
}

TEST(Backend, KnowsNoRoleByName) {
  Diagnostics warnings;
  ir::Scene scene;
  scene.outputs.clear();
  scene.contacts = {{"sole", "left_foot"}};
  for (const ir::QuantityRow& row : ir::quantities()) scene.outputs.push_back(row.quantity);
  std::set<std::string> names;
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    scene.base = base;
    const ir::KinematicTree tree = passes::build_tree(frontend::read_urdf(MAHRU, warnings), scene, warnings);
    for (const ir::EmittedFunction& f : ir::functions_of(scene))
      for (const ir::Algorithm& section : passes::describe(f, tree, passes::normalise(tree), scene, {}))
        for (const ir::Role& role : section.roles)
          if (role.source == ir::Source::sweep) names.insert(role.name);
  }
  ASSERT_GT(names.size(), 20u);
  for (const auto& [file, text] : sources())
    for (const std::string& name : names)
      for (const std::string& word : {"\"" + name + "\"", "scratch." + name})
        EXPECT_EQ(text.find(word), text.npos) << file << ": " << word;
}

}  // namespace
}  // namespace dalembert
