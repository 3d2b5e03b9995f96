#include "frontend/sdf_reader.hpp"

#include <console_bridge/console.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "frontend/sdf_outline.hpp"
#include "frontend/text_file.hpp"
#include "frontend/urdf_reader.hpp"
#include "frontend/xml_document.hpp"

namespace dalembert::frontend {

ir::RobotDescription read_sdf(const std::string& path, Diagnostics& warnings) {
  (void)read_text_file(path, "SDF", xml_bytes);  // whether it can be read is said by us
#ifdef DALEMBERT_SDF
  // It stays open: what it threw and warned of outlives the call.
  const std::filesystem::path library = std::filesystem::canonical("/proc/self/exe").parent_path() / DALEMBERT_SDF;
  void* const opened = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  const auto outline_of =
      opened ? reinterpret_cast<decltype(&dalembert_sdf_outline)>(dlsym(opened, "dalembert_sdf_outline")) : nullptr;
  if (!outline_of)
    throw InputError({Severity::error, path, "SDF", fmt::format("the library that reads SDF cannot be opened: {}", dlerror()),
                      "install dalembert again, and libsdformat 12 with it"});
  // What libsdformat cannot read it tries as a URDF, and urdfdom complains of that.
  struct Silence {
    Silence() { console_bridge::noOutputHandler(); }
    ~Silence() { console_bridge::restorePreviousOutputHandler(); }
  };
  UrdfOutline outline;
  {
    const Silence silence;
    outline_of(path, warnings, outline);
  }
  return robot_of(path, std::move(outline), warnings);
#else
  (void)warnings;
  throw InputError({Severity::error, path, "SDF", "this program was built without libsdformat, which reads SDF",
                    "install libsdformat-dev 12 and build it again, or convert the file to URDF"});
#endif
}

}  // namespace dalembert::frontend
