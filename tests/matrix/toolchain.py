"""Compilers: what they are, whether this machine runs what they make, and how."""
import functools
import platform
import shutil
import subprocess

# What a compiler may use by itself in code that computes with doubles.
EXTENSIONS = ["SSE2", "SSE3", "SSSE3", "SSE4_1", "SSE4_2", "SSE4A", "POPCNT", "AVX", "AVX2", "FMA", "FMA4", "XOP", "F16C", "BMI",
              "BMI2", "LZCNT", "MOVBE", "AVX512F", "AVX512CD", "AVX512BW", "AVX512DQ", "AVX512VL", "AVX512IFMA", "AVX512VBMI",
              "AVX512VBMI2", "AVX512VNNI", "AVX512BITALG", "AVX512VPOPCNTDQ", "GFNI", "VAES", "VPCLMULQDQ"]


def there(compiler):
    return shutil.which(compiler) is not None


@functools.cache
def version(compiler):
    return subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]


@functools.cache
def macros(compiler, target):
    """The predefined macros; None where the compiler does not know the target."""
    run = subprocess.run([compiler, *flags(target), "-dM", "-E", "-x", "c++", "/dev/null"], capture_output=True, text=True)
    return {line.split()[1] for line in run.stdout.splitlines()} if run.returncode == 0 else None


@functools.cache
def identity(compiler, target):
    """What an outcome depends on: the compiler, and for the target `native` the machine as it sees it."""
    return version(compiler) + (" " + " ".join(sorted(macros(compiler, target) or [])) if target == "native" else "")


def flags(target):
    return [] if target == "aarch64" else [f"-march={target}"]


def runner(compiler, target):
    """The command that runs the program: empty on this machine, qemu's for aarch64; None where it can only be compiled."""
    if target == "aarch64" and platform.machine() != "aarch64":
        return ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"] if there("qemu-aarch64") else None
    wanted, here = macros(compiler, target), macros(compiler, "native")
    if wanted is None or here is None:
        return None
    return None if any(f"__{e}__" in wanted and f"__{e}__" not in here for e in EXTENSIONS) else []
