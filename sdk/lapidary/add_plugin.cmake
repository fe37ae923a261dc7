# SPDX-License-Identifier: MIT
# lapidary_add_plugin(KIND FILE): builds one plugin from one file.
#
#   KIND   objects, materials, lights or outputs: the folder in which the registry looks for it
#   FILE   the source; its stem is the keyword that scenes write
#
# The library becomes <kind>/<keyword>.so in the plugin folder, in the build tree as under the installation prefix, built for the
# first of LAPIDARY_LEVELS, which every machine has that is to run it. Objects, materials and lights are built for each of the
# others, too: <level>/<kind>/<keyword>.so, which a kernel of that level takes instead.
#
# The target is called lapidary_<kind>_<keyword>, for files that need more than the SDK. What is added to it, the targets of other
# levels have, too.

if(NOT DEFINED LAPIDARY_PLUGIN_FOLDER)
  set(LAPIDARY_PLUGIN_FOLDER lib/lapidary/plugins)
endif()

# What a compiler is told for a level. Of x86-64-v4 it uses vectors of all 512 bits, which it would not by itself: where the
# machine computes them as one, all scenes are faster by 5 to 15 %.
function(lapidary_level_options level variable)
  set(options "")
  if(level)
    set(options -march=${level})
  endif()
  if(level STREQUAL x86-64-v4)
    list(APPEND options -mprefer-vector-width=512)
  endif()
  # Lanes are copied and cleared by vectors of the size that they are written by: g++ would take `rep stos`, which is slow to begin,
  # or smaller ones, of which there are more. (Larger ones would wait until all that they are made of has left for memory.)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12 AND level)
    set(strategy vector_loop:8192:noalign,libcall:-1:noalign)
    list(APPEND options -mmemset-strategy=${strategy} -mmemcpy-strategy=${strategy})
    if(level STREQUAL x86-64-v4)
      list(APPEND options -mmove-max=512 -mstore-max=512)
    endif()
  endif()
  set(${variable} ${options} PARENT_SCOPE)
endfunction()

function(lapidary_place_plugin target keyword folder)
  set_target_properties(${target} PROPERTIES
    PREFIX "" SUFFIX ".so" OUTPUT_NAME ${keyword}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${LAPIDARY_PLUGIN_FOLDER}/${folder})
  install(TARGETS ${target} LIBRARY DESTINATION ${LAPIDARY_PLUGIN_FOLDER}/${folder})
endfunction()

function(lapidary_add_plugin kind file)
  if(NOT kind MATCHES "^(objects|materials|lights|outputs)$")
    message(FATAL_ERROR "lapidary_add_plugin: '${kind}' is not a kind of plugin; write objects, materials, lights or outputs.")
  endif()
  cmake_path(GET file STEM LAST_ONLY keyword)
  if(NOT keyword MATCHES "^[A-Za-z_][A-Za-z0-9_]*$")
    message(FATAL_ERROR "lapidary_add_plugin: the file's stem '${keyword}' is to be a keyword: letters, digits and "
      "underscores, no digit first.")
  endif()
  set(higher_levels ${LAPIDARY_LEVELS})
  list(POP_FRONT higher_levels first_level)

  set(target lapidary_${kind}_${keyword})
  add_library(${target} MODULE ${file})
  target_link_libraries(${target} PRIVATE lapidary::sdk)
  target_compile_features(${target} PRIVATE cxx_std_20)
  # Contraction of a*b+c would break error-free transformations; with the other two the compiler vectorises sqrt.
  lapidary_level_options("${first_level}" options)
  target_compile_options(${target} PRIVATE
    -ffp-contract=off -fno-math-errno -fno-trapping-math -fvisibility=hidden -fvisibility-inlines-hidden ${options}
    $<$<STREQUAL:$<CONFIG>,>:-O3>)  # a project without a build type would get no optimisation at all
  lapidary_place_plugin(${target} ${keyword} ${kind})

  if(kind STREQUAL outputs)  # files are written at the speed of the disk
    return()
  endif()
  foreach(level ${higher_levels})
    set(copy ${target}_${level})
    add_library(${copy} MODULE $<TARGET_PROPERTY:${target},SOURCES>)
    target_include_directories(${copy} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    target_compile_definitions(${copy} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
    target_compile_features(${copy} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_FEATURES>)
    lapidary_level_options(${level} options)
    target_compile_options(${copy} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_OPTIONS> ${options})
    target_link_libraries(${copy} PRIVATE $<TARGET_PROPERTY:${target},LINK_LIBRARIES>)
    set_target_properties(${copy} PROPERTIES EXPORT_COMPILE_COMMANDS OFF)
    lapidary_place_plugin(${copy} ${keyword} ${level}/${kind})
    add_dependencies(${target} ${copy})
  endforeach()
endfunction()
