// Scene file (YAML) and command-line options → SceneDocument: what the user wrote, with its places.
//
// Every key of the file is an option of the same name. An option replaces the file's key as a whole. docs/scene.md describes
// the keys. Names of links and joints are not looked up here: check_scene does, with the places kept in the document.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "ir/scene.hpp"

namespace dalembert::frontend {

// A key given on the command line. The value is YAML in one line ("[a, b]", "{j1: 0.3}"); brackets may be left out of lists
// ("a,b"), and maps written "j1=0.3,j2=0".
struct Setting {
  std::string key;
  std::string text;
};

// The keys, in the order in which they are documented.
const std::vector<std::string>& scene_keys();

// Where something was written: a scene file with line and column, or an option.
struct Place {
  std::string file;
  std::string element;  // "line 3, column 5: key 'locked'" or "option --locked"
};

// Between an entry's name and that of a part of it. Not '/', which may stand in either.
inline constexpr char part_of_entry = '\0';

// What a function is asked of frames: by a name that the robot explains, a result's or a frame's; or by the frame and the
// quantity.
struct AskedOfFrame {
  std::string name;
  std::optional<ir::LinkOutput> output;
};

struct SceneDocument {
  ir::Scene scene;                                             // the keys given; the defaults elsewhere
  std::set<std::string> given;                                 // the keys given
  bool urdf_mimic = false;                                     // mimic: urdf
  std::map<std::string, std::vector<AskedOfFrame>> of_frames;  // per function
  std::vector<ir::Frame> placed_by_functions;                  // frames that stand in functions
  // "locked" for a key, "locked/l_knee" for an entry of it, "mimic/l_knee" + part_of_entry + "of" for a part of that
  std::map<std::string, Place> places;
  // Per key the largest number that it holds, whatever is made of it, and of which entry, if of one.
  struct Number {
    double size = 0;
    std::string text, entry;
    Place place;
  };
  std::map<std::string, Number> largest;
};

// `file`: empty when there is none. Throws InputError at the first unknown key or value, with line and column and a remedy.
SceneDocument read_scene(const std::string& file, const std::vector<Setting>& settings);

// The same for the text of a file.
SceneDocument read_scene_text(const std::string& file, const std::string& text, const std::vector<Setting>& settings);

}  // namespace dalembert::frontend
