# Writes FILE: NUMBER and the git commit of SOURCE as C++ strings (cmake -DSOURCE=… -DNUMBER=… -DFILE=… -P version.cmake).
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(WRITE ${FILE} "#include <run/command_line.hpp>
std::string tetsuame::run::version() { return \"${commit}\"; }
std::string tetsuame::run::release() { return \"${NUMBER}\"; }
")
