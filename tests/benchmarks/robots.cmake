# The robots that are timed, and their generated libraries.
#
# Written here: tables/benchmark_robots.hpp and tables/robots.json (all robots), tables/outputs.json (what is timed together),
# tables/generated_table.hpp (all generated libraries); generated_libraries lists the latter's targets.

# What is timed together: the labels of Quantities (benchmark_robot.hpp), and their outputs, at most four.
set(outputs_of_M mass_matrix)
set(outputs_of_C coriolis_matrix)
set(outputs_of_M+C mass_matrix coriolis_matrix)
set(outputs_of_g gravity)
set(outputs_of_bias bias)
set(outputs_of_id inverse_dynamics)
set(outputs_of_fd forward_dynamics)
set(outputs_of_minv inverse_mass_matrix)
set(outputs_of_did inverse_dynamics_dq inverse_dynamics_dv)
set(outputs_of_dfd forward_dynamics_dq forward_dynamics_dv inverse_mass_matrix)
set(outputs_of_cmm momentum_matrix)
set(outputs_of_com center_of_mass center_of_mass_jacobian)
set(outputs_of_energy kinetic_energy potential_energy)
set(outputs_of_regressor regressor)
set(terms M C M+C g bias)
set(everything ${terms} id fd minv did dfd cmm com energy regressor)

set(generated_libraries "")
set(robot_rows "")
set(robot_json "")
set(generated_includes "")
set(generated_rows "")

# One library of the robot: LABEL as in GeneratedRobot::outputs, then the outputs. What several of the standard functions would
# compute is one function of the scene.
function(benchmark_library robot urdf base label)
  string(MAKE_C_IDENTIFIER "benchmark_${robot}_${label}" name)
  # The functions that compute them (generator/ir/quantities.def), and where C's accessors find them.
  set(calls "")
  set(results "")
  foreach(quantity ${ARGN})
    if(quantity MATCHES "^(inverse_dynamics|forward_dynamics)")
      list(APPEND calls "DALEMBERT_CALL_WITH_MORE(${name}, ${CMAKE_MATCH_1})")
    elseif(quantity STREQUAL "regressor")
      list(APPEND calls "DALEMBERT_CALL_WITH_MORE(${name}, inverse_dynamics)")
    else()
      list(APPEND calls "DALEMBERT_CALL(${name}, evaluate)")
    endif()
    string(REGEX REPLACE "^(inverse_dynamics|forward_dynamics)$" "\\1_result" accessor ${quantity})
    list(APPEND results "DALEMBERT_OUTPUT(${name}, ${quantity}, ${accessor})")
  endforeach()
  list(REMOVE_DUPLICATES calls)
  list(LENGTH calls functions)
  list(JOIN ARGN "," outputs)
  set(options --outputs ${outputs})
  if(functions GREATER 1)
    set(options --outputs [] --functions together=${outputs})
    set(calls "DALEMBERT_CALL_WITH_MORE(${name}, together)")
    list(TRANSFORM ARGN REPLACE "(.+)" "DALEMBERT_OUTPUT(${name}, \\1, together_\\1)" OUTPUT_VARIABLE results)
  endif()
  dalembert_add_robot(${name} URDF "${urdf}" NAME ${name} NATIVE NO_SELF_TEST OPTIONS --base ${base} ${options})
  # Eigen is read once for all of these libraries: it is most of the time of compiling the smaller ones.
  if(generated_libraries)
    list(GET generated_libraries 0 first)
    target_precompile_headers(${name} REUSE_FROM ${first})
  else()
    target_precompile_headers(${name} PRIVATE <Eigen/Core>)
  endif()
  if(TARGET ${robot}_urdf)
    add_dependencies(${name} ${robot}_urdf)
  endif()
  list(JOIN calls " " calls)
  list(JOIN results ", " results)
  string(CONCAT row "    {\"${robot}\", \"${label}\", \"$<TARGET_FILE:${name}>\", DALEMBERT_WORKSPACE(${name}), "
                    "DALEMBERT_RUN(${calls}), {{${results}}}")
  set(generated_libraries ${generated_libraries} ${name} PARENT_SCOPE)
  set(generated_includes "${generated_includes}#include \"${name}/c_api.h\"\n" PARENT_SCOPE)
  set(generated_rows "${generated_rows}${row}},\n" PARENT_SCOPE)
endfunction()

# A robot, timed for each LABEL in ARGN.
macro(benchmark_robot robot urdf base chain)
  if("${base}" STREQUAL "floating")
    set(floats true)
  else()
    set(floats false)
  endif()
  string(APPEND robot_json "  {\"name\": \"${robot}\", \"urdf\": \"${urdf}\", \"base\": \"${base}\"},\n")
  string(APPEND robot_rows "    {\"${robot}\", \"${urdf}\", ${floats}, ${chain}},\n")
  foreach(label ${ARGN})
    benchmark_library("${robot}" "${urdf}" ${base} ${label} ${outputs_of_${label}})
  endforeach()
endmacro()

# The robot with the base it is not timed with, all outputs: for the accuracy program.
macro(accuracy_robot robot urdf base)
  benchmark_library("${robot}" "${urdf}" ${base} ${base} mass_matrix coriolis_matrix gravity bias)
endmacro()

# Writes the robot's URDF while building: ARGN are make_robot's arguments.
macro(make_urdf robot)
  set(urdf "${CMAKE_CURRENT_BINARY_DIR}/${robot}.urdf")
  add_custom_command(OUTPUT "${urdf}" COMMAND make_robot ${ARGN} > "${urdf}" DEPENDS make_robot VERBATIM)
  add_custom_target(${robot}_urdf DEPENDS "${urdf}")
endmacro()

# A chain on a fixed base, all outputs, for the program of extremes: the last link's mass and length relative to the base's.
macro(extreme_chain robot joints masses lengths)
  make_urdf(${robot} ${joints} 1 ${masses} ${lengths})
  accuracy_robot(${robot} "${urdf}" fixed)
  string(APPEND extreme_rows "    {\"${robot}\", \"${urdf}\", false, true},\n")
endmacro()

# A tree of equal branches (one: a chain) on a fixed base.
macro(benchmark_tree robot joints branches chain)
  make_urdf(${robot} ${joints} ${branches})
  benchmark_robot(${robot} "${urdf}" fixed ${chain} ${ARGN})
endmacro()

set(data /usr/share/doc/dart/data)
benchmark_robot(MAHRU "${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf" floating false ${everything})
accuracy_robot(MAHRU "${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf" fixed)
if(EXISTS ${data})
  benchmark_robot(DRC-Hubo ${data}/urdf/drchubo/drchubo.urdf floating false ${everything})
  benchmark_robot(Atlas ${data}/sdf/atlas/atlas_v3_no_head.urdf floating false ${everything})
  benchmark_robot(WAM ${data}/urdf/wam/wam.urdf fixed true ${everything})
  benchmark_robot(KR5 "${data}/urdf/KR5/KR5 sixx R650.urdf" fixed true ${terms})
  accuracy_robot(WAM ${data}/urdf/wam/wam.urdf floating)
  accuracy_robot(KR5 "${data}/urdf/KR5/KR5 sixx R650.urdf" floating)
else()
  message(WARNING "Benchmarks run without DRC-Hubo, Atlas, WAM and KR5, which are in the package dart-doc")
endif()
set(extreme_rows "    {\"MAHRU\", \"${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf\", false, false},\n")
if(EXISTS ${data})
  string(APPEND extreme_rows "    {\"WAM\", \"${data}/urdf/wam/wam.urdf\", true, false},\n")
endif()
extreme_chain(heavy_tip 10 1e9 1)
extreme_chain(light_tip 10 1e-9 1)
extreme_chain(long_tip 10 1 1e6)
extreme_chain(short_tip 10 1 1e-6)
extreme_chain(long_chain 100 1 1)
# The larger ones take minutes to compile: -DDALEMBERT_BENCHMARK_JOINTS="10;20;50;100" for a full table.
set(DALEMBERT_BENCHMARK_JOINTS 10 20 CACHE STRING "Joints of the chains and trees that are timed")
foreach(joints IN LISTS DALEMBERT_BENCHMARK_JOINTS)
  benchmark_tree(chain_${joints} ${joints} 1 true M M+C bias)
  foreach(branches 2 5 10)
    if(joints EQUAL branches)
      continue()  # ten pendulums: C is zero
    endif()
    benchmark_tree(tree_${joints}_${branches} ${joints} ${branches} false M+C)
  endforeach()
endforeach()

# The robots of benchmark_tasks: JOINTS in BRANCHES equal branches on a fixed base, with a task graph.
set(task_libraries "")
set(task_includes "")
set(task_structs "")
set(task_names "")
function(task_robot name urdf)
  dalembert_add_robot(tasks_${name} URDF "${urdf}" NAME ${name} TASKS NATIVE NO_SELF_TEST OPTIONS --base fixed --outputs mass_matrix,coriolis_matrix)
  set(task_libraries "${task_libraries};tasks_${name}" PARENT_SCOPE)
  set(task_includes "${task_includes}#include \"${name}/tasks.hpp\"\n" PARENT_SCOPE)
  set(task_structs "${task_structs}struct ${name}_robot {
  static constexpr int nq = ${name}::nq, nv = ${name}::nv;
  using Workspace = ${name}::Workspace;
  using TaskGraph = ${name}::TaskGraph;
  static void evaluate(const double* q, const double* v, Workspace& w) { ${name}::evaluate(q, v, w); }
};
" PARENT_SCOPE)
  set(task_names "${task_names} DALEMBERT_TASK_ROBOT(${name})" PARENT_SCOPE)
endfunction()
task_robot(mahru "${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf")
foreach(shape "50;1" "200;1" "500;1" "50;5" "100;5" "200;5" "500;5" "500;10")
  list(GET shape 0 joints)
  list(GET shape 1 branches)
  set(name tree_${joints}_in_${branches})
  set(urdf "${CMAKE_CURRENT_BINARY_DIR}/${name}.urdf")
  add_custom_command(OUTPUT "${urdf}" COMMAND make_robot ${joints} ${branches} > "${urdf}" DEPENDS make_robot VERBATIM)
  add_custom_target(${name}_urdf DEPENDS "${urdf}")
  task_robot(${name} "${urdf}")
  add_dependencies(tasks_${name} ${name}_urdf)
endforeach()
# The robots of benchmark_batch: LABEL in ARGN, as above, or of what `contacts` hold, a scene's.
set(outputs_of_cfd constrained_forward_dynamics constraint_forces)
set(outputs_of_cid constrained_inverse_dynamics inverse_constraint_forces)
set(outputs_of_impact impact)
set(contacts "")
set(batch_libraries "")
set(batch_includes "")
set(batch_structs "")
set(batch_names "")
function(batch_robot robot urdf base)
  foreach(label ${ARGN})
    string(MAKE_C_IDENTIFIER "batch_${robot}_${label}" name)
    list(JOIN outputs_of_${label} "," outputs)
    dalembert_add_robot(${name} URDF "${urdf}" NAME ${name} BATCH NATIVE NO_SELF_TEST OPTIONS --base ${base} --outputs [] --functions together=${outputs} ${contacts})
    set(call "q, v, workspace")
    if(label MATCHES "^(id|fd|did|dfd|regressor|cfd|cid)$")
      set(call "q, v, input, workspace")
    endif()
    set(sizes "")
    set(pointers "")
    foreach(quantity ${outputs_of_${label}})
      string(APPEND sizes "sizeof(Workspace::together_${quantity}) / sizeof(double), ")
      list(FIND outputs_of_${label} ${quantity} index)
      string(APPEND pointers "    to.together_${quantity} = results[${index}].data();\n")
    endforeach()
    list(GET outputs_of_${label} 0 first)
    set(rollout "  static constexpr bool rolls_out = false;")
    if(label MATCHES "^c?fd$")
      set(rollout "  static constexpr bool rolls_out = true;
  static void rollout(const Batch& batch, const dalembert::Rollout<double>& motions) { (void)${name}::together_rollout(batch, motions); }")
    endif()
    list(APPEND batch_libraries ${name})
    string(APPEND batch_includes "#include \"${name}/batch_tasks.hpp\"\n")
    string(APPEND batch_structs "struct ${name}_robot {
  static constexpr int nq = ${name}::nq, nv = ${name}::nv;
  using Workspace = ${name}::Workspace;
  using Batch = ${name}::Batch;
  static constexpr std::size_t sizes[] = {${sizes}};
  static void single(const double* q, const double* v, [[maybe_unused]] const double* input, Workspace& workspace) {
    ${name}::together(${call});
  }
  static const double* first_result(const Workspace& workspace) { return workspace.together_${first}; }
  template <class Results>
  static ${name}::TogetherBatchResults pointers(Results& results) {
    ${name}::TogetherBatchResults to;
${pointers}    return to;
  }
  template <class Results>
  static void batch(const Batch& batch, Results& results) { (void)${name}::together_batch(batch, pointers(results)); }
  template <class Results>
  static void tasks(const Batch& batch, Results& results) { (void)${name}::together_batch_tasks(batch, pointers(results)); }
  static void blocks(const Batch& batch) {
    (void)${name}::together_batch_blocks(
        batch, [](const ${name}::TogetherBatchBlock& block, void*) { benchmark::DoNotOptimize(block.together_${first}); }, nullptr);
  }
${rollout}
};
")
    string(APPEND batch_names " \\\n  DALEMBERT_BATCH_ROBOT(${name}_robot, \"${robot}/${label}\")")
  endforeach()
  foreach(list batch_libraries batch_includes batch_structs batch_names)
    set(${list} "${${list}}" PARENT_SCOPE)
  endforeach()
endfunction()
batch_robot(MAHRU "${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf" floating M+C bias id fd)
set(contacts --contacts "{left: {link: left_foot}, right: {link: right_foot}}")
batch_robot(MAHRU "${PROJECT_SOURCE_DIR}/examples/mahru/mahru.urdf" floating cfd cid impact)
set(contacts "")
foreach(leg front_left front_right hind_left hind_right)
  list(APPEND contacts "${leg}: {link: ${leg}_3_knee, type: point, at: [0, 0, -0.2]}")
endforeach()
list(JOIN contacts ", " contacts)
set(contacts --contacts "{${contacts}}")
batch_robot(quadruped "${PROJECT_SOURCE_DIR}/tests/robots/quadruped_12.urdf" floating fd cfd cid impact)
set(contacts "")
batch_robot(arm_fingers "${PROJECT_SOURCE_DIR}/tests/robots/arm_fingers.urdf" fixed M+C bias fd dfd)
if(EXISTS ${data})
  batch_robot(WAM ${data}/urdf/wam/wam.urdf fixed M+C bias fd dfd)
endif()
file(CONFIGURE OUTPUT tables/batch_robots.hpp CONTENT [[
// Written by tests/benchmarks/robots.cmake.
#pragma once

@batch_includes@
@batch_structs@
#define DALEMBERT_BATCH_ROBOTS @batch_names@
]] @ONLY)

file(CONFIGURE OUTPUT tables/task_robots.hpp CONTENT [[
// Written by tests/benchmarks/robots.cmake.
#pragma once

@task_includes@
@task_structs@
#define DALEMBERT_TASK_ROBOTS @task_names@
]] @ONLY)

file(CONFIGURE OUTPUT tables/benchmark_robots.hpp CONTENT [[
// Written by tests/benchmarks/robots.cmake.
#pragma once

namespace dalembert::benchmarks {

struct RobotEntry {
  const char* name;
  const char* urdf;
  bool floating;
  bool chain;  // on a fixed base
};

inline constexpr RobotEntry benchmark_robots[] = {
@robot_rows@};

// Of the program of extremes: chains that are extreme themselves, others whose states are.
inline constexpr RobotEntry extreme_robots[] = {
@extreme_rows@};

}  // namespace dalembert::benchmarks
]] @ONLY)

set(output_json "")
foreach(label IN LISTS everything)
  list(JOIN outputs_of_${label} "," outputs)
  string(APPEND output_json "  \"${label}\": \"${outputs}\",\n")
endforeach()
string(REGEX REPLACE ",\n$" "" output_json "${output_json}")
file(CONFIGURE OUTPUT tables/outputs.json CONTENT "{\n@output_json@\n}\n" @ONLY)

string(REGEX REPLACE ",\n$" "" robot_json "${robot_json}")
file(CONFIGURE OUTPUT tables/robots.json CONTENT "[\n@robot_json@\n]\n" @ONLY)

file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/tables/generated_table.hpp CONTENT
"// Written by tests/benchmarks/robots.cmake.
#pragma once

${generated_includes}
#include \"generated_robot.hpp\"

namespace dalembert::benchmarks {

#define DALEMBERT_WORKSPACE(name)            \\
  []() -> void* { return name##_create(); }, \\
      [](void* workspace) { name##_destroy(static_cast<name##_workspace*>(workspace)); }
#define DALEMBERT_RUN(calls) \\
  [](const double* q, const double* v, [[maybe_unused]] const double* more, void* workspace) { calls }
#define DALEMBERT_CALL(name, function) name##_##function(q, v, static_cast<name##_workspace*>(workspace));
#define DALEMBERT_CALL_WITH_MORE(name, function) name##_##function(q, v, more, static_cast<name##_workspace*>(workspace));
#define DALEMBERT_OUTPUT(name, quantity, accessor) \\
  {ir::Quantity::quantity, [](const void* workspace) { return name##_##accessor(static_cast<const name##_workspace*>(workspace)); }}

inline constexpr GeneratedRobot generated_robots[] = {
${generated_rows}};

#undef DALEMBERT_WORKSPACE
#undef DALEMBERT_RUN
#undef DALEMBERT_CALL
#undef DALEMBERT_CALL_WITH_MORE
#undef DALEMBERT_OUTPUT

}  // namespace dalembert::benchmarks
")
