// How machines are named: by what their times depend on, from what Linux says of them.
#include "commands/machine.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace dalembert {
namespace {

std::string amd(int family, int model, const char* flags) {
  return "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: " + std::to_string(family) +
         "\nmodel\t\t: " + std::to_string(model) + "\nmodel name\t: AMD EPYC\ncpu MHz\t\t: 2445.406\nflags\t\t: fpu sse2 " +
         flags + "\n\nprocessor\t: 1\nmodel name\t: another\n";
}

std::string intel(int model, const char* flags) {
  return "vendor_id\t: GenuineIntel\ncpu family\t: 6\nmodel\t\t: " + std::to_string(model) +
         "\nmodel name\t: Intel(R) Xeon(R)\nflags\t\t: " + flags + "\n";
}

std::string kind(const std::string& cpuinfo, const char* first = "32K", const char* second = "512K") {
  return machine_of({cpuinfo, first, second, "", 2}).kind;
}

TEST(Machine, IsNamedByWhatItsTimesDependOn) {
  EXPECT_EQ(kind(amd(25, 1, "avx avx2")), "AMD EPYC, Zen 3; L1d 32 kB, L2 512 kB; AVX2 on units of 256 bits");
  EXPECT_EQ(kind(amd(25, 17, "avx avx2 avx512f"), "32K", "1024K"),
            "AMD EPYC, Zen 4; L1d 32 kB, L2 1 MB; AVX-512 on units of 256 bits");
  EXPECT_EQ(kind(amd(26, 2, "avx avx2 avx512f"), "48K", "1024K"),
            "AMD EPYC, Zen 5; L1d 48 kB, L2 1 MB; AVX-512 on units of 512 bits");
  EXPECT_EQ(kind(amd(26, 36, "avx avx2 avx512f"), "48K", "1M"),
            "AMD EPYC, Zen 5; L1d 48 kB, L2 1 MB; AVX-512 on units of 256 bits");
  EXPECT_EQ(kind(amd(23, 1, "avx avx2")), "AMD EPYC, Zen; L1d 32 kB, L2 512 kB; AVX2 on units of 128 bits");
  EXPECT_EQ(kind(amd(23, 49, "avx avx2")), "AMD EPYC, Zen 2; L1d 32 kB, L2 512 kB; AVX2 on units of 256 bits");
  EXPECT_EQ(kind(intel(143, "sse2 avx avx2 avx512f"), "48K", "2048K"),
            "Intel(R) Xeon(R), Sapphire Rapids; L1d 48 kB, L2 2 MB; AVX-512 on units of 512 bits");
  EXPECT_EQ(kind(intel(63, "sse2 avx avx2"), "32K", "256K"),
            "Intel(R) Xeon(R), Haswell; L1d 32 kB, L2 256 kB; AVX2 on units of 256 bits");
}

TEST(Machine, WhatIsNotKnownIsLeftOutOrNumbered) {
  EXPECT_EQ(kind(amd(31, 4, "avx avx2")), "AMD EPYC, family 31, model 4; L1d 32 kB, L2 512 kB; AVX2");
  EXPECT_EQ(kind(amd(25, 1, "avx"), "", ""), "AMD EPYC, Zen 3; AVX");
  EXPECT_EQ(kind("processor\t: 0\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\nCPU part\t: 0xd0c\n", "64K", "1024K"),
            "ARM, Neoverse N1; L1d 64 kB, L2 1 MB; NEON, units of 128 bits");
  EXPECT_EQ(kind("", "", ""), "unknown processor");
}

TEST(Machine, DetailsAreWhatOthersOfItsKindNeedNotShare) {
  EXPECT_EQ(machine_of({amd(25, 1, "avx2"), "32K", "512K", "", 2}).details, "family 25, model 1; 2 cores; 2.4 GHz");
  EXPECT_EQ(machine_of({amd(25, 1, "avx2"), "32K", "512K", "3675000", 1}).details, "family 25, model 1; 1 core; up to 3.7 GHz");
  EXPECT_EQ(machine_of({amd(31, 4, ""), "", "", "", 4}).details, "4 cores; 2.4 GHz");
}

TEST(Machine, ThisOneHasOneLineOfEach) {
  const Machine machine = this_machine();
  EXPECT_FALSE(machine.kind.empty());
  EXPECT_FALSE(machine.details.empty());
  EXPECT_EQ(machine.text().find('\n'), std::string::npos) << machine.text();
}

#ifdef _SC_LEVEL1_DCACHE_SIZE
// A virtual machine that hides /sys's folders of caches is no other kind of machine.
TEST(Machine, ThisOneNamesItsCachesWhereTheProcessorDoes) {
  if (sysconf(_SC_LEVEL1_DCACHE_SIZE) <= 0) GTEST_SKIP();
  EXPECT_NE(this_machine().kind.find("; L1d "), std::string::npos) << this_machine().kind;
}
#endif

}  // namespace
}  // namespace dalembert
