# Writes the wrong dynamics, WRONG/dynamics.cpp, to TO, under the inner name that the right ones have.
file(STRINGS "${RIGHT}/dynamics.hpp" right REGEX "^inline namespace code_")
string(REGEX MATCH "code_[0-9a-f]+" name "${right}")
file(READ "${WRONG}/dynamics.cpp" text)
string(REGEX REPLACE "code_[0-9a-f]+" "${name}" text "${text}")
file(WRITE "${TO}" "${text}")
