#include "commands/build.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <link.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <dalembert/function_table.hpp>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <thread>

#include "backend/templates.hpp"
#include "commands/cache.hpp"
#include "commands/json.hpp"
#include "commands/output.hpp"
#include "ir/identifier.hpp"
#include "lower.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// ---- What an entry depends on

// The linker's hash of this program, or where it has none, its file.
std::string this_program() {
  std::string id;
  dl_iterate_phdr(
      [](dl_phdr_info* object, size_t, void* to) {
        for (int i = 0; i < object->dlpi_phnum; ++i) {
          const auto& header = object->dlpi_phdr[i];
          if (header.p_type != PT_NOTE) continue;
          const char* at = reinterpret_cast<const char*>(object->dlpi_addr + header.p_vaddr);
          const char* const end = at + header.p_memsz;
          while (at + sizeof(ElfW(Nhdr)) <= end) {
            const auto& note = *reinterpret_cast<const ElfW(Nhdr)*>(at);
            const char* const description = at + sizeof note + (note.n_namesz + 3u) / 4 * 4;
            if (note.n_type == NT_GNU_BUILD_ID) static_cast<std::string*>(to)->assign(description, note.n_descsz);
            at = description + (note.n_descsz + 3u) / 4 * 4;
          }
        }
        return 1;  // the first object is the program
      },
      &id);
  return id.empty() ? bytes_of("/proc/self/exe") : id;
}

// A program's file by its place, size and date: a compiler that is replaced has others.
std::string program(const std::string& word) {
  std::vector<fs::path> places{word};
  if (word.find('/') == word.npos) {
    places.clear();
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) places.push_back(fs::path(folder) / word);
  }
  for (const fs::path& place : places) {
    std::error_code error;
    const fs::path real = fs::canonical(place, error);
    struct stat is;
    if (!error && stat(real.c_str(), &is) == 0 && S_ISREG(is.st_mode))
      return fmt::format("{} {} {}.{}", real.string(), is.st_size, is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
  }
  return word;
}

// What -march=native goes by.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  std::string text;
  for (std::string line; std::getline(file, line) && !line.empty();)
    for (const char* key : {"vendor_id", "cpu family", "model", "flags", "Features", "CPU "})
      if (line.starts_with(key)) text += line + "\n";
  return text;
}

// The runtime's headers by their text, Eigen by its version.
void add_headers(Hash& hash) {
  for (const fs::path folder : include_folders()) {
    hash.add("Eigen", bytes_of(folder / "Eigen/src/Core/util/Macros.h"));
    std::error_code error;
    std::vector<fs::path> files;
    for (const fs::directory_entry& at : fs::recursive_directory_iterator(folder / "dalembert", error))
      if (at.path().extension() == ".hpp") files.push_back(at.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) hash.add(file.lexically_relative(folder).string(), bytes_of(file));
  }
}

std::string key_of(const Request& request, const CompilerOptions& options) {
  Hash hash;
  hash.add("program", this_program());
  for (const std::string& file : {request.robot, request.scene_file}) {
    hash.add("file", fs::path(file).filename().string());
    if (!file.empty()) hash.add("content", bytes_of(file));
  }
  for (const frontend::Setting& setting : request.settings) hash.add(setting.key, setting.text);
  hash.add("form", request.form);
  for (const std::string& pass : request.without) hash.add("without", pass);
  hash.add("name", request.name);
  for (const std::string& word : compiler_words(options)) hash.add("compiler", program(word));
  for (const std::string& word : compiler_and_flags(options)) hash.add("word", word);
  for (const char* variable : {"CPATH", "CPLUS_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH", "GCC_EXEC_PREFIX"})
    if (const char* const value = std::getenv(variable)) hash.add(variable, value);
  hash.add("processor", processor());
  add_headers(hash);
  return hash.digits();
}

// ---- What is generated

// A folder of generated code.
struct Part {
  Model model;
  std::vector<backend::OutputFile> files;
};

// One function of a part, as the table has it.
struct TableFunction {
  size_t part;
  ir::EmittedFunction function;
  std::vector<Output> results;
  bool of_one = false;  // an output alone, whose name the function bears in the table
  bool reads_velocities = true;
};

struct Library {
  std::vector<Part> parts;  // the whole scene first
  std::vector<TableFunction> functions;
};

std::vector<Output> results_of(const std::vector<Output>& outputs, const ir::EmittedFunction& function) {
  std::vector<Output> results;
  for (const Output& output : outputs)
    if (output.function.name == function.name && output.function.named == function.named) results.push_back(output);
  return results;
}

Library library_of(const Model& model, Diagnostics& warnings) {
  Library library;
  if (model.scene.parallel == ir::Parallel::tasks)
    warnings.push_back({Severity::warning, "", "key 'parallel'", "task graphs are left out of what programs load",
                        "give many states at once: they are computed on all cores"});
  const auto add_part = [&](Model part) {
    part.scene.parallel = ir::Parallel::serial;
    if (!library.parts.empty()) part.scene.batch = false;  // the controller's, in the whole scene's folder
    library.parts.push_back({std::move(part), {}});
    return library.parts.size() - 1;
  };
  add_part(model);
  const std::vector<Output> outputs = outputs_of(model);
  std::vector<TableFunction> alone;
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene)) {
    const std::vector<Output> results = results_of(outputs, function);
    library.functions.push_back({0, function, results});
    if (results.size() == 1 || function.named) continue;
    for (const Output& output : results) {
      Model part = with_outputs(model, {output});
      part.name = ir::identifier(output.name) + "_of_" + model.name;  // as no C function of the whole is called
      const ir::EmittedFunction of_one = ir::functions_of(part.scene).front();
      alone.push_back({add_part(std::move(part)), of_one, {output}, true});
    }
  }
  library.functions.insert(library.functions.end(), alone.begin(), alone.end());
  return library;
}

// What steps with rows of constraints do with v is theirs, not the program's.
bool steps_read_velocities(const ir::Algorithm& algorithm) {
  return std::any_of(algorithm.constraint_steps.begin(), algorithm.constraint_steps.end(),
                     [](const ir::ConstraintStep& step) { return step.kind != ir::ConstraintStep::Kind::delassus; });
}

// Which functions read v: of two halves, the first or the second.
void find_what_is_read(Library& library) {
  for (size_t p = 0; p < library.parts.size(); ++p) {
    std::map<std::string, bool> reads;
    for (const LoweredFunction& f : lower_to_programs(library.parts[p].model).functions) {
      const ir::EmittedFunction& function = f.algorithm.function;
      const std::string& called = function.first_half.empty() ? function.name : function.first_half;
      reads[called] |= steps_read_velocities(f.algorithm) ||
                       !ir::inputs_read(f.program, ir::uses(f.program.graph, f.program.roots())).velocities.empty();
    }
    for (TableFunction& f : library.functions)
      if (f.part == p) f.reads_velocities = reads[f.function.name];
  }
}

// The workspace's members that a scene has set at run time, and how many numbers they hold; 0: it is no array.
struct RunTimeInput {
  std::string name, unit, help;
  std::vector<std::pair<std::string, int>> members;
  std::vector<double> start;
  int size() const { return static_cast<int>(start.size()); }
};

std::vector<RunTimeInput> run_time_inputs(const Model& model) {
  std::vector<RunTimeInput> inputs;
  const ir::Scene& scene = model.scene;
  if (scene.gravity_kind == ir::GravityKind::run_time)
    inputs.push_back({"gravity_vector",
                      "m/s^2",
                      "gravity along the world's axes",
                      {{"gravity_vector", 3}},
                      {scene.gravity[0], scene.gravity[1], scene.gravity[2]}});
  for (const std::string& link : scene.payloads) {
    const std::string name = "payload_" + ir::identifier(link);
    inputs.push_back(
        {name,
         "kg, m, kg m^2",
         fmt::format("what link {} carries: mass, centre of mass, inertia xx xy xz yy yz zz about it; link axes", link),
         {{name + ".mass", 0}, {name + ".com", 3}, {name + ".inertia", 6}},
         std::vector<double>(10, 0.0)});
  }
  for (const ir::ExternalWrench& wrench : scene.wrenches) {
    const std::string name = "wrench_" + ir::identifier(wrench.link);
    inputs.push_back({name,
                      "N, N m",
                      fmt::format("force and moment on link {} at its origin, along {} axes", wrench.link,
                                  wrench.in_world ? "the world's" : "its"),
                      {{name, 6}},
                      std::vector<double>(6, 0.0)});
  }
  for (const ir::Constraint& c : scene.constraints()) {
    const std::string& name = c.member;
    const int rows = c.rows;
    if (c.loop) {
      std::vector<double> start(static_cast<size_t>(4 + 2 * rows), 0.0);
      start[0] = 1;  // active
      std::fill(start.end() - rows, start.end(), 1.0);
      inputs.push_back(
          {name,
           "1, 1/s^2, 1/s, 1, 1/kg",
           fmt::format("how {0} hold each other: active (1 or 0), kp, kd, restitution, regularization ({1}), weight ({1})",
                       c.of, rows),
           {{name + ".active", 0},
            {name + ".kp", 0},
            {name + ".kd", 0},
            {name + ".restitution", 0},
            {name + ".regularization", rows},
            {name + ".weight", rows}},
           start});
      continue;
    }
    std::vector<double> start(static_cast<size_t>(11 + 2 * rows), 0.0);
    start[0] = start[10] = 1;  // active; the anchor's quaternion
    std::fill(start.end() - rows, start.end(), 1.0);
    inputs.push_back({name,
                      "1, 1/s^2, 1/s, 1, m, 1/kg",
                      fmt::format("how {0} is held: active (1 or 0), kp, kd, restitution, anchor (3, quaternion x y z w), "
                                  "regularization ({1}), weight ({1})",
                                  c.of, rows),
                      {{name + ".active", 0},
                       {name + ".kp", 0},
                       {name + ".kd", 0},
                       {name + ".restitution", 0},
                       {name + ".anchor", 7},
                       {name + ".regularization", rows},
                       {name + ".weight", rows}},
                      start});
  }
  return inputs;
}

// ---- The table's source

std::string set_run_time_inputs(const Model& model) {
  std::string text;
  int at = 0;
  for (const RunTimeInput& input : run_time_inputs(model))
    for (const auto& [member, size] : input.members) {
      if (member.ends_with(".active")) text += fmt::format("    workspace.{} = values[{}] != 0;\n", member, at);
      else if (size == 0) text += fmt::format("    workspace.{} = values[{}];\n", member, at);
      else text += fmt::format("    for (int i = 0; i < {1}; ++i) workspace.{0}[i] = values[{2} + i];\n", member, size, at);
      at += std::max(size, 1);
    }
  return text;
}

// A class of what dalembert/function_table.hpp calls.
std::string table_class(const Library& library, size_t index) {
  const TableFunction& f = library.functions[index];
  const Model& model = library.parts[f.part].model;
  const bool takes_more = *f.function.input() != 0;
  int inputs = 0;
  for (const RunTimeInput& input : run_time_inputs(model)) inputs += input.size();
  const std::string status = f.function.own_name("status"), set = set_run_time_inputs(model);
  std::string copies;
  for (size_t i = 0; i < f.results.size(); ++i)
    copies += fmt::format("    dalembert::table::copy_result<{}, {}>(workspace.{}, results[{}], state);\n", f.results[i].rows,
                          f.results[i].columns, f.results[i].name, i);
  return fmt::format(
      "struct Function{0} {{\n"
      "  using Scalar = {1}::Scalar;\n"
      "  using Workspace = {1}::Workspace;\n"
      "  static constexpr int run_time_inputs = {2};\n"
      "  static void set([[maybe_unused]] const Scalar* values, [[maybe_unused]] Workspace& workspace) noexcept {{\n{3}  }}\n"
      "  static void call(const Scalar* q, const Scalar* v, [[maybe_unused]] const Scalar* more, Workspace& workspace) "
      "noexcept {{\n"
      "    {1}::{4}(q, v{5}, workspace);\n  }}\n"
      "  static void copy(const Workspace& workspace, void* const* results, std::ptrdiff_t state) noexcept {{\n{6}  }}\n"
      "  template <class W>\n"
      "  static auto status(const W& workspace, int) noexcept -> decltype(static_cast<std::int32_t>(workspace.{7}.coordinate)) "
      "{{\n"
      "    return static_cast<std::int32_t>(workspace.{7}.coordinate);\n  }}\n"
      "  template <class W>\n"
      "  static std::int32_t status(const W&, long) noexcept {{\n    return -1;\n  }}\n"
      "  template <class W>\n"
      "  static constexpr auto has_status(int) noexcept -> decltype(sizeof(static_cast<const W*>(nullptr)->{7}) > 0) {{\n"
      "    return true;\n  }}\n"
      "  template <class W>\n"
      "  static constexpr bool has_status(long) noexcept {{\n    return false;\n  }}\n"
      "}};\n\n",
      index, model.name, inputs, set, f.function.name, takes_more ? ", more" : "", copies, status);
}

std::string table_name(const TableFunction& f) { return f.of_one ? f.results.front().name : f.function.name; }

std::string table_source(const Library& library) {
  std::string includes, functions, entries;
  for (const Part& part : library.parts)
    includes += fmt::format("#include \"{0}/dynamics.hpp\"\n#include \"{0}/self_test.hpp\"\n", part.model.name);
  for (size_t i = 0; i < library.functions.size(); ++i) {
    const TableFunction& f = library.functions[i];
    functions += table_class(library, i);
    entries += fmt::format("    dalembert::table::entry<Function{}>(\"{}\", {}, {}::self_test),\n", i, table_name(f),
                           f.results.size(), library.parts[f.part].model.name);
  }
  return backend::render("function_table.cpp", {{"name", library.parts.front().model.name},
                                                {"includes", includes},
                                                {"functions", functions},
                                                {"entries", entries},
                                                {"count", std::to_string(library.functions.size())}});
}

// ---- Compiling

// Each as soon as a core is free; throws what the first that failed threw.
void in_parallel(size_t count, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  std::vector<std::exception_ptr> thrown(count);
  const auto take = [&] {
    for (size_t i; (i = next++) < count;) {
      try {
        work(i);
      } catch (...) {
        thrown[i] = std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::thread> others;
  for (size_t i = 1; i < std::min<size_t>(count, std::max(1u, std::thread::hardware_concurrency())); ++i)
    others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : thrown)
    if (error) std::rethrow_exception(error);
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw InputError({Severity::error, file.string(), "cache", "the file cannot be written",
                      "look for a full disk, or set XDG_CACHE_HOME to a folder with room"});
}

// `folder`/code.so of the sources there. What is written between goes into a folder that is removed.
void compile_library(const Library& library, const CompilerOptions& options, const fs::path& folder) {
  const fs::path sources = folder / "source", objects = folder / "objects";
  fs::create_directory(objects);
  std::vector<std::string> includes{"-fPIC", "-I" + sources.string()};
  for (const std::string& include : include_folders()) includes.insert(includes.end(), {"-isystem", include});
  struct Unit {
    fs::path source;
    bool for_speed;
  };
  // The longest first. What runs once need not be fast, and self-tests are one file, since most of it is headers.
  std::vector<Unit> units;
  std::string self_tests;
  for (const Part& part : library.parts) {
    for (const backend::OutputFile& file : part.files)
      if (file.name.ends_with(".cpp") && file.name != "c_api.cpp" && file.name != "self_test.cpp")
        units.push_back({sources / part.model.name / file.name, true});
    self_tests += fmt::format("#include \"{}/self_test.cpp\"\n", part.model.name);
  }
  write_text(objects / "self_tests.cpp", self_tests);
  write_text(objects / "function_table.cpp", table_source(library));
  units.push_back({objects / "self_tests.cpp", false});
  units.push_back({objects / "function_table.cpp", true});

  // The compiler's own files too: who kills it leaves them here.
  setenv("TMPDIR", objects.c_str(), 1);
  const auto command_of = [&](bool for_speed, std::vector<std::string> last) {
    std::vector<std::string> command = compiler_and_flags(options);
    if (!for_speed) command.push_back("-O0");
    command.insert(command.end(), includes.begin(), includes.end());
    command.insert(command.end(), last.begin(), last.end());
    return command;
  };
  // Where many files read the same headers, these are read once before; the code that comes of it is the same.
  std::vector<std::string> headers;
  if (units.size() > 8) {
    const std::string header = (objects / "headers.hpp").string();
    write_text(header, "#include <Eigen/Core>\n#include <dalembert/arguments.hpp>\n");
    run_compiler(command_of(true, {"-x", "c++-header", header, "-o", header + ".gch"}), objects / "headers.log");
    headers = {"-include", header};
  }
  std::vector<std::string> link = compiler_and_flags(options);
  link.push_back("-shared");
  for (size_t i = 0; i < units.size(); ++i) link.push_back((objects / fmt::format("{}.o", i)).string());
  link.insert(link.end(), {"-o", (folder / "code.so").string()});
  in_parallel(units.size(), [&](size_t i) {
    std::vector<std::string> last = units[i].for_speed ? headers : std::vector<std::string>{};
    last.insert(last.end(), {"-c", units[i].source.string(), "-o", (objects / fmt::format("{}.o", i)).string()});
    run_compiler(command_of(units[i].for_speed, std::move(last)), objects / fmt::format("{}.log", i));
  });
  run_compiler(link, objects / "link.log");
  std::error_code ignored;
  fs::remove_all(objects, ignored);
}

void run_self_tests(const fs::path& object) {
  void* const library = dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::runtime_error(std::string("the compiled code cannot be loaded: ") + dlerror());
  const auto table_of = reinterpret_cast<const FunctionTable* (*)()>(dlsym(library, "dalembert_function_table"));
  const FunctionTable& table = *table_of();
  std::string wrong;
  for (int i = 0; i < table.functions && wrong.empty(); ++i) {
    SelfTestReport report;
    if (table.entries[i].self_test(&report)) continue;
    char text[512];
    describe(report, text, sizeof text);
    wrong = text;
  }
  dlclose(library);
  if (!wrong.empty()) throw SelfTestFailure("the code does not compute on this machine what it should: " + wrong);
}

// ---- robot.json

std::string number(double x) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x > 0 ? "Infinity" : "-Infinity";  // as Python's json reads and writes them
  return fmt::format("{:.17g}", x);
}

std::string array(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

// The registry's row of an output: its axes without those of extent one, symbol, unit and help.
std::string output_json(const Output& output, const std::string& of_function) {
  std::vector<std::string> shape;
  std::string symbol, unit, help, quantity;
  const auto read = [&](const auto& row) {
    if (row.rows != ir::Extent::one) shape.push_back(std::to_string(output.rows));
    if (row.columns != ir::Extent::one) shape.push_back(std::to_string(output.columns));
    quantity = row.name;
    unit = row.unit;
    help = row.help;
  };
  if (output.quantity) {
    read(ir::row_of(*output.quantity));
    symbol = ir::row_of(*output.quantity).symbol;
  } else {
    read(ir::row_of(output.of_link));
  }
  std::string field = output.name;  // "mass_matrix" of the scene's "balance_mass_matrix"
  if (!of_function.empty() && field.starts_with(of_function + "_")) field = field.substr(of_function.size() + 1);
  return fmt::format(
      "{{\"name\": {}, \"field\": {}, \"quantity\": {}, \"link\": {}, \"shape\": {}, \"symbol\": {}, \"unit\": {}, \"help\": "
      "{}}}",
      json_string(output.name), json_string(field), json_string(quantity), json_string(output.link), array(shape),
      json_string(symbol), json_string(unit), json_string(help));
}

std::string functions_json(const Library& library) {
  std::vector<std::string> all;
  for (size_t i = 0; i < library.functions.size(); ++i) {
    const TableFunction& f = library.functions[i];
    std::vector<std::string> results;
    for (const Output& output : f.results) results.push_back(output_json(output, f.function.named ? f.function.name : ""));
    all.push_back(fmt::format(
        "\n    {{\"name\": {}, \"function\": {}, \"entry\": {}, \"takes\": {}, \"meaning\": {}, \"reads_velocities\": {}, "
        "\"named\": {}, \"alone\": {}, \"results\": {}}}",
        json_string(table_name(f)), json_string(f.function.named ? f.function.name : ir::row_of(f.function.inputs).name), i,
        json_string(f.function.input()), json_string(f.function.meaning()), f.reads_velocities, f.function.named, f.of_one,
        array(results)));
  }
  return array(all);
}

std::string run_time_json(const Model& model) {
  std::vector<std::string> all;
  for (const RunTimeInput& input : run_time_inputs(model)) {
    std::vector<std::string> start;
    for (const double x : input.start) start.push_back(number(x));
    all.push_back(fmt::format("{{\"name\": {}, \"unit\": {}, \"help\": {}, \"start\": {}}}", json_string(input.name),
                              json_string(input.unit), json_string(input.help), array(start)));
  }
  return array(all);
}

std::string robot_json(const Library& library, const Request& request, const CompilerOptions& options,
                       std::uintmax_t code_bytes, const Diagnostics& warnings) {
  const Model& model = library.parts.front().model;
  const ir::KinematicTree& tree = model.tree;
  std::vector<std::string> joints, types, bodies, links, said, lower, upper, velocity, effort;
  if (tree.floating_base) bodies.push_back(tree.base_link);
  for (const ir::Body& body : tree.bodies) {
    bodies.push_back(body.name);
    if (body.driven()) continue;
    joints.push_back(body.joint);
    types.push_back(body.prismatic() ? "prismatic" : body.type == ir::JointType::continuous ? "continuous" : "revolute");
    ir::Limits limits;
    for (const ir::Joint& joint : model.description.joints)
      if (joint.name == body.joint) limits = joint.limits;
    lower.push_back(number(limits.lower));
    upper.push_back(number(limits.upper));
    velocity.push_back(number(limits.velocity));
    effort.push_back(number(limits.effort));
  }
  for (const ir::LinkPlacement& link : tree.links) links.push_back(link.link);
  for (const Diagnostic& d : warnings)
    if (d.severity != Severity::error)
      said.push_back(fmt::format("[{}, {}]", json_string(d.severity == Severity::warning ? "warning" : "notice"),
                                 json_string(to_string(d))));
  std::string command = model.command_line;
  for (const char* words : {"dalembert ", "generate "})
    if (command.starts_with(words)) command = command.substr(std::strlen(words));
  return fmt::format(
      "{{\n  \"command_line\": {},\n  \"robot\": {},\n  \"name\": {},\n  \"file\": {},\n  \"base\": \"{}\",\n  \"base_link\": "
      "{},\n  \"nq\": {},\n"
      "  \"nv\": {},\n  \"scalar\": \"{}\",\n  \"joints\": {},\n  \"joint_types\": {},\n  \"bodies\": {},\n  \"links\": {},\n"
      "  \"lower\": {},\n  \"upper\": {},\n  \"velocity\": {},\n  \"effort\": {},\n  \"functions\": {},\n  \"run_time\": {},\n"
      "  \"compiled_by\": {},\n  \"code_bytes\": {},\n  \"said\": {}\n}}\n",
      json_string(command), json_string(tree.robot), json_string(model.name), json_string(request.robot),
      tree.floating_base ? "floating" : "fixed", json_string(tree.base_link), tree.nq(), tree.nv(),
      model.scene.scalar == ir::ScalarType::float32 ? "float32" : "float64", json_array(joints), json_array(types),
      json_array(bodies), json_array(links), array(lower), array(upper), array(velocity), array(effort),
      functions_json(library), run_time_json(model),
      json_string(fmt::format("{}", fmt::join(compiler_and_flags(options), " "))), code_bytes, array(said));
}

void make(const Request& request, const CompilerOptions& options, Diagnostics& warnings, const fs::path& folder) {
  const Model model = read_model(request, warnings);
  Library library = library_of(model, warnings);
  in_parallel(library.parts.size(), [&](size_t i) {
    Part& part = library.parts[i];
    part.files = compile(part.model);
    backend::write_files((folder / "source" / part.model.name).string(), part.files);
  });
  find_what_is_read(library);
  compile_library(library, options, folder);
  run_self_tests(folder / "code.so");
  write_text(folder / entry_file, robot_json(library, request, options, fs::file_size(folder / "code.so"), warnings));
}

}  // namespace

std::string build(const Request& request, const CompilerOptions& options, Diagnostics& warnings) {
  return cached(key_of(request, options), [&](const fs::path& folder) { make(request, options, warnings, folder); }).string();
}

std::string command_line_of(const fs::path& entry) {
  std::ifstream file(entry / entry_file);
  constexpr std::string_view key = "  \"command_line\": ";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key)) return line.substr(key.size() + 1, line.size() - key.size() - 3);
  return "";
}

std::string registry_text() {
  std::string text;
  for (const ir::QuantityRow& row : ir::quantities())
    text += fmt::format("{:<34}{:<10}{:<34}{}\n", row.name, row.symbol, row.unit, row.help);
  text += "\nof links, named QUANTITY_LINK:\n";
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    text += fmt::format("{:<34}{:<10}{:<34}{}\n", row.name, "", row.unit, row.help);
  return text;
}

std::string registry_json() {
  std::vector<std::string> quantities, of_links;
  for (const ir::QuantityRow& row : ir::quantities()) {
    const ir::FunctionRow& function = ir::row_of(row.function);
    quantities.push_back(
        fmt::format("\n    {{\"name\": {}, \"symbol\": {}, \"function\": {}, \"takes\": {}, \"unit\": {}, \"by_default\": {}, "
                    "\"help\": {}}}",
                    json_string(row.name), json_string(row.symbol), json_string(function.name), json_string(function.input),
                    json_string(row.unit), row.by_default, json_string(row.help)));
  }
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    of_links.push_back(fmt::format("\n    {{\"name\": {}, \"unit\": {}, \"by_default\": {}, \"help\": {}}}",
                                   json_string(row.name), json_string(row.unit), row.by_default, json_string(row.help)));
  return fmt::format("{{\n  \"quantities\": {},\n  \"link_quantities\": {},\n  \"scene_keys\": {}\n}}\n", array(quantities),
                     array(of_links), json_array(frontend::scene_keys()));
}

}  // namespace dalembert
