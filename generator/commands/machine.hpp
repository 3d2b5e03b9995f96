// The machine that figures were measured on, as everything that measures names it.
#pragma once

#include <string>

namespace dalembert {

struct Machine {
  // What tells machines apart on which times differ: the processor's name and generation, its first caches, its vector units:
  // "AMD EPYC, Zen 3; L1d 32 kB, L2 512 kB; AVX2 on units of 256 bits".
  std::string kind;
  // What need not: "family 25, model 1; 2 cores; 2.4 GHz".
  std::string details;

  std::string text() const { return kind + " (" + details + ")"; }
};

// What machine_of() is told of the machine, as Linux says it.
struct MachineFacts {
  std::string cpuinfo;                         // of /proc/cpuinfo, one processor at least
  std::string first_level_data, second_level;  // caches: "32K", "1024K"; empty: not known
  std::string highest_clock;                   // kHz; empty: not known
  unsigned cores = 0;
};

Machine machine_of(const MachineFacts& facts);

// Of this one; what cannot be found out is left out.
Machine this_machine();

}  // namespace dalembert
