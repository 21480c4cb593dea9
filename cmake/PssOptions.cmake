# How every target of this project is compiled.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(pss_options INTERFACE)
target_compile_options(pss_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror
  # g++ 12 also warns of designated initializers, whose point is to leave the rest at its default.
  -Wno-missing-field-initializers
  # The same bits on every machine: products and sums are fused only where the code says so.
  -ffp-contract=off
  # g++ 12 drops the rounding to float of pairs of doubles that this pass makes one vector of.
  $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
if(PSS_SANITIZE)
  target_compile_options(pss_options INTERFACE -fsanitize=${PSS_SANITIZE} -fno-omit-frame-pointer
                                               -fno-sanitize-recover=all)
  target_link_options(pss_options INTERFACE -fsanitize=${PSS_SANITIZE})
endif()

# A library of one folder: pss_add_library(core SOURCES ... PUBLIC_HEADERS ... HEADERS ... LINKS ...).
# All headers are compiled alone by the target all_verify_interface_header_sets; the public ones are
# installed: those that docs/library.md names, and what these include.
function(pss_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC_HEADERS;HEADERS;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(pss_${name} STATIC ${ARG_SOURCES})
  add_library(pss::${name} ALIAS pss_${name})
  set_target_properties(pss_${name} PROPERTIES EXPORT_NAME ${name}
                                               VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(pss_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}
                                    FILES ${ARG_PUBLIC_HEADERS})
  target_include_directories(pss_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/pss>)
  target_compile_features(pss_${name} PUBLIC cxx_std_20)
  target_link_libraries(pss_${name} PUBLIC ${ARG_LINKS}
                                    PRIVATE $<BUILD_INTERFACE:pss_options> ${ARG_PRIVATE_LINKS})
  # The others belong to no target that is installed.
  add_library(pss_${name}_inner INTERFACE)
  set_target_properties(pss_${name}_inner PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(pss_${name}_inner INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}
                                             FILES ${ARG_HEADERS})
  target_link_libraries(pss_${name}_inner INTERFACE pss_${name})
endfunction()
