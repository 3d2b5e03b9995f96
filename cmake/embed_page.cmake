# cmake -DOUTPUT=file.cpp "-DPARTS=name=file|name=file" -P embed_page.cmake: files as functions that return their bytes.
set(functions "")
string(REPLACE "|" ";" PARTS "${PARTS}")
foreach(part IN LISTS PARTS)
  string(REGEX MATCH "^([a-z_]+)=(.*)$" matched "${part}")
  set(name ${CMAKE_MATCH_1})
  file(READ "${CMAKE_MATCH_2}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND functions "
std::string_view ${name}() {
  static constexpr char bytes[] = {${bytes}};
  return {bytes, sizeof bytes};
}
")
endforeach()
file(WRITE ${OUTPUT} "#include \"commands/report/page.hpp\"

namespace dalembert::reporting {
${functions}
}  // namespace dalembert::reporting
")
