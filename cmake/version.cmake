# Writes FILE: the git commit of SOURCE as a C++ string (cmake -DSOURCE=… -DFILE=… -P version.cmake).
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(WRITE ${FILE} "#include <run/command_line.hpp>\nstd::string tetsuame::run::version() { return \"${commit}\"; }\n")
