#include "backend/emit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/emit_batch.hpp"
#include "backend/emit_c.hpp"
#include "backend/emit_embedded.hpp"
#include "backend/emit_header.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/emit_self_test.hpp"
#include "backend/emit_straight.hpp"
#include "backend/emit_tasks.hpp"
#include "backend/estimate.hpp"
#include "backend/kernel_text.hpp"
#include "backend/layout.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

std::string banner(const Folder& folder) {
  return fmt::format(
      "// {} from {} (FNV-1a {}). Do not edit; remake with\n"
      "{}"
      "// This file is yours: no licence of the generator applies to it.",
      banner_mark, comment_text(folder.source), folder.source_hash, comment_lines("  " + folder.command_line, 0, 4));
}

std::string form_source(const CodeInput& code, const Symbol& symbol) {
  return code.is_rolled() ? rolled_source(code, symbol) : straight_source(code, symbol);
}

// The section in its form; or in both, and which of them it is on registers of what width.
std::string function_source(const CodeInput& code, const std::string& linkage) {
  const std::string& name = code.algorithm.section.name;
  if (!code.elsewhere) return form_source(code, {name, linkage});
  const auto symbol = [&](const CodeInput& form) {
    return Symbol{name + (form.is_rolled() ? "_in_loops" : "_in_one_line"), "[[maybe_unused]] static "};
  };
  const Symbol here = symbol(code), elsewhere = symbol(*code.elsewhere);
  std::vector<std::string> lanes;
  for (const int width : code.elsewhere_lanes)
    lanes.push_back(fmt::format("lanes {} {}",
                                width == register_widths.front()  ? "<="
                                : width == register_widths.back() ? ">="
                                                                  : "==",
                                width));
  return form_source(*code.elsewhere, elsewhere) + "\n" + form_source(code, here) +
         fmt::format(
             "\n// In the form that is faster on the target's registers.\n"
             "void {0}({1}, Workspace& workspace) noexcept {{\n"
             "  constexpr int lanes = dalembert::native_lanes;\n"
             "  if constexpr ({2}) {3}({5}, workspace);\n"
             "  else {4}({5}, workspace);\n"
             "}}\n",
             name, parameters_of(code), fmt::join(lanes, " || "), elsewhere.name, here.name, arguments_of(code));
}

// All of a function: what it calls, then its sections, each behind the declaration of the next.
std::string definitions(const CodeInput& function) {
  std::string text;
  if (function.opened) text += opened_scope(*function.opened, function_source(*function.opened, "static "));
  for (const CodeInput* section = &function; section; section = section->next) {
    if (section->next) text += "\n" + section_declaration(*section->next);
    text += function_source(*section, section == &function ? "" : "static ") + solve_definition(*section);
  }
  return text;
}

std::string source(const Folder& folder, const std::string& banner) {
  std::set<std::string> headers{"narrow_packing"};  // for whatever is written here
  for (const CodeInput* f : folder.sections())
    for (const CodeInput* form : {f, f->elsewhere})
      if (form)
        for (const std::string& header : form->is_rolled() ? rolled_includes(*form) : straight_includes(*form))
          headers.insert(header);
  std::string includes;
  for (const std::string& header : headers) includes += fmt::format("#include <dalembert/{}.hpp>\n", header);
  std::string functions;
  for (const CodeInput& function : folder.functions) functions += definitions(function);
  return render("dynamics.cpp", {{"banner", banner},
                                 {"name", folder.common().name},
                                 {"code", code_mark},
                                 {"includes", includes},
                                 {"functions", linkage_structs(folder.common()) + functions}});
}

}  // namespace

std::vector<ir::OutputArray> Folder::arrays() const {
  std::vector<ir::OutputArray> all;
  for (const CodeInput& f : functions)
    for (const ir::OutputArray& a : f.program.arrays)
      if (!a.internal) all.push_back(a);
  return all;
}

std::vector<const CodeInput*> Folder::sections() const {
  std::vector<const CodeInput*> all;
  for (const CodeInput& function : functions)
    for (const CodeInput* section : sections_of(function)) all.push_back(section);
  return all;
}

std::vector<const CodeInput*> sections_of(const CodeInput& function) {
  std::vector<const CodeInput*> all;
  for (const CodeInput* section = &function; section; section = section->next) all.push_back(section);
  if (function.opened) all.push_back(function.opened);
  return all;
}

bool Folder::tasks() const {
  return std::any_of(functions.begin(), functions.end(), [](const CodeInput& f) { return f.plan.tasks; });
}

std::vector<OutputFile> emit(const Folder& folder) {
  const std::string &name = folder.common().name, top = banner(folder);
  std::vector<OutputFile> files{header(folder, top), {"dynamics.cpp", source(folder, top)}};
  std::string guard = name + "_C_API_H";
  CText c = c_functions(folder);
  c.declarations += batch_c_declarations(folder);
  std::transform(guard.begin(), guard.end(), guard.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  files.push_back({"c_api.h", render("c_api.h", {{"banner", top},
                                                 {"guard", guard},
                                                 {"includes", folder.common().scene.batch ? "\n#include <stddef.h>\n" : ""},
                                                 {"name", name},
                                                 {"layout", c_layout(folder.common())},
                                                 {"declarations", c.declarations}})});
  files.push_back({"c_api.cpp", render("c_api.cpp", {{"banner", top}, {"name", name}, {"definitions", c.definitions}})});
  if (folder.tasks()) {
    files.push_back({"tasks.hpp", tasks_header(folder, top)});
    files.push_back({"tasks.cpp", tasks_source(folder, top)});
  }
  for (OutputFile& file : batch_files(folder, top)) files.push_back(std::move(file));
  if (folder.self_test)
    for (OutputFile& file : self_test_files(folder, *folder.self_test, top)) files.push_back(std::move(file));
  // The banner tells where they are from, and how they were asked for; what a workspace begins with is in the header.
  name_by_content(files, files[0].text.substr(top.size()) + files[1].text.substr(top.size()));
  return files;
}

}  // namespace dalembert::backend
