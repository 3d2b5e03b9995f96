// What MAHRU is to do, a target per tick, laid out before the loop begins.
#pragma once

#include <string>
#include <vector>

#include "types.hpp"

namespace standing {

struct Plan {
  struct Part {
    std::string name;
    std::size_t begin;  // its first tick
  };
  std::vector<Target> targets;
  std::vector<Part> parts;
};

// From where centre of mass and soles are at the start. What is shorter than `seconds` ends in standing still, what is longer
// is cut off.

// The whole minute: stands, sways, squats by 0.15 m, stands on either foot, and is pushed to four sides, by `impulse` N s each.
Plan stand(const Target& start, double seconds, double impulse);

// Some of each, at a quicker pace, in five seconds.
Plan stand_briefly(const Target& start, double seconds, double impulse);

// Steps ahead, the last beside the one before.
Plan walk(const Target& start, int steps);

}  // namespace standing
