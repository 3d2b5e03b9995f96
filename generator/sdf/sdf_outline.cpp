// The SDF as an outline, by libsdformat: a library of its own, which the generator opens when it is given an SDF. libsdformat
// takes longer to load than everything else that a command of the cache does.
#include "frontend/sdf_outline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <sdf/sdf.hh>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <vector>

#include "frontend/nearest.hpp"
#include "frontend/numbers.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/urdf_outline.hpp"
#include "sdf/sdf_text.hpp"

namespace dalembert::frontend {

namespace {

using ignition::math::Pose3d;

constexpr double same_place = 1e-12;  // m, rad: rounding of resolved poses

Eigen::Vector3d vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

Eigen::Quaterniond quaternion(const ignition::math::Quaterniond& q) {
  return Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized();
}

bool is_identity(const Pose3d& pose) {
  return pose.Pos().Length() < same_place && 2 * quaternion(pose.Rot()).vec().norm() < same_place;
}

// What products of a few quaternions leave where a turn was meant to be square: more than the compiler takes for rounding.
Eigen::Matrix3d rotation(const ignition::math::Quaterniond& q) {
  constexpr double dust = 1e-15;
  Eigen::Matrix3d result = quaternion(q).toRotationMatrix();
  for (double& entry : result.reshaped())
    for (double exact : {0., 1., -1.})
      if (std::abs(entry - exact) < dust) entry = exact;
  return result;
}

Frame frame(const Pose3d& pose) { return {vector(pose.Pos()), Eigen::Vector3d::Zero(), rotation(pose.Rot())}; }

std::string text_of(const sdf::ElementPtr& element) {
  return element->GetValue() ? std::string(trimmed(element->GetValue()->GetAsString())) : std::string();
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The numbers of an element as they are written.
template <size_t count>
std::optional<std::array<double, count> > written_numbers(const sdf::ElementPtr& element) {
  const std::optional<std::vector<double> > all = parse_numbers(text_of(element));
  if (!all || all->size() != count) return std::nullopt;
  std::array<double, count> numbers{};
  std::copy(all->begin(), all->end(), numbers.begin());
  return numbers;
}

// The six numbers of an element's <pose> as they are written; none where it has other units, another format, or no such
// element.
std::optional<Frame> written_pose(const sdf::ElementPtr& element) {
  if (!element || !element->HasElement("pose")) return std::nullopt;
  const sdf::ElementPtr pose = element->GetElement("pose");
  if ((pose->HasAttribute("degrees") && pose->Get<bool>("degrees")) ||
      (pose->HasAttribute("rotation_format") && pose->Get<std::string>("rotation_format") != "euler_rpy"))
    return std::nullopt;
  const auto n = written_numbers<6>(pose);
  if (!n) return std::nullopt;
  return Frame{{(*n)[0], (*n)[1], (*n)[2]}, {(*n)[3], (*n)[4], (*n)[5]}, {}};
}

int line_of(const sdf::ElementPtr& element) { return element ? element->LineNumber().value_or(0) : 0; }

// A folder for copies of files, removed in the end.
class Folder {
 public:
  Folder() = default;
  ~Folder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  // The path of a file with the text; empty where it cannot be written.
  std::string file(const std::string& name, const std::string& text) {
    std::error_code ignored;
    if (path_.empty()) {
      std::string pattern = (std::filesystem::temp_directory_path(ignored) / "dalembert.sdf.XXXXXX").string();
      if (!mkdtemp(pattern.data())) return "";
      path_ = pattern;
    }
    const std::string path = (path_ / name).string();
    std::ofstream file(path, std::ios::binary);
    return file << text && file.flush() ? path : "";
  }

 private:
  std::filesystem::path path_;
};

class SdfReader {
 public:
  SdfReader(const std::string& file, Diagnostics& warnings) : file_(file), warnings_(warnings) {}

  UrdfOutline read() {
    try {
      return read_file();
    } catch (const std::logic_error& error) {  // of std::stoi and its like, where libsdformat does not look before
      throw InputError({Severity::error, file_, "SDF", fmt::format("libsdformat cannot read it, and fails ({})", error.what()),
                        "correct versions and <uri>s, in what it includes and in the model.config beside that too"});
    }
  }

 private:
  UrdfOutline read_file() {
    sdf::Console::Instance()->SetQuiet(true);
    for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH"})
      if (const char* const folders = std::getenv(variable)) config_.AddURIPath("model://", folders);
    const SdfText sdf = essential(file_);
    if (!sdf.root.empty() && sdf.root != "sdf" && sdf.root != "gazebo")  // the latter in files of 2011
      throw InputError({Severity::error, file_, fmt::format("<{}>", sdf.root), "the root of an SDF is <sdf>",
                        sdf.root == "robot" ? "call a URDF .urdf" : "name an SDF"});
    stop_on_errors();
    sdf::Root root;
    const sdf::Errors errors = root.LoadSdfString(sdf.text, config_);
    take_causes(errors, sdf.root);
    stop_on_errors();
    warn_of_doubts(sdf.text, errors);
    const sdf::Model& model = only_model(root);
    outline_.robot = model.Name();
    if (!is_identity(model.RawPose()) || !model.PlacementFrameName().empty())
      ignore("model", model.Name(), "its pose in the world",
             "a fixed base's frame is the model's; a floating base's pose is in q");
    add_model(model, "", Pose3d());
    refuse_loops_to_nowhere();
    stop_on_errors();
    place_root();
    return std::move(outline_);
  }

  // The text without what is idle. Included files are given to libsdformat as copies of which the same holds.
  SdfText essential(const std::string& path, int depth = 0) {
    const std::string text = bytes_of(path);
    if (depth > 0) include(path, text);
    else outline_.text = text;
    SdfText sdf =
        without_idle_elements(as_utf8(text), [&](const std::string& uri) { return copy_of_included(uri, path, depth); });
    for (Diagnostic& error : sdf.errors) {
      error.file = path;
      add_error(errors_, std::move(error));
    }
    for (Diagnostic& warning : sdf.warnings) {
      warning.file = path;
      warnings_.push_back(std::move(warning));
    }
    return sdf;
  }
  void include(const std::string& path, const std::string& text) {
    std::vector<std::string>& files = outline_.included;
    if (std::find(files.begin(), files.end(), path) != files.end()) return;
    files.push_back(path);
    outline_.text += text;
  }
  std::string copy_of_included(const std::string& uri, const std::string& from, int depth) {
    constexpr int deepest = 20;  // files that include themselves
    std::string path = sdf::findFile(uri, true, true, config_);
    if (path.empty() && uri.find("://") == std::string::npos) path = (std::filesystem::path(from).parent_path() / uri).string();
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
      for (const char* name : {"model.config", "manifest.xml"})  // of which one says what the model's file is
        if (const auto config = std::filesystem::path(path) / name; std::filesystem::is_regular_file(config, ignored))
          include(config.string(), bytes_of(config.string()));
      path = sdf::getModelFilePath(path);
    }
    if (!std::filesystem::is_regular_file(path, ignored)) return "";  // libsdformat says so
    if (depth == deepest) {
      add_error(errors_, {Severity::error, from, fmt::format("<uri>{}</uri>", uri), "files include each other without end",
                          "remove one <include>"});
      return "";
    }
    if (const auto known = copies_.find(path); known != copies_.end()) return known->second;
    const SdfText sdf = essential(path, depth + 1);
    if (sdf.root != "sdf") return "";
    const std::string copy = folder_.file(fmt::format("{}.sdf", copies_.size()), sdf.text);
    if (!copy.empty()) copies_.emplace(path, copy), originals_.emplace(copy, path);
    return copy;
  }

  void take(const sdf::Errors& errors) {
    for (const sdf::Error& error : errors) take(error, "correct the element it names");
  }
  void take(const sdf::Error& error, const std::string& remedy) {
    add_error(errors_, diagnostic(Severity::error, error, "libsdformat says: " + error.Message(), remedy));
  }
  Diagnostic diagnostic(Severity severity, const sdf::Error& error, std::string what, std::string remedy) const {
    return {severity, original_of(error.FilePath().value_or("")),
            error.LineNumber() ? fmt::format("line {}", *error.LineNumber()) : std::string("SDF"), std::move(what),
            std::move(remedy)};
  }
  // The file as it is called where a copy was read.
  const std::string& original_of(const std::string& path) const {
    const auto original = originals_.find(path);
    return original == originals_.end() ? file_ : original->second;
  }
  // What libsdformat holds against a file that it reads all the same. Elements are told by their descriptions:
  // warn_of_elements().
  void warn_of_doubts(const std::string& text, const sdf::Errors& known) {
    sdf::ParserConfig strict = config_;
    strict.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
    strict.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::LOG);
    sdf::Root again;
    for (const sdf::Error& error : again.LoadSdfString(text, strict)) {
      const auto is_same = [&](const sdf::Error& other) { return other.Message() == error.Message(); };
      if (std::any_of(known.begin(), known.end(), is_same)) continue;
      const std::string message(trimmed(error.Message()));
      // "XML Attribute[frame] in element[pose] not defined in SDF."
      const auto bracketed = [&](std::string_view before) {
        const size_t begin = message.find(before) + before.size();
        return message.substr(begin, message.find(']', begin) - begin);
      };
      const bool is_attribute = message.starts_with("XML Attribute[") && message.find("not defined in SDF") != message.npos;
      warnings_.push_back(
          is_attribute ? diagnostic(Severity::warning, error,
                                    fmt::format("unknown attribute '{}' of <{}> is ignored", bracketed("Attribute["),
                                                bracketed("element[")),
                                    "correct or remove it")
                       : diagnostic(Severity::warning, error, "libsdformat says: " + message, "correct the element it names"));
    }
  }
  // Of elements within: those that SDF does not have, and those that stand twice where one may. Links, joints and nested models
  // are looked at by themselves.
  void warn_of_elements(const sdf::ElementPtr& of, const std::string& element) {
    std::set<std::string> seen;
    for (sdf::ElementPtr within = of ? of->GetFirstElement() : nullptr; within; within = within->GetNextElement()) {
      const std::string& name = within->GetName();
      const auto warn = [&](const std::string& what, const std::string& remedy) {
        warnings_.push_back({Severity::warning, original_of(within->FilePath()), element, what, remedy});
      };
      if (name.find(':') != name.npos || (name == "screw_thread_pitch" && of->GetName() == "joint")) continue;
      if (!of->HasElementDescription(name)) {
        std::vector<std::string> known;
        for (unsigned int i = 0; i < of->GetElementDescriptionCount(); ++i)
          known.push_back(of->GetElementDescription(i)->GetName());
        warn(fmt::format("unknown element <{}> of <{}> is ignored", name, of->GetName()), suggestion(name, known));
        continue;
      }
      const std::string& required = of->GetElementDescription(name)->GetRequired();
      if (!seen.insert(name).second && required != "*" && required != "+")
        warn(fmt::format("a second <{}> in <{}> is ignored", name, of->GetName()), "keep one of them");
      if (name != "link" && name != "joint" && name != "model") warn_of_elements(within, element);
    }
  }
  // Of errors while a file is read those that others do not follow from. Inertias are judged by the robot's own check.
  void take_causes(const sdf::Errors& errors, const std::string& root) {
    const auto is_lookup = [](const sdf::Error& error) { return error.Code() == sdf::ErrorCode::URI_LOOKUP; };
    const bool lookup = std::any_of(errors.begin(), errors.end(), is_lookup);
    for (const sdf::Error& error : errors) {
      if (error.Code() == sdf::ErrorCode::LINK_INERTIA_INVALID || (lookup && !is_lookup(error))) continue;
      const bool encloses =
          error.Message().starts_with("Error reading element <") || error.Code() == sdf::ErrorCode::STRING_READ;
      if (encloses && !errors_.empty()) continue;
      if (error.Code() == sdf::ErrorCode::STRING_READ)
        add_error(errors_, root == "gazebo" ? Diagnostic{Severity::error, file_, "<gazebo>",
                                                         "libsdformat cannot read it: it is of SDF's first versions",
                                                         "bring it to <sdf version=\"1.6\"> or later"}
                                            : Diagnostic{Severity::error, file_, "SDF", "libsdformat says: Unable to read it",
                                                         "correct what is no XML"});
      else take(error, lookup ? remedy_of_lookup(error.Message()) : "correct the element it names");
    }
  }
  // Of a robot beside others the folder is seldom far.
  std::string remedy_of_lookup(const std::string& message) const {
    const size_t scheme = message.find("://"), begin = scheme == message.npos ? message.find('[') + 1 : scheme + 3;
    const std::string_view before = std::string_view(message).substr(0, scheme == message.npos ? 0 : scheme);
    if (before.ends_with("http") || before.ends_with("https")) {
      std::string_view path = std::string_view(message).substr(begin, message.find(']', begin) - begin);
      while (path.ends_with('/')) path.remove_suffix(1);
      return fmt::format(
          "nothing is downloaded here: fetch the model, and include it as model://{} with SDF_PATH=FOLDER, the "
          "folder that holds the model's",
          path.substr(path.rfind('/') + 1));
    }
    const std::string name = message.substr(begin, message.find_first_of("/]", begin) - begin);
    std::string holder = "FOLDER";
    std::error_code ignored;
    std::filesystem::path folder = std::filesystem::absolute(file_, ignored).parent_path();
    for (int level = 0; level < 5 && !name.empty() && holder == "FOLDER"; ++level, folder = folder.parent_path())
      if (std::filesystem::exists(folder / name, ignored)) holder = folder.string();
    return fmt::format("say where '{}' is: SDF_PATH={} dalembert ...{}", name, holder,
                       holder == "FOLDER" ? ", the folder that holds the model's" : "");
  }
  void stop_on_errors() const {
    if (!errors_.empty()) throw InputError(errors_);
  }
  void ignore(const char* kind, const std::string& name, const std::string& what, const std::string& remedy) {
    warnings_.push_back({Severity::warning, file_, fmt::format("{} '{}'", kind, name), what + " is ignored", remedy});
  }

  const sdf::Model& only_model(const sdf::Root& root) {
    std::vector<const sdf::Model*> models;
    if (root.Model()) models.push_back(root.Model());
    for (uint64_t w = 0; w < root.WorldCount(); ++w) {
      const sdf::World& world = *root.WorldByIndex(w);
      for (uint64_t m = 0; m < world.ModelCount(); ++m) models.push_back(world.ModelByIndex(m));
      const sdf::ElementPtr own = world.Element(),
                            gravity = own && own->HasElement("gravity") ? own->GetElement("gravity") : nullptr;
      if (gravity && gravity->GetExplicitlySetInFile() &&
          vector(world.Gravity()) != Eigen::Vector3d(0, 0, -9.81))  // the scene's
        ignore("world", world.Name(), "its gravity", "say it in the scene: gravity");
    }
    const auto named = [](const std::vector<const sdf::Model*>& some) {
      std::vector<std::string> names;
      for (const sdf::Model* model : some) names.push_back("'" + model->Name() + "'");
      return fmt::format("{}", fmt::join(names, ", "));
    };
    // A robot on its ground, among houses.
    const auto stands = [](const sdf::Model* model) { return model->Static() && model->JointCount() == 0; };
    const auto still = std::stable_partition(models.begin(), models.end(), [&](const sdf::Model* m) { return !stands(m); });
    if (still - models.begin() == 1 && models.size() > 1) {
      warnings_.push_back({Severity::notice, file_, "SDF",
                           fmt::format("models that are static are left out: {}", named({still, models.end()})),
                           "what holds the robot there is for the scene to say: base, contacts"});
      return *models.front();
    }
    if (models.size() == 1) return *models.front();
    throw InputError(
        {Severity::error, file_, "SDF",
         models.empty() ? "there is no model" : fmt::format("there are {} models: {}", models.size(), named(models)),
         "leave one, the robot, in the file; others may stay where they are static and have no joints"});
  }

  // in_whole: the model's pose in the whole one.
  void add_model(const sdf::Model& model, const std::string& prefix, const Pose3d& in_whole) {
    warn_of_elements(model.Element(), fmt::format("model '{}'", prefix + model.Name()));
    if (model.Static()) ignore("model", prefix + model.Name(), "that it is static", "say it in the scene: base: fixed");
    if (model.Element() && model.Element()->HasElement("dalembert:plugin"))
      ignore("model", prefix + model.Name(), "what its plugins do", "the dynamics is of links and joints alone");
    for (uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      add_link(link, prefix);
      const auto written = prefix.empty() && link.PoseRelativeTo().empty() ? written_pose(link.Element()) : std::nullopt;
      poses_.emplace(prefix + link.Name(), written ? *written : frame(in_whole * resolved(link.SemanticPose(), "")));
    }
    for (uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& nested = *model.ModelByIndex(i);
      add_model(nested, prefix + nested.Name() + "::", in_whole * resolved(nested.SemanticPose(), ""));
    }
    for (uint64_t i = 0; i < model.JointCount(); ++i)
      if (const sdf::Joint& joint = *model.JointByIndex(i); joint.Type() != sdf::JointType::GEARBOX)
        add_joint(model, joint, prefix, in_whole);
    for (uint64_t i = 0; i < model.JointCount(); ++i)
      if (const sdf::Joint& joint = *model.JointByIndex(i); joint.Type() == sdf::JointType::GEARBOX) add_gearbox(joint, prefix);
    for (uint64_t i = 0; i < model.FrameCount(); ++i) add_frame(model, *model.FrameByIndex(i), prefix);
  }

  // Of what stands for a frame of the model's: none of its own has that name.
  static std::string free_name(const sdf::Model& model, std::string name) {
    while (model.LinkNameExists(name) || model.JointNameExists(name) || model.FrameNameExists(name)) name += '_';
    return name;
  }

  // A robot that no joint holds to the world floats, and has no link that stands for the world.
  void refuse_loops_to_nowhere() {
    const auto is_in_world = [](const JointOutline& joint) { return joint.parent == "world"; };
    if (std::any_of(outline_.joints.begin(), outline_.joints.end(), is_in_world)) return;
    for (const ir::Loop& loop : outline_.loops)
      if (loop.links[0] == "world")
        add_error(errors_,
                  {Severity::error, file_, fmt::format("joint '{}'", loop.name),
                   fmt::format("link '{}' hangs on another joint already, and this one would hold to the world a robot "
                               "that no joint joins to it",
                               loop.links[1]),
                   "remove it, and say in the scene what holds the link: contacts"});
  }

  // The root link hangs on no joint whose frame would say where it stands.
  void place_root() {
    std::set<std::string> below;
    for (const JointOutline& joint : outline_.joints) below.insert(joint.child);
    for (const LinkOutline& link : outline_.links)
      if (const auto pose = poses_.find(link.name); pose != poses_.end() && !below.count(link.name))
        outline_.root_pose = pose->second;  // of several roots the reader of robots complains
  }

  void add_link(const sdf::Link& link, const std::string& prefix) {
    LinkOutline out{prefix + link.Name(), line_of(link.Element()), {}};
    const sdf::ElementPtr element = link.Element();
    warn_of_elements(element, place(out));
    InertialOutline is;
    is.mass = 1;  // SDF's own
    is.inertia = Eigen::Matrix3d::Identity();
    if (element && element->HasElement("inertial")) {
      is.origin = frame(link.Inertial().Pose());
      read_inertial(element->GetElement("inertial"), out, is);
    } else {
      warnings_.push_back({Severity::warning, file_, place(out), "it has no <inertial>: SDF gives it 1 kg and 1 kg m²",
                           "write its inertial, of mass 0 where it is a frame"});
    }
    out.inertial = is;
    if (element && element->HasElement("gravity") && !element->Get<bool>("gravity"))
      ignore("link", out.name, "that gravity does not act on it", "there is no such thing here");
    if (element && element->HasElement("kinematic") && element->Get<bool>("kinematic"))
      ignore("link", out.name, "that it is kinematic", "there is no such thing here");
    if (element && element->HasElement("velocity_decay"))
      ignore("link", out.name, "its velocity_decay", "damping of joints can be said in the scene");
    outline_.links.push_back(std::move(out));
  }

  // The numbers as they are written: libsdformat reads 1,5 as 1, and has none where an inertia is no body's.
  void read_inertial(const sdf::ElementPtr& inertial, const LinkOutline& link, InertialOutline& is) {
    const auto warn = [&](const std::string& what, const char* remedy) {
      warnings_.push_back({Severity::warning, file_, place(link), what, remedy});
    };
    const auto read = [&](const sdf::ElementPtr& of, const char* name, double& number) {
      if (!of->HasElement(name) || !of->GetElement(name)->GetExplicitlySetInFile()) return false;
      const std::string text = text_of(of->GetElement(name));
      const std::optional<double> value = parse_number(text);
      if (value && std::isfinite(*value)) number = *value;
      else
        add_error(errors_, {Severity::error, file_, place(link),
                            fmt::format("<{0}>{1}</{0}> is not a {2}", name, text, value ? "finite number" : "number"),
                            "write a decimal number"});
      return true;
    };
    if (const auto written = written_pose(inertial)) is.origin = *written;
    if (!read(inertial, "mass", is.mass)) warn("<inertial> has no <mass>: SDF gives it 1 kg", "write its <mass> in kg");
    if (!inertial->HasElement("inertia"))
      return warn("<inertial> has no <inertia>: SDF gives it 1 kg m²", "write its <inertia>: <ixx>, <iyy> and <izz> in kg m²");
    const sdf::ElementPtr inertia = inertial->GetElement("inertia");
    std::vector<std::string> missing;
    for (const auto& [name, i, k] :
         {std::tuple{"ixx", 0, 0}, {"iyy", 1, 1}, {"izz", 2, 2}, {"ixy", 0, 1}, {"ixz", 0, 2}, {"iyz", 1, 2}}) {
      if (!read(inertia, name, is.inertia(i, k)) && i == k) missing.push_back(name);
      is.inertia(k, i) = is.inertia(i, k);
    }
    if (!missing.empty())
      warn(fmt::format("<inertia> has no {}: SDF gives it 1 kg m²", fmt::join(missing, ", ")),
           "write all of ixx, iyy and izz in kg m²");
  }

  Pose3d resolved(const sdf::SemanticPose& pose, const std::string& to) {
    Pose3d result;
    take(pose.Resolve(result, to));
    return result;
  }

  // in_whole: the model's pose in the whole one.
  void add_joint(const sdf::Model& model, const sdf::Joint& joint, const std::string& prefix, const Pose3d& in_whole) {
    JointOutline out;
    out.name = prefix + joint.Name();
    out.line = line_of(joint.Element());
    warn_of_elements(joint.Element(), place(out));
    const auto refuse = [&](const std::string& what, const char* remedy) {
      add_error(errors_, {Severity::error, file_, place(out), what, remedy});
    };
    switch (joint.Type()) {
      case sdf::JointType::REVOLUTE: out.type = ir::JointType::revolute; break;
      case sdf::JointType::CONTINUOUS: out.type = ir::JointType::continuous; break;
      case sdf::JointType::PRISMATIC: out.type = ir::JointType::prismatic; break;
      case sdf::JointType::FIXED: out.type = ir::JointType::fixed; break;
      case sdf::JointType::SCREW: out.type = ir::JointType::helical; break;
      case sdf::JointType::BALL: out.type = ir::JointType::spherical; break;
      // Two axes in series, the first of them the parent's, the second the child's: in revolute2 at any angle to each other.
      case sdf::JointType::UNIVERSAL:
      case sdf::JointType::REVOLUTE2: out.type = ir::JointType::universal; break;
      default:
        return refuse(fmt::format("joints of type '{}' are not known here", joint.Element()->Get<std::string>("type")),
                      "there are revolute, continuous, prismatic, screw, ball, universal, revolute2 and fixed ones");
    }
    // SDF has a default only for those of an <axis> that is there.
    const sdf::JointAxis *const axis = joint.Axis(0), *const second = joint.Axis(1);
    const bool turns_two_ways = out.type == ir::JointType::universal;
    if (out.type != ir::JointType::fixed && out.type != ir::JointType::spherical && (!axis || (turns_two_ways && !second)))
      return refuse(axis ? "it has no second axis" : "it has no axis",
                    turns_two_ways ? "write its <axis> and <axis2>" : "write its <axis>, with the direction as <xyz>");
    warn_of_what_others_have(joint, out);
    std::string parent, child;
    const size_t before = errors_.size();
    take(joint.ResolveParentLink(parent));
    take(joint.ResolveChildLink(child));
    if (errors_.size() > before) return;
    const bool in_world = parent == "world";
    const Pose3d in_parent =
                     in_world ? in_whole * resolved(joint.SemanticPose(), "__model__") : resolved(joint.SemanticPose(), parent),
                 in_child = resolved(joint.SemanticPose(), child);
    if (in_world && !has_world_) {
      has_world_ = true;
      outline_.links.push_back({"world", 0, {}});
    }
    out.parent = in_world ? "world" : prefix + parent;
    out.child = prefix + child;
    if (!children_.insert(out.child).second) return add_loop(joint, out, in_parent, in_child);
    // As it is written, where it is written in the parent's frame: rounding has no part in it then. Names of frames are those
    // of the joint's own model, but of a child link in a nested one that model's.
    out.origin = frame(in_parent);
    const sdf::Link* const child_link = child.find("::") == child.npos ? model.LinkByName(child) : nullptr;
    const bool parent_is_link = in_world ? prefix.empty() : joint.ParentLinkName() == parent;
    const std::string parent_frame = in_world ? "__model__" : parent;
    const auto is_in_parent = [&](const std::string& relative_to) {
      return relative_to == parent_frame || (in_world && relative_to.empty());
    };
    if (parent_is_link && !joint.PoseRelativeTo().empty() && is_in_parent(joint.PoseRelativeTo())) {
      if (const auto written = written_pose(joint.Element())) out.origin = *written;
    } else if (parent_is_link && joint.PoseRelativeTo().empty() && is_identity(in_child) && child_link &&
               is_in_parent(child_link->PoseRelativeTo())) {
      if (const auto written = written_pose(child_link->Element())) out.origin = *written;
    }
    if (out.type != ir::JointType::fixed && out.type != ir::JointType::spherical) read_axis(*axis, out);
    if (out.type == ir::JointType::helical) {
      out.pitch = pitch(joint, out);
      if (!std::isfinite(out.pitch)) return refuse("its thread_pitch is 0: no turn moves it", "make it a prismatic joint");
    }
    if (turns_two_ways) {
      JointOutline of_second = out;
      read_axis(*second, of_second);
      out.second = of_second.axis;
      if (out.axis.cross(out.second).norm() < 1e-9 * out.axis.norm() * out.second.norm())
        return refuse("its second axis is its first: together they turn one way",
                      "correct <axis2>, or make it a revolute joint");
      if (of_second.damping != out.damping || of_second.friction != out.friction)
        ignore("joint", out.name, "the damping and friction of its second axis",
               "those of the first are each coordinate's: say them in the scene, damping and friction");
    }
    if (!is_identity(in_child)) {  // the child keeps its frame
      const LinkOutline between{prefix + free_name(model, joint.Name() + "_frame"), out.line, {}};
      JointOutline weld;
      weld.name = prefix + free_name(model, joint.Name() + "_to_" + child);
      weld.line = out.line;
      weld.type = ir::JointType::fixed;
      weld.parent = between.name;
      weld.child = out.child;
      weld.origin = frame(in_child.Inverse());
      out.child = between.name;
      outline_.links.push_back(between);
      outline_.joints.push_back(std::move(weld));
    }
    if (out.type == ir::JointType::revolute || out.type == ir::JointType::continuous) {
      ignition::math::Vector3d in_link;
      take(axis->ResolveXyz(in_link, child));
      hinges_.push_back({out.name, out.parent, prefix + child, vector(in_link).normalized()});
    }
    outline_.joints.push_back(std::move(out));
  }

  // Elements that joints of other types have: SDF allows them in each.
  void warn_of_what_others_have(const sdf::Joint& joint, const JointOutline& out) {
    const std::string type = joint.Element()->Get<std::string>("type");
    const bool has_second = out.type == ir::JointType::universal, is_screw = out.type == ir::JointType::helical;
    for (const auto& [element, belongs] : {std::pair{"axis2", has_second},
                                           {"thread_pitch", is_screw},
                                           {"screw_thread_pitch", is_screw},
                                           {"gearbox_ratio", false},
                                           {"gearbox_reference_body", false}})
      if (!belongs && joint.Element()->HasElement(element))
        ignore("joint", out.name, fmt::format("its <{}>", element),
               fmt::format("a {} joint has none: remove it, or correct the joint's type", type));
    const sdf::JointAxis* const axis = joint.Axis(0);
    if (out.type == ir::JointType::spherical && axis && (axis->Damping() != 0 || axis->Friction() != 0))
      ignore("joint", out.name, "the damping and friction of its <axis>",
             "a ball has no axis: say them in the scene, damping and friction");
  }

  // A joint to a link that hangs on another one already holds the two together.
  void add_loop(const sdf::Joint& joint, JointOutline& out, const Pose3d& in_parent, const Pose3d& in_child) {
    const auto isometry = [](const Pose3d& pose) {
      Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
      result.translation() = vector(pose.Pos());
      result.linear() = rotation(pose.Rot());
      return result;
    };
    ir::Loop loop;
    loop.name = out.name;
    loop.links = {out.parent, out.child};
    loop.at = {isometry(in_parent), isometry(in_child)};
    if (out.type == ir::JointType::revolute || out.type == ir::JointType::continuous) {
      loop.type = ir::LoopType::hinge;
      read_axis(*joint.Axis(0), out);
      for (Eigen::Isometry3d& at : loop.at)
        at.rotate(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out.axis.normalized()));
      if (out.damping != 0 || out.friction != 0)
        ignore("joint", out.name, "its damping and friction",
               "it closes a loop, and loops have none: say them of another joint");
    } else if (out.type == ir::JointType::spherical) {
      loop.type = ir::LoopType::point;
    } else if (out.type == ir::JointType::fixed) {
      loop.type = ir::LoopType::weld;
    } else {
      add_error(errors_, {Severity::error, file_, place(out),
                          fmt::format("link '{}' hangs on another joint already, and a loop is closed by no {} joint",
                                      out.child, joint.Element()->Get<std::string>("type")),
                          "write it before the other one, so that a revolute, ball or fixed joint closes the loop"});
      return;
    }
    outline_.loops.push_back(std::move(loop));
  }

  // A turning joint by which a gearbox may measure angles; its axis in its child's frame.
  struct Hinge {
    std::string joint, parent, child;
    Eigen::Vector3d axis;
  };

  // theta_2 = -ratio theta_1, angles of the child and of the parent against the reference body: the child's joint follows the
  // parent's.
  void add_gearbox(const sdf::Joint& joint, const std::string& prefix) {
    JointOutline out;
    out.name = prefix + joint.Name();
    out.line = line_of(joint.Element());
    warn_of_elements(joint.Element(), place(out));
    const auto refuse = [&](const std::string& what, const char* remedy) {
      add_error(errors_, {Severity::error, file_, place(out), what, remedy});
    };
    std::string parent, child;
    const size_t before = errors_.size();
    take(joint.ResolveParentLink(parent));
    take(joint.ResolveChildLink(child));
    if (errors_.size() > before) return;
    const sdf::ElementPtr element = joint.Element();
    double ratio = 1;
    if (element->HasElement("gearbox_ratio")) {
      const auto written = written_numbers<1>(element->GetElement("gearbox_ratio"));
      ratio = written ? (*written)[0] : std::numeric_limits<double>::quiet_NaN();
    }
    if (!std::isfinite(ratio) || ratio == 0) return refuse("its gearbox_ratio is no ratio", "write a number other than 0");
    if (!element->HasElement("gearbox_reference_body"))
      return refuse("it has no gearbox_reference_body", "write the link against which both angles are measured");
    const std::string written = element->Get<std::string>("gearbox_reference_body"),
                      reference = written == "world" ? written : prefix + written;
    if (!joint.Axis(0)) return refuse("it has no axis", "write its <axis>, that of the joint whose angle it is to measure");
    // The joint between the reference body and a link, and the sense in which its coordinate is that angle.
    const auto angle = [&](const std::string& link, unsigned which) -> std::optional<std::pair<std::string, double> > {
      const sdf::JointAxis* const axis = joint.Axis(which) ? joint.Axis(which) : joint.Axis(0);
      for (const Hinge& hinge : hinges_) {
        const bool behind = hinge.parent == reference && hinge.child == link;
        if (!behind && !(hinge.child == reference && hinge.parent == link)) continue;
        ignition::math::Vector3d in_link;
        take(axis->ResolveXyz(in_link, hinge.child.substr(prefix.size())));
        const double sense = vector(in_link).normalized().dot(hinge.axis) * (behind ? 1 : -1);
        if (std::abs(sense) > 1 - 1e-9) return std::pair(hinge.joint, sense < 0 ? -1. : 1.);
        refuse(fmt::format("its {} is not that of joint '{}', whose angle it is to measure", which == 0 ? "<axis>" : "<axis2>",
                           hinge.joint),
               "correct it: a gearbox couples the angles of two revolute joints");
        return std::nullopt;
      }
      refuse(fmt::format("no revolute joint is between its gearbox_reference_body '{}' and link '{}'", reference, link),
             "write the body that both links turn against: a gearbox couples the angles of two revolute joints");
      return std::nullopt;
    };
    const auto first = angle(prefix + parent, 0), second = angle(prefix + child, 1);
    if (!first || !second) return;
    const auto joint_of = [&](const std::string& name) {
      return std::find_if(outline_.joints.begin(), outline_.joints.end(),
                          [&](const JointOutline& j) { return j.name == name; });
    };
    JointOutline& follower = *joint_of(second->first);
    if (follower.mimic)
      return refuse(fmt::format("joint '{}' follows '{}' already", follower.name, follower.mimic->of),
                    "exchange its parent and child, or remove it");
    double multiplier = -ratio * first->second * second->second;
    std::string of = first->first;
    while (const auto& relation = joint_of(of)->mimic) multiplier *= relation->multiplier, of = relation->of;
    if (of == follower.name) return refuse("gearboxes couple joint '" + of + "' to itself", "remove one of them");
    follower.mimic = ir::Mimic{of, multiplier, 0};
    warnings_.push_back({Severity::notice, file_, place(out),
                         fmt::format("it is a gearbox: joint '{}' follows '{}' times {:.6g}", follower.name, of, multiplier),
                         "what it couples is one coordinate where the scene says mimic: urdf"});
    for (JointOutline& other : outline_.joints)
      if (other.mimic && other.mimic->of == follower.name) other.mimic = ir::Mimic{of, other.mimic->multiplier * multiplier, 0};
  }

  // m per turn of a right-handed thread. What SDF 1.10 calls screw_thread_pitch is this; the older thread_pitch is what Gazebo
  // takes it for, rad per m of a left-handed one.
  double pitch(const sdf::Joint& joint, const JointOutline& out) {
    const sdf::ElementPtr element = joint.Element();
    if (element->HasElement("screw_thread_pitch"))
      if (const auto written = written_numbers<1>(element->GetElement("screw_thread_pitch"))) return (*written)[0];
    constexpr double turn = 2 * 3.14159265358979323846;
    const double result = -turn / joint.ThreadPitch();
    if (std::isfinite(result))
      warnings_.push_back({Severity::notice, file_, place(out),
                           fmt::format("its thread_pitch is taken as Gazebo takes it, {} rad per m of a left-handed thread: "
                                       "{:.6g} m per turn",
                                       joint.ThreadPitch(), result),
                           "where that is not meant, say it in the scene: joints"});
    return result;
  }

  void read_axis(const sdf::JointAxis& axis, JointOutline& out) {
    ignition::math::Vector3d xyz;
    take(axis.ResolveXyz(xyz));
    out.axis = vector(xyz);
    if (axis.XyzExpressedIn().empty() && axis.Element() && axis.Element()->HasElement("xyz"))
      if (const auto written = written_numbers<3>(axis.Element()->GetElement("xyz")))
        out.axis = {(*written)[0], (*written)[1], (*written)[2]};
    out.damping = axis.Damping();
    out.friction = axis.Friction();
    constexpr double unlimited = 1e16;  // SDF's own
    const auto limit = [](double value, double otherwise) { return std::abs(value) < unlimited ? value : otherwise; };
    constexpr double infinite = std::numeric_limits<double>::infinity();
    out.limits = {limit(axis.Lower(), -infinite), limit(axis.Upper(), infinite),
                  axis.MaxVelocity() >= 0 ? limit(axis.MaxVelocity(), infinite) : infinite,
                  axis.Effort() >= 0 ? limit(axis.Effort(), infinite) : infinite};
    if (axis.SpringStiffness() != 0)
      ignore("joint", out.name, fmt::format("its spring of {} about {}", axis.SpringStiffness(), axis.SpringReference()),
             "say it in the scene: stiffness");
  }

  void add_frame(const sdf::Model& model, const sdf::Frame& from, const std::string& prefix) {
    std::string body;
    const size_t before = errors_.size();
    take(from.ResolveAttachedToBody(body));
    if (errors_.size() > before || body == "__model__") return;
    JointOutline weld;
    weld.name = prefix + free_name(model, from.Name() + "_weld");
    weld.line = line_of(from.Element());
    weld.type = ir::JointType::fixed;
    weld.parent = prefix + body;
    weld.child = prefix + from.Name();
    weld.origin = frame(resolved(from.SemanticPose(), body));
    outline_.links.push_back({weld.child, weld.line, {}});
    outline_.joints.push_back(std::move(weld));
  }

  const std::string& file_;
  Diagnostics& warnings_;
  sdf::ParserConfig config_ = sdf::ParserConfig::GlobalConfig();
  Folder folder_;
  std::map<std::string, std::string> copies_, originals_;  // of included files: path → copy, and back
  Diagnostics errors_;
  UrdfOutline outline_;
  std::vector<Hinge> hinges_;
  std::set<std::string> children_;      // links that hang on a joint
  std::map<std::string, Frame> poses_;  // of links in the whole model
  bool has_world_ = false;
};

}  // namespace

}  // namespace dalembert::frontend

void dalembert_sdf_outline(const std::string& path, dalembert::Diagnostics& warnings,
                           dalembert::frontend::UrdfOutline& outline) {
  outline = dalembert::frontend::SdfReader(path, warnings).read();
}
