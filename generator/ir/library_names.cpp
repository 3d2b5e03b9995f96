#include "ir/library_names.hpp"

#include <algorithm>
#include <iterator>

namespace dalembert::ir {

namespace {

// Those of the standard library and POSIX that someone may call a joint or a robot; sorted, for binary search.
// clang-format off
constexpr std::string_view macros[] = {
    "ATOMIC_FLAG_INIT", "BIG_ENDIAN", "BUFSIZ", "BYTE_ORDER", "CHAR_BIT", "CHAR_MAX", "CHAR_MIN", "CLOCKS_PER_SEC",
    "CLOCK_MONOTONIC", "CLOCK_REALTIME", "DBL_DIG", "DBL_EPSILON", "DBL_MANT_DIG", "DBL_MAX", "DBL_MAX_EXP",
    "DBL_MIN", "DBL_MIN_EXP", "EACCES", "EAGAIN", "EBUSY", "EDOM", "EEXIST", "EFAULT", "EINTR", "EINVAL", "EIO",
    "ENOENT", "ENOMEM", "ENOSPC", "EOF", "EPERM", "EPIPE", "ERANGE", "ETIME", "EXIT_FAILURE", "EXIT_SUCCESS",
    "FLT_DIG", "FLT_EPSILON", "FLT_MAX", "FLT_MIN", "FLT_RADIX", "FP_INFINITE", "FP_NAN", "FP_NORMAL",
    "FP_SUBNORMAL", "FP_ZERO", "HUGE_VAL", "HUGE_VALF", "HUGE_VALL", "INFINITY", "INT16_MAX", "INT16_MIN",
    "INT32_MAX", "INT32_MIN", "INT64_MAX", "INT64_MIN", "INT8_MAX", "INT8_MIN", "INTMAX_MAX", "INTMAX_MIN",
    "INTPTR_MAX", "INTPTR_MIN", "INT_MAX", "INT_MIN", "LDBL_EPSILON", "LDBL_MAX", "LDBL_MIN", "LITTLE_ENDIAN",
    "LLONG_MAX", "LLONG_MIN", "LONG_MAX", "LONG_MIN", "MAXFLOAT", "MB_LEN_MAX", "M_1_PI", "M_2_PI", "M_E", "M_LN10",
    "M_LN2", "M_LOG10E", "M_LOG2E", "M_PI", "M_PI_2", "M_PI_4", "M_SQRT1_2", "M_SQRT2", "NAN", "NULL", "PTRDIFF_MAX",
    "PTRDIFF_MIN", "RAND_MAX", "SEEK_CUR", "SEEK_END", "SEEK_SET", "SHRT_MAX", "SHRT_MIN", "SIG_ATOMIC_MAX",
    "SIZE_MAX", "UCHAR_MAX", "UINT16_MAX", "UINT32_MAX", "UINT64_MAX", "UINT8_MAX", "UINTMAX_MAX", "UINTPTR_MAX",
    "UINT_MAX", "ULLONG_MAX", "ULONG_MAX", "USHRT_MAX", "WCHAR_MAX", "WCHAR_MIN", "WEOF", "assert", "errno", "linux",
    "math_errhandling", "offsetof", "stderr", "stdin", "stdout", "unix"};
constexpr std::string_view library_functions[] = {
    "abort", "abs", "access", "acos", "acosh", "alarm", "aligned_alloc", "asctime", "asin", "asinh", "atan", "atan2",
    "atanh", "atexit", "atof", "atoi", "atol", "atoll", "basename", "bcmp", "bcopy", "brk", "bsearch", "bzero",
    "calloc", "cbrt", "ceil", "chdir", "clearenv", "clock", "close", "copysign", "cos", "cosh", "crypt", "ctermid",
    "ctime", "daemon", "difftime", "div", "drem", "dup", "erand48", "erf", "erfc", "execl", "execv", "execve", "exit",
    "exp", "exp10", "exp2", "expm1", "fabs", "fclose", "fdim", "feof", "ferror", "fflush", "ffs", "fgetc", "fgets",
    "finite", "floor", "fma", "fmax", "fmin", "fmod", "fopen", "fork", "fprintf", "fputc", "fputs", "fread", "free",
    "freopen", "frexp", "fscanf", "fseek", "fsync", "ftell", "fwrite", "gamma", "getc", "getchar", "getenv", "getpid",
    "gets", "getuid", "getw", "gmtime", "hypot", "ilogb", "index", "isalnum", "isalpha", "iscntrl", "isdigit",
    "isgraph", "islower", "isprint", "ispunct", "isspace", "isupper", "isxdigit", "j0", "j1", "jn", "kill", "labs",
    "ldexp", "ldiv", "lgamma", "link", "llabs", "lldiv", "localtime", "lockf", "log", "log10", "log1p", "log2",
    "logb", "lrint", "lround", "lseek", "malloc", "memchr", "memcmp", "memcpy", "memmove", "memset", "mktime", "modf",
    "nan", "nanosleep", "nearbyint", "nextafter", "nice", "open", "pause", "perror", "pipe", "pow", "printf", "putc",
    "putchar", "puts", "putw", "qsort", "rand", "random", "read", "realloc", "remove", "remquo", "rename", "rewind",
    "rindex", "rint", "rmdir", "round", "scalb", "scanf", "select", "setbuf", "setenv", "signal", "significand",
    "sin", "sincos", "sinh", "sleep", "sprintf", "sqrt", "srand", "sscanf", "stpcpy", "strcat", "strchr", "strcmp",
    "strcpy", "strdup", "strerror", "strlen", "strstr", "strtod", "strtok", "strtol", "swab", "symlink", "sync",
    "system", "tan", "tanh", "tempnam", "tgamma", "time", "timegm", "tmpfile", "tmpnam", "toascii", "tolower",
    "toupper", "trunc", "truncate", "ttyname", "tzset", "uname", "ungetc", "unlink", "usleep", "vfork", "wait",
    "write", "y0", "y1", "yn"};
// clang-format on

}  // namespace

bool is_library_macro(std::string_view text) { return std::binary_search(std::begin(macros), std::end(macros), text); }

bool is_library_function(std::string_view text) {
  return std::binary_search(std::begin(library_functions), std::end(library_functions), text);
}

}  // namespace dalembert::ir
