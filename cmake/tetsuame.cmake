# Shared settings and the three commands every folder uses:
#   tetsuame_module(NAME [FOLDER name, where a program has it] [SOURCES …] [DEPENDS modules …] [LIBRARIES targets …])
#   tetsuame_program(NAME SOURCES … DEPENDS … [WIDE])
#   tetsuame_test(NAME SOURCES … DEPENDS … [WIDE_DEPENDS …] [LABELS …] [RANKS n …])

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# Processors with AVX2 and later; elsewhere those that the compiler itself compiles for.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set(arch x86-64-v3)
else()
  set(arch "")
endif()
set(TETSUAME_ARCH "${arch}" CACHE STRING "-march= of every target (native: this machine only; empty: the compiler's own)")
option(TETSUAME_AVX512 "The programs marked WIDE can be built for AVX-512 too" ON)
# Half of the time that a small source takes to compile goes into headers and templates that its neighbours instantiate too.
option(TETSUAME_UNITY "Compile the sources of a module several at a time" ON)
option(TETSUAME_SANITIZE "Address and undefined-behaviour sanitizers" OFF)

add_library(tetsuame_options INTERFACE)
# -ffp-contract=off: a value must have the same bits wherever it stands in an array, so
# in the modules the compiler may not fuse differently in a loop's body and tail.
target_compile_options(tetsuame_options INTERFACE
  -Wall -Wextra -Wpedantic $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow> -Wno-psabi
  $<$<BOOL:${TETSUAME_ARCH}>:-march=$<IF:$<BOOL:$<TARGET_PROPERTY:TETSUAME_WIDE>>,x86-64-v4,${TETSUAME_ARCH}>> -ffp-contract=$<IF:$<BOOL:$<TARGET_PROPERTY:TETSUAME_FUSE>>,fast,off> -fno-math-errno -fno-trapping-math)
# g++ 12 takes the undefined operands inside its own AVX-512 intrinsics for uninitialised variables.
target_compile_options(tetsuame_options INTERFACE
  "$<$<BOOL:$<TARGET_PROPERTY:TETSUAME_WIDE>>:-Wno-maybe-uninitialized;-Wno-uninitialized>")
# By default g++ collects its garbage so often that it takes a tenth of the time; its memory grows by a quarter without.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(tetsuame_options INTERFACE "SHELL:--param ggc-min-heapsize=2000000")
endif()
# g++ 12 to 14 see faults of these kinds in what they inline from the standard library and Boost.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(tetsuame_options INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow)
endif()
target_compile_definitions(tetsuame_options INTERFACE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
if(TETSUAME_SANITIZE)
  target_compile_options(tetsuame_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(tetsuame_options INTERFACE -fsanitize=address,undefined)
endif()

# The kind of programs that the machine that configures takes.
set(TETSUAME_HOST_AVX512 OFF)
if(EXISTS /proc/cpuinfo)
  file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
  if(flags MATCHES "avx512bw" AND flags MATCHES "avx512cd" AND flags MATCHES "avx512vl" AND flags MATCHES "avx512dq")
    set(TETSUAME_HOST_AVX512 ON)
  endif()
endif()

# What most files include of the standard library and of others is read once for each kind of options, not for each file.
# A file includes what it uses all the same: ./run check and builds for debugging read it so. Only g++ allows the
# definitions of the targets to differ in what these headers do not use.
if(CMAKE_BUILD_TYPE STREQUAL "Debug" OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()
function(share_headers target)
  set(kind headers)
  set(options "")
  foreach(option IN ITEMS WIDE FUSE TEST)
    get_target_property(value ${target} TETSUAME_${option})
    if(value)
      string(APPEND kind _${option})
      list(APPEND options TETSUAME_${option} ON)
    endif()
  endforeach()
  if(NOT TARGET ${kind})
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${kind}.cpp CONTENT "")
    add_library(${kind} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/${kind}.cpp)
    target_link_libraries(${kind} PRIVATE tetsuame_options fmt::fmt m MPI::MPI_C OpenMP::OpenMP_CXX)
    target_precompile_headers(${kind} PRIVATE
      <algorithm> <array> <chrono> <cmath> <experimental/simd> <filesystem> <fstream> <functional> <map> <memory>
      <numeric> <optional> <span> <sstream> <string> <variant> <vector>
      <fmt/format.h> <mpi.h>)
    if(kind MATCHES TEST)
      target_precompile_headers(${kind} PRIVATE <boost/test/unit_test.hpp>)
      target_link_libraries(${kind} PRIVATE test_main)
      target_compile_options(${kind} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
    if(options)
      set_target_properties(${kind} PROPERTIES ${options})
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${kind})
endfunction()

# Without a target, ninja builds the programs and tools for the machine that configured. With the tests:
add_custom_target(this_machine)
# The programs and tools for processors of both kinds:
add_custom_target(portable)

function(tetsuame_module name)
  cmake_parse_arguments(arg "" "FOLDER" "SOURCES;DEPENDS;LIBRARIES" ${ARGN})
  if(NOT arg_FOLDER)
    set(arg_FOLDER ${name})
  endif()
  # <folder/header.hpp> is found only through this target: a link to the module's
  # folder in an include root of its own, so that an undeclared include fails.
  set(root ${CMAKE_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${root})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/${arg_FOLDER} SYMBOLIC)
  if(arg_SOURCES)
    set(scope PUBLIC)
    add_library(${name} STATIC ${arg_SOURCES})
    share_headers(${name})
    # Builds for debugging, and the linter, read every source by itself, and warn of names in it that hide others of it.
    if(TETSUAME_UNITY AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
      set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    endif()
  else()
    set(scope INTERFACE)
    add_library(${name} INTERFACE)
  endif()
  target_include_directories(${name} ${scope} ${root})
  target_link_libraries(${name} ${scope} tetsuame_options ${arg_DEPENDS} ${arg_LIBRARIES})
endfunction()

set(TETSUAME_BOTH_WIDTHS OFF)
if(TETSUAME_AVX512 AND TETSUAME_ARCH STREQUAL "x86-64-v3" AND NOT TETSUAME_SANITIZE
    AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  set(TETSUAME_BOTH_WIDTHS ON)
endif()

# Of the two kinds, that of the machine that configures.
if(NOT TETSUAME_BOTH_WIDTHS)
  set(TETSUAME_HOST_WIDTH "")
elseif(TETSUAME_HOST_AVX512)
  set(TETSUAME_HOST_WIDTH _avx512)
else()
  set(TETSUAME_HOST_WIDTH _avx2)
endif()

# Links the kind of these libraries that the target is of, by its name; of others that for this machine.
function(link_wide target)
  string(REGEX MATCH "_avx[0-9]+$" width ${target})
  if(NOT width)
    set(width ${TETSUAME_HOST_WIDTH})
  endif()
  foreach(library IN LISTS ARGN)
    target_link_libraries(${target} PUBLIC ${library}${width})
  endforeach()
endfunction()

# Code with the pair loop that several programs share: a library for each kind of program that WIDE makes, which these
# name under WIDE_DEPENDS.
function(tetsuame_wide_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS;WIDE_DEPENDS" ${ARGN})
  set(targets ${name})
  if(TETSUAME_BOTH_WIDTHS)
    set(targets ${name}_avx2 ${name}_avx512)
  endif()
  foreach(target IN LISTS targets)
    add_library(${target} STATIC EXCLUDE_FROM_ALL ${arg_SOURCES})
    link_wide(${target} ${arg_WIDE_DEPENDS})
    target_link_libraries(${target} PUBLIC ${arg_DEPENDS} tetsuame_options)
    set_target_properties(${target} PROPERTIES TETSUAME_FUSE ON)
  endforeach()
  if(TARGET ${name}_avx512)
    set_target_properties(${name}_avx512 PROPERTIES TETSUAME_WIDE ON)
  endif()
  foreach(target IN LISTS targets)
    share_headers(${target})
  endforeach()
endfunction()

# WIDE: the pair loop is in it. For AVX2 and for AVX-512, in folders of their own; the program's name stands for a
# launcher that chooses (programs/launcher.cpp), and as a target for it and the one that this machine takes; the other
# is built on request. Not with another TETSUAME_ARCH, or for debugging: then the name is the program.
function(tetsuame_program name)
  cmake_parse_arguments(arg "WIDE" "" "SOURCES;DEPENDS;WIDE_DEPENDS" ${ARGN})
  set(folder ${CMAKE_BINARY_DIR}/programs)
  if(arg_WIDE AND TETSUAME_BOTH_WIDTHS)
    add_executable(${name} ${CMAKE_SOURCE_DIR}/programs/launcher.cpp)
    set(targets ${name}_avx2 ${name}_avx512)
    add_executable(${name}_avx2 EXCLUDE_FROM_ALL ${arg_SOURCES})
    set_target_properties(${name}_avx2 PROPERTIES OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${folder}/avx2)
    add_executable(${name}_avx512 EXCLUDE_FROM_ALL ${arg_SOURCES})
    set_target_properties(${name}_avx512 PROPERTIES
      TETSUAME_WIDE ON OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${folder}/avx512)
    add_dependencies(portable ${targets})
    add_dependencies(${name} ${name}${TETSUAME_HOST_WIDTH})
  else()
    add_executable(${name} ${arg_SOURCES})
    set(targets ${name})
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${folder})
  # A launcher finds its programs below its own folder: that is lib/tetsuame, and in bin stand links.
  install(PROGRAMS $<TARGET_FILE:${name}> DESTINATION lib/tetsuame)
  foreach(kind IN LISTS targets)
    if(kind MATCHES "_(avx[0-9]+)$")
      install(PROGRAMS $<TARGET_FILE:${kind}> DESTINATION lib/tetsuame/${CMAKE_MATCH_1} OPTIONAL)
    endif()
  endforeach()
  install(CODE "set(prefix \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
    file(MAKE_DIRECTORY \"\${prefix}/bin\")
    file(CREATE_LINK ../lib/tetsuame/$<TARGET_FILE_NAME:${name}> \"\${prefix}/bin/$<TARGET_FILE_NAME:${name}>\" SYMBOLIC)")
  add_dependencies(this_machine ${name})
  add_dependencies(portable ${name})
  foreach(target IN LISTS targets)
    link_wide(${target} ${arg_WIDE_DEPENDS})
    target_link_libraries(${target} PUBLIC ${arg_DEPENDS})
    # The physics is compiled here, from headers. Its sums over neighbours run the same
    # instructions for every particle, so multiply and add may be fused (a sixth faster).
    set_target_properties(${target} PROPERTIES TETSUAME_FUSE ON)
    share_headers(${target})
  endforeach()
endfunction()

# One Boost.Test executable. With RANKS the test runs under mpirun once for each
# number given (named NAME.n), else as a plain process. It is of the kind that this machine takes. WIDE_DEPENDS: libraries
# of passes (run/passes.hpp, liquid/passes.hpp), which the test takes as the programs do instead of compiling them again.
# OPTIMISED: what is tested is the arithmetic of the test's own translation units as programs have it, so that these are
# optimised as much.
function(tetsuame_test name)
  cmake_parse_arguments(arg "OPTIMISED" "TIMEOUT" "SOURCES;DEPENDS;WIDE_DEPENDS;LABELS;RANKS" ${ARGN})
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(NOT TARGET test_main)
    add_library(test_main STATIC EXCLUDE_FROM_ALL ${CMAKE_SOURCE_DIR}/tests/main.cpp)
    target_link_libraries(test_main PUBLIC tetsuame_options Boost::unit_test_framework)
    target_compile_definitions(test_main PUBLIC BOOST_TEST_DYN_LINK)
  endif()
  add_executable(test_${name} EXCLUDE_FROM_ALL ${arg_SOURCES})
  add_dependencies(this_machine test_${name})
  target_compile_definitions(test_${name} PRIVATE
    TETSUAME_SOURCE_DIR="${CMAKE_SOURCE_DIR}" TETSUAME_BINARY_DIR="${CMAKE_BINARY_DIR}")
  # The others are compiled once and run for a second: -O1, which follows the -O3 of the build type, saves a third of the
  # time to compile them. Bits do not depend on it, as nothing is fused. The libraries are those of the programs.
  if(TETSUAME_HOST_WIDTH STREQUAL "_avx512")
    set_target_properties(test_${name} PROPERTIES TETSUAME_WIDE ON)
  endif()
  if(NOT arg_OPTIMISED)
    target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    set_target_properties(test_${name} PROPERTIES TETSUAME_TEST ON)
    share_headers(test_${name})
  endif()
  link_wide(test_${name} ${arg_WIDE_DEPENDS})
  target_link_libraries(test_${name} PUBLIC test_main ${arg_DEPENDS} tetsuame_options)
  set_target_properties(test_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  set(mpi_environment
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive)
  if(arg_RANKS)
    foreach(ranks IN LISTS arg_RANKS)
      add_test(NAME ${name}.${ranks}
        COMMAND ${MPIEXEC_EXECUTABLE} --bind-to none -n ${ranks} ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:test_${name}>)
      set_tests_properties(${name}.${ranks} PROPERTIES LABELS "${arg_LABELS};mpi"
        ENVIRONMENT "${mpi_environment}" TIMEOUT ${arg_TIMEOUT} PROCESSORS ${ranks})
    endforeach()
  else()
    add_test(NAME ${name} COMMAND test_${name})
    set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}"
      ENVIRONMENT "${mpi_environment}" TIMEOUT ${arg_TIMEOUT})
  endif()
endfunction()
