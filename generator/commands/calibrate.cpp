#include "commands/calibrate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>
#include <vector>

#include "backend/estimate.hpp"
#include "backend/task_plan.hpp"
#include "commands/cache.hpp"
#include "commands/generated_engine.hpp"
#include "commands/json.hpp"
#include "commands/machine.hpp"
#include "commands/random_states.hpp"
#include "commands/temporary_folder.hpp"
#include "compile.hpp"
#include "frontend/numbers.hpp"
#include "frontend/text_file.hpp"
#include "frontend/yaml_text.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

namespace fs = std::filesystem;

// Branches of so many joints each on a base that stands, and what is computed of them in which form: between them they are made
// of every feature.
struct Case {
  int branches, joints;
  const char *outputs, *form;
};
constexpr Case cases[] = {
    {1, 7, "mass_matrix", "straight"},
    {1, 7, "mass_matrix,coriolis_matrix", "straight"},
    {1, 7, "bias", "straight"},
    {2, 5, "inverse_mass_matrix", "straight"},
    {3, 4, "forward_dynamics", "straight"},
    {3, 6, "forward_dynamics_dq", "straight"},
    {4, 6, "mass_matrix,coriolis_matrix", "rolled"},
    {4, 6, "bias", "rolled"},
    {4, 6, "forward_dynamics", "rolled"},
    {8, 3, "mass_matrix", "rolled"},
    {3, 8, "inverse_mass_matrix", "rolled"},
    {1, 50, "mass_matrix,coriolis_matrix", "rolled"},
    {1, 50, "bias", "rolled"},
    {5, 20, "mass_matrix,coriolis_matrix", "rolled"},
    {5, 20, "inverse_dynamics", "rolled"},
    {10, 20, "mass_matrix", "rolled"},
    {1, 200, "mass_matrix", "rolled"},
    {1, 300, "mass_matrix,coriolis_matrix", "rolled"},
    {5, 100, "mass_matrix,coriolis_matrix", "rolled"},
    {10, 40, "mass_matrix,coriolis_matrix", "rolled"},
};
// What several threads are timed with.
constexpr Case divided[] = {{1, 300, "mass_matrix,coriolis_matrix", "rolled"},
                            {5, 100, "mass_matrix,coriolis_matrix", "rolled"}};

// How much a constant may leave its committed value for an error: of few programs none is known well.
constexpr double trust = 0.02, least = 0.1, most = 10;

std::string urdf(const Case& c) {
  std::string text = "<robot name='calibration'><link name='base'/>\n";
  const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
  for (int b = 0; b < c.branches; ++b)
    for (int k = 0; k < c.joints; ++k)
      text += fmt::format(
          "<link name='l{0}_{1}'><inertial><origin xyz='0.1 0.01 0.02' rpy='0.1 0.2 0.3'/><mass value='2'/><inertia ixx='.01' "
          "iyy='.02' izz='.02' ixy='0.001' ixz='0' iyz='0'/></inertial></link>\n<joint name='j{0}_{1}' type='continuous'>"
          "<parent link='{2}'/><child link='l{0}_{1}'/><origin xyz='.2 0 0.01' rpy='0.1 0 0'/><axis xyz='{3}'/></joint>\n",
          b, k, k == 0 ? "base" : fmt::format("l{}_{}", b, k - 1), axes[k % 3]);
  return text + "</robot>\n";
}

Model model_of(const Case& c, const fs::path& folder, std::shared_ptr<const ir::MachineCosts> costs, const char* parallel) {
  const fs::path file = folder / "calibration.urdf";
  std::ofstream(file) << urdf(c);
  Request request;
  request.robot = file.string();
  request.settings = {{"base", "fixed"}, {"outputs", c.outputs}, {"parallel", parallel}};
  request.form = c.form;
  request.costs = std::move(costs);
  Diagnostics warnings;
  return read_model(request, warnings);
}

std::string name_of(const Case& c) { return fmt::format("{} x {} joints, {}, {}", c.branches, c.joints, c.outputs, c.form); }

struct Measured {
  std::string name;
  double nanoseconds = 0;
  backend::Features features{};
};

Measured measure(const Case& c, const fs::path& folder, const CompilerOptions& options, int lanes) {
  const Model model = model_of(c, folder, nullptr, "serial");
  GeneratedEngine engine(model, outputs_of(model), options);
  Measured measured{name_of(c)};
  std::map<std::string, backend::Features> of_functions;
  for (const auto& [function, features] : features(model, lower(model), lanes)) of_functions[function] = features;
  for (const auto& [function, time] : engine.time_per_function(random_states(model.tree, 8))) {
    measured.nanoseconds += time.median;
    for (size_t f = 0; f < backend::feature_count; ++f) measured.features[f] += of_functions.at(function)[f];
  }
  return measured;
}

double expected(const Measured& m, const std::vector<double>& constants) {
  double sum = 0;
  for (size_t f = 0; f < backend::feature_count; ++f) sum += constants[f] * m.features[f];
  return sum;
}

// Least squares of relative errors, coordinate by coordinate, beside the distance from the committed constants in the measure
// of how fast the machine is all in all.
std::vector<double> fitted(const std::vector<Measured>& all, const backend::Features& committed) {
  const std::vector<double> before(committed.begin(), committed.end());
  std::vector<double> ratios;
  for (const Measured& m : all) ratios.push_back(m.nanoseconds / expected(m, before));
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
  const double speed = ratios[ratios.size() / 2];
  std::vector<double> factors(before.size(), 1.0);
  const auto share = [&](const Measured& m, size_t f) { return speed * before[f] * m.features[f] / m.nanoseconds; };
  for (int round = 0; round < 500; ++round)
    for (size_t f = 0; f < factors.size(); ++f) {
      double square = trust, product = trust;
      for (const Measured& m : all) {
        double rest = 1;
        for (size_t g = 0; g < factors.size(); ++g)
          if (g != f) rest -= share(m, g) * factors[g];
        square += share(m, f) * share(m, f);
        product += share(m, f) * rest;
      }
      factors[f] = std::clamp(product / square, least, most);
    }
  for (size_t f = 0; f < factors.size(); ++f) factors[f] *= speed * before[f];
  return factors;
}

// Doubles in a register of the target that the compiler compiles for.
int lanes_of(const CompilerOptions& options) {
  const LoadedCode code("registers",
                        {{"registers.cpp",
                          "#include <dalembert/lanes.hpp>\nextern \"C\" int doubles_in_register() { return "
                          "dalembert::doubles_in_register; }\n"}},
                        options);
  const int lanes = code.function<int()>("doubles_in_register")();
  return std::clamp(lanes, backend::register_widths.front(), backend::register_widths.back());
}

// By what factor threads cost more or less than is committed: what is expected of two threads is linear in it.
void measure_threads(ir::MachineCosts& costs, const fs::path& folder, const CompilerOptions& options, std::string& text) {
  if (std::thread::hardware_concurrency() < 2) return;
  const auto on_two = [&](const Case& c, double factor) {
    auto with = std::make_shared<ir::MachineCosts>(costs);
    with->threads.coming *= factor, with->threads.parting *= factor;
    const Model model = model_of(c, folder, with, "tasks");
    return ir::schedule_tasks(tasks_of_functions(model, lower(model)).front().plan, 2).nanoseconds;
  };
  double factor = 0;
  std::vector<double> measured;
  for (const Case& c : divided) {
    const Model model = model_of(c, folder, std::make_shared<ir::MachineCosts>(costs), "tasks");
    GeneratedEngine engine(model, outputs_of(model), options, Besides::task_graphs);
    measured.push_back(engine.time_per_call(random_states(model.tree, 8)).median);
    const double without = on_two(c, 0), with = on_two(c, 1);
    factor += std::clamp((measured.back() - without) / (with - without), least, most) / std::size(divided);
  }
  for (size_t i = 0; i < std::size(divided); ++i)
    text += fmt::format("  {:<55} {:>10} {:>10}\n", name_of(divided[i]) + ", two threads", time_text(measured[i]),
                        time_text(on_two(divided[i], factor)));
  costs.threads.coming *= factor;
  costs.threads.parting *= factor;
}

fs::path file_of(const std::string& machine) {
  Hash hash;
  hash.add("machine", machine);
  return cache_folder() / "costs" / (hash.digits() + ".yaml");
}

void keep(const fs::path& file, const std::string& text) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const fs::path making = file.string() + ".making";
  std::ofstream out(making);
  out << text;
  out.close();
  if (!error && out) fs::rename(making, file, error);
  if (error || !out)
    throw InputError({Severity::error, file.string(), "cache", "what was measured cannot be written",
                      "make room, or set XDG_CACHE_HOME to a folder that can be written"});
}

}  // namespace

Calibration calibrate(const CompilerOptions& options) {
  const TemporaryFolder folder;
  Calibration all;
  ir::MachineCosts& costs = all.costs;
  costs.machine = this_machine().kind;
  costs.compiler = fmt::format("{}", fmt::join(compiler_and_flags(options), " "));
  costs.lanes = lanes_of(options);
  std::vector<Measured> measured;
  for (const Case& c : cases) measured.push_back(measure(c, folder.path(), options, costs.lanes));
  costs.per_feature = fitted(measured, backend::committed_constants(costs.lanes));
  all.text = fmt::format("{}\n{}, registers of {} doubles\n  {:<55} {:>10} {:>10}\n", costs.machine, costs.compiler,
                         costs.lanes, "", "measured", "expected");
  double squares = 0;
  for (const Measured& m : measured) {
    const double now = expected(m, costs.per_feature), error = now / m.nanoseconds - 1;
    all.text += fmt::format("  {:<55} {:>10} {:>10}\n", m.name, time_text(m.nanoseconds), time_text(now));
    squares += error * error;
    costs.largest_error = std::max(costs.largest_error, std::abs(error));
  }
  costs.error = std::sqrt(squares / static_cast<double>(measured.size()));
  measure_threads(costs, folder.path(), options, all.text);
  const fs::path file = file_of(costs.machine);
  keep(file, costs_text(costs));
  all.text += fmt::format("expected times are off by {:.0f} % (root of the mean square), at most by {:.0f} %\nkept in {}\n",
                          100 * costs.error, 100 * costs.largest_error, file.string());
  return all;
}

std::string costs_text(const ir::MachineCosts& costs) {
  std::string text = fmt::format(
      "# What this machine takes for what calls are made of, ns: by 'dalembert calibrate', for --calibrated.\nmachine: {}\n"
      "compiler: {}\nregister: {}\ncoming: {:.6g}\nparting: {:.6g}\n",
      json_string(costs.machine), json_string(costs.compiler), costs.lanes, costs.threads.coming, costs.threads.parting);
  for (size_t f = 0; f < backend::feature_count; ++f)
    text += fmt::format("{}: {:.6g}\n", backend::feature_names[f], costs.per_feature[f]);
  return text;
}

ir::MachineCosts costs_of_text(const std::string& text, const std::string& where) {
  const auto refuse = [&](const std::string& message) -> InputError {
    return InputError({Severity::error, where, "measured costs", message, "run 'dalembert calibrate' again"});
  };
  std::map<std::string, std::string> entries;
  try {
    const auto node = frontend::read_yaml(text);
    if (!node || !node->is_map()) throw refuse("they are no map of names and numbers");
    for (const frontend::YamlEntry& e : node->entries) entries[e.key.scalar] = e.value.scalar;
  } catch (const frontend::YamlError& error) {
    throw refuse(error.what());
  }
  const auto number = [&](const std::string& name) {
    const auto at = entries.find(name);
    const auto value = at == entries.end() ? std::nullopt : frontend::parse_number(at->second);
    if (!value || !std::isfinite(*value) || *value < 0)
      throw refuse(fmt::format("'{}' is no number that is not negative", name));
    return *value;
  };
  ir::MachineCosts costs;
  costs.machine = entries["machine"];
  costs.compiler = entries["compiler"];
  costs.lanes = static_cast<int>(number("register"));
  const auto& widths = backend::register_widths;
  if (std::find(widths.begin(), widths.end(), costs.lanes) == widths.end()) throw refuse("a register holds 2, 4 or 8 doubles");
  costs.threads = {number("coming"), number("parting")};
  for (const char* name : backend::feature_names) costs.per_feature.push_back(number(name));
  return costs;
}

std::shared_ptr<const ir::MachineCosts> calibrated_costs() {
  const std::string machine = this_machine().kind;
  const fs::path file = file_of(machine);
  if (!fs::exists(file))
    throw InputError({Severity::error, "", "option --calibrated",
                      fmt::format("nothing was measured on this machine ({}) yet", machine),
                      "run 'dalembert calibrate' first"});
  return std::make_shared<ir::MachineCosts>(
      costs_of_text(frontend::read_text_file(file.string(), "costs", frontend::yaml_bytes), file.string()));
}

}  // namespace dalembert
