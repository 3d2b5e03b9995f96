# cmake -DOUTPUT=file.cpp -DFOLDER=templates -P embed_templates.cmake: the templates as one C++ table of raw strings.
file(GLOB templates RELATIVE ${FOLDER} ${FOLDER}/*.in)
list(SORT templates)
set(rows "")
foreach(template IN LISTS templates)
  file(READ ${FOLDER}/${template} text)
  string(REGEX REPLACE "\\.in$" "" name ${template})
  string(APPEND rows "    {\"${name}\", R\"_template_(${text})_template_\"},\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"backend/templates.hpp\"

namespace dalembert::backend {

const std::map<std::string_view, std::string_view> embedded_templates = {
${rows}};

}  // namespace dalembert::backend
")
