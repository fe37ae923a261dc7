# SPDX-License-Identifier: MIT
# lapidary_add_plugin(KIND FILE): builds one plugin from one file.
#
#   KIND   objects, materials, lights or outputs: the folder in which the registry looks for it
#   FILE   the source; its stem is the keyword that scenes write
#
# The library becomes <kind>/<keyword>.so in the plugin folder, in the build tree as under the installation prefix.
# Its target is called lapidary_<kind>_<keyword>, for files that need more than the SDK.

if(NOT DEFINED LAPIDARY_PLUGIN_FOLDER)
  set(LAPIDARY_PLUGIN_FOLDER lib/lapidary/plugins)
endif()

function(lapidary_add_plugin kind file)
  if(NOT kind MATCHES "^(objects|materials|lights|outputs)$")
    message(FATAL_ERROR "lapidary_add_plugin: '${kind}' is not a kind of plugin; write objects, materials, lights or outputs.")
  endif()
  cmake_path(GET file STEM LAST_ONLY keyword)
  if(NOT keyword MATCHES "^[A-Za-z_][A-Za-z0-9_]*$")
    message(FATAL_ERROR "lapidary_add_plugin: the file's stem '${keyword}' is to be a keyword: letters, digits and "
      "underscores, no digit first.")
  endif()
  set(target lapidary_${kind}_${keyword})
  add_library(${target} MODULE ${file})
  target_link_libraries(${target} PRIVATE lapidary::sdk)
  target_compile_features(${target} PRIVATE cxx_std_20)
  # Contraction of a*b+c would break error-free transformations; with the other two the compiler vectorises sqrt.
  target_compile_options(${target} PRIVATE
    -ffp-contract=off -fno-math-errno -fno-trapping-math -fvisibility=hidden -fvisibility-inlines-hidden
    $<$<BOOL:${LAPIDARY_ARCHITECTURE}>:-march=${LAPIDARY_ARCHITECTURE}>
    $<$<STREQUAL:$<CONFIG>,>:-O3>)  # a project without a build type would get no optimisation at all
  set_target_properties(${target} PROPERTIES
    PREFIX "" SUFFIX ".so" OUTPUT_NAME ${keyword}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${LAPIDARY_PLUGIN_FOLDER}/${kind})
  install(TARGETS ${target} LIBRARY DESTINATION ${LAPIDARY_PLUGIN_FOLDER}/${kind})
endfunction()
